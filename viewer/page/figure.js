// The figure: a seated player in shirt and trousers, modelled once round the default skeleton in a rest pose, then moved by the segments of a pose. Lengths in
// metres, in each segment's frame (zero pose: x forward, y left, z up).
import * as THREE from "./three.js";
import { rgb } from "./color.js";
import { cone, ellipsoid, sculpt, smoothMin } from "./sculpt.js";
import { joined as merge, lathe } from "./solids.js";
import { HANDS, bone, jointKind, kinematics } from "./body.js";
import { segments, tip, malletRadius } from "./skeleton.js";

const EYES_TURN = 0.5; // (rad); chosen: beyond it the head turns
const BUTT = 0.1; // length of the stick behind the grip: the library's default grip (m)

// Rotation vectors of the rest pose (rad), for a pair of joints the left one. Chosen: seated, close
// to the playing poses, so that the skin is deformed little. Joints that are not listed are at
// zero.
const rest = {
    waist: [0, 0.09, 0],
    neck: [0, 0.18, 0],
    head: [0, 0.18, 0],
    shoulder: [0.4, -0.1, -0.2],
    elbow: [0, -1.5, 0],
    grip: [-0.2, -0.36, 0], // between the german and the french grip
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

// The parts below: a surface each, over as many segments as bend it. All sizes: chosen by eye.
const part = (color, cell, soft, solids, extra = {}) => ({ color, cell, soft, blend: 0.03, solids, ...extra });

// flattens what `solid` covers: its own width of the joint with what came before (m)
const joined = (solid, soft) => ({ ...solid, soft });

// trunk and sleeves, rolled up below the elbow
function shirt() {
    const t = bone("trunk"),
        p = bone("pelvis");
    return part("shirt", 0.0145, 0.06, [
        ellipsoid(t, [0.012, 0, 0.26], [0.1, 0.142, 0.13]),
        ellipsoid(t, [0.004, 0, 0.17], [0.09, 0.12, 0.11]),
        ellipsoid(t, [0, 0, 0.06], [0.087, 0.115, 0.12]),
        ellipsoid(p, [-0.004, 0, 0.085], [0.095, 0.126, 0.075]),
        joined(cone(t, [-0.01, 0, 0.34], 0.062, [-0.003, 0, 0.374], 0.0535), 0.03),
        ...both((s, y) => {
            const u = bone(s + "-upper-arm"),
                f = bone(s + "-forearm");
            return [
                joined(ellipsoid(t, [0.052, 0.062 * y, 0.272], [0.056, 0.07, 0.062]), 0.05),
                joined(ellipsoid(t, [-0.055, 0.075 * y, 0.27], [0.045, 0.062, 0.085]), 0.05),
                // from the neck over the shoulder blade, and along the collar bone
                joined(cone(t, [-0.022, 0.03 * y, 0.362], 0.036, [-0.014, 0.15 * y, 0.337], 0.045), 0.05),
                joined(cone(t, [0.03, 0.02 * y, 0.335], 0.03, [0.012, 0.15 * y, 0.338], 0.042), 0.04),
                joined(ellipsoid(u, [0.002, 0.004 * y, -0.024], [0.056, 0.051, 0.075]), 0.045),
                joined(cone(u, [0, 0, -0.05], 0.049, [0, 0, -0.27], 0.0405), 0.02),
                joined(ellipsoid(u, [0.008, 0, -0.14], [0.048, 0.044, 0.09]), 0.03),
                joined(cone(f, [0.001, 0, -0.012], 0.0415, [0, 0, -0.045], 0.0415), 0.02),
            ];
        }),
    ]);
}

// the edge of a sleeve, rolled up
function cuff(side) {
    const f = bone(side + "-forearm"),
        edges = (d, local, x, y, z) => -smoothMin(-d, 0.016 - Math.abs(local(f, x, y, z)[2] + 0.066), 0.008);
    return part("shirt", 0.007, 0.01, [cone(f, [0, 0, -0.03], 0.0465, [0, 0, -0.1], 0.0455)], { shape: edges });
}

function forearm(side) {
    const f = bone(side + "-forearm"),
        h = bone(side + "-hand"),
        y = side === "left" ? 1 : -1;
    return part("skin", 0.011, 0.04, [
        cone(f, [0, 0, -0.08], 0.034, [0, 0, -0.225], 0.0255),
        joined(ellipsoid(f, [0.003, 0, -0.115], [0.038, 0.039, 0.07]), 0.02),
        joined(ellipsoid(f, [0.002, 0.002 * y, -0.25], [0.02, 0.027, 0.04]), 0.03),
        joined(ellipsoid(h, [0.003, 0.003 * y, -0.008], [0.0195, 0.0275, 0.03]), 0.02),
    ]);
}

// The hand holds the stick between thumb and index finger, the other three are closed round it. Each
// finger: knuckle, two joints and tip, in the left hand's frame, in the rest pose; y outwards from the
// stick.
const FINGERS = [
    [
        [0.018, -0.004, -0.076],
        [0.018, 0.0125, -0.112],
        [-0.003, 0.016, -0.114],
        [-0.0145, 0.004, -0.1],
    ],
    [
        [0.021, 0.018, -0.079],
        [0.003, 0.0275, -0.116],
        [-0.02, 0.0255, -0.103],
        [-0.0185, 0.014, -0.08],
    ],
    [
        [0.018, 0.037, -0.074],
        [-0.002, 0.044, -0.108],
        [-0.024, 0.037, -0.092],
        [-0.0245, 0.019, -0.066],
    ],
    [
        [0.011, 0.053, -0.065],
        [-0.006, 0.058, -0.092],
        [-0.025, 0.051, -0.08],
        [-0.031, 0.03, -0.058],
    ],
];
const THUMB = [
    [-0.004, -0.012, -0.02],
    [-0.009, -0.031, -0.048],
    [-0.008, -0.0235, -0.075],
    [0.002, -0.0155, -0.102],
];
const FINGER_RADII = [0.0115, 0.0098, 0.0088, 0.0078],
    THUMB_RADII = [0.0165, 0.0132, 0.011, 0.0088];

// a point of the left hand's frame in its stick's, in the rest pose
const turnedBack = new THREE.Quaternion().setFromAxisAngle(
    new THREE.Vector3(...rest.grip).normalize(),
    -Math.hypot(...rest.grip),
);
const held = point =>
    new THREE.Vector3(...point).sub(new THREE.Vector3(...segments[bone("left-stick")].origin)).applyQuaternion(turnedBack).toArray();

// Three bones in a row through four points. The last is on the stick, which it holds, the one before on
// both: a stick that turns in the hand opens the fingers.
function digit(side, y, points, radii, size, soft) {
    const moved = [[`${side}-hand`], [`${side}-hand`, `${side}-stick`], [`${side}-stick`]];
    return moved.flatMap((bones, i) =>
        bones.map(name => {
            const [from, to] = [points[i], points[i + 1]]
                .map(name.endsWith("stick") ? held : q => q)
                .map(([px, py, pz]) => [px, py * y, pz]);
            return joined(cone(bone(name), from, size * radii[i], to, size * radii[i + 1]), i ? 0.004 : soft);
        }),
    );
}

function hand(side) {
    const h = bone(side + "-hand"),
        y = side === "left" ? 1 : -1;
    const size = [1, 1.04, 1, 0.86];
    return part(
        "skin",
        0.0052,
        0.014,
        [
            cone(h, [0.001, 0.002 * y, -0.012], 0.0235, [0.007, 0.012 * y, -0.033], 0.0205),
            ...FINGERS.map(([k], i) =>
                joined(
                    cone(
                        h,
                        [0.009, (-0.006 + 0.011 * i) * y, -0.028],
                        0.0145,
                        [k[0], k[1] * y, k[2] + 0.004],
                        0.0105 * size[i],
                    ),
                    0.018,
                ),
            ),
            joined(ellipsoid(h, [-0.01, 0.038 * y, -0.03], [0.015, 0.016, 0.028]), 0.016),
            ...FINGERS.flatMap((f, i) => digit(side, y, f, FINGER_RADII, size[i], 0.006)),
            ...digit(side, y, THUMB, THUMB_RADII, 1, 0.016),
        ],
        { blend: 0.01 },
    );
}

// Head and neck: a mask with brow, nose, lips and ears; lids leave a slit for the eyes.
const EYE = [0.066, 0.031, 0.093], // the left one, in the head's frame
    EYEBALL = 0.0118; // its radius (m)

function head() {
    const h = bone("head"),
        n = bone("neck"),
        t = bone("trunk");
    return part(
        "skin",
        0.0068,
        0.03,
        [
            ellipsoid(h, [-0.01, 0, 0.122], [0.094, 0.0735, 0.084]),
            ellipsoid(h, [0.02, 0, 0.07], [0.062, 0.056, 0.088]),
            joined(ellipsoid(h, [0.05, 0, 0.001], [0.027, 0.026, 0.021]), 0.04),
            ...both((s, y) => [
                joined(cone(h, [-0.008, 0.05 * y, 0.04], 0.014, [0.05, 0.02 * y, -0.002], 0.014), 0.04),
                joined(ellipsoid(h, [0.053, 0.036 * y, 0.066], [0.02, 0.02, 0.018]), 0.03),
                joined(cone(h, [0.072, 0.012 * y, 0.111], 0.009, [0.058, 0.044 * y, 0.11], 0.009), 0.02),
                joined(cone(h, [-0.006, 0.073 * y, 0.068], 0.007, [-0.014, 0.076 * y, 0.1], 0.012), 0.008),
                joined(ellipsoid(h, [0.085, 0.01 * y, 0.0575], [0.009, 0.0075, 0.0065]), 0.006),
                // from behind the ear to the collar bone
                joined(cone(h, [-0.022, 0.05 * y, 0.045], 0.016, [-0.01, 0.032 * y, -0.01], 0.022), 0.03),
                joined(cone(n, [0, 0.03 * y, 0.03], 0.022, [0.012, 0.016 * y, -0.02], 0.02), 0.03),
            ]),
            joined(ellipsoid(h, [0.054, 0, 0.033], [0.022, 0.027, 0.024]), 0.03),
            joined(cone(h, [0.07, 0, 0.106], 0.007, [0.0925, 0, 0.063], 0.0098), 0.01),
            joined(cone(n, [-0.012, 0, -0.03], 0.05, [-0.008, 0, 0.055], 0.046), 0.03),
            joined(cone(t, [-0.012, 0, 0.345], 0.05, [-0.01, 0, 0.39], 0.048), 0.03),
        ],
        {
            cut: [-1, 1].map(y => ellipsoid(h, [0.088, EYE[1] * y, EYE[2] + 0.001], [0.017, 0.019, 0.0115])),
            cutSoft: 0.014,
        },
    );
}

// what is finer in a face, and hair
function features() {
    const h = bone("head"),
        hairline = (d, local, x, y, z) => {
            const [px, py, pz] = local(h, x, y, z),
                temple = Math.max(0, Math.abs(py) - 0.05);
            return -smoothMin(-d, 0.9 * pz - 0.75 * px + 0.9 * temple - 0.104, 0.008);
        };
    const [ex, ey, ez] = EYE;
    return [
        part("hair", 0.0078, 0.03, [ellipsoid(h, [-0.011, 0, 0.124], [0.1, 0.0785, 0.09])], { shape: hairline }),
        part("lips", 0.0035, 0.004, [
            ellipsoid(h, [0.0803, 0, 0.0366], [0.0085, 0.022, 0.0042]),
            ellipsoid(h, [0.0798, 0, 0.0288], [0.0085, 0.0185, 0.005]),
        ]),
        ...both((s, y) => [
            part("skin", 0.0031, 0.004, [ellipsoid(h, [ex - 0.001, ey * y, ez], [0.0136, 0.0152, 0.0132])], {
                cut: [ellipsoid(h, [ex + 0.015, (ey + 0.001) * y, ez - 0.003], [0.02, 0.0125, 0.0034])],
                cutSoft: 0.001,
            }),
            part("hair", 0.0032, 0.004, [
                cone(h, [0.081, 0.013 * y, 0.113], 0.0034, [0.074, 0.034 * y, 0.1165], 0.003),
                cone(h, [0.074, 0.034 * y, 0.1165], 0.003, [0.065, 0.047 * y, 0.113], 0.0018),
            ]),
        ]),
    ];
}

// Flat below, where he sits, in the pelvis: as the seat's edge falls away, so does the thigh.
const SEATED = -0.09; // its height (m), see stool()
const seated = (d, local, x, y, z) => {
    const [px, , pz] = local(bone("pelvis"), x, y, z);
    return pz < -0.25 ? d : Math.max(d, SEATED - Math.max(0, 0.9 * px) - pz);
};

function trousers() {
    const p = bone("pelvis");
    return part(
        "trousers",
        0.0155,
        0.06,
        [
            ellipsoid(p, [-0.004, 0, 0.045], [0.103, 0.142, 0.07]),
            ...both((s, y) => {
                const u = bone(s + "-upper-leg"),
                    l = bone(s + "-lower-leg");
                return [
                    ellipsoid(p, [-0.034, 0.07 * y, -0.012], [0.087, 0.082, 0.082]),
                    cone(u, [0, 0, -0.005], 0.084, [0, 0, -0.4], 0.058),
                    ellipsoid(u, [0.014, 0, -0.19], [0.076, 0.073, 0.13]),
                    joined(ellipsoid(l, [0.008, 0, -0.01], [0.056, 0.055, 0.06]), 0.03),
                    joined(cone(l, [0, 0, -0.06], 0.053, [-0.004, 0, -0.375], 0.0435), 0.04),
                    joined(ellipsoid(l, [-0.012, 0, -0.14], [0.055, 0.055, 0.1]), 0.05),
                ];
            }),
        ],
        { shape: seated },
    );
}

function shoe(side) {
    const f = bone(side + "-foot"),
        toes = bone(side + "-toes"),
        sole = (d, local, x, y, z) => Math.max(d, -(local(f, x, y, z)[2] + 0.075));
    return part(
        "shoes",
        0.012,
        0.03,
        [
            cone(f, [-0.012, 0, -0.01], 0.036, [-0.02, 0, -0.047], 0.037),
            cone(f, [0, 0, -0.03], 0.036, [0.125, 0, -0.052], 0.033),
            joined(ellipsoid(f, [0.125, 0, -0.055], [0.055, 0.043, 0.028]), 0.03),
            joined(ellipsoid(toes, [0.025, 0, -0.008], [0.056, 0.039, 0.026]), 0.03),
        ],
        { shape: sole },
    );
}

// what is drawn at once, the head apart: the performer's own eye does not see it
const surfaces = () => [
    [shirt(), trousers(), ...HANDS.flatMap(side => [cuff(side), forearm(side), hand(side), shoe(side)])],
    [head(), ...features()],
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
export const COLORS = { skin: "#a98e7c", hair: "#2a211c", lips: "#9c7768", trousers: "#2b2f38", shoes: "#17181c" };

const COARSE = 1.7; // of the cells of a plain picture; chosen: seen by looking for it only
let model; // geometry, the same for all performers
export function sharedModel({ plain }) {
    if (model) return model;
    const at = kinematics(restRotation);
    const matrices = segments.map((s, i) =>
        new THREE.Matrix4().compose(
            new THREE.Vector3(at[7 * i], at[7 * i + 1], at[7 * i + 2]),
            new THREE.Quaternion(at[7 * i + 4], at[7 * i + 5], at[7 * i + 6], at[7 * i + 3]),
            new THREE.Vector3(1, 1, 1),
        ),
    );
    return (model = {
        geometries: surfaces().map(parts => sculpt(parts, matrices, plain ? COARSE : 1)),
        inverses: matrices.map(m => new THREE.Matrix4().getInverse(m)),
        stick: stick(),
        eye: eye(),
    });
}

function stick() {
    const shaft = lathe(
        [
            [0, -tip],
            [0.0052, -tip],
            [0.0058, -0.1],
            [0.0072, 0.02],
            [0.0078, 0.07],
            [0.0062, BUTT - 0.004],
            [0.003, BUTT],
            [0, BUTT],
        ],
        14,
    );
    const felt = new THREE.SphereBufferGeometry(malletRadius, 20, 14).scale(1, 1, 0.94).translate(0, 0, -tip),
        core = new THREE.CylinderBufferGeometry(0.0085, 0.0085, 2 * malletRadius + 0.005, 16)
            .rotateX(Math.PI / 2)
            .translate(0, 0, -tip);
    return merge([shaft, felt, core], ["#d9b27a", "#f4efe2", "#a8452f"].map(rgb));
}

// an eyeball that looks along x: white, iris, pupil
function eye() {
    const ball = (from, to) => new THREE.SphereBufferGeometry(EYEBALL, 20, 6, 0, 2 * Math.PI, from, to - from),
        rings = [0, 0.26, 0.66, 1.7];
    return merge(
        rings.slice(1).map((to, i) => ball(rings[i], to)),
        ["#0b0a0a", "#4a3a2c", "#b9b1a6"].map(rgb),
    ).rotateZ(-Math.PI / 2);
}

// a model in the colours of one performer
function painted(geometry, colors) {
    const own = new THREE.BufferGeometry(),
        { paint } = geometry.userData,
        color = new Float32Array(3 * paint.length);
    paint.forEach((name, i) => colors[name].toArray(color, 3 * i));
    Object.assign(own.attributes, geometry.attributes);
    own.setIndex(geometry.index);
    own.setAttribute("color", new THREE.BufferAttribute(color, 3));
    return own;
}

function material(roughness, envMap, skinning = false) {
    return new THREE.MeshStandardMaterial({
        vertexColors: THREE.VertexColors,
        roughness,
        metalness: 0,
        skinning,
        envMap,
        envMapIntensity: 0.55,
    });
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
    constructor(index, stage) {
        const { geometries, inverses, stick, eye } = sharedModel(stage),
            { environment } = stage,
            names = Object.entries({ ...COLORS, shirt: shirts[index % shirts.length] }),
            colors = Object.fromEntries(names.map(([name, color]) => [name, rgb(color)])),
            skin = material(0.74, environment, true),
            hard = material(0.5, environment);
        this.group = new THREE.Group();
        this.bones = segments.map(() => new THREE.Bone());
        this.skeleton = new THREE.Skeleton(this.bones, inverses);
        const [, head] = geometries.map(geometry => {
            const mesh = shadowed(new THREE.SkinnedMesh(painted(geometry, colors), skin));
            mesh.bindMode = "detached"; // bones live in the group's frame
            mesh.bind(this.skeleton, new THREE.Matrix4());
            this.group.add(mesh);
            return mesh;
        });
        this.eyes = HANDS.map(() => new THREE.Mesh(eye, hard));
        this.eyesAt = [1, -1].map(y => [EYE[0], y * EYE[1], EYE[2]]); // in the head's frame
        this.sticks = HANDS.map(() => {
            const mesh = shadowed(new THREE.Mesh(stick, hard));
            mesh.tip = new THREE.Object3D();
            mesh.tip.position.z = -tip;
            return mesh.add(mesh.tip);
        });
        this.group.add(...this.eyes, ...this.sticks);
        this.headMeshes = [head, ...this.eyes];
        this.scale = new THREE.Vector3(1, 1, 1);
        this.look = null; // the point he looks at, in the group's frame (m); null: straight ahead
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
        this.turnEyes();
    }

    // to what he looks at, as far as eyes turn
    turnEyes() {
        const head = this.bones[bone("head")].matrixWorld,
            local = this.look && this.look.clone().applyMatrix4(new THREE.Matrix4().getInverse(head)),
            limit = angle => Math.min(EYES_TURN, Math.max(-EYES_TURN, angle));
        this.eyes.forEach((eye, i) => {
            eye.position.set(...this.eyesAt[i]);
            const to = local ? local.clone().sub(eye.position) : new THREE.Vector3(1, 0, -0.2);
            eye.rotation.set(0, -limit(Math.atan2(to.z, Math.hypot(to.x, to.y))), limit(Math.atan2(to.y, to.x)), "ZYX");
            eye.quaternion.premultiply(new THREE.Quaternion().setFromRotationMatrix(new THREE.Matrix4().extractRotation(head)));
            eye.position.applyMatrix4(head);
            eye.scale.copy(this.scale);
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
