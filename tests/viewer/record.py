"""What `himc render --scene` writes, against the tables of the same rendering."""

import csv
import json
import math
import os
import signal
import socket
import subprocess
import sys
import tempfile

import report
from bridge import osc
from scene import Scene

HIMC = os.path.join(os.environ["HIMC_BUILD"], "bin/himc")
SCORE = "tests/viewer/four.txt"
COLUMNS = "usual,torques,segments,root"
folder = tempfile.TemporaryDirectory(prefix="himc-scene-")


def path(name):
    return os.path.join(folder.name, name)


def render(*options, score=SCORE, sound="sound.wav"):
    command = [HIMC, "render", score, "-o", path(sound), *options]
    return subprocess.run(command, capture_output=True, text=True)


def scene(name="one.himc", *options):
    if not os.path.exists(path(name)):
        done = render(
            "--scene", path(name), "--motion", path("m.csv"), "--strokes", path("s.csv"),
            "--columns", COLUMNS, *options
        )
        assert done.returncode == 0, done.stderr
    with open(path(name), "rb") as file:
        return Scene(file.read())


def table(name):
    with open(path(name)) as file:
        return list(csv.DictReader(file))


def off_the_table(one, lines):
    """The largest distance of a value from the motion table's, in steps."""
    columns = one.of("scene")[0]["columns"]
    worst = 0
    for row, line in zip(one.rows, lines, strict=True):
        assert abs(row[0] - float(line["time_s"])) < 1e-6
        # the table has the pelvis' orientation as a quaternion, and nothing where nothing presses
        turn = [float(line[f"pelvis_q{k}"]) for k in "wxyz"]
        sine = math.hypot(*turn[1:])
        for k, q in zip("xyz", turn[1:]):
            line[f"pelvis_{k}_rad"] = 2 * math.atan2(sine, turn[0]) * q / sine if sine else 0.0
        for (name, step), value in zip(columns, row[1:], strict=True):
            there = float(line[name] or "nan")
            worst = max(worst, abs(value - (0 if math.isnan(there) else there)) / step)
    return worst


def test_rows_are_those_of_the_motion_table_within_half_a_step():
    one = scene()
    worst = off_the_table(one, table("m.csv"))
    assert worst < 0.51, worst
    return f"{len(one.rows)} rows within {worst:.3f} of a step"


def test_a_pelvis_that_is_free_moves_in_the_rows_of_one_body():
    files = ("--scene", path("seated.himc"), "--motion", path("seated.csv"))
    done = render(*files, "--columns", COLUMNS, score="tests/viewer/seated.txt", sound="seated.wav")
    assert done.returncode == 0, done.stderr
    with open(path("seated.himc"), "rb") as file:
        one = Scene(file.read())
    worst = off_the_table(one, table("seated.csv"))
    assert worst < 0.51, worst
    names = [name for name, _ in one.of("scene")[0]["columns"]]
    at = [1 + names.index(name) for name in ("pelvis_position_x_m", "pelvis_y_rad", "seat_force_z_n")]
    moved, turned, eased = (max(r[k] for r in one.rows) - min(r[k] for r in one.rows) for k in at)
    assert moved > 0.01 and turned > 0.05 and eased > 200, (moved, turned, eased)
    # his measures do not change: a scene of half an hour stays small
    assert len(one.of("body")) == 1, len(one.of("body"))
    return f"{1000 * moved:.0f} mm, {turned:.2f} rad, within {worst:.3f} of a step"


def test_strikes_are_those_of_the_table_with_their_beats():
    strikes = scene().of("strike")
    for strike, line in zip(strikes, table("s.csv"), strict=True):
        for name in ("hand", "drum", "nuance"):
            assert strike[name] == line[name]
        for name, column in (("time", "time_s"), ("x", "x_m"), ("force", "peak_force_n")):
            assert abs(strike[name] - float(line[column])) < 1e-3, (name, strike, line)
    assert [s["beat"] for s in strikes] == [1 + i / 2 for i in range(9)]


