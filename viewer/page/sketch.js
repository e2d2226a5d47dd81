// A plain drawing in place of the picture, where a browser has no WebGL: limbs, sticks, drums, what is
// chosen, as lines and filled shapes on a canvas, the farthest first. Widths and colours: chosen by eye.
import * as THREE from "./three.js";
import { HANDS, bone } from "./body.js";
import { COLORS } from "./figure.js";
import { tip, malletRadius } from "./skeleton.js";

const ROUND = 32, // corners of a circle
    KETTLE = 16, // circles of a shell
    HEAD = [0.01, 0, 0.1], // its middle in its segment (m)
    LIMBS = [
        ["upper-arm", "forearm", 0.085, null],
        ["forearm", "hand", 0.065, COLORS.skin],
        ["upper-leg", "lower-leg", 0.14, COLORS.trousers],
        ["lower-leg", "foot", 0.1, COLORS.trousers],
        ["foot", "toes", 0.07, COLORS.shoes],
    ];

const css = color => `#${color.clone().convertLinearToSRGB().getHexString()}`;

const circle = (radius, z) =>
    Array.from({ length: ROUND + 1 }, (_, i) => {
        const t = (2 * Math.PI * i) / ROUND;
        return new THREE.Vector3(radius * Math.cos(t), radius * Math.sin(t), z);
    });

// Takes the renderer's place. `performers` and `drums` are the page's, once it has them.
export class Sketch {
    constructor(canvas) {
        ((this.domElement = canvas), (this.pen = canvas.getContext("2d")));
        Object.assign(this, { shadowMap: {}, ratio: 1, performers: new Map(), drums: new Map() });
    }

    setPixelRatio(ratio) {
        this.ratio = ratio;
    }

    setSize(w, h) {
        ((this.domElement.width = this.ratio * w), (this.domElement.height = this.ratio * h));
    }

    // points of an object's frame, joined by a line of that width (m), or filled; over what is so much nearer (m)
    add(object, points, color, { width = 0.004, fill = false, near = 0 } = {}) {
        const seen = points.map(p => p.clone().applyMatrix4(object.matrixWorld).applyMatrix4(this.camera.matrixWorldInverse)),
            depth = -near - seen.reduce((sum, p) => sum + p.z, 0) / seen.length;
        if (seen.every(p => p.z < -this.camera.near)) this.shapes.push({ seen, color, width, fill, depth });
    }

    render(scene, camera) {
        const { pen } = this,
            { width, height } = this.domElement;
        ((this.camera = camera), (this.shapes = []));
        (scene.updateMatrixWorld(), camera.updateMatrixWorld());
        camera.matrixWorldInverse.getInverse(camera.matrixWorld);
        for (const drum of this.drums.values()) if (drum.group.visible) this.drum(drum);
        for (const one of this.performers.values()) if (one.group.visible) this.performer(one);
        scene.traverseVisible(part => this.mark(part));
        pen.fillStyle = "#1a1513";
        pen.fillRect(0, 0, width, height);
        ((pen.lineCap = pen.lineJoin = "round"), this.shapes.sort((a, b) => b.depth - a.depth));
        const scale = (height / 2) * camera.projectionMatrix.elements[5]; // (pixels) of 1 m in 1 m
        for (const { seen, color, width: broad, fill, depth } of this.shapes) {
            pen.beginPath();
            for (const p of seen.map(p => p.clone().applyMatrix4(camera.projectionMatrix)))
                pen.lineTo(((p.x + 1) * width) / 2, ((1 - p.y) * height) / 2);
            ((pen.strokeStyle = pen.fillStyle = color), (pen.lineWidth = Math.max(1, (scale * broad) / depth)));
            if (fill) pen.fill();
            pen.stroke();
        }
    }

