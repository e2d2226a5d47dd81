"""The viewer end to end, in a real Chromium.

No test depends on the speed of the machine: each waits for what must come, as long as the browser
answers. What the viewer must do in real time is in realtime.py.
"""

import base64
import contextlib
import csv
import json
import math
import os
import random
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import zlib

import report
from bridge import WAIT, bundle, osc, pose, sound
from browser import Browser

BUILD = os.environ["HIMC_BUILD"]
MADE = os.environ["HIMC_MADE"]  # by prepare.sh
HIMC, VIEWER = (os.path.join(BUILD, name) for name in ("bin/himc", "bin/himc-viewer"))
MOTION, STROKES, SCENE, FOUR, SEATED, EXPECTED = (
    os.path.join(MADE, f)
    for f in ("motion.csv", "strokes.csv", "play.himc", "four.himc", "seated.himc", "expected.txt")
)
FOUR_SCORE = "tests/viewer/four.txt"
# fixed, because the page must find a restarted viewer again; different for each run of this file
HTTP = 20000 + os.getpid() % 20000
OSC, SERVE = HTTP + 1, HTTP + 2
RECOVERED = 10  # of a body that was pushed, a second later (mm); tests/support/pushes.h
MARKS = 7  # layer of the marks of strikes
browser = bridge = None
STATES = tempfile.TemporaryDirectory(prefix="himc-states-")  # of pieces that were dropped
os.environ["XDG_STATE_HOME"] = STATES.name


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


def faulty_scenes(good, count):
    """The scene with a fault in one of its chunks, each of which is well packed."""
    chunks, at = [], 8
    while at < len(good):
        size = struct.unpack_from("<I", good, at + 4)[0]
        if good[at : at + 4] != b"snd ":
            chunks.append((good[at : at + 4], zlib.decompress(good[at + 8 : at + 8 + size])))
        at += 8 + size
    pieces = [b"", b"null", b"-1e999", b"[]", b"0", b"3", b"-0.5", b'"left"', b'"low"']
    for i in range(count):
        faulty = list(chunks)
        for _ in range(1 + i % 3):
            which = random.randrange(len(chunks))
            kind, data = faulty[which]
            begin = random.randrange(len(data))
            words = [p for p in range(begin, min(len(data), begin + 300)) if data[p : p + 1] in b",:["]
            if kind == b"json" and len(words) > 1:
                data = data[: words[0] + 1] + random.choice(pieces) + data[words[1] :]
            else:
                end = begin + random.randrange(1, 9)
                data = data[:begin] + random.randbytes(len(data[begin:end])) + data[end:]
            faulty[which] = (kind, data)
        yield good[:8] + b"".join(
            kind + struct.pack("<I", len(packed)) + packed
            for kind, packed in ((k, zlib.compress(d)) for k, d in faulty)
        )


def gone():
    assert browser.wait("return !viewer.joints()"), "the performer stays"


# --- one bridge and one page for all of these


def test_page_loads_without_errors():
    open_page()
    browser.wait("return viewer.numbers.render > 0")
    trouble = browser.log()
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


def test_himc_serve_is_shown_and_heard_with_drum_strikes_and_status():
    gone()
    command = [os.path.join(BUILD, "bin/himc"), "serve", "patches/improvisation.txt"]
    with Started(*command, "--port", str(SERVE)) as serve:
        serve.process.stdout.readline()
        browser.run("viewer.sound.wake()")
        for what in ("pose", "targets", "strikes", "head", "sound"):
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
        live = "[...viewer.liveSound.nodes.values()].map(n => n.told)"
        assert browser.wait(f"return {live}.some(t => t && t.peak > 0.001)"), "no sound"
        # the performer's time begins at 0 again: the picture goes on, as late as before
        count = browser.run("return viewer.panel.count")
        say(SERVE, osc("/himc/reset"), osc("/himc/hit", "right", "accent", "f"))
        clock = "[...viewer.performers.values()].find(p => p.group.visible).clock"
        assert browser.wait(f"return viewer.panel.count > {count}"), "no strike after a reset"
        assert browser.wait(f"const c = {clock}; return c.sounds && c.lag < 1000 && c.late - c.lag < 1000")
        rate = "Math.max(...[...viewer.performers.values()].map(p => p.clock.rate))"
        return f"{browser.run(f'return {rate}'):.1f} poses/s"


def test_the_picture_shows_the_moment_that_is_heard():
    """A sound that its sender tells to be of a moment 0.15 s before that of the poses sent with it."""
    gone()
    browser.run("viewer.sound.wake()")
    late, block, begin, first = 0.15, 240 / 48000, time.time(), 0
    apart = """
        const p = [...viewer.performers.values()].find(q => q.group.visible && q.clock.sounds),
            heard = p && viewer.liveSound.moment(p.key), c = p && p.clock;
        return heard && [performance.timeOrigin + performance.now() - c.late - heard, c.late - c.lag];"""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        said = None
        while not said or abs(said[0]) > 1 or said[1] < 1000 * late:
            assert time.time() < begin + WAIT, said
            while begin + block * first < time.time():
                told = begin + block * first
                udp.sendto(bundle(sound(240 * first, [0] * 240), told=told - late), ("127.0.0.1", OSC))
                if first % 6 == 0:
                    udp.sendto(bundle(*pose(), told=told), ("127.0.0.1", OSC))
                first += 1
            said = browser.run(apart)
    return f"{said[0]:.2f} ms apart, {said[1]:.0f} ms late"


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


def test_a_scene_that_is_dropped_is_played_or_refused_in_one_line():
    """Scenes with faults in what they hold: each is refused by name, or plays to its end."""
    with open(FOUR, "rb") as file:
        good = file.read()
    random.seed(5)
    tried = [0, 0]
    for bad in [good[:200], b"himc", good[:7] + b"\2" + good[8:], *faulty_scenes(good, 60)]:
        said = browser.run(
            """
            const done = arguments[1], bytes = Uint8Array.from(atob(arguments[0]), c => c.charCodeAt(0));
            return import("/playback.js").then(async ({ Playback }) => {
                let scene;
                try {
                    scene = await viewer.readScene(bytes, "a.himc");
                } catch (error) {
                    return error.message;
                }
                const playback = new Playback(scene, { stop() {}, play() {}, setLoop() {}, position: () => null });
                const on = { jump() {}, drum() {}, pose() {}, strike() {} };
                for (let t = 0; t < playback.length; t += 250) (playback.seek(t), playback.show(on, 1000));
                scene.heights();
                return "";
            });
            """,
            base64.b64encode(bad).decode(),
        )
        assert said == "" or said.startswith("a.himc: "), (said, len(bad))
        tried[said != ""] += 1
    assert min(tried) > 5, tried
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


def shown():
    """Drums and their places, joints and strikes as they are on the page."""
    return browser.run(
        """
        const strike = s => [s.hand, s.drum, s.nuance, s.time, s.x, s.y, s.velocity, s.force, s.duration];
        const { playback, panel } = viewer;
        return {
            drums: Object.fromEntries([...viewer.drums.values()]
                .filter(d => !d.name.startsWith("kettle")).map(d => [d.name, d.place])),
            joints: viewer.joints(),
            strikes: (playback
                ? playback.scene.strikes.filter(s => s.time + s.duration < playback.at / 1000)
                : panel.strikes
            ).map(strike),
        };
        """
    )


def apart(a, b):
    """Largest difference of the numbers in two nested lists, of those above 1 in proportion; words
    must be equal."""
    if isinstance(a, (int, float)):
        return abs(a - b) / max(1, abs(a))
    if isinstance(a, str):
        assert a == b, (a, b)
        return 0
    return max((apart(x, y) for x, y in zip(a, b, strict=True)), default=0)


def test_four_drums_live_and_played_back_are_the_same():
    global bridge
    gone()
    open_page()
    draw(False)
    with Started(os.path.join(MADE, "perform"), str(OSC), FOUR_SCORE, "3.5") as performer:
        time_shown = float(performer.process.stdout.readline())
        four = "['low', 'second', 'third', 'high'].every(n => [...viewer.drums.values()].some(d => d.name === n))"
        assert browser.wait(f"return viewer.joints() && {four}")
        # the pose that stays is the only one left to interpolate, and has been drawn
        assert browser.wait(
            "const { poses } = [...viewer.performers.values()].find(p => p.group.visible);"
            "return poses.length > 20 && poses.every(q => q.body.every((v, i) => v === poses[0].body[i]))"
        )
        browser.run("viewer.scripts.length = 0")
        assert browser.wait("return viewer.scripts.length > 1")
        live = shown()
    bridge.__exit__()
    bridge = viewer("--play", FOUR)
    open_page()
    draw(False)
    assert browser.wait("return !!viewer.playback")
    browser.run("viewer.playback.play(false); viewer.playback.seek(1000 * arguments[0])", time_shown)
    assert browser.wait("return viewer.playback.shownTo === viewer.playback.at && viewer.joints()")
    played = shown()
    assert len(live["drums"]) == 4 and live["drums"].keys() == played["drums"].keys(), played
    places = max(apart(live["drums"][name], played["drums"][name]) for name in live["drums"])
    joints, strikes = (apart(live[k], played[k]) for k in ("joints", "strikes"))
    assert places < 1e-6 and joints < 1e-5 and len(live["strikes"]) >= 8, (places, joints)
    assert len({s[1] for s in live["strikes"]}) == 4
    assert strikes < 5e-4, strikes  # the stream carries four digits of a velocity
    return f"joints within {1e6 * joints:.1f} µm, {len(live['strikes'])} strikes within {strikes:.1g}"


def test_the_page_of_a_scene_loads_without_errors():
    assert browser.wait("return !!viewer.timeline || viewer.panel.timeline.waves"), "no sound"
    trouble = browser.log()
    assert not trouble, trouble


