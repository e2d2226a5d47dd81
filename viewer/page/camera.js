// The camera: mouse (left button rotates, right button or shift moves, the wheel zooms to what is
// under it, a double click looks at it), touch (one finger rotates, two move and zoom), and presets.
// Factors of mouse and touch: chosen by hand.
import * as THREE from "./three.js";

const presets = {
    // target (m), azimuth (0 faces the performer) and elevation (rad), distance (m); chosen by eye
    stage: [[0.32, 0, 0.76], -0.75, 0.2, 2.65],
    front: [[0.3, 0, 0.78], 0, 0.24, 2.55],
    side: [[0.32, 0, 0.77], -1.5708, 0.12, 2.6],
    top: [[0.5, 0, 0.8], -0.001, 1.4, 2.45],
    hands: [[0.45, 0, 0.95], -0.55, 0.42, 0.95],
    head: [[0.7, 0, 0.85], -0.45, 0.3, 1.15],
};

export const ALONE = 0.45; // what the cameras show on either side of a performer with one drum (m)
export const SEATED = 1.35; // what they show of his height, to the joint of the head (m)
const FEET = 1.4, // how much farther off the feet are seen too; chosen
    FOV = 38, // of the height (degrees)
    ASIDE = 0.25, // of the spread: how far before the performer the camera then looks
    NEARER = 0.65, // the drums to the camera than the target (m)
    NEAREST = 0.2, // from the target (m)
    CLOSE_UP = 0.9, // after a double click (m), or nearer
    PICK = 80; // a double click this near to a joint, a tip or a head looks at it (pixels)
const calm = matchMedia("(prefers-reduced-motion: reduce)");

export class View {
    constructor(canvas) {
        this.points = () => []; // what a double click may look at (m)
        this.chosen = () => {}; // a click
        this.follow = () => null; // where the camera of that name looks now (m)
        this.camera = new THREE.PerspectiveCamera(FOV, 1, 0.03, 80);
        this.camera.up.set(0, 0, 1);
        this.now = { target: new THREE.Vector3(), azimuth: 0, elevation: 0, distance: 1 };
        this.goal = { target: new THREE.Vector3(), azimuth: 0, elevation: 0, distance: 1 };
        this.lift = 0; // what is written below takes this share of the height, twice
        this.aside = 0; // what is written at the left takes this share of the width, twice
        this.whole = false; // nothing of the performer behind the writing, not his feet either
        this.deep = 0; // how much nearer to the camera the outer performers are (m)
        this.spread = 0; // of all, on either side beyond ALONE (m)
        this.tall = 0; // of the tallest, beyond SEATED (m)
        this.pointers = new Map();
        this.preset("stage");
        this.settle();
        const on = (name, f) => canvas.addEventListener(name, f, { passive: false });
        on(
            "pointerdown",
            e => (
                canvas.setPointerCapture(e.pointerId),
                (this.pressed = [e.clientX, e.clientY]),
                this.pointers.set(e.pointerId, [e.clientX, e.clientY])
            ),
        );
        on("pointermove", e => this.drag(e));
        on("pointerup", e => this.pointers.has(e.pointerId) && this.still(e) && this.chosen(e));
        for (const name of ["pointerup", "pointercancel"])
            on(name, e => this.pointers.delete(e.pointerId));
        on("wheel", e => (e.preventDefault(), this.zoom(Math.exp(0.0012 * e.deltaY), e)));
        on("dblclick", e => this.focus(e));
        on("contextmenu", e => e.preventDefault());
    }

    // goes at once where it is going to
    settle() {
        Object.assign(this.now, { ...this.goal, target: this.goal.target.clone() });
    }

    preset(name) {
        if (name === "eye") this.name = name;
        else if (Object.hasOwn(presets, name)) {
            const [target, azimuth, elevation, distance] = presets[name];
            const wide = (innerWidth / innerHeight) * (1 - 2 * this.aside), // that is left beside the writing
                narrow = Math.max(1, 0.95 / Math.max(0.3, wide)),
                above = this.whole ? FEET / (1 - 2 * this.lift) : 1 + 2 * this.lift, // what is left over the writing
                half = Math.tan((FOV * Math.PI) / 360),
                upright = ["stage", "front", "side"].includes(name) ? this.tall : 0,
                near = name === "top" ? 0 : NEARER + Math.max(0, this.deep - ASIDE * this.spread);
            this.name = name;
            Object.assign(this.goal, {
                azimuth,
                elevation,
                distance: Math.max((distance + (0.8 * upright) / half) * Math.max(narrow, above), (ALONE + this.spread) / (half * wide) + near),
            });
            this.goal.target.set(...target);
            this.goal.target.z += 0.6 * upright; // and air over his head
            if (this.spread && name !== "top") this.goal.target.x += ASIDE * this.spread;
            if (this.follow(name)) this.goal.distance = distance * narrow;
        }
        return this.name === name;
    }

    // how much larger writing is drawn than 2.9 m away
    near() {
        return this.name === "eye" ? 0.5 : Math.min(3, Math.max(0.4, this.now.distance / 2.9));
    }

