// Everything written over the stage: buttons, numbers, and the running score of the played strokes.
const $ = id => document.getElementById(id);
const short = value => (typeof value === "number" ? +value.toPrecision(4) : value);
const STATUS_SHOWN = ["load", "sound", "physics", "task", "strokes", "played", "recoveries"];
const STATUS_KEPT = 16; // as many performers as himc-viewer keeps
const SPAN = 8000; // of the running score (ms); chosen: two bars at 60 beats a minute
const NOTE_TIME = 6000; // a message stays (ms); chosen: long enough to read a line
const LOUDEST = 0.004, // full deflection of the level, largest displacement (m); chosen
    STRONGEST = 150; // tallest note of the running score (N); chosen: a forte stroke
const nuanceColor = {
    legato: "#8fd0ff",
    tenuto: "#b7e08a",
    accent: "#ff9a6a",
    "vertical-accent": "#ff6f8e",
    staccato: "#ffd76a",
};

export class Panel {
    constructor(actions) {
        ((this.strikes = []), (this.beats = []), (this.status = new Map()), (this.bridge = {}));
        ((this.beat = null), (this.level = 0), (this.peak = 0), (this.count = 0));
        ((this.strip = $("strip")), (this.ink = this.strip.getContext("2d")));
        for (const button of document.querySelectorAll("[data-camera]"))
            button.onclick = () => actions.camera(button.dataset.camera);
        for (const box of document.querySelectorAll("[data-show]"))
            box.onclick = () =>
                actions.show(box.dataset.show, box.getAttribute("aria-pressed") !== "true");
        $("exaggeration").oninput = e =>
            actions.exaggerate(Math.round(10 ** Number(e.target.value)));
        $("picture").onclick = actions.picture;
        $("film").onclick = actions.film;
        $("more").onclick = () => document.body.classList.toggle("open");
        $("pause").onclick = actions.pause;
        $("seek").oninput = e => actions.seek(Number(e.target.value));
        addEventListener("keydown", e => {
            const key = { 1: "stage", 2: "front", 3: "side", 4: "top", 5: "eye" }[e.key];
            if (e.ctrlKey || e.metaKey || e.altKey) return;
            if (key) actions.camera(key);
            else if (e.key === "h") document.body.classList.toggle("bare");
            else if (e.key === "p") actions.picture();
            else if (e.key === "r") actions.film();
            else if (e.key === " " && e.target === document.body)
                (actions.pause(), e.preventDefault());
        });
    }

    connected(yes) {
        document.body.classList.toggle("lost", !yes);
    }

    note(text) {
        $("note").textContent = text;
        $("note").classList.add("on");
        clearTimeout(this.noteTimer);
        this.noteTimer = setTimeout(() => $("note").classList.remove("on"), NOTE_TIME);
    }

    camera(name) {
        for (const b of document.querySelectorAll("[data-camera]"))
            b.setAttribute("aria-pressed", b.dataset.camera === name);
    }

    shown(shown) {
        for (const b of document.querySelectorAll("[data-show]"))
            b.setAttribute("aria-pressed", !!shown[b.dataset.show]);
    }

    exaggeration(times) {
        $("exaggeration").value = Math.log10(times);
        $("times").textContent = `×${times}`;
    }

    filming(yes) {
        $("film").setAttribute("aria-pressed", yes);
    }

    strike(strike) {
        this.strikes.push(strike);
        this.count++;
        if (this.strikes.length > 600) this.strikes.splice(0, 200);
        this.peak = strike.force;
    }

    hearBeat(beat, now) {
        this.beat = beat;
        this.beats.push({ beat, now });
        if (this.beats.length > 64) this.beats.shift();
    }

    hearStatus(from, values) {
        const all = [];
        for (let i = 0; i + 1 < values.length; i += 2)
            all.push([values[i], `${values[i]} ${short(values[i + 1])}`]);
        const chosen = all.filter(([name]) => STATUS_SHOWN.includes(name));
        this.status.delete(from); // so that the newest is the last
        if (this.status.size >= STATUS_KEPT) this.status.delete(this.status.keys().next().value);
        this.status.set(from, (chosen.length ? chosen : all).map(pair => pair[1]).join("   "));
    }

