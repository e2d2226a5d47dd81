// Plays sound as it comes, in the audio thread. It is kept a little behind, so that packets that come
// late are there in time; the delay is that of the picture. Both clocks drift, so the speed follows
// the amount that waits.
const MOST = 0.2, // (s) more is left out
    SIZE = 1 << 16, // of the ring (samples)
    PULL = 0.02, // how much of the speed follows (1/s)
    TOLD = 0.25; // (s) between two reports

class Live extends AudioWorkletProcessor {
    // `behind` (s) is wanted in the buffer
    constructor({ processorOptions }) {
        super();
        this.behind = processorOptions.behind;
        this.ring = [new Float32Array(SIZE), new Float32Array(SIZE)];
        ((this.written = 0), (this.read = 0), (this.next = null), (this.rate = 48000));
        ((this.begun = false), (this.missed = 0), (this.peak = 0), (this.told = 0));
        this.port.onmessage = e => this.push(e.data);
    }

    push({ first, rate, channels, samples }) {
        const frames = samples.length / channels,
            lost = this.next === null ? 0 : (first - this.next) | 0;
        if (lost < 0 || lost > SIZE / 4 || rate !== this.rate) this.begun = false;
        else for (let i = 0; i < lost; i++) this.put(0, 0);
        ((this.next = (first + frames) | 0), (this.rate = rate));
        for (let i = 0; i < frames; i++)
            this.put(samples[i * channels] / 32768, samples[i * channels + channels - 1] / 32768);
    }

    put(left, right) {
        const at = this.written++ % SIZE;
        ((this.ring[0][at] = left), (this.ring[1][at] = right));
        this.peak = Math.max(this.peak, Math.abs(left), Math.abs(right));
    }

    process(_, [output]) {
        const waits = (this.written - this.read) / this.rate;
        if (!this.begun || waits > MOST) {
            this.read = Math.max(0, this.written - this.behind * this.rate);
            this.begun = this.written - this.read >= this.behind * this.rate;
        }
        const step = (this.rate / sampleRate) * (1 + PULL * (waits - this.behind));
        for (let i = 0; this.begun && i < output[0].length; i++) {
            const whole = Math.floor(this.read),
                t = this.read - whole;
            if (whole + 1 >= this.written) {
                this.begun = false;
                this.missed++;
                break;
            }
            output.forEach((out, channel) => {
                const ring = this.ring[channel];
                out[i] = (1 - t) * ring[whole % SIZE] + t * ring[(whole + 1) % SIZE];
            });
            this.read += step;
        }
        this.tell(waits);
        return true;
    }

    tell(waits) {
        if (currentTime < this.told + TOLD) return;
        this.told = currentTime;
        this.port.postMessage({ waits, missed: this.missed, peak: this.peak, played: this.read });
        this.peak = 0;
    }
}
registerProcessor("himc-live", Live);
