"""`himc edit`: random changes of a score, also with pushes, and of a take; 300 with HIMC_LONG."""

import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile
import zlib

import report
from editing import Piece

HIMC = os.path.join(os.environ["HIMC_BUILD"], "bin/himc")
EDITS = 100 if os.environ.get("HIMC_LONG") else 2  # of each kind
COMPARED = 10 if os.environ.get("HIMC_LONG") else 2  # every so many with playing from the start
JUMP = 0.35  # (m/s) of a target's velocity beside what its acceleration explains, in 4 ms
SCORE = "tests/viewer/editable.txt"
NUANCES = ["legato", "tenuto", "accent", "vertical-accent", "staccato"]
PUSHED = ["trunk", "head", "left-upper-arm", "right-forearm", "left-hand", "right-stick"]
folder = tempfile.TemporaryDirectory(prefix="himc-edit-")


def targets(piece):
    """[time, six coordinates] of each row, and the times of the strikes."""
    rows, strikes, names = [], [], None
    for _, kind, data in piece.chunks:
        data = zlib.decompress(data)
        if kind == "json":
            for event in json.loads(data):
                if event["event"] == "scene":
                    names = [c[0] for c in event["columns"]]
                    step = event["columns"][names.index("left_target_x_m")][1]
                if event["event"] == "strike":
                    strikes.append((event["time"], event["duration"]))
        elif kind == "rows":
            start, period, count = struct.unpack_from("<ddI", data)
            columns = []
            for name in names:
                if "_target_" not in name:
                    continue
                at = 20 + 4 * count * names.index(name)
                value = slope = 0
                column = []
                for i in range(count):
                    folded = sum(data[at + p * count + i] << 8 * p for p in range(4))
                    slope += folded >> 1 ^ -(folded & 1)
                    value += slope
                    column.append(step * ((value + (1 << 31)) % (1 << 32) - (1 << 31)))
                columns.append(column)
            rows += [[start + i * period, *(c[i] for c in columns)] for i in range(count)]
    return rows, strikes


def largest_jump(piece):
    """Of the targets' velocities between two rows, beside the mean of the accelerations around; away
    from contacts, where the plan begins anew from what was measured (m/s)."""
    rows, strikes = targets(piece)
    worst = (0, 0)
    for k in range(1, 7):
        v = [(b[k] - a[k]) / 0.004 for a, b in zip(rows, rows[1:])]
        for i in range(2, len(v) - 2):
            t = rows[i][0]
            if any(s - 0.02 < t < s + d + 0.05 for s, d in strikes):
                continue
            jump = abs(v[i] - v[i - 1] - (v[i - 1] - v[i - 2] + v[i + 1] - v[i]) / 2)
            worst = max(worst, (jump, t))
    return worst


def from_start(piece):
    """The same text, played from the start."""
    path = os.path.join(folder.name, "again.txt")
    with open(path, "wb") as file:
        file.write(piece.score())
    with Piece(HIMC, path) as fresh:
        assert fresh.play("hello") is None
        return fresh


