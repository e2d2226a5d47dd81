// The viewer's page: shows what himc-viewer streams, or plays a scene, and draws a frame whenever
// the browser asks for one.
import * as THREE from "./three.js";
import { Stage, discard } from "./stage.js";
import { ALONE, SEATED, View } from "./camera.js";
import { Stream } from "./stream.js";
import { Performer } from "./performer.js";
import { Drum } from "./drum.js";
import { MARK_TIME, Marks } from "./strike.js";
import { Playback, SPEEDS } from "./playback.js";
import { DRUMS, before, readScene } from "./scene.js";
import { LiveSound, Sound } from "./sound.js";
import { Panel } from "./panel.js";
import { Recorder } from "./record.js";
import { Editor } from "./edit.js";
import { Exporter } from "./export.js";
import { Studio } from "./studio.js";
import { HANDS, bone } from "./body.js";
import { sharedModel } from "./figure.js";
import { segments } from "./skeleton.js";

const canvas = document.getElementById("stage"),
    stage = new Stage(canvas, !!window.himcFiles),
    view = new View(canvas);
const performers = new Map(),
    drums = new Map(),
    marks = new Marks(),
    sound = new Sound(),
    liveSound = new LiveSound(sound),
    recorder = new Recorder(canvas, sound);
const PERFORMERS = 16, // as many as himc-viewer keeps
    LIFT = 0.08, // of the picture over the timeline, of the window's height
    TALL = 0.17, // with all lanes
    HEADER = 60, // over the picture on a phone (pixels)
    SLOW = 0.02, // speed for a look at a head; the slowest
    SECOND = 1000; // over which frames are counted (ms)
const shown = { targets: false, trails: true, errors: false, forces: false, marks: false, drums: true };
const GHOSTS = { captured: "#f4efe2", ik: "#ff9a5c", id: "#5cb8ff", himc: "#7ddc9a" }; // chosen
const numbers = { fps: 0, script: 0, latency: null, render: 0 };
const clock = () => performance.timeOrigin + performance.now(); // himc-viewer's clock too (ms)
const latencies = [],
    scripts = [],
    frames = []; // when they were drawn (ms)
let exaggeration = 8, // of a head's motion; chosen: seen from the stage, and no wilder than a film's
    playback = null,
    readings = 0, // of scenes, begun
    stream = null,
    editor = null, // on a page that knows the key
    studio = null, // in a page with a performer inside
    waiting = [];

const actions = {
    camera(name) {
        if (!view.preset(name)) return;
        panel.camera(name);
        // the head is seen to move when it moves slowly
        if (name === "head" && playback && playback.speed > SLOW) playback.setSpeed(SLOW);
    },
    select: joint => panel.timeline.select(joint),
    lanes() {
        if (!playback) return;
        panel.tall(panel.timeline.more());
        setLift(lifted());
    },
    frameAll: () => actions.camera(view.name && view.name !== "eye" ? view.name : "stage"),
    orbit: (x, y) => view.orbit(x, y),
    show: (what, yes) => (
        Object.hasOwn(shown, what) && (shown[what] = yes ?? !shown[what]), panel.shown(shown)
    ),
    exaggerate: times => (
        (exaggeration = Math.min(1000, Math.max(1, times || 1))),
        panel.exaggeration(exaggeration)
    ),
    picture: () => recorder.picture(),
    film: () => attempt(() => recorder.toggleFilm()),
    export(kind) {
        if (!playback) return;
        if (exporter.running) return void (exporter.stopped = true);
        const [from, to] = playback.span,
            tell = done => panel.exporting(done < 1 ? done : null);
        exporter
            .save(kind, { from, to, speed: playback.speed }, tell)
            .catch(error => panel.note(error.message))
            .finally(() => panel.exporting(null));
    },
    pause: () => playback && playback.play(!playback.playing),
    seek: ms => playback && playback.seek(ms),
    pick: strike => editor?.pick(strike),
    pickAt: time => editor?.pickAt(time),
    get marks() {
        return this.when ? editor.marks : [];
    },
    get when() {
        return editor?.piece.scene === playback?.scene ? editor?.when : null;
    },
    step: (by, strikes) => playback && playback.step(by, strikes),
    loop: (a, b) => playback && playback.setLoop(a, b),
    loopEnd: end => {
        if (!playback) return;
        const [from, to] = playback.span;
        if (end) playback.setLoop(from, playback.at);
        else playback.setLoop(playback.at, to > playback.at ? to : playback.length);
    },
    unloop: () => playback && playback.setLoop(0, 0),
    speed: by => {
        if (!playback) return;
        const i = SPEEDS.findIndex(s => s >= playback.speed);
        playback.setSpeed(SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, i + by))]);
    },
    setSpeed: speed => playback && playback.setSpeed(speed),
    compare(how) {
        if (!playback || !playback.scene.ghosts.length) return;
        const next = { overlay: "side", side: "", "": "overlay" }[playback.compare];
        playback.compare = how ?? next;
        document.body.classList.toggle("beside", playback.compare === "side");
        setLift(lifted());
        if (playback.compare === "side") actions.camera("front");
        playback.jumped = true;
        forget();
        panel.compared(playback.compare);
    },
    mute: () => (sound.setVolume(sound.volume ? 0 : 1), sound.wake() && playback?.resound()),
    live() {
        if (!playback || !(stream || studio)) return;
        const left = studio?.edits && editor.leave().then(score => studio.edited(score));
        playback = null;
        close();
        setLift(0);
        panel.open(null);
        return left;
    },
};
const panel = new Panel(actions);
const FLAT = "no WebGL in this browser: the picture is a plain drawing, all else is as ever";
if (stage.flat) (Object.assign(stage.renderer, { performers, drums }), panel.note(FLAT));

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

