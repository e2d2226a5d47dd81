// The stage: light, floor, curtain, and the reflections in metal. Sizes, lights and colours: chosen
// by eye.
import * as THREE from "./three.js";
import { rgb, picture } from "./color.js";
import { Sketch } from "./sketch.js";

const LATE_FRAME = 28, // (ms); chosen: below 36 frames/s motion is visibly uneven
    LATE_FRAMES = 40, // before a step; chosen: about a second, so that one pause changes nothing
    LATEST = 10; // frames that a very late one counts for

// takes an object away for ever, with what it holds of the graphics card
export function discard(object) {
    if (object.parent) object.parent.remove(object);
    object.traverse(part => part.geometry && part.geometry.dispose());
}

// Bright panels in a dark room, rendered once from the centre: the reflections in copper and steel, `size` points wide.
function environment(renderer, size) {
    const room = new THREE.Scene(),
        camera = new THREE.CubeCamera(0.1, 20, size);
    const panel = (color, strength, w, h, p) => {
        const c = rgb(color).multiplyScalar(strength);
        const mesh = new THREE.Mesh(
            new THREE.PlaneBufferGeometry(w, h),
            new THREE.MeshBasicMaterial({ color: c, side: THREE.DoubleSide, toneMapped: false }),
        );
        mesh.position.set(...p);
        mesh.up.set(0, 0, 1);
        mesh.lookAt(0, 0, 0);
        room.add(mesh);
    };
    const wall = new THREE.Mesh(
        new THREE.BoxBufferGeometry(12, 12, 8),
        new THREE.MeshBasicMaterial({
            color: rgb("#30323c"),
            toneMapped: false,
            side: THREE.BackSide,
        }),
    );
    const floor = new THREE.Mesh(
        new THREE.PlaneBufferGeometry(12, 12),
        new THREE.MeshBasicMaterial({ color: rgb("#4a3524"), toneMapped: false }),
    );
    floor.position.z = -1.5;
    room.add(wall, floor);
    panel("#fff0d8", 3.2, 3, 2, [3, -4, 3]);
    panel("#9fc0ff", 1.6, 2.4, 3, [-4, 4, 1.5]);
    panel("#ffd9b0", 2.0, 1, 4, [5, 3, 1]);
    panel("#ffffff", 1.4, 4, 1, [0, 0, 4]);
    panel("#ffb070", 1.0, 1, 3, [-5, -3, 0.6]);
    panel("#ffe9cc", 1.0, 5, 0.7, [3.5, -4, -0.4]);
    panel("#a8b8d8", 0.8, 4, 0.5, [-3, 4.5, -0.5]);
    panel("#d8b088", 0.7, 5, 2.5, [1, 0, -1.4]);
    panel("#fff4e4", 1.0, 0.8, 3.5, [4.8, -0.8, 0.8]);
    const texture = camera.renderTarget.texture;
    texture.generateMipmaps = true;
    texture.minFilter = THREE.LinearMipmapLinearFilter;
    camera.update(renderer, room);
    return texture;
}

function planks(sharp) {
    const canvas = document.createElement("canvas"),
        c = canvas.getContext("2d"),
        w = 1024;
    canvas.width = canvas.height = w;
    let seed = 11;
    const random = () => (seed = (seed * 16807) % 2147483647) / 2147483647;
    for (let row = 0; row < 8; row++) {
        const y = row * 128,
            start = random() * w;
        for (let part = 0; part < 3; part++) {
            const x = start + (part * w) / 3,
                l = 30 + 9 * random();
            for (const dx of [0, -w]) {
                c.fillStyle = `hsl(${24 + 5 * random()},${26 + 8 * random()}%,${l * 0.62}%)`;
                c.fillRect(x + dx, y, w / 3, 128);
                for (let g = 0; g < 46; g++) {
                    const grain = random() < 0.5 ? "20,10,5" : "150,105,70";
                    c.fillStyle = `rgba(${grain},${0.07 * random()})`;
                    c.fillRect(x + dx, y + 128 * random(), w / 3, 1 + 2 * random());
                }
                c.fillStyle = "rgba(0,0,0,0.5)";
                c.fillRect(x + dx, y, 2, 128);
            }
        }
        c.fillStyle = "rgba(0,0,0,0.55)";
        c.fillRect(0, y, w, 2);
    }
    const texture = picture(canvas);
    texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
    texture.repeat.set(16, 16);
    texture.anisotropy = sharp;
    return texture;
}

