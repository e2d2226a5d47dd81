// A scene (docs/scene.md): the recording of a performance. Reads it, and says where everything was
// at any time. Times are in seconds, as in the file.
import { HANDS, bone, forward, place, quaternion } from "./body.js";
import { Frames, Rows } from "./rows.js";
import { segments } from "./skeleton.js";

const MAGIC = "himcscn",
    VERSION = 1;

// the budget of a file, as in recording.c
const LARGEST = 64 << 20, // of an unpacked chunk (bytes); chosen: a second of a scene is 200 kB
    MOST = 2 ** 32, // of all of a scene (bytes); chosen: some hours
    ITEMS = 2 ** 23; // rows, frames of heads and values of events; chosen: 5 hours
const axes = (name, unit) => [..."xyz"].map(axis => `${name}_${axis}_${unit}`),
    PELVIS = axes("pelvis_position", "m"),
    SUPPORT = ["seat_force", "left_foot_force", "right_foot_force"].flatMap(name => axes(name, "n")),
    CENTER = axes("root_center", "m"),
    SUPPORTS = [...SUPPORT, ...CENTER],
    TARGETS = HANDS.flatMap(hand => axes(`${hand}_target`, "m")),
    PRESSES = 20; // the least force that friction is told of (N); chosen: a foot that rests
export const DRUMS = 32; // as many as himc-viewer keeps
const SLICE = 30, // of work, then the page draws itself (ms); chosen: it answers at once
    PART = 1024; // rows between two looks at the clock; chosen: some ms

// A few bytes may stand for a thousand times as many, so no more than `most` are unpacked.
export async function inflate(bytes, most = LARGEST) {
    const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate")).getReader(),
        parts = [];
    let size = 0;
    for (let got; !(got = await reader.read()).done;) {
        if ((size += got.value.length) > most) {
            reader.cancel().catch(() => {});
            throw new Error(`a chunk of more than ${most} bytes`);
        }
        parts.push(got.value);
    }
    const out = new Uint8Array(size);
    size = 0;
    for (const part of parts) (out.set(part, size), (size += part.length));
    return out;
}

// last index of the sorted list whose time is not after `time`, -1 if there is none
export function before(list, time, of = x => x) {
    let low = 0,
        high = list.length;
    while (low < high) {
        const middle = (low + high) >> 1;
        if (of(list[middle]) <= time) low = middle + 1;
        else high = middle;
    }
    return low - 1;
}

const finite = (...values) => values.every(Number.isFinite);
const wanted = {
    scene: e => Array.isArray(e.columns) && e.columns.length > 0 && e.columns.every(([n, s]) => typeof n === "string" && s > 0),
    body: e =>
        e.segments.length === segments.length &&
        e.segments.every((s, i) => s.name === segments[i].name && finite(...s.origin)) &&
        e.tips.length === HANDS.length &&
        finite(...e.tips.flat()),
    drum: e => finite(e.drum, ...e.place) && typeof e.name === "string" && (e.place.length === 5 || e.place.length === 7) && e.place[4] > 0.02 && e.place[4] < 2,
    modes: e =>
        e.modes.every(([hz, decay]) => hz > 0 && decay >= 0 && decay < 7 * hz) &&
        e.shapes.every(([shape, mode, part]) => shape >= 0 && shape < 64 && mode in e.modes && finite(part)),
    strike: e => (HANDS.includes(e.hand) || e.hand === "foot") && finite(e.x, e.y, e.force),
    missed: e => HANDS.includes(e.hand) && finite(e.x, e.y, e.due) && typeof e.why === "string",
    beat: e => finite(e.beat),
};

export class Scene {
    constructor(name) {
        this.name = name;
        ((this.head = null), (this.end = 0), (this.score = []));
        ((this.bodies = []), (this.drums = new Map()), (this.strikes = []), (this.missed = []));
        ((this.beats = []), (this.notes = []), (this.sounds = []), (this.ghosts = []));
        ((this.times = []), (this.blocks = []), (this.column = new Map()));
        this.local = new Float64Array(4 * segments.length);
        this.sits = false; // seat or floor carry him somewhere
        ((this.ahead = new Float64Array(4)), (this.root = new Float64Array(3)));
    }

