// A smooth surface from simple solids (tapered capsules and ellipsoids): their distances are joined
// by a smooth minimum, the surface is meshed with naive surface nets (Gibson 1998), normals are the
// gradient of the distance, skin weights follow the distance to the solids of each bone.
import * as THREE from "./three.js";

const BLOCK = 4, // cells
    TRUST = 0.5; // a distance is at least so much of itself; chosen: parts change the distances of solids

// distance to a cone with round ends (Quilez, "Round cone", 2018)
export function cone(bone, a, ra, b, rb) {
    const ba = b.map((v, i) => v - a[i]);
    const l2 = ba[0] * ba[0] + ba[1] * ba[1] + ba[2] * ba[2],
        rr = ra - rb,
        a2 = l2 - rr * rr,
        il2 = 1 / l2;
    return {
        bone,
        reach: Math.max(ra, rb),
        ends: [a, b],
        distance(x, y, z) {
            const px = x - a[0],
                py = y - a[1],
                pz = z - a[2];
            const s = px * ba[0] + py * ba[1] + pz * ba[2],
                t = s - l2;
            const ux = px * l2 - ba[0] * s,
                uy = py * l2 - ba[1] * s,
                uz = pz * l2 - ba[2] * s;
            const x2 = ux * ux + uy * uy + uz * uz,
                y2 = s * s * l2,
                z2 = t * t * l2;
            const k = Math.sign(rr) * rr * rr * x2;
            if (Math.sign(t) * a2 * z2 > k) return Math.sqrt(x2 + z2) * il2 - rb;
            if (Math.sign(s) * a2 * y2 < k) return Math.sqrt(x2 + y2) * il2 - ra;
            return (Math.sqrt(x2 * a2 * il2) + s * rr) * il2 - ra;
        },
    };
}

// distance to an ellipsoid, approximate (Quilez, "Ellipsoid SDF", 2008)
export function ellipsoid(bone, c, r) {
    return {
        bone,
        reach: Math.max(...r),
        ends: [c],
        distance(x, y, z) {
            const px = (x - c[0]) / r[0],
                py = (y - c[1]) / r[1],
                pz = (z - c[2]) / r[2];
            const k0 = Math.hypot(px, py, pz),
                k1 = Math.hypot(px / r[0], py / r[1], pz / r[2]);
            return k1 > 1e-9 ? (k0 * (k0 - 1)) / k1 : -Math.min(...r);
        },
    };
}

// smooth minimum, quadratic over a width k (Quilez, "Smooth minimum", 2013)
export function smoothMin(a, b, k) {
    const h = Math.max(k - Math.abs(a - b), 0) / k;
    return Math.min(a, b) - h * h * k * 0.25;
}

// distance of a point of the world to a part, by the inverse of each bone's rest matrix
function field(part, rest) {
    const inverse = rest.map(m => new THREE.Matrix4().getInverse(m).elements);
    const near = (s, x, y, z) => {
        const e = inverse[s.bone];
        return s.distance(
            e[0] * x + e[4] * y + e[8] * z + e[12],
            e[1] * x + e[5] * y + e[9] * z + e[13],
            e[2] * x + e[6] * y + e[10] * z + e[14],
        );
    };
    const local = (bone, x, y, z) => {
        const e = inverse[bone];
        return [
            e[0] * x + e[4] * y + e[8] * z + e[12],
            e[1] * x + e[5] * y + e[9] * z + e[13],
            e[2] * x + e[6] * y + e[10] * z + e[14],
        ];
    };
    const distance = (x, y, z) => {
        let d = 1e9;
        for (const s of part.solids) d = smoothMin(d, near(s, x, y, z), s.soft || part.soft);
        for (const s of part.cut || []) d = -smoothMin(-d, near(s, x, y, z), part.cutSoft || 0.01);
        if (part.shape) d = part.shape(d, local, x, y, z);
        return d;
    };
    return { distance, near };
}

function bounds(part, rest) {
    const box = new THREE.Box3();
    for (const s of part.solids)
        for (const end of s.ends) {
            const p = new THREE.Vector3(...end).applyMatrix4(rest[s.bone]);
            box.expandByPoint(p.clone().addScalar(s.reach + 0.03)).expandByPoint(
                p.addScalar(-s.reach - 0.03),
            );
        }
    return box;
}

