// The modes of a round membrane in the library's order (lib/src/head/modes.h): by increasing zero
// of the Bessel function, each pair as cosine and sine.
//     phi_mn = J_m(j_mn r / a) cos or sin (m theta)

// Bessel's integral by the midpoint rule: exact to rounding for the 64 modes drawn
export function bessel(m, x) {
    let sum = 0;
    const n = 96;
    for (let i = 0; i < n; i++) {
        const t = (Math.PI * (i + 0.5)) / n;
        sum += Math.cos(m * t - x * Math.sin(t));
    }
    return sum / n;
}

function zeros(m, below) {
    const found = [];
    for (let x = Math.max(m, 1e-6) + 0.1; x < below; x += 0.2)
        if (bessel(m, x) * bessel(m, x + 0.2) < 0) {
            let a = x,
                b = x + 0.2;
            for (let i = 0; i < 50; i++) {
                const c = (a + b) / 2;
                if (bessel(m, a) * bessel(m, c) <= 0) b = c;
                else a = c;
            }
            found.push(a);
        }
    return found;
}

function list(count) {
    const all = [];
    for (let m = 0; m < 20; m++)
        for (const zero of zeros(m, 22))
            all.push({ m, zero, sine: false }, ...(m ? [{ m, zero, sine: true }] : []));
    return all.sort((a, b) => a.zero - b.zero || a.sine - b.sine).slice(0, count);
}

export const modes = list(64);

// phi at radius fraction r and angle theta
export function shape(i, r, theta) {
    const { m, zero, sine } = modes[i];
    return bessel(m, zero * r) * (sine ? Math.sin(m * theta) : Math.cos(m * theta));
}

// Heights at the points of a polar net (rings x sectors) from modal amplitudes: first a sum for
// each ring and order, then round the circle, so the cost is modes x rings + orders x points.
export class Net {
    constructor(rings, sectors) {
        ((this.rings = rings), (this.sectors = sectors));
        this.radial = modes.map(k =>
            Float32Array.from({ length: rings + 1 }, (_, r) => bessel(k.m, (k.zero * r) / rings)),
        );
        const orders = (this.orders = Math.max(...modes.map(k => k.m)) + 1);
        const table = f =>
            Float32Array.from({ length: orders * sectors }, (_, i) =>
                f((Math.floor(i / sectors) * 2 * Math.PI * (i % sectors)) / sectors),
            );
        ((this.cos = table(Math.cos)), (this.sin = table(Math.sin)));
        ((this.c = new Float32Array(orders)), (this.s = new Float32Array(orders)));
    }

    // into height[ring * sectors + sector]
    fill(amplitude, height) {
        const { rings, sectors, orders, c, s, cos, sin } = this,
            n = Math.min(amplitude.length, modes.length);
        for (let r = 0; r <= rings; r++) {
            (c.fill(0), s.fill(0));
            for (let i = 0; i < n; i++)
                (modes[i].sine ? s : c)[modes[i].m] += amplitude[i] * this.radial[i][r];
            const ring = height.subarray(r * sectors, (r + 1) * sectors).fill(c[0]);
            for (let m = 1, o = sectors; m < orders; m++, o += sectors)
                if (c[m] || s[m])
                    for (let t = 0; t < sectors; t++)
                        ring[t] += c[m] * cos[o + t] + s[m] * sin[o + t];
        }
    }
}

const STRIKES_KEPT = 12;
// a head of 23 inches without air: radius (m), tension (N/m), density (kg/m^2), losses (1/s, s)
const HEAD = { radius: 0.2921, tension: 3700, density: 0.2653, s0: 2.2, s1: 3e-7 };

// Vibration of that head after strikes. A strike is an impulse J (N s) at (x, y), and each
// mode answers with a decaying sine, q = -J phi / (m w) e^(-d t) sin(w t) (Morse & Ingard 1968);
// the answers to the last 12 strikes are added (chosen: older ones have died away).
export class Ringing {
    constructor() {
        const { radius, tension, density, s0, s1 } = HEAD;
        this.mode = modes.map(({ m, zero }) => {
            const omega = (zero / radius) * Math.sqrt(tension / density),
                norm = bessel(m + 1, zero) ** 2 / (m ? 2 : 1);
            return {
                omega,
                decay: s0 + s1 * omega * omega,
                mass: density * Math.PI * radius * radius * norm,
            };
        });
        this.strikes = [];
    }

    strike(time, x, y, impulse) {
        const r = Math.hypot(x, y) / HEAD.radius,
            theta = Math.atan2(y, x);
        if (r < 1)
            this.strikes.push({
                time,
                gain: this.mode.map((k, i) => (-impulse * shape(i, r, theta)) / (k.mass * k.omega)),
            });
        if (this.strikes.length > STRIKES_KEPT) this.strikes.shift();
    }

    at(time) {
        const q = new Float32Array(modes.length);
        for (const { time: begin, gain } of this.strikes) {
            const t = time - begin;
            if (t < 0) continue;
            this.mode.forEach(
                (k, i) => (q[i] += gain[i] * Math.exp(-k.decay * t) * Math.sin(k.omega * t)),
            );
        }
        return q;
    }
}
