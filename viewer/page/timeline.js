// The timeline of a playback: strokes, heights of the sticks, forces, sound, all over one axis of
// time. The lanes are drawn once for a view; a frame adds the cursor. Sizes and colours: chosen by
// eye. Times in milliseconds.
import { listen } from "./sound.js";
import { before } from "./scene.js";
import { spectrogram } from "./spectrum.js";

export const handColor = ["#7fd6ff", "#ffb066"];
export const supportColor = ["#f2e3bd", ...handColor]; // seat, left foot, right foot
export const nuanceColor = {
    legato: "#8fd0ff",
    tenuto: "#b7e08a",
    accent: "#ff9a6a",
    "vertical-accent": "#ff6f8e",
    staccato: "#ffd76a",
};
export const MISSED = "#ff5a4d"; // a stroke that is not played
const STRONGEST = 150, // tallest stroke (N); a forte stroke
    NEAR = [6, 14], // a click this near to a stroke jumps to it, by mouse, by finger (pixels)
    GRIP = [9, 20], // a press this near to a chosen stroke's mark takes hold of it (pixels)
    YELLOW = "#ffd21f",
    SLIPS = 0.8, // friction at which a foot slips, the seat at less
    SHORTEST = 100, // of a view (ms)
    BUCKETS = 400; // of the sound's outline, each second
// what is shown, and its share of the height; all of it if more lanes are wanted, and there is the height
// that a lane needs (pixels)
const LANES = [
        { name: "beats", share: 12 },
        { name: "strokes", share: 30 },
        { name: "height", share: 22 },
        { name: "force", share: 14, least: 100 },
        { name: "sound", share: 22 },
    ],
    MORE = [
        ...LANES,
        { name: "angle", share: 34 },
        { name: "torque", share: 34 },
        { name: "spectrum", share: 40 },
        // of one who sits freely
        { name: "support", share: 34, sits: true, least: 150 },
        { name: "friction", share: 22, sits: true, least: 260 },
    ];
const AXES = ["#ff8f8f", "#8fe08f", "#8fb8ff"], // x, y, z
    CURVES = { angle: ["", "rad"], torque: ["_torque", "n_m"] }, // of a joint: its columns' names
    USUAL = "right-wrist"; // the joint before one is chosen

// least and largest sample of each bucket
function outline(buffer) {
    const size = buffer.sampleRate / BUCKETS,
        samples = new Float32Array(Math.ceil(size)),
        count = Math.floor(buffer.length / size),
        out = new Float32Array(2 * count);
    for (let i = 0; i < count; i++) {
        let low = 0,
            high = 0;
        for (const v of listen(buffer, Math.floor(i * size), samples)) {
            if (v < low) low = v;
            if (v > high) high = v;
        }
        ((out[2 * i] = low), (out[2 * i + 1] = high));
    }
    return out;
}

const finger = e => (e.pointerType === "touch" ? 1 : 0);
const digits = ms => (ms < 100 ? 3 : ms < 1000 ? 2 : ms < 10000 ? 1 : 0);

export class Timeline {
    constructor(canvas, actions) {
        ((this.canvas = canvas), (this.actions = actions), (this.ink = canvas.getContext("2d")));
        this.lanes = document.createElement("canvas");
        ((this.playback = null), (this.view = [0, 1]), (this.stale = true), (this.hover = null));
        ((this.all = false), (this.joint = USUAL));
        this.pointers = new Map();
        const on = (name, f) => canvas.addEventListener(name, f, { passive: false });
        on("pointerdown", e => this.press(e));
        on("pointermove", e => this.move(e));
        for (const name of ["pointerup", "pointercancel"]) on(name, e => this.release(e));
        on("keydown", e => this.key(e));
        on("pointerleave", () => (this.hover = null));
        on("dblclick", () => this.show(0, this.playback?.length));
        on("wheel", e => {
            e.preventDefault();
            const pan = e.shiftKey ? e.deltaY : e.deltaX;
            if (Math.abs(pan) > Math.abs(e.shiftKey ? 0 : e.deltaY)) this.pan(pan);
            else this.zoom(Math.exp(0.0015 * e.deltaY), this.time(e));
        });
    }

    open(playback) {
        ((this.playback = playback), (this.waves = null));
        ((this.range = undefined), (this.loudest = undefined));
        ((this.buffer = null), (this.picture = null), (this.extent = new Map()));
        this.show(0, playback.length);
    }

