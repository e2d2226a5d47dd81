// The figure: clothes, skin, hair and shoes, modelled once round the default skeleton in a seated
// rest pose, then moved by the segments of a pose. Lengths in metres, in each segment's frame
// (zero pose: x forward, y left, z up).
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

// Folds of cloth: a few oblique waves near the surface; `depth` their amplitude (m), u and v their
// wave numbers (rad/m). All numbers of the clothes and the body below: chosen by eye.
function cloth(depth, u, v) {
    return (d, local, x, y, z) =>
        Math.abs(d) > 0.03
            ? d
            : d +
              depth *
                  (Math.sin(u * z + 9 * x + 2 * Math.sin(v * y)) +
                      0.7 * Math.sin(1.7 * u * x + 14 * y - 8 * z));
}

function shirt() {
    const t = bone("trunk"),
        p = bone("pelvis");
    return {
        soft: 0.07,
        blend: 0.07,
        cell: 0.017,
        shape: cloth(0.0016, 52, 23),
        solids: [
            ellipsoid(t, [0.012, 0, 0.235], [0.105, 0.152, 0.15]),
            ellipsoid(t, [0.0, 0, 0.05], [0.098, 0.128, 0.15]),
            ellipsoid(p, [0.0, 0, 0.07], [0.105, 0.14, 0.1]),
            ...both((s, y) => [
                cone(t, [0, 0.03 * y, 0.35], 0.05, [-0.004, 0.15 * y, 0.33], 0.057),
            ]),
            cone(t, [-0.012, 0, 0.33], 0.062, [-0.012, 0, 0.362], 0.053),
        ],
    };
}

function sleeve(side) {
    const u = bone(side + "-upper-arm"),
        f = bone(side + "-forearm");
    return {
        soft: 0.035,
        blend: 0.035,
        cell: 0.0135,
        shape: cloth(0.0017, 75, 31),
        solids: [
            ellipsoid(u, [-0.002, 0, -0.018], [0.059, 0.054, 0.066]),
            cone(u, [0, 0, -0.035], 0.054, [0, 0, -0.265], 0.05),
            cone(f, [0, 0, 0], 0.05, [0, 0, -0.2], 0.037),
            cone(f, [0, 0, -0.215], 0.038, [0, 0, -0.235], 0.037),
        ],
    };
}

function hand(side) {
    const f = bone(side + "-forearm"),
        h = bone(side + "-hand"),
        y = side === "left" ? 1 : -1;
    const solids = [
        cone(f, [0, 0, -0.21], 0.029, [0, 0, -0.262], 0.026),
        cone(h, [0.002, 0, 0], 0.026, [0.01, 0.008 * y, -0.03], 0.026),
    ];
    const lengths = [1, 1.08, 1.0, 0.82];
    for (let i = 0; i < 4; i++) {
        // knuckles beside and above the stick, fingers closed round it
        const k = [0.021 - 0.004 * Math.abs(i - 1), (-0.006 + 0.0185 * i) * y, -0.083 + 0.006 * i],
            l = lengths[i];
        const a = [k[0] - 0.01, k[1], k[2] - 0.036 * l],
            b = [k[0] - 0.036, k[1] - 0.002 * y, k[2] - 0.03 * l];
        const c = [k[0] - 0.043, k[1] - 0.003 * y, k[2] - 0.008 * l];
        solids.push(
            {
                ...cone(h, [0.006, (-0.01 + 0.0095 * i) * y, -0.02], 0.0145, k, 0.0135),
                soft: 0.016,
            },
            { ...cone(h, k, 0.0112, a, 0.0098), soft: 0.005 },
            { ...cone(h, a, 0.0098, b, 0.009), soft: 0.004 },
            { ...cone(h, b, 0.009, c, 0.0082), soft: 0.004 },
        );
    }
    solids.push(
        {
            ...cone(h, [-0.002, -0.016 * y, -0.02], 0.018, [-0.008, -0.03 * y, -0.05], 0.0145),
            soft: 0.016,
        },
        {
            ...cone(h, [-0.008, -0.03 * y, -0.05], 0.0125, [-0.004, -0.021 * y, -0.084], 0.011),
            soft: 0.008,
        },
        {
            ...cone(h, [-0.004, -0.021 * y, -0.084], 0.011, [-0.003, -0.016 * y, -0.108], 0.0092),
            soft: 0.006,
        },
    );
    return { soft: 0.012, blend: 0.016, cell: 0.0056, solids };
}

function head() {
    const n = bone("neck"),
        h = bone("head"),
        t = bone("trunk");
    return {
        soft: 0.022,
        blend: 0.03,
        cell: 0.0054,
        cutSoft: 0.005,
        cut: both((s, y) => [
            cone(h, [0.0925, 0, 0.0305], 0.0032, [0.083, 0.025 * y, 0.0325], 0.0028),
        ]),
        solids: [
            cone(t, [-0.012, 0, 0.36], 0.05, [-0.008, 0, 0.39], 0.05),
            cone(n, [-0.006, 0, 0], 0.05, [0, 0, 0.06], 0.047),
            cone(h, [-0.012, 0, -0.02], 0.047, [-0.012, 0, 0.05], 0.05),
            ellipsoid(h, [-0.006, 0, 0.122], [0.094, 0.072, 0.084]),
            ellipsoid(h, [0.028, 0, 0.072], [0.06, 0.054, 0.082]),
            { ...ellipsoid(h, [0.052, 0, 0.012], [0.034, 0.031, 0.03]), soft: 0.03 },
            ...both((s, y) => [
                {
                    ...cone(h, [-0.002, 0.052 * y, 0.035], 0.014, [0.055, 0.02 * y, 0.004], 0.015),
                    soft: 0.03,
                },
                { ...ellipsoid(h, [0.058, 0.036 * y, 0.07], [0.022, 0.02, 0.018]), soft: 0.02 },
                {
                    ...cone(h, [0.08, 0.012 * y, 0.112], 0.009, [0.07, 0.042 * y, 0.11], 0.009),
                    soft: 0.014,
                },
                { ...ellipsoid(h, [-0.006, 0.073 * y, 0.078], [0.017, 0.009, 0.03]), soft: 0.008 },
            ]),
            { ...cone(h, [0.086, 0, 0.1], 0.008, [0.105, 0, 0.064], 0.011), soft: 0.014 },
            { ...ellipsoid(h, [0.098, 0, 0.06], [0.014, 0.017, 0.009]), soft: 0.01 },
            { ...cone(h, [0.079, -0.016, 0.031], 0.01, [0.079, 0.016, 0.031], 0.01), soft: 0.012 },
        ],
    };
}

