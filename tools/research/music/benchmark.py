#!/usr/bin/python3
"""Plays public MIDI and MusicXML files and holds what is struck against what the files say.

    benchmark.py PROGRAM SECONDS FOLDER LIST [WORD]   (needs mido and music21; only files whose name has WORD)

LIST names the files of FOLDER, with their sha256 (files.txt). The notes of each file are read by mido or by
music21, not by himc. The first SECONDS from its first note on are imported and rendered; a strike counts for a
note of its instrument (of a timpano: of its pitch, as tuned then) within 10, 25 and 50 ms, each for one only.

Not counted: keys that no stick strikes (claps, shakers, whistles); of notes of one instrument within 10 ms one
counts. Written-out rolls of timpani (4 notes and more at 9 a second) are a table of their own: a player's
strokes there are not the file's. `Playable` is what two hands and two feet can play by this rule, which
knows nothing of the player:

    a foot, of the kick and of the hi-hat: 80 ms or more from its stroke before
    a hand: 60 ms or more from its stroke before on the same instrument; to another one 100 ms and 250 ms a metre

Of each passage (notes less than 0.6 s apart) the largest number of notes that the rule allows is the number
asked; what is struck beyond it is neither credited nor blamed. Loudness is impact speed: its level, 22 dB
a factor of ten as from ppp to fff, against the velocity's on the notation curve; per instrument and file less
the mean, RMS. MusicXML has dynamics, too, but no velocities: left out. Then each file is exported and imported
again: strokes at the same beats on the same drums by the same hands, dynamics to a step, pedals.
"""
import bisect
import collections
import concurrent.futures
import csv
import hashlib
import math
import os
import re
import subprocess
import sys
import tempfile

import mido

WITHIN = (0.010, 0.025, 0.050)  # (s)
BEFORE = 2.0  # of preparation before the first note (s)
TOGETHER = 0.010  # notes of one instrument are one (s)
FOOT, SAME, OTHER, WAY = 0.080, 0.060, 0.100, 0.250  # the rule (s; s/m)
APART = 0.6  # between passages (s)
ROLL_RATE, ROLL_NOTES = 9.0, 4
DRUMS, TIMPANI = 9, 47
TIMPANI_NAME = re.compile("timp|pauk|kettle|timbal", re.I)
STEP = 1 / 7  # from one dynamic to the next
EQUAL = 0.003  # of times after a round trip (s)
LEAD = r"is beat ([0-9.]+) here"
BARS = r"comment bars of \S+ from beat ([0-9.]+);"
INSTRUMENTS = {}  # of General MIDI's keys, as docs/manual.md says
for name, keys in {
        "snare": (31, 37, 38, 40), "kick": (35, 36), "low-floor": (41,), "floor": (43,), "mid-tom": (45,), "tom": (47, 48),
        "high-tom": (50,), "hats": (42, 46), "hats-foot": (44,), "crash": (49,), "crash-16": (57,), "ride": (51, 53, 59),
        "china": (52,), "splash": (55,), "tambourine": (54,), "cowbell": (56,), "high-bongo": (60,), "low-bongo": (61,), "high-conga": (62, 63),
        "low-conga": (64,), "high-timbale": (65,), "low-timbale": (66,), "agogo": (67, 68), "claves": (75,),
        "high-block": (76,), "low-block": (77,), "triangle": (80, 81)}.items():
    INSTRUMENTS.update(dict.fromkeys(keys, name))

Note = collections.namedtuple("Note", "time what velocity")


def midi_notes(path):
    """The notes of the timpani, else those of the drum channel."""
    midi = mido.MidiFile(path, clip=True)
    named = {id(m) for t in midi.tracks if TIMPANI_NAME.search(t.name) for m in t}
    events = []
    for track in midi.tracks:
        at = 0
        for message in track:
            at += message.time
            events.append((at, len(events), message))
    timpani, drums, program, seconds, tempo, tick = [], [], {}, 0.0, 500000, 0
    for at, _, message in sorted(events, key=lambda e: e[:2]):
        seconds += (at - tick) * tempo / 1e6 / midi.ticks_per_beat
        tick = at
        if message.type == "set_tempo":
            tempo = message.tempo
        elif message.type == "program_change":
            program[message.channel] = message.program
        elif message.type == "note_on" and message.velocity > 0:
            if message.channel == DRUMS:
                drums.append(Note(seconds, INSTRUMENTS.get(message.note), message.velocity))
            elif program.get(message.channel) == TIMPANI or id(message) in named:
                timpani.append(Note(seconds, message.note, message.velocity))
    return timpani or drums


