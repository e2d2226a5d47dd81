// The performer inside the page: starts the Worker that computes it (worker.js), and another one for each piece,
// which takes over once it has loaded, so that nothing stands still meanwhile; hands the Worker a port to the audio thread, shows what it tells as the stream of any live performer, and turns what
// the user does into the commands that Pure Data has.
import * as THREE from "./three.js";
import { Channel } from "./channel.js";
import { readFrame } from "./stream.js";

const $ = id => document.getElementById(id);
const RATE = 48000, // (Hz), on every device: the same bits everywhere
    SAID = 60, // lines that are kept; chosen
    PREPARED = 700, // (ms) of loading that is not told; chosen
    LONGEST = 20000, // of a link (letters); chosen: what chats and mails keep whole
    LOWEST = 38, // the note at the left of the tuning, D2 ...
    JOURNAL = "himc-journal", // in the browser's storage: the scores whose text was changed, by name
    NOTES = ["C", "C#", "D", "Eb", "E", "F", "F#", "G", "Ab", "A", "Bb", "B"],
    HITS = { z: "left", x: "right" }; // keys
const DEFLATE = "deflate-raw",
    bytesOf = new TextEncoder();

// bytes as letters
const lettersOf = bytes => btoa(Array.from(bytes, b => String.fromCharCode(b)).join("")),
    bytesFrom = letters => Uint8Array.from(atob(letters), c => c.charCodeAt(0));

const noteName = key => `${NOTES[key % 12]}${Math.floor(key / 12) - 1}`;