def test_drums_have_places_tunings_and_settings():
    drums = {d["name"]: d for d in scene().of("drum")}
    assert list(drums) == ["low", "second", "third", "high"]
    place = drums["third"]["place"]
    assert all(abs(a - b) < 1e-6 for a, b in zip(place, (0.763, -0.439, 0.85, 0.1, 0.3302)))
    assert len(place) == 7 and place[5:] == [0, 0]  # no sides
    assert abs(drums["low"]["hz"] - 73.42) < 0.5 and "mallet hard" in drums["third"]["settings"]


def test_the_body_is_that_of_the_player():
    body = scene().of("body")[0]
    assert len(body["segments"]) == 20 and body["segments"][0]["parent"] == -1
    assert abs(body["segments"][0]["origin"][2] - 0.42 * 1.64) < 1e-6


def test_heads_move_most_after_their_strikes():
    one = scene()
    for drum in one.of("drum"):
        frames = [(max(map(abs, q)), time) for time, number, q, _ in one.heads if number == drum["drum"]]
        most, time = max(frames)
        struck = [s["time"] for s in one.of("strike") if s["drum"] == drum["name"]]
        assert 1e-5 < most < 0.01 and any(0 < time - t < 0.3 for t in struck), (drum["name"], most, time)


def test_between_two_frames_a_head_rings_freely():
    """From one frame to the next, by the frequencies and decays in the scene, to the rounding."""
    with open(path("two.txt"), "w") as file:
        file.write("stroke 1 left accent f;\nstroke 2 right legato mf;\n")
    command = [HIMC, "render", path("two.txt"), "-o", path("two.wav"), "--scene", path("two.himc")]
    assert subprocess.run(command, capture_output=True).returncode == 0
    with open(path("two.himc"), "rb") as file:
        one = Scene(file.read())
    modes, tried, worst = one.of("modes")[-1]["modes"], 0, 0
    loud = [s["time"] for s in one.of("strike")]  # a loud head is stiffer
    for (t, _, q, s), (t1, _, q1, _) in zip(one.heads, one.heads[1:]):
        if t1 - t > 0.05 or any(t - 0.5 < blow < t1 for blow in loud):
            continue
        step = max(map(abs, q + s)) / 127
        for k, (hz, d) in enumerate(modes):
            w0 = 2 * math.pi * hz
            w = math.sqrt(w0 * w0 - d * d)
            there = math.exp(-d * (t1 - t)) * (
                q[k] * math.cos(w * (t1 - t)) + (s[k] * w0 + d * q[k]) / w * math.sin(w * (t1 - t))
            )
            worst, tried = max(worst, abs(there - q1[k]) / step), tried + 1
    assert tried > 1000 and worst < 1.5, (tried, worst)
    return f"{tried} modes within {worst:.2f} of a step"


def test_it_ends_with_the_sound_and_is_small():
    one = scene()
    seconds = one.of("end")[0]["time"]
    with open(path("sound.wav"), "rb") as file:
        frames = (len(file.read()) - 80) / 8
    assert abs(frames / 48000 - seconds) < 1e-3, (frames / 48000, seconds)
    assert one.sound.startswith(b"OggS")
    minute = 60 / seconds * sum(one.size.values())
    assert minute < 4e6, minute
    return f"{minute / 1e6:.2f} MB a minute"


def test_block_size_changes_nothing_but_the_looks_at_the_heads():
    one, other = scene(), scene("other.himc", "--block", "1000")
    assert one.rows == other.rows and one.of("strike") == other.of("strike")
    assert one.of("body") == other.of("body") and one.of("beat") == other.of("beat")


