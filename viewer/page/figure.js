// The figure: a mannequin, a matte shell for each segment and dark balls between them, modelled once
// round the default skeleton in a seated rest pose, then moved by the segments of a pose. Lengths in
// metres, in each segment's frame (zero pose: x forward, y left, z up).
import * as THREE from "./three.js";
import { rgb } from "./color.js";
import { cone, ellipsoid, sculpt } from "./sculpt.js";
import { HANDS, bone, jointKind, kinematics } from "./body.js";
import { segments, tip, malletRadius } from "./skeleton.js";

const BUTT = 0.1; // length of the stick behind the grip: the library's default grip (m)

// Rotation vectors of the rest pose (rad), for a pair of joints the left one. Chosen: seated, close
// to the playing poses, so that the skin is deformed little. Joints that are not listed are at
// zero.
const rest = {
    waist: [0, 0.09, 0],
    neck: [0, 0.11, 0],
    head: [0, 0.11, 0],
    shoulder: [0.32, -0.1, -0.3],
    elbow: [0, -1.35, 0],
    grip: [0, -0.4, 0],
    hip: [0.228, -0.998, 0.41],
    knee: [0, 1.015, 0],
};

const kinds = new Set(segments.map(s => jointKind(s.joint)));
for (const name in rest) if (!kinds.has(name)) throw new Error(`no joint is called ${name}`);

// the right side mirrors the left one
function restRotation(joint) {
    const [x, y, z] = rest[jointKind(joint)] || [0, 0, 0];
    return joint.startsWith("right-") ? [-x, y, -z] : [x, y, z];
}

// f(side, sign of y) for both sides of the body
const both = f => HANDS.flatMap(side => f(side, side === "left" ? 1 : -1));

// The parts below: solids of one segment each, so that nothing stretches; between them balls, where
// the body bends. All sizes: chosen by eye.
const part = (cell, soft, solids, extra = {}) => ({ cell, soft, blend: 0.01, solids, ...extra });

// flattens what `solid` covers: its own width of the joint with what came before (m)
const joined = (solid, soft) => ({ ...solid, soft });

function chest() {
    const t = bone("trunk");
    return part(0.014, 0.07, [
        ellipsoid(t, [0.012, 0, 0.26], [0.1, 0.142, 0.13]),
        ellipsoid(t, [0.004, 0, 0.17], [0.088, 0.118, 0.11]),
        ...both((s, y) => [
            joined(ellipsoid(t, [0.052, 0.062 * y, 0.272], [0.056, 0.07, 0.062]), 0.05),
            joined(
                cone(t, [-0.012, 0.03 * y, 0.338], 0.046, [-0.004, 0.13 * y, 0.335], 0.05),
                0.06,
            ),
            joined(ellipsoid(t, [-0.055, 0.075 * y, 0.27], [0.045, 0.062, 0.085]), 0.05),
        ]),
        joined(cone(t, [-0.01, 0, 0.335], 0.062, [-0.008, 0, 0.362], 0.05), 0.04),
    ]);
}

function belly() {
    const t = bone("trunk"),
        p = bone("pelvis");
    return part(
        0.014,
        0.05,
        [
            ellipsoid(t, [0.002, 0, 0.1], [0.08, 0.107, 0.1]),
            ellipsoid(t, [0, 0, 0.02], [0.084, 0.112, 0.1]),
            ellipsoid(p, [0, 0, 0.09], [0.086, 0.115, 0.09]),
        ],
        { blend: 0.06 },
    );
}

function hips() {
    const p = bone("pelvis");
    return part(0.013, 0.06, [
        ellipsoid(p, [-0.004, 0, 0.045], [0.1, 0.138, 0.08]),
        ...both((s, y) => [ellipsoid(p, [-0.035, 0.072 * y, -0.012], [0.088, 0.082, 0.082])]),
    ]);
}

function upperArm(side) {
    const u = bone(side + "-upper-arm");
    return part(0.0105, 0.05, [
        cone(u, [0, 0, -0.05], 0.049, [0, 0, -0.235], 0.0385),
        ellipsoid(u, [0.008, 0, -0.14], [0.046, 0.042, 0.09]),
    ]);
}

