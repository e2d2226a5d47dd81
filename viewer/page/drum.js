// A kettledrum or a drum with a shell at its place, whose head modal amplitudes move; or a slab for bars and
// blocks, a disc of bronze for a plate, two for hats. Shapes and colours: chosen by eye.
import * as THREE from "./three.js";
import { rgb, picture } from "./color.js";
import { Net } from "./modes.js";
import { joined, lathe, ring, rod } from "./solids.js";
import { discard } from "./stage.js";

const RINGS = 22, // of the head's net: fine enough for the 64 modes drawn
    SECTORS = 72,
    MODES = 64,
    ABSENT_AFTER = 4000, // without amplitudes and strikes (ms); chosen: a drum at rest may send rarely
    HINGE = 0.07, // of the pedal, outside the head's edge (m); this and its angle as in pedal.c
    PEDAL = 0.22, // at rest (rad)
    HEEL = [-0.055, 0, -0.075], // in the foot's frame (m)
    TREADS = 0.06, // a heel so near the hinge has its foot on the pedal (m); chosen
    SHALLOW = 0.05, // what is less deep is no shell but a plate ...
    FLAT = 0.01, // ... and one less deep than this no pair of them (m)
    BOW = [[0, 0.07], [0.1, 0.06], [0.2, 0.01], [0.6, 0], [1, -0.03]], // of a plate: out, up (radii)
    SLAB = 0.022, // thickness of bars and blocks (m)
    UNDER_SLAB = 0.12, // radius of their stand (m)
    LARGEST_HEIGHT = 0.22, // as drawn, fraction of the radius; chosen: clear of the sticks
    AT_REST = 1e-16; // sum of squared amplitudes (m^2): 10 nm, far below a pixel
const net = new Net(RINGS, SECTORS);
export const usualPlace = [0.7, 0, 0.85, 0, 0.3302]; // 26 inches, where the library puts a drum

function dimples() {
    const size = 256,
        canvas = document.createElement("canvas"),
        c = canvas.getContext("2d");
    canvas.width = canvas.height = size;
    c.fillStyle = "#808080";
    c.fillRect(0, 0, size, size);
    let seed = 7;
    const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
    for (let i = 0; i < 420; i++) {
        const x = random() * size,
            y = random() * size,
            r = 7 + 8 * random();
        for (const [dx, dy] of [
            [0, 0],
            [size, 0],
            [-size, 0],
            [0, size],
            [0, -size],
        ]) {
            const g = c.createRadialGradient(x + dx, y + dy, 0, x + dx, y + dy, r);
            (g.addColorStop(0, "rgba(40,40,40,0.35)"), g.addColorStop(1, "rgba(160,160,160,0)"));
            c.fillStyle = g;
            c.fillRect(x + dx - r, y + dy - r, 2 * r, 2 * r);
        }
    }
    const texture = new THREE.CanvasTexture(canvas);
    texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
    texture.repeat.set(10, 5);
    return texture;
}

function parchment() {
    const size = 512,
        canvas = document.createElement("canvas"),
        c = canvas.getContext("2d");
    canvas.width = canvas.height = size;
    const g = c.createRadialGradient(size / 2, size / 2, 0, size / 2, size / 2, size / 2);
    (g.addColorStop(0, "#e9dcc0"), g.addColorStop(0.8, "#e4d4b4"), g.addColorStop(1, "#cdb68d"));
    c.fillStyle = g;
    c.fillRect(0, 0, size, size);
    let seed = 3;
    const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
    for (let i = 0; i < 900; i++) {
        c.fillStyle = `rgba(${random() < 0.5 ? "255,250,235" : "120,90,50"},${0.035 * random()})`;
        c.beginPath();
        c.ellipse(
            random() * size,
            random() * size,
            4 + 30 * random(),
            2 + 10 * random(),
            random() * 3,
            0,
            7,
        );
        c.fill();
    }
    return picture(canvas);
}

