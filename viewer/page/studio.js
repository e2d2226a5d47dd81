// The performer inside the page: starts the Worker that computes it (worker.js), hands the Worker a
// port to the audio thread, shows what it tells as the stream of any live performer, and turns what
// the user does into the commands that Pure Data has.
import * as THREE from "./three.js";
import { readFrame } from "./stream.js";

const $ = id => document.getElementById(id);
const RATE = 48000, // (Hz), on every device: the same bits everywhere
    SAID = 60, // lines that are kept; chosen
    LONGEST = 20000, // of a link (letters); chosen: what chats and mails keep whole
    LOWEST = 38, // the note at the left of the tuning, D2 ...
    NOTES = ["C", "C#", "D", "Eb", "E", "F", "F#", "G", "Ab", "A", "Bb", "B"],
    HITS = { z: "left", x: "right" }, // keys
    SCORE = /\.(txt|himc|mid|midi|musicxml|xml|mxl|bvh|c3d|trc)$/i;
const DEFLATE = "deflate-raw";

const noteName = key => `${NOTES[key % 12]}${Math.floor(key / 12) - 1}`;

async function squeeze(bytes, stream) {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

// a score as the part of an address after the #
export async function linkOf(text) {
    const bytes = await squeeze(new TextEncoder().encode(text), new CompressionStream(DEFLATE));
    return `#s=${btoa(String.fromCharCode(...bytes)).replace(/\+/g, "-").replace(/\//g, "_").replace(/=/g, "")}`;
}

export async function textOf(hash) {
    const letters = atob(hash.slice(3).replace(/-/g, "+").replace(/_/g, "/")),
        bytes = Uint8Array.from(letters, c => c.charCodeAt(0));
    return new TextDecoder().decode(await squeeze(bytes, new DecompressionStream(DEFLATE)));
}

// `on` has: frame, the handlers of a Stream; fresh(): another piece begins; drums(): those that are seen;
// ray(press); scene(file): to show one; hold(yes): to draw nothing
export class Studio {
    constructor(files, sound, liveSound, on) {
        ((this.on = on), (this.sound = sound), (this.liveSound = liveSound), (this.files = files));
        ((this.connections = 1), (this.plays = false), (this.said = []), (this.past = []), (this.names = ""));
        const [[, wasm], ...pieces] = files;
        ((this.pieces = pieces.map(([name]) => name)), (this.name = ""), (this.ready = false));
        this.texts = new Map(pieces);
        const source = window.himcScripts.get("worker.js"),
            address = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
        this.worker = new Worker(address);
        this.worker.onmessage = e => this.hear(e.data);
        this.worker.onerror = e => this.tell(e.message, true);
        this.worker.postMessage({ begin: { wasm, files: pieces, rate: RATE } });
        this.controls();
        document.body.classList.add("studio");
        this.begin().catch(error => this.tell(error.message, true));
    }

    async begin() {
        this.worker.postMessage({ runs: true });
        if (location.hash.startsWith("#s=")) {
            const text = await textOf(location.hash).catch(() => null);
            if (text !== null) return this.load("link.txt", new TextEncoder().encode(text));
            this.tell("this link holds no score", true);
        }
        this.load(this.pieces[0] ?? "");
    }

    // the device is open: sound goes from the Worker to the audio thread, past this page
    async listen() {
        if (this.listens) return;
        this.listens = true;
        this.on.hold(true);
        const port = await this.liveSound.feed("page").catch(error => this.tell(`no sound: ${error.message}`, true));
        this.on.hold(false);
        if (port) this.worker.postMessage({ port }, [port]);
    }

    // --- what the Worker tells

    hear({ frame, loaded, failed, line, saved, bytes, name }) {
        if (frame) readFrame(frame, this.handlers);
        else if (saved) this.save(saved, bytes);
        else if (loaded !== undefined) this.fresh(loaded);
        else if (line !== undefined) this.answered(line, failed);
        else if (failed) this.tell(name && !failed.startsWith(name) ? `${name}: ${failed}` : failed, true);
    }

    get handlers() {
        const on = this.on.frame;
        return {
            ...on,
            event: (event, time) => {
                if (event.event === "done") this.playing(false);
                else if (event.event === "line" || event.event === "note") this.tell(event.text);
                else if (event.event === "missed" || event.event === "refused") this.tell(event.text, true);
                else on.event(event, time);
            },
        };
    }

    fresh(name) {
        ((this.name = name), (this.ready = true), (this.names = ""));
        $("p-drum").replaceChildren();
        this.on.fresh();
        this.playing(!!this.wanted);
        $("p-piece").value = this.pieces.includes(name) ? name : "";
        $("p-piece").options[0].text = this.pieces.includes(name) || !name ? "a piece" : name;
        this.tell(name ? `${name} is on the stand` : "a performer without a score");
    }

    answered(line, failed) {
        if (failed) this.tell(failed, true);
        const word = line.split(" ")[0];
        if (!failed && (word === "play" || word === "stop")) this.playing(word === "play");
    }

    tell(text, wrong = false) {
        const log = $("p-said"),
            row = document.createElement("div");
        row.textContent = text;
        row.classList.toggle("wrong", wrong);
        log.append(row);
        this.said.push({ text, wrong });
        while (log.children.length > SAID) log.firstChild.remove();
        log.scrollTop = log.scrollHeight;
    }

    save(name, bytes) {
        const link = document.createElement("a");
        link.href = URL.createObjectURL(new Blob([bytes]));
        link.download = name;
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    }

    playing(yes) {
        this.plays = yes;
        this.wanted = false;
        $("p-play").textContent = yes ? "■ stop" : "▶ play";
        $("p-play").setAttribute("aria-pressed", yes);
    }

    // --- what the user does

    say(line) {
        this.worker.postMessage({ say: line.trim().replace(/;$/, "") });
    }

    // a piece of the page, or a file; `play`: at once
    load(name, bytes = null, play = false) {
        if (bytes) this.texts.set(name, bytes);
        this.wanted = play;
        this.worker.postMessage({ load: { name, bytes, then: play ? ["play"] : [] } });
    }

    async open(file) {
        if (/\.himc$/i.test(file.name)) return this.on.scene(file);
        const bytes = new Uint8Array(await file.arrayBuffer());
        this.load(file.name.split("/").pop(), bytes, true);
    }

    toggle() {
        if (this.ready) this.say(this.plays ? "stop" : "play");
    }

    // x and y on the head (m)
    hit(hand, dynamic = Number($("p-dynamic").value), spot = "", drum = $("p-drum").value) {
        this.say(`hit ${hand} legato ${dynamic.toFixed(3)} ${spot} ${drum}`.replace(/ +/g, " "));
    }

    press(e) {
        const caster = new THREE.Raycaster(),
            ray = this.on.ray(e);
        caster.set(ray.origin, ray.direction);
        for (const drum of this.on.drums()) {
            if (!caster.intersectObjects(drum.tilted.children, true).length) continue;
            const head = drum.tilted,
                normal = new THREE.Vector3(0, 0, 1).transformDirection(head.matrixWorld),
                plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, head.getWorldPosition(new THREE.Vector3())),
                at = ray.intersectPlane(plane, new THREE.Vector3());
            if (!at) continue;
            const { x, y } = head.worldToLocal(at),
                radius = drum.place[4];
            if (Math.hypot(x, y) < radius) return this.hit("any", undefined, `${x.toFixed(3)} ${y.toFixed(3)}`, drum.name);
        }
    }

    key(e) {
        const hand = HITS[e.key.toLowerCase()];
        if (e.ctrlKey || e.metaKey || e.altKey || e.repeat || /^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName)) return;
        if (hand) this.hit(hand);
        else if (e.key === " " && e.target.tagName !== "BUTTON") this.toggle();
        else return;
        e.preventDefault();
        e.stopImmediatePropagation();
    }

    paste(e) {
        const files = [...(e.clipboardData?.files ?? [])],
            text = e.clipboardData?.getData("text");
        if (/^(INPUT|TEXTAREA)$/.test(e.target.tagName)) return;
        if (files.length) files.forEach(file => this.open(file));
        else if (text) this.load("pasted.txt", new TextEncoder().encode(text), true);
    }

    async midi() {
        const access = await navigator.requestMIDIAccess();
        const listen = () => access.inputs.forEach(input => (input.onmidimessage = e => this.note(e.data)));
        access.onstatechange = listen;
        listen();
        this.tell(access.inputs.size ? `MIDI: ${[...access.inputs.values()].map(i => i.name).join(", ")}` : "MIDI: no keyboard yet");
    }

    // a key that is pressed; several drums lie on the keys in turn
    note([status, key, velocity]) {
        const drums = this.on.drums();
        if ((status & 0xf0) !== 0x90 || !velocity || !drums.length) return;
        this.hit("any", velocity / 127, "", drums[key % drums.length].name);
    }

    // the drums of the piece, once they are seen
    drums(all) {
        const names = all.map(drum => drum.name);
        if (names.join() === this.names) return;
        this.names = names.join();
        $("p-drum").replaceChildren(...names.map(name => new Option(name, name)));
    }

    async copyLink() {
        const bytes = this.texts.get(this.name),
            text = bytes && new TextDecoder().decode(bytes),
            link = text && !/\0/.test(text) ? await linkOf(text) : null;
        if (!link || link.length > LONGEST) return this.tell("only a short score fits into a link", true);
        const address = location.href.replace(/#.*/, "") + link;
        history.replaceState(null, "", link);
        const copied = await navigator.clipboard?.writeText(address).then(() => true, () => false);
        this.tell(copied ? "the link is copied" : "the link is in the address line");
    }

    controls() {
        const click = (id, f) => ($(id).onclick = f);
        $("perform").hidden = false;
        $("p-piece").append(new Option("a piece", ""), ...this.pieces.map(name => new Option(name, name)));
        $("p-piece").onchange = e => this.load(e.target.value, null, true);
        click("p-play", () => this.toggle());
        click("p-open", () => $("p-file").click());
        click("p-link", () => this.copyLink().catch(error => this.tell(error.message, true)));
        $("p-file").onchange = e => [...e.target.files].forEach(file => this.open(file));
        $("p-midi").hidden = !navigator.requestMIDIAccess;
        click("p-midi", () => this.midi().catch(error => this.tell(`MIDI: ${error.message}`, true)));
        const told = (id, words, command) =>
            ($(id).oninput = e => {
                $(id).nextElementSibling.textContent = words(Number(e.target.value));
                if (command) this.say(command(Number(e.target.value)));
            });
        told("p-tempo", bpm => `${bpm} bpm`, bpm => `tempo ${bpm}`);
        told("p-dynamic", d => ["ppp", "pp", "p", "mp", "mf", "f", "ff", "fff"][Math.round(7 * d)]);
        told("p-tune", k => noteName(LOWEST + k), k => `${$("p-drum").value} tune ${noteName(LOWEST + k)}`);
        $("p-mallet").onchange = e => this.say(`${$("p-drum").value} mallet ${e.target.value}`);
        $("p-form").onsubmit = e => (e.preventDefault(), this.send());
        $("p-line").onkeydown = e => this.recall(e);
        click("p-copy", () => navigator.clipboard?.writeText($("p-line").value.replace(/([,;$])/g, "\\$1")));
        $("stage").addEventListener("pointerdown", e => !e.button && this.press(e), true);
        addEventListener("keydown", e => this.key(e), true);
        addEventListener("paste", e => this.paste(e));
    }

    send() {
        const line = $("p-line").value.trim();
        if (!line) return;
        this.past.push(line);
        this.back = this.past.length;
        $("p-line").value = "";
        this.tell(`> ${line}`);
        this.say(line);
    }

    recall(e) {
        const by = { ArrowUp: -1, ArrowDown: 1 }[e.key];
        if (!by) return;
        e.preventDefault();
        this.back = Math.min(this.past.length, Math.max(0, (this.back ?? this.past.length) + by));
        $("p-line").value = this.past[this.back] ?? "";
    }
}

export const plays = name => SCORE.test(name);