function forearm(side) {
    const f = bone(side + "-forearm");
    return part(0.0095, 0.04, [
        cone(f, [0, 0, -0.045], 0.0375, [0, 0, -0.237], 0.024),
        ellipsoid(f, [0.004, 0, -0.095], [0.041, 0.043, 0.075]),
    ]);
}

// The hand holds the stick between thumb and index finger; the other three are closed round it.
// Each finger: knuckle, two joints and tip, y outwards from the stick.
const FINGERS = [
    [
        [0.018, -0.002, -0.079],
        [0.007, 0.0165, -0.113],
        [-0.011, 0.0135, -0.112],
        [-0.0165, -0.002, -0.1],
    ],
    [
        [0.021, 0.018, -0.081],
        [0.004, 0.027, -0.115],
        [-0.019, 0.024, -0.105],
        [-0.027, 0.011, -0.087],
    ],
    [
        [0.018, 0.037, -0.075],
        [-0.002, 0.044, -0.105],
        [-0.024, 0.037, -0.092],
        [-0.03, 0.02, -0.074],
    ],
    [
        [0.011, 0.053, -0.066],
        [-0.006, 0.057, -0.09],
        [-0.024, 0.048, -0.078],
        [-0.03, 0.031, -0.063],
    ],
];
const THUMB = [
    [-0.006, -0.014, -0.022],
    [-0.008, -0.03, -0.05],
    [-0.002, -0.0225, -0.082],
    [0.004, -0.0145, -0.107],
];
const FINGER_RADII = [0.0115, 0.0098, 0.0088, 0.0078],
    THUMB_RADII = [0.0165, 0.0135, 0.0112, 0.0094];

// three bones in a row through four points
const digit = (h, y, points, radii, size, soft) =>
    [0, 1, 2].map(i => {
        const at = ([px, py, pz]) => [px, py * y, pz];
        return joined(
            cone(h, at(points[i]), size * radii[i], at(points[i + 1]), size * radii[i + 1]),
            i ? 0.004 : soft,
        );
    });

function hand(side) {
    const h = bone(side + "-hand"),
        y = side === "left" ? 1 : -1;
    const size = [1, 1.04, 1, 0.86];
    return part(0.0042, 0.014, [
        cone(h, [0.001, 0.002 * y, -0.012], 0.0255, [0.004, 0.012 * y, -0.035], 0.024),
        ...FINGERS.map(([k], i) =>
            joined(
                cone(
                    h,
                    [0.004, (-0.006 + 0.011 * i) * y, -0.028],
                    0.0165,
                    [k[0] - 0.003, k[1] * y, k[2] + 0.004],
                    0.0125 * size[i],
                ),
                0.018,
            ),
        ),
        joined(ellipsoid(h, [-0.012, 0.036 * y, -0.03], [0.015, 0.017, 0.028]), 0.016),
        ...FINGERS.flatMap((f, i) => digit(h, y, f, FINGER_RADII, size[i], 0.006)),
        ...digit(h, y, THUMB, THUMB_RADII, 1, 0.016),
    ]);
}

// A head without a face: brow, nose and chin say which way it looks.
function head() {
    const h = bone("head");
    return part(0.0066, 0.03, [
        ellipsoid(h, [-0.01, 0, 0.122], [0.094, 0.0735, 0.084]),
        ellipsoid(h, [0.018, 0, 0.07], [0.066, 0.056, 0.088]),
        joined(ellipsoid(h, [0.048, 0, 0.006], [0.032, 0.03, 0.026]), 0.045),
        ...both((s, y) => [
            joined(
                cone(h, [-0.012, 0.05 * y, 0.045], 0.014, [0.045, 0.02 * y, 0.005], 0.014),
                0.04,
            ),
            joined(ellipsoid(h, [0.05, 0.034 * y, 0.06], [0.024, 0.022, 0.026]), 0.04),
            joined(ellipsoid(h, [-0.008, 0.0715 * y, 0.08], [0.018, 0.008, 0.026]), 0.008),
        ]),
        joined(ellipsoid(h, [0.056, 0, 0.036], [0.032, 0.034, 0.04]), 0.03),
        joined(cone(h, [0.07, 0, 0.112], 0.01, [0.079, 0, 0.07], 0.011), 0.03),
    ]);
}

