// A piece under edit, inside the page: what `himc edit` does in processes (tools/himc/edit.c), done with
// instances of the module. Follows worker.js in a Worker of its own, and in the tests.
//
// One instance has the text. Another plays it, and leaves a copy of its memory behind every second: the last
// copy as a whole, of each earlier one only the pages of 512 bytes in which it differs from the next. After a change
// the last copy whose plan does not rest on it comes back, takes the new strokes in place of the old ones, and plays
// on; if it refuses after all, the one before is asked. So all that follows is, bit by bit, what a playing from the
// start would be. Where memory is short, copies far from the last change go. When a stroke is chosen, and all
// is played, a copy is made from which its change would be heard soonest.
const WORD = 4,
    PAGE = 512 / WORD, // (words)
    BLOCK = 65536 / WORD,
    APART = 1, // (s) of the piece between two copies
    CELL = 0.2, // (s) played at a time
    ROOM = 190 << 20, // of a memory, its last copy and what the others differ in (bytes); chosen: half of what the page has
    FOCUS = 4, // (s) copies get rarer from here on ...
    FAR = 8, // ... to here, where they are three times as far apart
    BACK = 1.6, // (s) so long before a stroke the plan rarely rests on it
    HEADROOM = 2, // (s) a piece may begin so much later than its first beat
    HANDS = [0, 1],
    TEXT = "himc-text"; // PAGE_TEXT of viewer/engine/engine.h

// the memory of an instance as it was
class Copies {
    constructor(memory) {
        ((this.memory = memory), (this.image = new Int32Array(0)));
        this.list = []; // { at, until when each hand's plan rests on strokes (s), pages that the next one has otherwise: where, words }
        this.touched = 0; // where the memory was ever used (words) ...
        this.used = new Set(); // ... and in which blocks
    }

    // of what the copies differ in (bytes)
    get size() {
        return WORD * this.list.reduce((sum, copy) => sum + copy.words.length, 0);
    }

    // the memory as it is now is that at a time
    add(at, rests) {
        const now = new Int32Array(this.memory.buffer),
            last = this.list[this.list.length - 1];
        if (now.length > this.image.length) {
            const { image } = this;
            (this.image = new Int32Array(now.length)).set(image);
        }
        const where = this.differing(now);
        if (last) [last.where, last.words] = [where, pagesOf(this.image, where)];
        else this.touched = where.length * PAGE;
        for (const i of where) (this.image.set(now.subarray(i, i + PAGE), i), this.used.add(i - (i % BLOCK)));
        this.list.push({ at, rests, where: [], words: [] });
    }

    // the pages in which it differs from the last copy; others stay untouched, and, empty, cost nothing
    differing(now) {
        const { image } = this,
            where = [];
        for (let at = 0; at < now.length; at += PAGE) {
            let i = at;
            const end = at + PAGE;
            while (i < end && !((now[i] ^ image[i]) | (now[i + 1] ^ image[i + 1]) | (now[i + 2] ^ image[i + 2]) | (now[i + 3] ^ image[i + 3]))) i += 4;
            if (i < end) where.push(at);
        }
        return Int32Array.from(where);
    }

    // the last copy is the memory again
    restore() {
        const now = new Int32Array(this.memory.buffer),
            { image } = this;
        for (let at = 0; at < now.length; at += BLOCK)
            if (this.used.has(at)) now.set(image.subarray(at, at + BLOCK), at);
            else if (!isZero(now, at)) now.fill(0, at, at + BLOCK);
    }

    // the memory is that of the copy at an index; all copies stay
    visit(index) {
        const now = new Int32Array(this.memory.buffer);
        this.restore();
        for (let k = this.list.length - 2; k >= index; k--) this.list[k].where.forEach((at, n) => now.set(pageOf(this.list[k], n), at));
    }

    // the one before is the last
    drop() {
        this.list.pop();
        const last = this.list[this.list.length - 1];
        if (!last) return;
        last.where.forEach((at, k) => this.image.set(pageOf(last, k), at));
        ((last.where = []), (last.words = []));
    }

    // until there is room, without those whose absence costs least
    thin(room, focus) {
        for (const { list } = this; list.length > 3 && this.size > room;) {
            const cost = i => (list[i + 1].at - list[i - 1].at) / (FOCUS + Math.min(Math.abs(list[i].at - focus), FAR));
            let least = 1;
            for (let i = 2; i < list.length - 1; i++) if (cost(i) < cost(least)) least = i;
            this.join(list[least - 1], list.splice(least, 1)[0]);
        }
    }