def random_stroke(piece):
    strokes = [s for s in piece.text["statements"] if "beat" in s]
    s = random.choice(strokes[random.choice([0, 2, 2]) * len(strokes) // 3 :])
    beat = s["beat"] + random.choice([0, 0, random.uniform(-0.2, 0.2)])
    return (
        f"set {s['index']} stroke {max(0, beat):.4f} {random.choice(['left', 'right'])}"
        f" {random.choice(NUANCES)} {random.uniform(0, 1):.3f}"
        f" {random.uniform(-0.2, 0.1):.3f} {random.uniform(-0.15, 0.15):.3f} {s['drum']}"
    )


def random_push_or_stroke(piece):
    old = [s["index"] for s in piece.text["statements"] if "push" in s]
    if random.random() < 0.5:
        return random_stroke(piece)
    index = random.choice([piece.text["count"], *old]) if len(old) < 8 else random.choice(old)
    last = max(s["beat"] for s in piece.text["statements"] if "beat" in s)
    force = " ".join(f"{random.uniform(-200, 200):.1f}" for _ in range(3))
    return (
        f"set {index} at {random.uniform(0, last):.3f} push {random.choice(PUSHED)}"
        f" {force} {random.uniform(0.02, 0.3):.3f}"
    )


def random_nudge(piece):
    old = [s["index"] for s in piece.text["statements"]]
    index = random.choice([piece.text["count"], *old]) if len(old) < 8 else random.choice(old)
    span = random.uniform(0.1, 0.6)
    way = " ".join(f"{random.uniform(-0.06, 0.06):.4f}" for _ in range(3))
    end = 0.55 * piece.ends - span  # what follows is the rest after the last stroke
    return (
        f"set {index} nudge {random.choice(['left', 'right'])}"
        f" {random.uniform(0.7 * end, end):.3f} {span:.3f} {way}"
    )


def edit_at_random(source, change, most=JUMP):
    random.seed(18)
    refused, worst, late = 0, (0, 0), 0
    with Piece(HIMC, source) as piece:
        assert piece.play("hello") is None
        piece.ends = max(piece.parts) / 48000
        original, first, done = piece.score(), dict(piece.parts), 0
        unedited = largest_jump(piece)[0]
        assert unedited < JUMP, unedited
        for i in range(EDITS):
            before = dict(piece.parts)
            trouble = piece.play(change(piece))
            if trouble:
                assert trouble["event"] in ("refused", "undone") and trouble["text"], trouble
                assert piece.parts == before
                refused += 1
                continue
            done += 1
            worst = max(worst, largest_jump(piece))
            assert worst[0] < most, f"{worst[0]:.2f} m/s at {worst[1]:.3f} s after edit {i}"
            late += piece.came_from > 0
            assert all(
                piece.parts[at] == part
                for at, part in before.items()
                if at < round(48000 * piece.came_from)
            )
            if i % COMPARED == COMPARED - 1:
                fresh = from_start(piece)
                different = [at for at in piece.parts if fresh.parts.get(at) != piece.parts[at]]
                assert fresh.parts == piece.parts, f"from {min(different) / 48000} s on"
        assert done > EDITS / 2 and late > 0, (done, late)
        edited = piece.score()
        for _ in range(done):
            assert piece.play("undo") is None
        assert piece.score() == original and piece.parts == first
        for _ in range(done):
            assert piece.play("redo") is None
        assert piece.score() == edited
    return f"{done} edits, {refused} refused, {late} from a copy, jumps up to {worst[0]:.3f} m/s"


def test_scores_changed_at_random_play_as_if_written_so():
    return edit_at_random(SCORE, random_stroke)


def test_scores_pushed_at_random_play_as_if_written_so():
    # a pushed stick misses its head, and its target goes on from where the stick is
    return edit_at_random(SCORE, random_push_or_stroke, most=math.inf)


def test_the_last_stroke_is_changed_after_the_end():
    path = os.path.join(folder.name, "two.txt")
    with open(path, "w") as file:
        file.write("stroke 0 right legato mf; stroke 1 left accent mf;")
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None
        before = dict(piece.parts)
        assert piece.play("set 1 stroke 1 left accent pp") is None
        assert from_start(piece).parts == piece.parts != before


def test_saved_takes_leave_no_open_file():
    path = os.path.join(folder.name, "short.txt")
    with open(path, "w") as file:
        file.write("stroke 0 right legato mf;")

    with Piece(HIMC, path) as piece:
        open_files = []
        assert piece.play("hello") is None
        for _ in range(3):
            piece.say("take take.trc")
            piece.until("file")
            assert piece.play("nothing") is not None  # all has been put away by then
            open_files.append(len(os.listdir(f"/proc/{piece.process.pid}/fd")))
        assert len(set(open_files)) == 1, open_files


def made_take():
    path, score = (os.path.join(folder.name, name) for name in ("take.bvh", "one.txt"))
    with open(score, "w") as file:
        for i in range(10):
            file.write(f"stroke {i / 2} {['right', 'left'][i % 2]} legato mf;\n")
    with Piece(HIMC, score) as piece:
        piece.play("hello")
        piece.say("take take.bvh")
        piece.until("file")
    with open(path, "wb") as file:
        file.write(piece.files["take.bvh"])
    return path


def test_takes_changed_at_random_play_as_if_written_so():
    return edit_at_random(made_take(), random_nudge)


def test_a_push_acts_at_its_beat_and_is_taken_back():
    score = os.path.join(folder.name, "three.txt")
    with open(score, "w") as file:
        file.write("tempo 120; stroke 1 right legato mf; roll 2 1 single p mf; stroke 4 left legato mf;")
    # beats; of a take seconds, and its first frame comes 1 s after `play`
    cases = [(score, 3.2, 1.6)]
    if os.environ.get("HIMC_LONG"):
        cases.append((made_take(), 0.4, 1.4))
    for source, at, time in cases:
        with Piece(HIMC, source) as piece:
            assert piece.play("hello") is None
            before, unpushed, count = dict(piece.parts), piece.score(), piece.text["count"]
            strikes = targets(piece)[1]
            assert piece.play(f"set {count} at {at} push left-forearm 60 0 40 0.15") is None
            last = piece.text["statements"][-1]
            assert (last["push"], last["at"], last["force"]) == ("left-forearm", at, [60, 0, 40])
            assert 0 < piece.came_from <= time
            changed = [k / 48000 for k in before if piece.parts.get(k) != before[k]]
            assert changed and time - 0.2 < min(changed) < time + 1, (time, changed[:3])
            assert abs(len(targets(piece)[1]) - len(strikes)) <= 1  # it plays on
            assert from_start(piece).parts == piece.parts
            assert piece.play(f"set {count} at {at} push left-forearm 0 0 0 0.15") is None
            assert piece.parts == before  # nothing but the force has changed the piece
            assert piece.play("undo") is None and piece.play("undo") is None
            assert piece.score().rstrip() == unpushed.rstrip() and piece.parts == before


def test_what_is_no_change_is_refused_in_a_line():
    with Piece(HIMC, SCORE) as piece:
        before = piece.score()
        for line in (
            "",
            "nonsense",
            "undo",
            "set",
            "set -1 stroke 1 right accent f",
            "set 9999 stroke 1 right accent f",
            "set 0 stroke 1 right accent f",
            "set 5 record /tmp/x.bvh",
            "set 5 stroke 1 right accent f; record /tmp/x.bvh",
            "set 5 stroke 1 right boing f",
            "set 5 stroke nan right accent f",
            "set 5 push head 1 0 0 0.1",
            "set 5 at 1 push pelvis 1 0 0 0.1",
            "set 5 at nan push head 1 0 0 0.1",
            "set 5 at 1 low tune 60",
            "take ../x.txt",
            "x" * 10000,
        ):
            event = piece.play(line)
            assert event and event["event"] == "refused" and len(event["text"]) > 5, (line, event)
        assert piece.score() == before


def test_a_score_that_names_files_is_refused_when_confined():
    path = os.path.join(folder.name, "reads.txt")
    with open(path, "w") as file:
        file.write("take /etc/passwd;\n")
    process = subprocess.run(
        [HIMC, "edit", "--confined", path], capture_output=True, text=True, input=""
    )
    assert process.returncode == 1 and process.stderr.count("\n") == 1, process
    assert "names other files" in process.stderr


TESTS = [f for name, f in list(globals().items()) if name.startswith("test_")]

if __name__ == "__main__":
    sys.exit(report.run("tests/viewer/edit.py", TESTS))
