#!/usr/bin/python3
"""Plays MIDI files and holds what is struck against what the files say, read by mido.

    evaluate.py PROGRAM SECONDS FILE...      (needs python3-mido)

A file's drum parts are counted by mido; `himc import` must account for each note of the part, as
a stroke, in a roll or in a line of its report. Each stroke of the score must be at the time of a note
(2 ms). Then the first SECONDS from the first stroke on are rendered, and each stroke there must be
struck, on its drum, within 10 ms, as the first of each roll; a roll's other notes are told apart: the
player's strokes are not the file's. A .wad file stands for the MIDI files inside it. Prints a line for each
file, and at the end `files F strokes N within W percent X extra E`; extra are strikes that no stroke asked
for, of files without rolls. Exit status 1 if a note is not accounted for, if less than 99 % are within
10 ms, or more than 1 % are extra.
"""
import bisect
import csv
import os
import re
import struct
import subprocess
import sys
import tempfile

import mido

TOLERANCE = 0.010  # of a strike (s)
EXACT = 0.002  # of a stroke of the score (s)
BEFORE = 1.5  # of preparation before the first stroke (s)
DRUMS = 9
TIMPANI = 47
TIMPANI_NAME = re.compile("timp|pauk|kettle|timbal", re.I)


def midi_files(path):
    """(name, bytes) of a file, or of all MIDI files inside a WAD."""
    data = open(path, "rb").read()
    if data[:4] not in (b"IWAD", b"PWAD"):
        yield os.path.basename(path), data
        return
    count, directory = struct.unpack("<II", data[4:12])
    for i in range(count):
        at, size, name = struct.unpack("<II8s", data[directory + 16 * i:directory + 16 * i + 16])
        if data[at:at + 4] == b"MThd":
            yield name.rstrip(b"\0").decode() + ".mid", data[at:at + size]


def drum_notes(path):
    """Times (s) of the notes of the part that is played: timpani, else the drum channel."""
    midi = mido.MidiFile(path, clip=True)
    named = {id(m) for t in midi.tracks if TIMPANI_NAME.search(t.name) for m in t}
    timpani, drums, program, seconds = [], [], {}, 0.0
    tempo, tick = 500000, 0
    events = sorted(((at, k, m, id(m) in named) for k, (at, m) in enumerate(absolute(midi))), key=lambda e: e[:2])
    for at, _, message, is_named in events:
        seconds += (at - tick) * tick_seconds(midi.ticks_per_beat, tempo)
        tick = at
        if message.type == "set_tempo":
            tempo = message.tempo
        elif message.type == "program_change":
            program[message.channel] = message.program
        elif message.type == "note_on" and message.velocity > 0:
            if message.channel == DRUMS:
                drums.append(seconds)
            elif program.get(message.channel) == TIMPANI or is_named:
                timpani.append(seconds)
    return timpani or drums


def tick_seconds(division, tempo):
    """Of quarter notes; negative: minus frames a second, and ticks a frame."""
    return tempo / 1e6 / division if division > 0 else -1.0 / ((division >> 8) * (division & 0xFF))


def absolute(midi):
    for track in midi.tracks:
        at = 0
        for message in track:
            at += message.time
            yield at, message


def read_score(text):
    """(tempi, strokes): (beat, bpm) and (beat, line)."""
    tempi, strokes = [], []
    for line in text.splitlines():
        word = line.rstrip(";").split()
        if line.startswith("tempo"):
            tempi.append((float(word[2]), float(word[1])))
        elif line.startswith(("stroke", "roll")):
            strokes.append((float(word[1]), line, word[-1]))
    return tempi, strokes


def seconds_of(tempi, beat):
    seconds = 0.0
    for (begin, bpm), (end, _) in zip(tempi, tempi[1:] + [(float("inf"), 0)]):
        seconds += max(0.0, min(beat, end) - begin) * 60 / bpm
    return seconds


def nearest(times, t):
    at = bisect.bisect_left(times, t)
    return min((abs(times[i] - t) for i in (at - 1, at) if 0 <= i < len(times)), default=float("inf"))


