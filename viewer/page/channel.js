// The channel to a performer that edits inside this page (workshop.js), as piece.js uses the WebSocket to
// himc-viewer. It keeps the journals of `himc edit` in the browser's storage, and ends when another tab edits.
const TAKEN = 4001, // as viewer/channel.c
    JOURNAL = "himc-edit/", // begins the key of a journal
    EDITS = "himc-edits", // key: which tab edits
    HEAD = 72, // of a chunk `file`, and the name in it (bytes)
    LARGEST = 1 << 20; // of a journal that this page takes over; chosen

const storage = use => {
    try {
        return use(localStorage);
    } catch {
        return null;
    }
};

const journals = () =>
    storage(all => Object.keys(all).filter(key => key.startsWith(JOURNAL) && all[key].length < LARGEST).map(key => [key.slice(JOURNAL.length), all[key]])) ?? [];

export class Channel {
    // files: [name, bytes] of all that a score may name; `name` is the one to edit. `unkept` is called if the storage refuses
    constructor(wasm, files, name, unkept) {
        const scripts = ["worker.js", "workshop.js"].map(one => window.himcScripts.get(one)),
            address = URL.createObjectURL(new Blob([`${scripts[0]};onmessage = null;${scripts[1]}`], { type: "text/javascript" }));
        Object.assign(this, { readyState: WebSocket.OPEN, unkept, mine: `${name} ${Math.random()}`, text: null });
        storage(all => all.setItem(EDITS, this.mine));
        this.heard = e => e.key === EDITS && e.newValue?.startsWith(`${name} `) && this.end(TAKEN);
        addEventListener("storage", this.heard);
        this.worker = new Worker(address);
        this.worker.onmessage = e => this.hear(e.data);
        this.worker.onerror = e => this.end(0, e.message);
        const kept = journals().map(([file, text]) => [file, new TextEncoder().encode(text)]);
        this.worker.postMessage({ begin: { wasm, files: [...files, ...kept], name } });
        queueMicrotask(() => this.onopen?.());
    }

    send(line) {
        this.worker.postMessage({ line });
    }

    // a stroke, its time (s) and hand, has been chosen and may be changed
    look(...stroke) {
        this.worker.postMessage({ look: stroke });
    }

    hear({ bytes, written, ended }) {
        if (ended) return this.end(0, ended);
        if (written) return this.keep(written);
        if (this.text && new TextDecoder().decode(bytes.subarray(0, 4)) === "file") return this.text(bytes.slice(HEAD));
        this.onmessage?.({ data: bytes.buffer });
    }

    keep({ name, text }) {
        const done = storage(all => (text === null ? all.removeItem(JOURNAL + name) : all.setItem(JOURNAL + name, text), true));
        if (!done) this.unkept();
    }

    // the text as it is now; then the channel is at its end
    async leave() {
        if (this.readyState !== WebSocket.OPEN) return null;
        this.onmessage = this.onclose = null;
        const bytes = await new Promise(done => {
            ((this.text = done), (this.onclose = () => done(null)));
            this.send("save");
        });
        this.end(0);
        return bytes;
    }

    close() {
        this.end(0);
    }

    end(code, reason = "") {
        if (this.readyState === WebSocket.CLOSED) return;
        this.readyState = WebSocket.CLOSED;
        removeEventListener("storage", this.heard);
        this.worker.terminate();
        this.onclose?.({ code, reason });
    }
}