let shared;
// `plain` (stage.js): without what a plain picture has too few points for
function materials({ environment: envMap, plain }) {
    if (shared) return shared;
    const metal = (color, roughness, extra) =>
        new THREE.MeshStandardMaterial({
            color,
            roughness,
            metalness: 1,
            envMap,
            envMapIntensity: 1.6,
            ...extra,
        });
    return (shared = {
        copper: metal(rgb("#e08a5c"), 0.2, {
            bumpMap: plain ? null : dimples(),
            bumpScale: 0.006,
            side: THREE.DoubleSide,
        }),
        wood: new THREE.MeshStandardMaterial({ color: rgb("#7a3f26"), roughness: 0.45, envMap, envMapIntensity: 0.5 }),
        metal: metal(0xffffff, 0.26, { vertexColors: THREE.VertexColors }),
        head: new THREE.MeshStandardMaterial({
            color: rgb("#d8d4cc"),
            map: parchment(),
            roughness: 0.5,
            envMap,
            envMapIntensity: 0.45,
            side: THREE.DoubleSide,
        }),
    });
}

// the kettle, and its edge rolled outwards below the collar of the head
function bowl(a, plain) {
    const points = [];
    for (let i = 0; i <= 20; i++) {
        const t = ((i / 20) * Math.PI) / 2; // from the bottom up
        points.push([a * Math.pow(Math.sin(t), 0.82), -0.02 - 0.86 * a * Math.pow(Math.cos(t), 0.9)]);
    }
    return lathe([...points, [1.03 * a, -0.022], [1.03 * a, -0.03]], plain ? 32 : 64);
}

// a shell with its lower hoop
const shell = (a, depth) =>
    lathe([[0, -depth], [1.03 * a, -depth], [1.03 * a, 0.02 - depth], [a, 0.02 - depth], [a, -0.02], [1.03 * a, -0.03]], 64);

const BRONZE = rgb("#c29a4b"),
    STEEL = rgb("#c9ccd0"),
    DARK = rgb("#3c3f44"),
    PALE = rgb("#f6f2e6");

// one geometry of bars of steel and dark ones
const metals = (steel, dark, pale = []) =>
    joined(
        [...steel, ...dark, ...pale],
        [...steel.map(() => STEEL), ...dark.map(() => DARK), ...pale.map(() => PALE)],
    );

const around = (r, t, h) => [r * Math.cos(t), r * Math.sin(t), h];

// The stand in the drum's place, untilted, its pedal along x; `z` is the height of the head above the
// floor. Three legs on wheels, joined below to the column in the middle, above to a ring.
function stand(a, z) {
    const floor = h => h - z,
        hub = floor(0.085),
        dark = [ring(a * 1.075, 0.009, -0.16), rod([0, 0, floor(0.04)], [0, 0, floor(0.13)], 0.038)],
        steel = [rod([0, 0, floor(0.12)], [0, 0, -0.8 * a], 0.017)];
    for (let i = 0; i < 3; i++) {
        const t = ((2 * i + 1) * Math.PI) / 3,
            foot = around(a * 0.97, t, floor(0.075));
        dark.push(
            rod(around(a * 1.075, t, -0.15), foot, 0.011),
            rod(foot, [0, 0, hub], 0.013),
            wheel(a * 0.97, t, floor(0.034)),
        );
        steel.push(rod(around(a * 0.97, t, floor(0.03)), foot, 0.014));
    }
    const hinge = a + HINGE;
    steel.push(rod([hinge - 0.18, 0, floor(0.05)], [0, 0, hub], 0.012));
    dark.push(new THREE.BoxBufferGeometry(0.03, 0.11, 0.008).translate(hinge - 0.01, 0, floor(0.004)));
    return metals(steel, dark);
}

// below a sole, from its hinge inwards
const plate = () => metals([new THREE.BoxBufferGeometry(0.19, 0.085, 0.01).translate(-0.12, 0, -0.006)], []);

const slab = (length, width) => new THREE.BoxBufferGeometry(length, width, SLAB).translate(0, 0, -SLAB / 2);

