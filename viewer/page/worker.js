// The performer in a page of its own: the library as WebAssembly (viewer/engine), in a Worker. A plain
// script: a page that is one file makes the Worker of its text, and the tests run it without a browser.
//
// The library finds its files in memory; of the calls of WASI it uses these sixteen, and no clock, no
// chance, no network. Sound goes straight to the audio thread, over a port that the page hands on; all
// else to the page, as frames of the viewer's stream.
const OK = 0,
    BADF = 8,
    EXIST = 20,
    NOENT = 44,
    ROOT = 3, // the descriptor of the folder, which is open at first
    CREATE = 1,
    EXCLUSIVE = 4,
    EMPTY = 8, // of what opens a file
    FILE = 4,
    FOLDER = 3; // kinds
const text = new TextDecoder(),
    bytesOf = new TextEncoder();

// files under plain names; those that are written are there once they are closed
class Files {
    constructor() {
        ((this.bytes = new Map()), (this.open = new Map()), (this.memory = null));
        this.said = ""; // on the standard output and error
        // called with bytes for the standard output; with what is in a file that is on the disk, null: removed
        this.told = this.written = null;
    }

    view() {
        return new DataView(this.memory.buffer);
    }

    name(at, size) {
        return text.decode(new Uint8Array(this.memory.buffer, at, size).slice());
    }

    // the parts of a vector of buffers
    parts(at, count) {
        const view = this.view();
        return Array.from({ length: count }, (_, i) => {
            const part = view.getUint32(at + 8 * i, true);
            return new Uint8Array(this.memory.buffer, part, view.getUint32(at + 8 * i + 4, true));
        });
    }

    answer(at, count) {
        this.view().setUint32(at, count, true);
        return OK;
    }

    about(at, size, kind) {
        new Uint8Array(this.memory.buffer, at, 64).fill(0);
        this.view().setUint8(at + 16, kind);
        this.view().setBigUint64(at + 32, BigInt(size), true);
        return OK;
    }

    get calls() {
        const of = f => (fd, ...rest) => (this.open.has(fd) ? f(this.open.get(fd), ...rest) : BADF);
        return {
            fd_prestat_get: (fd, at) => (fd === ROOT ? (this.view().setUint32(at, 0, true), this.answer(at + 4, 1)) : BADF),
            fd_prestat_dir_name: (_, at) => (new Uint8Array(this.memory.buffer)[at] = 47) && OK,
            fd_fdstat_get: (fd, at) => {
                new Uint8Array(this.memory.buffer, at, 24).fill(0);
                new Uint8Array(this.memory.buffer, at + 8, 16).fill(255); // all rights
                this.view().setUint8(at, fd === ROOT ? FOLDER : fd < ROOT ? 2 : FILE);
                return fd <= ROOT || this.open.has(fd) ? OK : BADF;
            },
            fd_fdstat_set_flags: () => OK,
            fd_filestat_get: of((file, at) => this.about(at, file.size, FILE)),
            fd_filestat_set_size: of((file, size) => this.resize(file, Number(size))),
            fd_sync: of(file => this.write(file)),
            fd_close: fd => {
                const file = this.open.get(fd);
                if (file?.writes) this.write(file);
                return this.open.delete(fd) || fd <= ROOT ? OK : BADF;
            },
            fd_seek: of((file, by, whence, at) => {
                file.at = Math.max(0, [0, file.at, file.size][whence] + Number(by));
                this.view().setBigUint64(at, BigInt(file.at), true);
                return OK;
            }),
            fd_read: of((file, parts, count, at) => {
                const begin = file.at;
                for (const part of this.parts(parts, count)) {
                    const more = file.bytes.subarray(file.at, Math.min(file.size, file.at + part.length));
                    part.set(more);
                    file.at += more.length;
                }
                return this.answer(at, file.at - begin);
            }),
            fd_write: (fd, parts, count, at) => {
                const file = this.open.get(fd),
                    all = this.parts(parts, count),
                    size = all.reduce((sum, part) => sum + part.length, 0);
                if (!file && fd >= ROOT) return BADF;
                if (fd === 1 && this.told) for (const part of all) this.told(part);
                else if (!file) this.said += all.map(part => text.decode(part.slice())).join("");
                else {
                    if (file.at + size > file.size) this.resize(file, file.at + size);
                    for (const part of all) (file.bytes.set(part, file.at), (file.at += part.length));
                }
                return this.answer(at, size);
            },
            path_filestat_get: (_, __, name, size, at) => {
                const bytes = this.bytes.get(this.name(name, size));
                return bytes ? this.about(at, bytes.length, FILE) : NOENT;
            },
            path_open: (_, __, at, length, how, rights, ___, ____, out) => {
                const name = this.name(at, length),
                    old = this.bytes.get(name),
                    writes = !!(Number(rights) & 64);
                if (!old && !(how & CREATE)) return NOENT;
                if (old && how & CREATE && how & EXCLUSIVE) return EXIST;
                const bytes = old && !(how & EMPTY) ? (writes ? old.slice() : old) : new Uint8Array();
                let fd = ROOT + 1;
                while (this.open.has(fd)) fd++;
                this.open.set(fd, { name, bytes, size: bytes.length, at: 0, writes });
                if (writes) this.bytes.set(name, bytes);
                return this.answer(out, fd);
            },
            path_rename: (_, from, size, __, to, length) => {
                const name = this.name(from, size);
                if (!this.bytes.has(name)) return NOENT;
                this.bytes.set(this.name(to, length), this.bytes.get(name));
                return this.bytes.delete(name) ? OK : NOENT;
            },
            path_unlink_file: (_, at, size) => {
                const name = this.name(at, size);
                this.written?.(name, null);
                return this.bytes.delete(name) ? OK : NOENT;
            },
            proc_exit: status => {
                throw new Error(`the performer has ended (${status})${this.said ? `: ${this.said}` : ""}`);
            },
        };
    }

