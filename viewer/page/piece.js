// A piece under edit: the channel to `himc edit` behind himc-viewer, or to the same inside this page
// (channel.js), the scene that grows by what comes over it, and its sound, which plays while more of it
// is computed. docs/viewer.md has the messages. Times in seconds.
import { Scene, inflate } from "./scene.js";

const EARS = 2,
    TAKEN = 4001, // status of the channel's end when another page edits, as in viewer/channel.c
    NAME = 59, // of a saved file, without its ending (bytes), as the channel takes
    AHEAD = 0.6, // of sound that is handed to the device at a time (s); chosen: some frames
    MOST = 64 << 20; // of a file that is sent (bytes), as himc-viewer takes
export const APPROACH = 1; // (s) from play to the first frame of a take, as HIMC_APPROACH

// the sound of parts that come one after the other; for a Playback in place of a Sound
class PieceSound {
    constructor(sound, rate) {
        ((this.out = sound), (this.rate = rate), (this.parts = []), (this.sources = []));
        ((this.arrived = 0), (this.complete = false), (this.on = false));
    }

    get ready() {
        return this.parts.length > 0 && this.out.context?.state === "running";
    }

    get buffer() {
        return this.parts.length ? { duration: this.arrived } : null;
    }

    add(samples) {
        this.parts.push(samples);
        this.arrived += samples.length / EARS / this.rate;
        if (this.waits) this.play(this.from, this.speed);
        else this.schedule();
    }

    // all after `time` will come anew
    cut(time) {
        const size = this.parts.length ? this.parts[0].length / EARS / this.rate : 1;
        this.parts.length = Math.min(this.parts.length, Math.round(time / size));
        this.arrived = this.parts.length * size;
        this.complete = false;
        if (this.next > this.arrived) this.stop();
    }

    // frames [from, to) as a buffer
    piece(from, to) {
        const out = this.out.context.createBuffer(EARS, to - from, this.rate),
            size = this.parts[0].length / EARS;
        for (let c = 0; c < EARS; c++) {
            const data = out.getChannelData(c);
            for (let i = from; i < to; i++)
                data[i - from] = this.parts[Math.floor(i / size)][EARS * (i % size) + c] / 32767;
        }
        return out;
    }

    play(at, speed) {
        this.stop();
        if (!this.ready || (this.complete && at >= this.arrived)) return;
        ((this.from = this.next = at), (this.speed = speed), (this.on = true));
        this.waits = at >= this.arrived;
        this.begun = this.out.context.currentTime + 0.01;
        this.schedule();
    }

    // the playback turns back at the loop's end
    setLoop() {}

    schedule() {
        if (!this.on || this.waits) return;
        const until = this.from + (this.out.context.currentTime - this.begun + AHEAD) * this.speed;
        while (this.next < Math.min(until, this.arrived - 1e-9)) {
            const first = Math.round(this.next * this.rate),
                last = Math.round(Math.min(this.arrived, this.next + AHEAD * this.speed) * this.rate);
            if (last <= first) break;
            const source = this.out.context.createBufferSource();
            source.buffer = this.piece(first, last);
            source.playbackRate.value = this.speed;
            source.connect(this.out.gain);
            source.start(this.begun + (first / this.rate - this.from) / this.speed);
            source.onended = () => this.sources.splice(this.sources.indexOf(source), 1);
            this.sources.push(source);
            this.next = last / this.rate;
        }
    }

    stop() {
        for (const source of this.sources.splice(0)) ((source.onended = null), source.stop());
        ((this.on = false), (this.waits = false), (this.next = 0));
    }

    // what is heard now; null while nothing sounds
    position() {
        if (!this.on || !this.ready) return null;
        this.schedule();
        const now = this.from + (this.out.heard() - this.begun) * this.speed;
        if (this.waits || now < this.arrived) return Math.max(this.from, this.waits ? this.from : now);
        if (this.complete) this.stop();
        else ((this.waits = true), (this.from = this.arrived));
        return this.arrived;
    }

    // for the timeline's outline and its spectrum
    whole() {
        const size = this.parts.length ? this.parts[0].length / EARS : 0,
            length = Math.max(1, size * this.parts.length),
            out = new AudioBuffer({ length, sampleRate: this.rate }),
            data = out.getChannelData(0);
        this.parts.forEach((part, p) => {
            for (let i = 0; i < size; i++) data[p * size + i] = part[EARS * i] / 32767;
        });
        return out;
    }
}

// `on` is told: begun(piece), cut(piece, time), grown(piece), over(piece), text(event), trouble(text, the
// line that it answers, if any), restored(line), unkept(line), saved(name, bytes), ended(why), which is "taken", "refused" or "lost"
export class Piece {
    // `key` is that of himc-viewer's channel, or opens another one
    constructor(key, sound, on) {
        ((this.on = on), (this.device = sound), (this.rest = new Uint8Array()));
        ((this.scene = null), (this.sound = null), (this.text = null));
        ((this.turn = Promise.resolve()), (this.cuts = 0), (this.key = key));
        this.open();
    }

