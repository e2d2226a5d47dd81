// The figure with its motion, its sticks and the drums as one glTF 2.0 file (.glb): a skin over the
// segments' nodes, one animation with a rotation for each joint. The heads do not move. Lengths in
// metres; glTF has y upwards.
import * as THREE from "./three.js";
import { HANDS, bone } from "./body.js";
import { segments } from "./skeleton.js";

const FRAMES = 60; // key frames a second; chosen: as many as are shown
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

    // a mesh of glTF; figures share theirs
    mesh(object) {
        const { geometry, material } = object,
            { position, normal, skinIndex, skinWeight } = geometry.attributes,
            key = `${geometry.uuid} ${material.uuid}`;
        if (this.primitives.has(key)) return this.primitives.get(key);
        const attributes = {
            POSITION: this.accessor(Float32Array.from(position.array), "VEC3", FLOAT, true),
            NORMAL: this.accessor(Float32Array.from(normal.array), "VEC3", FLOAT),
        };
        if (skinIndex) {
            attributes.JOINTS_0 = this.accessor(Uint16Array.from(skinIndex.array), "VEC4", SHORT);
            attributes.WEIGHTS_0 = this.accessor(Float32Array.from(skinWeight.array), "VEC4", FLOAT);
        }
        const primitive = { attributes, material: this.material(material) };
        if (geometry.index)
            primitive.indices = this.accessor(Uint32Array.from(geometry.index.array), "SCALAR", INT);
        this.primitives.set(key, this.add("meshes", { primitives: [primitive] }));
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

// rows of [x y z w], one for each joint, at each time
function rotations(scene, times) {
    const pose = new Float64Array(7 * segments.length),
        out = segments.map(() => new Float32Array(4 * times.length));
    times.forEach((time, k) => {
        scene.pose(time, pose);
        for (let i = 1; i < segments.length; i++) {
            const [w, x, y, z] = scene.local.subarray(4 * i, 4 * i + 4);
            out[i].set([x, y, z, w], 4 * k);
        }
    });
    return out;
}

function animate(writer, scene, nodes) {
    const times = Float32Array.from({ length: Math.floor(scene.end * FRAMES) + 1 }, (_, i) => i / FRAMES),
        input = writer.accessor(times, "SCALAR", FLOAT, true),
        channels = [],
        samplers = [];
    rotations(scene, times).forEach((list, i) => {
        if (!i) return;
        channels.push({ sampler: samplers.length, target: { node: nodes[i], path: "rotation" } });
        samplers.push({ input, output: writer.accessor(list, "VEC4", FLOAT) });
    });
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
const still = (writer, object, matrix) =>
    writer.add("nodes", { mesh: writer.mesh(object), matrix: [...matrix.elements] });

function figure(writer, performer, nodes) {
    const { group, sticks, skeleton: bones, scale } = performer.figure,
        inverse = new Float32Array(16 * segments.length),
        larger = new THREE.Matrix4().makeScale(scale.x, scale.y, scale.z);
    bones.boneInverses.forEach((m, i) =>
        inverse.set(new THREE.Matrix4().multiplyMatrices(larger, m).elements, 16 * i),
    );
    const skin = writer.add("skins", {
        joints: nodes,
        inverseBindMatrices: writer.accessor(inverse, "MAT4", FLOAT),
    });
    sticks.forEach((stick, hand) => {
        const above = writer.json.nodes[nodes[bone(`${HANDS[hand]}-stick`)]];
        for (const part of stick.children) {
            part.updateMatrix();
            above.children.push(still(writer, part, part.matrix));
        }
    });
    return group.children
        .filter(part => part.isSkinnedMesh)
        .map(part => writer.add("nodes", { mesh: writer.mesh(part), skin }));
}

function standing(writer, group) {
    const all = [];
    group.updateMatrixWorld();
    const own = new THREE.Matrix4().getInverse(group.matrixWorld);
    group.traverse(part => {
        if (part.isMesh && part.geometry.attributes.normal && part.material.isMeshStandardMaterial)
            all.push(still(writer, part, new THREE.Matrix4().multiplyMatrices(own, part.matrixWorld)));
    });
    return all;
}

// `performer` and `drums` as they are drawn now
export function makeGltf(scene, performer, drums) {
    const writer = new Writer(),
        root = writer.add("nodes", { name: "himc", rotation: [-Math.SQRT1_2, 0, 0, Math.SQRT1_2] }),
        nodes = skeleton(writer, scene.bodies[0]);
    writer.json.nodes[root].children = [
        nodes[0],
        ...figure(writer, performer, nodes),
        ...standing(writer, performer.stool),
        ...drums.flatMap(drum => standing(writer, drum.group)),
    ];
    animate(writer, scene, nodes);
    for (const node of writer.json.nodes) if (node.children && !node.children.length) delete node.children;
    return writer.glb();
}