    // An event in the order of time; one that is not as it should be is a fault of the file.
    add(event) {
        const check = wanted[event.event];
        if (!finite(event.time) || (check && !check(event)))
            throw new Error(`${this.name}: a faulty ${event.event}`);
        if (event.event === "scene") {
            if (this.head && JSON.stringify(this.head.columns) !== JSON.stringify(event.columns))
                throw new Error(`${this.name}: a second scene with other columns`);
            this.head = event;
            event.columns.forEach(([name], i) => this.column.set(name, i));
        } else if (event.event === "body") this.bodies.push(event);
        else if (event.event === "drum") this.drum(event.drum, event).changes.push(event);
        else if (event.event === "modes") this.drum(event.drum).modes.push(event);
        else if (event.event === "strike") this.strikes.push({ ...event, from: this.name });
        // as a strike that should have been; `told`: when
        else if (event.event === "missed") this.missed.push({ ...event, force: 0, time: event.due, told: event.time });
        else if (event.event === "beat") this.beats.push(event);
        else if (event.event === "note") this.notes.push(event);
        else if (event.event === "score") this.score = event.lines;
        else if (event.event === "end") this.end = event.time;
    }

    drum(number, event) {
        if (!this.drums.has(number)) {
            if (this.drums.size === DRUMS) throw new Error(`${this.name}: more than ${DRUMS} drums`);
            this.drums.set(number, { changes: [], modes: [], frames: new Frames() });
        }
        return Object.assign(this.drums.get(number), event && { name: event.name });
    }

    rows(bytes) {
        const view = new DataView(bytes.buffer),
            start = view.getFloat64(0, true),
            period = view.getFloat64(8, true),
            count = view.getUint32(16, true),
            columns = this.head.columns.length;
        if (!finite(start, period) || bytes.length !== 20 + 4 * columns * count)
            throw new Error(`${this.name}: faulty rows`);
        const block = new Rows(this.times.length, count, columns, bytes, 20);
        this.blocks.push(block);
        this.sits ||= SUPPORT.some(name => this.column.has(name) && !block.empty(this.column.get(name)));
        for (let i = 0; i < count; i++) this.times.push(start + i * period);
    }

    // motion of heads
    heads(bytes) {
        const view = new DataView(bytes.buffer);
        for (let i = view.getUint32(0, true), at = 4; i > 0; i--)
            at = this.drum(view.getUint16(at + 12, true)).frames.add(bytes, view, at);
    }

    // forgets all from `time` on
    cut(time) {
        const past = e => e.time < time - 1e-9;
        this.times.length = before(this.times, time - 1e-6) + 1;
        ((this.blocks = this.blocks.filter(b => b.first < this.times.length)), (this.near = null));
        const last = this.blocks[this.blocks.length - 1];
        if (last) last.count = Math.min(last.count, this.times.length - last.first);
        for (const name of ["bodies", "strikes", "beats", "notes"]) this[name] = this[name].filter(past);
        this.missed = this.missed.filter(e => past({ time: e.told }));
        for (const drum of this.drums.values()) {
            for (const part of ["changes", "modes"]) drum[part] = drum[part].filter(past);
            drum.frames.keep(drum.frames.times.filter(t => past({ time: t })).length);
        }
        this.end = this.times.length ? this.times[this.times.length - 1] : 0;
        this.tipHeights = this.carriers = null;
    }

    // whether that contact, which a cut has halved, is there
    has(strike) {
        return this.strikes.some(s => s.hand === strike.hand && Math.abs(s.time - strike.time) < 1e-6);
    }

    // once all is read
    finish() {
        const last = this.times.length ? this.times[this.times.length - 1] : 0;
        this.end = Math.max(this.end, last);
        if (!this.head || !this.times.length || !this.bodies.length)
            throw new Error(`${this.name}: nothing is in it`);
        for (const body of this.bodies)
            body.origin = Float64Array.from(body.segments.flatMap(s => s.origin));
        this.strikes.sort((a, b) => a.time - b.time);
        const blows = new Map();
        for (const strike of this.strikes) {
            if (!blows.has(strike.drum)) blows.set(strike.drum, []);
            blows.get(strike.drum).push(strike);
        }
        for (const drum of this.drums.values()) drum.blows = blows.get(drum.name) ?? [];
        this.joints = segments.map(s => this.column.get(`${s.joint || s.name}_x_rad`));
        if (this.joints.some(c => c + 2 >= this.head.columns.length)) throw new Error(`${this.name}: faulty columns`);
    }