    // asks to edit; whichever page does so last edits
    open() {
        const { key } = this,
            socket = (this.socket = typeof key === "function" ? key() : new WebSocket(`ws://${location.host}/edit/${key}`, "edit"));
        let opened = false;
        this.rest = new Uint8Array();
        socket.binaryType = "arraybuffer";
        socket.onopen = () => (opened = true);
        socket.onmessage = e => (typeof e.data === "string" ? this.told(JSON.parse(e.data)) : this.hear(new Uint8Array(e.data)));
        socket.onclose = e => this.on.ended(e.code === TAKEN ? "taken" : opened ? "lost" : "refused");
    }

    // ends the channel of a program that cannot be reached, which would be noticed much later
    leave() {
        if (this.socket.readyState >= WebSocket.CLOSING) return;
        this.socket.onclose = this.socket.onmessage = null;
        this.socket.close();
        this.on.ended("lost");
    }

    get live() {
        return this.socket.readyState === WebSocket.OPEN;
    }

    say(line) {
        if (this.live) this.socket.send(line);
    }

    look(time, hand) {
        if (this.live) this.socket.look?.(time, hand);
    }

    // of the source without its ending, as long as a saved file's may be
    get stem() {
        let stem = this.text.source.split("/").pop().replace(/(.)\.[^.]*$/, "$1");
        while (new TextEncoder().encode(stem).length > NAME) stem = stem.slice(0, -1);
        return stem;
    }

    // a score, a MIDI file or a take, to be edited from now on
    async send(file) {
        if (!this.live) throw new Error(`${file.name}: himc-viewer cannot be reached by this page`);
        if (file.size > MOST) throw new Error(`${file.name}: larger than ${MOST >> 20} MB`);
        const name = new TextEncoder().encode(`${file.name}\0`),
            message = new Uint8Array(name.length + file.size);
        message.set(name);
        message.set(new Uint8Array(await file.arrayBuffer()), name.length);
        this.socket.send(message);
    }

    // what himc-viewer itself says: another program begins, and how many pieces were before it, or are after
    // it; or a file that was dropped is refused
    told(event) {
        if (event.event === "begun") Object.assign(this, { rest: new Uint8Array(), before: event.before, after: event.after });
        else this.on.trouble(event.text);
    }

    hear(bytes) {
        const all = new Uint8Array(this.rest.length + bytes.length);
        (all.set(this.rest), all.set(bytes, this.rest.length));
        const view = new DataView(all.buffer),
            text = new TextDecoder();
        let at = 0;
        for (let size; at + 8 <= all.length; at += 8 + size) {
            size = view.getUint32(at + 4, true);
            if (at + 8 + size > all.length) break;
            const kind = text.decode(all.subarray(at, at + 4)),
                body = all.slice(at + 8, at + 8 + size);
            this.turn = this.turn
                .then(() => this.take(kind, body))
                .catch(error => this.on.trouble(error.message));
        }
        this.rest = all.slice(at);
    }

    async take(kind, bytes) {
        const view = new DataView(bytes.buffer);
        if (kind === "edit") this.event(JSON.parse(new TextDecoder().decode(bytes)));
        else if (kind === "from") this.cut(view.getFloat64(0, true));
        else if (kind === "json") JSON.parse(new TextDecoder().decode(await inflate(bytes))).forEach(e => this.add(e));
        else if (kind === "rows") this.scene.rows(await inflate(bytes));
        else if (kind === "head") this.scene.heads(await inflate(bytes));
        else if (kind === "pcm ") this.hearPart(bytes);
        else if (kind === "over") {
            ((this.sound.complete = true), (this.over = true));
            this.on.over(this);
        } else if (kind === "file") {
            const name = new TextDecoder().decode(bytes.subarray(0, 64)).replace(/\0.*$/s, "");
            this.on.saved(name, bytes.subarray(64));
        }
    }

    event(event) {
        if (event.event === "text") {
            for (const s of event.statements) s.words = s.words.trim().replace(/\s+/g, " ");
            if (event.begun) ((this.fresh = true), (this.over = false)); // all is to come
            this.on.text((this.text = event));
        } else if (event.event === "restored") this.on.restored(event.text);
        else if (event.event === "unkept") this.on.unkept(event.text);
        else this.on.trouble(event.text, event.line);
    }

    cut(time) {
        ((this.over = false), this.cuts++);
        if (this.fresh) {
            this.sound?.stop();
            this.scene = new Scene(this.text.source.split("/").pop());
            ((this.sound = null), (this.fresh = false));
        } else {
            this.scene.cut(time);
            this.sound?.cut(time);
        }
        this.on.cut(this, time);
    }

    add(event) {
        if (event.event !== "strike" || !this.scene.has(event)) this.scene.add(event);
    }

    // the last of each step's messages
    hearPart(bytes) {
        const { scene } = this,
            begins = !this.sound;
        scene.finish();
        this.sound ??= new PieceSound(this.device, scene.head.sound);
        this.sound.add(new Int16Array(bytes.buffer, 12));
        if (begins) this.on.begun(this);
        this.on.grown(this);
    }

    // when a nudge is, in the take
    static takeTime(time) {
        return time - APPROACH;
    }

    // the nudges of a take as what can be chosen, by their times in the scene
    get nudges() {
        const all = this.text?.take ? this.text.statements.filter(s => s.words.startsWith("nudge ")) : [];
        return all.map(statement => {
            const [, hand, time] = statement.words.split(" ");
            return { take: true, hand, time: Number(time) + APPROACH, statement, index: statement.index };
        });
    }
}
