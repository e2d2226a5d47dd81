// Editing in space. A stroke is chosen on the timeline or by its dot on a head; its place on the
// head, its height (the dynamic) and what else is written of it are changed, and it is heard from
// shortly before. In a take a point of a stick's path is dragged. Sizes and colours: chosen by eye.
import * as THREE from "./three.js";
import { rgb } from "./color.js";
import { HANDS, bone, place, pushed } from "./body.js";
import { Piece } from "./piece.js";
import { Pushes } from "./push.js";
import { When } from "./when.js";
import { before } from "./scene.js";
import { segments } from "./skeleton.js";
import { MISSED, handColor } from "./timeline.js";

const $ = id => document.getElementById(id);
const GRAB = [16, 28], // a press this near takes a handle, by mouse, by finger (pixels)
    PATH = [0.7, 0.4], // of a stick's path, before and after (s)
    STEP = 0.008, // between its points (s)
    STROKES = 1.5, // dots of strokes so near in time (s)
    BEFORE = 0.7, // a stroke that is changed while it plays is heard from so much before (s)
    LEAD = 0.3, // once so much of that has come (s), for more comes faster than it is played
    SOON = 0.25, // and is looked at once so much after it has come (s)
    AT = 0.012, // a nudge so near is at the cursor (s): half a step of a key
    INSIDE = 0.95, // of a head's radius: nothing is struck further out
    RANGE = 0.45, // height that a drag from the softest to the loudest takes (m)
    DYNAMICS = ["ppp", "pp", "p", "mp", "mf", "f", "ff", "fff"], // of 0 .. 1, as the library
    BOUNCE = 0.25, // a bounce is no further from its ornament (beats)
    NEAR = 0.005, // of a dynamic, which then is that word: less than a key changes it
    AGAIN = 1000, // before the channel is opened again (ms)
    PUSHED = "#9cf29c", // the path of a segment that is pushed
    FAMILY = ["legato", "tenuto", "accent", "vertical-accent", "staccato"];
// the same of an editor inside the page
const STOPPED = "The editor has stopped. Your changes are kept: it brings them again.";
const round = (v, digits = 4) => +v.toFixed(digits);
const ENDED = {
    taken: "Another page edits this piece now. It has all that was changed here.",
    lost: "himc-viewer has ended, or cannot be reached. This page goes on playing what it has; your changes are kept with the piece.",
    refused: "himc-viewer has been started again: open the address that it prints. Your changes are kept with the piece.",
};
const reach = e => GRAB[e.pointerType === "touch" ? 1 : 0];

// 0 .. 1 .. 0 over a span, as the library's nudge
const bump = s => (s <= 0 ? 0 : s * s * s * (10 + s * (-15 + 6 * s)));

function dot(color, size) {
    const mesh = new THREE.Mesh(
        new THREE.SphereBufferGeometry(size, 20, 14),
        new THREE.MeshBasicMaterial({ color: rgb(color), transparent: true, opacity: 0.9, depthTest: false }),
    );
    mesh.renderOrder = 9;
    return mesh;
}

function line(color, opacity) {
    const made = new THREE.Line(
        new THREE.BufferGeometry(),
        new THREE.LineBasicMaterial({ color: rgb(color), transparent: true, opacity, depthTest: false }),
    );
    made.renderOrder = 8;
    made.frustumCulled = false;
    return made;
}

const draw = (made, points) => {
    made.geometry.dispose();
    made.geometry = new THREE.BufferGeometry().setFromPoints(points);
    made.visible = points.length > 1;
};