def xml_notes(path):
    """The same of MusicXML, by music21, in quarter notes: repeats are played, ties are one note."""
    import music21
    score = music21.converter.parse(path)
    parts = [p for p in score.parts if TIMPANI_NAME.search(p.partName or "")]
    notes = []
    for part in parts:
        flat = part.expandRepeats() if part.recurse().getElementsByClass("Repeat") else part
        for n in flat.stripTies().flatten().notes:
            for pitch in n.pitches:
                notes.append(Note(float(n.offset), pitch.midi, None))
    return sorted(notes)


def joined(notes):
    """Without what no stick strikes, and of notes of one instrument at once the loudest."""
    kept, last = [], {}
    for n in sorted((n for n in notes if n.what is not None), key=lambda n: n.time):
        before = last.get(n.what)
        if before is not None and n.time - kept[before].time < TOGETHER:
            louder = max(kept[before].velocity or 0, n.velocity or 0) or None
            kept[before] = kept[before]._replace(velocity=louder)
        else:
            last[n.what] = len(kept)
            kept.append(n)
    return kept


def without_rolls(notes):
    """(notes, those in written-out rolls) of timpani."""
    rolled, row = set(), []
    for i, n in enumerate(notes + [Note(1e9, None, None)]):
        if row and n.what == notes[row[-1]].what and n.time - notes[row[-1]].time <= 1 / ROLL_RATE:
            row.append(i)
            continue
        if len(row) >= ROLL_NOTES:
            rolled.update(row)
        row = [i]
    return [n for i, n in enumerate(notes) if i not in rolled], [n for i, n in enumerate(notes) if i in rolled]


def passages(notes):
    group = []
    for n in notes:
        if group and n.time - group[-1].time >= APART:
            yield group
            group = []
        group.append(n)
    if group:
        yield group


def allows(before, n, places):
    gap = n.time - before.time
    if before.what == n.what:
        return gap >= SAME
    a, b = places.get(before.what), places.get(n.what)
    return gap >= OTHER + WAY * (math.dist(a, b) if a and b else 0.5)


def playable(group, places):
    """The largest number of these notes that the rule allows."""
    count, last = 0, {}
    hands = []
    for n in group:
        if n.what in ("kick", "hats-foot"):
            if n.time - last.get(n.what, -1e9) >= FOOT:
                count += 1
                last[n.what] = n.time
        else:
            hands.append(n)
    states = {(-1, -1): 0}
    for i, n in enumerate(hands):
        after = dict(states)
        for (left, right), best in states.items():
            for state, hand in (((i, right), left), ((left, i), right)):
                if hand < 0 or allows(hands[hand], n, places):
                    after[state] = max(after.get(state, 0), best + 1)
        # a hand whose last note is long past is free: the same state
        states = {}
        for state, best in after.items():
            key = tuple(k if k >= 0 and n.time - hands[k].time < APART else -1 for k in state)
            states[key] = max(states.get(key, 0), best)
    return count + max(states.values())


def matched(notes, strikes, within):
    """For each note its strike or None, for each strike whether it has a note; nearest pairs first."""
    pairs = []
    times = collections.defaultdict(list)
    for k, s in enumerate(strikes):
        times[s.what].append((s.time, k))
    for i, n in enumerate(notes):
        row = times[n.what]
        at = bisect.bisect_left(row, (n.time - within,))
        while at < len(row) and row[at][0] <= n.time + within:
            pairs.append((abs(row[at][0] - n.time), i, row[at][1]))
            at += 1
    of_note, of_strike = {}, {}
    for _, i, k in sorted(pairs):
        if i not in of_note and k not in of_strike:
            of_note[i], of_strike[k] = k, i
    return of_note, of_strike


