// What carries one who sits freely: the forces of seat and floor as slim arrows, as long as the force and
// in its direction, and the centre of pressure on the floor. Sizes and colours: chosen by eye.
import * as THREE from "./three.js";
import { rgb } from "./color.js";
import { HANDS, bone } from "./body.js";
import { Arrow } from "./strike.js";
import { supportColor } from "./timeline.js";

const LENGTH = 0.0008, // of an arrow (m/N)
    STRONGEST = 1500, // no arrow grows beyond this force (N)
    LEAST = 2, // (N) a foot that hangs
    POINT = 0.045, // of an arrow, before its shaft (m)
    WHOLE = 0.1, // a shorter arrow is smaller as a whole (m)
    SEAT = 0.12, // radius of what carries (m)
    SOLE = [0.05, 0, -0.07]; // its middle, of a foot (m)

// a ring with a dot, flat on the floor
function target() {
    const material = new THREE.MeshBasicMaterial({ color: rgb(supportColor[0]), transparent: true, opacity: 0.85, depthWrite: false }),
        ring = new THREE.Mesh(new THREE.RingBufferGeometry(0.036, 0.042, 48), material),
        dot = new THREE.Mesh(new THREE.CircleBufferGeometry(0.01, 24), material),
        group = new THREE.Group();
    group.position.z = 0.004;
    return group.add(ring, dot);
}

export class Supports {
    constructor() {
        this.arrows = supportColor.map(color => {
            const arrow = new Arrow({ depthTest: false, opacity: 0.85 });
            for (const part of arrow.group.children) part.renderOrder = 9;
            return Object.assign(arrow, { color });
        });
        this.center = target();
        this.group = new THREE.Group();
        this.group.add(this.center, ...this.arrows.map(a => a.group));
    }

    // of a performer's pose, in its group's frame; `near` scales the writing
    update({ support, pose, figure, stool }, shown, near) {
        this.group.visible = shown && support[2] + support[5] + support[8] > LEAST;
        if (!this.group.visible) return;
        const force = i => new THREE.Vector3(...support.slice(3 * i, 3 * i + 3)),
            center = force(3),
            all = force(0).add(force(1)).add(force(2));
        const under = side => new THREE.Vector3(...SOLE).applyMatrix4(figure.bones[bone(`${side}-foot`)].matrixWorld).setZ(0),
            seat = stool.position.clone().setZ(0),
            hips = new THREE.Vector3(pose[0], pose[1], 0).sub(seat).clampLength(0, SEAT),
            at = [seat.add(hips).setZ(stool.cushion.position.z), ...HANDS.map(under)];
        this.arrows.forEach((arrow, i) => this.draw(arrow, at[i], force(i), near));
        // from the plane of the seat, along the force, down to the floor
        this.center.position.x = center.x - (all.x / all.z) * center.z;
        this.center.position.y = center.y - (all.y / all.z) * center.z;
    }

    // it ends at its point, and begins where the body is pressed
    draw(arrow, at, force, near) {
        const newtons = force.length(),
            along = force.clone().divideScalar(newtons || 1),
            length = LENGTH * Math.min(newtons, STRONGEST);
        arrow.group.visible = newtons > LEAST;
        if (!arrow.group.visible) return;
        arrow.group.position.copy(at).addScaledVector(along, length);
        arrow.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), along.negate());
        arrow.write(newtons, arrow.color);
        const size = Math.min(1, length / WHOLE);
        arrow.group.scale.setScalar(size);
        arrow.stretch(length / size - POINT, near / size);
    }
}