    heard(buffer) {
        this.waves = buffer && outline(buffer);
        this.buffer = buffer;
        this.analyse();
        this.stale = true;
    }

    // what follows that time (s) will be another sound
    cut(time) {
        this.waves = this.waves?.slice(0, 2 * Math.floor(time * BUCKETS)) ?? null;
        this.stale = true;
    }

    // more of the piece has come, or other
    grown() {
        const { playback } = this,
            all = this.view[0] === 0 && this.view[1] >= (this.length ?? 0);
        ((this.range = undefined), (this.extent = new Map()), (playback.scene.tipHeights = playback.scene.carriers = null));
        this.length = playback.length;
        if (all) this.show(0, playback.length);
        this.stale = true;
    }

    // shows angles, torques and spectrum as well, or not
    more() {
        this.all = !this.all;
        this.stale = true;
        this.analyse();
        return this.all;
    }

    // the joint whose angles and torques are shown
    select(joint) {
        ((this.joint = joint), (this.stale = true));
    }

    analyse() {
        const { buffer } = this;
        if (!buffer || !this.all || this.analysed === buffer) return;
        this.analysed = buffer;
        spectrogram(buffer, () => this.buffer === buffer).then(
            picture => picture && ((this.picture = picture), (this.stale = true)),
        );
    }

    show(from, to) {
        const length = this.playback ? this.playback.length : 1,
            span = Math.min(length, Math.max(SHORTEST, to - from));
        from = Math.min(length - span, Math.max(0, from));
        this.view = [from, from + span];
        this.stale = true;
    }

    zoom(factor, at = this.playback.at) {
        const [from, to] = this.view;
        this.show(at - (at - from) * factor, at + (to - at) * factor);
    }

    pan(pixels) {
        const [from, to] = this.view,
            by = (pixels * (to - from)) / this.canvas.clientWidth;
        this.show(from + by, to + by);
    }

    x(time) {
        const [from, to] = this.view;
        return ((time - from) / (to - from)) * this.canvas.clientWidth;
    }

    time(e) {
        const box = this.canvas.getBoundingClientRect(),
            [from, to] = this.view;
        return from + ((e.clientX - box.left) / box.width) * (to - from);
    }

    // the stroke, nudge or push under the pointer
    near(e) {
        if (!this.playback) return null;
        const at = this.time(e),
            list = this.playback.scene.strikes,
            i = before(list, at / 1000, s => s.time);
        return (
            [...this.actions.marks, ...this.playback.scene.missed, list[i], list[i + 1]]
                .filter(s => s && Math.abs(this.x(1000 * s.time) - this.x(at)) < NEAR[finger(e)])
                .sort((a, b) => Math.abs(1000 * a.time - at) - Math.abs(1000 * b.time - at))[0] ?? null
        );
    }

    // whether the pointer is at the chosen stroke's mark, in the lanes of beats and strokes
    grips(e) {
        const mark = this.actions.when?.mark,
            box = this.canvas.getBoundingClientRect(),
            sum = this.shown.reduce((all, { share }) => all + share, 0),
            low = ((LANES[0].share + LANES[1].share) / sum) * box.height;
        return (
            !!mark &&
            e.clientY - box.top < low &&
            Math.abs(this.x(mark.time) - (e.clientX - box.left)) < GRIP[finger(e)]
        );
    }

    press(e) {
        if (!this.playback) return;
        this.canvas.setPointerCapture(e.pointerId);
        this.pointers.set(e.pointerId, e.clientX);
        this.begun = this.time(e);
        this.held = this.pointers.size === 1 && !e.shiftKey && this.grips(e);
        if (this.pointers.size === 1 && !e.shiftKey && !this.held) this.scrub(e);
    }

    move(e) {
        this.hover = this.near(e);
        this.canvas.style.cursor = this.held || this.grips(e) ? "ew-resize" : "";
        if (this.held) return this.actions.when.move(this.time(e) / 1000);
        const was = this.pointers.get(e.pointerId);
        if (was === undefined) return;
        if (this.pointers.size === 2) {
            const other = [...this.pointers].find(([id]) => id !== e.pointerId)[1];
            this.zoom(Math.abs(was - other) / Math.max(1, Math.abs(e.clientX - other)), this.time(e));
        } else if (e.shiftKey) this.actions.loop(this.begun, this.time(e));
        else this.scrub(e);
        this.pointers.set(e.pointerId, e.clientX);
    }

