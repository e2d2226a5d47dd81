// The viewer's page: receives the stream of himc-viewer, keeps performers and drums, and draws a
// frame whenever the browser asks for one.
import * as THREE from "./three.js";
import { Stage, discard } from "./stage.js";
import { View } from "./camera.js";
import { Stream } from "./stream.js";
import { Performer } from "./performer.js";
import { Drum } from "./drum.js";
import { Marks } from "./strike.js";
import { Motion } from "./motion.js";
import { Panel } from "./panel.js";
import { Recorder } from "./record.js";

const canvas = document.getElementById("stage"),
    stage = new Stage(canvas),
    view = new View(canvas);
const performers = new Map(),
    drums = new Map(),
    marks = new Marks(),
    recorder = new Recorder(canvas);
const PERFORMERS = 16, // as many as himc-viewer keeps
    DRUMS = 32;
const shown = { targets: true, trails: true, forces: true, marks: true, drums: true };
const numbers = { fps: 60, script: 0, latency: null, render: 0 };
const clock = () => performance.timeOrigin + performance.now(); // himc-viewer's clock too (ms)
const latencies = [],
    scripts = [];
let exaggeration = 25,
    motion = null,
    live = false,
    waiting = [];

const actions = {
    camera: name => view.preset(name) && panel.camera(name),
    show: (what, yes) => (Object.hasOwn(shown, what) && (shown[what] = yes), panel.shown(shown)),
    exaggerate: times => (
        (exaggeration = Math.min(1000, Math.max(1, times || 1))),
        panel.exaggeration(exaggeration)
    ),
    picture: () => recorder.picture(),
    film: () => attempt(() => recorder.toggleFilm()),
    pause: () => motion && (motion.playing = !motion.playing),
    seek: ms => motion && motion.seek(ms),
};
const panel = new Panel(actions);

function attempt(f) {
    try {
        return f();
    } catch (error) {
        panel.note(error.message);
    }
}

// What `table` has under that name, made if there is nothing. In a full table it replaces one that
// is absent; undefined if there is none.
function place(table, most, name, make) {
    if (!table.has(name) && table.size >= most) {
        const absent = [...table].find(([, old]) => !old.present(virtual || clock()));
        if (!absent) return undefined;
        discard(absent[1].group);
        table.delete(absent[0]);
    }
    if (!table.has(name)) table.set(name, make());
    return table.get(name);
}

function performer(key) {
    return place(performers, PERFORMERS, key, () => {
        const used = [...performers.values()].map(p => p.index);
        let index = 0;
        while (used.includes(index)) index++;
        return new Performer(key, index, stage);
    });
}

// a drum belongs to its sender; a strike may name it before the drum itself sends anything
function drum(key, name) {
    const id = `${key} ${name}`;
    if (!drums.has(id)) {
        const same = [...drums.values()].find(
            d => d.name === name && (!performers.has(d.key) || !performers.has(key)),
        );
        if (same) return same;
    }
    return place(drums, DRUMS, id, () => new Drum(key, name, stage));
}

function strike(event, now) {
    const d = drum(event.from, event.drum);
    if (d) {
        d.struck = now;
        d.striker = event.from;
        marks.add(d.tilted, event, now);
    }
    event.now = now;
    panel.strike(event);
    waiting.push(event);
}

const on = {
    pose(key, time, known, targets, body, target) {
        live = live || !motion;
        performer(key)?.receive(time, virtual || clock(), known, targets, body, target);
    },
    drum(key, name, time, place, amplitude) {
        drum(key, name)?.receive(virtual || clock(), place, amplitude);
    },
    event(event, time) {
        const now = virtual || clock();
        if (event.event === "strike") strike({ ...event, sent: time }, now);
        else if (event.event === "beat") panel.hearBeat(event.beat, now);
        else if (event.event === "status") panel.hearStatus(event.from, event.values);
        else if (event.event === "bridge") panel.hearBridge(event, now);
        else if (event.event === "view") control(event.what, event.values);
    },
    connected: yes => panel.connected(yes),
};

// /viewer/camera front, /viewer/show trails 0, /viewer/exaggeration 80
function control(what, [first, second]) {
    if (what === "camera") actions.camera(String(first));
    else if (what === "show") actions.show(String(first), !!second);
    else if (what === "exaggeration") actions.exaggerate(Number(first));
}

