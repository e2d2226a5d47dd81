// The spectrogram of a sound: levels in decibels over time and frequency, the frequencies in equal
// steps of a tone. By short Fourier transforms under Hann's window.
import { listen } from "./sound.js";

const SIZE = 4096, // of a transform: 12 Hz at 48 kHz, so that the modes of a timpano are apart
    COLUMNS = 2400, // most; chosen: as many as a screen shows
    ROWS = 96,
    LOW = 50, // (Hz)
    HIGH = 4000,
    RANGE = 70; // below the loudest (dB); chosen

const window = Float32Array.from({ length: SIZE }, (_, i) => 0.5 - 0.5 * Math.cos((2 * Math.PI * i) / SIZE)),
    cos = Float32Array.from({ length: SIZE / 2 }, (_, i) => Math.cos((2 * Math.PI * i) / SIZE)),
    sin = Float32Array.from({ length: SIZE / 2 }, (_, i) => Math.sin((2 * Math.PI * i) / SIZE)),
    reversed = Uint16Array.from({ length: SIZE }, (_, i) => {
        let r = 0;
        for (let bit = 1, out = SIZE >> 1; bit < SIZE; bit <<= 1, out >>= 1) if (i & bit) r |= out;
        return r;
    });

// in place (Cooley and Tukey 1965)
export function fourier(re, im) {
    for (let i = 0; i < SIZE; i++) {
        const j = reversed[i];
        if (j > i) ([re[i], re[j]] = [re[j], re[i]], ([im[i], im[j]] = [im[j], im[i]]));
    }
    for (let half = 1; half < SIZE; half *= 2)
        for (let i = 0, step = SIZE / 2 / half; i < SIZE; i += 2 * half)
            for (let k = 0; k < half; k++) {
                const a = i + k,
                    b = a + half,
                    c = cos[k * step],
                    s = -sin[k * step],
                    x = re[b] * c - im[b] * s,
                    y = re[b] * s + im[b] * c;
                ((re[b] = re[a] - x), (im[b] = im[a] - y));
                ((re[a] += x), (im[a] += y));
            }
}

// powers of one column, from low to high
function column(buffer, centre, re, im, out) {
    const rate = buffer.sampleRate;
    listen(buffer, centre - SIZE / 2, re);
    for (let i = 0; i < SIZE; i++) ((re[i] *= window[i]), (im[i] = 0));
    fourier(re, im);
    for (let r = 0; r < ROWS; r++) {
        const edge = k => (LOW * (HIGH / LOW) ** (k / ROWS) * SIZE) / rate,
            first = Math.round(edge(r));
        let most = 0;
        for (let i = first; i <= Math.max(first, Math.round(edge(r + 1)) - 1); i++)
            most = Math.max(most, re[i] * re[i] + im[i] * im[i]);
        out[r] = most;
    }
}

// dark blue over violet and orange to white
function paint(level, data, at) {
    data[at] = 255 * Math.min(1, Math.max(0, 1.8 * level - 0.25));
    data[at + 1] = 255 * Math.min(1, Math.max(0, 1.9 * level - 0.75));
    data[at + 2] = 255 * Math.min(1, Math.max(0.1, level < 0.5 ? 1.1 * level : 1.1 - 1.1 * level + Math.max(0, 4 * level - 3)));
    data[at + 3] = 255;
}

// A picture of the whole sound, `ROWS` high. Works a little at a time; `alive` says whether to go on.
// Null if it was stopped.
export async function spectrogram(buffer, alive) {
    const columns = Math.min(COLUMNS, Math.ceil(buffer.length / 480)),
        power = new Float32Array(columns * ROWS),
        [re, im] = [new Float32Array(SIZE), new Float32Array(SIZE)];
    let rest = performance.now(),
        loudest = 1e-12;
    for (let c = 0; c < columns; c++) {
        const out = power.subarray(c * ROWS, (c + 1) * ROWS);
        column(buffer, Math.round(((c + 0.5) / columns) * buffer.length), re, im, out);
        for (const v of out) if (v > loudest) loudest = v;
        if (performance.now() - rest < 4) continue; // of a frame's 16 ms
        await new Promise(done => setTimeout(done));
        if (!alive()) return null;
        rest = performance.now();
    }
    const canvas = document.createElement("canvas");
    ((canvas.width = columns), (canvas.height = ROWS));
    const ink = canvas.getContext("2d"),
        picture = ink.createImageData(columns, ROWS);
    for (let c = 0; c < columns; c++)
        for (let r = 0; r < ROWS; r++) {
            const level = 1 + (10 * Math.log10(power[c * ROWS + r] / loudest + 1e-12)) / RANGE;
            paint(Math.min(1, Math.max(0, level)), picture.data, 4 * ((ROWS - 1 - r) * columns + c));
        }
    ink.putImageData(picture, 0, 0);
    return canvas;
}
