// Marks of a strike: light on the head, an arrow as long as the force, the force in newtons; and
// the trails of the tips. Sizes and colours: chosen by eye.
import * as THREE from "./three.js";
import { rgb, picture } from "./color.js";

export const MARK_TIME = 1100; // (ms)
const ARROW_LENGTH = 0.0035, // (m/N)
    STRONGEST = 300; // no arrow grows beyond this force (N)

function glow() {
    const canvas = document.createElement("canvas"),
        c = canvas.getContext("2d");
    canvas.width = canvas.height = 128;
    const g = c.createRadialGradient(64, 64, 0, 64, 64, 64);
    (g.addColorStop(0, "rgba(255,214,120,1)"),
        g.addColorStop(0.22, "rgba(255,140,40,0.85)"),
        g.addColorStop(0.6, "rgba(255,90,20,0.3)"),
        g.addColorStop(1, "rgba(255,70,10,0)"));
    c.fillStyle = g;
    c.fillRect(0, 0, 128, 128);
    return picture(canvas);
}
const glowTexture = glow();

class Label {
    constructor() {
        this.canvas = document.createElement("canvas");
        ((this.canvas.width = 256), (this.canvas.height = 128));
        this.texture = picture(this.canvas);
        this.sprite = new THREE.Sprite(
            new THREE.SpriteMaterial({
                map: this.texture,
                transparent: true,
                depthTest: false,
                depthWrite: false,
            }),
        );
        this.sprite.renderOrder = 10;
        this.sprite.scale.set(0.2, 0.1, 1);
    }

    write(text, color) {
        const c = this.canvas.getContext("2d");
        c.clearRect(0, 0, 256, 128);
        c.font = "600 64px system-ui, sans-serif";
        ((c.textAlign = "center"), (c.textBaseline = "middle"));
        ((c.lineWidth = 10), (c.lineJoin = "round"));
        c.strokeStyle = "rgba(8,8,12,0.75)";
        c.strokeText(text, 128, 66);
        c.fillStyle = color;
        c.fillText(text, 128, 66);
        this.texture.needsUpdate = true;
    }
}

// An arrow along z, its point at the origin, with writing at its other end.
export class Arrow {
    constructor(material) {
        this.material = new THREE.MeshBasicMaterial({ transparent: true, ...material });
        this.group = new THREE.Group();
        this.shaft = new THREE.Mesh(
            new THREE.CylinderBufferGeometry(0.006, 0.006, 1, 16).rotateX(Math.PI / 2),
            this.material,
        );
        this.point = new THREE.Mesh(
            new THREE.ConeBufferGeometry(0.017, 0.045, 20).rotateX(-Math.PI / 2),
            this.material,
        );
        this.label = new Label();
        this.group.add(this.shaft, this.point, this.label.sprite);
    }

    write(newtons, color) {
        if (this.written === `${newtons} ${color}`) return;
        this.written = `${newtons} ${color}`;
        this.material.color.copy(rgb(color));
        this.label.write(`${Math.round(newtons)} N`, color);
    }

    // `length` of the shaft; `near` scales the writing
    stretch(length, near) {
        this.point.position.z = 0.026;
        ((this.shaft.scale.z = length), (this.shaft.position.z = 0.045 + length / 2));
        this.label.sprite.scale.set(0.2 * near, 0.1 * near, 1);
        this.label.sprite.position.z = 0.045 + length + 0.05 * near;
    }
}

// One mark, taken from a pool.
class Mark {
    constructor() {
        this.group = new THREE.Group();
        this.disc = new THREE.Mesh(
            new THREE.PlaneBufferGeometry(1, 1),
            new THREE.MeshBasicMaterial({
                map: glowTexture,
                transparent: true,
                depthWrite: false,
                polygonOffset: true,
                polygonOffsetFactor: -4,
            }),
        );
        this.arrow = new Arrow({ depthWrite: false });
        this.group.add(this.disc, this.arrow.group);
        this.group.visible = false;
        this.born = -Infinity;
    }

    show(parent, strike, now) {
        parent.add(this.group);
        this.born = now;
        this.hand = strike.hand;
        this.latest = true;
        this.length = 0.06 + ARROW_LENGTH * Math.min(strike.force, STRONGEST);
        this.group.position.set(strike.x, strike.y, 0);
        this.size = 0.1 + 0.0011 * Math.min(strike.force, 200);
        this.arrow.write(strike.force, strike.hand === "left" ? "#7fd6ff" : "#ffb066");
        this.group.visible = true;
    }

    // `near` scales the writing with the distance of the camera
    update(now, shown, near) {
        const age = (now - this.born) / MARK_TIME,
            fade = 1 - age;
        if (!this.group.visible) return;
        if (age > 1) {
            this.group.visible = false;
            return;
        }
        const grow = Math.min(1, 0.35 + (now - this.born) / 70);
        this.disc.scale.setScalar(this.size * (1 + 0.9 * age));
        this.disc.position.z = 0.004;
        this.disc.material.opacity = fade * fade;
        this.arrow.stretch(this.length * grow, near);
        this.arrow.material.opacity = 0.9 * Math.min(1, 2 * fade);
        this.arrow.label.sprite.material.opacity = Math.min(1, 2 * fade);
        this.arrow.group.visible = shown.forces && this.latest;
        this.disc.visible = shown.marks;
    }
}