    release(e) {
        this.pointers.delete(e.pointerId);
        if (this.held) this.actions.when[e.type === "pointerup" ? "drop" : "stay"]();
        this.held = false;
    }

    // enter chooses the stroke at the cursor, in a take the point there of a path
    key(e) {
        if (e.key !== "Enter" || !this.playback) return;
        if (this.actions.when?.take) return this.actions.pickAt(this.playback.at / 1000);
        const apart = s => Math.abs(1000 * s.time - this.playback.at),
            [first, ...rest] = this.playback.scene.strikes;
        if (first) this.actions.pick(rest.reduce((a, b) => (apart(b) < apart(a) ? b : a), first));
    }

    scrub(e) {
        const strike = this.near(e);
        this.actions.seek(strike ? 1000 * strike.time : this.time(e));
        if (strike) this.actions.pick(strike);
    }

    // --- the lanes

    get shown() {
        const sits = this.playback?.scene.sits,
            fits = ({ sits: needed, least = 0 }) => (sits || !needed) && this.canvas.clientHeight >= least;
        return (this.all ? MORE : LANES).filter(fits);
    }

    redraw(w, h, ratio) {
        const { lanes, shown } = this,
            c = lanes.getContext("2d");
        ((lanes.width = Math.round(w * ratio)), (lanes.height = Math.round(h * ratio)));
        c.setTransform(ratio, 0, 0, ratio, 0, 0);
        c.font = "11px system-ui, sans-serif";
        const sum = shown.reduce((all, { share }) => all + share, 0);
        let top = 0;
        for (const { name, share } of shown) {
            const tall = (share / sum) * h;
            c.save();
            c.translate(0, top);
            this[name](c, w, tall);
            c.restore();
            top += tall;
        }
        this.stale = false;
    }

    label(c, text, y) {
        c.fillStyle = "rgba(255,255,255,0.6)";
        c.fillText(text, 4, y);
    }

    beats(c, w, h) {
        const { scene } = this.playback,
            [from, to] = this.view,
            span = to - from,
            step = [1, 2, 5, 10, 20, 50, 100, 200, 500]
                .flatMap(n => [n, 1000 * n])
                .sort((a, b) => a - b)
                .find(s => (s / span) * w > 70);
        c.fillStyle = "rgba(255,255,255,0.7)";
        for (let t = Math.ceil(from / step) * step; t <= to; t += step)
            c.fillText(`${(t / 1000).toFixed(digits(step))} s`, this.x(t) + 3, Math.max(10, h - 4));
        const apart = scene.beats.length > 1 ? (this.playback.length / scene.beats.length / span) * w : w;
        c.fillStyle = "rgba(255,255,255,0.13)";
        for (const b of scene.beats)
            if (apart > 5 || b.beat % 4 === 0) c.fillRect(this.x(1000 * b.time), 0, 1, 999);
    }

    strokes(c, w, h) {
        const mid = h / 2;
        c.fillStyle = "rgba(255,255,255,0.1)";
        c.fillRect(0, mid - 0.5, w, 1);
        this.label(c, "L", mid - 4);
        this.label(c, "R", mid + 12);
        for (const s of this.playback.scene.strikes) {
            const x = this.x(1000 * s.time),
                tall = 3 + (mid - 6) * Math.min(1, Math.sqrt(s.force / STRONGEST)),
                up = s.hand === "left";
            if (x < -4 || x > w + 4) continue;
            c.fillStyle = nuanceColor[s.nuance] || "#d8d8e0";
            c.fillRect(x - 1, up ? mid - tall : mid, 2, tall);
            c.beginPath();
            c.arc(x, up ? mid - tall : mid + tall, 2.6, 0, 7);
            c.fill();
        }
        // a cross where a stroke should have been
        c.strokeStyle = MISSED;
        c.lineWidth = 2;
        for (const s of this.playback.scene.missed) {
            const x = this.x(1000 * s.time),
                y = s.hand === "left" ? mid / 2 : (3 * mid) / 2;
            c.beginPath();
            (c.moveTo(x - 4, y - 4), c.lineTo(x + 4, y + 4), c.moveTo(x - 4, y + 4), c.lineTo(x + 4, y - 4));
            c.stroke();
        }
        c.lineWidth = 1;
    }

