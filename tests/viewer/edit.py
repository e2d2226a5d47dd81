"""`himc edit`: random changes of a score, also with pushes, and of a take; 300 with HIMC_LONG."""

import contextlib
import json
import math
import os
import random
import resource
import struct
import subprocess
import sys
import tempfile
import zlib

import report
from bridge import processes, wait_until_gone
from editing import Piece

HIMC = os.path.join(os.environ["HIMC_BUILD"], "bin/himc")
EDITS = 100 if os.environ.get("HIMC_LONG") else 2  # of each kind
COMPARED = 10 if os.environ.get("HIMC_LONG") else 2  # every so many with playing from the start
JUMP = 0.35  # (m/s) of a target's velocity beside what its acceleration explains, in 4 ms
SCORE = "tests/viewer/editable.txt"
NUANCES = ["legato", "tenuto", "accent", "vertical-accent", "staccato"]
PUSHED = ["trunk", "head", "left-upper-arm", "right-forearm", "left-hand", "right-stick"]
folder = tempfile.TemporaryDirectory(prefix="himc-edit-")
os.environ["XDG_STATE_HOME"] = os.path.join(folder.name, "state")


def made(name, contents):
    """A file in a folder of its own, so that no journal stands beside it."""
    path = os.path.join(tempfile.mkdtemp(dir=folder.name), name)
    with open(path, "wb") as file:
        file.write(contents if isinstance(contents, bytes) else contents.encode())
    return path


def read(path):
    with open(path, "rb") as file:
        return file.read()


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
    with Piece(HIMC, made("again.txt", piece.score())) as fresh:
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
    return edit_at_random(made("piece.txt", read(SCORE)), random_stroke)


def test_scores_pushed_at_random_play_as_if_written_so():
    # a pushed stick misses its head, and its target goes on from where the stick is
    return edit_at_random(made("piece.txt", read(SCORE)), random_push_or_stroke, most=math.inf)


def test_the_last_stroke_is_changed_after_the_end():
    path = made("two.txt", "stroke 0 right legato mf; stroke 1 left accent mf;")
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None
        before = dict(piece.parts)
        assert piece.play("set 1 stroke 1 left accent pp") is None
        assert from_start(piece).parts == piece.parts != before


def test_saved_takes_leave_no_open_file():
    path = made("short.txt", "stroke 0 right legato mf;")
    with Piece(HIMC, path) as piece:
        open_files = []
        assert piece.play("hello") is None
        for _ in range(3):
            piece.say("take take.trc")
            piece.until("file")
            assert piece.play("nothing") is not None  # all has been put away by then
            open_files.append(len(os.listdir(f"/proc/{piece.process.pid}/fd")))
        assert len(set(open_files)) == 1, open_files


def test_processes_and_files_of_a_save_end_with_the_program():
    path = made("long.txt", "".join(f"stroke {i} right legato mf;\n" for i in range(60)))

    def close(piece):
        piece.process.stdin.close()
        piece.process.stdout.close()

    ends = {"its input": close, "SIGTERM": lambda p: p.process.terminate(), "kill -9": lambda p: p.process.kill()}
    for played in (True, False):
        for name, end in ends.items():
            home = tempfile.mkdtemp(dir=folder.name)
            piece = Piece(HIMC, path, TMPDIR=home)
            if played:  # so that there are copies from before the save, too
                piece.say("hello")
                piece.until("pcm ")
            piece.say("take x.bvh")
            if played:
                piece.say("hello")
                assert piece.until("text")["begun"]
                piece.until("from")
            while not os.listdir(home) or len(running := processes(piece)) < (3 if played else 1):
                pass
            end(piece)
            piece.process.wait(60)
            wait_until_gone(running)
            assert name == "kill -9" or not os.listdir(home), (name, os.listdir(home))


def made_take():
    strokes = (f"stroke {i / 2} {['right', 'left'][i % 2]} legato mf;\n" for i in range(10))
    with Piece(HIMC, made("one.txt", "".join(strokes))) as piece:
        piece.play("hello")
        piece.say("take take.bvh")
        piece.until("file")
    return made("take.bvh", piece.files["take.bvh"])