function spot(color, intensity, from, to, angle, shadow) {
    const light = new THREE.SpotLight(rgb(color), intensity, 0, angle, 0.7, 1);
    light.position.set(...from);
    light.target.position.set(...to);
    if (shadow) {
        light.castShadow = true;
        light.shadow.mapSize.set(shadow, shadow);
        light.shadow.bias = -0.0004;
        light.shadow.radius = 3;
        light.shadow.camera.near = 1.5;
        light.shadow.camera.far = 12;
    }
    return light;
}

// A curtain in folds round the stage, with painted light; visible from inside only, so that the
// camera may be outside.
function curtain() {
    const g = new THREE.CylinderBufferGeometry(1, 1, 7, 640, 7, true).rotateX(Math.PI / 2),
        p = g.attributes.position;
    const color = new Float32Array(3 * p.count),
        fold = t => Math.sin(70 * t + 1.5 * Math.sin(9 * t)) + 0.4 * Math.sin(151 * t);
    for (let i = 0; i < p.count; i++) {
        const t = Math.atan2(p.getY(i), p.getX(i)),
            r = 8.5 + 0.13 * fold(t),
            z = p.getZ(i) + 3.5;
        p.setXYZ(i, 1 + r * Math.cos(t), r * Math.sin(t), z);
        const slope = (fold(t + 0.004) - fold(t - 0.004)) / 0.008 / 110,
            lit = 0.5 + 0.42 * slope - 0.13 * fold(t);
        // dark at the hem, where the floor ends
        const hem = Math.min(1, Math.max(0, (z - 0.25) / 1.4)),
            glow =
                hem *
                hem *
                (3 - 2 * hem) *
                Math.exp(-((z - 1.1) ** 2) / 3.6) *
                (0.75 + 0.25 * Math.cos(2 * t));
        color.set(
            [0.105, 0.017, 0.02].map(c => c * lit * glow),
            3 * i,
        );
    }
    g.setAttribute("color", new THREE.BufferAttribute(color, 3));
    return new THREE.Mesh(
        g,
        new THREE.MeshBasicMaterial({
            vertexColors: THREE.VertexColors,
            side: THREE.BackSide,
            fog: false,
        }),
    );
}

// true where no graphics card draws
function inSoftware(gl) {
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    return !!info && /swiftshader|llvmpipe|softpipe|basic render/i.test(gl.getParameter(info.UNMASKED_RENDERER_WEBGL));
}

// one that plays, too, leaves the processor alone where that draws: no edge is smoothed then
function makeRenderer(canvas, plays) {
    const trial = plays ? document.createElement("canvas").getContext("webgl") : null,
        antialias = !(trial && inSoftware(trial)),
        context = canvas.getContext("webgl", { alpha: false, antialias });
    trial?.getExtension("WEBGL_lose_context")?.loseContext();
    return context ? new THREE.WebGLRenderer({ canvas, context }) : new Sketch(canvas);
}

export class Stage {
    // `plays`: the performer is in the page
    constructor(canvas, plays) {
        THREE.Object3D.DefaultUp.set(0, 0, 1);
        const renderer = (this.renderer = makeRenderer(canvas, plays));
        renderer.shadowMap.enabled = true;
        renderer.shadowMap.type = THREE.PCFSoftShadowMap;
        renderer.gammaOutput = true;
        renderer.gammaFactor = 2.2;
        renderer.toneMapping = THREE.ACESFilmicToneMapping;
        renderer.toneMappingExposure = 1.05;
        renderer.physicallyCorrectLights = true;
        this.scene = new THREE.Scene();
        this.flat = renderer instanceof Sketch; // a drawing
        this.plain = plays && this.software;
        this.environment = this.flat ? null : environment(renderer, this.plain ? 64 : 256);
        this.lights();
        this.floor();
        this.scene.background = rgb("#0a0707");
        this.scene.fog = new THREE.Fog(rgb("#0a0707"), 4.5, 10.5);
        this.scene.add((this.curtain = curtain()));
        this.quality = Math.min(window.devicePixelRatio || 1, 2);
    }

