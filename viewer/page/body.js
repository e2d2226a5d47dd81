// Forward kinematics of the default performer, from the library's own table of segments
// (skeleton.js, made by tools/skeleton/table.c when the viewer is built).
import * as THREE from "./three.js";
import { segments, root } from "./skeleton.js";

export const HANDS = ["left", "right"]; // in the library's order

// "elbow" of "left-elbow" and "right-elbow"
export const jointKind = joint => joint.replace(/^(left|right)-/, "");

const index = new Map(segments.map((s, i) => [s.name, i]));

// Index of a segment; a name that the table does not have is a mistake in the page.
export function bone(name) {
    if (!index.has(name)) throw new Error(`no segment is called ${name}`);
    return index.get(name);
}

// `rotation` gives a joint's rotation vector (rad); the result has [x y z qw qx qy qz] of each
// segment, as the library's himc_pose_to_state.
export function kinematics(rotation, out = new Float64Array(7 * segments.length)) {
    const q = segments.map(() => new THREE.Quaternion()),
        p = segments.map(() => new THREE.Vector3());
    segments.forEach((s, i) => {
        if (s.parent < 0) p[i].set(...root);
        else {
            const r = rotation(s.joint),
                angle = Math.hypot(...r);
            if (angle > 1e-12)
                q[i].setFromAxisAngle(new THREE.Vector3(...r).divideScalar(angle), angle);
            q[i].premultiply(q[s.parent]);
            p[i]
                .set(...s.origin)
                .applyQuaternion(q[s.parent])
                .add(p[s.parent]);
        }
        out.set([p[i].x, p[i].y, p[i].z, q[i].w, q[i].x, q[i].y, q[i].z], 7 * i);
    });
    return out;
}