    // the joint's three columns of that kind, and the largest value in them; null where there are none
    curve(kind) {
        const { scene } = this.playback,
            [what, unit] = CURVES[kind],
            names = ["x", "y", "z"].map(axis => `${this.joint}${what}_${axis}_${unit}`);
        if (!names.every(name => scene.column.has(name))) return null;
        if (!this.extent.has(names[0])) {
            let most = 0;
            for (const name of names)
                for (let row = 0; row < scene.times.length; row++)
                    most = Math.max(most, Math.abs(scene.value(row, name)));
            this.extent.set(names[0], most);
        }
        return { names, most: this.extent.get(names[0]) };
    }

    // a line from the least to the largest value of the rows under each pixel
    line(c, w, color, value, y) {
        const { times } = this.playback.scene,
            [from, to] = this.view;
        c.strokeStyle = color;
        c.beginPath();
        let row = Math.max(0, before(times, from / 1000) - 1);
        for (let x = 0; x < w && row < times.length; x++) {
            const end = (from + ((x + 1) / w) * (to - from)) / 1000;
            if (times[row] > end) continue;
            let [low, high] = [Infinity, -Infinity];
            for (; row < times.length && times[row] <= end; row++) {
                const v = value(row);
                ((low = Math.min(low, v)), (high = Math.max(high, v)));
            }
            (c.lineTo(x, y(low)), c.lineTo(x, y(high)));
        }
        c.stroke();
    }

    curves(c, w, h, kind, unit) {
        const curve = this.curve(kind),
            { scene } = this.playback;
        if (curve && curve.most > 0)
            curve.names.forEach((name, axis) =>
                this.line(c, w, AXES[axis], r => scene.value(r, name), v => h / 2 - (v / curve.most) * (h / 2 - 3)),
            );
        const most = curve && curve.most > 0 ? `± ${curve.most.toPrecision(3)} ${unit}` : "none";
        this.label(c, `${this.joint.replace("-", " ")}: ${kind}, ${most}`, 11);
        AXES.forEach((color, axis) => {
            c.fillStyle = color;
            c.fillText("xyz"[axis], w - 36 + 11 * axis, 11);
        });
    }

    angle(c, w, h) {
        this.curves(c, w, h, "angle", "rad");
    }

    torque(c, w, h) {
        this.curves(c, w, h, "torque", "N m");
    }

    spectrum(c, w, h) {
        const { picture } = this;
        if (picture) {
            const [from, to] = this.view.map(t => (t / 1000 / this.buffer.duration) * picture.width);
            c.drawImage(picture, from, 0, to - from, picture.height, 0, 1, w, h - 1);
        }
        this.label(c, "50 Hz to 4 kHz", 11);
    }

    height(c, w, h) {
        const both = this.playback.scene.heights();
        this.range ??= both.reduce(
            ([low, high], list) => list.reduce(([l, g], v) => [Math.min(l, v), Math.max(g, v)], [low, high]),
            [Infinity, -Infinity],
        );
        const [low, high] = this.range;
        this.label(c, "height", 11);
        both.forEach((list, hand) =>
            this.line(c, w, handColor[hand], r => list[r], v => h - 3 - ((h - 6) * (v - low)) / (high - low)),
        );
    }

    force(c, w, h) {
        const { scene } = this.playback;
        this.label(c, "force", 11);
        ["left", "right"].forEach((hand, i) =>
            this.line(
                c,
                w,
                handColor[i],
                r => scene.value(r, `${hand}_force_n`),
                v => h - 2 - (h - 4) * Math.min(1, Math.sqrt(v / STRONGEST)),
            ),
        );
    }

    // one line for each of seat, left and right foot, as high as `share` (0 .. 1) of what is in its list
    carriers(c, w, h, lists, share) {
        supportColor.forEach((color, part) =>
            this.line(c, w, color, r => lists[part][r], v => h - 2 - (h - 4) * Math.min(1, share(v))),
        );
        ["seat", "left foot", "right foot"].reduceRight((x, text, part) => {
            c.fillStyle = supportColor[part];
            c.fillText(text, x - c.measureText(text).width, 11);
            return x - c.measureText(text).width - 8;
        }, w - 4);
    }

    support(c, w, h) {
        const { up, most } = this.playback.scene.carried();
        this.carriers(c, w, h, up, newtons => Math.sqrt(Math.max(0, newtons) / most));
        this.label(c, `support, up to ${most.toFixed(0)} N`, 11);
    }

