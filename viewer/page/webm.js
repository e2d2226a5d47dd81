// A WebM file (Matroska, RFC 9559) of one track of pictures and one of sound, with an index before
// them. Each cluster begins with a key frame. Times of chunks in microseconds, of the file in
// milliseconds.
const text = new TextEncoder();

function join(parts) {
    const out = new Uint8Array(parts.reduce((sum, p) => sum + p.length, 0));
    let at = 0;
    for (const part of parts) (out.set(part, at), (at += part.length));
    return out;
}

// a number with its highest byte first
function number(value, size) {
    const out = new Uint8Array(size);
    for (let i = size - 1; i >= 0; i--) ((out[i] = value % 256), (value = Math.floor(value / 256)));
    return out;
}

function real(value) {
    const out = new Uint8Array(8);
    new DataView(out.buffer).setFloat64(0, value);
    return out;
}

// an element: its id, as written in hexadecimal, its size in 8 bytes, what is in it
function element(id, ...parts) {
    const body = join(
            parts.map(p => (typeof p === "number" ? number(p, 8) : typeof p === "string" ? text.encode(p) : p)),
        ),
        size = number(body.length, 8);
    size[0] = 1;
    return join([Uint8Array.from(id.match(/../g), b => parseInt(b, 16)), size, body]);
}

const header = () =>
    element(
        "1a45dfa3",
        element("4286", 1),
        element("42f7", 1),
        element("42f2", 4),
        element("42f3", 8),
        element("4282", "webm"),
        element("4287", 4),
        element("4285", 2),
    );

function tracks({ codec, width, height }, sound) {
    const track = (n, type, id, ...more) =>
        element("ae", element("d7", n), element("73c5", n), element("83", type), element("86", id), ...more);
    const all = [track(1, 1, codec, element("e0", element("b0", width), element("ba", height)))];
    if (sound)
        all.push(
            track(
                2,
                2,
                "A_OPUS",
                element("63a2", sound.head),
                element("56aa", sound.delay * 1000),
                element("56bb", 80e6), // as Opus in Matroska asks for
                element("e1", element("b5", real(48000)), element("9f", sound.channels)),
            ),
        );
    return element("1654ae6b", ...all);
}

const ms = chunk => Math.round(chunk.time / 1000);

function block(chunk, start) {
    const head = Uint8Array.of(0x80 | chunk.track, 0, 0, chunk.key ? 0x80 : 0);
    new DataView(head.buffer).setInt16(1, ms(chunk) - start);
    return element("a3", head, chunk.data);
}

// `chunks`: { track 1 or 2, time, key, data }; `sound`: { head, delay, channels } or null
export function webm(video, sound, chunks, duration) {
    const sorted = [...chunks].sort((a, b) => a.time - b.time || a.track - b.track),
        clusters = [];
    for (const chunk of sorted) {
        if (!clusters.length || (chunk.track === 1 && chunk.key)) clusters.push([]);
        clusters[clusters.length - 1].push(chunk);
    }
    const start = list => ms(list[0]),
        made = clusters.map(list =>
            element("1f43b675", element("e7", start(list)), ...list.map(c => block(c, start(list)))),
        );
    const info = element(
            "1549a966",
            element("2ad7b1", 1e6),
            element("4489", real(duration)),
            element("4d80", "himc"),
            element("5741", "himc"),
        ),
        about = tracks(video, sound);
    const cues = first => {
        let at = first;
        return element(
            "1c53bb6b",
            ...clusters.map((list, i) => {
                const point = element(
                    "bb",
                    element("b3", start(list)),
                    element("b7", element("f7", 1), element("f1", at)),
                );
                at += made[i].length;
                return point;
            }),
        );
    };
    // numbers have 8 bytes each, so the index is as long wherever it points to
    const before = info.length + about.length + cues(0).length;
    return new Blob([header(), element("18538067", info, about, cues(before), ...made)], {
        type: "video/webm",
    });
}