export class Editor {
    // `on`: opened(piece), playback(), performer(), note(line, stays), cut(time), changed(piece), finished(piece),
    // drum(name), its tilted group
    constructor(key, sound, view, stage, on) {
        Object.assign(this, { view, on, chosen: null, drag: null, waiting: null, heard: [] });
        // lines that are not answered yet, { line, statement as it will be, exact if all of it is known };
        // changes that wait for their answers; the field that is being typed in
        ((this.sent = []), (this.later = []), (this.typing = null));
        this.piece = new Piece(key, sound, {
            begun: piece => this.begun(piece),
            cut: (piece, time) => this.cut(piece, time),
            grown: piece => this.grown(piece),
            over: piece => this.over(piece),
            text: event => this.written(event),
            trouble: (text, line) => this.refused(text, line),
            restored: text => this.state(text),
            unkept: text => this.state(text),
            ended: why => this.ended(why),
            saved: (name, bytes) => save(name, bytes),
        });
        this.when = new When(this);
        this.group = new THREE.Group();
        ((this.spot = dot("#ffd21f", 0.02)), (this.top = dot("#ff8f5c", 0.02)));
        ((this.path = line("#ffffff", 0.95)), (this.ghost = line("#ffffff", 0.4)));
        this.offered = HANDS.map((_, h) => line(handColor[h], 0.6)); // paths of a take, to choose a point of
        this.dots = Array.from({ length: 24 }, () => dot("#ffffff", 0.008));
        this.group.add(this.path, this.ghost, ...this.offered, ...this.dots, this.spot, this.top);
        stage.scene.add(this.group);
        this.pushes = new Pushes(this, stage.scene);
        this.hide();
        const canvas = $("stage");
        canvas.addEventListener("pointerdown", e => this.press(e), { capture: true });
        canvas.addEventListener("pointermove", e => this.move(e), { capture: true });
        for (const name of ["pointerup", "pointercancel"])
            canvas.addEventListener(name, e => this.release(e), { capture: true });
        this.inspector();
        // a browser may keep a page that was left for a long time, and its channel with it
        addEventListener("pagehide", () => this.piece.socket.close());
        addEventListener("beforeunload", e => this.risky && e.preventDefault());
    }

    // --- the page and the program

    // true if changes would be lost with the page: not written anywhere, or on their way
    get risky() {
        const { text } = this.piece;
        return !!this.sent.length || (!!text?.undo && !text.kept);
    }

    // a line that stays until another takes its place; `ended` if nothing can be changed any more
    state(text, ended = "") {
        $("e-said").textContent = text;
        ($("e-state").hidden = !text), ($("e-here").hidden = ended !== "taken" && !(ended && this.inside));
        for (const part of $("edit").children) part.inert = !!ended && part.id !== "e-state";
        if (!this.on.playback() && ended) this.on.note(text, true);
    }

    ended(why) {
        if (why === "refused" && !this.reachable) why = "lost";
        ((this.waiting = null), (this.later = []), (this.ends = why));
        this.state(this.inside && why === "lost" ? STOPPED : ENDED[why], why);
        this.choose(null);
        if (why === "lost") setTimeout(() => this.reachable && this.again(), AGAIN);
    }

    // the performer is in this page
    get inside() {
        return typeof this.piece.key === "function";
    }

    // what is edited is shown no more; resolves to its text, null if that is not known
    async leave() {
        document.body.classList.remove("editing", "take", "chosen");
        (this.choose(null), this.state(""));
        return this.piece.socket.leave();
    }

    // whether a change can be made now; else the page says why not
    able() {
        if (this.elsewhere) {
            this.on.note("Another scene is shown: reload the page to edit the piece again.");
            return false;
        }
        if (!this.piece.live) this.on.note(ENDED[this.ends] ?? "himc-viewer is asked for the piece; nothing can be changed yet.");
        return this.piece.live;
    }

    // a scene was dropped, and is shown in the piece's place
    get elsewhere() {
        const p = this.on.playback();
        return !!p && !!this.piece.scene && p.scene !== this.piece.scene;
    }

    // the program can be reached, or not; its channel may not have noticed
    connected(yes) {
        this.reachable = yes;
        if (!yes) this.piece.leave();
        else if (this.ends === "lost") this.again();
    }

    // edits again, from where the page is; or another piece
    again(key = this.piece.key) {
        this.piece.key = key;
        if (this.piece.socket.readyState >= WebSocket.CLOSING) this.piece.open();
    }

    // the line changed nothing: the fields are as the text has it, and what played plays on
    refused(text, line) {
        const { waiting } = this;
        (this.answered(line), this.on.note(line?.startsWith("set ") ? `Not changed: ${text}` : text), this.agree());
        if (this.sent.length) return;
        this.waiting = null;
        if (waiting?.plays) this.on.playback()?.play(true);
    }

    // a line, and those before it
    answered(line) {
        this.sent.splice(0, this.sent.findIndex(s => s.line === line) + 1);
    }