    // the numbers; called a few times a second
    write(performers, numbers, now) {
        const here = performers.filter(p => p.present(now));
        document.body.classList.toggle("empty", !here.length);
        $("who").textContent = here.map(p => `${p.key}  ${p.rate.toFixed(0)} Hz`).join("\n");
        $("beat").textContent = this.beat === null ? "" : `beat ${this.beat}`;
        $("force").textContent = this.count ? `${this.peak.toFixed(0)} N` : "";
        const b = this.bridge,
            late = numbers.latency;
        $("rates").textContent = [
            `${numbers.fps.toFixed(0)} frames/s`,
            `${numbers.script.toFixed(1)} ms script`,
            `${this.count} strikes`,
            ...(late === null ? [] : [`${late.toFixed(0)} ms late`]),
        ].join(" · ");
        $("bridge").textContent =
            b.packets === undefined
                ? ""
                : [
                      `bridge ${(100 * b.load).toFixed(1)} % load`,
                      `${b.rate === undefined ? "–" : b.rate} packets/s`,
                      `${b.malformed} malformed`,
                      `${b.unknown} unknown`,
                  ].join(" · ");
        $("status").textContent = [...this.status.values()].slice(-2).join("\n");
    }

    hearBridge(event, now) {
        const old = this.bridge;
        this.bridge = { ...event, now };
        if (old.now < now)
            this.bridge.rate = Math.round((1000 * (event.packets - old.packets)) / (now - old.now));
    }

    playing(motion) {
        document.body.classList.toggle("playback", !!motion);
        if (!motion) return;
        $("seek").max = motion.length;
        $("seek").value = motion.at;
        $("pause").textContent = motion.playing ? "❚❚" : "▶";
        $("clock").textContent = `${(motion.at / 1000).toFixed(1)} s`;
    }

    // the level (largest displacement of all heads, m; three decades) and the running score
    draw(excursion, now) {
        const c = this.ink,
            ratio = Math.min(devicePixelRatio || 1, 2),
            w = this.strip.clientWidth,
            h = this.strip.clientHeight;
        if (this.strip.width !== Math.round(w * ratio))
            ((this.strip.width = Math.round(w * ratio)),
                (this.strip.height = Math.round(h * ratio)));
        this.level = Math.max(excursion, this.level * 0.93);
        const decades = 1 + Math.log10(Math.max(1e-9, this.level / LOUDEST)) / 3;
        $("level").style.transform = `scaleX(${Math.min(1, Math.max(0, decades))})`;
        c.setTransform(ratio, 0, 0, ratio, 0, 0);
        c.clearRect(0, 0, w, h);
        const x = t => w - 14 - ((now - t) / SPAN) * (w - 14),
            mid = h / 2;
        c.fillStyle = "rgba(255,255,255,0.10)";
        c.fillRect(0, mid - 0.5, w, 1);
        c.font = "11px system-ui, sans-serif";
        for (const b of this.beats) {
            if (now - b.now > SPAN) continue;
            c.fillStyle = "rgba(255,255,255,0.13)";
            c.fillRect(x(b.now), 2, 1, h - 4);
            c.fillStyle = "rgba(255,255,255,0.45)";
            c.fillText(b.beat, x(b.now) + 3, h - 4);
        }
        for (const s of this.strikes) {
            if (now - s.now > SPAN) continue;
            const tall = 3 + (mid - 6) * Math.min(1, Math.sqrt(s.force / STRONGEST)),
                up = s.hand === "left";
            c.fillStyle = nuanceColor[s.nuance] || "#d8d8e0";
            c.globalAlpha = 1 - 0.65 * ((now - s.now) / SPAN);
            c.fillRect(x(s.now) - 1.5, up ? mid - tall : mid, 3, tall);
            c.beginPath();
            c.arc(x(s.now), up ? mid - tall : mid + tall, 3.2, 0, 7);
            c.fill();
        }
        c.globalAlpha = 1;
        c.fillStyle = "rgba(255,255,255,0.8)";
        c.fillRect(w - 14, 2, 1, h - 4);
        c.fillStyle = "rgba(255,255,255,0.55)";
        (c.fillText("L", 4, mid - 5), c.fillText("R", 4, mid + 13));
    }
}