def test_a_saved_score_names_a_sent_take_as_it_was_sent():
    with Piece(HIMC, made_take(), "--confined", "--name", "my take.bvh") as piece:
        assert piece.play("hello") is None
        piece.say("save")
        piece.until("file")
        assert piece.files == {"my take.txt": b"take my\\ take.bvh;\n"}, piece.files


def test_takes_changed_at_random_play_as_if_written_so():
    return edit_at_random(made_take(), random_nudge)


def test_a_push_acts_at_its_beat_and_is_taken_back():
    score = made(
        "three.txt",
        "tempo 120; stroke 1 right legato mf; roll 2 1 single p mf; stroke 4 left legato mf;",
    )
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
    with Piece(HIMC, made("piece.txt", read(SCORE))) as piece:
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


def test_the_answer_to_bytes_that_are_no_text_is_json():
    path = made("one.txt", "stroke 0 left legato mf;")
    said = subprocess.run([HIMC, "edit", path], input=b"set 0 stroke \xe9 1\n", capture_output=True).stdout
    event = json.JSONDecoder().raw_decode(said[said.index(b"{") :].decode())[0]
    assert event["event"] == "refused" and event["line"] == "set 0 stroke \ufffd 1", event


def test_a_segment_that_nobody_has_is_refused_at_once():
    """As any other misspelt word: nothing is played again, and the journal has nothing of it."""
    path = made("two.txt", "stroke 0 left legato f;\nstroke 1 right legato f;\n")
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None
        before = piece.score()
        for line in ("at 1 push rihgt-hand 50 0 0 0.1", "at 1 push pelvis 50 0 0 0.1 0.1", "stroke 1 rihgt legato f"):
            event = piece.play(f"set {piece.text['count'] - 1} {line}")
            assert event["event"] == "refused" and line.split()[3 if "push" in line else 2] in event["text"], event
            assert event["line"].endswith(line) and "undone" not in piece.said, event
        assert piece.score() == before
        assert not os.path.exists(os.path.join(os.path.dirname(path), ".two.txt.himc-edit"))
        assert piece.play(f"set {piece.text['count'] - 1} at 1 push right-hand 50 0 0 0.1") is None
        assert piece.text["line"].endswith("at 1 push right-hand 50 0 0 0.1")


def test_a_score_that_names_files_is_refused_when_confined():
    """However it is written: the score is asked as it will be played."""
    victim = made("victim.bvh", "PRECIOUS")
    mark, stroke = "\ufeff", "stroke 1 left accent f;"
    for text in (
        "take /etc/passwd;",
        f"{mark}record {victim};\n{stroke}",
        f"{mark}take /etc/passwd;{stroke}",
        "drum kettle;\nkettle shape /etc/passwd;" + stroke,
        f"{stroke} rec\\ord\t{victim}",
        f"\v\f\r\n\trecord\n{victim}\n;{stroke}",
        f"comment one\\; two;record {victim};{stroke}",
        f"units {victim} legato rim;{stroke}",
        f"kettle tune 110;kettle\fsh\\ape /etc/passwd;{stroke}",
    ):
        process = subprocess.run(
            [HIMC, "edit", "--confined", made("piece.txt", text)],
            capture_output=True,
            input=b"hello\n",
        )
        assert process.returncode == 1 and process.stderr.count(b"\n") == 1, (text, process)
        assert b"names other files" in process.stderr, (text, process.stderr)
        assert read(victim) == b"PRECIOUS", text
    for text in (f"comment record {victim};{stroke}", f"{mark}{stroke} kettle shape circle;"):
        with Piece(HIMC, made("piece.txt", text), "--confined") as piece:
            assert piece.play("hello") is None, text
            assert [s["words"] for s in piece.text["statements"]] == [stroke[:-1]], text


