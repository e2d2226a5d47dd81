// Saves the next frame as a picture, or the coming frames as a film.
export function save(blob, suffix) {
    const link = document.createElement("a"),
        stamp = new Date().toISOString().slice(0, 19).replace(/[:T]/g, "-");
    link.href = URL.createObjectURL(blob);
    link.download = `himc-${stamp}.${suffix}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export class Recorder {
    // `sound` goes into the film, if it is on
    constructor(canvas, sound) {
        ((this.canvas = canvas), (this.sound = sound));
        this.filmed = 0; // of the film so far (bytes)
    }

    picture() {
        this.wanted = true;
    }

    // called right after a frame is drawn: later its pixels are gone
    drawn() {
        if (!this.wanted) return;
        this.wanted = false;
        this.canvas.toBlob(blob => save(blob, "png"), "image/png");
    }

    get filming() {
        return !!this.film;
    }

    toggleFilm() {
        if (this.film) {
            this.film.stop();
            return;
        }
        const types = ["video/webm;codecs=vp9,opus", "video/webm;codecs=vp8,opus", "video/webm", "video/mp4"];
        const type = types.find(t => window.MediaRecorder && MediaRecorder.isTypeSupported(t)),
            parts = [];
        if (!type) throw new Error("this browser cannot record films");
        const stream = this.canvas.captureStream(60);
        this.sound.tracks().forEach(track => stream.addTrack(track));
        this.film = new MediaRecorder(stream, {
            mimeType: type,
            videoBitsPerSecond: 12e6,
        });
        this.filmed = 0;
        this.film.ondataavailable = e => {
            parts.push(e.data);
            this.filmed += e.data.size;
        };
        this.film.onstop = () => {
            save(new Blob(parts, { type }), type.includes("mp4") ? "mp4" : "webm");
            this.film = null;
        };
        this.film.start(500);
    }
}