def run(program, *words, text=None):
    return subprocess.run([program, *words], capture_output=True, text=True, input=text)


def lines_of(score):
    return [line.rstrip(";").split() for line in score.splitlines() if not line.startswith("comment")]


def tempi_of(score):
    return [(float(w[2]), float(w[1])) for w in lines_of(score) if w[:1] == ["tempo"] and len(w) > 2]


def seconds_of(tempi, beat):
    seconds = 0.0
    for (begin, bpm), (end, _) in zip(tempi, tempi[1:] + [(float("inf"), 0)]):
        seconds += max(0.0, min(beat, end) - begin) * 60 / bpm
    return seconds


def beat_of(words):
    if words[:1] == ["at"]:
        return float(words[1])
    return float(words[1]) if words[:1] in (["stroke"], ["roll"], ["flam"], ["drag"], ["ruff"]) else None


def key_of(pitch):
    found = re.fullmatch(r"([A-G])([#b]?)(-?\d)", pitch)
    if not found:
        return round(69 + 12 * math.log2(float(pitch) / 440))
    step = dict(C=0, D=2, E=4, F=5, G=7, A=9, B=11)[found[1]] + {"": 0, "#": 1, "b": -1}[found[2]]
    return 12 * (int(found[3]) + 1) + step


def pitches_of(score, tempi, zero):
    """For each drum its pitches: (time, MIDI key)."""
    pitches = collections.defaultdict(list)
    for words in lines_of(score):
        at, rest = (float(words[1]), words[2:]) if words[:1] == ["at"] else (None, words)
        if len(rest) > 2 and rest[1] in ("tune", "gliss"):
            time = -1e9 if at is None else seconds_of(tempi, at) - zero
            pitches[rest[0]].append((time, key_of(rest[2])))
    return pitches


def render(program, score, folder):
    path, table = os.path.join(folder, "s.txt"), os.path.join(folder, "s.csv")
    with open(path, "w") as file:
        file.write(score)
    done = run(program, "render", path, "-o", "/dev/null", "--channels", "1", "--strokes", table)
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    with open(table) as file:
        return list(csv.DictReader(file))


def excerpt(score, tempi, lead, first, seconds):
    """The score with what is due in the first seconds from the first note, and when beat 0 of the file is."""
    zero = seconds_of(tempi, lead)
    end = zero + first + seconds
    start_beat = 0.0
    begin = max(0.0, zero + first - BEFORE)
    for (beat, bpm), (following, _) in zip(tempi, tempi[1:] + [(float("inf"), 0)]):
        at = seconds_of(tempi, beat)
        if at <= begin:
            start_beat = min(following, beat + (begin - at) * bpm / 60)
    kept = []
    for line in score.splitlines():
        beat = beat_of(line.rstrip(";").split())
        if beat is None or seconds_of(tempi, beat) <= end:
            kept.append(line)
    kept.append("seek %.9g;\n" % start_beat)
    return "\n".join(kept), zero - seconds_of(tempi, start_beat)


def level_of(velocity):
    """Of the notation curve (dB); 22 dB from ppp to fff, as of the strokes' speeds."""
    dynamic = min(max((velocity - 16) / 112, 0), 1)
    forte = 5 / 7
    factor = 7.2 ** ((dynamic - forte) / forte) if dynamic < forte else 1.39 ** ((dynamic - forte) / (1 - forte))
    return 22 * math.log10(factor)


def loudness(notes, strikes, of_note):
    """Squared errors (dB^2) of the strikes' levels."""
    errors = collections.defaultdict(list)
    for i, k in of_note.items():
        if notes[i].velocity and strikes[k].velocity > 0:
            errors[notes[i].what].append(22 * math.log10(strikes[k].velocity) - level_of(notes[i].velocity))
    return [(e - sum(row) / len(row)) ** 2 for row in errors.values() for e in row]


def dynamic_of(word):
    names = "ppp pp p mp mf f ff fff".split()
    return names.index(word) / 7 if word in names else float(word)


