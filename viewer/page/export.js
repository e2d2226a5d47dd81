// Files made of a playback: a film, a still, the moving figure. For the page's buttons, and for
// `himc film`, which starts one here and takes it in pieces.
import { makeFilm, prepare } from "./film.js";
import { makeGltf } from "./gltf.js";
import { save } from "./record.js";

const PIECE = 3 << 19; // bytes handed over at once, a multiple of 3 for base64; chosen

const makers = {
    webm: makeFilm,
    async png(viewer, { at = 0 }) {
        prepare(viewer, at);
        viewer.step(0);
        // in the same task, because later the pixels are gone
        return new Promise(done => viewer.stage.renderer.domElement.toBlob(done, "image/png"));
    },
    async glb(viewer) {
        prepare(viewer, 0);
        viewer.step(0, false);
        const { playback } = viewer,
            { scene } = playback,
            known = [...scene.drums.values()],
            mine = key => p => p.key === key;
        return makeGltf(
            scene,
            [...viewer.performers.values()].find(mine(scene.name)),
            [...viewer.drums.values()].filter(mine(scene.name)),
            (name, time) => playback.head(known.find(drum => drum.name === name), time),
            viewer.exaggeration,
        );
    },
};

export class Exporter {
    constructor(viewer) {
        ((this.viewer = viewer), (this.blob = null), (this.stopped = false));
        ((this.progress = 0), (this.running = false), (this.failed = ""));
    }

    // makes the file and puts the playback back where it was; null if it was stopped
    async make(kind, options, tell = () => {}) {
        const { viewer } = this,
            { playback, view } = viewer;
        if (this.running) throw new Error("one is being made");
        const { at, speed, loop, playing } = playback,
            { lift } = view,
            { held } = viewer; // as in himc film
        ((this.running = true), (this.stopped = false));
        viewer.lift(0); // nothing is written below
        try {
            return await makers[kind](viewer, options, done => {
                ((this.progress = done), tell(done));
                return this.stopped;
            });
        } finally {
            this.running = false;
            viewer.lift(lift);
            if (viewer.held && !held) viewer.resume();
            (playback.setLoop(...(loop ?? [0, 0])), playback.setSpeed(speed), playback.seek(at), playback.play(playing));
        }
    }

    async save(kind, options, tell) {
        const blob = await this.make(kind, options, tell);
        if (blob) save(blob, kind);
    }

    // --- for himc film

    start(kind, options) {
        ((this.blob = null), (this.failed = ""));
        for (const name of ["from", "at"])
            if (options[name] > this.viewer.playback.length)
                return (this.failed = `--${name} ${options[name] / 1000}: the scene ends at ${this.viewer.playback.length / 1000} s`);
        this.make(kind, options).then(
            blob => (this.blob = blob),
            error => (this.failed = error.message || String(error)),
        );
    }

    // after at most `ms`: "0.25", how far it is, "failed WHY", or "done"
    async wait(ms) {
        for (const end = performance.now() + ms; performance.now() < end && !this.blob && !this.failed;)
            await new Promise(done => setTimeout(done, 20));
        return this.failed ? `failed ${this.failed}` : this.blob ? "done" : this.progress.toFixed(3);
    }

    // piece `i` in base64; "" after the last
    async piece(i) {
        const part = this.blob.slice(i * PIECE, (i + 1) * PIECE),
            url = await new Promise(done => {
                const reader = new FileReader();
                reader.onload = () => done(reader.result);
                reader.readAsDataURL(part);
            });
        return part.size ? url.slice(url.indexOf(",") + 1) : "";
    }
}