// marks a strike; `time` is that of the marks: the playback's, or now
function strike(event, time) {
    const d = drum(event.from, event.drum);
    if (!d) return;
    d.striker = event.from;
    if (!playback) performers.get(event.from)?.lookAt(d.spot(event));
    d.mark = time;
    marks.add(d.tilted, event, time);
}

// does `act` when the picture of that sender has come to `time` (ms)
function inStep(key, time, act) {
    const now = () => virtual || clock(),
        p = performers.get(key);
    if (p) p.clock.wait(time, () => act(now()));
    else act(now());
}

const live = {
    pose(key, time, ...pose) {
        if (!playback) performer(key)?.receive(time, virtual || clock(), ...pose);
    },
    drum(key, name, time, place, amplitude) {
        if (!playback) inStep(key, time, now => drum(key, name)?.receive(now, place, amplitude));
    },
    sound(key, ...packet) {
        if (!playback) liveSound.receive(key, ...packet, virtual || clock(), performers.get(key)?.clock.delay ?? 0);
    },
    event(event, time) {
        const now = virtual || clock();
        if (event.event === "bridge") panel.hearBridge(event, now);
        else if (event.event === "view") control(event.what, event.values);
        else if (playback) return;
        else if (event.event === "strike") {
            inStep(event.from, event.told, then => {
                strike(event, then);
                const d = drum(event.from, event.drum);
                if (d) d.struck = then;
            });
            Object.assign(event, { now, sent: time });
            panel.strike(event);
            waiting.push(event);
        } else if (event.event === "beat") panel.hearBeat(event.beat, now);
        else if (event.event === "status") panel.hearStatus(event.from, event.values);
    },
    connected: yes => (panel.connected(yes), editor?.connected(yes)),
};

