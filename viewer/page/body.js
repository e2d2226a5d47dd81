// Forward kinematics of a body. The default performer is the library's own table of segments
// (skeleton.js, made by tools/research/skeleton/table.c when the viewer is built); a scene brings the measures
// of its own.
import { segments } from "./skeleton.js";

export const HANDS = ["left", "right"]; // in the library's order

// "elbow" of "left-elbow" and "right-elbow"
export const jointKind = joint => joint.replace(/^(left|right)-/, "");

const index = new Map(segments.map((s, i) => [s.name, i]));

// Index of a segment; a name that the table does not have is a mistake in the page.
export function bone(name) {
    if (!index.has(name)) throw new Error(`no segment is called ${name}`);
    return index.get(name);
}

// each joint in its parent's frame, the pelvis in the world (m)
const usual = Float64Array.from(segments.flatMap(s => s.origin));

// where a push acts, in the segment's frame: `along` its line from the joint through the centre of
// mass (m), or if that is not said the centre of mass
export function pushed(segment, along) {
    const { center } = segments[segment];
    return along === undefined ? center : center.map(v => (v * along) / Math.hypot(...center));
}

// the rotation (w x y z) of a rotation vector, into out[o ..]
export function quaternion(x, y, z, out, o) {
    const angle = Math.hypot(x, y, z),
        s = angle > 1e-9 ? Math.sin(angle / 2) / angle : 0.5;
    ((out[o] = Math.cos(angle / 2)), (out[o + 1] = s * x));
    ((out[o + 2] = s * y), (out[o + 3] = s * z));
}

// v turned by the rotation q[a ..], plus p[b ..], into out[o ..]
export function place(q, a, vx, vy, vz, p, b, out, o) {
    const w = q[a],
        x = q[a + 1],
        y = q[a + 2],
        z = q[a + 3];
    const tx = 2 * (y * vz - z * vy),
        ty = 2 * (z * vx - x * vz),
        tz = 2 * (x * vy - y * vx);
    out[o] = p[b] + vx + w * tx + y * tz - z * ty;
    out[o + 1] = p[b + 1] + vy + w * ty + z * tx - x * tz;
    out[o + 2] = p[b + 2] + vz + w * tz + x * ty - y * tx;
}

// `local` has the rotation (w x y z) of each segment in its parent's frame, `root` the pelvis' place
// (m); the result has [x y z qw qx qy qz] of each segment, as the library's himc_pose_to_state.
export function forward(local, out = new Float64Array(7 * segments.length), origin = usual, root = origin) {
    segments.forEach((s, i) => {
        const o = 7 * i,
            l = 4 * i,
            p = 7 * s.parent;
        if (s.parent < 0) {
            for (let k = 0; k < 3; k++) out[o + k] = root[k];
            for (let k = 0; k < 4; k++) out[o + 3 + k] = local[k];
            return;
        }
        const [x, y, z] = [origin[3 * i], origin[3 * i + 1], origin[3 * i + 2]];
        place(out, p + 3, x, y, z, out, p, out, o);
        const [a, b, c, d] = [out[p + 3], out[p + 4], out[p + 5], out[p + 6]],
            [e, f, g, h] = [local[l], local[l + 1], local[l + 2], local[l + 3]];
        out[o + 3] = a * e - b * f - c * g - d * h;
        out[o + 4] = a * f + b * e + c * h - d * g;
        out[o + 5] = a * g - b * h + c * e + d * f;
        out[o + 6] = a * h + b * g - c * f + d * e;
    });
    return out;
}

// the default performer's body; `rotation` gives a joint's rotation vector (rad)
export function kinematics(rotation) {
    const local = new Float64Array(4 * segments.length);
    segments.forEach((s, i) => quaternion(...(i ? rotation(s.joint) : [0, 0, 0]), local, 4 * i));
    return forward(local);
}
