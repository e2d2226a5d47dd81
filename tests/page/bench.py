"""What the page needs on this machine: until it is there, from the click and from an edit to the sound, speed, misses.

bench.py PAGE.html [SECONDS]    the last: how long tide is played with its picture
"""

import os
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
EDITS = 12  # of strokes all over tide, each half a second after it was chosen
CHOOSE = """
const { piece } = viewer.editor, { strikes } = piece.scene;
viewer.playback.play(false);
viewer.editor.choose(strikes[Math.floor(arguments[0] * strikes.length)]);
"""
CHANGE = """
viewer.playback.play(true);
viewer.editor.heard.length = 0;
viewer.editor.commit({ dynamic: arguments[0] });
"""


def renderers():
    """Numbers of the processes that have pages."""
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/cmdline", "rb") as file:
                if b"--type=renderer" in file.read():
                    yield pid
        except OSError:  # it has just ended
            pass


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
    browser.run("document.getElementById('p-edit').click()")
    took = []
    for edit in range(EDITS):
        browser.wait("return viewer.editor?.piece.over", 120)
        browser.run(CHOOSE, (0.5 + 7 * edit) / EDITS % 1)
        time.sleep(0.5)
        browser.run(CHANGE, (0.3 + 0.618 * edit) % 1)
        browser.wait("return viewer.editor.heard.length")
        took.append(browser.run("return viewer.editor.heard[0]") / 1000)
    took.sort()
    print(f"tide edited, {EDITS} times: heard after {took[EDITS // 2]:.2f} s (median), {took[0]:.2f} to {took[-1]:.2f}", end=", ")
    memory = sum(int(line.split()[1]) for pid in renderers() for line in open(f"/proc/{pid}/smaps_rollup") if line.startswith("Pss:"))
    print(f"the page has {memory / 1024:.0f} MB")
    browser.run("viewer.editor.piece.leave(); viewer.held = true; viewer.studio.worker.terminate()")
    with open("tests/page/hash.js") as file:
        code = file.read()
    for name in ("improvisation.txt", "tide.txt"):
        got = browser.run(SPEED, name, code)
        print(f"{name}: {got['speed']:.1f} x real time, {got['memory']} MB")
finally:
    browser.close()