// what a playback shows: `now` keeps its performer and its drums present
const played = {
    now: 0,
    pose(scene, time, pose, target, support) {
        const one = performer(scene.name),
            name = scene.head.name,
            next = scene.strikes[before(scene.strikes, time, s => s.time) + 1],
            ghost = scene !== playback.scene;
        one?.show(this.now, pose, target, support, scene.sits ? scene.body(time).origin : null);
        const struck = next && [scene, playback.scene].map(s => drums.get(`${s.name} ${next.drum}`)).find(d => d);
        one?.lookAt(struck?.spot(next));
        one?.ghost(ghost && playback.compare === "overlay" ? (GHOSTS[name] ?? "#e7b6ff") : null);
        if (one) one.title = playback.compare ? (name ?? scene.name) : scene.name;
    },
    drum(scene, name, place, amplitude) {
        drum(scene.name, name)?.show(this.now, place, amplitude);
    },
    strike: (event, time) => strike(event, time),
    jump() {
        marks.clear();
        for (const p of performers.values()) p.trails.forEach(trail => trail.clear());
    },
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
            .filter(p => p.present(now) && !p.ghostly)
            .sort((a, b) => a.index - b.index),
        n = here.length;
    const drumsReach = [...drums.values()]
        .filter(d => d.group.visible)
        .reduce((most, d) => Math.max(most, Math.abs(d.place[1]) + d.place[4]), 0);
    const step = n > 1 ? Math.min(0.75, 2.6 / (n - 1)) : 0,
        radius = Math.max(2.6, n * 0.62, step && (2 * drumsReach) / step); // no drum reaches its neighbour's
    here.forEach((p, i) => {
        const angle = n > 1 ? (i - (n - 1) / 2) * step : 0;
        p.group.rotation.z = -angle;
        p.group.position.set(radius - radius * Math.cos(angle), radius * Math.sin(angle), 0);
    });
    for (const p of performers.values())
        if (p.ghostly && here.length)
            (p.group.position.copy(here[0].group.position), (p.group.rotation.z = here[0].group.rotation.z));
    const last = Math.min(Math.PI / 2, ((n - 1) / 2) * step),
        wide = n > 1 ? radius * Math.sin(last) : 0,
        spread = wide + Math.round(20 * Math.max(0, drumsReach - ALONE)) / 20,
        high = here.reduce((most, p) => Math.max(most, p.height()), SEATED),
        tall = Math.round(5 * (high - SEATED)) / 5; // so that a nod moves no camera
    stage.cover(0.35 * spread, spread + 1);
    if (spread !== view.spread || tall !== view.tall) {
        ((view.spread = spread), (view.tall = tall), (view.deep = n > 1 ? radius * (1 - Math.cos(last)) : 0));
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
        if (owner) d.turn(owner);
        d.update(now, exaggeration);
        excursion = Math.max(excursion, d.excursion);
    }
    return excursion;
}

// frames of the last second
function countFrames(now) {
    frames.push(now);
    while (frames[0] < now - SECOND) frames.shift();
    numbers.fps = frames.length > 1 ? (1000 * (frames.length - 1)) / (now - frames[0]) : 0;
}

let previous = clock(),
    written = 0,
    virtual = 0,
    held = false; // nothing is drawn while the sound is being opened, which needs this thread, too
function frame(_, now = clock(), draw = true) {
    const dt = Math.max(0, now - previous), // after held frames the clock may be behind theirs
        begin = performance.now();
    previous = now;
    if (playback) {
        if (virtual) playback.tick(dt);
        else playback.advance(dt);
        played.now = now;
        playback.show(played, MARK_TIME);
    }
    const time = playback ? playback.at : now, // of marks and trails
        first = arrange(now);
    for (const p of performers.values()) p.update(now, time, view.camera, shown, view.near(), liveSound.moment(p.key));
    const excursion = updateDrums(now);
    marks.update(time, shown, view.near());
    view.update(Math.min(200, dt), first);
    editor?.update();
    stage.haze(view.now.distance);
    const drawn = performance.now();
    if (draw && !held) stage.renderer.render(stage.scene, view.camera);
    recorder.drawn();
    const end = performance.now();
    for (const event of waiting.splice(0)) {
        event.drawn = clock();
        latencies.push(event.drawn - event.sent);
    }
    if (latencies.length > 200) latencies.splice(0, 100);
    countFrames(now);
    numbers.render += 0.05 * (end - drawn - numbers.render);
    numbers.latency = latencies.length
        ? [...latencies].sort((a, b) => a - b)[latencies.length >> 1]
        : null;
    panel.draw(excursion, now, playback);
    if (now - written > 250) {
        written = now;
        panel.write([...performers.values()], numbers, now, playback);
        const any = playback ? !!playback.sound.buffer : studio ? sound.context?.state !== "running" : now - liveSound.heard < 1000;
        panel.silent(any && !(playback?.sound ?? sound).ready, sound);
        studio?.drums(shownDrums());
        panel.filming(recorder.filming);
    }
    if (!virtual && !held) stage.adapt(dt, view);
    const script = drawn - begin + performance.now() - end; // all but the drawing
    numbers.script += 0.05 * (script - numbers.script);
    scripts.push(script);
    if (scripts.length > 200) scripts.splice(0, 100);
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
    virtual = (virtual || previous) + ms;
    frame(0, virtual, draw);
}

// --- a scene

const phone = matchMedia("(max-width: 760px), (max-height: 480px)"),
    lying = matchMedia("(max-height: 480px)"), // then the inspector is beside the figure
    inspector = document.getElementById("edit"),
    footer = document.querySelector("footer");

// on a phone the picture is in the middle of what the writing leaves
function lifted() {
    if (!playback) return studio && phone.matches && !lying.matches ? (footer.offsetHeight - HEADER) / 2 / innerHeight : 0;
    if (playback.compare === "side" && !phone.matches) return 0; // the buttons are above them
    if (phone.matches) return Math.max(0, (footer.offsetHeight - HEADER) / 2 / innerHeight);
    return panel.timeline.all ? TALL : LIFT;
}

