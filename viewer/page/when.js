// When a chosen statement happens: its mark on the timeline is dragged, or moved by keys. A stroke
// moves by beats, on a grid; what a take has, by seconds. Times of the scene in seconds.

const GRID = 24, // places in a beat; chosen: halves to eighths, and thirds
    FINE = 1000, // in a second of a take
    STEP = [1 / 8, 0.024], // of a key: beats, seconds of a take; a third of it with shift
    KEYS = { ",": -1, ".": 1, "<": -1 / 3, ">": 1 / 3 },
    SOON = 400; // the last key is waited for (ms); chosen: between two presses

// the statement's words with another time, which follows the name, or a nudge's name and hand
function retimed(words, value) {
    const all = words.split(" ");
    all[all[0] === "nudge" ? 2 : 1] = String(value);
    return all.join(" ");
}

export class When {
    // `editor` has chosen, piece, pushes, on and send()
    constructor(editor) {
        ((this.editor = editor), (this.to = null));
        addEventListener("keydown", e => this.key(e));
    }

    get take() {
        return this.editor.piece.text.take;
    }

    // what its mark on the timeline says (time in ms); null without a statement
    get mark() {
        const c = this.editor.chosen;
        if (!c?.statement || !this.editor.piece.live) return null;
        const name = this.take ? `${this.value().toFixed(3)} s` : `beat ${+this.value().toFixed(3)}`;
        return { time: 1000 * (this.to ?? c.time), from: 1000 * c.time, moves: this.to !== null, hand: c.hand, name };
    }

    // the beat, or the second of the take, with the mark at `to` (s)
    value(to = this.to) {
        const { chosen, pushes } = this.editor,
            s = chosen.statement,
            from = pushes.beatAt(chosen.time),
            was = s.beat ?? s.at ?? from,
            steps = this.take ? FINE : GRID;
        if (to === null) return was;
        return Math.max(0, Math.round((was + pushes.beatAt(to) - from) * steps) / steps);
    }

    // shows the mark there (s)
    move(time) {
        this.editor.pause();
        this.to = Math.min(this.editor.piece.scene.end, Math.max(0, time));
    }

    // leaves it where it was
    stay() {
        this.to = null;
    }

    // says so to the program
    drop() {
        const { chosen } = this.editor,
            { to } = this;
        if (to === null || !chosen?.statement) return;
        this.to = null;
        if (Math.abs(to - chosen.time) < 1e-3) return void (this.editor.played = false);
        this.editor.build(() => {
            const s = chosen.statement,
                value = +this.value(to).toFixed(4);
            this.editor.send(s.index, retimed(s.words, value), s.beat === undefined ? { at: value } : { beat: value }, to);
        });
    }

    key(e) {
        const { chosen, pushes } = this.editor;
        if (!KEYS[e.key] || !(chosen?.statement || chosen?.take) || e.ctrlKey || e.metaKey || e.altKey) return;
        if (["INPUT", "SELECT"].includes(e.target.tagName) || !this.editor.able()) return;
        e.preventDefault();
        const to = pushes.timeAt(pushes.beatAt(this.to ?? chosen.time) + KEYS[e.key] * STEP[this.take ? 1 : 0]);
        // a point of a path that is not nudged yet: the next one of it
        if (!chosen.statement) return this.editor.choose({ take: true, hand: chosen.hand, time: Math.min(this.editor.piece.scene.end, Math.max(0, to)) });
        this.move(to);
        clearTimeout(this.timer);
        this.timer = setTimeout(() => this.drop(), SOON);
    }
}
