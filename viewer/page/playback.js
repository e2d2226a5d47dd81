// The clock of a playback and what it shows: pose, targets, drums and strikes at its time. While
// there is sound, the sound's clock is the playback's. Times in milliseconds.
import { before } from "./scene.js";
import { segments } from "./skeleton.js";

const LONGEST_FRAME = 1000; // (ms) after a longer one, as of a hidden tab, time goes on where it was
const FRAME = 1000 / 60;
export const SPEEDS = [0.02, 0.05, 0.1, 0.25, 0.5, 1, 2];

export class Playback {
    constructor(scene, sound) {
        ((this.scene = scene), (this.sound = sound));
        ((this.at = 0), (this.speed = 1), (this.playing = true));
        ((this.loop = null), (this.jumped = true), (this.shownTo = 0));
        this.length = 1000 * scene.end;
        this.compare = scene.ghosts.length ? "overlay" : ""; // or "side": the ghosts beside the performer
        this.pose = new Float64Array(7 * segments.length);
        this.target = new Float64Array(6);
        this.support = new Float64Array(12);
        this.amplitude = new Float32Array(64);
        this.modal = new Float64Array(64);
    }

    // [from, to] of what is played: the loop, or all
    get span() {
        return this.loop ?? [0, this.length];
    }

    // up to where it has been computed, in an edit
    get known() {
        return Math.min(this.length, 1000 * this.scene.end);
    }

    seek(ms) {
        this.at = Math.min(this.known, Math.max(0, ms));
        this.jumped = true;
        this.resound();
    }

    // the sound begins anew where the playback is
    resound() {
        this.sound.stop();
        if (this.playing) this.sound.play(this.at / 1000, this.speed, this.seconds);
    }

    // the loop in seconds, or null
    get seconds() {
        return this.loop && this.loop.map(t => t / 1000);
    }

    play(yes) {
        if (yes && this.at >= this.span[1]) this.seek(this.span[0]);
        this.playing = yes;
        this.resound();
    }

    setSpeed(speed) {
        this.speed = Math.min(SPEEDS[SPEEDS.length - 1], Math.max(SPEEDS[0], speed));
        this.resound();
    }

    setLoop(a, b) {
        const [from, to] = [Math.min(a, b), Math.max(a, b)].map(t =>
            Math.min(this.length, Math.max(0, t)),
        );
        this.loop = to - from >= FRAME ? [from, to] : null;
        this.sound.setLoop(this.seconds);
        if (this.loop && (this.at < from || this.at > to)) this.seek(from);
    }

    // a frame, or with `strikes` a stroke, further or back
    step(by, strikes) {
        this.play(false);
        if (!strikes) return this.seek(this.at + by * FRAME);
        const list = this.scene.strikes,
            time = s => 1000 * s.time,
            i = by > 0 ? before(list, this.at + 0.5, time) + 1 : before(list, this.at - 0.5, time);
        if (list[i]) this.seek(time(list[i]));
    }

    // `dt` ms have passed while frames are held: silent, by this clock alone
    tick(dt) {
        this.sound.stop();
        if (!this.playing) return;
        this.at += dt * this.speed;
        this.turn();
    }

    // at the end of the loop, or of all
    turn() {
        const [from, to] = this.span;
        if (this.at < to) return false;
        if (this.loop) this.seek(from);
        else (this.play(false), (this.at = to));
        return true;
    }

    // `dt` ms have passed
    advance(dt) {
        const heard = this.playing ? this.sound.position() : null;
        if (heard !== null) this.at = 1000 * heard;
        else if (this.playing && dt < LONGEST_FRAME) this.at += dt * this.speed;
        this.at = Math.min(this.at, this.known); // there it waits for more
        if (!this.playing) return;
        const silent = heard === null && this.sound.ready;
        if (!this.turn() && silent && this.at < 1000 * this.sound.buffer.duration) this.resound();
    }

    // shows this time: calls on.pose, on.drum for each drum, and on.strike for each strike since the
    // last call, or since `memory` ms ago after a jump
    show(on, memory) {
        const time = this.at / 1000;
        if (!this.scene.times.length) return; // an edit has just begun anew
        if (this.jumped || this.at < this.shownTo) on.jump();
        const since = this.jumped || this.at < this.shownTo ? this.at - memory : this.shownTo,
            of = s => 1000 * s.time;
        for (const scene of this.scenes) {
            on.pose(
                scene, time, scene.pose(time, this.pose), scene.targets(time, this.target), scene.support(time, this.support),
            );
            if (scene !== this.scene && this.compare !== "side") continue;
            const own = scene.drums.size > 0; // a take has none: it is beside the performer's, which rest
            for (const drum of (own ? scene : this.scene).drums.values()) {
                const change = drum.changes[Math.max(0, before(drum.changes, time, c => c.time))];
                if (change) on.drum(scene, drum.name, change.place, own ? this.head(drum, time) : this.amplitude.fill(0));
            }
            const last = before(scene.strikes, this.at, of);
            for (let i = before(scene.strikes, since, of) + 1; i <= last; i++)
                on.strike(scene.strikes[i], of(scene.strikes[i]));
        }
        ((this.shownTo = this.at), (this.jumped = false));
    }

    // the performer's, and those it is compared with
    get scenes() {
        return this.compare ? [this.scene, ...this.scene.ghosts] : [this.scene];
    }

    // Amplitudes of a head's shapes. Between two frames the modes ring freely, on from the one before
    // and back from the one after, which are weighed by how near they are; a blow parts the two.
    head(drum, time) {
        const { frames } = drum,
            i = before(frames.times, time),
            a = i >= 0 && frames.get(i),
            b = i + 1 < frames.times.length && frames.get(i + 1),
            out = this.amplitude.fill(0),
            known = drum.modes[Math.max(0, before(drum.modes, time, m => m.time))];
        if (!a || !known) return out;
        let t = 0;
        if (b && b.time - a.time < 0.1) {
            const blow = drum.blows[before(drum.blows, b.time, s => s.time)],
                parted = blow && blow.time > a.time,
                [from, last] = parted ? [blow.time, Math.max(1e-3, blow.duration || 0)] : [a.time, b.time - a.time];
            t = Math.min(1, Math.max(0, (time - from) / last));
        }
        const modal = this.modal.fill(0);
        if (t < 1) ring(a, known.modes, time, 1 - t, modal);
        if (t > 0) ring(b, known.modes, time, t, modal);
        for (const [shape, mode, part] of known.shapes) out[shape] += part * modal[mode];
        return out;
    }
}

const MOST = 3; // (1) a mode that has decayed by more is not followed back; chosen: beyond it a byte is noise

// adds `weight` times the displacements at `time` of modes that ring freely since, or until, a frame:
// q(t) = e^(-d t) (q cos wt + (s w0 + d q) / w sin wt), with w^2 = w0^2 - d^2
function ring(frame, modes, time, weight, out) {
    const dt = time - frame.time,
        n = Math.min(frame.q.length, modes.length);
    for (let k = 0; k < n; k++) {
        const q = frame.q[k],
            s = frame.s[k];
        if (!q && !s) continue;
        const [hz, d] = modes[k],
            w0 = 2 * Math.PI * hz,
            w = Math.sqrt(Math.max(0.01 * w0 * w0, w0 * w0 - d * d)),
            fall = -d * dt;
        if (fall > MOST) continue;
        out[k] +=
            weight * frame.scale * Math.exp(fall) * (q * Math.cos(w * dt) + ((s * w0 + d * q) / w) * Math.sin(w * dt));
    }
}
