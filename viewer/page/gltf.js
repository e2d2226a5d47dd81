// The figure with its motion, its sticks and the drums as one glTF 2.0 file (.glb): a skin over the
// segments' nodes, morph targets for the shapes of the heads, one animation with a rotation for each
// joint, its place where the body's measures change, and the weights of the shapes. Lengths in metres;
// glTF has y upwards.
import * as THREE from "./three.js";
import { HANDS, bone } from "./body.js";
import { segments } from "./skeleton.js";

const FRAMES = 60, // key frames a second; chosen: as many as are shown
    SHAPES = 16, // of a head, the lowest; chosen: the others are a twentieth of its height, and 40 kB each
    UNIT = 0.01; // height of a shape at weight 1 (m); chosen: viewers make room for all shapes at 1
const FLOAT = 5126,
    SHORT = 5123,
    INT = 5125;

class Writer {
    constructor() {
        ((this.bytes = []), (this.size = 0));
        this.json = {
            asset: { version: "2.0", generator: "himc" },
            scene: 0,
            scenes: [{ nodes: [0] }],
            nodes: [],
            meshes: [],
            materials: [],
            accessors: [],
            bufferViews: [],
        };
        ((this.materials = new Map()), (this.primitives = new Map()));
    }

    add(list, value) {
        return (this.json[list] ??= []).push(value) - 1;
    }

    accessor(array, type, componentType, bounds) {
        const width = { SCALAR: 1, VEC3: 3, VEC4: 4, MAT4: 16 }[type],
            bytes = new Uint8Array(array.buffer, array.byteOffset, array.byteLength),
            view = this.add("bufferViews", { buffer: 0, byteOffset: this.size, byteLength: bytes.length });
        this.bytes.push(bytes, new Uint8Array((4 - (bytes.length % 4)) % 4));
        this.size = 4 * Math.ceil((this.size + bytes.length) / 4);
        const accessor = { bufferView: view, componentType, count: array.length / width, type };
        if (bounds) {
            ((accessor.min = Array(width).fill(Infinity)), (accessor.max = Array(width).fill(-Infinity)));
            array.forEach((v, i) => {
                accessor.min[i % width] = Math.min(accessor.min[i % width], v);
                accessor.max[i % width] = Math.max(accessor.max[i % width], v);
            });
        }
        return this.add("accessors", accessor);
    }

    material(m) {
        if (!this.materials.has(m))
            this.materials.set(
                m,
                this.add("materials", {
                    pbrMetallicRoughness: {
                        baseColorFactor: [m.color.r, m.color.g, m.color.b, 1],
                        metallicFactor: m.metalness,
                        roughnessFactor: m.roughness,
                    },
                    doubleSided: m.side === THREE.DoubleSide,
                }),
            );
        return this.materials.get(m);
    }

    // a mesh of glTF; figures share theirs. `shapes`: { position, normal } by which it can differ
    mesh(object, shapes = []) {
        const { geometry, material } = object,
            { position, normal, color, skinIndex, skinWeight } = geometry.attributes,
            key = `${geometry.uuid} ${material.uuid}`;
        if (this.primitives.has(key)) return this.primitives.get(key);
        const attributes = {
            POSITION: this.accessor(Float32Array.from(position.array), "VEC3", FLOAT, true),
            NORMAL: this.accessor(Float32Array.from(normal.array), "VEC3", FLOAT),
        };
        if (color) attributes.COLOR_0 = this.accessor(Float32Array.from(color.array), "VEC3", FLOAT);
        if (skinIndex) {
            attributes.JOINTS_0 = this.accessor(Uint16Array.from(skinIndex.array), "VEC4", SHORT);
            attributes.WEIGHTS_0 = this.accessor(Float32Array.from(skinWeight.array), "VEC4", FLOAT);
        }
        const primitive = { attributes, material: this.material(material) };
        if (geometry.index)
            primitive.indices = this.accessor(Uint32Array.from(geometry.index.array), "SCALAR", INT);
        const mesh = { primitives: [primitive] };
        if (shapes.length) {
            primitive.targets = shapes.map(({ position, normal }) => ({
                POSITION: this.accessor(position, "VEC3", FLOAT, true),
                NORMAL: this.accessor(normal, "VEC3", FLOAT),
            }));
            mesh.weights = shapes.map(() => 0);
        }
        this.primitives.set(key, this.add("meshes", mesh));
        return this.primitives.get(key);
    }

    glb() {
        this.json.buffers = [{ byteLength: this.size }];
        const plain = new TextEncoder().encode(JSON.stringify(this.json)),
            json = new Uint8Array(4 * Math.ceil(plain.length / 4)).fill(0x20);
        json.set(plain);
        const word = (...values) => new Uint8Array(Uint32Array.from(values).buffer);
        return new Blob(
            [
                word(0x46546c67, 2, 28 + json.length + this.size),
                word(json.length, 0x4e4f534a),
                json,
                word(this.size, 0x004e4942),
                ...this.bytes,
            ],
            { type: "model/gltf-binary" },
        );
    }
}

// rows of [x y z w], one for each joint, at each time; and the places of the pelvis
function motion(scene, times) {
    const pose = new Float64Array(7 * segments.length),
        root = new Float32Array(3 * times.length),
        out = segments.map(() => new Float32Array(4 * times.length));
    times.forEach((time, k) => {
        root.set(scene.pose(time, pose).subarray(0, 3), 3 * k);
        for (let i = 0; i < segments.length; i++) {
            const [w, x, y, z] = scene.local.subarray(4 * i, 4 * i + 4);
            out[i].set([x, y, z, w], 4 * k);
        }
    });
    return [out, root];
}

