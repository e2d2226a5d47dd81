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


def test_hostile_senders_leave_the_page_as_it_was():
    """Names without end, words of JavaScript, numbers beyond all bounds."""
    gone()
    browser.log()
    draw(False)
    words = ["constructor", "__proto__", "toString", "<b>", "", "-1", "e" * 31]
    senders = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(40)]
    strikes = browser.run("return viewer.panel.count")
    for i in range(400):
        huge = (1e30, -1e30, 0.0, 1e-30)[i % 4]
        name, to = f"{words[i % 7] or 'x'}{i // 7}", ("127.0.0.1", OSC)
        for packet in (
            osc("/himc/strike", huge, "left", name, 0.1, 0.1, huge, huge, huge, words[i % 7]),
            osc(f"/membrane/{name}/place", 0.5, 0.0, 0.8, 0.1, 0.1 + i % 100 / 100),
            osc(f"/membrane/{name}/head", *[0.999] * 64),
            osc(f"/himc/{name}/status", words[i % 7], huge, words[i % 5], words[i % 3]),
            osc(f"/himc/{name}/body", "head", 999.0, -999.0, 999.0, 1.0, 0.0, 0.0, 0.0),
            osc("/himc/beat", huge),
            osc("/viewer/camera", words[i % 7]),
            osc("/viewer/show", words[i % 7], i % 2),
            osc("/viewer/exaggeration", (huge, words[i % 7])[i // 4 % 2]),
            osc("/viewer/camera"),
        ):
            senders[i % 40].sendto(packet, to)
        if i % 20 == 0:  # what does not fit into the bridge is lost: wait for the page
            end = "return viewer.panel.count > arguments[0]"
            browser.wait(end.replace("arguments[0]", str(strikes)))
            strikes = browser.run("return viewer.panel.count")
    sizes = browser.run(
        "return [viewer.performers.size, viewer.drums.size, viewer.panel.status.size]"
    )
    assert sizes[0] <= 16 and sizes[1] <= 32 and sizes[2] <= 16, sizes
    say(OSC, osc("/viewer/camera", "stage"), osc("/viewer/exaggeration", 25.0))
    assert browser.wait("return viewer.view.name === 'stage'")
    browser.run("viewer.scripts.length = 0")
    assert browser.wait("return viewer.scripts.length > 3"), "no frames"
    gone()
    expect("3.6")
    with sender("--still", "--start", "3.6"):
        said = settle()
    trouble = browser.log()
    assert not trouble, trouble[:3]
    return said


def test_a_fault_in_a_frame_costs_that_frame_only():
    browser.run(
        "const draw = viewer.panel.draw; viewer.scripts.length = 0;"
        "viewer.panel.draw = () => { viewer.panel.draw = draw; throw new Error('once'); }"
    )
    assert browser.wait("return viewer.scripts.length > 3"), "no frames"
    assert "once" in "".join(browser.log())


def test_a_drum_that_changes_its_size_frees_the_old_one():
    with sender("--start", "18"):
        assert browser.wait("return [...viewer.drums.values()].some(d => d.group.visible)")
        draw(True)
        counts = browser.run(
            """
            const drum = [...viewer.drums.values()].find(d => d.group.visible);
            return [0.3, 0.4, 0.5, 0.4, 0.3].map(radius => {
                drum.setPlace([0.7, 0, 0.85, 0, radius]);
                drum.head.frustumCulled = false;
                viewer.stage.renderer.render(viewer.stage.scene, viewer.view.camera);
                return viewer.stage.renderer.info.memory.geometries;
            });
            """
        )
        draw(False)
    assert counts[-1] <= counts[0], counts


def test_a_motion_that_is_dropped_is_played_or_refused_in_one_line():
    with open(MOTION) as file:
        text = "".join(file.readline() for _ in range(12))
    tried = browser.run(
        """
        return Promise.all([import("/motion.js"), import("/stream.js")]).then(([{Motion}]) => {
            const pieces = ["", ",", "\\n", "-", "e", "nan", "Infinity", "1e999", "0", "9", "x", "time_s"];
            const columns = arguments[0].split("\\n")[0].split(",");
            let seed = 1, played = 0, refused = 0;
            const below = n => (seed = (seed * 16807) % 2147483647) % n;
            const finite = list => [...list].every(Number.isFinite);
            const on = {
                pose: (...a) => { if (!finite(a[4]) || !finite(a[5])) throw new TypeError("pose"); },
                drum: (...a) => { if (!finite(a[4])) throw new TypeError("drum"); },
                event: e => { if (!finite([e.x, e.y, e.force, e.time])) throw new TypeError("event"); },
            };
            for (let i = 0; i < 3000; i++) {
                let text = arguments[0];
                for (let n = below(4); n > 0; n--) {
                    const at = below(text.length), cut = below(4) ? below(9) : below(text.length);
                    text = text.slice(0, at) + pieces[below(pieces.length)] + text.slice(at + cut);
                }
                const lines = text.split("\\n"), line = 1 + below(lines.length - 1);
                if (below(4) === 0) text = [...lines, lines[line]].join("\\n");
                if (i < columns.length) text = arguments[0].replace(columns[i], "other");
                let motion;
                try {
                    motion = new Motion(text, "a.csv");
                } catch (error) {
                    if (!/^a.csv:.+$/.test(error.message)) return `${error.message} of ${text}`;
                    refused++;
                    continue;
                }
                played++;
                if (!motion.rows.every((row, k) => !k || row[0] > motion.rows[k - 1][0]))
                    return `time does not grow in ${text.slice(0, 300)}`;
                try {
                    for (let t = 0; t < 60; t += 20) motion.update(t, 20, on);
                    motion.seek(1e9), motion.update(100, 0, on);
                } catch (error) {
                    return `${error.message} in ${text.slice(0, 300)}`;
                }
            }
            return [played, refused];
        });
        """,
        text,
    )
    assert isinstance(tried, list) and min(tried) > 300, tried
    return f"{tried[0]} played, {tried[1]} refused"


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