def test_timeline_steps_loops_and_slows_down():
    said = browser.run(
        """
        const { playback: p, panel, actions } = viewer, told = {};
        viewer.held = true;
        const key = (key, shift) =>
            document.body.dispatchEvent(new KeyboardEvent("keydown", { key, shiftKey: !!shift, bubbles: true }));
        const run = ms => { viewer.step(ms, false); return p.at; };
        p.seek(0), p.play(true);
        told.plain = run(100);
        for (let i = 0; i < 3; i++) key("-");
        told.speed = p.speed;
        told.slow = run(100) - told.plain;
        p.setSpeed(1);
        p.setLoop(500, 700), p.seek(650);
        told.loop = [run(40), run(40)];
        key("\\\\");
        told.loopEnds = run(600);
        p.seek(0);
        key("ArrowRight", true);
        told.first = [p.at, p.playing];
        key("ArrowRight", true), key("ArrowLeft", true);
        told.back = p.at;
        key("ArrowRight");
        told.frame = p.at - told.back;
        key("["), p.seek(p.at + 800), key("]");
        told.ab = p.loop[1] - p.loop[0];
        const box = document.getElementById("timeline").getBoundingClientRect(), strike = p.scene.strikes[3];
        const x = box.left + (1000 * strike.time / p.length) * box.width + 2, y = box.top + 20;
        const at = { clientX: x, clientY: y, pointerId: 1, bubbles: true };
        HTMLCanvasElement.prototype.setPointerCapture = () => {};
        document.getElementById("timeline").dispatchEvent(new PointerEvent("pointerdown", at));
        document.getElementById("timeline").dispatchEvent(new PointerEvent("pointerup", at));
        told.click = p.at - 1000 * strike.time;
        panel.timeline.zoom(0.25);
        told.zoom = (panel.timeline.view[1] - panel.timeline.view[0]) / p.length;
        told.strike = 1000 * p.scene.strikes[0].time;
        actions.unloop();
        p.seek(p.length - 10), p.play(true);
        told.end = [run(50) === p.length];
        viewer.resume();
        return told;
        """
    )
    assert abs(said["plain"] - 100) < 1e-6 and said["speed"] == 0.1, said
    assert abs(said["slow"] - 10) < 1e-6, said
    assert abs(said["loop"][0] - 690) < 1e-6 and said["loop"][1] == 500, said
    assert abs(said["loopEnds"] - 1100) < 1e-6, said
    assert said["first"] == [said["strike"], False] and said["back"] == said["strike"], said
    assert abs(said["frame"] - 1000 / 60) < 1e-6 and abs(said["ab"] - 800) < 1e-6, said
    assert abs(said["click"]) < 1e-6 and abs(said["zoom"] - 0.25) < 1e-6 and said["end"], said


def control_faults():
    """What a finger or a screen reader lacks: at a phone's width every control that is shown is 42
    pixels wide and high and has a name; writing stands out by 4.5 even where a drum is white."""
    return browser.run(
        """
        document.body.classList.add("open");
        const faults = [], shown = e => e.offsetParent !== null && !e.disabled;
        for (const e of document.querySelectorAll("button, select, input, summary, canvas[tabindex]")) {
            if (!shown(e) && getComputedStyle(e).position !== "fixed") continue;
            const box = e.getBoundingClientRect(), label = e.closest("label");
            const name = e.ariaLabel || e.textContent.trim() || label?.textContent.trim();
            if (!name) faults.push(`${e.id} has no name`);
            if (e.tagName !== "CANVAS" && e.type !== "range" && (box.width < 41.5 || box.height < 41.5))
                faults.push(`${e.id || name}: ${box.width} x ${box.height}`);
        }
        const light = ([r, g, b]) => [r, g, b].map(v => v / 255)
            .map(v => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
            .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
        const parse = text => { const n = text.match(/[0-9.]+/g).map(Number); return n.length < 4 ? [...n, 1] : n; };
        for (const e of document.querySelectorAll("button, #big span, #who div, nav label, #edit :is(label, summary, #e-none), #clock, #text span, #lost, #note, .playback label, #silent")) {
            if (!e.textContent.trim()) continue;
            let back = [225, 225, 225], layers = [];
            for (let at = e; at && at !== document.body; at = at.parentElement)
                layers.unshift(parse(getComputedStyle(at).backgroundColor));
            for (const [r, g, b, a] of layers) back = back.map((v, i) => v + a * ([r, g, b][i] - v));
            const [a, b] = [light(parse(getComputedStyle(e).color)), light(back)].sort((x, y) => y - x);
            const ratio = (a + 0.05) / (b + 0.05);
            if (!e.disabled && ratio < 4.5) faults.push(`${e.id || e.textContent}: contrast ${ratio.toFixed(2)}`);
        }
        document.body.classList.remove("open");
        return faults;
        """
    )


def test_controls_have_names_sizes_and_contrast():
    faults = control_faults()
    assert not faults, faults
    # the sheet of keys lies over other writing, which does not show through
    sheet = browser.run("const s = getComputedStyle(document.getElementById('keys')); return [s.backgroundColor, s.opacity]")
    assert sheet[0].startswith("rgb(") and sheet[1] == "1", sheet


def test_playback_shows_a_scene_as_the_library_does():
    browser.run("return viewer.playback.scene.name")
    with open(SCENE, "rb") as file:
        scene = base64.b64encode(file.read()).decode()
    browser.run(
        "return viewer.play(Uint8Array.from(atob(arguments[0]), c => c.charCodeAt(0)), 'play.himc')",
        scene,
    )
    for start in ("12.5", "25.9"):
        expect(start)
        browser.run(
            "viewer.playback.play(false); viewer.playback.seek(1000 * arguments[0])",
            float(start),
        )
        said = settle(1e-5)
    with open(STROKES) as file:
        strokes = list(csv.DictReader(file))
    strikes = browser.run("return viewer.playback.scene.strikes")
    assert len(strikes) == len(strokes)
    for there, here in zip(strikes, strokes, strict=True):
        assert abs(there["time"] - float(here["time_s"])) < 1e-6
        assert there["nuance"] == here["nuance"] and there["beat"] is not None
    return said


def test_sound_is_the_clock_of_a_playback():
    """The position of the sound is that of the picture, also at half the speed and after a jump."""
    browser.run("viewer.sound.wake()")
    assert browser.wait("return viewer.sound.ready"), "no sound device"
    for speed, at in ((1, 12000), (0.5, 20000)):
        browser.run(
            "const p = viewer.playback; p.setSpeed(arguments[0]); p.seek(arguments[1]); p.play(true)",
            speed,
            at,
        )
        assert browser.wait(f"return viewer.playback.at > {at + 300}")
        off, passed = browser.run(
            "const p = viewer.playback, before = p.at; viewer.held = true; p.advance(0);"
            "const off = p.at - 1000 * viewer.sound.position(), c = viewer.sound.context.currentTime;"
            "viewer.resume(); return [off, p.at - before]"
        )
        assert abs(off) < 20 and passed >= 0, (off, passed)
    late = browser.run(
        "const s = viewer.sound, p = viewer.playback, heard = s.heard; p.seek(0);"
        "s.heard = () => s.begun - 0.08; p.advance(0); s.heard = heard; return p.at"
    )
    assert late == 0, "a device that is late plays its first moment"
    browser.run("viewer.playback.play(false)")
    tracks = browser.run(
        "viewer.actions.film(); const tracks = viewer.recorder.film.stream.getAudioTracks().length;"
        "viewer.actions.film(); return tracks"
    )
    assert tracks == 1, "a film without sound"
    return f"{off:.2f} ms"


