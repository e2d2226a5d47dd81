#!/usr/bin/env python3
"""Holds the onsets of imported timpani parts against Verovio's timemap.

    verovio_onsets.py HIMC [FILE...]

needs `pip install music21 verovio`. Without files: those of music21's corpus with a timpani part. Columns: file, notes of
Verovio, strokes of himc, pairs within 1 ms, largest difference (ms). Verovio's notes are those of the staffs named timpani; a tied
note is one. himc reads a copy without fermatas, which Verovio does not hold; its onsets are the strokes and rolls of the score that `himc import` makes, in seconds through its tempi.
"""
import glob
import os
import re
import subprocess
import sys
import zipfile

import verovio

NAME = r"timp|pauk|timbal|kettle"


def read(path):
    if not path.endswith(".mxl"):
        return open(path, "rb").read()
    archive = zipfile.ZipFile(path)
    return archive.read([n for n in archive.namelist() if not n.startswith("META") and n.endswith("xml")][0])


def has_timpani(path):
    return re.search(NAME.encode(), read(path).split(b"</part-list>")[0], re.I)


def corpus():
    import music21

    folder = os.path.join(os.path.dirname(music21.__file__), "corpus")
    files = [f for e in ("xml", "mxl") for f in glob.glob(f"{folder}/**/*.{e}", recursive=True)]
    return sorted(f for f in files if has_timpani(f))


def verovio_onsets(path):
    toolkit = verovio.toolkit()
    toolkit.loadFile(path)
    mei = toolkit.getMEI()
    staffs = set()
    for head in re.findall(r"<staffDef [^>]*>.*?</staffDef>", mei, re.S):
        label = re.search(r"<label[^>]*>(.*?)</label>", head, re.S)
        if label and re.search(NAME, label.group(1), re.I):
            staffs.add(re.search(r' n="(\d+)"', head).group(1))
    notes = set()
    for n, staff in re.findall(r'<staff [^>]*?n="(\d+)"[^>]*>(.*?)</staff>', mei, re.S):
        if n in staffs:
            notes |= {i for i in re.findall(r'<note xml:id="([^"]+)"', staff)}
    onsets = []
    for event in toolkit.renderToTimemap({}):
        # a note of a second time through has the id with a suffix
        onsets += [event["tstamp"] / 1000 for i in event.get("on", []) if re.sub("-rend.*", "", i) in notes]
    return sorted(onsets)


def himc_onsets(himc, path):
    plain = re.sub(rb"<fermata.*?(/>|</fermata>)", b"", read(path))
    text = subprocess.run([himc, "import", "-", "-o", "-"], input=plain, capture_output=True, check=True).stdout.decode()
    lead = float(re.search(r"beat 0 of the file is beat (\S+)", text).group(1))
    tempi = [(float(b), float(t)) for t, b in re.findall(r"^tempo (\S+) (\S+);", text, re.M)]
    starts = [0.0]
    for (beat, bpm), (after, _) in zip(tempi, tempi[1:]):
        starts.append(starts[-1] + (after - beat) * 60 / bpm)

    def seconds(beat):
        i = max(k for k, (b, _) in enumerate(tempi) if b <= beat + 1e-9)
        return starts[i] + (beat - tempi[i][0]) * 60 / tempi[i][1]

    beats = re.findall(r"^(?:stroke|roll|flam|drag|ruff) (\S+)", text, re.M)
    return sorted(seconds(float(b)) - seconds(lead) for b in beats)


def main():
    himc, files = sys.argv[1], sys.argv[2:] or corpus()
    total = [0, 0, 0]
    worst = 0
    for path in files:
        theirs, ours = verovio_onsets(path), himc_onsets(himc, path)
        near, i, largest = 0, 0, 0
        for t in theirs:
            while i < len(ours) and ours[i] < t - 0.001:
                i += 1
            if i < len(ours) and abs(ours[i] - t) <= 0.001:
                largest = max(largest, abs(ours[i] - t))
                near += 1
                i += 1
        worst = max(worst, largest)
        total = [a + b for a, b in zip(total, (len(theirs), len(ours), near))]
        print(os.path.basename(path), len(theirs), len(ours), near, f"{1000 * largest:.3f}")
    print("all", *total, f"{1000 * worst:.3f}")


main()