function hair() {
    const h = bone("head");
    return {
        soft: 0.03,
        blend: 0.03,
        cell: 0.0085,
        solids: [
            ellipsoid(h, [-0.014, 0, 0.132], [0.098, 0.08, 0.087]),
            ellipsoid(h, [-0.045, 0, 0.075], [0.06, 0.068, 0.075]),
        ],
        shape(d, local, x, y, z) {
            const p = local(h, x, y, z),
                line = 0.8 * (p[0] - 0.05) - 0.6 * (p[2] - 0.135) - 0.15 * Math.abs(p[1]);
            const ear = 0.045 - Math.hypot(p[0] - 0.012, 1.1 * (p[2] - 0.07));
            const wave = 0.0016 * Math.sin(190 * p[1] + 40 * p[0] + 5 * Math.sin(30 * p[2]));
            return Math.max(d + wave, line, ear, 0.015 - p[2]);
        },
    };
}

function eyes() {
    const h = bone("head");
    return {
        soft: 0.001,
        blend: 0.03,
        cell: 0.0026,
        solids: both((s, y) => [
            ellipsoid(h, [0.0755, 0.0305 * y, 0.0925], [0.0095, 0.0125, 0.0058]),
        ]),
    };
}

function brows() {
    const h = bone("head");
    return {
        soft: 0.004,
        blend: 0.03,
        cell: 0.003,
        solids: both((s, y) => [
            cone(h, [0.0885, 0.016 * y, 0.1165], 0.0042, [0.077, 0.046 * y, 0.1135], 0.003),
        ]),
    };
}

function trousers() {
    const p = bone("pelvis");
    return {
        soft: 0.045,
        blend: 0.05,
        cell: 0.018,
        shape: cloth(0.0018, 46, 19),
        solids: [
            ellipsoid(p, [0, 0, 0.03], [0.113, 0.15, 0.085]),
            ...both((s, y) => [
                ellipsoid(p, [-0.035, 0.075 * y, -0.03], [0.095, 0.088, 0.075]),
                cone(bone(s + "-upper-leg"), [0, 0, -0.01], 0.088, [0, 0, -0.395], 0.066),
                cone(bone(s + "-lower-leg"), [0.008, 0, 0], 0.064, [-0.006, 0, -0.2], 0.06),
                cone(bone(s + "-lower-leg"), [-0.006, 0, -0.2], 0.06, [-0.008, 0, -0.4], 0.052),
            ]),
        ],
    };
}

function shoe(side) {
    const f = bone(side + "-foot"),
        t = bone(side + "-toes");
    return {
        soft: 0.02,
        blend: 0.03,
        cell: 0.011,
        solids: [
            cone(f, [-0.005, 0, -0.005], 0.042, [-0.018, 0, -0.045], 0.042),
            cone(f, [-0.02, 0, -0.045], 0.042, [0.12, 0, -0.05], 0.04),
            cone(f, [0.02, 0, -0.02], 0.036, [0.13, 0, -0.05], 0.034),
            cone(t, [0, 0, 0], 0.041, [0.05, 0, -0.004], 0.034),
        ],
        shape(d, local, x, y, z) {
            return Math.max(d, -(local(f, x, y, z)[2] + 0.075));
        },
    };
}

const look = (color, roughness, extra = {}) => ({ color, roughness, metalness: 0, ...extra });
const parts = () => [
    [shirt(), "shirt"],
    [sleeve("left"), "shirt"],
    [sleeve("right"), "shirt"],
    [trousers(), "trousers"],
    [hand("left"), "skin"],
    [hand("right"), "skin"],
    [head(), "skin", true],
    [hair(), "hair", true],
    [eyes(), "eyes", true],
    [brows(), "hair", true],
    [shoe("left"), "shoes"],
    [shoe("right"), "shoes"],
];
export const shirts = [
    "#3f5f8c",
    "#8c3f45",
    "#3f7d62",
    "#8a6a34",
    "#67508c",
    "#3f7f8a",
    "#a0563a",
    "#56606b",
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
    const geometries = parts().map(([part, material, ofHead]) => ({
        geometry: sculpt(part, matrices),
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
        shirt: make(look(rgb(shirts[index % shirts.length]), 0.82)),
        trousers: make(look(rgb("#20222b"), 0.9)),
        skin: make(look(rgb("#b77f61"), 0.6)),
        hair: make(look(rgb("#2b1c14"), 0.62)),
        eyes: make(look(rgb("#14100e"), 0.15)),
        shoes: make(look(rgb("#17130f"), 0.32)),
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
            thigh > 0.2 && thigh < 0.8
                ? thigh / segments[bone("left-upper-leg")].length
                : 1,
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

    // hidden for the camera of the performer's eye
    showHead(yes) {
        for (const mesh of this.headMeshes) mesh.visible = yes;
    }
}
