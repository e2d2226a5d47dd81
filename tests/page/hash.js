// Appended to viewer/page/worker.js by the tests: plays a piece as tests/page/play.c does, and tells the same.
function hashOf(module, name, bytes) {
    const engine = new Engine(module, 48000),
        cell = 9600;
    if (bytes) engine.files.bytes.set(name, bytes);
    const failed = engine.load(name) || engine.say("play");
    if (failed) return failed;
    let [exact, coarse, samples, strikes] = [2166136261, 2166136261, 0, 0];
    const began = performance.now();
    do {
        const sound = engine.play(cell, 0),
            words = new Uint32Array(sound.buffer);
        for (let i = 0; i < words.length; i++) {
            exact = Math.imul(exact ^ words[i], 16777619);
            coarse = Math.imul(coarse ^ Math.floor(32767 * Math.max(-1, Math.min(1, sound[i])) + 0.5), 16777619);
        }
        samples += cell;
        strikes += text.decode(engine.frame()).split('"event":"strike"').length - 1;
    } while (!engine.calls.page_is_over());
    const hex = sum => (sum >>> 0).toString(16).padStart(8, "0");
    return {
        line: `${samples} ${strikes} ${hex(exact)} ${hex(coarse)}`,
        speed: samples / 48 / (performance.now() - began),
        memory: engine.files.memory.buffer.byteLength >> 20,
    };
}