    // the statements as they are once all that was sent has been taken
    get statements() {
        const all = new Map(this.piece.text.statements.map(s => [s.index, s]));
        for (const { statement } of this.sent) if (statement) all.set(statement.index, statement);
        return [...all.values()];
    }

    // the number of a statement to be added
    get next() {
        return Math.max(this.piece.text.count, ...this.sent.map(s => 1 + (s.statement?.index ?? -1)));
    }

    // what is chosen, and beside the stage, as the text is now
    agree() {
        const c = this.chosen,
            index = c?.index ?? c?.statement?.index;
        if (index !== undefined) c.statement = this.statements.find(s => s.index === index);
        if (index !== undefined && !c.statement) this.choose(null);
        else this.show();
        if (this.exact) for (const change of this.later.splice(0)) change();
    }

    // true if undo finds a change
    get changed() {
        return !!this.piece.text?.undo || this.sent.some(s => s.statement);
    }

    get exact() {
        return this.sent.every(s => s.exact);
    }

    // does a change of what is chosen, which builds on what was sent: after an undo, or words that
    // were typed, once the text has them
    build(change) {
        const c = this.chosen;
        if (this.exact) change();
        else this.later.push(() => this.chosen === c && change());
    }

    // another piece, or this one from its start: then the cursor comes back to where it was
    begun(piece) {
        const old = this.on.playback(),
            same = old && this.named === piece.text.source;
        this.named = piece.text.source;
        this.choose(null);
        this.on.opened(piece);
        if (same) this.hold(this.on.playback(), old.at, old.playing);
    }

    // what follows that time (s) is computed again
    cut(piece, time) {
        const p = this.on.playback();
        if (p?.scene !== piece.scene) return;
        this.on.cut(time);
        if (!p.playing && p.at > p.known) this.hold(p, this.back?.at ?? p.at, !!this.back?.playing);
    }

    // the cursor comes back there when it can, unless it is moved before
    hold(p, at, playing) {
        p.play(false);
        p.seek(at);
        this.back = { at, playing, held: p.at };
    }

    comeBack(p) {
        const { back } = this;
        if (back && (p.playing || p.at !== back.held)) this.back = null;
        if (!this.back || (p.known < back.at && !this.piece.over)) return;
        this.back = null;
        p.seek(back.at);
        p.play(back.playing);
    }

    // --- what is written beside the stage

    inspector() {
        for (const nuance of FAMILY) $("e-nuance").add(new Option(nuance.replace("-", " "), nuance));
        for (const hand of HANDS) $("e-hand").add(new Option(hand, hand));
        for (const name of ["hand", "nuance"]) $(`e-${name}`).onchange = () => this.commit({ [name]: $(`e-${name}`).value });
        for (const name of ["beat", "dynamic", "x", "y"]) $(`e-${name}`).onchange = () => this.typed(`e-${name}`, value => this.commit({ [name]: value }));
        $("e-span").onchange = () => this.chosen?.take && this.typed("e-span", value => this.word(3, value));
        $("e-dynamic").oninput = () => ($("e-loud").textContent = Number($("e-dynamic").value).toFixed(2));
        $("e-words").onchange = () => {
            const words = $("e-words").value.trim().replace(/\s+/g, " ");
            if (words) this.send(this.chosen?.statement?.index, words);
            else this.wrong("An empty line: \"delete\" takes the stroke away.");
        };
        $("e-delete").onclick = () => this.send(this.chosen?.statement?.index, "");
        $("e-undo").onclick = () => this.step("undo");
        $("e-redo").onclick = () => this.step("redo");
        $("e-revert").onclick = () => this.step("revert");
        $("e-here").onclick = () => this.again();
        $("e-save").onclick = () => this.able() && this.piece.say("save");
        for (const ending of ["bvh", "trc", "c3d"])
            $(`e-${ending}`).onclick = () => this.able() && (this.piece.say(`take ${this.piece.stem}.${ending}`), this.on.note("The take is being played and saved …"));
        $("edit").addEventListener("input", e => (this.typing = e.target));
        for (const name of ["change", "focusout"]) $("edit").addEventListener(name, () => (this.typing = null), { capture: true });
        addEventListener("keydown", e => {
            if (!(e.ctrlKey || e.metaKey) || e.target.tagName === "INPUT") return;
            const name = e.key === "z" && !e.shiftKey ? "undo" : e.key === "y" || (e.key === "Z" && e.shiftKey) ? "redo" : null;
            if (name) (e.preventDefault(), this.step(name));
        });
    }

