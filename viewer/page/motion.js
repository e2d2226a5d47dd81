// Playback of a motion.csv (from `himc render --motion`) as poses, targets and strikes. Joint
// rotations are rotation vectors from the zero pose of the default performer. A strike is an
// interval of force on a stick. The drumhead is the library's default one; its vibration is
// computed from the strikes, as if each fell on a head at rest.
import { HANDS, kinematics } from "./body.js";
import { segments } from "./skeleton.js";
import { usualPlace } from "./drum.js";
import { Ringing } from "./modes.js";

const POSE_INTERVAL = 1000 / 60, // (ms); chosen: a frame of the usual screen
    ALL_SEGMENTS = 2 ** segments.length - 1,
    BOTH_HANDS = 3;

export class Motion {
    constructor(text, name) {
        const lines = text.split("\n"),
            names = lines[0].trim().split(",");
        this.name = name;
        this.column = Object.fromEntries(names.map((n, i) => [n, i]));
        const ofHand = hand => [
            `${hand}_force_n`,
            ...["x", "y", "z"].flatMap(a => [`${hand}_tip_${a}_m`, `${hand}_target_${a}_m`]),
        ];
        for (const want of ["time_s", `${segments[1].joint}_x_rad`, ...HANDS.flatMap(ofHand)])
            if (!(want in this.column))
                throw new Error(`${name}:1: not a motion: no column ${want}`);
        this.rows = [];
        for (let i = 1; i < lines.length; i++) {
            if (!lines[i].trim()) continue;
            const row = Float64Array.from(lines[i].split(","), Number),
                before = this.rows.length ? this.rows[this.rows.length - 1][0] : -Infinity,
                wrong =
                    row.length !== names.length
                        ? `${row.length} numbers, wanted ${names.length}`
                        : !row.every(Number.isFinite)
                          ? "not a number"
                          : !(row[0] > before)
                            ? `time ${row[0]} s, allowed only above ${before} s`
                            : "";
            if (wrong) throw new Error(`${name}:${i + 1}: ${wrong}`);
            this.rows.push(row);
        }
        if (this.rows.length < 2) throw new Error(`${name}: no rows`);
        this.period = this.rows[1][0] - this.rows[0][0];
        this.length = 1000 * this.rows[this.rows.length - 1][0];
        this.strikes = HANDS.flatMap(hand => this.findStrikes(hand)).sort(
            (a, b) => a.time - b.time,
        );
        this.ringing = new Ringing();
        this.at = 0; // (ms)
        this.playing = true;
        this.next = 0;
        this.sent = -Infinity;
    }

    get(row, name) {
        return this.rows[row][this.column[name]];
    }

    findStrikes(hand) {
        const found = [],
            force = i => this.get(i, hand + "_force_n");
        for (let i = 1; i < this.rows.length; i++) {
            if (!(force(i) > 0 && force(i - 1) === 0)) continue;
            let most = 0,
                end = i;
            for (; end < this.rows.length && force(end) > 0; end++)
                most = Math.max(most, force(end));
            const tip = a => this.get(i, `${hand}_tip_${a}_m`),
                before = this.get(i - 1, hand + "_tip_z_m");
            found.push({
                event: "strike",
                from: this.name,
                time: this.get(i, "time_s"),
                hand,
                drum: "kettle",
                x: tip("x") - usualPlace[0],
                y: tip("y") - usualPlace[1],
                velocity: (before - tip("z")) / this.period,
                force: most,
                duration: (end - i) * this.period,
                nuance: "",
            });
            i = end;
        }
        return found;
    }

    body(i) {
        const angle = j => ["x", "y", "z"].map(a => this.get(i, `${j}_${a}_rad`) || 0);
        return Float32Array.from(kinematics(angle));
    }

    seek(ms) {
        this.at = Math.min(this.length, Math.max(0, ms));
        this.next = this.strikes.findIndex(s => 1000 * s.time >= this.at);
        if (this.next < 0) this.next = this.strikes.length;
        this.ringing.strikes.length = 0;
        this.sent = -Infinity;
    }

    // passes on the packets that a performer would have sent in the last `dt` ms
    update(now, dt, on) {
        if (this.playing) this.at += dt;
        if (this.at > this.length) this.seek(0);
        if (now - this.sent >= POSE_INTERVAL - 1) {
            const i = Math.max(
                0,
                Math.min(
                    this.rows.length - 1,
                    Math.round((this.at / 1000 - this.rows[0][0]) / this.period),
                ),
            );
            const target = Float32Array.from(
                HANDS.flatMap(h => ["x", "y", "z"].map(a => this.get(i, `${h}_target_${a}_m`))),
            );
            on.drum(this.name, "kettle", now, null, this.ringing.at(this.at / 1000));
            on.pose(this.name, now, ALL_SEGMENTS, BOTH_HANDS, this.body(i), target);
            this.sent = now;
        }
        while (
            this.playing &&
            this.next < this.strikes.length &&
            1000 * this.strikes[this.next].time <= this.at
        )
            this.hit(this.strikes[this.next++], now, on);
    }

    // the impulse is that of a half sine of the strike's peak force
    hit(strike, now, on) {
        this.ringing.strike(
            strike.time,
            strike.x,
            strike.y,
            (2 / Math.PI) * strike.force * strike.duration,
        );
        on.event({ ...strike }, now);
    }
}
