// A performer. Poses arrive at 33 Hz with a varying delay, so each frame shows the pose of a moment
// ago (clock.js), interpolated between the poses before and after that moment: motion is smooth at any
// frame rate.
import * as THREE from "./three.js";
import { rgb } from "./color.js";
import { Clock } from "./clock.js";
import { HANDS, bone } from "./body.js";
import { Figure, shirts } from "./figure.js";
import { segments } from "./skeleton.js";
import { joined, lathe, rod } from "./solids.js";
import { Trail } from "./strike.js";
import { Supports } from "./support.js";

const KEPT = 256, // poses: chosen, 1 s at 250 Hz
    ABSENT_AFTER = 2000; // without a pose (ms); chosen: longer than a pause of the network
const qa = new THREE.Quaternion(),
    qb = new THREE.Quaternion();

function interpolate(a, b, t, out) {
    for (let o = 0; o < a.length; o += 7) {
        for (let i = 0; i < 3; i++) out[o + i] = a[o + i] + t * (b[o + i] - a[o + i]);
        qa.set(a[o + 4], a[o + 5], a[o + 6], a[o + 3]);
        qb.set(b[o + 4], b[o + 5], b[o + 6], b[o + 3]);
        qa.slerp(qb, t);
        ((out[o + 3] = qa.w), (out[o + 4] = qa.x), (out[o + 5] = qa.y), (out[o + 6] = qa.z));
    }
}

export class Performer {
    constructor(key, index, stage) {
        this.key = key;
        this.color = shirts[index % shirts.length];
        this.index = index;
        this.figure = new Figure(index, stage);
        this.group = this.figure.group;
        this.group.visible = false;
        this.poses = [];
        this.pose = new Float64Array(7 * segments.length);
        this.target = new Float32Array(3 * HANDS.length);
        this.clock = new Clock();
        this.trails = [new Trail("#6fd0ff"), new Trail("#ffb36f")];
        const ball = new THREE.SphereBufferGeometry(0.022, 24, 16);
        this.targets = this.trails.map(
            () =>
                new THREE.Mesh(
                    ball,
                    new THREE.MeshStandardMaterial({
                        color: rgb("#ffd21f"),
                        emissive: rgb("#ffc400"),
                        emissiveIntensity: 0.55,
                        transparent: true,
                        opacity: 0.55,
                        depthWrite: false,
                    }),
                ),
        );
        this.stool = stool(stage.environment);
        this.support = new Float32Array(12);
        this.supports = new Supports();
        this.group.add(this.stool, this.supports.group, ...this.targets, ...this.trails.map(t => t.mesh));
        stage.scene.add(this.group);
    }

    receive(time, now, known, targets, body, target, support) {
        if (!this.clock.hear(time, now)) return;
        const last = this.poses[this.poses.length - 1];
        if (last && (time < last.time || time - last.time >= 500)) this.poses.length = 0;
        this.poses.push({ time, known, targets, body, target, support });
        if (this.poses.length > KEPT) this.poses.shift();
        this.heard = now;
    }

    // shows this pose, of a playback; `home`: where a pelvis that is free rests
    show(now, pose, target, support, home) {
        ((this.heard = now), (this.poses.length = 0), (this.haveTargets = 3));
        (this.pose.set(pose), this.target.set(target), this.support.set(support));
        this.home = home;
        this.shown = true;
    }

    // at a point in the group's frame (m), or straight ahead
    lookAt(point) {
        this.figure.look = point ?? null;
    }

    present(now) {
        return this.heard !== undefined && now - this.heard < ABSENT_AFTER;
    }

    interpolateAt(moment) {
        const list = this.poses;
        let i = list.length - 1;
        while (i > 0 && list[i].time > moment) i--;
        const a = list[i],
            b = list[Math.min(i + 1, list.length - 1)];
        const t =
            b.time > a.time ? Math.min(1, Math.max(0, (moment - a.time) / (b.time - a.time))) : 0;
        interpolate(a.body, b.body, t, this.pose);
        for (const what of ["target", "support"])
            a[what].forEach((v, k) => (this[what][k] = v + t * (b[what][k] - v)));
        this.haveTargets = a.targets;
    }

    // `time` is that of the trails: of a playback, or now; `heard` is the moment of its clock that is at
    // the loudspeaker, null while nothing sounds (ms)
    update(now, time, camera, shown, near, heard) {
        this.group.visible = this.present(now) && (this.shown || this.poses.length > 0);
        if (!this.group.visible) return;
        if (this.poses.length) {
            const moment = this.clock.moment(now, heard);
            this.interpolateAt(moment);
            this.clock.run(moment);
        }
        this.figure.set(this.pose);
        this.targets.forEach((ball, hand) => {
            ball.visible = shown.targets && !!((this.haveTargets >> hand) & 1);
            ball.position.set(
                this.target[3 * hand],
                this.target[3 * hand + 1],
                this.target[3 * hand + 2],
            );
        });
        this.sit();
        this.supports.update(this, shown.forces && !this.ghostly, near);
        this.group.updateMatrixWorld();
        this.trails.forEach((trail, hand) => {
            trail.mesh.visible = shown.trails;
            const p = new THREE.Vector3().setFromMatrixPosition(
                this.figure.sticks[hand].tip.matrixWorld,
            );
            const wanted = shown.errors && (this.haveTargets >> hand) & 1 ? this.targets[hand].position : null;
            if (shown.trails) trail.add(p, time, camera, this.group, wanted);
        });
    }