    // the row at or before `time`, and how far it is to the next (0 .. 1)
    at(time) {
        const i = Math.max(0, before(this.times, time)),
            a = this.times[i],
            b = this.times[i + 1];
        return [i, b > a ? Math.min(1, Math.max(0, (time - a) / (b - a))) : 0];
    }

    // that of the row before, nearly always
    block(row) {
        const near = this.near;
        if (near && row >= near.first && row < near.first + near.count) return near;
        return (this.near = this.blocks[before(this.blocks, row, b => b.first)]);
    }

    value(row, name) {
        const c = this.column.get(name),
            block = this.block(row);
        return c === undefined ? 0 : block.column(c)[row - block.first] * this.head.columns[c][1];
    }

    body(time) {
        return this.bodies[Math.max(0, before(this.bodies, time, b => b.time))];
    }

    rotation(row, segment, out, o) {
        const c = this.joints[segment],
            block = this.block(row),
            r = row - block.first,
            get = k => block.column(c + k)[r] * this.head.columns[c + k][1];
        if (c === undefined) quaternion(0, 0, 0, out, o);
        else quaternion(get(0), get(1), get(2), out, o);
    }

    // [x y z qw qx qy qz] of each segment at `time`
    pose(time, out) {
        const [row, t] = this.at(time),
            q = this.local,
            r = this.ahead;
        for (let i = 0; i < segments.length; i++) {
            const o = 4 * i;
            this.rotation(row, i, q, o);
            if (!t) continue;
            this.rotation(row + 1, i, r, 0);
            // along the chord: rows are so near that the arc differs by less than a rounding
            const dot = q[o] * r[0] + q[o + 1] * r[1] + q[o + 2] * r[2] + q[o + 3] * r[3],
                near = dot < 0 ? -t : t;
            let norm = 0;
            for (let k = 0; k < 4; k++) {
                q[o + k] += near * r[k] - t * q[o + k];
                norm += q[o + k] * q[o + k];
            }
            for (let k = 0; k < 4; k++) q[o + k] /= Math.sqrt(norm);
        }
        const { origin } = this.body(time);
        return forward(q, out, origin, this.column.has(PELVIS[0]) ? this.values(time, PELVIS, this.root) : origin);
    }

    // of these columns at `time`
    values(time, names, out) {
        const [row, t] = this.at(time);
        names.forEach((name, k) => {
            const a = this.value(row, name);
            out[k] = t ? a + t * (this.value(row + 1, name) - a) : a;
        });
        return out;
    }

    targets(time, out) {
        return this.values(time, TARGETS, out);
    }

    // forces of seat, left and right foot (N), and the centre of pressure on the plane of the seat (m), all
    // x y z; 0 of a pelvis that is fixed
    support(time, out) {
        return this.sits ? this.values(time, SUPPORTS, out) : out.fill(0);
    }

    // in each row, of seat, left and right foot: the force upwards (N), and the friction it needs, horizontal
    // over vertical force; once
    carried() {
        if (this.carriers) return this.carriers;
        const list = () => [0, 1, 2].map(() => new Float32Array(this.times.length)),
            [up, friction] = [list(), list()];
        for (let row = 0; row < this.times.length; row++)
            for (let part = 0; part < 3; part++) {
                const [x, y, z] = [0, 1, 2].map(k => this.value(row, SUPPORT[3 * part + k]));
                ((up[part][row] = z), (friction[part][row] = z > PRESSES ? Math.hypot(x, y) / z : 0));
            }
        return (this.carriers = { up, friction, most: Math.max(1, ...up.map(all => all.reduce((a, b) => Math.max(a, b), 0))) });
    }

    // the heights of both tips in each row (m), once
    heights() {
        if (!this.tipHeights) for (const part of this.measure()) void part;
        return this.tipHeights;
    }

    // computes them, in parts: yields how much is done (0 .. 1)
    *measure() {
        const out = HANDS.map(() => new Float32Array(this.times.length)),
            pose = new Float64Array(7 * segments.length),
            at = new Float64Array(3),
            sticks = HANDS.map(hand => 7 * bone(`${hand}-stick`));
        for (let i = 0; i < this.times.length; i++) {
            if (i % PART === 0) yield i / this.times.length;
            const time = this.times[i],
                tips = this.body(time).tips;
            this.pose(time, pose);
            sticks.forEach((s, hand) => {
                place(pose, s + 3, ...tips[hand], pose, s, at, 0);
                out[hand][i] = at[2];
            });
        }
        this.tipHeights = out;
    }

