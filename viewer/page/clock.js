// The clock of a live performer. Poses, heads, strikes and sound carry the sender's time of what they
// tell. The picture shows one moment: the one that is heard at the loudspeaker, so that both are in
// step whatever each has waited for. While nothing sounds, the picture is as little late as the
// intervals between poses allow. All times in milliseconds.
const LONGEST_DELAY = 120, // of a silent picture; chosen: later than that looks late
    LATEST = 600, // a sound later than the newest pose by more has no picture; chosen: poses are kept longer
    SMOOTH = 100, // the picture follows the sound within; chosen: no jump is seen
    JUMP = 300, // further off than that it jumps; chosen
    WAITING = 512; // deeds that wait at most; chosen: a second of a flood

export class Clock {
    constructor() {
        this.interval = 30; // between poses, a running mean
        this.rate = 0; // of poses (Hz)
        this.waiting = []; // what happens in the picture once its moment has come
        this.begin();
    }

    // the sender's clock is another one now
    begin() {
        this.lag = Infinity; // of the sender's clock behind ours, the least seen
        this.last = this.late = null; // time of the last pose; how far the moment shown is behind ours
    }

    // a pose of `time` has come; false if that is before the last one
    hear(time, now) {
        const since = this.last === null ? 0 : time - this.last;
        if (Math.abs(since) > 1000) this.begin();
        else if (since < 0) return false;
        else if (since > 0 && since < 500) this.interval += 0.1 * (since - this.interval);
        this.rate = 1000 / this.interval;
        this.last = time;
        this.lag = Math.min(this.lag + 0.01, now - time);
        return true;
    }

    // how late a pose is shown: a third of an interval and 3 ms more than one interval, so that the
    // next pose is nearly always there (chosen)
    get delay() {
        return Math.min(LONGEST_DELAY, 1.35 * this.interval + 3);
    }

    // the moment to show; `heard` is the one at the loudspeaker, null while nothing sounds
    moment(now, heard) {
        this.sounds = heard !== null && Math.abs(now - this.lag - heard) < LATEST;
        const wanted = this.sounds ? now - heard : this.lag + this.delay,
            off = wanted - this.late;
        if (this.late === null || Math.abs(off) > JUMP) this.late = wanted;
        else this.late += off * (1 - Math.exp((this.shown - now) / SMOOTH));
        this.shown = now;
        return now - this.late;
    }

    // `act` of that time: in step with what is heard; at once while nothing sounds
    wait(time, act) {
        const left = time - (this.shown - this.late);
        if (this.sounds && left > 0 && left < LATEST && this.waiting.length < WAITING)
            this.waiting.push({ time, act });
        else act();
    }

    // does what `moment` has reached
    run(moment) {
        const due = this.waiting.filter(one => !this.sounds || one.time <= moment);
        if (!due.length) return;
        this.waiting = this.waiting.filter(one => !due.includes(one));
        for (const { act } of due) act();
    }
}
