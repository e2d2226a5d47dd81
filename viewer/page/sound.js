// The sound of a playback. Browsers start sound only after a click or a key, so the device is opened
// by wake(); until then the playback is silent and goes by the wall clock.

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
        this.context = new AudioContext({ latencyHint: "interactive" });
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

    // from `at` (s) at `rate` times the speed
    play(at, rate) {
        this.stop();
        if (!this.ready || at >= this.buffer.duration) return;
        const source = (this.source = this.context.createBufferSource());
        source.buffer = this.buffer;
        source.playbackRate.value = rate;
        source.connect(this.gain);
        ((this.begun = this.context.currentTime), (this.from = at), (this.rate = rate));
        source.onended = () => source === this.source && (this.source = null);
        source.start(this.begun, at);
    }

    stop() {
        if (!this.source) return;
        const source = this.source;
        this.source = null;
        source.stop();
    }

    // what is heard now (s of the scene); null while nothing sounds
    position() {
        if (!this.source || !this.ready) return null;
        return this.from + (this.heard() - this.begun) * this.rate;
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
