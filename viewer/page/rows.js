// What a scene keeps of its rows and of the motion of heads: nearly as few bytes as the file has, from
// which values are computed where they are asked for.
const RUN = 32, // rows whose differences take as many bytes as the largest of them; chosen
    PLANES = 4, // bytes of a difference, the lowest first
    DECODED = 24; // blocks whose values are kept; chosen: some seconds, a few MB

const recent = []; // the blocks that have values, the latest last

// The rows of a chunk (docs/scene.md). `bytes`: those of each column, from `at` on.
export class Rows {
    constructor(first, count, columns, bytes, at) {
        ((this.first = first), (this.count = this.length = count), (this.values = new Map()));
        this.runs = Math.ceil(count / RUN);
        this.width = new Uint8Array(columns * this.runs);
        this.begin = new Uint32Array(columns); // of a column, in `packed`
        const packed = new Uint8Array(PLANES * columns * count);
        let size = 0;
        for (let c = 0; c < columns; c++, at += PLANES * count) {
            this.begin[c] = size;
            for (let run = 0; run < this.runs; run++) {
                const from = RUN * run,
                    to = Math.min(count, from + RUN),
                    plane = k => bytes.subarray(at + k * count + from, at + k * count + to);
                let width = PLANES;
                while (width && plane(width - 1).every(b => !b)) width--;
                this.width[c * this.runs + run] = width;
                for (let k = 0; k < width; k++) (packed.set(plane(k), size), (size += to - from));
            }
        }
        this.packed = packed.slice(0, size);
    }

    // whether all values of a column are 0
    empty(c) {
        return this.width.subarray(c * this.runs, (c + 1) * this.runs).every(w => !w);
    }

    // the values of a column, in its steps
    column(c) {
        const known = this.values.get(c);
        if (known) return known;
        if (!this.values.size) {
            recent.push(this);
            if (recent.length > DECODED) recent.shift().values.clear();
        }
        const out = new Int32Array(this.length);
        let at = this.begin[c],
            value = 0,
            slope = 0;
        for (let run = 0; run < this.runs; run++) {
            const width = this.width[c * this.runs + run],
                to = Math.min(this.length, RUN * (run + 1)),
                size = to - RUN * run;
            for (let i = RUN * run; i < to; i++, at++) {
                let folded = 0;
                for (let k = 0; k < width; k++) folded |= this.packed[at + k * size] << (8 * k);
                slope = (slope + ((folded >>> 1) ^ -(folded & 1))) | 0;
                value = out[i] = (value + slope) | 0;
            }
            at += (width - 1) * size;
        }
        this.values.set(c, out);
        return out;
    }
}

// The motion of one head: where each frame is in its chunk.
export class Frames {
    constructor() {
        ((this.times = []), (this.chunks = []), (this.offsets = []));
    }

    // displacements of the modes, velocities over angular frequencies, as in the file; returns the end
    add(chunk, view, at) {
        const end = at + 16 + 2 * view.getUint16(at + 14, true);
        if (end > chunk.length) throw new Error("a frame of a head is cut short");
        this.times.push(view.getFloat64(at, true));
        (this.chunks.push(chunk), this.offsets.push(at));
        return end;
    }

    get(i) {
        const { buffer } = this.chunks[i],
            at = this.offsets[i],
            view = new DataView(buffer, at, 16),
            modes = view.getUint16(14, true),
            part = k => new Int8Array(buffer, at + 16 + k * modes, modes);
        return { time: this.times[i], scale: view.getFloat32(8, true), q: part(0), s: part(1) };
    }

    // the first `count`
    keep(count) {
        this.times.length = this.chunks.length = this.offsets.length = count;
    }
}