def play_compared(others):
    """Plays the four drums, with the scenes of other pipelines to compare."""
    path = os.path.join(MADE, "others.himc")
    command = [HIMC, "render", FOUR_SCORE, "-o", os.path.join(MADE, "others.wav")]
    command += ["--scene", path, "--compare", others, "--quiet"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    with open(path, "rb") as file:
        scene = base64.b64encode(file.read()).decode()
    browser.run(
        """
        const bytes = Uint8Array.from(atob(arguments[0]), c => c.charCodeAt(0));
        return viewer.play(bytes, "others.himc")
        """,
        scene,
    )


def test_others_are_shown_over_and_beside_the_performer():
    """A scene with `ik` in it: each figure stands where its own rows say, over or beside the other."""
    play_compared("ik")
    said = browser.run(
        """
        const { playback: p, performers, drums, actions } = viewer, told = {};
        viewer.held = true;
        const far = (a, b) => Math.max(...a.map((v, i) => Math.hypot(...v.map((x, k) => x - b[i][k]))));
        p.play(false), p.seek(2600), viewer.step(0, false);
        const here = () => [...performers.values()].filter(q => q.group.visible);
        const own = q => {
            const scene = p.scenes.find(s => s.name === q.key), pose = scene.pose(p.at / 1000, new Float64Array(140));
            return Array.from({ length: 20 }, (_, i) => [...pose.subarray(7 * i, 7 * i + 3)]);
        };
        const off = q => far(own(q), q.points().slice(0, 20).map(v => q.group.worldToLocal(v).toArray()));
        told.over = here().map(q => [q.title, q.group.position.y, off(q), !!q.ghostly]);
        told.apart = far(own(here()[0]), own(here()[1]));
        told.drums = drums.size;
        p.play(true);
        for (let i = 0; i < 12; i++) viewer.step(20, false);
        p.play(false);
        told.colors = here().map(q => q.trails[1].points.at(-1).color.getHexString());
        actions.compare("side"), viewer.step(0, false), viewer.step(0, false);
        told.beside = here().map(q => [q.title, q.group.position.y, off(q), !!q.ghostly]);
        told.both = drums.size;
        actions.compare(""), viewer.step(0, false);
        told.alone = here().length;
        viewer.resume();
        return told;
        """
    )
    for how in ("over", "beside"):
        assert [p[0] for p in said[how]] == ["himc", "ik"], said
        assert all(p[2] < 1e-6 for p in said[how]), said
    assert [p[3] for p in said["over"]] == [False, True] and not any(p[3] for p in said["beside"]), said
    assert said["over"][0][1] == said["over"][1][1] == 0 and said["drums"] == 4, said
    assert abs(said["beside"][0][1] - said["beside"][1][1]) > 1 and said["both"] == 8, said
    assert said["apart"] > 1e-4 and said["alone"] == 1 and len(said["colors"]) == 2, said
    return f"{1000 * said['apart']:.1f} mm apart"


def test_lanes_follow_the_limb_that_is_clicked():
    """A click on the left elbow: its angles and torques; a tone stands in its row of the spectrum."""
    said = browser.run(
        """
        const { playback: p, panel, actions, view, performers } = viewer, told = {}, { timeline } = panel;
        viewer.held = true;
        actions.camera("front"), p.play(false), p.seek(2600), viewer.step(0, false);
        view.settle(), viewer.step(0, false), view.camera.updateMatrixWorld();
        actions.lanes(), view.settle(), viewer.step(0, false), view.camera.updateMatrixWorld();
        return import("/body.js").then(({ bone }) => {
            const q = performers.get(p.scene.name).points()[bone("left-forearm")].project(view.camera),
                at = { clientX: ((q.x + 1) / 2) * innerWidth, clientY: ((1 - q.y) / 2) * innerHeight, pointerId: 1, bubbles: true };
            for (const what of ["pointerdown", "pointerup"])
                document.getElementById("stage").dispatchEvent(new PointerEvent(what, at));
            told.joint = timeline.joint;
            told.most = ["angle", "torque"].map(kind => timeline.curve(kind).most);
            timeline.draw();
            actions.lanes();
            viewer.resume();
            return import("/spectrum.js");
        }).then(({ spectrogram }) => {
            const rate = 48000, tone = Float32Array.from({ length: 24000 }, (_, i) => Math.sin((2 * Math.PI * 440 * i) / rate));
            const b = new AudioBuffer({ length: tone.length, sampleRate: rate });
            b.copyToChannel(tone, 0);
            return spectrogram(b, () => true);
        }).then(picture => {
            const { data } = picture.getContext("2d").getImageData(picture.width >> 1, 0, 1, picture.height),
                light = Array.from({ length: picture.height }, (_, r) => data[4 * r] + data[4 * r + 1] + data[4 * r + 2]),
                row = picture.height - 1 - light.indexOf(Math.max(...light));
            told.hz = [row, row + 1].map(r => 50 * (4000 / 50) ** (r / picture.height));
            return told;
        });
        """
    )
    assert said["joint"] == "left-elbow" and 0.1 < said["most"][0] < 3.2, said
    assert 0.5 < said["most"][1] < 2000, said
    assert said["hz"][0] * 0.97 < 440 < said["hz"][1] * 1.03, said


def made_by_film(ending, *options):
    out = os.path.join(MADE, "made." + ending)
    command = [HIMC, "film", FOUR, "-o", out, "--size", "96x64", *options]
    done = subprocess.run(command, capture_output=True, text=True)
    if "without three.js" in done.stderr:
        raise report.Ignored("himc was built without three.js")
    assert done.returncode == 0, done.stderr
    with open(out, "rb") as file:
        return file.read()


def test_a_film_has_all_its_pictures_and_the_sound_in_step():
    """The browser's own reader of films, and where the first stroke is heard in it."""
    film = made_by_film("webm", "--from", "1", "--to", "2.2", "--fps", "10")
    assert film.count(b"V_VP9") + film.count(b"V_VP8") == 1 and film.count(b"A_OPUS") == 1
    said = browser.run(
        """
        const bytes = Uint8Array.from(atob(arguments[0]), c => c.charCodeAt(0)),
            video = document.createElement("video");
        video.src = URL.createObjectURL(new Blob([bytes], { type: "video/webm" }));
        video.muted = true;
        const event = name => new Promise((done, fail) => ((video["on" + name] = done), (video.onerror = fail)));
        return event("loadeddata").then(async () => {
            const told = { size: [video.videoWidth, video.videoHeight], seconds: video.duration };
            video.currentTime = 1.1;
            await event("seeked");
            told.at = video.currentTime;
            const sound = await new OfflineAudioContext(2, 1, 48000).decodeAudioData(bytes.buffer.slice(0)),
                loud = (list, from) => list.findIndex((x, i) => i > from && Math.abs(x) > 0.02) / 48000;
            told.heard = loud(sound.getChannelData(0), 0);
            return told;
        });
        """,
        base64.b64encode(film).decode(),
    )
    loud = browser.run(
        """
        const bytes = Uint8Array.from(atob(arguments[0]), c => c.charCodeAt(0));
        return viewer.readScene(bytes, "a").then(scene => viewer.sound.load(scene.sounds, 48000)).then(b =>
            b.getChannelData(0).findIndex((x, i) => i > 48000 && Math.abs(x) > 0.02) / 48000 - 1);
        """,
        base64.b64encode(open(FOUR, "rb").read()).decode(),
    )
    assert said["size"] == [96, 64] and abs(said["seconds"] - 1.2) < 0.03, said
    assert abs(said["at"] - 1.1) < 1e-6 and abs(said["heard"] - loud) < 0.02, (said, loud)
    return f"sound {1000 * (said['heard'] - loud):.1f} ms off"


def test_a_film_beyond_the_end_is_refused():
    for option in "--at", "--from":
        out = os.path.join(MADE, "beyond.png")
        command = [HIMC, "film", FOUR, "-o", out, "--size", "96x64", option, "999"]
        said = subprocess.run(command, capture_output=True, text=True)
        if "without three.js" in said.stderr:
            raise report.Ignored("himc was built without three.js")
        assert said.returncode == 1 and f"{option} 999: the scene ends at " in said.stderr, said
        assert not os.path.exists(out)


def test_an_interrupted_film_leaves_nothing():
    made_by_film("png", "--at", "1")
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        with tempfile.TemporaryDirectory() as home:
            command = [HIMC, "film", FOUR, "-o", os.path.join(home, "a.png"), "--size", "96x64"]
            film = subprocess.Popen(command, env=dict(os.environ, TMPDIR=home))
            while not any(os.path.exists(os.path.join(home, name, "page.html")) for name in os.listdir(home)):
                assert film.poll() is None
                time.sleep(0.01)
            film.send_signal(number)
            assert film.wait(WAIT) == -number
            end = time.time() + WAIT
            while left := [name for name in os.listdir(home) if number != signal.SIGKILL or "a.png" not in name]:
                assert time.time() < end, left
                time.sleep(0.05)


def test_a_film_of_what_the_page_refuses_says_why():
    with open(FOUR, "rb") as file:
        good = file.read()
    bad = os.path.join(MADE, "bad.himc")
    with open(bad, "wb") as file:
        file.write(good + packed(b"json", b'[{"event":"beat","time":1,"beat":"one"}]'))
    done = subprocess.run([HIMC, "film", bad, "-o", bad + ".png"], capture_output=True, text=True)
    assert done.returncode == 1 and "bad.himc: a faulty beat" in done.stderr, done
    assert done.stderr.count("\n") == 1 and not os.path.exists(bad + ".png"), done


def test_a_camera_finds_the_head_before_it_is_drawn():
    """As in a film that begins later than at 0: its pictures before are not drawn."""
    said = browser.run(
        """
        const { playback: p, actions, view } = viewer;
        viewer.held = true;
        actions.camera("head"), p.play(false), p.seek(2600);
        for (const drum of viewer.drums.values()) drum.head.matrixWorld.identity();
        viewer.step(10, false);
        const { x, y, z } = view.goal.target;
        actions.camera("stage"), p.setSpeed(1), viewer.resume();
        return [x, y, z];
        """
    )
    assert said[2] > 0.5, said


def test_a_still_is_a_picture_of_that_size():
    still = made_by_film("png", "--at", "2", "--camera", "hands")
    assert still[:8] == b"\x89PNG\r\n\x1a\n" and struct.unpack(">II", still[16:24]) == (96, 64)


def matrix(node, rotation=None):
    """Of a glTF node, by rows."""
    if "matrix" in node:
        return [[node["matrix"][4 * c + r] for c in range(4)] for r in range(4)]
    x, y, z, w = rotation or node.get("rotation", [0, 0, 0, 1])
    at = node.get("translation", [0, 0, 0])
    turned = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return [[*turned[r], at[r]] for r in range(3)] + [[0, 0, 0, 1]]


def times(a, b):
    return [[sum(a[r][k] * b[k][c] for k in range(4)) for c in range(4)] for r in range(4)]


def loudest(gltf, binary, channel):
    """A head of the file at its loudest frame: name, time, some points (radius, angle), number of its
    shapes, and the heights of the points (m)."""

    def floats(accessor):
        found = gltf["accessors"][accessor]
        start = gltf["bufferViews"][found["bufferView"]]["byteOffset"]
        return struct.unpack_from(f"<{found['count'] * (3 if found['type'] == 'VEC3' else 1)}f", binary, start)

    node = gltf["nodes"][channel["target"]["node"]]
    primitive = gltf["meshes"][node["mesh"]]["primitives"][0]
    shapes = [floats(target["POSITION"]) for target in primitive["targets"]]
    at = floats(primitive["attributes"]["POSITION"])
    weights = floats(gltf["animations"][0]["samplers"][channel["sampler"]]["output"])
    rows = [weights[i : i + len(shapes)] for i in range(0, len(weights), len(shapes))]
    frame = max(range(len(rows)), key=lambda i: max(map(abs, rows[i])))
    rim = 22 * 72  # the first point of the head's edge; beyond it lies its collar
    edge = math.hypot(at[3 * rim], at[3 * rim + 1])
    chosen = range(72, rim, 131)
    points = [[math.hypot(at[3 * i], at[3 * i + 1]) / edge, math.atan2(at[3 * i + 1], at[3 * i])] for i in chosen]
    heights = [sum(w * s[3 * i + 2] for w, s in zip(rows[frame], shapes)) for i in chosen]
    return node["name"].split()[0], frame / 60, points, len(shapes), heights


def test_the_figure_as_gltf_moves_as_on_the_page():
    data = made_by_film("glb")
    magic, version, size, length, kind = struct.unpack_from("<IIIII", data)
    assert (magic, version, size, kind) == (0x46546C67, 2, len(data), 0x4E4F534A)
    gltf = json.loads(data[20 : 20 + length])
    binary = data[28 + length :]
    assert len(binary) == gltf["buffers"][0]["byteLength"]
    for accessor in gltf["accessors"]:
        view = gltf["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
        width *= 2 if accessor["componentType"] == 5123 else 4
        assert width * accessor["count"] == view["byteLength"] and view["byteOffset"] % 4 == 0
    animation, frame = gltf["animations"][0], 120  # 2 s
    turned, loud = {}, []
    for channel in animation["channels"]:
        if channel["target"]["path"] == "weights":
            loud.append(loudest(gltf, binary, channel))
            continue
        accessor = gltf["accessors"][animation["samplers"][channel["sampler"]]["output"]]
        start = gltf["bufferViews"][accessor["bufferView"]]["byteOffset"] + 16 * frame
        turned[channel["target"]["node"]] = struct.unpack_from("<4f", binary, start)
    assert len(turned) == 19 and gltf["skins"][0]["joints"][0] == 1
    where = {}

    def walk(index, above):
        node = gltf["nodes"][index]
        own = times(above, matrix(node, turned.get(index)))
        where[node.get("name")] = own
        for child in node.get("children", []):
            walk(child, own)

    walk(0, [[float(r == c) for c in range(4)] for r in range(4)])
    there, heads = browser.run(
        """
        const [packed, loud] = arguments, bytes = Uint8Array.from(atob(packed), c => c.charCodeAt(0));
        return Promise.all([viewer.readScene(bytes, "a"), import("/playback.js"), import("/modes.js")]).then(
            ([scene, { Playback }, { shape }]) => {
                const p = new Playback(scene, null), drums = [...scene.drums.values()];
                const heads = loud.map(([name, time, points, shapes]) => {
                    const all = p.head(drums.find(d => d.name === name), time).slice(),
                        sum = n => points.map(([r, t]) => 8 * all.slice(0, n).reduce((z, q, i) => z + q * shape(i, r, t), 0));
                    return [sum(shapes), sum(64)];
                });
                return [[...scene.pose(2, new Float64Array(140))], heads];
            });
        """,
        base64.b64encode(open(FOUR, "rb").read()).decode(),
        [head[:4] for head in loud],
    )
    assert len(loud) == 4, [head[0] for head in loud]
    left = 0
    for (name, _, _, _, drawn), (same, whole) in zip(loud, heads):
        most = max(map(abs, whole))
        assert most > 1e-5 and max(abs(a - b) for a, b in zip(drawn, same)) < 1e-3 * most, (name, drawn, same)
        left = max(left, max(abs(a - b) for a, b in zip(drawn, whole)) / most)
    assert left < 0.3, left
    names = [n["name"] for n in gltf["nodes"][1:21]]
    worst = max(
        abs(a - b)
        for i, name in enumerate(names)
        # y up: (x, y, z) of himc is (x, z, -y) there
        for a, b in zip(
            (where[name][0][3], -where[name][2][3], where[name][1][3]), there[7 * i : 7 * i + 3]
        )
    )
    assert worst < 1e-5, worst
    said = f"joints within {1e6 * worst:.1f} µm, heads but for {100 * left:.0f} % of their height"
    return f"{said}, {len(data) / 1e6:.1f} MB"


def test_a_body_that_changes_moves_the_joints_of_the_gltf():
    browser.run("viewer.held = true")
    gltf = browser.run(
        """
        const bytes = Uint8Array.from(atob(arguments[0]), c => c.charCodeAt(0));
        return viewer.play(bytes, "four.himc").then(async () => {
            const { bodies } = viewer.playback.scene, [first] = bodies,
                longer = first.segments.map(s => ({ ...s, origin: s.origin.map(v => 1.1 * v) }));
            bodies.push({ ...first, time: 1.5, segments: longer });
            const blob = await viewer.exporter.make("glb", {}), data = await blob.arrayBuffer();
            return JSON.parse(new TextDecoder().decode(new Uint8Array(data, 20, new DataView(data).getUint32(12, true))));
        });
        """,
        base64.b64encode(open(FOUR, "rb").read()).decode(),
    )
    browser.run("viewer.resume(); viewer.actions.live()")
    animation = gltf["animations"][0]
    placed = [c for c in animation["channels"] if c["target"]["path"] == "translation"]
    assert sorted(c["target"]["node"] for c in placed) == sorted(gltf["skins"][0]["joints"])
    for channel in placed:
        sampler = animation["samplers"][channel["sampler"]]
        times, places = (gltf["accessors"][sampler[k]] for k in ("input", "output"))
        assert sampler["interpolation"] == "STEP" and times["max"] == [1.5], (sampler, times)
        assert times["count"] == places["count"] == 2, (times, places)


def test_a_pelvis_that_is_free_moves_in_the_gltf():
    browser.run("viewer.held = true")
    joint, kinds, placed, there = browser.run(
        """
        const bytes = Uint8Array.from(atob(arguments[0]), c => c.charCodeAt(0));
        return viewer.play(bytes, "seated.himc").then(async () => {
            const blob = await viewer.exporter.make("glb", {}), data = await blob.arrayBuffer(), view = new DataView(data),
                length = view.getUint32(12, true), gltf = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 20, length)));
            const [{ channels, samplers }] = gltf.animations, [pelvis] = gltf.skins[0].joints,
                own = channels.filter(c => c.target.node === pelvis), way = own.find(c => c.target.path === "translation"),
                accessor = gltf.accessors[samplers[way.sampler].output],
                at = 28 + length + gltf.bufferViews[accessor.bufferView].byteOffset, frame = 164; // 2.73 s
            return [pelvis, own.map(c => c.target.path).sort(), [0, 1, 2].map(k => view.getFloat32(at + 12 * frame + 4 * k, true)),
                [...viewer.playback.scene.pose(frame / 60, new Float64Array(140))].slice(0, 3)];
        });
        """,
        base64.b64encode(open(SEATED, "rb").read()).decode(),
    )
    browser.run("viewer.resume(); viewer.actions.live()")
    assert joint == 1 and kinds == ["rotation", "translation"], kinds
    assert math.dist(placed, there) < 1e-6 and there[0] > 0.01, (placed, there)


# Where the audio thread meets the first loud sample of a playback, against the picture's time (ms)
SOUND_AGAINST_PICTURE = """
const { sound, playback: p } = viewer, code = `registerProcessor("onset", class extends AudioWorkletProcessor {
    process([[samples = []]]) {
        const i = samples.findIndex(x => Math.abs(x) > 0.02);
        if (i >= 0) this.port.postMessage(currentTime + i / sampleRate);
        return i < 0;
    }
})`;
sound.wake();
const opened = new Promise(done => {
    const look = () => (sound.ready ? done() : setTimeout(look, 20));
    look();
});
return opened.then(async () => {
    await sound.context.audioWorklet.addModule("data:text/javascript," + encodeURIComponent(code));
    const ear = new AudioWorkletNode(sound.context, "onset"),
        loud = sound.buffer.getChannelData(0).findIndex(x => Math.abs(x) > 0.02) / sound.buffer.sampleRate;
    sound.gain.connect(ear);
    p.setSpeed(1), p.seek(1000 * loud - 500), p.play(true);
    const met = await new Promise(done => (ear.port.onmessage = e => done(e.data)));
    // a busy machine stamps a moment late now and then; the middle of nine looks does not
    const offs = [];
    for (let i = 0; i < 9; i++) {
        p.advance(0);
        offs.push(p.at - 1000 * (loud + sound.heard() - met));
        await new Promise(done => setTimeout(done, 30));
    }
    p.play(false);
    return offs.sort((a, b) => a - b)[4];
});
"""


DRAG = """
    const e = viewer.editor, stage = document.getElementById("stage"),
        [handle, x, y] = arguments, push = typeof handle === "number", // a handle, or a segment
        [left, top] = e.screen(push ? e.on.performer().figure.place(handle, [0, 0, -0.2]) : e[handle].position);
    stage.setPointerCapture = () => {}; // there is no true pointer
    for (const [name, at] of [["pointerdown", 0], ["pointermove", 0.5], ["pointermove", 1], ["pointerup", 1]])
        stage.dispatchEvent(new PointerEvent(name, {
            clientX: left + at * x, clientY: top + at * y, button: 0, pointerId: 1, altKey: push, bubbles: true, cancelable: true,
        }));
"""


def edits(url=None):
    """Opens the page, or waits for the one that is open; all of the piece has been played then."""
    if url:
        browser.open(url)
    assert browser.wait("return !!(window.viewer && viewer.playback)"), browser.log()
    draw(False)
    assert browser.wait("return viewer.editor.piece.over")


def copied(source, home):
    """Without a journal from another test beside it."""
    return shutil.copy(source, home)


@contextlib.contextmanager
def editing(source):
    """A page that edits; strokes are written, all of it is played, and nothing moves."""
    with (
        tempfile.TemporaryDirectory() as home,
        Started(
            VIEWER, "--no-browser", "--osc", "0", "--http", "0", "--edit", copied(source, home)
        ) as started,
    ):
        browser.open("about:blank")
        browser.log()  # the page of another piece has perhaps tried to connect again
        edits(started.process.stdout.readline().split()[0])
        browser.run("viewer.sound.wake(); viewer.playback.play(false)")
        yield
        trouble = [line for line in browser.log() if "/icon.svg" not in line]
        assert not trouble, trouble


def saved_score():
    browser.run(
        "viewer.saved = null;"
        "viewer.editor.piece.on.saved = (name, bytes) => (viewer.saved = new TextDecoder().decode(bytes));"
        "document.getElementById('e-save').click()"
    )
    return browser.wait("return viewer.saved")


def undo_all():
    """By the key, one change after the other."""
    while browser.run("return viewer.editor.piece.text.undo"):
        assert browser.wait("return viewer.editor.piece.over")
        left = browser.run("return viewer.editor.piece.text.undo")
        browser.run("dispatchEvent(new KeyboardEvent('keydown', { key: 'z', ctrlKey: true, bubbles: true }))")
        assert browser.wait(f"return viewer.editor.piece.text.undo < {left}")
    assert browser.wait("return viewer.editor.piece.over")


def test_a_stroke_is_dragged_heard_and_put_back():
    with editing("tests/viewer/editable.txt"):
        with open("tests/viewer/editable.txt") as file:
            written = file.read()
        assert saved_score() == written
        strikes = "return viewer.editor.piece.scene.strikes.map(s => [s.time, s.x, s.y, s.force])"
        before = browser.run(strikes)
        # the accent on beat 11, as by a click on the timeline
        browser.run(
            "const s = viewer.editor.piece.scene.strikes.find(s => s.beat === 11);"
            "viewer.actions.seek(1000 * s.time - 200); viewer.actions.pick(s)"
        )
        assert browser.wait("return viewer.editor.spot.visible && !viewer.editor.late && viewer.editor.group.visible")
        words = "return document.getElementById('e-words').value"
        assert browser.run(words) == "stroke 11 right tenuto mf normal high"
        browser.run(DRAG, "spot", 5, 0)
        assert browser.wait("return viewer.editor.heard.length === 1")
        assert browser.run("return !viewer.playback.playing && viewer.editor.ghost.visible")
        assert browser.wait("return viewer.editor.piece.over")
        after, from_time = browser.run(strikes), 4.0
        assert [s for s in after if s[0] < from_time] == [s for s in before if s[0] < from_time]
        moved = browser.run("const s = viewer.editor.chosen; return [s.statement.x, s.statement.y, s.strike.x, s.strike.y]")
        old = browser.run("return viewer.editor.piece.scene.strikes.find(s => s.beat === 11).y")
        assert abs(moved[0] - moved[2]) < 0.02 and abs(moved[1] - moved[3]) < 0.02, (moved, old)
        # higher is louder
        browser.run("viewer.playback.play(false)")
        assert browser.wait("return viewer.editor.group.visible && viewer.editor.top.visible")
        loud = browser.run("return viewer.editor.chosen.statement.dynamic")
        browser.run(DRAG, "top", 0, -15)
        assert browser.wait("return viewer.editor.heard.length === 2")
        assert browser.run("return viewer.editor.chosen.statement.dynamic") > loud + 0.02
        undo_all()
        assert saved_score() == written and browser.run(strikes) == before
        return f"heard after {max(browser.run('return viewer.editor.heard')):.0f} ms without pictures"


# Drags the chosen statement's mark on the timeline by so many seconds
RETIME = """
    const { timeline } = viewer.panel, { canvas } = timeline, box = canvas.getBoundingClientRect(),
        from = viewer.actions.when.mark.time, x = time => box.left + timeline.x(time);
    canvas.setPointerCapture = () => {};
    for (const [name, part] of [["pointerdown", 0], ["pointermove", 0.5], ["pointermove", 1], ["pointerup", 1]])
        canvas.dispatchEvent(new PointerEvent(name, {
            clientX: x(from + 1000 * part * arguments[0]), clientY: box.top + 5, pointerId: 1, bubbles: true, cancelable: true,
        }));
"""
WORDS = "return viewer.editor.chosen.statement.words"


def heard(count):
    assert browser.wait("return viewer.editor.heard.length >= %d && viewer.editor.piece.over" % count)


def figure_over_inspector():
    """On a phone, while a piece is edited: the figure stands over the sheet of the inspector."""
    browser.resize(390, 844)
    browser.run(
        "const s = viewer.editor.piece.scene.strikes.find(s => s.beat === 11);"
        "viewer.editor.choose(null); viewer.actions.seek(1000 * s.time - 200)"
    )
    # height of the sheet, and where the figure is between the top and the sheet (pixels)
    framed = """
        const p = [...viewer.performers.values()].find(q => q.group.visible),
            heights = p.points().map(v => viewer.editor.screen(v)[1]),
            sheet = document.getElementById("edit").getBoundingClientRect();
        return [sheet.height, Math.min(...heights), sheet.top - Math.max(...heights)]"""
    settled = """
        const { now, goal, lift } = viewer.view, left = document.querySelector("footer").offsetHeight - 60;
        return Math.abs(lift - left / 2 / innerHeight) < 0.004 && Math.abs(now.distance - goal.distance) < 0.01"""
    assert browser.wait(settled)
    folded = browser.run(framed)
    browser.run("viewer.actions.pick(viewer.editor.piece.scene.strikes.find(s => s.beat === 11))")
    assert browser.wait("return document.getElementById('e-stroke').getBoundingClientRect().height > 0")
    assert browser.wait(settled)
    chosen = browser.run(framed)
    browser.run("for (const part of document.querySelectorAll('#edit details')) part.open = true")
    faults = control_faults()
    browser.resize(480, 480)
    assert not faults, faults
    assert folded[0] < chosen[0] < 0.35 * 844, (folded, chosen)
    assert min(folded[1:] + chosen[1:]) > 0, (folded, chosen)
    return f"{folded[0]:.0f} and {chosen[0]:.0f} of 844 pixels, {min(folded[1:] + chosen[1:]):.0f} free"


def test_a_stroke_is_moved_in_time_and_a_phone_shows_it():
    """On the timeline by the mouse, and by keys alone; it stays chosen, and undo gives the text back."""
    with editing("tests/viewer/editable.txt"):
        written = saved_score()
        press = "document.getElementById('timeline').dispatchEvent(new KeyboardEvent('keydown', { key: '%s', bubbles: true }))"
        time = "return viewer.editor.piece.scene.strikes.find(s => s.beat === 11).time"
        browser.run(time.replace("return ", "viewer.actions.seek(1000 * ") + " - 50)")
        browser.run(press % "Enter")
        assert browser.run(WORDS) == "stroke 11 right tenuto mf normal high"
        was = browser.run(time)
        # the place on the head is right before a frame has drawn the head where it is now
        assert browser.wait("return !!viewer.editor.head('high')")
        high = browser.run(
            "const e = viewer.editor; e.head('high').matrixWorld.identity();"
            "return e.choose(e.chosen.strike), e.spot.position.z"
        )
        assert abs(high - 0.862) < 1e-3, high
        browser.run(RETIME, 0.225)  # half a beat at 132 a minute
        heard(1)
        assert browser.run(WORDS) == "stroke 11.5 right tenuto mf normal high"
        now = browser.run("return viewer.editor.chosen.time")
        assert abs(now - was - 30 / 132) < 0.05 and abs(browser.run("return viewer.actions.when.mark.time") - 1000 * now) < 1
        browser.run(press % ",")
        heard(2)
        assert browser.run(WORDS) == "stroke 11.375 right tenuto mf normal high"
        undo_all()
        assert saved_score() == written and browser.run(time) == was
        assert abs(browser.run("return viewer.editor.chosen.time") - was) < 1e-9
        browser.run("viewer.actions.loop(1000, 1400); viewer.playback.seek(1300); viewer.playback.play(true)")
        assert browser.wait("return viewer.playback.at < 1290"), "the loop does not begin again"
        browser.run("viewer.actions.unloop(); viewer.playback.play(false)")
        # beside the mark the cursor goes there, and nothing is moved
        browser.run(RETIME.replace("x(from", "40 + x(from"), 0.2)
        assert browser.run("return viewer.editor.piece.text.undo") == 0
        return f"sheet of {figure_over_inspector()}"


# time and places of the right forearm and of both tips, as the piece is now (s, mm)
PATHS = """
const e = viewer.editor, out = [];
for (let t = 0.7; t < 7; t += 1.096) {
    const paths = [e.points(null, t, 7, [0, 0, -0.2]), e.points("left", t), e.points("right", t)];
    paths[0].forEach((p, i) => out.push([p.time, ...paths.map(path => path[i].toArray().map(v => 1000 * v))]));
}
return out;
"""


def farthest(before, after, first, last):
    """By how much the forearm and each tip are elsewhere between two times (mm)."""
    now = [(x, y) for x, y in zip(before, after, strict=True) if first <= x[0] < last]
    return [max(math.dist(x[k], y[k]) for x, y in now) for k in (1, 2, 3)]


def test_a_drag_on_the_forearm_pushes_it_and_undo_takes_the_push_back():
    with editing("tests/viewer/editable.txt"):
        written, before = saved_score(), browser.run(PATHS)
        browser.run("viewer.actions.seek(3000); viewer.actions.camera('side')")
        assert browser.wait("return Math.abs(viewer.view.now.azimuth - viewer.view.goal.azimuth) < 1e-3")
        browser.run(DRAG, 7, 25, -30)
        assert browser.wait("return viewer.editor.heard.length === 1 && viewer.editor.piece.over")
        s = browser.run("return viewer.editor.chosen.statement")
        assert s["push"] == "right-forearm" and s["force"][0] > 100 and s["force"][2] > 100, s
        assert 0.15 < s["along"] < 0.25, s  # it was taken hold of at 0.2 m
        assert math.hypot(*s["force"]) <= 1000.1 and s["words"] in saved_score(), s
        # the push begins at most a tick before 3 s; a second after its end the body has recovered
        after = browser.run(PATHS)
        assert farthest(before, after, 0, 2.99) == [0, 0, 0]
        pushed = farthest(before, after, 3, 4)
        left = farthest(before, after, 3 + s["seconds"] + 1, 3 + s["seconds"] + 1.5)
        assert pushed[0] > 5 and max(left) < RECOVERED, (pushed, left)
        # its arrow is there while it acts; the fields change it
        browser.run("viewer.actions.loop(2500, 4000); viewer.playback.play(false); viewer.playback.seek(3050)")
        assert browser.wait("return viewer.editor.pushes.arrows[0].group.visible")
        browser.run("viewer.playback.seek(3500)")
        assert browser.wait("return !viewer.editor.pushes.arrows[0].group.visible")
        browser.run("const x = document.getElementById('e-fx'); x.value = 0; x.onchange()")
        assert browser.wait("return viewer.editor.heard.length === 2 && viewer.editor.piece.over")
        assert browser.run("return viewer.editor.chosen.statement.force[0]") == 0
        browser.run("for (const _ of [1, 2]) document.getElementById('e-undo').click()")
        assert browser.wait("return !viewer.editor.piece.text.undo && viewer.editor.piece.over")
        assert saved_score().strip() == written.strip() and browser.run(PATHS) == before
        return (
            f"{math.hypot(*s['force']):.0f} N: forearm {pushed[0]:.0f} mm off, tips"
            f" {max(pushed[1:]):.0f} mm; a second later {max(left):.1f} mm"
        )


def change(script):
    """One change by the inspector; the text after it, when all of it is played."""
    browser.run("viewer.changes = viewer.editor.heard.length;" + script)
    assert browser.wait(
        "return viewer.editor.heard.length > viewer.changes && viewer.editor.piece.over"
    ), browser.log()
    return browser.run(WORDS)


SET = "const field = document.getElementById('e-%s'); field.value = '%s'; field.onchange();"
SAID = "return document.getElementById('e-state').hidden ? '' : document.getElementById('e-said').textContent"


def choose(beat):
    browser.run(
        "viewer.actions.pick(viewer.editor.piece.scene.strikes.find(s => Math.abs(s.beat - arguments[0]) < 1e-6))",
        beat,
    )


def test_a_field_changes_its_own_word_and_a_paused_piece_stays_paused():
    with editing("tests/viewer/editable.txt"):
        written = saved_score()
        choose(8)
        browser.run("viewer.playback.seek(1500)")
        was = browser.run("return viewer.playback.at")
        assert browser.run(WORDS) == "stroke 8 left legato pp normal low"
        for field, value, words in (
            ("dynamic", 0.43, "stroke 8 left legato mp normal low"),
            ("dynamic", 0.5, "stroke 8 left legato 0.5 normal low"),
            ("nuance", "accent", "stroke 8 left accent 0.5 normal low"),
            ("hand", "right", "stroke 8 right accent 0.5 normal low"),
        ):
            assert change(SET % (field, value)) == words
        line = "stroke 8 left legato pp normal low"
        assert saved_score() == written.replace(line, words)  # and nothing else
        assert browser.run("return [viewer.playback.at, viewer.playback.playing]") == [was, False]
        # one number of the place: the other one is that of the word, not that of what was played
        x, y = browser.run("return viewer.editor.aim(viewer.editor.chosen.statement)")
        words = change(SET % ("x", -0.1)).split()
        assert words[5] == "-0.1" and abs(float(words[6]) - y) < 1e-4 and words[7] == "low", words
        assert abs(x + 0.75 * 0.0254 * 29 / 2) < 1e-3 and abs(y + 0.015) < 1e-9, (x, y)
        # what plays is heard again from shortly before
        browser.run("viewer.playback.seek(500); viewer.playback.play(true)")
        change(SET % ("dynamic", 0.9))
        assert browser.run("return viewer.playback.playing")
        browser.run("viewer.playback.play(false); document.getElementById('e-revert').click()")
        assert browser.wait("return !viewer.editor.piece.text.undo && viewer.editor.piece.over")
        assert saved_score() == written


THREE = (
    "drum kettle 26; tempo 120; stroke 1 right legato mf; stroke 2 left legato mf; stroke 3 right legato mf;"
    "at 2.5 push left-forearm 100 0 0 0.1;"
)
UNDO = "document.getElementById('e-undo').click();"
# a stroke's, and a push's
QUICK = (
    [SET % f for f in (("hand", "left"), ("nuance", "staccato"), ("beat", "1.5"))],
    [SET % f for f in (("hand", "left"), ("x", "-0.1"), ("dynamic", "0.9"), ("y", "0.1"))],
    [SET % f for f in (("words", "stroke 1.25 left accent f rim"), ("x", "-0.1"), ("nuance", "tenuto"))],
    [SET % ("words", "stroke 1 rihgt legato mf"), SET % ("hand", "left"), SET % ("beat", "1.25")],
    [SET % ("hand", "left"), UNDO, SET % ("nuance", "staccato")],
    [SET % f for f in (("fx", "50"), ("segment", "head"), ("seconds", "0.05"))],
)


def settled(script):
    """It is done, and answered, and all of it is played."""
    browser.run("viewer.answers = viewer.editor.piece.answers;" + script)
    assert browser.wait("return viewer.editor.piece.answers > viewer.answers && viewer.editor.piece.over"), script


def test_fields_set_without_waiting_are_as_if_set_one_by_one():
    with tempfile.TemporaryDirectory() as home:
        source = os.path.join(home, "three.txt")
        with open(source, "w") as file:
            file.write(THREE)
        with editing(source):
            # each line has an answer
            browser.run(
                "const { piece } = viewer.editor, { text, trouble } = piece.on; piece.answers = 0;"
                "piece.on.text = e => (text(e), e.begun || piece.answers++);"
                "piece.on.trouble = (...t) => (trouble(...t), piece.answers++);"
            )
            pick = (
                "viewer.actions.pick(viewer.editor.piece.scene.strikes.find(s => s.beat === 1));",
                "viewer.actions.pick(viewer.actions.marks[0]);",
            )
            state = "const { undo, redo } = viewer.editor.piece.text; return [undo, redo, viewer.editor.chosen.statement.words]"
            for changes in QUICK:
                ends = []
                for quick in (False, True):
                    browser.run(pick["fx" in changes[0]])
                    if quick:
                        browser.run("viewer.answers = viewer.editor.piece.answers;" + "".join(f"{{{c}}}" for c in changes))
                        # what was sent is shown at once, and marked
                        if all("words" not in c and c != UNDO for c in changes):
                            shown = browser.run("return ['e-words', 'e-sent'].map(id => document.getElementById(id)).map(e => e?.value ?? e?.textContent)")
                            assert shown == [ends[0][1][2], "…"], (changes, shown, ends)
                        assert browser.wait(
                            f"return viewer.editor.piece.answers >= viewer.answers + {len(changes)} && viewer.editor.piece.over"
                        )
                    else:
                        for c in changes:
                            settled(c)
                    words = browser.run("return document.getElementById('e-words').value")
                    ends.append((saved_score(), browser.run(state)))
                    assert ends[-1][1][2] == words and not browser.run("return document.getElementById('e-sent')?.textContent")
                    undo_all()
                assert ends[0] == ends[1] and ends[0][0] != THREE, (changes, ends)
            # two pushes: the second takes no place of the first
            for _ in range(2):
                browser.run("document.getElementById('e-add').onclick()")
            assert browser.wait("return viewer.editor.piece.text.undo === 2 && viewer.editor.piece.over")
            assert saved_score().count("push") == 3
            # a score that has changed is not lost: answers of before mean nothing
            assert browser.run("return viewer.editor.risky") is False


ORNAMENTS = (
    "drum kettle 26; tempo 120; stroke 0 left legato mf; flam 3 right legato f; roll 4 1 double p f; drag 7 left legato f;"
    "stroke 9 left legato mf;"
)


def test_each_stroke_of_an_ornament_chooses_its_whole_statement():
    """Grace notes, bounces and a roll's strokes; its words and its time are changed, and delete takes it whole."""
    with tempfile.TemporaryDirectory() as home:
        source = os.path.join(home, "ornaments.txt")
        with open(source, "w") as file:
            file.write(ORNAMENTS)
        with editing(source):
            strikes = "return viewer.editor.piece.scene.strikes.map(s => [s.time, s.beat])"
            count = len(browser.run(strikes))
            chosen = [
                browser.run(f"viewer.actions.pick(viewer.editor.piece.scene.strikes[{i}]); {WORDS}?.split(' ')[0]")
                for i in range(count)
            ]
            rolled = chosen.count("roll")
            assert rolled > 4 and None in [beat for _, beat in browser.run(strikes)], chosen
            assert chosen == ["stroke"] + ["flam"] * 2 + ["roll"] * rolled + ["drag"] * 3 + ["stroke"], chosen
            assert not browser.run("return document.getElementById('note').textContent")
            # a bounce of the drag: louder words, later, and all of it away
            browser.run(f"viewer.actions.pick(viewer.editor.piece.scene.strikes[{count - 3}])")
            assert browser.run("return [viewer.editor.top.visible, document.getElementById('e-stroke').hidden]") == [False, True]
            assert change(SET % ("words", "drag 7 left legato p")) == "drag 7 left legato p"
            was = browser.run("return viewer.editor.chosen.time")
            browser.run("viewer.editor.when.move(viewer.editor.chosen.time + 0.25)")
            assert change("viewer.editor.when.drop()") == "drag 7.5 left legato p"
            assert abs(browser.run("return viewer.editor.chosen.time") - was - 0.25) < 0.1
            browser.run("document.getElementById('e-delete').click()")
            assert browser.wait("return viewer.editor.piece.text.undo === 3 && !viewer.editor.chosen")
            assert browser.wait(f"return viewer.editor.piece.over && viewer.editor.piece.scene.strikes.length === {count - 3}")
            undo_all()
            assert saved_score() == ORNAMENTS


def type_in(field, value):
    """What the page says then, and the field's value."""
    browser.run("viewer.panel.note('')")
    browser.run(SET % (field, value))
    return browser.run(
        "return [document.getElementById('note').textContent, document.getElementById(arguments[0]).value]", f"e-{field}"
    )


def type_in_after(field, value):
    """What is left on the page of a line of before."""
    browser.run(SET % (field, value))
    return browser.run("return document.getElementById('note').textContent")


def test_a_stroke_out_of_reach_is_shown_and_wrong_numbers_are_refused():
    with tempfile.TemporaryDirectory() as home:
        source = os.path.join(home, "far.txt")
        with open(source, "w") as file:
            file.write(
                "tempo 90;drum kettle;drum far;far place 1.6 0.9 0.85;stroke 1 right legato mf normal kettle;"
                "stroke 2 left legato mf normal far;stroke 3 right legato mf normal kettle;"
            )
        with editing(source):
            written = saved_score()
            missed = "return viewer.playback.scene.missed.map(s => [s.hand, s.beat, s.drum, s.why])"
            told = browser.run(missed)
            assert [m[:3] for m in told] == [["left", 2, "far"]] and "out of reach" in told[0][3], told
            browser.run("viewer.actions.pick(viewer.playback.scene.missed[0])")
            why = "const e = document.getElementById('e-missed'); return e.hidden ? '' : e.textContent"
            assert "out of reach" in browser.run(why) and browser.run(WORDS) == "stroke 2 left legato mf normal far"
            words = browser.run(WORDS)
            for field, value, there in (("beat", "", "2"), ("beat", "-3", "2"), ("x", "", "-0.248"), ("y", "7", "0.015"), ("words", "  ", words)):
                said, now = type_in(field, value)
                assert said and now == there, (field, value, said, now)
            # a field that is left after what it belonged to has gone
            browser.run("viewer.editor.choose(null)")
            for field in ("beat", "words", "dynamic"):
                browser.run(f"document.getElementById('e-{field}').onchange()")
            browser.run("document.getElementById('e-delete').click()")
            # the words that are there already
            browser.run("viewer.actions.pick(viewer.playback.scene.missed[0]); viewer.cuts = viewer.editor.piece.cuts")
            browser.run(SET % ("beat", "2"))
            assert saved_score() == written
            assert browser.run("return [viewer.editor.piece.text.undo, viewer.editor.piece.cuts - viewer.cuts]") == [0, 0]
            # a good change clears at once what was refused
            said, _ = type_in("beat", "-3")
            assert "expected 0 or more" in said and type_in_after("beat", "2.25") == ""
            assert browser.wait("return viewer.editor.piece.text.undo === 1")
            undo_all()
            # one of two strikes is taken away
            browser.run("viewer.actions.pick(viewer.playback.scene.strikes[1]); document.getElementById('e-delete').click()")
            assert browser.wait("return viewer.editor.piece.text.undo === 1 && viewer.editor.piece.over")
            assert browser.wait("return document.getElementById('said').textContent === '1 strike'")
            undo_all()
            assert browser.wait("return document.getElementById('said').textContent === '2 strikes'")
            browser.run("viewer.actions.pick(viewer.playback.scene.missed[0])")
            # within reach it is played, and the mark has gone; undo brings it back
            assert change(SET % ("words", "stroke 2 left legato mf normal kettle")).endswith("kettle")
            assert browser.run(missed) == [] and browser.run(why) == ""
            assert len(browser.run("return viewer.playback.scene.strikes")) == 3
            undo_all()
            assert browser.run(missed) == told
            browser.resize(844, 390)
            browser.run("dispatchEvent(new Event('resize')); viewer.step(2000, false)")
            # a phone that lies on its side: the inspector covers no drum
            covered = browser.run(
                "const right = document.getElementById('edit').getBoundingClientRect().right;"
                "return [...viewer.drums.values()].map(d => { const at = d.head.getWorldPosition(viewer.view.camera.position.clone());"
                "at.x -= d.place[4]; return viewer.editor.screen(at)[0] - right; })"
            )
            browser.resize(480, 480)
            assert len(covered) == 2 and min(covered) > 0, covered


def test_a_page_whose_program_is_silent_says_so_and_takes_no_edits():
    with tempfile.TemporaryDirectory() as home:
        path = copied("tests/viewer/editable.txt", home)
        with Started(VIEWER, "--no-browser", "--osc", "0", "--http", "0", "--edit", path) as started:
            edits(started.process.stdout.readline().split()[0])
            choose(8)
            started.process.send_signal(signal.SIGSTOP)
            try:
                assert browser.wait("return viewer.editor.ends === 'lost'")
                assert "cannot be reached" in browser.run(SAID)
                assert browser.run("return [viewer.editor.chosen, viewer.editor.risky]") == [None, False]
                for act in (
                    "dispatchEvent(new KeyboardEvent('keydown', { key: 'z', ctrlKey: true }))",
                    "document.getElementById('e-save').onclick()",
                    "viewer.editor.pushes.add('left-forearm', [100, 0, 0])",
                    "viewer.actions.pick(viewer.playback.scene.strikes[3]); document.getElementById('e-delete').onclick()",
                ):
                    browser.run("viewer.panel.note('');" + act)
                    assert "cannot be reached" in browser.run("return document.getElementById('note').textContent"), act
            finally:
                started.process.send_signal(signal.SIGCONT)
            assert browser.wait("return !viewer.editor.ends && viewer.editor.piece.live && viewer.editor.piece.over")
            choose(8)
            change(SET % ("dynamic", 0.9))
            browser.open("about:blank")


def test_the_cursor_stays_where_something_is_computed():
    with editing("tests/viewer/editable.txt"):
        choose(2)
        browser.run("viewer.playback.play(true); viewer.playback.seek(6000); viewer.beyond = [];")
        browser.run(
            "const grown = viewer.editor.piece.on.grown; viewer.editor.piece.on.grown = piece => {"
            "grown(piece); viewer.playback.advance(1); viewer.beyond.push(viewer.playback.at - 1000 * piece.scene.end) }"
        )
        browser.run("viewer.actions.pause(); viewer.playback.seek(6000)")
        change(SET % ("dynamic", 0.9))
        beyond = browser.run("return viewer.beyond")
        assert len(beyond) > 3 and max(beyond) <= 1e-6, beyond
        # seeking while it is computed
        browser.run("viewer.editor.piece.on.cut = () => (viewer.playback.seek(1e9), viewer.beyond.push(viewer.playback.at))")
        browser.run("viewer.beyond = []")
        change(SET % ("dynamic", 0.2))
        assert max(browser.run("return viewer.beyond")) < 3000


def test_a_reload_a_second_tab_and_a_killed_server_lose_nothing():
    with tempfile.TemporaryDirectory() as home:
        path = copied("tests/viewer/editable.txt", home)
        command = [VIEWER, "--no-browser", "--osc", "0", "--http", "0", "--edit", path]
        with Started(*command) as started:
            url = started.process.stdout.readline().split()[0]
            edits(url)
            choose(8)
            change(SET % ("dynamic", 0.9))
            score = saved_score()
            assert "stroke 8 left legato 0.9" in score
            # a reload, with the history
            browser.run("location.reload()")
            assert browser.wait("return !!(window.viewer && !viewer.changes)")
            edits()
            assert "1 change" in browser.run(SAID) and saved_score() == score
            assert browser.run("return viewer.editor.piece.text.undo") == 1
            # another tab
            tabs = [browser.call("GET", browser.session + "/window")]
            tabs.append(browser.call("POST", browser.session + "/window/new", {"type": "tab"})["handle"])
            turn = lambda i: browser.call("POST", browser.session + "/window", {"handle": tabs[i]})
            turn(1)
            edits(url)
            assert saved_score() == score
            choose(9)
            change(SET % ("nuance", "legato"))
            score = saved_score()
            turn(0)
            assert browser.wait("return viewer.editor.ends === 'taken'")
            assert "Another page" in browser.run(SAID)
            browser.run("document.getElementById('e-here').click()")
            assert browser.wait("return !viewer.editor.ends && viewer.editor.piece.over")
            assert "2 changes" in browser.run(SAID) and saved_score() == score
            turn(1)
            assert browser.wait("return viewer.editor.ends === 'taken'")
            browser.call("DELETE", browser.session + "/window")
            turn(0)
            # the server is killed: the page says so, plays what it has, and asks for no leave
            started.process.kill()
            assert browser.wait("return viewer.editor.ends === 'lost'")
            assert "has ended" in browser.run(SAID) and not browser.run("return viewer.editor.risky")
            browser.run("viewer.playback.seek(500); viewer.playback.play(true)")
            assert browser.wait("return viewer.playback.at > 700")
            browser.run("viewer.playback.play(false)")
            assert len(browser.log()) < 30  # refusals, fewer and fewer
            port = url.split(":")[2].split("/")[0]
        command[command.index("--http") + 1] = port
        with Started(*command) as started:
            url = started.process.stdout.readline().split()[0]
            browser.run("dispatchEvent(new Event('focus'))")  # the page is looked at again
            assert browser.wait("return viewer.editor.ends === 'refused'")
            assert "open the address" in browser.run(SAID)
            browser.open("about:blank")
            edits(url)
            assert "2 changes" in browser.run(SAID) and saved_score() == score
            browser.run("document.getElementById('e-revert').click()")
            assert browser.wait("return !viewer.editor.piece.text.undo && viewer.editor.piece.over")
            with open(path) as file:
                assert saved_score() == file.read()
        browser.log()


def test_a_page_that_would_lose_changes_asks_before_it_goes():
    """Where no journal can be written."""
    with tempfile.TemporaryDirectory() as home:
        path = copied("tests/viewer/editable.txt", home)
        with open(os.path.join(home, ".editable.txt.himc-edit"), "w") as file:
            file.write("something else")
        command = [VIEWER, "--no-browser", "--osc", "0", "--http", "0", "--edit", path]
        with Started(*command) as started:
            edits(started.process.stdout.readline().split()[0])
            assert "not a journal" in browser.run(SAID)
            assert not browser.run("return viewer.editor.risky")
            choose(8)
            change(SET % ("dynamic", 0.9))
            asks = "const e = new Event('beforeunload', { cancelable: true }); dispatchEvent(e); return e.defaultPrevented"
            assert browser.run(asks)
            undo_all()
            assert not browser.run(asks)
            browser.open("about:blank")


def packed(kind, data):
    data = zlib.compress(data, 9)
    return kind + struct.pack("<I", len(data)) + data


def test_a_scene_that_unpacks_without_end_is_refused():
    with open(FOUR, "rb") as file:
        good = file.read()
    size = struct.unpack_from("<I", good, 12)[0]
    first = json.loads(zlib.decompress(good[16 : 16 + size]))
    head, body = (next(e for e in first if e["event"] == wanted) for wanted in ("scene", "body"))

    def events(*what):
        return packed(b"json", json.dumps(what).encode())

    def rows(count):
        return packed(b"rows", struct.pack("<ddI", 0, 0.004, count))

    magic, most = good[:8], "more than 8388608 rows"
    nothing = b"[" + b",".join([b'{"event":"x","time":0}'] * 2800000) + b"]"
    cases = (
        (good, "read"),
        (magic + packed(b"json", b" " * (65 << 20)), "more than"),
        (magic + events(dict(head, columns=[]), body) + rows(0xFFFFFFFF), "a faulty scene"),
        (magic + events(head, body) + rows(0xFFFFFFFF), most),
        (good + events(dict(head, columns=head["columns"][:1])), "a second scene with other columns"),
        (magic + events(dict(head, columns=head["columns"][:1]), body) + rows(0), "nothing is in it"),
        (good + events(head), "read"),
        (magic + packed(b"json", nothing), most),
        (good + packed(b"json", b'[{"event":"note","time":0,"x":[' + b"[]," * 9000000 + b"[]]}]"), most),
        (good + events({"event": "note", "time": 0, "text": ',[{"' * 3000000}), "read"),
        (good + packed(b"ring", b"\xff" * 4), most),
    )
    with viewer():
        open_page()
        for i, (scene, wanted) in enumerate(cases):
            told = browser.run(
                "return viewer.readScene(Uint8Array.from(atob(arguments[0]), c => c.charCodeAt(0)), 'bomb.himc')"
                ".then(() => 'read', error => error.message)",
                base64.b64encode(scene).decode(),
            )
            assert told == wanted == "read" or (told.startswith("bomb.himc") and wanted in told), (i, told)


DROP = """
    const data = new DataTransfer();
    data.items.add(new File([arguments[0]], arguments[1]));
    viewer.panel.note("");
    dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
"""


def test_a_dropped_score_is_played_and_a_point_of_a_take_is_dragged():
    with tempfile.TemporaryDirectory() as home, editing("tests/viewer/editable.txt"):
        # what is refused changes nothing
        browser.run("viewer.playback.seek(2000)")
        before = browser.run("viewer.scene = viewer.playback.scene; return [viewer.playback.at, viewer.editor.piece.cuts]")
        for contents, name, why in (
            ("stroke 1 left boing f;", "bad.txt", "boing"),
            ("record x.bvh;stroke 1 left legato f;", "writes.txt", "names other files"),
            ("RIFF", "sound.wav", "expected a score"),
            ("not a capture", "bad.bvh", "bad.bvh"),
        ):
            browser.run(DROP, contents, name)
            assert browser.wait("return document.getElementById('note').textContent").startswith(name), name
            said = browser.run("return document.getElementById('note').textContent")
            assert why in said, said
        assert browser.run("return [viewer.playback.at, viewer.editor.piece.cuts]") == before
        assert browser.run("return viewer.playback.scene === viewer.scene")
        browser.run(DROP, "".join(f"stroke {b} right legato mf;" for b in range(4)), "dropped.txt")
        assert browser.wait("return viewer.editor.piece.text.statements.length === 4 && viewer.editor.piece.over")
        # undo goes back to what was before, redo forth again
        source = "return viewer.editor.piece.text.source.endsWith('%s') && viewer.editor.piece.over"
        for button, wanted in (("undo", "editable.txt"), ("redo", "dropped.txt")):
            browser.run(f"document.getElementById('e-{button}').click()")
            assert browser.wait(source % wanted), button
            assert browser.run("return ['e-undo', 'e-redo'].map(id => document.getElementById(id).disabled)") == [
                button == "undo", button == "redo"
            ]
        assert browser.wait("return viewer.editor.piece.text.statements.length === 4 && viewer.editor.piece.over")
        assert browser.wait("return viewer.playback.scene.strikes.length === 4")
        browser.run(
            "viewer.saved = null; viewer.editor.piece.on.saved = (name, bytes) => (viewer.saved = new File([bytes], name));"
            "document.getElementById('e-bvh').click()"
        )
        assert browser.wait("return !!viewer.saved")
        browser.run("viewer.editor.piece.send(viewer.saved)")
        assert browser.wait("return viewer.editor.piece.text.take && viewer.editor.piece.over")
        browser.run(
            "viewer.playback.play(false); viewer.actions.seek(2500);"
            "viewer.editor.choose({ take: true, hand: 'right', time: 2.5 })"
        )
        assert browser.wait("return viewer.editor.spot.visible && viewer.editor.group.visible")
        place = "return viewer.editor.points('right', 2.5).find(p => Math.abs(p.time - 2.5) < 0.005).toArray()"
        before = browser.run(place)
        browser.run(DRAG, "spot", 12, -12)
        assert browser.wait("return viewer.editor.heard.length === 1 && viewer.editor.piece.over")
        words = browser.run("return viewer.editor.piece.text.statements[0].words")
        way = [float(v) for v in words.split()[4:]]
        assert words.startswith("nudge right 1.5 0.3 ") and max(map(abs, way)) > 0.01, words
        after = browser.run(place)
        off = max(abs(b + w - a) for a, b, w in zip(after, before, way))
        assert off < 0.01, (words, before, after)
        # the same ball again changes the same line
        browser.run("viewer.playback.play(false)")
        assert browser.wait("return viewer.editor.spot.visible && viewer.editor.group.visible")
        browser.run(DRAG, "spot", -12, 12)
        heard(2)
        assert browser.run("return viewer.editor.piece.text.statements.length") == 1
        words = browser.run(WORDS)
        assert words.startswith("nudge right 1.5 0.3 "), words
        # the nudge is chosen on the timeline, moved in time, and drawn further
        browser.run("viewer.playback.play(false); viewer.actions.pick(viewer.editor.piece.nudges[0])")
        browser.run(RETIME, -0.2)
        heard(3)
        moved = browser.run(WORDS).split()
        assert abs(float(moved[2]) - 1.3) < 0.002 and moved[3:] == words.split()[3:], (words, moved)
        browser.run("viewer.playback.play(false)")
        assert browser.wait("return viewer.editor.spot.visible && viewer.editor.group.visible")
        browser.run(DRAG, "spot", 12, -12)
        heard(4)
        further = browser.run(WORDS).split()
        assert further[:4] == moved[:4] and further[4:] != moved[4:], (moved, further)
        undo_all()
        assert browser.run("return viewer.editor.piece.text.statements.length") == 0
        browser.run(
            "viewer.saved = null; document.getElementById('e-c3d').click()"
        )
        assert browser.wait("return viewer.saved && viewer.saved.name === 'dropped.c3d'")
        assert browser.run("return viewer.saved.arrayBuffer().then(b => new Uint8Array(b)[1])") == 0x50


# a click of the mouse there, as from the user
CLICK = """
    const stage = document.getElementById("stage"), [x, y] = arguments;
    stage.setPointerCapture = () => {}; // there is no true pointer
    for (const name of ["pointerdown", "pointerup"])
        stage.dispatchEvent(new PointerEvent(name, { clientX: x, clientY: y, button: 0, pointerId: 1, bubbles: true, cancelable: true }));
"""
# the page's key there: the timeline has the focus
KEY = "viewer.panel.timeline.canvas.dispatchEvent(new KeyboardEvent('keydown', { key: arguments[0], bubbles: true, cancelable: true }))"
# [x, y] on the window of a point of the path that is drawn for a hand, null if none is
ON_PATH = """
    const e = viewer.editor, made = e.group.visible && e.offered[arguments[0]];
    if (!made || !made.visible) return null;
    const p = made.geometry.attributes.position, i = p.count >> 1;
    return e.screen(e.spot.position.clone().set(p.getX(i), p.getY(i), p.getZ(i))).slice(0, 2);
"""
CHOSEN = "const c = viewer.editor.chosen; return c && [!!c.take, c.hand, c.time]"


def test_a_nudge_is_begun_on_the_page_of_a_take_without_one():
    """By a click on a path that is seen, and by keys: nothing is chosen for the user."""
    with tempfile.TemporaryDirectory() as home:
        score, take = os.path.join(home, "s.txt"), os.path.join(home, "nine.trc")
        with open(score, "w") as file:
            file.write("tempo 96; stroke 0 right legato mf; stroke 1 left accent f; stroke 2 right legato mf;")
        command = [HIMC, "render", score, "-o", os.path.join(home, "n.wav"), "--set", f"record {take}"]
        assert subprocess.run(command, capture_output=True).returncode == 0
        with editing(take):
            assert browser.run("return viewer.editor.piece.text.statements.length") == 0
            browser.run("viewer.actions.seek(1936)")
            for h, hand in enumerate(("left", "right")):
                assert browser.wait(f"return (() => {{{ON_PATH.replace('arguments[0]', str(h))}}})()", 20), "no path is drawn"
                browser.run(CLICK, *browser.run(ON_PATH, h))
                chosen = browser.run(CHOSEN)
                assert chosen and chosen[0] and abs(chosen[2] - 1.936) < 0.7, chosen
                assert browser.wait("return viewer.editor.spot.visible && !viewer.editor.offered.some(o => o.visible)")
                browser.run("viewer.editor.choose(null)")
                assert not browser.run("return viewer.editor.spot.visible || viewer.editor.path.visible")
            # enter chooses the point at the cursor, and again the other hand's; a key goes along its path
            browser.run(KEY, "Enter")
            first = browser.run(CHOSEN)
            assert first[0] and abs(first[2] - 1.936) < 1e-6, first
            browser.run(KEY, "Enter")
            assert {first[1], browser.run(CHOSEN)[1]} == {"left", "right"}
            browser.run(KEY, ".")
            _, hand, time_ = browser.run(CHOSEN)
            assert abs(time_ - 1.960) < 1e-6, time_
            # and the ball is dragged
            assert browser.wait("return viewer.editor.spot.visible && viewer.editor.group.visible")
            browser.run(DRAG, "spot", 12, -12)
            heard(1)
            words = browser.run(WORDS)
            assert words.startswith(f"nudge {hand} 0.96 0.3 "), words
            # enter at a nudge chooses that
            browser.run("viewer.playback.play(false); viewer.editor.choose(null); viewer.actions.seek(1960)")
            browser.run(KEY, "Enter")
            assert browser.run(WORDS) == words


def test_a_shared_page_plays_from_the_disk():
    """One file, no server: the same scene, with its sound, and nothing on the console."""
    html = os.path.join(MADE, "shared.html")
    done = subprocess.run([HIMC, "share", SCENE, "-o", html], capture_output=True, text=True)
    if "without three.js" in done.stderr:
        raise report.Ignored("himc was built without three.js")
    assert done.returncode == 0, done.stderr
    browser.log()
    browser.open("file://" + os.path.abspath(html))
    draw_when = "return !!(window.viewer && viewer.playback && viewer.panel.timeline.waves)"
    assert browser.wait(draw_when), browser.log()
    draw(False)
    expect("12.5")
    browser.run("viewer.playback.play(false); viewer.playback.seek(12500)")
    said = settle(1e-5)
    off = browser.run(SOUND_AGAINST_PICTURE)
    assert abs(off) < 20, off
    # the page before may still have asked its server
    trouble = [line for line in browser.log() if not line.startswith("http://")]
    assert not trouble, trouble
    seconds, size = browser.run("return viewer.playback.length") / 1000, os.path.getsize(html)
    assert size * 60 / seconds < 6e6, size
    return f"{said}, sound {off:.1f} ms off, {size * 60 / seconds / 1e6:.2f} MB a minute"


def test_a_browser_without_webgl_shows_a_drawing_and_says_so():
    """The shared page plays; it does not ask for a performer."""
    html = os.path.join(MADE, "shared.html")
    if not os.path.exists(html):
        raise report.Ignored("no page was shared")
    plain = Browser(480, 480, ["--disable-3d-apis"])
    try:
        plain.open("file://" + os.path.abspath(html))
        said = plain.wait("return document.getElementById('note').innerText", 30)
        assert "WebGL" in said, said
        assert plain.wait("return viewer.playback && viewer.joints()", 60), plain.log()
        shown = "return getComputedStyle(document.getElementById(arguments[0])).display"
        assert plain.run(shown, "wait") == "none" and plain.run(shown, "lost") == "none"
        # the camera glides up to its place
        plain.run("viewer.held = true; viewer.playback.play(false); for (let i = 0; i < 100; i++) viewer.step(100)")
        pictures = [
            plain.run(
                "viewer.playback.seek(arguments[0]); viewer.step(1);"
                "return viewer.stage.renderer.domElement.toDataURL()",
                at,
            )
            for at in (1000, 1000, 7000)
        ]
        assert pictures[0] == pictures[1] != pictures[2]
        assert not plain.log(), plain.log()
    finally:
        plain.close()


# A sine of which a loop has whole periods, as the audio thread meets it: the largest step between two
# samples, how many there were, and where the page says that the loop is (samples)
LOOP_WITHOUT_A_GAP = """
const { sound } = viewer, rate = sound.context.sampleRate, period = 200, code = `
registerProcessor("steps", class extends AudioWorkletProcessor {
    constructor() { super(); this.last = null; this.most = 0; this.count = 0; }
    process([[samples]]) {
        if (!samples) return true;
        for (const x of samples) {
            if (this.last !== null) this.most = Math.max(this.most, Math.abs(x - this.last));
            if (this.last !== null || x) { this.last = x; this.count++; }
        }
        if (this.count > 40000) this.port.postMessage([this.most, this.count]);
        return true;
    }
})`;
await sound.context.audioWorklet.addModule("data:text/javascript," + encodeURIComponent(code));
const ear = new AudioWorkletNode(sound.context, "steps"), kept = sound.buffer,
    buffer = (sound.buffer = sound.context.createBuffer(1, 20 * period, rate)), s = buffer.getChannelData(0);
for (let i = 0; i < s.length; i++) s[i] = Math.sin((2 * Math.PI * i) / period);
sound.stop();
sound.gain.connect(ear);
sound.play(0, 1, [(4 * period) / rate, (14 * period) / rate]);
const places = [], told = new Promise(done => (ear.port.onmessage = e => done(e.data)));
const look = setInterval(() => places.push(sound.place(sound.context.currentTime)), 5);
const [most, count] = await told;
clearInterval(look);
sound.stop(), sound.gain.disconnect(ear);
sound.buffer = kept;
return [most, count, Math.min(...places.slice(-20)) * rate, Math.max(...places.slice(-20)) * rate];
"""


def test_a_loop_sounds_without_a_gap():
    if not browser.run("return viewer.sound.ready"):
        browser.run("viewer.sound.wake()")
        assert browser.wait("return viewer.sound.ready"), "no sound device"
    most, count, low, high = browser.run(f"return (async () => {{{LOOP_WITHOUT_A_GAP}}})()")
    # the steepest step of that sine is 2 pi / 200
    assert most < 0.035 and count > 40000, (most, count)
    assert 799 <= low and high <= 2801, (low, high)
    return f"largest step {most:.4f} in {count} samples"


if __name__ == "__main__":
    browser = Browser(480, 480)
    try:
        bridge = viewer()
        tests = [f for name, f in list(globals().items()) if name.startswith("test_")]
        first = tests.index(test_a_stroke_is_dragged_heard_and_put_back)  # of those of editing
        parts = {"page": tests[:first], "edit": tests[first:]}
        code = report.run("tests/viewer/page.py", parts[sys.argv[1]])
        bridge.__exit__()
    finally:
        browser.close()
    sys.exit(code)
