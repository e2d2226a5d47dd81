"""What the page needs on this machine: until it is there, from the click to the sound, speed, misses.

bench.py PAGE.html [SECONDS]    the last: how long tide is played with its picture
"""

import sys
import time

sys.path.insert(0, "tests/viewer")
from browser import Browser

page, seconds = sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else 20
CLICK = """
const b = document.getElementById("p-play"), began = performance.now();
b.dispatchEvent(new PointerEvent("pointerdown", { bubbles: true }));
b.click();
const look = setInterval(() => {
    const told = viewer.liveSound.nodes.get("page")?.told;
    if (told) window.flows ??= (performance.now() - began) / 1000;
    if (!(told?.peak > 1e-4)) return;
    clearInterval(look);
    window.took = (performance.now() - began) / 1000;
}, 5);
"""
SPEED = """
const name = arguments[0], files = [...himcFiles], source = himcScripts.get("worker.js") + arguments[1],
    worker = new Worker(URL.createObjectURL(new Blob([`${source}
onmessage = e => postMessage(hashOf(new WebAssembly.Module(e.data[0]), e.data[1], e.data[2]));`])));
return new Promise(done => {
    worker.onmessage = e => done(e.data);
    worker.postMessage([files[0][1], name, files.find(([n]) => n === name)[1]]);
});
"""
browser = Browser(1280, 720)
try:
    began = time.time()
    browser.open(f"file://{page}")
    browser.wait("return !!(window.viewer && viewer.studio?.ready)")
    print(f"page there after {time.time() - began:.2f} s", end=", ")
    browser.wait("return viewer.numbers.render > 0 && viewer.joints()")
    print(f"the performer in the picture after {time.time() - began:.2f} s")
    browser.run(CLICK)
    print(f"click to first stroke heard {browser.wait('return window.took'):.2f} s", end=", ")
    print(f"of which the sound opens in {browser.run('return window.flows'):.2f} s; the performer then lifts a stick")
    browser.run("viewer.studio.choose('tide.txt')")
    browser.wait("return viewer.studio.name === 'tide.txt' && viewer.studio.plays")
    time.sleep(1)
    told = "return viewer.liveSound.nodes.get('page').told.missed"
    before = browser.run(told)
    time.sleep(seconds)
    stats = browser.run("const s = viewer.sound.context.playbackStats; return s ? s.underrunEvents : null")
    print(f"tide with picture, {seconds:g} s: buffer empty {browser.run(told) - before} times, device under-runs {stats}")
    print(f"frames a second {browser.run('return viewer.numbers.fps'):.1f}")
    browser.run("viewer.held = true; viewer.studio.worker.terminate()")
    with open("tests/page/hash.js") as file:
        code = file.read()
    for name in ("improvisation.txt", "tide.txt"):
        got = browser.run(SPEED, name, code)
        print(f"{name}: {got['speed']:.1f} x real time, {got['memory']} MB")
finally:
    browser.close()