def test_a_file_that_is_no_score_is_refused_as_by_render():
    """Nothing is read as if it ended at a zero byte."""
    stroke = b"stroke 1 right legato mf;\n"
    for bytes_ in (stroke + b"\0record x.bvh;\n", stroke + b"\0", b"\0" + stroke, b"%PDF-1.4\n" + stroke):
        path = made("nul.txt", bytes_)
        said = set()
        for call in (["render", "-o", "/dev/null", path], ["info", path], ["edit", path]):
            done = subprocess.run([HIMC, *call], capture_output=True, input=b"hello\n")
            assert done.returncode == 1, (call, done)
            said.add(done.stderr.decode().split(": ", 1)[1])
        assert len(said) == 1 and "expected a score" in (line := said.pop()), said
        sent = [HIMC, "edit", path, "--confined", "--name", "my.txt"]
        done = subprocess.run(sent, capture_output=True, input=b"hello\n")
        assert done.stderr.decode() == f"himc edit: {line.replace(path, 'my.txt')}", done
        assert b'"failed"' in done.stdout and done.stdout.count(b"edit") == 1, done


def test_a_change_changes_its_words_alone():
    text = (
        "\ufeffstroke 0  right\tlegato mf; comment a; b ;\n"
        "  stroke 1\n    left   accent f   rim ; flam 3 right accent f;\tstroke 4 left legato pp"
    )
    text = text.replace("; b ;", "\\; b ;")
    with Piece(HIMC, made("spaces.txt", text)) as piece:
        piece.say("hello")
        words = [s["words"] for s in piece.until("text")["statements"]]
        assert words[1].split() == "stroke 1 left accent f rim".split(), words
        for index, line, wanted in (
            (0, "stroke 0 right legato ppp", ("mf;", "ppp;")),
            (2, "stroke 1 left accent f 0.1 0.2", ("rim ;", "0.1 0.2 ;")),
            (2, "stroke 1 left accent f", ("   rim ;", " ;")),
            (2, "stroke 1 left accent mf rim", ("accent f   rim", "accent mf   rim")),
            (2, "stroke 1 right accent f rim", ("    left   ", "    right   ")),
            (3, "flam 3 right accent f rim", ("flam 3 right accent f;", "flam 3 right accent f rim;")),
            (4, "stroke 4.5 left legato pp", ("stroke 4 ", "stroke 4.5 ")),
            (0, "stroke 0 right legato mf", ("", "")),
        ):
            piece.say(f"set {index} {line}")
            assert piece.until("text")["event"] == "text", line
            assert piece.score().decode() == text.replace(*wanted).rstrip(";") or (
                piece.score().decode() == text.replace(*wanted) + ";"
            ), (line, piece.score())
            piece.say("undo")
            piece.until("text")
            assert piece.score().decode() == text


def test_what_is_refused_leaves_what_could_be_done_again():
    with Piece(HIMC, made("two.txt", "stroke 0 right legato mf;stroke 1 right legato mf;")) as piece:
        piece.say("hello")
        piece.until("text")
        piece.say("set 1 stroke 1 right legato ff")
        piece.until("text")
        piece.say("undo")
        assert piece.until("text")["redo"] == 1
        piece.say("set 1 stroke 0.01 right legato ff")  # too near to the first
        assert piece.until("text")["event"] == "refused"
        piece.say("redo")
        event = piece.until("text")
        assert event["redo"] == 0 and event["statements"][1]["dynamic"] == 6 / 7, event


PUSH = "at 0 push head 1 0 0 0.1"