function neck() {
    const n = bone("neck"),
        t = bone("trunk"),
        h = bone("head");
    return part(
        0.009,
        0.03,
        [
            cone(t, [-0.01, 0, 0.35], 0.05, [-0.008, 0, 0.385], 0.046),
            cone(n, [-0.006, 0, 0], 0.046, [-0.004, 0, 0.06], 0.044),
            cone(h, [-0.008, 0, -0.015], 0.044, [-0.004, 0, 0.012], 0.042),
        ],
        { blend: 0.03 },
    );
}

function thigh(side) {
    const l = bone(side + "-upper-leg");
    return part(0.013, 0.06, [
        cone(l, [0, 0, -0.005], 0.081, [0, 0, -0.365], 0.0545),
        ellipsoid(l, [0.014, 0, -0.19], [0.074, 0.071, 0.13]),
    ]);
}

function shin(side) {
    const l = bone(side + "-lower-leg");
    return part(0.012, 0.05, [
        cone(l, [0.004, 0, -0.07], 0.05, [0, 0, -0.38], 0.035),
        ellipsoid(l, [-0.014, 0, -0.14], [0.054, 0.053, 0.1]),
    ]);
}

function shoe(side) {
    const f = bone(side + "-foot"),
        sole = (d, local, x, y, z) => Math.max(d, -(local(f, x, y, z)[2] + 0.075));
    return part(
        0.0095,
        0.03,
        [
            cone(f, [-0.012, 0, -0.02], 0.037, [-0.02, 0, -0.047], 0.036),
            cone(f, [0, 0, -0.03], 0.036, [0.125, 0, -0.052], 0.033),
            joined(ellipsoid(f, [0.125, 0, -0.055], [0.055, 0.042, 0.028]), 0.03),
        ],
        { shape: sole },
    );
}

function toes(side) {
    const t = bone(side + "-toes"),
        sole = (d, local, x, y, z) => Math.max(d, -(local(t, x, y, z)[2] + 0.025));
    return part(0.0085, 0.02, [ellipsoid(t, [0.02, 0, -0.006], [0.056, 0.04, 0.026])], {
        shape: sole,
    });
}

// the balls at the joints of a side: segment, radius
const BALLS = [
    ["upper-arm", 0.047],
    ["forearm", 0.034],
    ["hand", 0.0235],
    ["lower-leg", 0.049],
    ["foot", 0.0335],
];

const look = (color, roughness, extra = {}) => ({ color, roughness, metalness: 0, ...extra });

// what is drawn with one material; `ofHead` is hidden from the performer's own eye
const surfaces = () => [
    { material: "shirt", parts: [chest(), ...HANDS.map(upperArm)] },
    { material: "skin", parts: [...HANDS.map(forearm), ...HANDS.map(hand)] },
    { material: "skin", parts: [head()], ofHead: true },
    { material: "dark", parts: [neck()], ofHead: true },
    { material: "trousers", parts: [hips(), ...HANDS.map(thigh), ...HANDS.map(shin)] },
    { material: "shoes", parts: [...HANDS.map(shoe), ...HANDS.map(toes)] },
    {
        material: "dark",
        parts: [
            belly(),
            ...HANDS.flatMap(side =>
                BALLS.map(([name, r]) =>
                    part(r / 5, 0.01, [ellipsoid(bone(`${side}-${name}`), [0, 0, 0], [r, r, r])]),
                ),
            ),
        ],
    },
];
export const shirts = [
    "#35557d",
    "#83403f",
    "#3a6b56",
    "#7d5f35",
    "#5f4d80",
    "#386b75",
    "#8f543c",
    "#525b66",
];

let model; // geometry, the same for all performers
function sharedModel() {
    if (model) return model;
    const at = kinematics(restRotation);
    const matrices = segments.map((s, i) =>
        new THREE.Matrix4().compose(
            new THREE.Vector3(at[7 * i], at[7 * i + 1], at[7 * i + 2]),
            new THREE.Quaternion(at[7 * i + 4], at[7 * i + 5], at[7 * i + 6], at[7 * i + 3]),
            new THREE.Vector3(1, 1, 1),
        ),
    );
    const geometries = surfaces().map(({ parts, material, ofHead }) => ({
        geometry: sculpt(parts, matrices),
        material,
        ofHead,
    }));
    return (model = {
        geometries,
        inverses: matrices.map(m => new THREE.Matrix4().getInverse(m)),
        stick: stickParts(),
    });
}

