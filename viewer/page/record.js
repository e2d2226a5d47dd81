// Saves the next frame as a picture, or the coming frames as a film.
function save(blob, suffix) {
    const link = document.createElement("a"),
        stamp = new Date().toISOString().slice(0, 19).replace(/[:T]/g, "-");
    link.href = URL.createObjectURL(blob);
    link.download = `himc-${stamp}.${suffix}`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export class Recorder {
    constructor(canvas) {
        this.canvas = canvas;
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
        const types = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"];
        const type = types.find(t => window.MediaRecorder && MediaRecorder.isTypeSupported(t)),
            parts = [];
        if (!type) throw new Error("this browser cannot record films");
        this.film = new MediaRecorder(this.canvas.captureStream(60), {
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
