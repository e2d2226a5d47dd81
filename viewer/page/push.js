// Pushes: a drag on the body becomes a force on the segment it took hold of, as by a spring from
// there to the pointer, from the beat shown on for a while. Each is a statement of the piece,
// `at BEAT push SEGMENT X Y Z SECONDS ALONG`. Colour: chosen by eye.
import * as THREE from "./three.js";
import { bone, pushed } from "./body.js";
import { APPROACH } from "./piece.js";
import { segments } from "./skeleton.js";
import { Arrow } from "./strike.js";

const $ = id => document.getElementById(id);
const STIFFNESS = 2000, // of the spring (N/m); chosen: a hand's width is 200 N, which moves an arm by a centimetre
    STRONGEST = 1000, // (N), as the command allows
    WEAKEST = 10, // of a drag that counts (N)
    BEAT = 0.6, // length of a beat where there is one only (s)
    ARROWS = 4, // at a time
    COLOR = "#9cf29c";
const round = (v, digits) => +v.toFixed(digits);

// y at x, linear between the points [x, y] and beyond the outer ones
function linear(points, x) {
    let i = 1;
    while (i < points.length - 1 && points[i][0] < x) i++;
    const [a, b] = [points[i - 1], points[i]];
    return a[1] + ((b[1] - a[1]) * (x - a[0])) / (b[0] - a[0]);
}

export class Pushes {
    // `on`: performer(); view, ray(e), piece, chosen, choose(what), send(index, words) of the editor
    constructor(editor, scene) {
        ((this.editor = editor), (this.held = null));
        this.arrows = Array.from({ length: ARROWS }, () => {
            const arrow = new Arrow({ depthTest: false, opacity: 0.9 });
            for (const part of arrow.group.children) part.renderOrder = 10;
            return arrow;
        });
        scene.add(...this.arrows.map(a => a.group));
        for (const s of segments.slice(1)) $("e-segment").add(new Option(s.name.replaceAll("-", " "), s.name));
        $("e-segment").value = "left-forearm";
        ["e-segment", "e-fx", "e-fy", "e-fz", "e-seconds", "e-along"].forEach(
            (id, i) => ($(id).onchange = () => this.editor.chosen?.push && this.change(id, 3 + i)),
        );
        $("e-add").onclick = () => this.numbers(["e-fx", "e-fy", "e-fz", "e-seconds", "e-along"], (x, y, z, _, along) => this.add($("e-segment").value, [x, y, z], along));
        $("e-grab").onclick = () => $("e-grab").setAttribute("aria-pressed", document.body.classList.toggle("pushing"));
        $("e-pushes").onchange = e => this.choose(this.list().find(s => s.index === Number(e.target.value)));
    }

    list() {
        return (this.editor.piece.text?.statements ?? []).filter(s => s.push);
    }

    // --- when

    // [time, beat] of the scene; a take's beats are seconds
    course() {
        const beats = this.editor.piece.scene.beats.map(b => [b.time, b.beat]);
        if (!beats.length) beats.push([APPROACH, 0]);
        if (beats.length < 2) beats.push([beats[0][0] + (this.editor.piece.scene.beats.length ? BEAT : 1), beats[0][1] + 1]);
        return beats;
    }

    beatAt(time) {
        return linear(this.course(), time);
    }

    timeAt(beat) {
        return linear(this.course().map(([time, at]) => [at, time]), beat);
    }

    time(s) {
        return this.timeAt(s.at);
    }

    // --- what is written

    // the word at that place of the chosen push, as the field has it; without a place along the segment the
    // push acts on its centre of mass
    change(id, place) {
        if (id === "e-segment" || $("e-along").value === "" && id === "e-along") this.editor.word(place, $(id).value);
        else this.editor.typed(id, value => this.editor.word(place, value));
    }

    // does `use` with the numbers in these fields, if they are such; undefined: the centre of mass
    numbers([id, ...rest], use, ...values) {
        if (!id) return use(...values);
        if (id === "e-along" && $(id).value === "") this.numbers(rest, use, ...values, undefined);
        else this.editor.typed(id, value => this.numbers(rest, use, ...values, value));
    }

    words(at, name, force, along) {
        return `at ${at} push ${name} ${force.map(f => round(f, 0)).join(" ")} ${Number($("e-seconds").value)} ${along ?? ""}`.trim();
    }