function lathe(points, detail = 20) {
    const g = new THREE.LatheBufferGeometry(
        points.map(p => new THREE.Vector2(p[0], p[1])),
        detail,
    );
    return g.rotateX(Math.PI / 2); // its axis becomes z
}

function stickParts() {
    const shaft = lathe([
        [0, -tip],
        [0.0052, -tip],
        [0.0058, -0.1],
        [0.0072, 0.02],
        [0.0078, 0.07],
        [0.0062, BUTT - 0.004],
        [0.003, BUTT],
        [0, BUTT],
    ]);
    const felt = new THREE.SphereBufferGeometry(malletRadius, 28, 20);
    felt.scale(1, 1, 0.94);
    const core = new THREE.CylinderBufferGeometry(0.0085, 0.0085, 2 * malletRadius + 0.005, 20);
    core.rotateX(Math.PI / 2);
    return { shaft, felt, core };
}

function materials(index, environment) {
    const make = (o, skinning = true) =>
        new THREE.MeshStandardMaterial({
            ...o,
            skinning,
            envMap: environment,
            envMapIntensity: 0.55,
        });
    return {
        shirt: make(look(rgb(shirts[index % shirts.length]), 0.78)),
        skin: make(look(rgb("#a09488"), 0.72)),
        trousers: make(look(rgb("#2f343e"), 0.8)),
        shoes: make(look(rgb("#191b20"), 0.5)),
        dark: make(look(rgb("#1d2027"), 0.6)),
        wood: make(look(rgb("#d9b27a"), 0.42), false),
        felt: make(look(rgb("#f4efe2"), 0.95), false),
        core: make(look(rgb("#a8452f"), 0.6), false),
    };
}

function shadowed(mesh) {
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.frustumCulled = false;
    return mesh;
}

// a skinned mesh as the figure's bones put it, as the graphics card does
function posed(mesh, { skeleton: { boneMatrices }, group }) {
    const { position, skinIndex, skinWeight } = mesh.geometry.attributes,
        out = new Float32Array(3 * position.count),
        at = new THREE.Vector3(),
        one = new THREE.Matrix4(),
        sum = new THREE.Vector3();
    for (let i = 0; i < position.count; i++) {
        sum.set(0, 0, 0);
        for (let k = 0; k < 4; k++) {
            const weight = skinWeight.array[4 * i + k];
            if (!weight) continue;
            one.fromArray(boneMatrices, 16 * skinIndex.array[4 * i + k]);
            sum.addScaledVector(at.fromBufferAttribute(position, i).applyMatrix4(one), weight);
        }
        sum.toArray(out, 3 * i);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(out, 3));
    geometry.setIndex(mesh.geometry.index);
    const made = new THREE.Mesh(geometry, mesh.material);
    made.matrixWorld.copy(group.matrixWorld);
    return made;
}

// the bone that moves a vertex most
function mainBone({ attributes: { skinIndex, skinWeight } }, vertex) {
    const weights = skinWeight.array.subarray(4 * vertex, 4 * vertex + 4);
    return skinIndex.array[4 * vertex + weights.indexOf(Math.max(...weights))];
}

// A figure in its own group, moved by set(). `bones[i].matrixWorld` is segment i in the group's
// frame.
export class Figure {
    constructor(index, environment) {
        const { geometries, inverses, stick } = sharedModel();
        this.group = new THREE.Group();
        this.bones = segments.map(() => new THREE.Bone());
        this.skeleton = new THREE.Skeleton(this.bones, inverses);
        this.materials = materials(index, environment);
        this.headMeshes = [];
        for (const { geometry, material, ofHead } of geometries) {
            const mesh = shadowed(new THREE.SkinnedMesh(geometry, this.materials[material]));
            mesh.bindMode = "detached"; // bones live in the group's frame
            mesh.bind(this.skeleton, new THREE.Matrix4());
            this.group.add(mesh);
            if (ofHead) this.headMeshes.push(mesh);
        }
        this.sticks = HANDS.map(() => this.makeStick(stick));
        this.scale = new THREE.Vector3(1, 1, 1);
    }