    step(name) {
        if (!this.able()) return;
        const { text, before, after } = this.piece,
            other = name === "undo" && !this.changed && before ? "back" : name === "redo" && !text.redo && after ? "forth" : "";
        if (!other) this.sent.push({ line: name });
        this.piece.say(other || name);
    }

    // what was typed is not sent, and the fields are as they were
    wrong(text) {
        (this.on.note(text), this.show());
    }

    // a field that nobody types in gets its value
    put(id, value) {
        if ($(id) !== this.typing) $(id).value = value;
    }

    // does `use` with the number in a field; one that is none, or out of its limits, is refused
    typed(id, use) {
        const field = $(id),
            { rangeUnderflow, rangeOverflow } = field.validity,
            name = field.getAttribute("aria-label") ?? field.parentElement.firstChild.textContent.trim();
        if (!Number.isNaN(field.valueAsNumber) && !rangeUnderflow && !rangeOverflow) return use(field.valueAsNumber);
        const said = field.value === "" ? "no number" : field.value;
        field.value = field.defaultValue; // where nothing is chosen
        this.wrong(`${name}: ${said}, expected ${field.min}${field.max ? ` to ${field.max}` : " or more"}`);
    }

    written(event) {
        if (event.begun) ((this.ends = ""), (this.sent = []), (this.later = []));
        else this.answered(event.line);
        if (!event.begun || event.source !== this.named) this.on.note(""); // of what was refused before
        if (this.waiting && !this.sent.length) this.waiting.cuts = this.piece.cuts;
        if (event.begun || event.kept) this.state(""); // what was said of the changes from before
        document.body.classList.add("editing");
        document.body.classList.toggle("take", event.take);
        this.agree();
    }

    // of a drum (m); NaN before it has come
    radius(name) {
        const drum = [...this.piece.scene.drums.values()].find(d => d.name === name);
        return drum?.changes[drum.changes.length - 1]?.place[4] ?? NaN;
    }

    // where a stroke is written to land (m)
    aim(s) {
        if (s.x !== undefined) return [s.x, s.y];
        const radius = this.radius(s.drum || this.chosen.strike.drum),
            [none, one] = s.spot;
        return none.map((v, i) => v + radius * (one[i] - v));
    }

    // a dynamic as it was written: a word stays one if there is one for it
    loud(value, was) {
        const i = Math.round(value * (DYNAMICS.length - 1)),
            near = Math.abs(value - i / (DYNAMICS.length - 1)) < NEAR;
        return near && DYNAMICS.includes(was) ? DYNAMICS[i] : round(value);
    }

    // a stroke's words with these fields changed, and no others
    rewritten(s, changes) {
        const all = s.words.split(" "),
            rest = s.drum ? all.length - 1 : all.length, // of the drum's name
            [x, y] = this.aim(s);
        if ("x" in changes || "y" in changes) all.splice(5, rest - 5, round(changes.x ?? x), round(changes.y ?? y));
        if ("dynamic" in changes) all[4] = this.loud(changes.dynamic, all[4]);
        if ("nuance" in changes) all[3] = changes.nuance;
        if ("hand" in changes) all[2] = changes.hand;
        if ("beat" in changes) all[1] = round(changes.beat);
        return all.join(" ");
    }