// one plate, or a second one upside down so far below
function plates(a, depth) {
    const one = (z, up) => {
            const side = t => BOW.map(([r, h]) => [r * a, z + up * h * a + t]);
            return lathe([...side(-0.001), ...side(0.001).reverse()], 64);
        },
        all = depth < FLAT ? [one(0, 1)] : [one(0, 1), one(-depth, -1)];
    return joined(all, all.map(() => BRONZE));
}

// a rod through a plate so high above the floor, on three feet
const tripod = z =>
    metals(
        [rod([0, 0, 0.05 - z], [0, 0, 0.04], 0.009)],
        [0, 2, 4].map(i => rod(around(0.24, (i * Math.PI) / 3, 0.008 - z), [0, 0, 0.35 - z], 0.008)),
    );

// with its axle across the leg
const wheel = (r, t, h) =>
    new THREE.CylinderBufferGeometry(0.034, 0.034, 0.022, 20).rotateZ(t).translate(...around(r, t, h));

// The counterhoop below the head, which is drawn over the kettle's edge, with eight screws and the tuning
// gauge; in the head's frame, the player along x.
function fittings(a) {
    const band = [
            [1.022 * a, -0.03],
            [1.045 * a, -0.03],
            [1.045 * a, -0.01],
            [1.022 * a, -0.01],
        ],
        steel = band.slice(1).map((p, i) => lathe([band[i], p], 64)), // each with its own edges
        dark = [];
    for (let i = 0; i < 8; i++) {
        const p = h => around(a * 1.06, (2 * Math.PI * (i + 0.5)) / 8, h);
        steel.push(rod(p(-0.007), p(-0.19), 0.0055), rod(p(-0.0085), p(-0.028), 0.011));
        dark.push(rod(p(-0.11), p(-0.17), 0.009));
    }
    const [x, y] = around(a * 1.09 + DIAL, GAUGE_AT, 0),
        at = (dx, dy, z) => [x + dx, y + dy, z],
        dial = new THREE.CylinderBufferGeometry(DIAL, DIAL, 0.004, 24, 1, false, -1.1, 2.2);
    dark.push(
        rod(at(0, 0, -0.165), at(0, 0, 0.015), 0.006),
        rod(around(a * 1.07, GAUGE_AT, -0.158), at(0, 0, -0.158), 0.006),
        rod(at(0.004, 0, 0.012), at(0.004, 0.02, DIAL - 0.006), 0.002), // its hand
    );
    return metals(steel, dark, [dial.rotateZ(Math.PI / 2).translate(...at(0, 0, 0.008))]);
}

const GAUGE_AT = 1.4, // from the player's direction: beside the hands (rad)
    DIAL = 0.06; // its radius (m)

// where the head bends down to its hoop: out (radii), down (m), how far the normal is turned outwards
const COLLAR = [
    [1.008, -0.0025, 0.4],
    [1.018, -0.011, 0.8],
    [1.026, -0.016, 0.6],
];

// `plain`: every other point of the net is drawn
function headGeometry(a, plain) {
    const g = new THREE.BufferGeometry(),
        rings = RINGS + COLLAR.length,
        position = new Float32Array(3 * (rings + 1) * SECTORS),
        normal = new Float32Array(position.length),
        uv = [],
        index = [],
        step = plain ? 2 : 1;
    for (let r = 0; r <= rings; r++)
        for (let s = 0; s < SECTORS; s++) {
            const t = (2 * Math.PI * s) / SECTORS,
                [out, down, slope] = COLLAR[r - RINGS - 1] ?? [r / RINGS, 0, 0],
                x = Math.cos(t) * out,
                y = Math.sin(t) * out,
                b = SECTORS;
            position.set([a * x, a * y, down], 3 * (r * SECTORS + s));
            normal.set([slope * Math.cos(t), slope * Math.sin(t), 1 - slope], 3 * (r * SECTORS + s));
            uv.push(0.5 + x / 2, 0.5 + y / 2);
            const i = r * b + s,
                j = r * b + ((s + step) % b),
                next = (r < RINGS ? step : 1) * b;
            if (r < rings && s % step === 0 && (r > RINGS || r % step === 0)) index.push(i, i + next, j, j, i + next, j + next);
        }
    g.setIndex(index);
    g.setAttribute("position", new THREE.BufferAttribute(position, 3));
    g.setAttribute("normal", new THREE.BufferAttribute(normal, 3));
    g.setAttribute("uv", new THREE.Float32BufferAttribute(uv, 2));
    return g;
}