    makeStick(stick) {
        const group = new THREE.Group(),
            felt = shadowed(new THREE.Mesh(stick.felt, this.materials.felt));
        const core = shadowed(new THREE.Mesh(stick.core, this.materials.core));
        felt.position.z = core.position.z = -tip;
        group.add(shadowed(new THREE.Mesh(stick.shaft, this.materials.wood)), felt, core);
        group.tip = felt;
        this.group.add(group);
        return group;
    }

    // pose: [x y z qw qx qy qz] by segment
    set(pose) {
        const p = new THREE.Vector3(),
            q = new THREE.Quaternion(),
            hip = bone("left-upper-leg") * 7,
            knee = bone("left-lower-leg") * 7;
        const thigh = Math.hypot(
            pose[knee] - pose[hip],
            pose[knee + 1] - pose[hip + 1],
            pose[knee + 2] - pose[hip + 2],
        );
        this.scale.setScalar(
            thigh > 0.2 && thigh < 0.8 ? thigh / segments[bone("left-upper-leg")].length : 1,
        );
        for (let i = 0; i < segments.length; i++) {
            const o = 7 * i;
            p.set(pose[o], pose[o + 1], pose[o + 2]);
            q.set(pose[o + 4], pose[o + 5], pose[o + 6], pose[o + 3]);
            this.bones[i].matrixWorld.compose(p, q, this.scale);
        }
        this.sticks.forEach((stick, hand) => {
            const o = 7 * bone(HANDS[hand] + "-stick");
            stick.position.set(pose[o], pose[o + 1], pose[o + 2]);
            stick.quaternion.set(pose[o + 4], pose[o + 5], pose[o + 6], pose[o + 3]);
        });
    }

    // what a ray meets first: { point, segment }; null if nothing
    meet(ray) {
        const caster = new THREE.Raycaster(ray.origin, ray.direction),
            hits = [];
        this.skeleton.update();
        for (const mesh of this.group.children)
            if (mesh.isSkinnedMesh && mesh.visible)
                for (const hit of caster.intersectObject(posed(mesh, this)))
                    hits.push({ ...hit, segment: mainBone(mesh.geometry, hit.face.a) });
        this.sticks.forEach((stick, hand) => {
            for (const hit of caster.intersectObject(stick, true))
                hits.push({ ...hit, segment: bone(HANDS[hand] + "-stick") });
        });
        return hits.sort((a, b) => a.distance - b.distance)[0] ?? null;
    }

    // how far along a segment a point of the scene is, from its joint (m)
    along(segment, point) {
        const m = new THREE.Matrix4().multiplyMatrices(this.group.matrixWorld, this.bones[segment].matrixWorld),
            axis = new THREE.Vector3(...segments[segment].center).normalize();
        return +Math.min(1, Math.max(0, point.clone().applyMatrix4(new THREE.Matrix4().getInverse(m)).dot(axis))).toFixed(2);
    }

    // a point of a segment's frame in the scene (m)
    place(segment, point) {
        return new THREE.Vector3(...point)
            .applyMatrix4(this.bones[segment].matrixWorld)
            .applyMatrix4(this.group.matrixWorld);
    }

    // in one transparent colour, or as ever
    ghost(color) {
        this.glass ??= [true, false].map(
            skinning =>
                new THREE.MeshStandardMaterial({
                    skinning,
                    transparent: true,
                    opacity: 0.2,
                    depthWrite: false,
                    polygonOffset: true, // behind a surface in the same place
                    polygonOffsetFactor: 2,
                    polygonOffsetUnits: 2,
                    roughness: 0.9,
                    emissiveIntensity: 0.35,
                }),
        );
        if (color)
            for (const glass of this.glass) (glass.color.copy(rgb(color)), glass.emissive.copy(rgb(color)));
        this.group.traverse(part => {
            if (!part.isMesh) return;
            part.own ??= part.material;
            part.material = color ? this.glass[part.isSkinnedMesh ? 0 : 1] : part.own;
            part.castShadow = !color;
        });
    }

    // hidden for the camera of the performer's eye
    showHead(yes) {
        for (const mesh of this.headMeshes) mesh.visible = yes;
    }
}