    lights() {
        this.key = spot("#ffe4c4", 50, [3.2, -3.0, 4.6], [0.3, 0, 0.7], 0.5, 2048);
        const rim = spot("#c3d2ff", 14, [-3.2, 2.8, 3.4], [0.3, 0, 0.9], 0.55);
        const side = spot("#ffc79c", 13, [3.6, 2.6, 1.9], [0.1, 0, 1], 0.5);
        this.set = [this.key, rim, side];
        const sky = new THREE.HemisphereLight(rgb("#b4bcd0"), rgb("#8a6a52"), 0.5);
        sky.position.set(0, 0, 1);
        this.scene.add(sky);
        for (const l of this.set) this.scene.add(l, l.target);
    }

    // widens the light to `reach` metres round (x, 0)
    cover(x, reach) {
        const scale = Math.max(1, reach / 2);
        if (Math.abs(scale - (this.scale || 1)) < 0.01) return;
        this.scale = scale;
        this.key.position.set(x + 3.2 * scale, -3.0 * scale, 3 + 1.6 * scale);
        this.key.target.position.set(x, 0, 0.7);
        this.key.intensity = 50 * scale;
        this.curtain.scale.set(scale ** 0.6, scale ** 0.6, scale ** 0.3);
        this.key.angle = Math.min(0.75, 0.5 + 0.05 * scale);
        this.key.shadow.camera.far = 12 * scale;
        this.set.slice(1).forEach(l => (l.angle = Math.min(1.2, 0.55 * scale)));
    }

    // what stands as far as `distance` (m) is clear, what is behind it fades
    haze(distance) {
        const near = Math.max(4.5 * (this.scale || 1), distance + 1.5);
        ((this.scene.fog.near = near), (this.scene.fog.far = (10.5 / 4.5) * near));
    }

    floor() {
        const wood = new THREE.MeshStandardMaterial({
            color: rgb("#b9a08c"),
            map: planks(this.plain ? 1 : 8),
            roughness: 0.55,
            envMap: this.plain ? null : this.environment, // it fills the picture
            envMapIntensity: 0.25,
        });
        const floor = new THREE.Mesh(new THREE.PlaneBufferGeometry(48, 48), wood);
        floor.receiveShadow = true;
        this.scene.add(floor);
    }

    resize(view) {
        const w = window.innerWidth,
            h = window.innerHeight;
        this.renderer.setPixelRatio(this.quality);
        this.renderer.setSize(w, h, false);
        view.resize();
    }

    get software() {
        return this.flat || inSoftware(this.renderer.getContext());
    }

    // if the frame rate stays low, lowers the quality by one step; `frame` is the last frame's time
    // (ms)
    adapt(frame, view) {
        this.late = frame > LATE_FRAME ? (this.late || 0) + Math.min(LATEST, Math.floor(frame / LATE_FRAME)) : Math.max(0, (this.late || 0) - 2);
        if (this.late < LATE_FRAMES || this.step === 4) return;
        this.late = 0;
        this.simplify((this.step || 0) + 1);
        this.resize(view);
    }

    // step 0: full quality; 1: no more pixels than the screen's; 2: smaller shadow map; 3: one
    // light, no shadows; 4: half the resolution
    simplify(step) {
        this.step = step;
        this.quality = Math.min(this.quality, step >= 4 ? 0.5 : 1);
        if (step >= 2 && this.key.shadow.map) {
            this.key.shadow.map.dispose();
            this.key.shadow.map = null;
            this.key.shadow.mapSize.set(1024, 1024);
            this.key.shadow.bias = -0.001; // coarser points, deeper into the surface
        }
        if (step < 3) return;
        this.key.castShadow = false;
        for (const light of this.set.slice(1)) light.visible = false;
    }
}