def test_others_and_the_take_itself_are_in_the_scene():
    """The take is what this program played, so its joints are those of that playing."""
    with open(path("two.txt"), "w") as file:
        file.write("stroke 1 left accent f;\nstroke 2 right legato mf;\n")
    for source, *options in (
        [path("two.txt"), "--set", f"record {path('two.bvh')}", "--scene", path("played.himc")],
        [path("two.bvh"), "--scene", path("others.himc"), "--compare", "himc,ik,captured"],
    ):
        command = [HIMC, "render", source, "-o", path("two.wav"), *options]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    with open(path("played.himc"), "rb") as file:
        played = Scene(file.read())
    with open(path("others.himc"), "rb") as file:
        one = Scene(file.read())
    ik, captured = one.more
    assert [s.of("scene")[0]["name"] for s in (one, ik, captured)] == ["himc", "ik", "captured"]
    assert len(ik.rows) == len(one.rows) == len(captured.rows)
    assert not ik.sound and not captured.sound and not captured.of("strike")
    names = [name for name, _ in one.of("scene")[0]["columns"]]
    joints = [i + 1 for i, name in enumerate(names) if name.endswith("_rad")]
    struck = [s.of("strike")[0]["time"] for s in (played, one)]
    # a frame of the take lies up to half a row beside a row; 0.05 rad: a whole row beside it
    off = round(250 * (struck[1] - struck[0]))
    worst = max(
        abs(captured.rows[i + off][c] - played.rows[i][c]) for i in range(100, 500) for c in joints
    )
    assert worst < 0.04, worst
    return f"within {worst:.4f} rad"


def serve(perform):
    """himc serve --scene, driven by perform(say, strikes), and ended; the scene, and what it says last.
    say(address, ...) sends a command, strikes(n) waits for so many strikes."""
    with open(path("serve.txt"), "w") as file:
        file.write("tempo 120;\nstroke 1 left legato p;\nstroke 2 right accent f;\n")
    command = [HIMC, "serve", "--port", "0", "--scene", path("live.himc"), path("serve.txt")]
    live = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    port = int(live.stdout.readline().split()[-1])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.bind(("127.0.0.1", 0))
        udp.settimeout(60)

        def say(*message):
            udp.sendto(osc(*message), ("127.0.0.1", port))

        def strikes(count):
            for _ in range(count):
                while b"/himc/strike" not in udp.recv(4096):
                    pass

        say("/himc/subscribe", "127.0.0.1", udp.getsockname()[1], "strikes")
        perform(say, strikes)
    live.send_signal(signal.SIGTERM)
    told = json.loads(live.communicate(timeout=60)[0].splitlines()[-1])
    with open(path("live.himc"), "rb") as file:
        return Scene(file.read()), told


def test_what_is_served_is_recorded():
    """The strikes that were asked for, their sound."""
    one, told = serve(lambda say, strikes: (say("/himc/play"), strikes(2)))
    times = [row[0] for row in one.rows]
    assert all(abs(b - a - 0.004) < 1e-6 for a, b in zip(times, times[1:])), "rows are missing"
    assert abs(one.of("end")[0]["time"] - told["blocks"] * 96 / 48000) < 1e-6, told
    assert [s["hand"] for s in one.of("strike")][:2] == ["left", "right"], one.of("strike")
    assert one.sound[:4] in (b"OggS", b"RIFF") and len(one.heads) > 5
    return f"{len(times)} rows, {told['late']} of {told['blocks']} blocks late"