def strokes_of(score, lead):
    """(time, drum, hand, dynamic, kind) of each stroke and roll, from beat `lead` on, and (drum, pitch) of each pedal."""
    tempi = tempi_of(score)
    zero = seconds_of(tempi, lead)
    strokes, pedals = [], []
    for words in lines_of(score):
        if words[:1] == ["stroke"]:
            strokes.append((seconds_of(tempi, float(words[1])) - zero, words[-1], words[2], dynamic_of(words[4]), ""))
        elif words[:1] == ["roll"]:
            strokes.append((seconds_of(tempi, float(words[1])) - zero, words[-1], "", dynamic_of(words[4]), "roll"))
        elif len(words) > 4 and words[0] == "at" and words[3] in ("tune", "gliss"):
            pedals.append((words[2], words[4]))
    return strokes, pedals


def round_trip(program, score, folder):
    """(strokes, those not equal after MusicXML, further ones there, pedals, pitches of pedals not there)."""
    source, sheet = os.path.join(folder, "a.txt"), os.path.join(folder, "a.musicxml")
    with open(source, "w") as file:
        file.write(score)
    done = run(program, "export", source, "-o", sheet)
    back = run(program, "import", sheet, "-o", "-")
    if done.returncode != 0 or back.returncode != 0:
        raise RuntimeError(done.stderr + back.stderr)
    bars = re.search(BARS, score)  # where its page begins
    strokes, pedals = strokes_of(score, float(bars.group(1)) if bars else 0)
    again, pedals_again = strokes_of(back.stdout, float(re.search(LEAD, back.stdout).group(1)))
    found = collections.defaultdict(list)
    for s in again:
        found[s[1], s[2], s[4]].append(s)
    lost = []
    for s in strokes:
        row = found[s[1], s[2], s[4]]
        like = next((k for k, o in enumerate(row) if abs(o[0] - s[0]) < EQUAL and abs(o[3] - s[3]) <= STEP / 2 + 1e-3), None)
        if like is None:
            lost.append(s)
        else:
            del row[like]
    rest = [s for row in found.values() for s in row]
    if os.environ.get("HIMC_VERBOSE"):
        for s in lost[:10]:
            print("   lost", s)
        for s in rest[:10]:
            print("   new ", s)
    return len(strokes), len(lost), len(rest), len(pedals), sum(p not in pedals_again for p in pedals)


def evaluate(program, seconds, path):
    """A row of the table."""
    with tempfile.TemporaryDirectory() as folder:
        is_midi = path.lower().endswith(".mid")
        notes = midi_notes(path) if is_midi else xml_notes(path)
        made = run(program, "import", path, "-o", "-", "--quiet")
        if made.returncode != 0:
            raise RuntimeError(path + ": " + made.stderr)
        score = made.stdout
        tempi = tempi_of(score)
        lead = float(re.search(LEAD, score).group(1))
        # fermatas are himc's: where a file has no times, its beats have those of the score
        if not is_midi:
            zero = seconds_of(tempi, lead)
            notes = [n._replace(time=seconds_of(tempi, lead + n.time) - zero) for n in notes]
        notes = joined(notes)
        first = notes[0].time
        notes = [n for n in notes if n.time <= first + seconds]
        text, zero = excerpt(score, tempi, lead, first, seconds)
        timpani = not isinstance(notes[0].what, str)
        pitches = pitches_of(score, tempi, seconds_of(tempi, lead))
        places = {w[0]: [float(v) for v in w[2:5]] for w in lines_of(score) if len(w) > 4 and w[1] == "place"}
        strikes = []
        for row in render(program, text, folder):
            if float(row["velocity_m_s"]) == 0:
                continue
            time, what = float(row["time_s"]) - zero, row["drum"]
            if timpani:
                known = [p for t, p in pitches[what] if t <= time + 0.01]
                what = known[-1] if known else what
                places.setdefault(what, places.get(row["drum"]))
            elif what == "hats" and row["hand"] == "foot":
                what = "hats-foot"
            strikes.append(Note(time, what, float(row["velocity_m_s"])))
        return {"name": os.path.basename(path), **scored(notes, strikes, timpani, places), "trip": round_trip(program, score, folder)}