    // the beat at `time`, between the whole ones in proportion; null without any
    beat(time) {
        const i = before(this.beats, time, b => b.time);
        if (i < 0) return null;
        const a = this.beats[i],
            b = this.beats[i + 1];
        return b ? a.beat + ((b.beat - a.beat) * (time - a.time)) / (b.time - a.time) : a.beat;
    }
}

// What may still come of a file, the scenes in it included; and the pauses in which the page draws
// itself. `tell` is told what is done and how much of it (0 .. 1).
class Reading {
    constructor(tell) {
        ((this.bytes = MOST), (this.items = ITEMS), (this.tell = tell));
        this.begun = performance.now();
    }

    async pause(what, part) {
        if (performance.now() - this.begun < SLICE) return;
        this.tell?.(what, part);
        // a timer would wait for a second in a page that is not seen
        await new Promise(go => {
            const { port1, port2 } = new MessageChannel();
            port1.onmessage = () => (port1.close(), go());
            port2.postMessage(0);
        });
        this.begun = performance.now();
    }

    async unpack(packed) {
        const out = await inflate(packed, Math.min(this.bytes, LARGEST));
        this.bytes -= out.length;
        return out;
    }

    count(items) {
        if ((this.items -= items) < 0) throw new Error(`more than ${ITEMS} rows, frames of heads and values of events`);
    }
}

// of a list in JSON: each value but the first stands behind one of these
function values(text) {
    const [quote, escape, ...signs] = [...'"\\,[{'].map(c => c.charCodeAt(0)),
        [comma, list, object] = signs;
    let found = 0,
        quoted = false;
    for (let i = 0; i < text.length; i++) {
        const c = text[i];
        if (c === quote) quoted = !quoted;
        else if (quoted) i += c === escape ? 1 : 0;
        else if (c === comma || c === list || c === object) found++;
    }
    return found;
}

const u32 = (bytes, at) => new DataView(bytes.buffer, bytes.byteOffset, bytes.length).getUint32(at, true);

// a scene within a scene belongs to its `reading`, and has none in itself
export async function readScene(bytes, name, tell, reading) {
    const scene = new Scene(name),
        view = new DataView(bytes.buffer, bytes.byteOffset, bytes.length),
        text = new TextDecoder();
    if (text.decode(bytes.subarray(0, 7)) !== MAGIC)
        throw new Error(
            `${name}: expected a score (.txt), MIDI (.mid), MusicXML (.musicxml .mxl .xml), a take (.bvh .c3d .trc) or a scene (.himc), which himc render SOURCE -o SOUND.wav --scene FILE.himc makes`,
        );
    if (bytes[7] !== VERSION)
        throw new Error(`${name}: version ${bytes[7]} of scenes, this page reads ${VERSION}`);
    const outer = !reading;
    reading ??= new Reading(tell);
    const unpack = async (body, items) => {
        const out = await reading.unpack(body);
        reading.count(items(out));
        return out;
    };
    try {
        for (let at = 8; at < bytes.length;) {
            const kind = text.decode(bytes.subarray(at, at + 4)),
                size = view.getUint32(at + 4, true),
                body = bytes.subarray(at + 8, at + 8 + size);
            at += 8 + size;
            if (at > bytes.length) break; // a recording that was cut short is good up to here
            if (kind === "json") JSON.parse(text.decode(await unpack(body, values))).forEach(e => scene.add(e));
            else if (kind === "rows") scene.rows(await unpack(body, out => u32(out, 16)));
            else if (kind === "ring") scene.heads(await unpack(body, out => u32(out, 0)));
            else if (kind === "snd ") scene.sounds.push(body.slice()); // the file itself is not kept
            else if (kind === "more" && outer)
                scene.ghosts.push(await readScene(body, `${name}, ${scene.ghosts.length + 2}`, null, reading));
            if (outer) await reading.pause("reading", at / bytes.length);
        }
        scene.finish();
        if (outer) for (const part of scene.measure()) await reading.pause("measuring", part);
    } catch (error) {
        throw error.message.startsWith(name) ? error : new Error(`${name}: faulty (${error.message})`);
    }
    return scene;
}