    // a point of the page as the camera has it, -1 .. 1
    screen(e) {
        return [(2 * e.clientX) / innerWidth - 1, 1 - (2 * e.clientY) / innerHeight];
    }

    // keeps what is under the pointer where it is, at the target's depth
    zoom(factor, e) {
        const before = this.goal.distance;
        this.goal.distance = Math.min(30, Math.max(NEAREST, before * factor));
        if (e) {
            const [right, high] = this.screen(e),
                x = right - 2 * this.aside,
                y = high - 2 * this.lift, // over the target
                half = Math.tan((this.camera.fov * Math.PI) / 360) * (before - this.goal.distance),
                m = this.camera.matrixWorld.elements;
            for (const [i, a] of ["x", "y", "z"].entries())
                this.goal.target[a] += half * (x * this.camera.aspect * m[i] + y * m[4 + i]);
        }
        this.leave();
    }

    // a click, not a drag
    still(e) {
        return Math.hypot(e.clientX - this.pressed[0], e.clientY - this.pressed[1]) < 4;
    }

    // what is under the pointer, near and far
    ray(e) {
        const caster = new THREE.Raycaster();
        caster.setFromCamera(
            { x: (2 * e.clientX) / innerWidth - 1, y: 1 - (2 * e.clientY) / innerHeight },
            this.camera,
        );
        return caster.ray;
    }

    // which of the points is under the pointer; -1: none
    nearest(points, e) {
        const [x, y] = this.screen(e),
            off = points.map(p => {
                const q = p.clone().project(this.camera);
                return Math.abs(q.z) > 1
                    ? Infinity
                    : Math.hypot(((q.x - x) * innerWidth) / 2, ((q.y - y) * innerHeight) / 2);
            }),
            least = Math.min(...off);
        return least > PICK ? -1 : off.indexOf(least);
    }

    focus(e) {
        const points = this.points(),
            i = this.nearest(points, e);
        if (i < 0) return;
        this.leave();
        this.goal.target.copy(points[i]);
        this.goal.distance = Math.min(this.goal.distance, CLOSE_UP);
    }

    // to the window's size; the middle of the picture is above what is written below, and beside
    resize() {
        const w = innerWidth,
            h = innerHeight;
        this.camera.setViewOffset(w, h, -this.aside * w, this.lift * h, w, h);
    }

    // by an angle (rad)
    orbit(x, y) {
        this.goal.azimuth += x;
        this.goal.elevation = Math.min(1.55, Math.max(-0.08, this.goal.elevation + y));
        this.leave();
    }

    leave() {
        if (this.name === "eye") this.preset("stage");
        this.name = "";
    }

    drag(e) {
        const before = this.pointers.get(e.pointerId);
        if (!before) return;
        const dx = e.clientX - before[0],
            dy = e.clientY - before[1],
            all = [...this.pointers];
        if (all.length === 2) {
            const other = all.find(([id]) => id !== e.pointerId)[1],
                length = (x, y) => Math.hypot(x - other[0], y - other[1]);
            this.zoom(length(...before) / Math.max(1, length(e.clientX, e.clientY)));
            this.move(dx / 2, dy / 2);
        } else if (e.buttons & 2 || e.shiftKey) this.move(dx, dy);
        else this.orbit(-0.006 * dx, 0.005 * dy);
        this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
    }

    move(dx, dy) {
        const scale = (this.goal.distance / window.innerHeight) * 0.75,
            m = this.camera.matrixWorld.elements;
        this.goal.target.add(
            new THREE.Vector3(
                -m[0] * dx + m[4] * dy,
                -m[1] * dx + m[5] * dy,
                -m[2] * dx + m[6] * dy,
            ).multiplyScalar(scale),
        );
        this.leave();
    }

    update(dt, performer) {
        const eye = this.name === "eye" && performer && performer.group.visible;
        if (performer) performer.figure.showHead(!eye);
        if (eye) return this.look(performer);
        const followed = this.follow(this.name);
        if (followed) this.goal.target.copy(followed);
        if (this.camera.fov !== FOV) ((this.camera.fov = FOV), this.camera.updateProjectionMatrix());
        const k = calm.matches ? 1 : 1 - Math.exp(-dt / 120),
            n = this.now,
            g = this.goal;
        n.target.lerp(g.target, k);
        for (const a of ["azimuth", "elevation", "distance"]) n[a] += k * (g[a] - n[a]);
        const c = Math.cos(n.elevation);
        this.camera.position
            .set(Math.cos(n.azimuth) * c, Math.sin(n.azimuth) * c, Math.sin(n.elevation))
            .multiplyScalar(n.distance)
            .add(n.target);
        this.camera.position.z = Math.max(0.08, this.camera.position.z);
        this.camera.lookAt(n.target);
    }

    look(performer) {
        const m = performer.eye(),
            at = new THREE.Vector3(0.09, 0, 0.1).applyMatrix4(m),
            to = new THREE.Vector3(0.72, 0, -0.35).applyMatrix4(m);
        this.camera.position.copy(at);
        this.camera.lookAt(to);
        if (this.camera.fov !== 62) ((this.camera.fov = 62), this.camera.updateProjectionMatrix());
    }
}