def test_the_change_that_cannot_be_played_is_taken_back_alone():
    strokes = "stroke 0 left legato f;\nstroke 1 right legato f;\n"
    bad, good = "set 0 stroke 0 left legato f tympani", "set 1 stroke 1 right legato mf"
    with Piece(HIMC, made("two.txt", strokes)) as piece:
        assert piece.play("hello") is None
        piece.say(f"{bad}\n{good}")
        event = piece.until("text")
        assert event["event"] == "refused" and "tympani: no " in event["text"], event
        assert "kettle" in event["text"], event
        piece.until("over")
        assert piece.text["undo"] == 1 and "undone" not in piece.said
        assert piece.score().decode() == strokes.replace("right legato f", "right legato mf")
        assert piece.play("set 0 stroke 0 left legato p kettle") is None
    # one more push than a score may have is only found when it is to be played
    path = made("pushes.txt", strokes + (PUSH + ";\n") * 256)
    for sent_with_hello in (False, True):
        with Piece(HIMC, path) as piece:
            if not sent_with_hello:
                assert piece.play("hello") is None
            lines = [f"set 258 {PUSH}", good, "set 0 stroke 0 left legato p"]
            piece.say("\n".join(["hello"] * sent_with_hello + lines))
            assert "one too many" in piece.until("undone")["text"]
            while piece.text["undo"] < 2:
                assert piece.until("text")["event"] == "text"
            wanted = strokes.replace("right legato f", "right legato mf").replace("left legato f", "left legato p")
            assert piece.score().decode().strip() == (wanted + (PUSH + ";\n") * 256).strip()
            assert "failed" not in piece.said and piece.play("set 0 stroke 0 left legato pp") is None
            piece.say("revert")
            piece.until("text")
            assert piece.play("undo")["event"] == "refused"
            piece.process.kill()
        os.unlink(os.path.join(os.path.dirname(path), ".pushes.txt.himc-edit"))


def test_a_change_that_cannot_be_played_leaves_undo_and_redo():
    """Found only when it is to be played: as if it had never been, also for whoever opens the piece again."""
    strokes = "stroke 0 left legato f;\nstroke 1 right legato f;\n"
    path = made("pushes.txt", strokes + (PUSH + ";\n") * 256)
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None
        for line in ("set 0 stroke 0 left legato p", "set 1 stroke 1 right legato mf", "undo"):
            assert piece.play(line) is None
        before, steps = piece.score(), (piece.text["undo"], piece.text["redo"])
        assert steps == (1, 1)
        for _ in range(2):
            assert piece.play(f"set 258 {PUSH}")["event"] == "undone"
            assert piece.score() == before and (piece.text["undo"], piece.text["redo"]) == steps
        piece.process.kill()
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None
        assert piece.score() == before and (piece.text["undo"], piece.text["redo"]) == steps
        assert piece.play("redo") is None
        assert piece.text["statements"][1]["words"].endswith("mf") and piece.text["undo"] == 2


def test_words_that_are_there_already_are_no_change():
    text = "stroke 0  right legato mf; flam 1 left accent f ;"
    path = made("two.txt", text)
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None
        for line in ("set 0 stroke 0 right legato mf", "set 1 flam 1 left accent f", "set 2 ", "set 0 stroke 0 right  legato mf"):
            piece.say(line)
            event = piece.until("text")
            assert event["event"] == "text" and (event["undo"], event["redo"]) == (0, 0), (line, event)
        assert piece.play("undo")["event"] == "refused" and piece.score().decode() == text
    assert os.listdir(os.path.dirname(path)) == ["two.txt"]  # nor a journal


def test_a_score_under_edit_records_nothing():
    victim = made("victim.bvh", "PRECIOUS")
    stroke = "stroke 0 right legato mf;"
    for index, text in (
        (1, f"record {victim};\n{stroke}"),
        (1, f"rec\\ord\t{victim};{stroke}record stop;"),
        (0, f"{stroke}\nrecord\n {victim}"),
    ):
        with Piece(HIMC, made("piece.txt", text)) as piece:
            assert piece.play("hello") is None, text
            assert victim in piece.said["held"] and "nothing is recorded" in piece.said["held"], piece.said
            assert piece.play(f"set {index} stroke 0 right legato ff") is None
            assert b"ff" in piece.score() and victim.encode() in piece.score()
            piece.say("take take.trc")
            piece.until("file")
        assert read(victim) == b"PRECIOUS", text
    with Piece(HIMC, made("piece.txt", stroke)) as piece:
        assert piece.play("hello") is None and "held" not in piece.said


