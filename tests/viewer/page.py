"""The viewer end to end, in a real Chromium.

No test depends on the speed of the machine: each waits for what must come, as long as the browser
answers. What the viewer must do in real time is in realtime.py.
"""

import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time

import report
from bridge import WAIT, osc
from browser import Browser

BUILD = os.environ["HIMC_BUILD"]
VIEWER, MADE = os.path.join(BUILD, "bin/himc-viewer"), os.path.join(BUILD, "tests/viewer")
MOTION, STROKES, EXPECTED = (
    os.path.join(MADE, f) for f in ("motion.csv", "strokes.csv", "expected.txt")
)
# fixed, because the page must find a restarted viewer again; different for each run of this file
HTTP = 20000 + os.getpid() % 20000
OSC, SERVE = HTTP + 1, HTTP + 2
MARKS = 7  # layer of the marks of strikes
browser = bridge = None


def say(port, *packets):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        for packet in packets:
            udp.sendto(packet, ("127.0.0.1", port))


class Started:
    def __init__(self, *command):
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(WAIT)


def viewer(*options):
    started = Started(VIEWER, "--no-browser", "--osc", str(OSC), "--http", str(HTTP), *options)
    started.process.stdout.readline()
    return started


def sender(*options):
    return Started(os.path.join(MADE, "sender"), str(OSC), MOTION, STROKES, *options)


def open_page():
    browser.open(f"http://127.0.0.1:{HTTP}/")
    assert browser.wait("return !!(window.viewer && viewer.stream.connections)")


def draw(yes):
    """Without a graphics card a picture takes 50 to 500 ms, and most tests need none: with False
    frames go on, but the camera sees only the marks of strikes."""
    browser.run("viewer.view.camera.layers.set(arguments[0])", 0 if yes else MARKS)


def expected():
    with open(EXPECTED) as file:
        return [[float(v) for v in line.split()[1:]] for line in file]


def joints_error():
    """Largest distance of a joint or tip in the scene from its place by the library (m)."""
    there = browser.run("return viewer.joints()")
    return (
        max(
            sum((a - b) ** 2 for a, b in zip(p, q)) ** 0.5
            for p, q in zip(there, expected(), strict=True)
        )
        if there
        else 1e9
    )


def settle(limit=0.001):
    end, error = time.time() + WAIT, joints_error()
    while error >= limit:
        assert time.time() < end, f"{1000 * error:.3f} mm"
        time.sleep(0.1)
        error = joints_error()
    return f"{1000 * error:.4f} mm"


def expect(start):
    """Writes the joints at that time of the motion, by the library, into EXPECTED."""
    with sender("--still", "--start", start, "--expect", EXPECTED, "--seconds", "0") as once:
        once.process.wait(WAIT)


def gone():
    assert browser.wait("return !viewer.joints()"), "the performer stays"


# --- one bridge and one page for all of these


def test_page_loads_without_errors():
    open_page()
    browser.wait("return viewer.numbers.render > 0")
    trouble = [line for line in browser.log() if "play.csv" not in line]
    assert not trouble, trouble


def test_pictures_and_films_are_saved():
    home = tempfile.mkdtemp(prefix="himc-saved-")
    browser.downloads(home)
    with sender("--start", "18"):
        assert browser.wait("return viewer.joints()")
        # the cheapest picture: without a graphics card a full one takes half a second
        browser.run("viewer.stage.simplify(4); dispatchEvent(new Event('resize'))")
        browser.run("viewer.actions.picture(); viewer.actions.film(); viewer.scripts.length = 0")
        assert browser.wait("return viewer.scripts.length > 12 && viewer.recorder.filmed > 1000")
        browser.run("viewer.actions.film()")
        end, sizes = time.time() + WAIT, {}
        while time.time() < end and not (sizes.get("png") and sizes.get("webm")):
            time.sleep(0.2)
            sizes = {
                name.split(".")[-1]: os.path.getsize(os.path.join(home, name))
                for name in os.listdir(home)
            }
    heads = {}
    for name in os.listdir(home):
        with open(os.path.join(home, name), "rb") as file:
            heads[name.split(".")[-1]] = file.read(64)
    shutil.rmtree(home)
    assert heads.get("png", b"").startswith(b"\x89PNG"), heads
    assert heads.get("webm", b"").startswith(b"\x1a\x45\xdf\xa3"), heads
    assert b"webm" in heads["webm"] and sizes["webm"] > 1000, sizes
    return f"{sizes['webm'] // 1024} kB of film"


def test_figure_stands_where_the_poses_say_within_1_mm():
    draw(False)
    said = []
    for start in ("3.6", "19.64"):
        expect(start)
        with sender("--still", "--start", start):
            said.append(settle())
    return ", ".join(said)