def rolled(report):
    """(notes, rolls) of the report."""
    found = re.search(r"(\d+) notes are played as (\d+) roll", report)
    return (int(found.group(1)), int(found.group(2))) if found else (0, 0)


def accounted(report, notes, strokes):
    """True if strokes, rolls and the report's reasons add up to the notes of the part."""
    reasons = sum(int(line.split()[0]) for line in report.splitlines()
                  if "not played" in line or "one stroke" in line)
    in_rolls, rolls = rolled(report)
    return reasons + strokes - rolls + in_rolls == notes


def excerpt(text, tempi, strokes, seconds):
    """The score with the strokes of the first seconds, and these strokes with their times from `play` on."""
    begin = max(0.0, strokes[0][0] - BEFORE * tempi[0][1] / 60)
    zero = seconds_of(tempi, begin)
    end = seconds_of(tempi, strokes[0][0]) + seconds
    kept = [(seconds_of(tempi, s[0]) - zero, s[2]) for s in strokes if seconds_of(tempi, s[0]) <= end]
    drop = {s[1] for s in strokes[len(kept):]}
    lines = [line for line in text.splitlines() if line not in drop and not late(line, tempi, end)]
    return "\n".join(lines) + "\nseek %.9g;\n" % begin, kept


def late(line, tempi, end):
    return line.startswith("at ") and seconds_of(tempi, float(line.split()[1])) > end


def struck(program, text, folder):
    """Sorted times of the strikes of each drum."""
    score, table = os.path.join(folder, "s.txt"), os.path.join(folder, "s.csv")
    open(score, "w").write(text)
    subprocess.run([program, "render", score, "-o", "/dev/null", "--channels", "1", "--strokes", table],
                   check=True, capture_output=True)
    drums = {}
    for row in csv.DictReader(open(table)):
        drums.setdefault(row["drum"], []).append(float(row["time_s"]))
    return drums


def evaluate(program, seconds, name, data, folder):
    """(strokes, within, extra, good) or None if there is no such part."""
    path = os.path.join(folder, "f.mid")
    open(path, "wb").write(data)
    notes = drum_notes(path)
    if not notes:
        return None
    made = subprocess.run([program, "import", path, "-o", "-"], capture_output=True, text=True)
    if made.returncode != 0:
        return 0, 0, 0, "none" in made.stderr
    tempi, strokes = read_score(made.stdout)
    lead = seconds_of(tempi, float(re.search(r"is beat ([0-9.]+) here", made.stdout).group(1)))
    good = accounted(made.stderr, len(notes), len(strokes))
    off = sum(nearest(notes, seconds_of(tempi, s[0]) - lead) > EXACT for s in strokes)
    text, kept = excerpt(made.stdout, tempi, strokes, seconds)
    drums = struck(program, text, folder)
    within = sum(nearest(drums.get(drum, []), t) <= TOLERANCE for t, drum in kept)
    asked = {drum: [t for t, d in kept if d == drum] for drum in drums}
    extra = sum(nearest(asked[drum], t) > TOLERANCE for drum in drums for t in drums[drum])
    extra = 0 if rolled(made.stderr)[1] else extra
    print("%-30s %5d notes, %5d strokes, %3d off, %d in %d rolls; in %g s %4d of %4d struck%s" %
          (name[:30], len(notes), len(strokes), off, *rolled(made.stderr), seconds, within, len(kept),
           "" if good else "; NOT ACCOUNTED FOR"), flush=True)
    return len(kept), within, extra, good and off == 0


def main():
    program, seconds = sys.argv[1], float(sys.argv[2])
    files = strokes = within = extra = 0
    good = True
    with tempfile.TemporaryDirectory() as folder:
        for path in sys.argv[3:]:
            for name, data in midi_files(path):
                result = evaluate(program, seconds, name, data, folder)
                if result:
                    files += 1
                    strokes += result[0]
                    within += result[1]
                    extra += result[2]
                    good = good and result[3]
    share = 100 * within / max(strokes, 1)
    print("files %d strokes %d within %d percent %.3f extra %d" % (files, strokes, within, share, extra))
    sys.exit(0 if good and share >= 99 and extra <= 0.01 * strokes else 1)


if __name__ == "__main__":
    main()