def scored(notes, strikes, timpani, places):
    rolled = []
    if timpani:
        notes, rolled = without_rolls(notes)
        # what is struck in a roll is judged there
        spans = [(n.what, n.time - 0.1, n.time + 0.2) for n in rolled]
        strikes = [s for s in strikes if not any(w == s.what and a <= s.time <= b for w, a, b in spans)]
        octaves = {n.what for n in notes}
        strikes = [s._replace(what=next((o for o in octaves if (o - s.what) % 12 == 0 and s.what not in octaves), s.what))
                   if isinstance(s.what, int) else s for s in strikes]
    row = {"notes": len(notes), "rolled": len(rolled), "asked": 0, "f": [], "all": []}
    groups = list(passages(notes))
    counts = [playable(g, places) for g in groups]
    row["asked"] = sum(counts)
    for within in WITHIN:
        of_note, of_strike = matched(notes, strikes, within)
        at = hit = 0
        for group, count in zip(groups, counts):
            found = sum(at + k in of_note for k in range(len(group)))
            hit += min(found, count)
            at += len(group)
        wrong = len(strikes) - len(of_strike)
        row["f"].append((hit, row["asked"] - hit, wrong))
        row["all"].append((len(of_note), len(notes) - len(of_note), wrong))
        if within == WITHIN[0]:
            row["level"] = loudness(notes, strikes, of_note)
            row["missed"] = [n for i, n in enumerate(notes) if i not in of_note]
            row["wrong"] = [s for k, s in enumerate(strikes) if k not in of_strike]
    return row


def f1(counts):
    hit, missed, wrong = (sum(c) for c in zip(*counts))
    return 2 * hit / max(2 * hit + missed + wrong, 1)


def show(row):
    levels = row["level"]
    strokes, lost, new, pedals, untuned = row["trip"]
    print("%-26s %5d notes %5d playable, F1 %.4f %.4f %.4f, of all %.4f; %s dB%s; round trip of %d strokes: %s" % (
        row["name"][:26], row["notes"], row["asked"], *(f1([c]) for c in row["f"]), f1([row["all"][0]]),
        "%.2f" % math.sqrt(sum(levels) / len(levels)) if levels else "-", ", %d in rolls" % row["rolled"] if row["rolled"] else "",
        strokes, "%d lost, %d new, %d of %d pedals" % (lost, new, untuned, pedals) if lost + new + untuned else "equal"), flush=True)
    if os.environ.get("HIMC_VERBOSE"):
        for n in row["missed"][:40]:
            print("   missed %.3f %s %s" % n)
        for n in row["wrong"][:40]:
            print("   wrong %.3f %s %s" % n)


def listed(folder, path, word):
    for line in open(path):
        if line.startswith("#") or not line.strip():
            continue
        digest, name = line.split()
        data = open(os.path.join(folder, name), "rb").read()
        if hashlib.sha256(data).hexdigest() != digest:
            sys.exit("%s: another file than the one listed, expected sha256 %s" % (name, digest))
        if word in name:
            yield os.path.join(folder, name)


def main():
    program, seconds, folder, names = sys.argv[1], float(sys.argv[2]), sys.argv[3], sys.argv[4]
    word = sys.argv[5] if len(sys.argv) > 5 else ""
    rows = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for row in pool.map(lambda path: evaluate(program, seconds, path), listed(folder, names, word)):
            show(row)
            rows.append(row)
    levels = [e for row in rows for e in row["level"]]
    print("files %d notes %d playable %d F1 %s of-all %s loudness_db %.2f" % (
        len(rows), sum(r["notes"] for r in rows), sum(r["asked"] for r in rows),
        " ".join("%.4f" % f1([r["f"][k] for r in rows]) for k in range(len(WITHIN))),
        " ".join("%.4f" % f1([r["all"][k] for r in rows]) for k in range(len(WITHIN))), math.sqrt(sum(levels) / max(len(levels), 1))))
    equal = sum(row["trip"][1:3] == (0, 0) and row["trip"][4] == 0 for row in rows)
    print("round trips %d equal %d" % (len(rows), equal))
    sys.exit(0 if f1([r["f"][0] for r in rows]) >= 0.99 and equal == len(rows) else 1)


if __name__ == "__main__":
    main()
