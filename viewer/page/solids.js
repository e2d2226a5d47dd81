// Solids of wood and metal, and many of them in one geometry: what one material draws at once.
import * as THREE from "./three.js";

// turns (radius, height) round the z axis
export const lathe = (points, detail = 20) =>
    new THREE.LatheBufferGeometry(
        points.map(p => new THREE.Vector2(...p)),
        detail,
    ).rotateX(Math.PI / 2);

const up = new THREE.Vector3(0, 1, 0);

// a round bar from `a` to `b`
export function rod(a, b, radius, ends = true, detail = 10) {
    const [from, to] = [a, b].map(p => new THREE.Vector3(...p)),
        bar = new THREE.CylinderBufferGeometry(radius, radius, from.distanceTo(to), detail, 1, !ends),
        turned = new THREE.Quaternion().setFromUnitVectors(up, to.clone().sub(from).normalize());
    return bar.applyMatrix(
        new THREE.Matrix4().compose(from.add(to).multiplyScalar(0.5), turned, new THREE.Vector3(1, 1, 1)),
    );
}

export const ring = (radius, tube, z, detail = 64) =>
    new THREE.TorusBufferGeometry(radius, tube, 8, detail).translate(0, 0, z);

// one geometry of all; `colors`, if given, has the colour of each
export function joined(parts, colors) {
    const out = new THREE.BufferGeometry(),
        size = parts.reduce((n, g) => n + g.attributes.position.count, 0),
        index = [];
    for (const [name, width] of [
        ["position", 3],
        ["normal", 3],
        ["uv", 2],
    ]) {
        const all = new Float32Array(width * size);
        let at = 0;
        for (const g of parts) (all.set(g.attributes[name].array, at), (at += g.attributes[name].array.length));
        out.setAttribute(name, new THREE.BufferAttribute(all, width));
    }
    let first = 0;
    const color = colors && new Float32Array(3 * size);
    parts.forEach((g, i) => {
        for (const k of g.index.array) index.push(first + k);
        const end = first + g.attributes.position.count;
        for (; first < end; first++) if (color) colors[i].toArray(color, 3 * first);
        g.dispose();
    });
    if (color) out.setAttribute("color", new THREE.BufferAttribute(color, 3));
    out.setIndex(index);
    return out;
}