    // the fields of such words
    read(words) {
        const [, at, , push, ...numbers] = words.split(" "),
            [x, y, z, seconds, along] = numbers.map(Number);
        return { at: Number(at), push, force: [x, y, z], seconds, along };
    }

    // at the moment that is shown
    add(name, force, along) {
        const { editor } = this;
        if (!editor.able()) return;
        const time = editor.on.playback().at / 1000,
            at = round(Math.max(0, this.beatAt(time)), 4);
        const index = editor.next;
        editor.choose({ push: true, time, segment: bone(name), along, index });
        editor.send(index, this.words(at, name, force, along), {});
    }

    // a push as what can be chosen
    mark(s) {
        return { push: true, time: this.time(s), segment: bone(s.push), along: s.along, statement: s, index: s.index };
    }

    choose(s) {
        if (!s) return void this.editor.choose(null);
        const mark = this.mark(s);
        this.editor.on.playback().play(false);
        this.editor.on.playback().seek(1000 * mark.time);
        this.editor.choose(mark);
    }

    // the fields as the text has them
    show() {
        const chosen = this.editor.chosen?.statement,
            list = this.list();
        $("e-pushes").replaceChildren(new Option(`${list.length} in the piece`, ""), ...list.map(s => new Option(`at ${round(s.at, 2)} ${s.push}`, s.index)));
        $("e-pushes").hidden = !list.length;
        if (!chosen?.push) return;
        const put = (id, value) => this.editor.put(id, value);
        ($("e-pushes").value = chosen.index), put("e-segment", chosen.push);
        ["e-fx", "e-fy", "e-fz"].forEach((id, i) => put(id, round(chosen.force[i], 1)));
        put("e-seconds", round(chosen.seconds, 3));
        put("e-along", chosen.along === undefined ? "" : round(chosen.along, 3));
        $("e-push").open = true;
    }

    // --- dragging; each tells whether the event was for a push

    press(e) {
        if (!(e.altKey || e.ctrlKey || e.metaKey || document.body.classList.contains("pushing"))) return false;
        const figure = this.editor.on.performer()?.figure,
            hit = figure?.meet(this.editor.ray(e));
        if (!hit) return false;
        if (!hit.segment) return !!this.editor.on.note("The pelvis stays where it is: push another segment.");
        const away = this.editor.view.camera.getWorldDirection(new THREE.Vector3());
        this.held = {
            segment: hit.segment,
            along: figure.along(hit.segment, hit.point),
            from: hit.point,
            plane: new THREE.Plane().setFromNormalAndCoplanarPoint(away, hit.point),
            force: new THREE.Vector3(),
        };
        return true;
    }

    move(e) {
        const { held } = this,
            to = held && this.editor.ray(e).intersectPlane(held.plane, new THREE.Vector3());
        if (to) held.force.copy(to).sub(held.from).multiplyScalar(STIFFNESS).clampLength(0, STRONGEST);
        return !!held;
    }

    release(e) {
        const { held } = this;
        this.held = null;
        if (held && e.type === "pointerup" && held.force.length() > WEAKEST) this.add(segments[held.segment].name, held.force.toArray(), held.along);
        return !!held;
    }

    // --- a frame: the pushes that act, and the one under way

    update() {
        const p = this.editor.on.playback(),
            figure = this.editor.on.performer()?.figure,
            here = figure && p && p.scene === this.editor.piece.scene,
            acting = here ? this.list().filter(s => this.acts(s, p.at / 1000)) : [],
            shown = acting.map(s => ({ segment: bone(s.push), along: s.along, force: new THREE.Vector3(...s.force) }));
        if (here && this.held) shown.unshift(this.held);
        this.arrows.forEach((arrow, i) => {
            const { segment, along, force } = shown[i] ?? {};
            arrow.group.visible = force?.length() > WEAKEST;
            if (arrow.group.visible) this.point(arrow, figure.place(segment, pushed(segment, along)), force);
        });
    }

    acts(s, now) {
        const since = now - this.time(s);
        return since > -0.004 && since < s.seconds; // it begins at a tick
    }

    // from where the force acts
    point(arrow, from, force) {
        const way = force.clone().divideScalar(STIFFNESS);
        arrow.group.position.copy(from).add(way);
        arrow.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), way.clone().normalize().negate());
        arrow.write(force.length(), COLOR);
        const near = this.editor.view.near();
        arrow.stretch(way.length(), near);
        arrow.label.sprite.position.z = -0.04 * near;
    }
}
