// Appended to viewer/page/worker.js and workshop.js by the tests: edits a piece as a page does. Returns what was
// heard in the end and what is heard of the same text from its start, as hashes; and how long edits took.
function editsOf(module, name, bytes, edits, seed) {
    const sum = parts => parts.reduce((all, part) => part.reduce((s, b) => Math.imul(s ^ b, 16777619), all), 2166136261) >>> 0;
    const listen = () => {
        const one = { pcm: [], events: [], files: [], kept: new Map(), cut: 0 };
        one.shop = new Workshop(
            module,
            [[name, bytes]],
            all => {
                const kind = text.decode(all.subarray(0, 4)),
                    body = all.subarray(8);
                if (kind === "from") one.pcm.length = one.cut = Math.round(new DataView(all.buffer).getFloat64(8, true) / CELL);
                else if (kind === "pcm ") one.pcm.push(body.slice(4)); // without the number of its first sample
                else if (kind === "edit") one.events.push(JSON.parse(text.decode(body)));
                else if (kind === "file") one.files.push(text.decode(body.subarray(64)));
            },
            (file, bytes) => (bytes ? one.kept.set(file, bytes) : one.kept.delete(file)),
        );
        one.run = until => {
            while (one.shop.busy && !until?.()) one.shop.work();
            return one;
        };
        one.says = line => {
            one.shop.line(line);
            return one;
        };
        return one;
    };
    const random = () => ((seed = Math.imul(seed, 1103515245) + 12345), ((seed >>> 8) & 0xffff) / 65536);
    const a = listen(),
        took = [];
    a.shop.open(name);
    a.run();
    const first = sum(a.pcm),
        length = a.pcm.length;
    let chosen = null; // changed once more: what is played for it while it is chosen must not be heard
    const change = (wholly = false) => {
        const { statements } = a.events.findLast(e => e.event === "text"),
            strokes = statements.filter(s => s.words.trim().startsWith("stroke ")),
            { index, words, hand } = (random() < 0.3 && strokes.find(s => s.index === chosen?.index)) || strokes[Math.floor(random() * strokes.length)],
            parts = words.trim().split(/\s+/);
        if (index === chosen?.index) {
            a.run().shop.look(chosen.time, { left: 0, right: 1 }[hand]);
            a.run(() => random() < 0.01);
        }
        const began = performance.now();
        if (random() < 0.2) a.says(random() < 0.7 ? "undo" : "redo");
        else a.says(`set ${index} ${[...parts.slice(0, 4), random().toFixed(2), ...parts.slice(5)].join(" ")}`);
        const before = a.events.length;
        a.run(() => a.events.length > before); // the text has changed
        if (a.events[a.events.length - 1].event !== "text") return;
        // until so much is there that the page plays from before the stroke (edit.js: BEFORE, LEAD)
        let enough = Infinity;
        a.run(() => {
            if (!a.shop.order && a.shop.focus && enough === Infinity) {
                enough = (a.shop.focus - 0.7 + 0.3) / CELL;
                chosen = { index, time: a.shop.focus };
            }
            return a.pcm.length >= enough;
        });
        took.push(performance.now() - began);
        if (wholly) a.run();
    };
    for (let i = 0; i < edits; i++) change(i === edits - 1);
    a.says("save").run();
    const memory = a.shop.player.files.memory.buffer.byteLength,
        size = { memory: memory >> 20, copies: a.shop.copies.list.length, differ: a.shop.copies.size >> 20 },
        edited = sum(a.pcm),
        events = a.events.filter(e => e.event === "refused" || e.event === "failed");
    // the text that was saved, from its start; and, undone to the last, the first text
    bytes = bytesOf.encode(a.files[a.files.length - 1]);
    const b = listen();
    b.shop.open(name);
    b.run();
    a.says("revert").run();
    took.sort((x, y) => x - y);
    return {
        first,
        edited,
        fresh: sum(b.pcm),
        reverted: sum(a.pcm),
        seconds: length * CELL,
        took: took.map(Math.round),
        size,
        events,
    };
}