    write(file) {
        this.bytes.set(file.name, file.bytes.slice(0, file.size));
        this.written?.(file.name, this.bytes.get(file.name));
        return OK;
    }

    resize(file, size) {
        if (size > file.bytes.length) {
            const more = new Uint8Array(2 * size);
            more.set(file.bytes);
            file.bytes = more;
        }
        file.size = size;
        return OK;
    }
}

// the calls of viewer/engine/engine.h
class Engine {
    constructor(module, rate) {
        ((this.files = new Files()), (this.rate = rate));
        const { exports } = new WebAssembly.Instance(module, { wasi_snapshot_preview1: this.files.calls });
        this.files.memory = exports.memory;
        this.calls = exports;
        exports._initialize();
    }

    input(words) {
        const at = this.calls.page_input(),
            bytes = bytesOf.encode(words);
        if (bytes.length >= INPUT) throw new Error(`${words.slice(0, 40)} ...: ${bytes.length} bytes, expected fewer than ${INPUT}`);
        new Uint8Array(this.files.memory.buffer).set([...bytes, 0], at);
    }

    get error() {
        const memory = new Uint8Array(this.files.memory.buffer),
            at = this.calls.page_error();
        return text.decode(memory.slice(at, memory.indexOf(0, at)));
    }

    call(name, words) {
        this.input(words);
        return this.calls[name]();
    }

    // each returns why not, or ""
    load(name) {
        this.input(name);
        return this.calls.page_load(this.rate) ? "" : this.error;
    }

    say(line) {
        this.input(line);
        return this.calls.page_command() ? "" : this.error;
    }

    // samples of both ears, interleaved
    play(count, wall) {
        return new Float32Array(this.files.memory.buffer, this.calls.page_play(count, wall), 2 * count).slice();
    }

    frame() {
        const at = this.calls.page_frame();
        return this.files.memory.buffer.slice(at, at + this.calls.page_frame_size());
    }
}

// --- in the Worker

const INPUT = 8192, // PAGE_INPUT of viewer/engine/engine.h (bytes)
    CHUNK = 256, // samples at a time
    AHEAD = 0.06, // (s) of sound that waits in the audio thread; chosen: `latency` adds 0.15
    MORE = 0.02, // after each time that it was not enough ...
    MOST = 0.25, // ... up to this
    ALONE = 200, // (ms) without the audio thread, after which this clock is the performer's
    TICK = 15; // (ms)