def test_a_recording_goes_on_when_the_performer_is_reset():
    """`reset` counts the performer's time from 0 again: the recording has one time, and all of the sound."""

    def perform(say, strikes):
        say("/himc/hit", "left", "accent", "f"), strikes(1)
        say("/himc/reset")
        for hand in ("right", "left"):
            say("/himc/hit", hand, "accent", "f"), strikes(1)

    one, told = serve(perform)
    times, struck = [row[0] for row in one.rows], one.of("strike")
    assert all(b > a for a, b in zip(times, times[1:])), "time goes back"
    assert abs(one.of("end")[0]["time"] - told["blocks"] * 96 / 48000) < 1e-6, told
    assert [s["hand"] for s in struck] == ["left", "right", "left"], struck
    first, right, left = [s["time"] for s in struck]
    assert right > first + 0.1, struck
    # all before the last strike is in the recording, however soon it ends after that
    heads = [frame[0] for frame in one.heads]
    assert heads == sorted(heads) and any(right < time < left for time in heads), (heads, struck)
    rate, samples = one.heard()
    blow = round(right * rate)
    assert max(map(abs, samples[blow : blow + 2400])) > 10 * max(map(abs, samples[blow - 2400 : blow]))


def test_a_film_without_a_browser_is_refused_in_one_line():
    scene()
    lacking = dict(os.environ, HIMC_BROWSER="/nowhere")
    command = [HIMC, "film", path("one.himc"), "-o", path("film.webm")]
    done = subprocess.run(command, capture_output=True, text=True, env=lacking)
    assert done.returncode == 1 and done.stderr.count("\n") == 1, done
    assert "Debian: " in done.stderr and not os.path.exists(path("film.webm")), done.stderr


def test_a_file_that_is_named_twice_is_refused():
    done = render("--scene", path("sound.wav"))
    assert done.returncode == 1 and "named twice" in done.stderr, done.stderr


def test_what_is_no_scene_is_not_shared():
    for name, why in (("Makefile", "not a scene"), ("/nowhere.himc", "cannot be read")):
        command = [HIMC, "share", name, "-o", path("page.html")]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 1 and done.stderr.count("\n") == 1, done
        assert why in done.stderr or "without three.js" in done.stderr, done.stderr
        assert not os.path.exists(path("page.html"))


def test_a_shared_page_has_the_licence_of_what_it_contains():
    scene()
    command = [HIMC, "share", path("one.himc"), "-o", path("shared.html")]
    done = subprocess.run(command, capture_output=True, text=True)
    if "without three.js" in done.stderr:
        raise report.Ignored(done.stderr.strip())
    with open(path("shared.html"), encoding="utf-8") as file:
        page = " ".join(file.read().split())
    for notice in ("© 2010-2019 three.js authors", "shall be included in all copies", "WITHOUT WARRANTY OF ANY KIND"):
        assert notice in page, notice
    with open(path("shared.html"), "rb") as file:
        assert b'charset="utf-8"' in file.read(1024)  # where browsers look for it


def test_what_is_played_is_what_is_rendered():
    """A sound card that is a file: the samples are those of the WAV file, bit by bit."""
    with open(path("asound.conf"), "w") as file:
        file.write(
            "</usr/share/alsa/alsa.conf>\n"
            f'pcm.!default {{ type file file "{path("played")}" format "raw" slave.pcm "null" }}\n'
        )
    card = dict(os.environ, ALSA_CONFIG_PATH=path("asound.conf"))
    command = [HIMC, "play", SCORE]
    done = subprocess.run(command, capture_output=True, text=True, env=card)
    if "without PortAudio" in done.stderr or "no sound card" in done.stderr:
        raise report.Ignored(done.stderr.strip())
    assert done.returncode == 0, done.stderr
    scene()
    with open(path("played"), "rb") as played, open(path("sound.wav"), "rb") as rendered:
        sound, heard = rendered.read().split(b"data", 1)[1][4:], played.read()
        both = min(len(sound), len(heard))  # they look for the end in other blocks
        assert both > 2000000 and heard[:both] == sound[:both]
    told = json.loads(done.stdout.splitlines()[-1])
    assert told["underruns"] == 0 and told["seconds"] > 5, told


if __name__ == "__main__":
    code = report.run(
        "tests/viewer/record.py",
        [f for name, f in list(globals().items()) if name.startswith("test_")],
    )
    folder.cleanup()
    sys.exit(code)