export class Marks {
    constructor(count = 24) {
        this.pool = Array.from({ length: count }, () => new Mark());
        this.next = 0;
        this.shown = 0; // marks since the page was loaded
    }

    add(parent, strike, now) {
        // only the last force of each hand is written, so that rolls stay readable
        for (const m of this.pool)
            if (m.hand === strike.hand && m.group.parent === parent) m.latest = false;
        this.pool[this.next++ % this.pool.length].show(parent, strike, now);
        this.shown++;
    }

    clear() {
        for (const mark of this.pool) mark.group.visible = false;
    }

    update(now, shown, near) {
        for (const mark of this.pool) mark.update(now, shown, near);
    }

    visible() {
        return this.pool.filter(m => m.group.visible).length;
    }
}

const POINTS = 60,
    TRAIL = 900; // (ms)

// The colour of a tip's distance from its target: chosen, green up to 0.1 mm, yellow at 1 mm, orange
// at 10 mm, red from 100 mm on.
export const ERRORS = ["#3ddc84", "#ffe14d", "#ff9a3d", "#ff3b3b"];
const errorColors = ERRORS.map(rgb);
function errorColor(distance, out) {
    const at = Math.min(2.999, Math.max(0, 4 + Math.log10(Math.max(1e-9, distance)))),
        i = Math.floor(at);
    return out.copy(errorColors[i]).lerp(errorColors[i + 1], at - i);
}

// A ribbon that faces the camera and gets thinner with age.
export class Trail {
    constructor(color) {
        this.points = [];
        this.geometry = new THREE.BufferGeometry();
        const index = [];
        for (let i = 0; i < POINTS - 1; i++)
            index.push(2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 1, 2 * i + 3, 2 * i + 2);
        this.geometry.setIndex(index);
        this.geometry.setAttribute(
            "position",
            new THREE.BufferAttribute(new Float32Array(6 * POINTS), 3),
        );
        this.geometry.setAttribute(
            "color",
            new THREE.BufferAttribute(new Float32Array(6 * POINTS), 3),
        );
        this.mesh = new THREE.Mesh(
            this.geometry,
            new THREE.MeshBasicMaterial({
                vertexColors: THREE.VertexColors,
                transparent: true,
                blending: THREE.AdditiveBlending,
                depthWrite: false,
                side: THREE.DoubleSide,
            }),
        );
        this.mesh.frustumCulled = false;
        this.color = rgb(color);
        ((this.away = new THREE.Vector3()),
            (this.along = new THREE.Vector3()),
            (this.side = new THREE.Vector3()),
            (this.inverse = new THREE.Matrix4()));
        this.eye = new THREE.Vector3();
    }

    clear() {
        this.points.length = 0;
        this.geometry.setDrawRange(0, 0);
    }

    // `target`: where p should be, for a colour of its own; or null
    add(p, now, camera, group, target) {
        this.inverse.getInverse(group.matrixWorld);
        p.applyMatrix4(this.inverse);
        this.eye.copy(camera.position).applyMatrix4(this.inverse);
        const color = target ? errorColor(p.distanceTo(target), new THREE.Color()) : this.color;
        this.points.push({ p, now, color });
        while (
            this.points.length > POINTS ||
            (this.points.length && now - this.points[0].now > TRAIL)
        )
            this.points.shift();
        const position = this.geometry.attributes.position,
            colors = this.geometry.attributes.color,
            n = this.points.length;
        for (let i = 0; i < n; i++) {
            const at = this.points[i],
                before = this.points[Math.max(0, i - 1)].p,
                after = this.points[Math.min(n - 1, i + 1)].p;
            const life = 1 - (now - at.now) / TRAIL,
                width = 0.0075 * life;
            (this.away.copy(this.eye).sub(at.p), this.along.copy(after).sub(before));
            this.side.crossVectors(this.away, this.along);
            if (this.side.lengthSq() > 1e-12) this.side.normalize().multiplyScalar(width);
            position.setXYZ(
                2 * i,
                at.p.x + this.side.x,
                at.p.y + this.side.y,
                at.p.z + this.side.z,
            );
            position.setXYZ(
                2 * i + 1,
                at.p.x - this.side.x,
                at.p.y - this.side.y,
                at.p.z - this.side.z,
            );
            const light = 0.4 * life * life;
            for (const k of [2 * i, 2 * i + 1])
                colors.setXYZ(k, light * at.color.r, light * at.color.g, light * at.color.b);
        }
        this.geometry.setDrawRange(0, Math.max(0, 6 * (n - 1)));
        position.needsUpdate = colors.needsUpdate = true;
    }
}