    show() {
        const c = this.chosen,
            s = c?.statement;
        document.body.classList.toggle("chosen", !!c);
        $("e-undo").disabled = !this.changed && !this.piece.before;
        $("e-redo").disabled = !this.piece.text?.redo && !this.piece.after;
        $("e-revert").disabled = !this.changed;
        $("e-none").hidden = !!c;
        $("e-chosen").hidden = !c;
        $("e-missed").hidden = !c?.strike?.why;
        $("e-missed").textContent = c?.strike?.why ? `Not played: ${c.strike.why}` : "";
        this.pushes.show();
        if (!c) return;
        this.put("e-words", s?.words ?? "");
        $("e-sent").textContent = this.sent.some(({ statement }) => statement && statement.index === s?.index) ? "…" : "";
        $("e-words").parentElement.hidden = !s;
        $("e-stroke").hidden = s?.beat === undefined || c.take;
        $("e-way").hidden = !c.take || c.push;
        if (c.take && s?.words) this.put("e-span", s.words.split(" ")[3]);
        if (s?.beat === undefined) return;
        const [x, y] = this.aim(s);
        (this.put("e-hand", s.hand), this.put("e-nuance", s.nuance));
        (this.put("e-beat", round(s.beat)), this.put("e-dynamic", s.dynamic));
        $("e-loud").textContent = Number($("e-dynamic").value).toFixed(2);
        (this.put("e-x", round(x, 3)), this.put("e-y", round(y, 3)));
    }

    // --- choosing

    // a strike of the scene; a point of a path: { take, hand, time }; a push: { push, segment, along,
    // time, index, statement }
    choose(what) {
        const { scene } = this.piece;
        ((this.chosen = null), (this.drag = null), (this.late = false), (this.typing = null));
        this.when.stay();
        if (what?.take || what?.push) {
            this.chosen = what;
            if (what.index !== undefined) what.statement = this.statements.find(s => s.index === what.index);
        } else if (what) {
            const near = this.statements.filter(s => what.beat !== null && Math.abs(s.beat - what.beat) < 1e-4),
                one = near.length === 1 ? near[0] : undefined, // the other hand had no time
                own = near.find(s => s.hand === what.hand) ?? this.ornament(what) ?? one;
            this.chosen = { strike: what, hand: what.hand, time: what.time, statement: own };
            this.piece.look(what.time, { left: 0, right: 1 }[what.hand]);
            if (!own) this.on.note("No words of the score stand for this stroke.");
        }
        draw(this.ghost, []);
        if (!this.chosen) (draw(this.path, []), (this.spot.visible = this.top.visible = false));
        this.show();
        if (this.chosen && scene) this.trace();
    }

    // the roll, flam, drag or ruff that a strike is of, whose beat it has; a bounce has none
    ornament(strike) {
        const beat = strike.beat ?? this.pushes.beatAt(strike.time),
            most = strike.beat === null ? BOUNCE : 1e-4,
            off = s => Math.max(0, s.at - beat, beat - s.at - s.length),
            near = this.statements.filter(s => s.length !== undefined && off(s) < most);
        return near.sort((a, b) => off(a) - off(b))[0];
    }

    // a click of the timeline, on a strike, a nudge or a push
    pick(what) {
        if (this.piece.scene && (what.push || !!this.piece.text?.take === !!what.take)) this.choose(what);
    }

    // by a key, of a take: the nudge at that time (s), or the point there of the hand that strikes next to it;
    // once more the other hand's
    pickAt(time) {
        const c = this.chosen,
            apart = s => Math.abs(s.time - time),
            nearest = list => list.reduce((a, b) => (a && apart(a) <= apart(b) ? a : b), null),
            nudge = nearest(this.piece.nudges),
            again = c?.take && apart(c) < AT,
            hand = again ? HANDS.find(h => h !== c.hand) : (nearest(this.piece.scene.strikes)?.hand ?? HANDS[1]);
        this.pick(nudge && apart(nudge) < AT && nudge.index !== c?.index ? nudge : { take: true, hand, time });
    }

    // the nudges and pushes, as what can be chosen
    get marks() {
        return [...this.piece.nudges, ...this.pushes.list().map(s => this.pushes.mark(s))];
    }

    // the path of the hand's tip, or of another segment's point, around a time
    points(hand, time, segment = bone(`${hand}-stick`), local = null) {
        const { scene } = this.piece,
            pose = new Float64Array(7 * segments.length),
            at = new Float64Array(3),
            h = HANDS.indexOf(hand),
            out = [];
        for (let t = Math.max(0, time - PATH[0]); t < Math.min(scene.end, time + PATH[1]); t += STEP) {
            scene.pose(t, pose);
            place(pose, 7 * segment + 3, ...(local ?? scene.body(t).tips[h]), pose, 7 * segment, at, 0);
            out.push(Object.assign(new THREE.Vector3(...at), { time: t }));
        }
        return out;
    }