class Player {
    constructor() {
        ((this.engine = null), (this.port = null), (this.runs = false));
        ((this.made = 0), (this.played = 0), (this.ahead = AHEAD), (this.missed = 0), (this.asked = -Infinity));
    }

    tell(message, transfer = []) {
        postMessage(message, transfer);
    }

    begin({ module, wasm, files, rate }) {
        if (this.engine) return;
        this.tell({ begins: true });
        this.engine = new Engine(module ?? new WebAssembly.Module(wasm), rate);
        for (const [name, bytes] of files) this.engine.files.bytes.set(name, bytes);
        setInterval(() => this.guarded(() => this.tick()), TICK);
    }

    listen(port) {
        this.port = port;
        ((this.made = 0), (this.played = 0));
        port.onmessage = e => this.guarded(() => this.asks(e.data));
    }

    // an error that the engine throws while it plays ends the playing, once
    guarded(play) {
        try {
            play();
        } catch (error) {
            this.runs = false;
            this.tell({ failed: error.message });
        }
    }

    // the audio thread has played so many samples, and had none so often
    asks({ read, missed }) {
        if (missed > this.missed && this.asked > 0) this.ahead = Math.min(MOST, this.ahead + MORE);
        ((this.asked = performance.now()), (this.played = read), (this.missed = missed));
        this.fill();
    }

    // without a device the time goes by the wall's clock
    tick() {
        const now = performance.now(),
            since = now - (this.ticked ?? now);
        this.ticked = now;
        if (now - this.asked < ALONE) return;
        this.played += (Math.min(100, since) * this.engine.rate) / 1000;
        this.fill();
    }

    fill() {
        if (!this.runs || !this.loaded) return;
        const { engine } = this,
            until = this.played + this.ahead * engine.rate;
        while (this.made < until) {
            const wall = (performance.timeOrigin + performance.now()) / 1000,
                samples = engine.play(CHUNK, wall),
                time = engine.calls.page_told() - (1000 * CHUNK) / engine.rate;
            this.made += CHUNK;
            this.port?.postMessage({ time, rate: engine.rate, channels: 2, samples, behind: this.ahead }, [samples.buffer]);
        }
        this.look();
    }

    look() {
        const frame = this.engine.frame();
        if (frame.byteLength) this.tell({ frame }, [frame]);
    }

    load({ name, bytes, then }) {
        const { engine } = this;
        if (bytes) engine.files.bytes.set(name, bytes);
        const failed = engine.load(name);
        if (failed) return this.tell({ failed });
        this.loaded = true;
        this.tell({ loaded: name });
        for (const line of then ?? []) this.say(line);
        if (!this.runs) (engine.play(CHUNK, 0), this.look()); // how it looks at rest
    }

    say(line) {
        const failed = this.engine.say(line);
        this.tell({ line, failed });
        if (!failed) this.look();
        if (!failed && /^record\s+stop/.test(line)) this.save();
    }

    // what has been written goes to the page
    save() {
        for (const [name, bytes] of this.engine.files.bytes)
            if (name === this.recording) this.tell({ saved: name, bytes });
    }

    hear({ begin, port, load, say, runs }) {
        if (begin) this.begin(begin);
        if (port) this.listen(port);
        if (load) this.load(load);
        if (say !== undefined) {
            const record = /^record\s+(\S+)/.exec(say)?.[1];
            if (record && record !== "stop") this.recording = record;
            this.say(say);
        }
        if (runs !== undefined) ((this.runs = runs), (this.ticked = performance.now()));
    }
}

if (typeof WorkerGlobalScope !== "undefined" && self instanceof WorkerGlobalScope) {
    const player = new Player();
    onmessageerror = () => player.engine ?? postMessage({ unread: true });
    onmessage = e => {
        try {
            player.hear(e.data);
        } catch (error) {
            player.tell({ failed: error.message });
        }
    };
}