// one vertex in each cell that the surface crosses, at the mean of the crossings on its edges; one
// quad over each crossed edge
function mesh(distance, box, h) {
    const n = ["x", "y", "z"].map(a => Math.ceil((box.max[a] - box.min[a]) / h) + 1),
        [nx, ny, nz] = n;
    const d = new Float32Array(nx * ny * nz),
        cell = new Int32Array(nx * ny * nz).fill(-1);
    const at = (i, j, k) => (k * ny + j) * nx + i;
    // a block far from the surface is wholly on one side of it
    const half = (BLOCK - 1) / 2,
        far = (half * Math.sqrt(3) * h) / TRUST;
    for (let k = 0; k < nz; k += BLOCK)
        for (let j = 0; j < ny; j += BLOCK)
            for (let i = 0; i < nx; i += BLOCK) {
                const v = distance(box.min.x + (i + half) * h, box.min.y + (j + half) * h, box.min.z + (k + half) * h),
                    beyond = Math.abs(v) > far;
                for (let c = k; c < Math.min(nz, k + BLOCK); c++)
                    for (let b = j; b < Math.min(ny, j + BLOCK); b++)
                        for (let a = i; a < Math.min(nx, i + BLOCK); a++)
                            d[at(a, b, c)] = beyond ? v : distance(box.min.x + a * h, box.min.y + b * h, box.min.z + c * h);
            }
    const corners = [
        [0, 0, 0],
        [1, 0, 0],
        [0, 1, 0],
        [1, 1, 0],
        [0, 0, 1],
        [1, 0, 1],
        [0, 1, 1],
        [1, 1, 1],
    ];
    const edges = [
        [0, 1],
        [2, 3],
        [4, 5],
        [6, 7],
        [0, 2],
        [1, 3],
        [4, 6],
        [5, 7],
        [0, 4],
        [1, 5],
        [2, 6],
        [3, 7],
    ];
    const position = [],
        index = [],
        offsets = corners.map(c => at(...c));
    for (let k = 0; k < nz - 1; k++)
        for (let j = 0; j < ny - 1; j++)
            for (let i = 0; i < nx - 1; i++) {
                const from = at(i, j, k),
                    outside = d[from] > 0;
                if (offsets.every(o => d[from + o] > 0 === outside)) continue;
                const v = offsets.map(o => d[from + o]);
                let count = 0,
                    x = 0,
                    y = 0,
                    z = 0;
                for (const [a, b] of edges)
                    if (v[a] > 0 !== v[b] > 0) {
                        const t = v[a] / (v[a] - v[b]),
                            p = corners[a],
                            q = corners[b];
                        ((x += p[0] + t * (q[0] - p[0])),
                            (y += p[1] + t * (q[1] - p[1])),
                            (z += p[2] + t * (q[2] - p[2])));
                        count++;
                    }
                cell[at(i, j, k)] = position.length / 3;
                position.push(
                    box.min.x + (i + x / count) * h,
                    box.min.y + (j + y / count) * h,
                    box.min.z + (k + z / count) * h,
                );
            }
    const quad = (a, b, c, e, flip) =>
        flip ? index.push(a, b, c, a, c, e) : index.push(a, c, b, a, e, c);
    for (let k = 1; k < nz - 1; k++)
        for (let j = 1; j < ny - 1; j++)
            for (let i = 1; i < nx - 1; i++) {
                const v = d[at(i, j, k)] > 0;
                if (v !== d[at(i + 1, j, k)] > 0)
                    quad(
                        cell[at(i, j, k)],
                        cell[at(i, j - 1, k)],
                        cell[at(i, j - 1, k - 1)],
                        cell[at(i, j, k - 1)],
                        !v,
                    );
                if (v !== d[at(i, j + 1, k)] > 0)
                    quad(
                        cell[at(i, j, k)],
                        cell[at(i, j, k - 1)],
                        cell[at(i - 1, j, k - 1)],
                        cell[at(i - 1, j, k)],
                        !v,
                    );
                if (v !== d[at(i, j, k + 1)] > 0)
                    quad(
                        cell[at(i, j, k)],
                        cell[at(i - 1, j, k)],
                        cell[at(i - 1, j - 1, k)],
                        cell[at(i, j - 1, k)],
                        !v,
                    );
            }
    return { position, index };
}

function skinWeights(part, near, x, y, z) {
    const nearest = new Map();
    for (const s of part.solids)
        nearest.set(
            s.bone,
            Math.min(near(s, x, y, z), nearest.has(s.bone) ? nearest.get(s.bone) : 1e9),
        );
    const sorted = [...nearest].sort((a, b) => a[1] - b[1]).slice(0, 4);
    const weight = sorted.map(([, d]) => Math.exp(-(((d - sorted[0][1]) / part.blend) ** 2)));
    const sum = weight.reduce((a, b) => a + b);
    const fill = (list, value) => [...list, value, value, value, value].slice(0, 4);
    return {
        bones: fill(
            sorted.map(s => s[0]),
            0,
        ),
        weights: fill(
            weight.map(w => w / sum),
            0,
        ),
    };
}

// One skinned geometry from parts and the rest matrices of the bones. Part: solids; soft, the width
// of their joints (m); color, a name kept by vertex in userData.paint; blend, of the change from bone to bone (m); cell, of the mesh (m); cut,
// solids taken away; shape, a function that changes the distance. Cells are
// `coarse` times as wide.
export function sculpt(parts, rest, coarse) {
    const all = { position: [], index: [], normal: [], bones: [], weights: [], paint: [] };
    for (const part of parts) carve({ ...part, cell: coarse * part.cell }, rest, all);
    const geometry = new THREE.BufferGeometry();
    geometry.userData.paint = all.paint;
    geometry.setIndex(all.index);
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(all.position, 3));
    geometry.setAttribute("normal", new THREE.Float32BufferAttribute(all.normal, 3));
    geometry.setAttribute("skinIndex", new THREE.Uint16BufferAttribute(all.bones, 4));
    geometry.setAttribute("skinWeight", new THREE.Float32BufferAttribute(all.weights, 4));
    return geometry;
}

// adds a part's surface to `all`
function carve(part, rest, all) {
    const { distance, near } = field(part, rest);
    const { position, index } = mesh(distance, bounds(part, rest), part.cell);
    const first = all.position.length / 3,
        e = part.cell * 0.5;
    for (const i of index) all.index.push(first + i);
    for (let i = 0; i < position.length; i += 3) {
        const [x, y, z] = position.slice(i, i + 3);
        const g = [
                distance(x + e, y, z) - distance(x - e, y, z),
                distance(x, y + e, z) - distance(x, y - e, z),
                distance(x, y, z + e) - distance(x, y, z - e),
            ],
            l = Math.hypot(...g) || 1;
        all.position.push(x, y, z);
        all.paint.push(part.color);
        all.normal.push(g[0] / l, g[1] / l, g[2] / l);
        const w = skinWeights(part, near, x, y, z);
        all.bones.push(...w.bones);
        all.weights.push(...w.weights);
    }
}