    trace() {
        const c = this.chosen;
        c.points = this.points(c.hand, c.time, c.segment, c.push && pushed(c.segment, c.along));
        this.path.material.color = rgb(c.push ? PUSHED : handColor[HANDS.indexOf(c.hand)]);
        draw(this.path, c.points);
        const nearest = c.points.reduce((a, p) => (Math.abs(p.time - c.time) < Math.abs(a.time - c.time) ? p : a), c.points[0]);
        if (!nearest) return this.hide();
        if (c.take || c.push) this.spot.position.copy(nearest);
        else {
            const head = this.head(c.strike.drum);
            this.spot.position.set(c.strike.x, c.strike.y, 0.012);
            this.late = !head;
            head?.localToWorld(this.spot.position);
            const rise = c.points.filter(p => p.time < c.time);
            this.top.position.copy(rise.reduce((a, p) => (p.z > a.z ? p : a), nearest));
        }
        this.spot.visible = !c.push;
        this.top.visible = !c.take && !c.push && c.statement?.beat !== undefined;
    }

    // the paths of a take around that time (s), while none of their points is chosen
    offer(time) {
        const key = this.chosen || !this.piece.text?.take ? "" : `${time} ${this.piece.cuts} ${this.piece.scene.end}`;
        if (key === this.offers) return;
        this.offers = key;
        this.offered.forEach((made, h) => draw(made, key ? this.points(HANDS[h], time) : []));
    }

    hide() {
        for (const part of this.group.children) part.visible = false;
    }

    // with its place of now, which a frame has perhaps not drawn yet
    head(name) {
        const head = this.on.drum(name);
        head?.updateWorldMatrix(true, false);
        return head;
    }

    // --- dragging

    screen(position) {
        const q = position.clone().project(this.view.camera);
        return [((q.x + 1) * innerWidth) / 2, ((1 - q.y) * innerHeight) / 2, q.z];
    }

    off(position, e) {
        const [x, y, z] = this.screen(position);
        return z > 1 ? Infinity : Math.hypot(x - e.clientX, y - e.clientY);
    }

    ray(e) {
        return this.view.ray(e);
    }

    // the one of these that a press takes
    grabbed(meshes, e) {
        const near = meshes.filter(m => m.visible).map(mesh => ({ mesh, off: this.off(mesh.position, e) })),
            least = near.reduce((a, b) => (b.off < a.off ? b : a), { off: reach(e) });
        return least.mesh;
    }

    press(e) {
        if (e.button || !this.piece.text || !this.piece.scene || !this.group.visible || !this.piece.live) return;
        const c = this.chosen,
            pushes = this.pushes.press(e),
            handle = !pushes && this.grabbed([this.spot, this.top], e);
        if (pushes || (handle && (c.take || c.statement?.beat !== undefined))) {
            this.drag = !pushes && { handle, begun: handle.position.clone() };
            if (!pushes) draw(this.ghost, c.points);
            $("stage").setPointerCapture(e.pointerId);
        } else if (this.piece.text.take) {
            if (!this.grab(e)) return;
        } else {
            const hit = this.grabbed(this.dots, e);
            if (!hit) return;
            this.choose(hit.strike);
        }
        this.pause();
        e.stopImmediatePropagation();
    }

    // while something is dragged; after the change it plays on if it did
    pause() {
        const p = this.on.playback();
        if (!p?.playing) return;
        this.played = true;
        p.play(false);
    }

    // a point of a path of the take; false if none is near
    grab(e) {
        const at = (this.on.playback()?.at ?? 0) / 1000;
        let best = { off: reach(e) };
        for (const hand of HANDS)
            for (const p of this.points(hand, at)) {
                const off = this.off(p, e);
                if (off < best.off) best = { off, hand, time: p.time };
            }
        if (best.hand) this.choose({ take: true, hand: best.hand, time: best.time });
        return !!best.hand;
    }