def test_changes_survive_kill_9():
    text = read(SCORE)
    path = made("piece.txt", text)
    journal = os.path.join(os.path.dirname(path), ".piece.txt.himc-edit")
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None and not os.path.exists(journal)
        for line in ("set 9 stroke 0.5 right legato ff", "set 9 stroke 0.5 right legato pp", "undo"):
            assert piece.play(line) is None
        edited = piece.score()
        piece.process.kill()
    assert edited != text and os.stat(journal).st_mode & 0o777 == 0o600
    with open(journal, "ab") as file:
        file.write(b"set 9 stro")  # the last line was cut short
    for _ in range(2):
        with Piece(HIMC, path) as piece:
            piece.say("hello")
            event = piece.until("restored")
            assert (piece.text["undo"], piece.text["redo"]) == (1, 1) and "1 change from before is here again" in event["text"]
            assert "brings it again" in event["text"], event
            assert piece.score() == edited
            for line, wanted in (("undo", text), ("redo", edited), ("revert", text), ("redo", edited)):
                piece.say(line)
                assert piece.until("text")["kept"] and piece.score() == wanted, line
            piece.process.kill()
    assert read(path) == text


def test_a_file_that_has_changed_keeps_what_was_edited():
    path = made("piece.txt", "stroke 0 right legato mf;")
    beside = os.path.dirname(path)

    def change(line):
        with Piece(HIMC, path) as piece:
            piece.say("hello")
            piece.until("text")
            piece.say(line)
            piece.until("text")
            return piece.score()

    edited = change("set 0 stroke 0 right legato ff")
    with open(path, "w") as file:
        file.write("stroke 2 left accent p;")
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        event = piece.until("restored")
        assert "piece.txt has changed" in event["text"] and piece.text["undo"] == 0
    kept = [name for name in os.listdir(beside) if name != "piece.txt"]
    assert len(kept) == 1 and kept[0] in event["text"], (kept, event)
    assert read(os.path.join(beside, kept[0])) == edited
    os.unlink(os.path.join(beside, kept[0]))
    # an edited score that was saved over its source is no change any more
    edited = change("set 0 stroke 2 left accent ff")
    with open(path, "wb") as file:
        file.write(edited)
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None
        assert piece.text["undo"] == 0 and "restored" not in piece.said
    assert os.listdir(beside) == ["piece.txt"]


def test_one_program_at_a_time_keeps_the_changes_of_a_piece():
    path = made("piece.txt", "stroke 0 right legato mf;")
    with Piece(HIMC, path) as first:
        first.say("hello")
        first.until("text")
        first.say("set 0 stroke 0 right legato ff")
        assert first.until("text")["kept"]
        with Piece(HIMC, path) as second:
            second.say("hello")
            assert "another program" in second.until("unkept")["text"]
            second.say("set 0 stroke 0 right legato ppp")
            event = second.until("text")
            assert not event["kept"] and event["undo"] == 1
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        assert piece.until("text")["statements"][0]["words"].endswith(" ff")
    # what is no journal is left alone
    path = made("piece.txt", "stroke 0 right legato mf;")
    other = os.path.join(os.path.dirname(path), ".piece.txt.himc-edit")
    with open(other, "w") as file:
        file.write("mine")
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        assert "not a journal" in piece.until("unkept")["text"]
        piece.say("set 0 stroke 0 right legato ff")
        assert not piece.until("text")["kept"]
    assert read(other) == b"mine"


def journal_of(text, *lines):
    """A journal as the program writes it."""
    total = 0xCBF29CE484222325
    for byte in text.encode():
        total = (total ^ byte) * 0x100000001B3 % 2**64
    head = f"himc edit 1 {total:016x} {len(text.encode())}\n{text}"
    return (head + "".join(f"{line}\n" for line in lines)).encode()


def strangers_folder(journal, links):
    """A source and files beside it as its sender has made them, and where their links lead to."""
    path = made("piece.txt", "stroke 0 right legato mf;")
    beside, home = os.path.dirname(path), tempfile.mkdtemp(dir=folder.name)
    if journal:
        with open(os.path.join(beside, ".piece.txt.himc-edit"), "wb") as file:
            file.write(journal)
    for name, to in links.items():
        os.symlink(os.path.join(home, to), os.path.join(beside, name))
    return path, beside, home