    friction(c, w, h) {
        this.carriers(c, w, h, this.playback.scene.carried().friction, needed => needed / SLIPS);
        this.label(c, `friction, up to ${SLIPS}`, 11);
    }

    sound(c, w, h) {
        this.label(c, "sound", 11);
        if (!this.waves) return;
        const mid = h / 2,
            [from, to] = this.view,
            bucket = x => Math.floor(((from + (x / w) * (to - from)) / 1000) * BUCKETS);
        this.loudest ??= this.waves.reduce((most, v) => Math.max(most, Math.abs(v)), 1e-6);
        const scale = (mid - 1) / this.loudest;
        c.fillStyle = "#9fb0c8";
        for (let x = 0; x < w; x++) {
            let low = 0,
                high = 0;
            for (let i = bucket(x); i <= bucket(x + 1) && 2 * i + 1 < this.waves.length; i++) {
                low = Math.min(low, this.waves[2 * i]);
                high = Math.max(high, this.waves[2 * i + 1]);
            }
            c.fillRect(x, mid - scale * high, 1, Math.max(1, scale * (high - low)));
        }
    }

    // --- a frame

    draw() {
        const p = this.playback,
            w = this.canvas.clientWidth,
            h = this.canvas.clientHeight,
            ratio = Math.min(devicePixelRatio || 1, 2);
        if (!p || !w) return;
        if (p.playing && (p.at > this.view[1] || p.at < this.view[0]) && !this.pointers.size)
            this.show(p.at, p.at + this.view[1] - this.view[0]);
        const size = `${w} ${h} ${ratio}`;
        if (this.stale || size !== this.size) {
            ((this.size = size), (this.canvas.width = Math.round(w * ratio)));
            this.canvas.height = Math.round(h * ratio);
            this.redraw(w, h, ratio);
        }
        const c = this.ink;
        c.setTransform(1, 0, 0, 1, 0, 0);
        c.clearRect(0, 0, this.canvas.width, this.canvas.height);
        c.drawImage(this.lanes, 0, 0);
        c.setTransform(ratio, 0, 0, ratio, 0, 0);
        if (p.loop) {
            const [a, b] = p.loop.map(t => this.x(t));
            c.fillStyle = "rgba(255,210,31,0.14)";
            c.fillRect(a, 0, b - a, h);
            c.fillStyle = "#ffd21f";
            (c.fillRect(a, 0, 1, h), c.fillRect(b, 0, 1, h));
        }
        c.fillStyle = "#fff";
        c.fillRect(this.x(p.at) - 0.75, 0, 1.5, h);
        c.fillStyle = YELLOW;
        for (const { time } of this.actions.marks) c.fillRect(this.x(1000 * time) - 1, 0, 2, h / 4);
        const mark = this.actions.when?.mark;
        if (mark) this.mark(c, mark, w, h);
        else if (this.hover) this.tell(c, this.hover, w);
    }

    // the chosen stroke, and where it goes
    mark(c, { time, from, moves, name }, w, h) {
        const x = this.x(time);
        c.fillStyle = "rgba(255,255,255,0.5)";
        if (moves) c.fillRect(this.x(from) - 0.5, 0, 1, h);
        c.fillStyle = YELLOW;
        c.fillRect(x - 1, 0, 2, h);
        c.beginPath();
        (c.moveTo(x - 9, 7), c.lineTo(x - 3, 1), c.lineTo(x + 3, 1), c.lineTo(x + 9, 7));
        (c.lineTo(x + 3, 13), c.lineTo(x - 3, 13), c.fill());
        this.write(c, name, x + 4, w, h - 22);
    }

    tell(c, s, w) {
        const beat = Number.isFinite(s.beat) ? ` · beat ${+s.beat.toFixed(3)}` : "",
            text = s.statement ? s.statement.words : s.why ? `${s.hand} ${s.nuance} · ${s.drum} · not played: ${s.why}${beat}` : `${s.hand} ${s.nuance} · ${s.drum} · ${s.force.toFixed(0)} N${beat}`;
        this.write(c, text, this.x(1000 * s.time), w, 2);
    }

    write(c, text, at, w, y) {
        c.font = "12px system-ui, sans-serif";
        const wide = c.measureText(text).width + 12,
            x = Math.min(w - wide, Math.max(0, at + 8));
        c.fillStyle = "#22232bf2";
        c.fillRect(x, y, wide, 20);
        c.fillStyle = "#fff";
        c.fillText(text, x + 6, y + 14);
    }
}