export class Drum {
    constructor(key, name, stage) {
        ((this.key = key), (this.name = name), (this.stage = stage));
        this.group = new THREE.Group();
        this.tilted = new THREE.Group();
        this.group.add(this.tilted);
        this.height = new Float32Array((RINGS + 1) * SECTORS);
        ((this.from = new Float32Array(MODES)),
            (this.to = new Float32Array(MODES)),
            (this.now = new Float32Array(MODES)));
        this.fromTime = this.toTime = 0;
        this.mark = -Infinity; // the last strike, by the clock of marks (ms)
        this.heard = this.struck = 0; // amplitudes, a strike (ms)
        this.excursion = 0; // largest displacement of the head now, not exaggerated (m)
        this.setPlace(usualPlace);
        stage.scene.add(this.group);
    }

    setPlace(place) {
        if (this.place && this.place.every((v, i) => v === place[i])) return;
        const build = !this.place || [2, 4, 5, 6].some(i => this.place[i] !== place[i]);
        this.place = Array.from(place);
        const [x, y, z, tilt, a, length, width] = place;
        if (build) this.build(a, z, length, width);
        if (this.slab) this.slab.rotation.z = Math.atan2(y, x); // its length leads away from the player
        this.tilted.position.set(x, y, z);
        this.tilted.rotation.y = -tilt;
        this.legs.position.set(x, y, z);
    }

    // Turns pedal and gauge to the player; a foot on the pedal turns that.
    turn(player) {
        const [x, y, , , a] = this.place,
            to = Math.atan2(-y, -x),
            hinge = new THREE.Vector3(x + (a + HINGE) * Math.cos(to), y + (a + HINGE) * Math.sin(to), 0);
        this.legs.rotation.z = this.trim.rotation.z = to;
        for (const foot of player.feet())
            if (new THREE.Vector3(...HEEL).applyMatrix4(foot).distanceTo(hinge) < TREADS)
                this.pedal.rotation.y = Math.asin(foot.elements[2] / Math.hypot(...foot.elements.slice(0, 3)));
    }

    // where it is struck, in its group's frame, which is its player's (m)
    spot({ x, y }) {
        this.tilted.updateMatrix();
        return new THREE.Vector3(x, y, 0).applyMatrix4(this.tilted.matrix);
    }

    // `length` and `width` of what is no drum: then nothing is seen of head and kettle; without a length the
    // width is the depth of a shell or plates
    build(a, z, length, width) {
        const { plain } = this.stage,
            m = materials(this.stage);
        for (const old of [...this.tilted.children, this.legs]) if (old) discard(old);
        this.head = new THREE.Mesh(headGeometry(a, plain), m.head);
        this.trim = new THREE.Mesh(fittings(a), m.metal);
        this.slab = length > 0 && new THREE.Mesh(slab(length, width), m.wood);
        const thin = !this.slab && width > 0 && width < SHALLOW;
        if (this.slab) this.tilted.add(this.slab);
        else if (thin) this.tilted.add(new THREE.Mesh(plates(a, width), m.metal));
        else this.tilted.add(new THREE.Mesh(width > 0 ? shell(a, width) : bowl(a, plain), width > 0 ? m.wood : m.copper), this.head, this.trim);
        this.legs = new THREE.Mesh(thin ? tripod(z) : stand(this.slab ? Math.min(a, UNDER_SLAB) : a, z), m.metal);
        this.pedal = new THREE.Mesh(plate(), m.metal);
        this.pedal.position.set(a + HINGE, 0, -z);
        this.pedal.rotation.y = PEDAL;
        if (!this.slab && !(width > 0)) this.legs.add(this.pedal);
        this.group.add(this.legs);
        this.group.traverse(o => (o.castShadow = o.receiveShadow = true));
        this.head.castShadow = false;
        this.draw(1);
    }