// the places of a joint in its parent's frame, one for each body
const places = (scene, i) => Float32Array.from(scene.bodies.flatMap(b => b.segments[i].origin));

// `heads`: { node, name, weights(time) }
function animate(writer, scene, nodes, heads) {
    const times = Float32Array.from({ length: Math.floor(scene.end * FRAMES) + 1 }, (_, i) => i / FRAMES),
        clock = list => writer.accessor(list, "SCALAR", FLOAT, true),
        input = clock(times),
        channels = [],
        samplers = [];
    const move = (node, path, output, type, more = {}) => {
        channels.push({ sampler: samplers.length, target: { node, path } });
        samplers.push({ input, output: writer.accessor(output, type, FLOAT), ...more });
    };
    // a pelvis that is fixed stays where the body has it
    const first = scene.sits ? 0 : 1,
        [turns, root] = motion(scene, times);
    turns.forEach((list, i) => i >= first && move(nodes[i], "rotation", list, "VEC4"));
    if (scene.sits) move(nodes[0], "translation", root, "VEC3");
    if (scene.bodies.length > 1) {
        const changes = clock(Float32Array.from(scene.bodies, b => b.time));
        nodes.forEach((node, i) => (i || !scene.sits) && move(node, "translation", places(scene, i), "VEC3", { input: changes, interpolation: "STEP" }));
    }
    for (const { node, weights } of heads)
        move(node, "weights", Float32Array.from([...times].flatMap(weights)), "SCALAR");
    writer.add("animations", { name: "performance", channels, samplers });
}

// the nodes of the segments, each below its parent; the first has the pelvis
function skeleton(writer, body) {
    const nodes = segments.map((s, i) =>
        writer.add("nodes", { name: s.name, translation: body.segments[i].origin, children: [] }),
    );
    segments.forEach((s, i) => i && writer.json.nodes[nodes[s.parent]].children.push(nodes[i]));
    return nodes;
}

// a mesh that stands, or is moved by the node above it
const still = (writer, object, matrix, shapes) =>
    writer.add("nodes", { mesh: writer.mesh(object, shapes), matrix: [...matrix.elements] });

function figure(writer, performer, nodes) {
    const { group, eyes, eyesAt, sticks, skeleton: bones, scale } = performer.figure,
        inverse = new Float32Array(16 * segments.length),
        larger = new THREE.Matrix4().makeScale(scale.x, scale.y, scale.z);
    bones.boneInverses.forEach((m, i) =>
        inverse.set(new THREE.Matrix4().multiplyMatrices(larger, m).elements, 16 * i),
    );
    const skin = writer.add("skins", {
        joints: nodes,
        inverseBindMatrices: writer.accessor(inverse, "MAT4", FLOAT),
    });
    const below = (name, object, matrix) => writer.json.nodes[nodes[bone(name)]].children.push(still(writer, object, matrix));
    sticks.forEach((stick, hand) => below(`${HANDS[hand]}-stick`, stick, new THREE.Matrix4()));
    eyes.forEach((eye, i) => below("head", eye, new THREE.Matrix4().makeTranslation(...eyesAt[i])));
    return group.children
        .filter(part => part.isSkinnedMesh)
        .map(part => writer.add("nodes", { mesh: writer.mesh(part), skin }));
}

// `head`: the mesh in it that has shapes
function standing(writer, group, head, shapes) {
    const all = [];
    group.updateMatrixWorld();
    const own = new THREE.Matrix4().getInverse(group.matrixWorld);
    group.traverse(part => {
        if (part.isMesh && part.geometry.attributes.normal && part.material.isMeshStandardMaterial)
            all.push(
                still(writer, part, new THREE.Matrix4().multiplyMatrices(own, part.matrixWorld), part === head ? shapes : []),
            );
    });
    return all;
}

// a drum, and what moves its head: the amplitudes at a time (m), `times` larger
function drum(writer, one, amplitudes, times) {
    const nodes = standing(writer, one.group, one.head, one.shapes(SHAPES, UNIT)),
        node = nodes.find(i => writer.json.meshes[writer.json.nodes[i].mesh].weights);
    if (node !== undefined) writer.json.nodes[node].name = `${one.name} head`; // a slab has none
    return { nodes, node, weights: time => Array.from(amplitudes(time).subarray(0, SHAPES), q => (times * q) / UNIT) };
}

// `performer` and `drums` as they are drawn now; `amplitudes(name, time)` of a drum's shapes (m)
export function makeGltf(scene, performer, drums, amplitudes, times) {
    const writer = new Writer(),
        root = writer.add("nodes", { name: "himc", rotation: [-Math.SQRT1_2, 0, 0, Math.SQRT1_2] }),
        nodes = skeleton(writer, scene.bodies[0]),
        moving = drums.map(d => drum(writer, d, time => amplitudes(d.name, time), times));
    writer.json.nodes[root].children = [
        nodes[0],
        ...figure(writer, performer, nodes),
        ...standing(writer, performer.stool),
        ...moving.flatMap(d => d.nodes),
    ];
    animate(writer, scene, nodes, moving.filter(d => d.node !== undefined));
    for (const node of writer.json.nodes) if (node.children && !node.children.length) delete node.children;
    return writer.glb();
}
