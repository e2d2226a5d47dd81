// Everything written over the stage: buttons, numbers, the running score of what is played live, and
// the timeline of a playback.
import { SPEEDS } from "./playback.js";
import { Timeline, nuanceColor } from "./timeline.js";
import { before } from "./scene.js";

const $ = id => document.getElementById(id);
const short = value => (typeof value === "number" ? +value.toPrecision(4) : value);
const strikes = count => (count === 1 ? "1 strike" : `${count} strikes`);
const STATUS_SHOWN = ["load", "sound", "physics", "task", "strokes", "played", "recoveries"];
const STATUS_KEPT = 16; // as many performers as himc-viewer keeps
const SPAN = 8000; // of the running score (ms); chosen: two bars at 60 beats a minute
const NOTE_TIME = 9000; // a message stays (ms); chosen: long enough to read two lines
const LOUDEST = 0.004, // full deflection of the level, largest displacement (m); chosen
    STRONGEST = 150; // tallest note of the running score (N); chosen: a forte stroke
const TURN = 0.08; // of the view by an arrow key (rad); chosen

// what a key does: its name on the page, the words there, the action; "" is a shift
const KEYS = [
    ["1 – 7", "cameras", null],
    ["f", "show everything", a => a.frameAll()],
    ["t", "targets", a => a.show("targets")],
    ["c", "others over, beside, not", a => a.compare()],
    ["p", "save a picture", a => a.picture()],
    ["r", "record a film", a => a.film()],
    ["h", "hide all writing", () => document.body.classList.toggle("bare")],
    ["d", "numbers for diagnosis", () => document.body.classList.toggle("diagnosis")],
    ["space", "play, pause", a => a.pause()],
    ["← →", "a frame back, on (live: turn the view)", null],
    ["shift ← →", "a stroke back, on", null],
    ["- +", "slower, faster", null],
    ["[ ]", "the loop begins, ends here", null],
    ["\\", "no loop", a => a.unloop()],
    ["home end", "the beginning, the end", null],
    ["l", "more lanes: angles, torques, spectrum, seat and feet", a => a.lanes()],
    ["alt and drag", "push the body, in an edit", null],
    ["enter", "choose the stroke at the cursor, to edit it", null],
    [", .", "the chosen stroke an eighth of a beat earlier, later (< > a third of that)", null],
    ["ctrl z, ctrl y", "undo, redo a change", null],
    ["m", "sound on, off", a => a.mute()],
    ["?", "these keys", null],
];
const cameras = ["stage", "front", "side", "top", "eye", "hands", "head"];
const more = {
    " ": a => a.pause(),
    "-": a => a.speed(-1),
    "+": a => a.speed(1),
    "=": a => a.speed(1),
    "[": a => a.loopEnd(false),
    "]": a => a.loopEnd(true),
    Home: a => a.seek(0),
    End: a => a.seek(Infinity),
};
const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class Panel {
    constructor(actions) {
        ((this.actions = actions), (this.strikes = []), (this.beats = []));
        ((this.status = new Map()), (this.bridge = {}), (this.playback = null));
        ((this.beat = null), (this.level = 0), (this.peak = 0), (this.count = 0));
        ((this.strip = $("strip")), (this.ink = this.strip.getContext("2d")));
        this.timeline = new Timeline($("timeline"), actions);
        this.buttons();
        addEventListener("keydown", e => this.key(e));
        for (const [key, does] of KEYS) {
            const row = $("keys").appendChild(document.createElement("div"));
            row.appendChild(document.createElement("kbd")).textContent = key;
            row.appendChild(document.createElement("span")).textContent = does;
        }
    }

    buttons() {
        const actions = this.actions,
            click = (id, f) => ($(id).onclick = f);
        for (const button of document.querySelectorAll("[data-camera]"))
            button.onclick = () => actions.camera(button.dataset.camera);
        for (const box of document.querySelectorAll("[data-show]"))
            box.onclick = () => actions.show(box.dataset.show);
        for (const b of document.querySelectorAll("[data-compare]"))
            b.onclick = () => actions.compare(b.dataset.compare);
        $("exaggeration").oninput = e =>
            actions.exaggerate(Math.round(10 ** Number(e.target.value)));
        for (const speed of SPEEDS) $("speed").add(new Option(`× ${speed}`, speed));
        $("speed").onchange = e => actions.setSpeed(Number(e.target.value));
        for (const id of ["picture", "film", "pause", "mute", "unloop", "live", "lanes"]) click(id, actions[id]);
        click("make-webm", () => actions.export("webm"));
        click("make-glb", () => actions.export("glb"));
        click("back", () => actions.step(-1, true));
        click("on", () => actions.step(1, true));
        click("from", () => actions.loopEnd(false));
        click("to", () => actions.loopEnd(true));
        click("help", () => this.help());
        click("copy", () => navigator.clipboard?.writeText($("subscribe").textContent));
        click("more", () =>
            $("more").setAttribute("aria-expanded", document.body.classList.toggle("open")),
        );
    }

    help() {
        $("help").setAttribute("aria-pressed", document.body.classList.toggle("help"));
    }

    key(e) {
        const { actions } = this,
            camera = cameras[Number(e.key) - 1];
        if (e.ctrlKey || e.metaKey || e.altKey || e.target.tagName === "SELECT") return;
        if (e.key === " " && e.target.tagName === "BUTTON") return;
        if (e.target.tagName === "INPUT") return;
        const known = KEYS.find(([key, , act]) => act && key === e.key)?.[2] ?? more[e.key];
        if (camera) actions.camera(camera);
        else if (known) known(actions);
        else if (e.key === "?") this.help();
        else if (e.key === "Escape") document.body.classList.remove("help", "open");
        else if (arrows[e.key]) this.arrow(...arrows[e.key], e);
        else return;
        e.preventDefault();
    }

    arrow(x, y, e) {
        if (x && this.playback && e.target.id !== "stage") this.actions.step(x, e.shiftKey);
        else this.actions.orbit(TURN * x, TURN * y);
    }

    // the program that serves the page: where it listens
    session({ host, osc }) {
        $("subscribe").textContent = ["pose", "strikes", "head", "sound"]
            .map(what => `subscribe ${host} ${osc} ${what}`)
            .join(", ");
    }

    connected(yes) {
        document.body.classList.toggle("lost", !yes);
        $("lost").textContent = yes
            ? ""
            : "Connection lost: what you see is old. Is himc-viewer still running? Trying again …";
        if (!yes) this.bridge = {};
    }

    // "" takes it away; it stays if it says why the page can do no more
    note(text, stays = false) {
        $("note").textContent = text;
        $("note").classList.toggle("on", !!text);
        clearTimeout(this.noteTimer);
        if (!stays) this.noteTimer = setTimeout(() => $("note").classList.remove("on"), NOTE_TIME);
    }

    loading(text) {
        document.body.classList.toggle("loading", !!text);
        $("load").textContent = text ?? "";
    }

    open(playback) {
        this.playback = playback;
        document.body.classList.toggle("playing", !!playback);
        if (playback) (this.timeline.open(playback), this.transport(playback));
    }

    tall(yes) {
        document.body.classList.toggle("tall", yes);
        $("lanes").setAttribute("aria-pressed", yes);
    }

    // how a playback is compared with others, "" not
    compared(how) {
        document.body.classList.toggle("compared", !!this.playback?.scene.ghosts.length);
        for (const b of document.querySelectorAll("[data-compare]"))
            b.setAttribute("aria-pressed", b.dataset.compare === how);
    }

    camera(name) {
        for (const b of document.querySelectorAll("[data-camera]"))
            b.setAttribute("aria-pressed", b.dataset.camera === name);
    }

    shown(shown) {
        for (const b of document.querySelectorAll("[data-show]"))
            b.setAttribute("aria-pressed", !!shown[b.dataset.show]);
        document.body.classList.toggle("off-target", shown.errors && shown.trails);
    }

    exaggeration(times) {
        $("exaggeration").value = Math.log10(times);
        $("times").textContent = `×${times}`;
    }

    // how far a film is (0 .. 1); null when none is made
    exporting(done) {
        const working = done !== null;
        $("make-webm").setAttribute("aria-pressed", working);
        $("make-webm").textContent = working ? `stop (${Math.round(100 * done)} %)` : "make film";
    }

    filming(yes) {
        $("film").setAttribute("aria-pressed", yes);
    }

    strike(strike) {
        this.strikes.push(strike);
        this.count++;
        if (this.strikes.length > 600) this.strikes.splice(0, 200);
        this.peak = strike.force;
    }

    // another piece begins
    forget() {
        ((this.strikes = []), (this.beats = []), (this.beat = null), (this.count = 0), (this.peak = 0));
    }

    hearBeat(beat, now) {
        this.beat = beat;
        this.beats.push({ beat, now });
        if (this.beats.length > 64) this.beats.shift();
    }

    hearStatus(from, values) {
        const all = [];
        for (let i = 0; i + 1 < values.length; i += 2)
            all.push([values[i], `${values[i]} ${short(values[i + 1])}`]);
        const chosen = all.filter(([name]) => STATUS_SHOWN.includes(name));
        this.status.delete(from); // so that the newest is the last
        if (this.status.size >= STATUS_KEPT) this.status.delete(this.status.keys().next().value);
        this.status.set(from, (chosen.length ? chosen : all).map(pair => pair[1]).join("   "));
    }

    hearBridge(event, now) {
        const old = this.bridge;
        this.bridge = { ...event, now };
        if (old.now < now)
            this.bridge.rate = Math.round((1000 * (event.packets - old.packets)) / (now - old.now));
    }

    // --- the numbers; called a few times a second

    write(performers, numbers, now, playback) {
        const here = performers.filter(p => p.present(now));
        document.body.classList.toggle("empty", !here.length);
        this.list(here);
        this.diagnosis(numbers);
        if (playback) this.transport(playback);
        else this.live();
    }

    list(here) {
        const names = here.map(p => `${p.title} ${p.color} ${p.key} ${p.clock.rate.toFixed(0)}`).join("\n");
        if (names === this.listed) return;
        this.listed = names;
        $("who").replaceChildren(
            ...here.map((p, i) => {
                const row = document.createElement("div"),
                    dot = row.appendChild(document.createElement("i"));
                dot.style.background = p.color;
                const name = this.playback ? p.title : `performer ${i + 1}`;
                row.append(name);
                const from = row.appendChild(document.createElement("span"));
                from.textContent = this.playback ? "" : ` ${p.key} ${p.clock.rate.toFixed(0)} Hz`;
                return row;
            }),
        );
    }

    live() {
        $("beat").textContent = this.beat === null ? "" : `beat ${this.beat}`;
        $("force").textContent = this.count ? `${this.peak.toFixed(0)} N` : "";
        $("said").textContent = strikes(this.count);
    }

    diagnosis(numbers) {
        const b = this.bridge;
        $("rates").textContent = [
            `${numbers.fps.toFixed(0)} frames/s`,
            `${numbers.script.toFixed(1)} ms script`,
            ...(numbers.latency === null ? [] : [`${numbers.latency.toFixed(0)} ms late`]),
        ].join(" · ");
        $("bridge").textContent =
            b.packets === undefined
                ? ""
                : [
                      `himc-viewer ${(100 * b.load).toFixed(1)} % load`,
                      `${b.rate === undefined ? "–" : b.rate} packets/s`,
                      `${b.malformed} malformed`,
                      `${b.unknown} unknown`,
                  ].join(" · ");
        $("status").textContent = [...this.status.values()].slice(-2).join("\n");
    }

    // whether there is a sound that needs a click to be heard
    silent(waits, sound) {
        $("mute").setAttribute("aria-pressed", sound.volume > 0);
        document.body.classList.toggle("silent", waits);
    }

    transport(p) {
        const { scene } = p,
            time = p.at / 1000,
            beat = scene.beat(time),
            last = scene.strikes[before(scene.strikes, time, s => s.time)];
        $("beat").textContent = beat === null ? "" : `beat ${Math.floor(beat + 1e-6)}`;
        $("force").textContent = last && time - last.time < 2 ? `${last.force.toFixed(0)} N` : "";
        $("said").textContent = strikes(scene.strikes.length);
        $("pause").textContent = p.playing ? "❚❚" : "▶";
        $("pause").setAttribute("aria-label", p.playing ? "pause" : "play");
        $("clock").textContent = `${time.toFixed(2)} / ${scene.end.toFixed(1)} s`;
        if (Number($("speed").value) !== p.speed) $("speed").value = p.speed;
        $("unloop").disabled = !p.loop;
        const slider = $("timeline");
        slider.setAttribute("aria-valuemax", scene.end.toFixed(2));
        slider.setAttribute("aria-valuenow", time.toFixed(2));
        const mark = this.actions.when?.mark;
        slider.setAttribute("aria-valuetext", `${time.toFixed(1)} seconds${mark ? `, chosen: ${mark.name}` : ""}`);
    }

    // --- a frame: the level (largest displacement of all heads, m; three decades), and the timeline
    // or the running score

    draw(excursion, now, playback) {
        this.level = Math.max(excursion, this.level * 0.93);
        const decades = 1 + Math.log10(Math.max(1e-9, this.level / LOUDEST)) / 3;
        $("level").style.transform = `scaleX(${Math.min(1, Math.max(0, decades))})`;
        if (playback) this.timeline.draw();
        else this.running(now);
    }

    running(now) {
        const c = this.ink,
            ratio = Math.min(devicePixelRatio || 1, 2),
            w = this.strip.clientWidth,
            h = this.strip.clientHeight;
        if (this.strip.width !== Math.round(w * ratio))
            ((this.strip.width = Math.round(w * ratio)),
                (this.strip.height = Math.round(h * ratio)));
        c.setTransform(ratio, 0, 0, ratio, 0, 0);
        c.clearRect(0, 0, w, h);
        const x = t => w - 14 - ((now - t) / SPAN) * (w - 14),
            mid = h / 2;
        c.fillStyle = "rgba(255,255,255,0.10)";
        c.fillRect(0, mid - 0.5, w, 1);
        c.font = "11px system-ui, sans-serif";
        for (const b of this.beats) {
            if (now - b.now > SPAN) continue;
            c.fillStyle = "rgba(255,255,255,0.13)";
            c.fillRect(x(b.now), 2, 1, h - 4);
            c.fillStyle = "rgba(255,255,255,0.6)";
            c.fillText(b.beat, x(b.now) + 3, h - 4);
        }
        for (const s of this.strikes) {
            if (now - s.now > SPAN) continue;
            const tall = 3 + (mid - 6) * Math.min(1, Math.sqrt(s.force / STRONGEST)),
                up = s.hand === "left";
            c.fillStyle = nuanceColor[s.nuance] || "#d8d8e0";
            c.globalAlpha = 1 - 0.65 * ((now - s.now) / SPAN);
            c.fillRect(x(s.now) - 1.5, up ? mid - tall : mid, 3, tall);
            c.beginPath();
            c.arc(x(s.now), up ? mid - tall : mid + tall, 3.2, 0, 7);
            c.fill();
        }
        c.globalAlpha = 1;
        c.fillStyle = "rgba(255,255,255,0.8)";
        c.fillRect(w - 14, 2, 1, h - 4);
        c.fillStyle = "rgba(255,255,255,0.7)";
        (c.fillText("L", 4, mid - 5), c.fillText("R", 4, mid + 13));
    }
}
