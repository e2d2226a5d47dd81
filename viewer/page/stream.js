// The bridge's stream: frames of blocks as scene_encode.c writes them; comes back by itself when
// the bridge does.
const text = new TextDecoder();
const word = (bytes, at, size) => {
    const end = bytes.indexOf(0, at);
    return text.decode(bytes.subarray(at, end < 0 || end > at + size ? at + size : end));
};

export function readFrame(buffer, on) {
    const view = new DataView(buffer),
        bytes = new Uint8Array(buffer);
    for (let at = 0; at + 16 <= buffer.byteLength;) {
        const kind = view.getUint32(at, true),
            size = view.getUint32(at + 4, true),
            time = view.getFloat64(at + 8, true);
        at += 16;
        if (kind === 1)
            on.pose(
                word(bytes, at, 80),
                time,
                view.getUint32(at + 80, true),
                view.getUint32(at + 84, true),
                new Float32Array(buffer.slice(at + 88, at + 88 + 560)),
                new Float32Array(buffer.slice(at + 648, at + 672)),
            );
        else if (kind === 2)
            on.drum(
                word(bytes, at, 80),
                word(bytes, at + 80, 32),
                time,
                view.getUint32(at + 112, true)
                    ? new Float32Array(buffer.slice(at + 116, at + 136))
                    : null,
                new Float32Array(
                    buffer.slice(at + 144, at + 144 + 4 * view.getUint32(at + 136, true)),
                ),
            );
        else if (kind === 3) on.event(JSON.parse(text.decode(bytes.subarray(at, at + size))), time);
        at += size;
    }
}

export class Stream {
    constructor(on) {
        this.on = on;
        this.wait = 250;
        this.connections = 0;
        this.open();
    }

    open() {
        const socket = new WebSocket(`ws://${location.host}/`, "scene");
        socket.binaryType = "arraybuffer";
        socket.onopen = () => {
            this.wait = 250;
            this.connections++;
            this.on.connected(true);
        };
        socket.onmessage = message => readFrame(message.data, this.on);
        socket.onclose = () => {
            this.on.connected(false);
            setTimeout(() => this.open(), this.wait);
            this.wait = Math.min(this.wait * 1.5, 2000);
        };
    }
}