    move(e) {
        if (this.pushes.move(e)) return e.stopImmediatePropagation();
        if (!this.drag) return;
        e.stopImmediatePropagation();
        const { handle, begun } = this.drag,
            c = this.chosen,
            ray = this.ray(e),
            plane = new THREE.Plane(),
            to = new THREE.Vector3();
        if (handle === this.top || c.take) plane.setFromNormalAndCoplanarPoint(ray.direction.clone().setZ(c.take ? ray.direction.z : 0).normalize(), begun);
        else {
            const head = this.head(c.strike.drum);
            plane.setFromNormalAndCoplanarPoint(new THREE.Vector3(0, 0, 1).transformDirection(head.matrixWorld), begun);
        }
        if (!ray.intersectPlane(plane, to)) return;
        if (handle === this.top) to.set(begun.x, begun.y, to.z);
        handle.position.copy(to);
        const way = to.clone().sub(begun),
            span = c.take ? Number($("e-span").value) : PATH[1],
            middle = c.take ? c.time : handle === this.top ? c.time - 0.2 : c.time;
        this.drag.way = way;
        draw(
            this.path,
            c.points.map(p => p.clone().addScaledVector(way, bump(1 - Math.abs(p.time - middle) / span))),
        );
    }

    release(e) {
        this.released(e);
        this.played = false; // what was only chosen stays paused
    }

    released(e) {
        if (this.pushes.release(e)) return e.stopImmediatePropagation();
        if (!this.drag) return;
        e.stopImmediatePropagation();
        const { handle, way, begun } = this.drag,
            c = this.chosen;
        this.drag = null;
        if (!way || way.length() < 1e-3) return void handle.position.copy(begun);
        if (c.take) return this.nudge(way);
        const s = c.statement;
        if (handle === this.top) return this.commit({ dynamic: Math.min(1, Math.max(0, s.dynamic + way.z / RANGE)) });
        // what is played differs from what is written as a player's strokes do, and so it stays
        const [from, to] = [begun, this.spot.position].map(v => this.head(c.strike.drum).worldToLocal(v.clone())),
            [x, y] = this.aim(s).map((v, i) => v + (i ? to.y - from.y : to.x - from.x)),
            out = Math.max(1, Math.hypot(x, y) / (INSIDE * this.radius(c.strike.drum)));
        this.commit({ x: x / out, y: y / out });
    }

    // --- changes

    // a stroke's fields
    commit(changes) {
        if (this.chosen?.statement?.beat === undefined || this.chosen.take) return;
        this.build(() => {
            const c = this.chosen,
                s = c.statement,
                [x, y] = this.aim(s),
                whole = { ...changes };
            if ("x" in changes || "y" in changes) ((whole.x = changes.x ?? x), (whole.y = changes.y ?? y));
            if ((changes.hand ?? s.hand) !== s.hand && s.spot) whole.spot = s.spot.map(([x, y]) => [x, -y]); // each hand has its side
            if (!this.ghost.visible) draw(this.ghost, c.points);
            this.send(s.index, this.rewritten(s, changes), whole);
        });
    }

    // another word at that place of the chosen statement, "" for none
    word(place, word) {
        if (!this.chosen?.statement) return;
        this.build(() => {
            const s = this.chosen.statement,
                all = s.words.split(" ");
            all.splice(place, 1, ...(word === "" ? [] : [word]));
            this.send(s.index, all.join(" "), {});
        });
    }

    nudge(way) {
        const c = this.chosen,
            [begin, was] = c.statement
                ? [c.statement.words.split(" ").slice(0, 4).join(" "), c.statement.words.split(" ").slice(4).map(Number)]
                : [`nudge ${c.hand} ${round(Piece.takeTime(c.time), 3)} ${$("e-span").value}`, [0, 0, 0]],
            whole = way.toArray().map((v, i) => round(Math.min(0.5, Math.max(-0.5, v + was[i]))));
        c.index = c.statement?.index ?? this.next; // more drags change the same one
        this.send(c.index, `${begin} ${whole.join(" ")}`, {});
    }