    receive(now, place, amplitude) {
        if (place) this.setPlace(place);
        this.from.set(this.now);
        this.fromTime = now;
        this.toTime = now + Math.min(60, Math.max(10, now - (this.heard || now - 30)));
        this.to.fill(0);
        this.to.set(amplitude);
        this.heard = now;
    }

    // shows these amplitudes, of a playback
    show(now, place, amplitude) {
        this.setPlace(place);
        this.to.fill(0);
        this.to.set(amplitude);
        this.fromTime = this.toTime = 0;
        this.heard = now;
    }

    present(now) {
        return now - Math.max(this.heard, this.struck) < ABSENT_AFTER;
    }

    update(now, exaggeration) {
        const t =
            this.toTime > this.fromTime
                ? Math.min(1, (now - this.fromTime) / (this.toTime - this.fromTime))
                : 1;
        let energy = 0;
        for (let i = 0; i < MODES; i++) {
            this.now[i] = this.from[i] + t * (this.to[i] - this.from[i]);
            energy += this.now[i] * this.now[i];
        }
        const still = energy < AT_REST;
        if (!(still && this.wasStill)) this.draw(exaggeration);
        this.wasStill = still;
    }

    // the lowest shapes: by how much points and normals differ from rest where a shape is `height` (m)
    shapes(count, height) {
        const part = 1e-3, // of it, which is drawn: there heights and slopes are in proportion
            now = this.now.slice(),
            { position, normal } = this.head.geometry.attributes,
            drawn = i => {
                this.now.fill(0);
                if (i >= 0) this.now[i] = part * height;
                this.draw(1);
                return [position, normal].map(a => Float32Array.from(a.array));
            },
            rest = drawn(-1),
            made = Array.from({ length: count }, (_, i) => {
                const [p, n] = drawn(i).map((a, k) => a.map((v, j) => (v - rest[k][j]) / part));
                return { position: p, normal: n };
            });
        this.now.set(now);
        this.wasStill = false;
        return made;
    }

    // Heights, exaggerated but limited, and normals from the differences along and across the
    // rings.
    draw(exaggeration) {
        const { position, normal } = this.head.geometry.attributes,
            p = position.array,
            n = normal.array,
            h = this.height;
        const a = this.place[4],
            dr = a / RINGS,
            b = SECTORS,
            limit = LARGEST_HEIGHT * a;
        net.fill(this.now, h);
        this.excursion = 0;
        for (let i = 0; i < h.length; i++) {
            if (Math.abs(h[i]) > this.excursion) this.excursion = Math.abs(h[i]);
            const z = exaggeration * h[i];
            h[i] = p[3 * i + 2] = Math.abs(z) < 0.05 * limit ? z : limit * Math.tanh(z / limit);
        }
        for (let r = 0; r <= RINGS; r++)
            for (let s = 0; s < b; s++) {
                const i = r * b + s,
                    outer = h[Math.min(r + 1, RINGS) * b + s],
                    inner = h[Math.max(r - 1, 0) * b + s];
                const radial = (outer - inner) / (dr * (r === 0 || r === RINGS ? 1 : 2));
                const round = r
                    ? (h[r * b + ((s + 1) % b)] - h[r * b + ((s + b - 1) % b)]) /
                      ((4 * Math.PI * r * dr) / b)
                    : 0;
                const c = net.cos[b + s],
                    d = net.sin[b + s];
                const x = -(radial * c - round * d),
                    y = -(radial * d + round * c),
                    l = 1 / Math.sqrt(x * x + y * y + 1);
                ((n[3 * i] = x * l), (n[3 * i + 1] = y * l), (n[3 * i + 2] = l));
            }
        position.needsUpdate = normal.needsUpdate = true;
    }
}
