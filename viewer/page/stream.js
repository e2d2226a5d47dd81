// The stream from himc-viewer: frames of blocks, in the layout of viewer/scene_encode.c. The page
// connects again by itself when the program has been restarted.
import { segments } from "./skeleton.js";

// sizes in a block (bytes)
const KEY = 80,
    NAME = 32,
    BODY = 4 * 7 * segments.length,
    TARGET = 4 * 2 * 3,
    SUPPORT = 4 * 4 * 3;
const FIRST_WAIT = 250, // before connecting again (ms); chosen
    LONGEST_WAIT = 30000; // or until the page is looked at again
const QUIET = 10; // looks, one a second, that find no news, of which there are some each second; chosen: a loaded machine
const text = new TextDecoder();
const word = (bytes, at, size) => {
    const end = bytes.indexOf(0, at);
    return text.decode(bytes.subarray(at, end < 0 || end > at + size ? at + size : end));
};

function readPose(buffer, view, bytes, at, time, on) {
    const body = at + KEY + 8,
        target = body + BODY,
        support = target + TARGET;
    on.pose(
        word(bytes, at, KEY),
        time,
        view.getUint32(at + KEY, true),
        view.getUint32(at + KEY + 4, true),
        new Float32Array(buffer.slice(body, target)),
        new Float32Array(buffer.slice(target, support)),
        new Float32Array(buffer.slice(support, support + SUPPORT)),
    );
}

function readDrum(buffer, view, bytes, at, time, on) {
    const placed = at + KEY + NAME,
        place = placed + 4,
        modes = place + 28,
        amplitude = modes + 8;
    on.drum(
        word(bytes, at, KEY),
        word(bytes, at + KEY, NAME),
        time,
        view.getUint32(placed, true) ? new Float32Array(buffer.slice(place, modes)) : null,
        new Float32Array(
            buffer.slice(amplitude, amplitude + 4 * view.getUint32(modes, true)),
        ),
    );
}

function readSound(buffer, view, bytes, at, time, on) {
    const field = i => view.getUint32(at + KEY + 4 * i, true),
        samples = at + KEY + 16;
    on.sound(
        word(bytes, at, KEY),
        time,
        field(0),
        field(1),
        field(2),
        new Int16Array(buffer.slice(samples, samples + 2 * field(3))),
    );
}

export function readFrame(buffer, on) {
    const view = new DataView(buffer),
        bytes = new Uint8Array(buffer);
    for (let at = 0; at + 16 <= buffer.byteLength;) {
        const kind = view.getUint32(at, true),
            size = view.getUint32(at + 4, true),
            time = view.getFloat64(at + 8, true);
        at += 16;
        if (kind === 1)
            readPose(buffer, view, bytes, at, time, on);
        else if (kind === 2)
            readDrum(buffer, view, bytes, at, time, on);
        else if (kind === 4) readSound(buffer, view, bytes, at, time, on);
        else if (kind === 3) on.event(JSON.parse(text.decode(bytes.subarray(at, at + size))), time);
        at += size;
    }
}

export class Stream {
    constructor(on) {
        this.on = on;
        this.wait = FIRST_WAIT;
        this.connections = 0;
        setInterval(() => this.look(), 1000);
        for (const name of ["focus", "online"]) addEventListener(name, () => this.timer && this.open());
        this.open();
    }

    open() {
        clearTimeout(this.timer);
        this.timer = 0;
        const socket = new WebSocket(`ws://${location.host}/`, "scene");
        socket.binaryType = "arraybuffer";
        socket.onopen = () => {
            this.wait = FIRST_WAIT;
            this.connections++;
            this.on.connected(true);
        };
        socket.onmessage = message => ((this.quiet = 0), readFrame(message.data, this.on));
        socket.onclose = () => this.lost();
        ((this.socket = socket), (this.quiet = 0));
    }

    lost() {
        this.on.connected(false);
        this.timer = setTimeout(() => this.open(), this.wait);
        this.wait = Math.min(this.wait * 1.5, LONGEST_WAIT);
    }

    // a connection that brings no news is none, though nobody has ended it
    look() {
        if (this.socket.readyState !== WebSocket.OPEN || ++this.quiet < QUIET) return;
        this.socket.onclose = this.socket.onmessage = null;
        this.socket.close();
        this.lost();
    }
}