    performer({ figure, group, stool, color, ghostly, trails }) {
        const at = (name, point = [0, 0, 0]) => new THREE.Vector3(...point).applyMatrix4(figure.bones[bone(name)].matrixWorld),
            add = (points, own, width) => this.add(group, points, ghostly ? color : own, { width: ghostly ? 0.01 : width }),
            head = at("head", HEAD);
        add([at("trunk"), at("trunk", [0, 0, 0.25])], color, 0.26);
        add([at("pelvis"), at("pelvis", [0, 0, 0.06])], COLORS.trousers, 0.24);
        add(HANDS.map(side => at(side + "-upper-arm")), color, 0.09);
        add([at("neck"), head], COLORS.skin, 0.1);
        if (figure.headMeshes[0].visible) {
            add([head, at("head", [0, 0, 0.11])], COLORS.skin, 0.18);
            add([at("head", [-0.02, 0, 0.14]), at("head", [-0.02, 0, 0.15])], COLORS.hair, 0.17);
        }
        HANDS.forEach((side, hand) => {
            for (const [from, to, width, own] of LIMBS) add([at(`${side}-${from}`), at(`${side}-${to}`)], own ?? color, width);
            const end = [0, 0, -tip];
            add([at(`${side}-hand`), at(`${side}-stick`)], COLORS.skin, 0.06);
            add([at(`${side}-stick`, [0, 0, 0.1]), at(`${side}-stick`, end)], "#d9b27a", 0.014);
            add([at(`${side}-stick`, end), at(`${side}-stick`, end).addScalar(1e-3)], "#f4efe2", 2 * malletRadius);
            const trail = trails[hand].points.map(one => one.p);
            if (trails[hand].mesh.visible && trail.length > 1) add(trail, css(trails[hand].color), 0.006);
        });
        if (!stool.visible) return;
        this.add(stool.cushion, circle(0.15, -0.03), "#3a1f1a", { fill: true, width: 0.05 });
        this.add(stool.post, [0, 1].map(z => new THREE.Vector3(0, 0, z)), "#9aa0a6", { width: 0.04 });
    }

    // a shell as circles below the head, whose outer rings move as its net does; a slab
    drum({ tilted, legs, slab, head, place: [, , high, , radius, length, width] }) {
        const bronze = !slab && width > 0 && width < 0.05,
            ring = r => {
                const { array } = head.geometry.attributes.position,
                    all = Array.from({ length: 73 }, (_, s) => 3 * (r * 72 + (s % 72)));
                return all.map(i => new THREE.Vector3(array[i], array[i + 1], array[i + 2]));
            };
        this.add(legs, [0.02 - high, -0.05].map(z => new THREE.Vector3(0, 0, z)), "#6d7176", { width: 0.03, near: -0.5 * radius });
        for (const t of [1, 3, 5])
            this.add(legs, [new THREE.Vector3(0, 0, 0.1 - high), circle(0.25, 0.02 - high)[Math.round((t * ROUND) / 6)]], "#6d7176", { width: 0.02 });
        if (slab) {
            const corners = [[1, 1], [1, -1], [-1, -1], [-1, 1]].map(([x, y]) => new THREE.Vector3((x * length) / 2, (y * width) / 2, 0));
            return this.add(slab, corners, "#9a5533", { fill: true });
        }
        if (bronze) return this.add(tilted, circle(radius, 0), "#c29a4b", { fill: true });
        for (let i = KETTLE; i > 0; i--) {
            const t = i / KETTLE,
                [r, z] = width > 0 ? [radius, -t * width] : [radius * Math.sqrt(1 - (0.9 * t) ** 2), -0.86 * t * radius];
            this.add(tilted, circle(r, z), width > 0 ? "#6a3722" : "#b0623a", { fill: true, width: radius / KETTLE / 2, near: -0.4 * radius });
        }
        this.add(tilted, ring(22), "#e4d4b4", { fill: true, width: 0.008 });
        for (const r of [7, 14, 19]) this.add(tilted, ring(r), "#c9b68f", { width: 0.003, near: 0.01 });
    }

    // balls and lines: targets, what is edited
    mark(part) {
        if (!part.material?.color) return;
        const color = css(part.material.color),
            { position } = part.geometry.attributes;
        if (part.geometry.type === "SphereBufferGeometry" && part.material.transparent)
            this.add(part, [0, 1e-3].map(z => new THREE.Vector3(0, 0, z)), color, { width: 2 * part.geometry.parameters.radius });
        else if (part.isLine && position)
            this.add(part, Array.from({ length: position.count }, (_, i) => new THREE.Vector3().fromBufferAttribute(position, i)), color);
    }
}