    // a copy has otherwise, too, what the one after it had, which is gone
    join(copy, gone) {
        const known = new Set(copy.where),
            more = [...gone.where.keys()].filter(k => !known.has(gone.where[k])),
            own = copy.where.length,
            where = new Int32Array(own + more.length),
            words = new Int32Array(where.length * PAGE);
        (where.set(copy.where), words.set(copy.words));
        where.set(more.map(k => gone.where[k]), own);
        more.forEach((k, n) => words.set(pageOf(gone, k), (own + n) * PAGE));
        Object.assign(copy, { where, words });
    }
}

function isZero(words, at) {
    const end = at + BLOCK;
    while (at < end && !(words[at] | words[at + 1] | words[at + 2] | words[at + 3])) at += 4;
    return at === end;
}

// the n-th that a copy has otherwise
function pageOf(copy, n) {
    return copy.words.subarray(n * PAGE, (n + 1) * PAGE);
}

// one after another
function pagesOf(image, where) {
    const words = new Int32Array(where.length * PAGE);
    where.forEach((at, k) => words.set(image.subarray(at, at + PAGE), k * PAGE));
    return words;
}

// `tell` is given chunks; `written(name, bytes)` what is in a file that has to last, null: nothing
class Workshop {
    constructor(module, files, tell, written) {
        Object.assign(this, { module, files, tell, lines: [], order: null, player: null, copies: null });
        ((this.time = 0), (this.focus = 0), (this.over = true));
        this.chosen = this.ready = null; // a stroke that may be changed; what is played for it
        this.rested = []; // until when each hand's plan rested on strokes, by cells (s)
        this.unheard = false; // what is played goes nowhere
        this.session = this.instance(chunk => this.hear(chunk));
        this.session.files.written = (name, bytes) => name.endsWith(".himc-edit") && written(name, bytes);
    }

    instance(told) {
        const engine = new Engine(this.module, 48000);
        for (const [name, bytes] of this.files) engine.files.bytes.set(name, bytes);
        engine.files.told = chunks(told);
        return engine;
    }

    open(name) {
        this.name = name;
        if (this.ask("page_edit_open", name)) this.line("hello");
    }

    // what the text's instance says; orders to play are for here
    hear(chunk) {
        const view = new DataView(chunk.buffer);
        if (text.decode(chunk.subarray(0, 4)) === "play") this.order = { from: view.getFloat64(8, true), strokes: [16, 24].map(at => view.getFloat64(at, true)), text: chunk.slice(32) };
        else this.tell(chunk);
    }

    line(line) {
        if (!this.ended) this.lines.push(line);
    }

    // a stroke at a time (s) has been chosen
    look(time, hand) {
        this.chosen = { time, hands: HANDS.filter(h => hand === undefined || h === hand) };
    }

    // true if there is something to do
    get busy() {
        return !!this.order || !this.over || this.lines.length > 0 || (this.chosen !== null && !!this.copies);
    }

    // a part of it, some hundredths of a second long
    work() {
        if (this.order) this.begin();
        else if (this.lines.length && this.session.calls.page_edit_proved()) this.obey(this.lines.shift());
        else if (!this.over) this.cell();
        else if (this.chosen !== null) this.prepare();
    }

    obey(line) {
        if (line.startsWith("take ")) this.save(line.slice(5));
        else this.ask("page_edit_line", line);
    }

    // plays the text that was ordered; from a copy, if only strokes have changed
    begin() {
        const { from, strokes, text } = this.order,
            { list } = this.copies ?? { list: [] },
            late = ({ at, rests }) => at > from + HEADROOM || HANDS.some(h => rests[h] > strokes[h]);
        ((this.order = null), (this.played = text), (this.focus = Math.max(0, from)));
        this.takeReady(late);
        for (; from >= 0 && list.length; this.copies.drop()) {
            if (late(list[list.length - 1]) && list.length > 1) continue;
            this.copies.restore();
            this.player.files.bytes.set(TEXT, text);
            const done = this.player.calls.page_piece_exchange();
            if (done === 0) return this.failed();
            if (done > 0) return this.resume();
        }
        this.start(text);
    }

    // plays towards the chosen stroke, unheard, from a copy to where its plan does not rest on it yet
    prepare() {
        const { copies, chosen, player } = this,
            open = rests => chosen.hands.every(h => rests[h] <= chosen.time);
        if (this.ready?.chosen !== chosen) {
            const index = copies.list.findLastIndex(({ at, rests }) => at < chosen.time && open(rests)),
                { at } = copies.list[Math.max(index, 0)],
                cells = this.rested.findLastIndex((rests, cell) => CELL * cell < chosen.time && open(rests)) - Math.round(at / CELL);
            if (index < 0 || cells <= 0) return (this.chosen = null);
            copies.visit(index);
            this.ready = { chosen, at, cells };
            if (at === 0) player.calls.page_piece_start();
        }
        this.unheard = true;
        player.calls.page_piece_cell();
        this.unheard = false;
        this.ready.at += CELL;
        if (--this.ready.cells === 0) this.chosen = null;
    }