def test_figure_moves_and_strikes_leave_marks():
    gone()
    with sender("--start", "18"):
        assert browser.wait("return viewer.joints()")
        first = browser.run("return viewer.joints()")
        assert browser.wait("return viewer.marks.shown > 2 && viewer.marks.visible() > 0")
        assert browser.wait(
            "return viewer.joints().some((p, i) =>"
            " Math.hypot(...p.map((v, k) => v - %s[i][k])) > 0.02)" % first
        )
        # the head moves with its modes
        assert browser.wait("return [...viewer.drums.values()].some(d => d.excursion > 1e-5)")
        strike = browser.run(
            "const {hand, force, drum} = viewer.panel.strikes[0]; return {hand, force, drum}"
        )
        assert strike["drum"] == "kettle0" and 1 < strike["force"] < 200


def test_performer_leaves_and_comes_back():
    gone()
    with sender("--still"):
        assert browser.wait(
            "return [...viewer.performers.values()].some(p => p.group.visible)"
        )


def test_camera_and_controls_obey_buttons_and_osc():
    browser.run("document.querySelector('[data-camera=top]').click()")
    assert browser.run("return viewer.view.name") == "top"
    pressed = (
        "return document.querySelector('[data-show=trails]').getAttribute('aria-pressed') === "
    )
    browser.run("document.querySelector('[data-show=trails]').click()")
    assert browser.run(pressed + "'false'")
    say(OSC, osc("/viewer/camera", "eye"), osc("/viewer/show", "trails", 1))
    say(OSC, osc("/viewer/exaggeration", 80.0))
    assert browser.wait("return viewer.view.name === 'eye'")
    assert browser.wait(pressed + "'true'")
    assert browser.wait("return document.body.textContent.includes('80')")
    say(OSC, osc("/viewer/camera", "stage"), osc("/viewer/exaggeration", 25.0))
    assert browser.wait("return viewer.view.name === 'stage'")


def test_eight_performers_are_shown_and_come_and_go():
    gone()
    with sender("--performers", "8", "--start", "10"):
        assert browser.wait(
            "return [...viewer.performers.values()].filter(p => p.group.visible).length === 8"
        )


def test_himc_serve_is_shown_with_drum_strikes_and_status():
    gone()
    command = [os.path.join(BUILD, "bin/himc"), "serve", "patches/improvisation.txt"]
    with Started(*command, "--port", str(SERVE)) as serve:
        serve.process.stdout.readline()
        for what in ("pose", "targets", "strikes", "head"):
            say(SERVE, osc("/himc/subscribe", "127.0.0.1", OSC, what))
        say(SERVE, osc("/himc/play"))
        assert browser.wait("return viewer.joints()"), "no performer"
        assert browser.wait("return viewer.panel.strikes.some(s => s.drum === 'kettle')")
        drum = "[...viewer.drums.values()].find(d => d.name === 'kettle')"
        assert browser.wait(f"return {drum}.excursion > 1e-6"), "the head is still"
        assert browser.wait("return [...viewer.panel.status.values()].some(s => /load/.test(s))")
        assert browser.wait("return viewer.panel.beat !== null"), "no beat"
        counts = browser.wait(
            "return viewer.panel.bridge.packets !== undefined && viewer.panel.bridge"
        )
        assert counts["malformed"] == 0 and counts["unknown"] == 0, counts
        rate = "Math.max(...[...viewer.performers.values()].map(p => p.rate))"
        return f"{browser.run(f'return {rate}'):.1f} poses/s"


def test_page_finds_a_restarted_bridge_again():
    global bridge
    bridge.__exit__()
    before = browser.run("return viewer.stream.connections")
    assert browser.wait("return document.body.classList.contains('lost')")
    bridge = viewer()
    expect("3.6")
    with sender("--still", "--start", "3.6"):
        assert browser.wait(
            f"return viewer.stream.connections > {before}"
            " && !document.body.classList.contains('lost')"
        )
        return settle()


# --- and a second bridge


def test_playback_shows_a_motion_file_as_the_library_does():
    global bridge
    bridge.__exit__()
    bridge = viewer("--play", MOTION)
    open_page()
    draw(False)
    assert browser.wait("return !!viewer.motion")
    for start in ("12.5", "25.9"):
        expect(start)
        browser.run(
            "viewer.motion.playing = false; viewer.motion.seek(1000 * arguments[0])",
            float(start),
        )
        said = settle()
    strikes = browser.run("return viewer.motion.strikes.length")
    with open(STROKES) as file:
        assert strikes == len(file.readlines()) - 1, strikes
    return said


if __name__ == "__main__":
    browser = Browser(480, 480)
    try:
        bridge = viewer()
        code = report.run(
            "tests/viewer/page.py",
            [f for name, f in list(globals().items()) if name.startswith("test_")],
        )
        bridge.__exit__()
    finally:
        browser.close()
    sys.exit(code)