def test_a_folder_from_somebody_else_writes_nothing_elsewhere():
    other, line = "stroke 3 left legato p;", "set 0 stroke 3 left legato ff"
    changed = "stroke 3 left legato ff;"
    # the text that is kept takes a name that nothing has, a link included
    path, beside, home = strangers_folder(
        journal_of(other, line), {".piece.txt.himc-edit-1.txt": "profile"}
    )
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        assert "-2.txt" in piece.until("restored")["text"]
    assert os.listdir(home) == []
    assert read(os.path.join(beside, ".piece.txt.himc-edit-2.txt")).decode() == changed
    # so does a journal that does not fit
    path, beside, home = strangers_folder(
        journal_of(other, "set 0 record /tmp/x.bvh"), {".piece.txt.himc-edit-1": "profile"}
    )
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        assert "-2" in piece.until("restored")["text"]
    assert os.listdir(home) == []
    assert read(os.path.join(beside, ".piece.txt.himc-edit-2")) == journal_of(
        other, "set 0 record /tmp/x.bvh"
    )
    # a journal that is a link, to nothing, to a file or to a folder, or a file with two names
    for target, contents in (("new", None), ("old", b""), ("old", journal_of(other, line)), (".", None)):
        path, beside, home = strangers_folder(None, {".piece.txt.himc-edit": target})
        if contents is not None:
            with open(os.path.join(home, target), "wb") as file:
                file.write(contents)
        refuses_its_journal(path)
        assert [read(os.path.join(home, name)) for name in os.listdir(home)] == (
            [] if contents is None else [contents]
        )
        assert sorted(os.listdir(beside)) == [".piece.txt.himc-edit", "piece.txt"]
    path, beside, home = strangers_folder(None, {})
    with open(os.path.join(home, "old"), "wb") as file:
        file.write(b"")
    os.link(os.path.join(home, "old"), os.path.join(beside, ".piece.txt.himc-edit"))
    refuses_its_journal(path)
    assert read(os.path.join(home, "old")) == b""


def refuses_its_journal(path):
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        assert ".piece.txt.himc-edit: " in piece.until("unkept")["text"]
        piece.say("set 0 stroke 0 right legato ff")
        event = piece.until("text")
        assert event["event"] == "text" and not event["kept"], event


def test_a_journal_that_cannot_be_played_is_taken_back():
    """The program was killed between a change and the answer that it cannot be played."""
    text = "stroke 0 right legato mf;"
    path = made("piece.txt", text)
    journal = os.path.join(os.path.dirname(path), ".piece.txt.himc-edit")
    with Piece(HIMC, path) as piece:
        assert piece.play("hello") is None
        assert piece.play("set 0 stroke 0 right legato f") is None
        piece.process.kill()
    with open(journal, "a") as file:
        file.write("".join(f"set {i} {PUSH}\n" for i in range(1, 258)))  # one too many
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        event = piece.until("undone")
        assert event["event"] == "undone" and "one too many" in event["text"], event
        assert piece.text["undo"] == 257 and piece.text["redo"] == 0  # all but the last
        assert piece.score().decode().count("push") == 256
    # one that does not fit is kept as it is
    path = made("piece.txt", text)
    journal = os.path.join(os.path.dirname(path), ".piece.txt.himc-edit")
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        piece.until("text")
        piece.say("set 0 stroke 0 right legato f")
        piece.until("text")
        piece.process.kill()
    with open(journal, "a") as file:
        file.write("set 77 stroke 0 right legato f\n")
    wrong = read(journal)
    with Piece(HIMC, path) as piece:
        piece.say("hello")
        piece.until("restored")
        assert piece.score().decode() == text and (piece.text["undo"], piece.text["redo"]) == (0, 0)
    assert read(journal + "-1") == wrong and not os.path.exists(journal)