const aside = () => (lying.matches ? (studio && !playback ? document.getElementById("perform") : inspector).getBoundingClientRect().right / 2 / innerWidth : 0);

const resized = new ResizeObserver(() => {
    document.body.style.setProperty("--footer", `${footer.offsetHeight}px`);
    const moves = Math.abs(lifted() - view.lift) > 0.002 || Math.abs(aside() - view.aside) > 0.002;
    if (phone.matches && moves) setLift(lifted());
});
for (const part of [footer, inspector]) resized.observe(part);

for (const kind of [phone, lying]) kind.onchange = () => setLift(lifted());

function setLift(lift) {
    ((view.lift = lift), (view.whole = phone.matches && !lying.matches));
    view.aside = aside();
    dispatchEvent(new Event("resize"));
}

// forgets the performer and the drums of the playback, or of the stream
function close() {
    sound.stop();
    playback?.sound.stop();
    liveSound.close();
    forget();
}

function forget() {
    marks.clear();
    for (const table of [performers, drums]) {
        for (const one of table.values()) discard(one.group);
        table.clear();
    }
}

// `others` are scenes of the same piece, to compare
async function play(bytes, name, others = []) {
    const turn = ++readings,
        progress = (what, part) => turn === readings && panel.loading(`${what} ${name} … ${Math.round(100 * part)} %`),
        scene = await readScene(bytes, name, progress);
    if (turn !== readings) return; // another one was dropped meanwhile
    scene.ghosts.push(...others);
    close();
    playback = new Playback(scene, sound);
    panel.open(playback);
    panel.compared(playback.compare);
    actions.show("errors", !!playback.compare);
    panel.loading(null);
    setLift(lifted());
    const buffer = await sound
        .load(scene.sounds, scene.head.sound)
        .catch(error => panel.note(`${name}: its sound cannot be played (${error.message})`));
    panel.timeline.heard(buffer);
    if (playback?.scene === scene) playback.resound();
    window.viewer.ready = true; // all is there, the sound too
}

// `failed` is for himc film
const tell = name => error => (panel.loading(null), panel.note((window.viewer.failed = error.message || name)));

// one file, or several of one piece, the first with its sound
async function drop(files) {
    const [first, ...more] = files,
        capture = files.find(file => /\.(bvh|c3d|trc|txt|mid)$/i.test(file.name)),
        bytes = async file => new Uint8Array(await file.arrayBuffer());
    if (studio && !/\.himc$/i.test(first.name)) {
        if (playback) await actions.live();
        return files.forEach(file => studio.open(file));
    }
    if (capture && !editor)
        throw new Error(
            `${capture.name}: open the page by the address that himc-viewer prints, or make a scene of it with "himc render ${capture.name} -o sound.wav --scene scene.himc", and drop scene.himc`,
        );
    if (capture) return editor.piece.send(capture);
    const others = [];
    for (const file of more) others.push(await readScene(await bytes(file), file.name));
    for (const scene of others) scene.head.name = scene.name.replace(/\.himc$/, "");
    await play(await bytes(first), first.name, others);
}

// the scene of --play, with progress; its bytes grow by what has come
async function fetchScene(name) {
    const answer = await fetch("/play.himc"),
        size = Number(answer.headers.get("content-length")),
        reader = answer.body.getReader(),
        bytes = new Uint8Array(size);
    for (let got = 0; ;) {
        panel.loading(`loading ${name} … ${Math.round((100 * got) / size)} %`);
        const { done, value } = await reader.read();
        if (done) break;
        bytes.set(value, got);
        got += value.length;
    }
    await play(bytes, name);
}

// a click on a limb chooses its joint for the lanes
view.chosen = e => {
    const p = [...performers.values()].find(q => q.group.visible && !q.ghostly),
        i = p ? view.nearest(p.points(), e) : -1;
    if (i < 0) return;
    // after the segments come the tips; the first segment has no joint
    const segment = i < segments.length ? i : bone(`${HANDS[i - segments.length]}-stick`);
    if (segments[segment].joint && segment) actions.select(segments[segment].joint);
};
addEventListener("resize", () => (stage.resize(view), view.name && view.preset(view.name)));
addEventListener("dragover", e => e.preventDefault());
addEventListener("drop", e => {
    e.preventDefault();
    const files = [...e.dataTransfer.files];
    if (files.length) drop(files).catch(tell(files[0].name));
});
for (const gesture of ["pointerdown", "keydown"])
    addEventListener(gesture, () => (sound.wake() && playback?.resound(), studio?.listen()), true);