async function squeeze(bytes, stream) {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

// a score as the part of an address after the #
export async function linkOf(text) {
    const bytes = await squeeze(bytesOf.encode(text), new CompressionStream(DEFLATE));
    return `#s=${lettersOf(bytes).replace(/\+/g, "-").replace(/\//g, "_").replace(/=/g, "")}`;
}

export async function textOf(hash) {
    if (hash.length > LONGEST) throw new Error("too long");
    const bytes = bytesFrom(hash.slice(3).replace(/-/g, "+").replace(/_/g, "/"));
    return new TextDecoder().decode(await squeeze(bytes, new DecompressionStream(DEFLATE)));
}

// `on` has: frame, the handlers of a Stream; prepare(): a piece will come; fresh(): another piece begins; drums(): those that are seen;
// ray(press); plays(): a playback is shown; edit(connect): the piece to which this opens a channel; scene(file): to show one; hold(yes): to draw nothing; wide(): there is room for all controls
export class Studio {
    constructor(files, sound, liveSound, on) {
        ((this.on = on), (this.sound = sound), (this.liveSound = liveSound), (this.worker = this.coming = null));
        ((this.plays = false), (this.said = []), (this.past = []), (this.names = ""));
        this.embedded = new URLSearchParams(location.search).has("embed");
        const [[, wasm], ...pieces] = files;
        this.wasm = wasm;
        ((this.pieces = pieces.map(([name]) => name)), (this.name = ""), (this.ready = false));
        this.texts = new Map(pieces); // as they are in the files
        this.journal = this.remembered();
        this.address = URL.createObjectURL(new Blob([window.himcScripts.get("worker.js")], { type: "text/javascript" }));
        this.controls();
        document.body.classList.add("studio");
        this.begin().catch(error => this.tell(error.message, true));
    }

    async begin() {
        this.module = await WebAssembly.compile(this.wasm).catch(() => null); // once, for all Workers
        if (location.hash.startsWith("#s=")) {
            const text = await textOf(location.hash).catch(() => null);
            if (text !== null) return this.load("link.txt", bytesOf.encode(text));
            this.tell("this link holds no score", true);
        }
        const { base } = this.journal;
        this.resumes = !!base?.open;
        if (base?.open) return this.load(base.name, bytesFrom(base.bytes));
        if (await this.restore()) return;
        this.load(this.pieces[0] ?? "");
    }

    // --- the text of a score, which no end of the page loses

    // a page around this one neither reads nor changes it
    remembered() {
        try {
            const all = JSON.parse((!this.embedded && localStorage.getItem(JOURNAL)) || "{}");
            return { name: String(all.name ?? ""), text: all.text && typeof all.text === "object" ? all.text : {}, base: all.base };
        } catch {
            return { name: "", text: {} };
        }
    }

    remember() {
        if (this.embedded) return;
        try {
            localStorage.setItem(JOURNAL, JSON.stringify(this.journal));
        } catch {
            this.lose();
        }
    }

    lose() {
        if (!this.unkept) this.tell("this browser keeps no changes: save the score as a file", true);
        this.unkept = true;
    }

    // the score that was on the stand when the page ended, as it was changed
    async restore() {
        const { name, text } = this.journal;
        if (typeof text[name] !== "string") return false;
        this.draft = text[name];
        this.load(name, bytesOf.encode(text[name]));
        const own = this.pieces.includes(name) ? `; "file's text" takes your changes back` : "";
        this.tell(`${name} is here again as you left it${own}`);
        return true;
    }

    // what is typed is kept at once; a link in the address would bring back another text
    typed() {
        if (location.hash) history.replaceState(null, "", location.pathname + location.search);
        ((this.journal.name = this.name || "score.txt"), (this.journal.text[this.journal.name] = $("p-text").value));
        this.remember();
    }

    // plays the text; from the beat that was heard last, if `on`
    use(on = false) {
        const beat = on && this.beat > 0 ? [`seek ${this.beat}`] : [];
        this.typed();
        this.load(this.journal.name, bytesOf.encode($("p-text").value), true, beat);
    }

    // Changes the piece on the stand where it is seen, from what it was before all changes if it is still what they
    // have led to, so that undo goes back to that. What has begun here goes on after the page's end.
    edit() {
        const { journal, name } = this,
            text = $("p-text").value;
        if (!this.ready) return;
        this.worker?.postMessage({ runs: false });
        if (journal.base?.name !== name || !(journal.base.open || journal.base.led === text))
            journal.base = { name, bytes: lettersOf(text ? bytesOf.encode(text) : this.bytes) };
        ((journal.base.open = this.edits = true), this.remember());
        const all = new Map([...this.texts, [name, bytesFrom(journal.base.bytes)]]);
        this.on.edit(() => new Channel(this.module ?? this.wasm, [...all], name, () => this.lose()));
    }

    // and comes back with the score
    edited(bytes) {
        const { base, text } = this.journal;
        ((this.edits = base.open = false), this.worker?.postMessage({ runs: true }));
        if (bytes) base.led = text[base.name] = new TextDecoder().decode(bytes);
        this.remember();
        if (bytes) this.load(base.name, bytes);
    }

    forgetChanges() {
        const text = this.texts.get(this.name);
        delete this.journal.text[this.name];
        this.remember();
        if (text) this.load(this.name, text);
    }

    // the text of what is on the stand; "" of what is no text
    write(bytes) {
        const text = bytes && !bytes.includes(0) ? new TextDecoder().decode(bytes) : "";
        $("p-text").value = text;
        $("p-sheet").hidden = !!bytes && !text;
    }

    // the device is open: sound goes from the Worker to the audio thread, past this page
    async listen() {
        const { worker } = this;
        if (this.listens || !worker || this.sound.context?.state === "closed") return;
        this.listens = true;
        this.on.hold(true);
        const port = await this.liveSound.feed("page").catch(error => this.tell(`no sound: ${error.message}`, true));
        this.on.hold(false);
        this.listens = !!port;
        if (port) worker.postMessage({ port }, [port]);
    }

    // the Worker that has loaded a piece is the performer from now on
    async takeOver({ worker }) {
        this.worker?.terminate();
        Object.assign(this, { worker, coming: null, listens: false });
        if (this.sound.context) await this.listen();
        worker.postMessage({ runs: !this.edits });
    }

    // --- what the Worker tells

    hear({ frame, loaded, failed, line, saved, bytes, unread, begins }, from) {
        if (unread) ((this.module = null), this.send(from)); // a browser that hands no module on
        else if (begins) this.on.prepare(); // while it loads
        else if (frame) readFrame(frame, this.handlers);
        else if (saved) (this.texts.set(saved, bytes), this.save(saved, bytes));
        else if (loaded !== undefined) (this.takeOver(from), this.fresh(from));
        else if (line !== undefined) this.answered(line, failed);
        else if (failed) {
            const { name } = from,
                loads = from === this.coming;
            if (loads) (from.worker.terminate(), (this.coming = null));
            this.failed(loads && !failed.startsWith(name) ? `${name}: ${failed}` : failed);
        }
    }

    get handlers() {
        const on = this.on.frame;
        return {
            ...on,
            event: (event, time) => {
                if (event.event === "beat") this.beat = event.beat;
                if (event.event === "done") this.playing(false);
                else if (event.event === "line" || event.event === "note") this.tell(event.text);
                else if (event.event === "missed" || event.event === "refused") this.tell(event.text, true);
                else on.event(event, time);
            },
        };
    }

    // what was there goes on; at first there is nothing yet, and a text that cannot be played waits to be mended
    failed(why) {
        this.tell(why, true);
        if (this.ready || this.draft === undefined || this.mends) return;
        this.mends = true;
        this.load(this.pieces[0] ?? "");
    }

    fresh({ name: loaded, bytes, play }) {
        const name = this.draft === undefined ? loaded : this.journal.name; // a draft keeps its name
        ((this.name = name), (this.ready = true), (this.names = ""), (this.bytes = bytes), (this.beat = 0));
        $("p-drum").replaceChildren();
        this.on.fresh();
        this.write(this.draft === undefined ? this.bytes : bytesOf.encode(this.draft));
        const tempo = /^\s*tempo\s+([0-9.]+)/m.exec($("p-text").value);
        $("p-tempo").value = tempo ? tempo[1] : 100;
        this.draft = undefined;
        if (!this.pieces.includes(name) && $("p-text").value) this.typed();
        this.playing(!!play);
        $("p-piece").value = this.pieces.includes(name) ? name : "";
        $("p-piece").options[0].text = this.pieces.includes(name) || !name ? "a piece" : name;
        if (this.resumes) this.edit();
        this.resumes = false;
        this.tell(loaded ? `${loaded} is on the stand` : "a performer without a score");
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
        this.said = [...this.said, { text, wrong }].slice(-SAID);
        this.outside?.({ text, wrong });
        while (log.children.length > SAID) log.firstChild.remove();
        log.scrollTop = log.scrollHeight;
        if (wrong) $("perform").scrollTop = $("perform").scrollHeight; // where the answers are
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
        $("p-play").textContent = yes ? "■ stop" : "▶ play";
        $("p-play").setAttribute("aria-pressed", yes);
    }

    // --- what the user does

    say(line) {
        this.worker?.postMessage({ say: line.trim().replace(/;$/, "") });
    }

    // a piece of the page, or a file; `play`: at once, after these commands
    load(name, bytes = null, play = false, first = []) {
        if (bytes && !this.texts.has(name)) this.texts.set(name, bytes);
        bytes ??= this.texts.get(name);
        this.coming?.worker.terminate(); // the newest is meant
        const worker = new Worker(this.address),
            from = (this.coming = { worker, name, bytes, play, then: play ? [...first, "play"] : [] });
        worker.onmessage = e => this.hear(e.data, from);
        worker.onerror = e => this.hear({ failed: e.message }, from);
        this.send(from);
        setTimeout(() => from === this.coming && this.tell(`${name} is being prepared`), PREPARED);
    }

    send({ worker, name, bytes, then }) {
        const { module, wasm, texts } = this;
        worker.postMessage({ begin: { module, wasm: module ? null : wasm, files: [...texts], rate: RATE } });
        worker.postMessage({ load: { name, bytes, then } });
    }

    // as it was changed here, if it was
    choose(name) {
        const changed = this.journal.text[name];
        ((this.journal.name = name), this.remember());
        this.load(name, typeof changed === "string" ? bytesOf.encode(changed) : null, true);
    }

    open(file) {
        return this.read(file).catch(error => this.tell(`${file.name}: ${error.message}`, true));
    }

    async read(file) {
        if (/\.himc$/i.test(file.name)) return this.on.scene(file);
        const bytes = new Uint8Array(await file.arrayBuffer()),
            name = file.name.split("/").pop();
        this.texts.delete(name);
        this.load(name, bytes, true);
    }

    toggle() {
        if (this.ready) this.say(this.plays ? "stop" : "play");
    }

    // x and y on the head (m)
    hit(hand, dynamic = Number($("p-dynamic").value), spot = "", drum = $("p-drum").value) {
        this.say(`hit ${hand} legato ${dynamic.toFixed(3)} ${spot} ${drum}`.replace(/ +/g, " "));
    }

    press(e) {
        if (this.on.plays()) return;
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
        const hand = HITS[e.key?.toLowerCase()];
        if (this.on.plays() || e.ctrlKey || e.metaKey || e.altKey || e.repeat || /^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName)) return;
        if (hand) this.hit(hand);
        else if (e.key === " " && !/^(BUTTON|SUMMARY)$/.test(e.target.tagName)) this.toggle();
        else return;
        e.preventDefault();
        e.stopImmediatePropagation();
    }

    paste(e) {
        const files = [...(e.clipboardData?.files ?? [])],
            text = e.clipboardData?.getData("text");
        if (/^(INPUT|TEXTAREA)$/.test(e.target.tagName)) return;
        if (files.length) files.forEach(file => this.open(file));
        else if (text) this.load("pasted.txt", bytesOf.encode(text), true);
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
        const { bytes } = this,
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
        $("p-more").open = this.on.wide();
        $("p-piece").append(new Option("a piece", ""), ...this.pieces.map(name => new Option(name, name)));
        $("p-piece").onchange = e => e.target.value && this.choose(e.target.value);
        click("p-play", () => this.toggle());
        click("p-open", () => $("p-file").click());
        click("p-edit", () => this.edit());
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
        $("p-text").oninput = () => this.typed();
        $("p-text").onkeydown = e => e.key === "Enter" && (e.ctrlKey || e.metaKey) && (e.preventDefault(), this.use());
        click("p-use", () => this.use());
        click("p-here", () => this.use(true));
        click("p-undo", () => this.forgetChanges());
        $("p-form").onsubmit = e => (e.preventDefault(), this.sayLine());
        $("p-line").onkeydown = e => this.recall(e);
        click("p-copy", () => navigator.clipboard?.writeText($("p-line").value.replace(/([,;$])/g, "\\$1")));
        $("stage").addEventListener("pointerdown", e => !e.button && this.press(e), true);
        addEventListener("keydown", e => this.key(e), true);
        addEventListener("paste", e => this.paste(e));
        if (this.embedded) this.embed();
    }

    // in another page, which sends { himc: "a command" } or { himc: { name, score } } and hears what is told here
    embed() {
        document.body.classList.add("bare");
        if (parent === window) return;
        addEventListener("message", e => {
            const what = e.source === parent ? e.data?.himc : null;
            if (typeof what === "string") this.say(what);
            else if (typeof what?.score === "string") this.load(String(what.name ?? "score.txt"), bytesOf.encode(what.score));
        });
        this.outside = text => parent.postMessage({ himc: text }, "*");
    }

    sayLine() {
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
