// A film of a playback, frame by frame at its own time, however long a frame takes to draw; the
// sound is that of the scene. Times in milliseconds.
import { webm } from "./webm.js";

const KEY_EVERY = 2, // (s) between key frames; chosen: a jump to any place is quick
    QUEUE = 4, // frames that wait for the encoder; chosen
    BITS = 0.15, // of a pixel; chosen: no blocks to be seen
    LEAD = 1500; // before the first frame, for trails, camera and heads; chosen
const CODECS = [
    ["vp09.00.41.08", "V_VP9"],
    ["vp8", "V_VP8"],
];

// lets the page live; a timer would be slowed down in a hidden tab
const breathe = () =>
    new Promise(done => {
        const { port1, port2 } = new MessageChannel();
        port1.onmessage = () => (port1.close(), done());
        port2.postMessage(0);
    });

async function choose(width, height, fps) {
    for (const [codec, name] of window.VideoEncoder ? CODECS : []) {
        const config = { codec, width, height, framerate: fps, bitrate: BITS * width * height * fps };
        if ((await VideoEncoder.isConfigSupported(config).catch(() => ({}))).supported)
            return { config, name };
    }
    throw new Error("this browser cannot make films (it has no WebCodecs): record one with r");
}

const taken = (list, track) => chunk => {
    const data = new Uint8Array(chunk.byteLength);
    chunk.copyTo(data);
    list.push({ track, time: chunk.timestamp, key: chunk.type === "key", data });
};

// the scene's sound between two times, at that speed, as Opus; null without
async function encodeSound(buffer, from, seconds, speed, chunks) {
    const rate = 48000;
    if (!buffer || !window.AudioEncoder) return null;
    const offline = new OfflineAudioContext(2, Math.max(1, Math.round(seconds * rate)), rate),
        source = offline.createBufferSource();
    ((source.buffer = buffer), (source.playbackRate.value = speed));
    source.connect(offline.destination);
    source.start(0, from / 1000);
    const heard = await offline.startRendering(),
        own = [];
    let head = null,
        failed = null;
    const encoder = new AudioEncoder({
        output(chunk, about) {
            head ??= about?.decoderConfig?.description && new Uint8Array(about.decoderConfig.description);
            taken(own, 2)(chunk);
        },
        error: e => (failed = e),
    });
    encoder.configure({ codec: "opus", sampleRate: rate, numberOfChannels: 2, bitrate: 192000 });
    for (let at = 0; at < heard.length; at += rate) {
        const n = Math.min(rate, heard.length - at),
            data = new Float32Array(2 * n);
        for (const c of [0, 1]) data.set(heard.getChannelData(c).subarray(at, at + n), c * n);
        encoder.encode(
            new AudioData({
                format: "f32-planar",
                sampleRate: rate,
                numberOfFrames: n,
                numberOfChannels: 2,
                timestamp: (1e6 * at) / rate,
                data,
            }),
        );
    }
    await encoder.flush();
    if (failed || !head) throw failed ?? new Error("this browser's Opus has no header");
    // what the decoder drops at the beginning: samples, in the header's bytes 10 and 11
    const delay = (1e6 * (head[10] + 256 * head[11])) / rate;
    for (const chunk of own) chunks.push({ ...chunk, time: chunk.time + delay, key: true });
    return { head, delay: Math.round(delay), channels: 2 };
}

// plays to `at` unseen, so that trails and heads are as they would be
export function prepare(viewer, at) {
    const { playback, view } = viewer,
        from = Math.max(0, at - LEAD);
    viewer.held = true;
    (playback.setLoop(0, 0), playback.setSpeed(1));
    (playback.seek(from), playback.play(true));
    for (let t = from; t < at; t += 1000 / 60) viewer.step(Math.min(1000 / 60, at - t), false);
    view.settle();
}

// the film as a blob; `tell` hears how far it is (0 .. 1), and stops it by answering true
export async function makeFilm(viewer, { fps = 30, from = 0, to = Infinity, speed = 1 }, tell) {
    const { playback, stage, sound } = viewer,
        canvas = stage.renderer.domElement,
        [width, height] = [canvas.width & ~1, canvas.height & ~1];
    to = Math.min(to, playback.length);
    const seconds = (to - from) / 1000 / speed,
        count = Math.max(1, Math.round(seconds * fps)),
        { config, name } = await choose(width, height, fps),
        chunks = [];
    let failed = null;
    const encoder = new VideoEncoder({ output: taken(chunks, 1), error: e => (failed = e) });
    encoder.configure(config);
    prepare(viewer, from);
    playback.setSpeed(speed);
    for (let i = 0; i < count && !failed; i++) {
        viewer.step(i ? 1000 / fps : 0);
        const frame = new VideoFrame(canvas, {
            timestamp: Math.round((1e6 * i) / fps),
            visibleRect: { x: 0, y: 0, width, height },
        });
        encoder.encode(frame, { keyFrame: i % Math.round(KEY_EVERY * fps) === 0 });
        frame.close();
        if (tell((i + 1) / count)) return (encoder.close(), null);
        do await breathe();
        while (encoder.encodeQueueSize > QUEUE && !failed);
    }
    if (!failed) await encoder.flush();
    if (failed) throw failed;
    const heard = await encodeSound(sound.buffer, from, seconds, speed, chunks);
    return webm({ codec: name, width, height }, heard, chunks, 1000 * seconds);
}