    // `fields` are those of the words that differ, null if they are not known; `to` is the new time (s)
    send(index, words, fields = null, to = this.chosen?.time) {
        const c = this.chosen,
            { waiting } = this,
            line = `set ${index} ${words}`;
        if (!c || index === undefined) return;
        if (!this.able()) return this.show();
        this.on.note("");
        if (words === c.statement?.words) return this.same();
        const plays = this.played || !!this.on.playback()?.playing || !!waiting?.plays,
            times = [c.time, to, ...(waiting?.times ?? [])].sort((a, b) => a - b);
        if (c.push && !this.ghost.visible) draw(this.ghost, c.points);
        this.waiting = { begun: performance.now(), cuts: this.piece.cuts, times: [times[0], times.pop()], to, plays };
        this.played = false;
        c.statement = { ...c.statement, ...(c.push && words ? this.pushes.read(words) : fields), index, words };
        this.sent.push({ line, statement: c.statement, exact: !!fields });
        this.piece.say(line);
        this.show();
    }

    // nothing has changed: what was dragged goes back, and what played plays on
    same() {
        this.show();
        this.trace();
        if (this.played) this.on.playback().play(true);
        this.played = false;
    }

    // --- what comes

    grown(piece) {
        const p = this.on.playback();
        if (!p || p.scene !== piece.scene) return;
        p.length = Math.max(piece.over ? 0 : p.length, 1000 * piece.scene.end);
        this.on.changed(piece);
        this.comeBack(p);
        const w = this.waiting;
        if (!w || this.sent.length || piece.cuts === w.cuts) return;
        const from = Math.max(0, w.times[0] - BEFORE),
            done = piece.sound.arrived >= w.times[1] + SOON || piece.over;
        if (!w.heard && (done || (w.plays && piece.sound.arrived >= from + LEAD))) {
            if (w.plays) (p.seek(1000 * from), p.play(true));
            this.heard.push(performance.now() - w.begun);
            w.heard = true;
        }
        if (!done) return;
        this.waiting = null;
        this.follow(w.to);
    }

    // what is chosen as it is played now, near that time (s)
    follow(to = this.chosen?.time) {
        const c = this.chosen,
            { scene } = this.piece;
        if (!c) return;
        if (!c.take && !c.push) {
            const { statement } = c,
                wanted = statement?.beat === undefined ? c.strike : statement,
                all = [...scene.strikes, ...scene.missed],
                off = s => Math.abs(s.time - to),
                there =
                    statement?.length === undefined
                        ? all.filter(s => Math.abs(s.beat - wanted.beat) < 1e-3)
                        : all.filter(s => this.ornament(s) === statement).sort((a, b) => off(a) - off(b)),
                found = there.find(s => s.hand === wanted.hand) ?? there[0];
            if (!found) return;
            if (found.why) this.on.note(`Not played: ${found.why}`);
            Object.assign(c, { strike: found, hand: found.hand, time: found.time });
        } else c.time = this.marks.find(n => n.index === c.statement?.index)?.time ?? c.time;
        this.trace();
        this.show();
    }

    // the chosen statement as it is written now, after an undo too
    refresh() {
        if (this.chosen?.statement && !this.waiting) this.follow();
    }

    over(piece) {
        const p = this.on.playback();
        if (p?.scene === piece.scene) p.length = 1000 * piece.scene.end;
        this.on.finished(piece);
        this.grown(piece);
        this.refresh();
    }

    // a frame: the dots of the strokes around, while nothing moves
    update() {
        const p = this.on.playback(),
            here = p && p.scene === this.piece.scene;
        this.group.visible = !!here && !p.playing && this.piece.live;
        document.body.classList.toggle("elsewhere", this.elsewhere);
        this.pushes.update();
        if (this.late) this.trace();
        if (!this.group.visible) return;
        this.offer(p.at / 1000);
        if (this.piece.text?.take) return;
        const list = p.scene.strikes,
            first = before(list, p.at / 1000 - STROKES, s => s.time) + 1,
            near = [...p.scene.missed.filter(s => Math.abs(s.time - p.at / 1000) < STROKES), ...list.slice(first, first + this.dots.length)];
        this.dots.forEach((mesh, i) => {
            const s = near[i],
                head = s && s.time < p.at / 1000 + STROKES && this.head(s.drum);
            mesh.visible = !!head;
            if (!head || mesh.strike === s) return;
            mesh.strike = s;
            mesh.position.set(s.x, s.y, 0.006);
            head.localToWorld(mesh.position);
            mesh.material.color = rgb(s.why ? MISSED : handColor[s.hand === HANDS[0] ? 0 : 1]);
        });
    }
}

function save(name, bytes) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([bytes]));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
