// Plays sound as it comes, in the audio thread. It is kept a little behind, so that packets that come
// late are there in time. Both clocks drift, so the speed follows the amount that waits. It reports
// the sender's time of what it plays, which the picture follows.
//
// A performer inside the page is fed: this thread tells over a port of its own what it has played, gets what
// is next, and leaves nothing out.
const MOST = 0.2, // (s) more is left out
    SIZE = 1 << 16, // of the ring (samples)
    SPARE = 0.01, // (s) more than wanted, and never needed within a LOOK, is left out, under a
    LOOK = 0.5, // crossfade: the speed alone would take a minute, and the sound be late meanwhile
    FADE = 256, // (samples)
    PULL = 0.02, // how much of the speed follows (1/s)
    ASKED = 4, // blocks between two requests of one that is fed; chosen: 11 ms
    TOLD = 0.05; // (s) between two reports; chosen: the speed changes far more slowly

class Live extends AudioWorkletProcessor {
    constructor() {
        super();
        this.behind = this.began = Infinity; // wanted in the buffer now, and when it began (s)
        ((this.place = 0), (this.time = 0)); // of a sample written; the sender's time of it (ms)
        this.ring = [new Float32Array(SIZE), new Float32Array(SIZE)];
        ((this.written = 0), (this.read = 0), (this.next = null), (this.rate = 48000));
        ((this.least = Infinity), (this.looked = 0), (this.old = 0), (this.fade = 0));
        ((this.begun = false), (this.missed = 0), (this.peak = 0), (this.told = 0));
        ((this.feeder = null), (this.blocks = 0), (this.origin = 0));
        this.port.onmessage = e => (e.data.feed ? this.feed(e.data.feed) : this.push(e.data));
    }

    // from now on; what waits is played first
    feed(port) {
        this.feeder?.close();
        ((this.feeder = port), (this.origin = this.written));
        port.onmessage = e => port === this.feeder && this.push(e.data);
    }

    // begins once enough is there
    fed(waits) {
        if (this.blocks++ % ASKED === 0) this.feeder.postMessage({ read: this.read - this.origin, missed: this.missed });
        this.begun ||= waits >= this.behind;
    }

    push({ time, first, rate, channels, samples, behind }) {
        const frames = samples.length / channels,
            full = samples instanceof Float32Array ? 1 : 32768,
            lost = this.feeder || this.next === null ? 0 : (first - this.next) | 0;
        if (!this.feeder && (lost < 0 || lost > SIZE / 4 || rate !== this.rate || behind > this.began + SPARE))
            this.begun = false;
        else for (let i = 0; i < lost; i++) this.put(0, 0);
        ((this.next = (first + frames) | 0), (this.rate = rate), (this.behind = behind));
        ((this.place = this.written), (this.time = time));
        for (let i = 0; i < frames; i++)
            this.put(samples[i * channels] / full, samples[i * channels + channels - 1] / full);
    }

    put(left, right) {
        const at = this.written++ % SIZE;
        ((this.ring[0][at] = left), (this.ring[1][at] = right));
        this.peak = Math.max(this.peak, Math.abs(left), Math.abs(right));
    }

    process(_, [output]) {
        const waits = (this.written - this.read) / this.rate;
        if (this.feeder) this.fed(waits);
        else if (!this.begun || waits > MOST) {
            this.read = Math.max(0, this.written - this.behind * this.rate);
            this.begun = this.written - this.read >= this.behind * this.rate;
            this.began = this.behind;
        }
        if (!this.feeder) this.catchUp(waits);
        this.tell(waits);
        const step = (this.rate / sampleRate) * (this.feeder ? 1 : 1 + PULL * (waits - this.behind));
        for (let i = 0; this.begun && i < output[0].length; i++) {
            if (Math.floor(this.read) + 1 >= this.written) {
                this.begun = false;
                this.missed++;
                break;
            }
            const old = this.fade > 0 ? this.fade-- / FADE : 0;
            output.forEach((out, channel) => {
                out[i] = this.sample(channel, this.read);
                if (old) out[i] += old * (this.sample(channel, this.old) - out[i]);
            });
            this.read += step;
            this.old += step;
        }
        return true;
    }

    sample(channel, place) {
        const ring = this.ring[channel],
            whole = Math.floor(place),
            t = place - whole;
        return (1 - t) * ring[whole % SIZE] + t * ring[(whole + 1) % SIZE];
    }

    // leaves out what waits for nothing
    catchUp(waits) {
        this.least = Math.min(this.least, waits);
        if (currentTime < this.looked + LOOK) return;
        const spare = this.least - this.behind;
        if (this.begun && spare > SPARE)
            ((this.old = this.read), (this.fade = FADE), (this.read += spare * this.rate), (this.skipped = true));
        ((this.looked = currentTime), (this.least = Infinity));
    }

    // what sounds from this block on
    tell(waits) {
        const { begun: playing, missed, peak, read: played } = this;
        if (currentTime < this.told + TOLD && playing === this.playing && !this.skipped) return;
        ((this.told = currentTime), (this.playing = playing), (this.skipped = false), (this.peak = 0));
        const moment = this.time + (1000 * (played - this.place)) / this.rate;
        this.port.postMessage({ at: currentTime, moment, playing, waits, missed, peak, played });
    }
}
registerProcessor("himc-live", Live);