    // the stool below him; one who sits freely moves on it, one whose feet alone carry him has none
    sit() {
        if (!this.rests || !this.support.some(v => v)) this.rests = this.pose.slice(0, 3);
        const [x, y, z] = this.home ?? this.rests,
            { stool } = this,
            size = this.figure.scale.x,
            high = z - BELOW * size;
        if (Math.hypot(stool.position.x + BEHIND * size - x, stool.position.y - y) > SLID)
            stool.position.set(x - BEHIND * size, y, 0);
        stool.cushion.position.z = high;
        stool.post.scale.z = high - 0.03;
        const [, , seat, , , left, , , right] = this.support;
        stool.visible = !this.ghostly && !(seat === 0 && left + right > STANDS);
    }

    // their places in the group's frame (m)
    feet() {
        return ["left", "right"].map(side => this.figure.bones[bone(`${side}-foot`)].matrixWorld);
    }

    // of the joint of his head (m)
    height() {
        return this.figure.bones[bone("head")].matrixWorld.elements[14];
    }

    // drawn in one transparent colour, without a stool; `color` null: as a performer
    ghost(color) {
        if (this.ghostly === color) return;
        this.ghostly = color;
        this.stool.visible = !color;
        this.figure.ghost(color);
        this.color = color ?? shirts[this.index % shirts.length];
    }

    // the middle of the hands in the scene (m)
    hands() {
        const [a, b] = HANDS.map(hand =>
            new THREE.Vector3().setFromMatrixPosition(this.figure.bones[bone(`${hand}-hand`)].matrixWorld),
        );
        return a.lerp(b, 0.5).applyMatrix4(this.group.matrixWorld);
    }

    // its joints and tips in the scene (m)
    points() {
        const { bones, sticks } = this.figure;
        return [
            ...bones.map(b =>
                new THREE.Vector3().setFromMatrixPosition(b.matrixWorld).applyMatrix4(this.group.matrixWorld),
            ),
            ...sticks.map(s => s.tip.getWorldPosition(new THREE.Vector3())),
        ];
    }

    eye() {
        return new THREE.Matrix4().multiplyMatrices(
            this.group.matrixWorld,
            this.figure.bones[bone("head")].matrixWorld,
        );
    }
}

const BEHIND = 0.11, // the seat's middle behind the hips, so that its edge is below the thighs (m)
    BELOW = 0.086, // the seat below the hips: the figure is 4 mm in the cushion (m)
    SLID = 0.05, // how far he may move on it before it is moved too (m)
    STANDS = 300; // on the feet of one who stands, at least (N)

// a seat 1 m high, which set() moves; its column is `post`
function stool(envMap) {
    const leather = new THREE.MeshStandardMaterial({ color: rgb("#3a1f1a"), roughness: 0.5, envMap, envMapIntensity: 0.5 }),
        metal = new THREE.MeshStandardMaterial({ color: rgb("#9aa0a6"), roughness: 0.3, metalness: 1, envMap }),
        profile = [
            [0, -0.068],
            [0.12, -0.068],
            [0.148, -0.058],
            [0.158, -0.035],
            [0.145, -0.01],
            [0.105, 0.001],
            [0.05, 0],
            [0, -0.001],
        ],
        curve = new THREE.SplineCurve(profile.map(p => new THREE.Vector2(...p))),
        cushion = new THREE.Mesh(lathe(curve.getPoints(20).map(p => [p.x, p.y]), 40), leather),
        post = new THREE.Mesh(rod([0, 0, 0.03], [0, 0, 1], 0.02), metal),
        legs = [1, 3, 5].flatMap(k => {
            const a = (k * Math.PI) / 3,
                at = (r, z) => [r * Math.cos(a), r * Math.sin(a), z];
            return [rod(at(0, 0.26), at(0.25, 0.014), 0.011), rod(at(0.25, 0.014), at(0.265, 0.006), 0.014)];
        }),
        base = new THREE.Mesh(joined([...legs, rod([0, 0, 0.02], [0, 0, 0.29], 0.027)]), metal),
        group = new THREE.Group();
    group.add(cushion, post, base);
    group.traverse(o => (o.castShadow = o.receiveShadow = true));
    return Object.assign(group, { cushion, post });
}