    // what is ready, or so far, becomes the last copy, if no stroke has changed on which it rests, and no
    // copy is nearer
    takeReady(late) {
        const { copies, ready } = this;
        this.chosen = this.ready = null;
        if (!ready || late({ at: ready.at, rests: this.rests }) || copies.list.some(copy => copy.at > ready.at && !late(copy))) return;
        while (copies.list[copies.list.length - 1].at > ready.at) copies.drop();
        copies.add(ready.at, this.rests);
    }

    get rests() {
        return HANDS.map(this.player.calls.page_piece_rests_to);
    }

    resume() {
        ((this.time = this.copies.list[this.copies.list.length - 1].at), (this.over = false));
        if (this.time === 0) this.player.calls.page_piece_start();
    }

    start(text) {
        this.player = this.copies = null; // before the next one: they are large
        this.player = this.instance(chunk => this.unheard || this.tell(chunk));
        this.player.files.bytes.set(TEXT, text);
        if (!this.player.call("page_piece_begin", this.name)) return this.failed();
        this.copies = new Copies(this.player.files.memory);
        this.copies.add(0, [0, 0]);
        this.resume();
    }

    failed() {
        this.over = true;
        this.ask("page_edit_hear", `fail${this.player.error}`);
    }

    // the text's instance; once it cannot go on there is nothing to do any more
    ask(call, words) {
        if (this.session.call(call, words)) return true;
        Object.assign(this, { lines: [], order: null, over: true, ended: true });
        return false;
    }

    cell() {
        const { copies, player } = this,
            since = this.time - copies.list[copies.list.length - 1].at,
            back = this.time - this.focus; // before a change is heard: one copy, for the next one there
        this.rested[Math.round(this.time / CELL)] = this.rests;
        if (back > 0 ? since > APART - CELL / 2 : since > 0 && Math.abs(back + BACK) < CELL / 2) {
            copies.add(this.time, this.rests);
            copies.thin(ROOM - 2 * WORD * copies.touched, this.focus);
        }
        this.over = !player.calls.page_piece_cell();
        this.time += CELL;
        this.ask("page_edit_hear", "pcm ");
        if (!this.over || !player.calls.page_piece_end()) return; // which a copy knows nothing of
        this.tell(chunk("over"));
        this.ask("page_edit_hear", "over");
    }

    // the motion as a take, played for it alone
    save(name) {
        const engine = this.instance(() => {});
        engine.files.bytes.set(TEXT, this.played);
        const good = engine.call("page_piece_begin", `${this.name}\n${name}`) && engine.calls.page_piece_start();
        while (good && engine.calls.page_piece_cell());
        if (good && engine.calls.page_piece_end()) this.tell(chunk("file", [...bytesOf.encode(name.padEnd(64, "\0")), ...engine.files.bytes.get(name)]));
        else this.tell(chunk("edit", bytesOf.encode(JSON.stringify({ event: "refused", text: engine.error }))));
    }
}

// calls with whole chunks of what comes in parts
function chunks(use) {
    let rest = new Uint8Array();
    return bytes => {
        const all = new Uint8Array(rest.length + bytes.length);
        (all.set(rest), all.set(bytes, rest.length));
        let at = 0;
        for (let size; at + 8 <= all.length; at += size) {
            size = 8 + new DataView(all.buffer).getUint32(at + 4, true);
            if (at + size > all.length) break;
            use(all.slice(at, at + size));
        }
        rest = all.slice(at);
    };
}

function chunk(kind, bytes = []) {
    const all = new Uint8Array(8 + bytes.length);
    all.set(bytesOf.encode(kind));
    new DataView(all.buffer).setUint32(4, bytes.length, true);
    all.set(bytes, 8);
    return all;
}

// --- in the Worker

if (typeof WorkerGlobalScope !== "undefined" && self instanceof WorkerGlobalScope) {
    let workshop = null,
        runs = false;
    const { port1, port2 } = new MessageChannel(); // gives way to messages
    const guarded = act => {
        try {
            act();
        } catch (error) {
            ((workshop = null), postMessage({ ended: error.message }));
        }
        if (!runs && workshop?.busy) ((runs = true), port1.postMessage(0));
    };
    port2.onmessage = () => ((runs = false), guarded(() => workshop?.busy && workshop.work()));
    onmessage = ({ data: { begin, line, look } }) =>
        guarded(() => {
            if (line !== undefined) return workshop?.line(line);
            if (look !== undefined) return workshop?.look(...look);
            workshop = new Workshop(
                begin.wasm instanceof WebAssembly.Module ? begin.wasm : new WebAssembly.Module(begin.wasm),
                begin.files,
                bytes => postMessage({ bytes }, [bytes.buffer]),
                (name, bytes) => postMessage({ written: { name, text: bytes && text.decode(bytes) } }),
            );
            workshop.open(begin.name);
        });
}