// one performer sits at the origin, several in an arc, all facing its centre (sizes chosen by eye)
function arrange(now) {
    const here = [...performers.values()]
            .filter(p => p.present(now))
            .sort((a, b) => a.index - b.index),
        n = here.length;
    const radius = Math.max(2.6, n * 0.62),
        step = n > 1 ? Math.min(0.75, 2.6 / (n - 1)) : 0;
    here.forEach((p, i) => {
        const angle = n > 1 ? (i - (n - 1) / 2) * step : 0;
        p.group.rotation.z = -angle;
        p.group.position.set(radius - radius * Math.cos(angle), radius * Math.sin(angle), 0);
    });
    const spread = n > 1 ? radius * Math.sin(Math.min(Math.PI / 2, ((n - 1) / 2) * step)) : 0;
    stage.cover(0.35 * spread, spread + 1);
    if (spread !== view.spread) {
        view.spread = spread;
        if (view.name) view.preset(view.name);
    }
    return here[0];
}

function updateDrums(now) {
    let excursion = 0;
    for (const d of drums.values()) {
        const owner =
            performers.get(d.key) || performers.get(d.striker) || performers.values().next().value;
        d.group.visible =
            shown.drums &&
            (d.present(now) || !!(owner && owner.present(now)));
        if (!d.group.visible) continue;
        if (owner)
            (d.group.position.copy(owner.group.position),
                (d.group.rotation.z = owner.group.rotation.z));
        d.update(now, exaggeration);
        excursion = Math.max(excursion, d.excursion);
    }
    return excursion;
}

let before = clock(),
    written = 0,
    virtual = 0;
function frame(_, now = clock(), draw = true) {
    const dt = Math.min(200, now - before),
        begin = performance.now();
    before = now;
    if (motion && !live) motion.update(now, dt, on);
    const first = arrange(now);
    for (const p of performers.values()) p.update(now, view.camera, shown);
    const excursion = updateDrums(now);
    marks.update(
        now,
        shown,
        view.name === "eye" ? 0.5 : Math.min(3, Math.max(0.4, view.now.distance / 2.9)),
    );
    view.update(dt, first);
    const drawn = performance.now();
    if (draw) stage.renderer.render(stage.scene, view.camera);
    recorder.drawn();
    const end = performance.now();
    for (const strike of waiting.splice(0)) {
        strike.drawn = clock();
        latencies.push(strike.drawn - strike.sent);
    }
    if (latencies.length > 200) latencies.splice(0, 100);
    numbers.fps += 0.05 * (1000 / Math.max(1, dt) - numbers.fps);
    numbers.script += 0.05 * (drawn - begin - numbers.script);
    scripts.push(drawn - begin);
    if (scripts.length > 200) scripts.splice(0, 100);
    numbers.render += 0.05 * (end - drawn - numbers.render);
    numbers.latency =
        latencies.length && !motion
            ? [...latencies].sort((a, b) => a - b)[latencies.length >> 1]
            : null;
    panel.draw(excursion, now);
    if (now - written > 250) {
        written = now;
        panel.write([...performers.values()], numbers, now);
        panel.filming(recorder.filming);
        panel.playing(live ? null : motion);
    }
    stage.adapt(dt, view.camera);
}

function next() {
    requestAnimationFrame(t => {
        if (window.viewer.held) return;
        next(); // first, so that a fault costs one frame only
        frame(t);
    });
}

// while frames are held: advances the playback by `ms` and draws if asked to; time is then the
// playback's, not the clock's
function step(ms, draw = true) {
    virtual = (virtual || before) + ms;
    frame(0, virtual, draw);
}

function play(text, name) {
    attempt(() => {
        motion = new Motion(text, name);
        live = false;
        drum(name, "kettle");
    });
}

addEventListener("resize", () => (stage.resize(view.camera), view.name && view.preset(view.name)));
addEventListener("dragover", e => e.preventDefault());
addEventListener("drop", e => {
    e.preventDefault();
    const file = e.dataTransfer.files[0];
    if (file) file.text().then(text => play(text, file.name));
});

stage.resize(view.camera);
panel.shown(shown);
actions.camera("stage");
actions.exaggerate(exaggeration);
const stream = new Stream(on);
fetch("/play.csv")
    .then(answer => (answer.ok ? answer.text().then(text => play(text, "playback")) : null))
    .catch(error => panel.note(`play.csv: ${error.message}`));
next();

// For tests and pictures: joints and tips read back from the scene (m). `held` stops the frames,
// because a software renderer is too slow to draw between them.
function joints(key) {
    const p = key ? performers.get(key) : [...performers.values()].find(q => q.group.visible);
    if (!p || !p.group.visible) return null;
    return [
        ...p.figure.bones.map(b => new THREE.Vector3().setFromMatrixPosition(b.matrixWorld)),
        ...p.figure.sticks.map(s => s.tip.getWorldPosition(new THREE.Vector3())),
    ].map(position => position.toArray());
}
window.viewer = {
    held: false,
    step,
    resume: () => ((window.viewer.held = false), (virtual = 0), next()),
    joints,
    numbers,
    latencies,
    scripts,
    marks,
    performers,
    drums,
    stream,
    panel,
    actions,
    view,
    stage,
    recorder,
    get motion() {
        return motion;
    },
};