// where an object is, also before it is drawn
function placeOf(object) {
    object.updateWorldMatrix(true, false);
    return object.getWorldPosition(new THREE.Vector3());
}

// the middle of the first performer's hands; the head that was struck last
view.follow = name => {
    const p = [...performers.values()].find(q => q.group.visible && !q.ghostly),
        all = [...drums.values()].filter(d => d.group.visible);
    if (name === "hands" && p) return p.hands();
    if (name !== "head" || !all.length) return null;
    const last = all.reduce((a, b) => (b.mark > a.mark ? b : a));
    return placeOf(last.head);
};
view.points = () => [
    ...[...performers.values()]
        .filter(p => p.group.visible)
        .flatMap(p => p.points()),
    ...[...drums.values()]
        .filter(d => d.group.visible)
        .map(d => placeOf(d.head)),
];
stage.resize(view);
panel.shown(shown);
actions.camera("stage");
actions.exaggerate(exaggeration);

// For tests and pictures: joints and tips read back from the scene (m). `held` stops the frames,
// because a software renderer is too slow to draw between them.
function joints(key) {
    const p = key ? performers.get(key) : [...performers.values()].find(q => q.group.visible);
    return p && p.group.visible ? p.points().map(position => position.toArray()) : null;
}
const exporter = new Exporter((window.viewer = {
    held: location.hash === "#held",
    step,
    resume: () => ((window.viewer.held = false), (virtual = 0), next()),
    joints,
    play,
    readScene,
    numbers,
    latencies,
    scripts,
    marks,
    performers,
    drums,
    get stream() {
        return stream;
    },
    get studio() {
        return studio;
    },
    panel,
    actions,
    view,
    stage,
    sound,
    liveSound,
    lift: setLift,
    recorder,
    get exporter() {
        return exporter;
    },
    get playback() {
        return playback;
    },
    get exaggeration() {
        return exaggeration;
    },
    get editor() {
        return editor;
    },
}));

// a piece that is played while it is computed
function open(piece) {
    close();
    playback = new Playback(piece.scene, piece.sound);
    panel.open(playback);
    panel.loading(null);
    setLift(lifted());
}

function edit(key) {
    editor = new Editor(key, sound, view, stage, {
        opened: open,
        playback: () => playback,
        performer: () => [...performers.values()].find(p => p.group.visible && !p.ghostly),
        note: (text, stays) => panel.note(text, stays),
        cut: time => editor.elsewhere || panel.timeline.cut(time),
        changed: () => editor.elsewhere || panel.timeline.grown(),
        finished: piece => editor.elsewhere || panel.timeline.heard(piece.sound.whole()),
        drum: name => [...drums.values()].find(d => d.name === name && d.group.visible)?.tilted,
    });
}

const shownDrums = () => [...drums.values()].filter(d => d.group.visible);

// a page of `himc share` brings its scene, that of `make page` a performer; any other asks the program that
// serves it
if (window.himcFiles) {
    if (stage.plain && !stage.flat) (stage.simplify(4), stage.resize(view)); // the performer needs the processor, too
    studio = new Studio(window.himcFiles, sound, liveSound, {
        frame: live,
        prepare: () => sharedModel(stage),
        fresh: () => (forget(), panel.forget()),
        drums: shownDrums,
        hold: yes => (held = yes),
        edit: connect => (editor ? editor.again(connect) : edit(connect)),
        plays: () => !!playback,
        wide: () => !phone.matches,
        ray: e => view.ray(e),
        scene: async file => play(new Uint8Array(await file.arrayBuffer()), file.name),
    });
    if (stage.plain) studio.tell(stage.flat ? FLAT : "no graphics card: drawn with fewer points, one light and no shadows");
} else if (window.himcScene) {
    document.body.classList.add("shared");
    play(window.himcScene.bytes, window.himcScene.name).catch(tell("scene"));
} else {
    const key = location.hash.slice(1);
    if (/^[0-9a-f]{32}$/.test(key)) edit(key);
    stream = new Stream(live);
    fetch("/session.json")
        .then(answer => answer.json())
        .then(session => {
            panel.session(session);
            if (session.play) return fetchScene(session.play);
        })
        .catch(tell("himc-viewer"));
}
next();
