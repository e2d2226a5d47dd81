// The sound of a playback. Browsers start sound only after a click or a key, so the device is opened
// by wake(); until then the playback is silent and goes by the wall clock.
const PERFORMERS = 16, // as many as himc-viewer keeps
    SHORTEST = 0.02, // (s) of sound that waits; chosen: four packets
    OLD = 500; // (ms) a report of the audio thread; chosen: ten reports

// the first channel of a buffer from a sample on, into `out`; zeros before and after. A copy: samples that are
// taken out whole stay in memory twice.
export function listen(buffer, from, out) {
    out.fill(0);
    const at = Math.max(0, from);
    if (at < buffer.length && at - from < out.length) buffer.copyFromChannel(out.subarray(at - from), 0, at);
    return out;
}

export class Sound {
    constructor() {
        ((this.context = null), (this.buffer = null), (this.source = null));
        ((this.volume = 1), (this.begun = 0), (this.from = 0), (this.rate = 1));
    }

    // decodes the sound of a scene; resolves to its buffer, null without one
    async load(parts, rate) {
        this.stop();
        this.buffer = null;
        if (!parts.some(part => part.length)) return null;
        const bytes = await new Blob(parts).arrayBuffer();
        return (this.buffer = await new OfflineAudioContext(2, 1, rate).decodeAudioData(bytes));
    }

    // after a gesture of the user; true if the device has just been opened
    wake() {
        if (this.context) return false;
        // a performer inside the page has one rate on every device
        const rate = window.himcFiles ? { sampleRate: 48000 } : {};
        this.context = new AudioContext({ latencyHint: "interactive", ...rate });
        this.gain = this.context.createGain();
        this.gain.connect(this.context.destination);
        this.setVolume(this.volume);
        return true;
    }

    // for a film: what is heard, as tracks; none before wake()
    tracks() {
        if (!this.context) return [];
        const out = this.context.createMediaStreamDestination();
        this.gain.connect(out);
        return out.stream.getAudioTracks();
    }

    setVolume(volume) {
        this.volume = volume;
        if (this.gain) this.gain.gain.value = volume;
    }

    get ready() {
        return !!this.buffer && !!this.context && this.context.state === "running";
    }

    // from `at` (s) at `rate` times the speed, round and round in `loop` [from, to] (s) if it is given
    play(at, rate, loop = null) {
        this.stop();
        if (!this.ready || at >= this.buffer.duration) return;
        const source = (this.source = this.context.createBufferSource());
        source.buffer = this.buffer;
        source.playbackRate.value = rate;
        source.connect(this.gain);
        ((this.begun = this.context.currentTime), (this.from = at), (this.rate = rate), (this.loop = null));
        source.onended = () => source === this.source && (this.source = null);
        this.setLoop(loop);
        source.start((this.started = this.begun), at);
    }

    // from now on; what sounds goes on without a gap
    setLoop(loop) {
        const { source, context } = this;
        if (!source) return;
        ((this.from = this.place(context.currentTime)), (this.begun = context.currentTime));
        this.loop = loop && [loop[0], Math.min(loop[1], this.buffer.duration)];
        source.loop = !!loop && this.loop[1] > this.loop[0];
        if (!source.loop) this.loop = null;
        else [source.loopStart, source.loopEnd] = this.loop;
    }

    // what the source plays at that time of the context's clock (s of the scene)
    place(time) {
        const at = this.from + (time - this.begun) * this.rate,
            [from, to] = this.loop ?? [0, Infinity];
        return at < to ? at : from + ((at - from) % (to - from));
    }

    stop() {
        if (!this.source) return;
        const source = this.source;
        this.source = null;
        source.stop();
    }

    // what is heard now (s of the scene), its first moment until that is at the loudspeaker; null while
    // nothing sounds
    position() {
        if (!this.source || !this.ready) return null;
        return this.place(Math.max(this.heard(), this.started));
    }

    // the time of the context's clock that is at the loudspeaker now
    heard() {
        const c = this.context,
            stamp = c.getOutputTimestamp ? c.getOutputTimestamp() : null,
            now = stamp && stamp.contextTime + (performance.now() - stamp.performanceTime) / 1000;
        // some devices give no stamp, or an old one
        return stamp && stamp.contextTime > 0 && now <= c.currentTime && now > c.currentTime - 0.5
            ? now
            : c.currentTime - (c.outputLatency || 0);
    }
}

// The module of the audio thread. In a page that is one file it is a text: Chromium refuses a Blob's address
// where the page is a file, and takes a data: address.
function addWorklet({ audioWorklet }) {
    const source = window.himcScripts?.get("worklet.js");
    if (!source) return audioWorklet.addModule("/worklet.js");
    const blob = () => URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
    return audioWorklet
        .addModule(`data:text/javascript,${encodeURIComponent(source)}`)
        .catch(() => audioWorklet.addModule(blob()));
}

// The sound of live performers, each in its order, once the device is open. What is heard sets the
// moment of the picture (clock.js).
export class LiveSound {
    constructor(sound) {
        ((this.sound = sound), (this.nodes = new Map()), (this.module = null));
        this.heard = -Infinity; // the last packet (ms)
    }

    // `delay` is how late a silent picture would be (ms): the sound need not be earlier
    receive(key, time, first, rate, channels, samples, now, delay) {
        this.heard = now;
        const { context } = this.sound;
        if (!context || context.state !== "running") return;
        this.load();
        const behind = Math.max(SHORTEST, delay / 1000 - (context.outputLatency || 0));
        if (this.loaded) this.node(key).port.postMessage({ time, first, rate, channels, samples, behind });
    }

    load() {
        return (this.module ??= addWorklet(this.sound.context).then(() => (this.loaded = true)));
    }

    // a port over which the audio thread asks for what it plays, and gets it
    async feed(key) {
        await this.load();
        const { port1, port2 } = new MessageChannel();
        this.node(key).port.postMessage({ feed: port1 }, [port1]);
        return port2;
    }

    node(key) {
        if (this.nodes.has(key)) return this.nodes.get(key);
        if (this.nodes.size >= PERFORMERS) this.close();
        const { context, gain } = this.sound,
            node = new AudioWorkletNode(context, "himc-live", { outputChannelCount: [2] });
        node.port.onmessage = e => (node.told = e.data);
        node.connect(gain);
        this.nodes.set(key, node);
        return node;
    }

    // the sender's time of what is at the loudspeaker now (ms); null while it is silent
    moment(key) {
        const told = this.nodes.get(key)?.told,
            since = told?.playing ? 1000 * (this.sound.heard() - told.at) : Infinity;
        return since < OLD ? told.moment + since : null;
    }

    close() {
        for (const node of this.nodes.values()) node.disconnect();
        this.nodes.clear();
    }
}