def test_a_damaged_journal_is_kept_and_one_cut_short_holds_nothing():
    text, line = "stroke 0 right legato mf;", "set 0 stroke 0 right legato f"
    good = journal_of(text, line)
    begun = len(good) - len(line) - 1
    damages = {
        "hash": good.replace(good[12:20], b"nonsense", 1),
        "size": good.replace(b" 25\n", b" 2500\n", 1),
        "no size": good.replace(b" 25\n", b" \n", 1),
        "end of the head": good[:20],
        "head": good[:15] + good[begun:],
        "zeros": good + b"\0\0\0\0" + line.encode() + b"\n",
    }
    for name, wrong in damages.items():
        path, beside, _ = strangers_folder(wrong, {})
        with Piece(HIMC, path) as piece:
            piece.say("hello")
            if name == "end of the head":  # cut short
                assert piece.until("text")["kept"] and "restored" not in piece.said
                piece.until("over")
                assert os.listdir(beside) == ["piece.txt"]
                continue
            piece.until("over")
            assert "-1" in piece.said.get("restored", ""), name
            assert piece.text["undo"] == 0 and piece.text["kept"], name
            piece.say(line)
            assert piece.until("text")["kept"], name
        journal = os.path.join(beside, ".piece.txt.himc-edit")
        assert read(journal + "-1") == wrong and read(journal) == good, name
    for size in range(begun, len(good) - 1, 8):  # nor one without a whole change
        path, beside, _ = strangers_folder(good[:size], {})
        with Piece(HIMC, path) as piece:
            piece.say("hello")
            piece.until("over")
            assert "restored" not in piece.said and os.listdir(beside) == ["piece.txt"], size


def test_a_journal_that_cannot_be_written_leaves_nothing():
    def full(size):
        return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    strokes = "".join(f"stroke {i} right legato mf;\n" for i in range(400))
    for text, most in (("stroke 0 right legato mf;", 0), ("stroke 0 right legato mf;", 40), (strokes, 6000)):
        path = made("piece.txt", text)
        pipes = dict(stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        # as on a full disk: Python ignores SIGXFSZ, and so does what it starts
        done = subprocess.Popen([HIMC, "edit", path], restore_signals=False, preexec_fn=full(most), **pipes)
        said = done.communicate(b"set 0 stroke 0 right legato ff\nset 0 stroke 0 right legato f\n")[0]
        assert said.count(b'"event":"unkept"') == 1 and b"too large" in said, said
        assert said.count(b'"kept":false') >= 1 and os.listdir(os.path.dirname(path)) == ["piece.txt"], said


def test_what_a_page_has_sent_is_known_again_by_its_name_and_contents():
    def sent(contents, name="my score.txt"):
        return Piece(HIMC, made("piece.txt", contents), "--confined", "--name", name)

    text = "stroke 0 right legato mf;"
    with sent(text) as piece:
        piece.say("hello")
        assert piece.until("text")["source"] == "my score.txt"
        piece.say("set 0 stroke 0 right legato ff")
        piece.until("text")
        piece.stem = "my score"
        edited = piece.score()
        piece.process.kill()
    for contents, name, wanted in ((text, "other.txt", 0), (text + " ", "my score.txt", 0), (text, "my score.txt", 1)):
        with sent(contents, name) as piece:
            piece.say("hello")
            assert piece.until("text")["undo"] == wanted, (contents, name)
    assert edited != text.encode()


def test_what_a_page_has_sent_is_told_by_its_name_alone():
    for ending in ("bvh", "c3d", "trc", "mid", "txt"):
        path = made(f"piece.0.{ending}", b"MThd\0\0\0\6junk" if ending == "mid" else b"junk")
        for options, name in ((["--confined", "--name", f"my.{ending}"], f"my.{ending}"), ([], path)):
            pipes = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
            # not buffered: nothing is left to write when it has ended
            with subprocess.Popen([HIMC, "edit", path, *options], bufsize=0, **pipes) as process:
                with contextlib.suppress(BrokenPipeError):
                    process.stdin.write(b"hello\n")
                out, why = process.stdout.read(), process.stderr.read()
            for text in (out[out.index(b'{"event":"failed"') :].decode(), why.decode()):
                assert process.returncode == 1 and text.count(name) == 1, text
                assert options == [] or "piece.0" not in text, text


TESTS = [f for name, f in list(globals().items()) if name.startswith("test_")]

if __name__ == "__main__":
    sys.exit(report.run("tests/viewer/edit.py", TESTS))
