#!/usr/bin/env python3
"""How near the computed timpano is to a recorded one: `make sound-report`.

    report.py PROGRAM FOLDER    renders strokes with PROGRAM (build/bin/himc), measures them, and
                                writes FOLDER/report.md and the data of FOLDER's plots

Each row has a figure to reach, what was measured, and PASS or FALLS SHORT. The recordings are
numbers only (recordings.csv, measure.py): no audio of others is needed.
"""
import csv
import io
import itertools
import json
import os
import subprocess
import sys

import numpy as np
from scipy.signal import butter, correlate, decimate, sosfiltfilt

import measure

# what was recorded: the usual drum for the note, tuned as there (inches, Hz)
STROKES = {'C2': (32, 64.5), 'G2': (29, 98.5)}
# a 26 inch timpano (Rossing), and its tension and density (Christian et al. 1984): docs/air.md
RATIOS = {(1, 1): 150, (2, 1): 227, (3, 1): 298, (4, 1): 366, (5, 1): 434,
          (0, 1): 127, (0, 2): 252, (1, 2): 314, (2, 2): 401, (0, 3): 418}
MALLETS = ['soft', 'medium', 'hard', 'wood']
LONGEST = 4  # (s) of a stroke; the recordings have 3.5
BANDS = [(40, 200), (200, 800), (800, 3000)]  # of the ears' correlation (Hz)


class Himc:
    """the program, and a folder for what it renders"""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        os.makedirs(folder, exist_ok=True)

    def call(self, *arguments):
        done = subprocess.run([self.program, *arguments], capture_output=True, text=True)
        if done.returncode:
            sys.exit(f'sound-report: {" ".join(arguments)}: {done.stderr.strip()}')
        return done.stdout

    def render(self, name, *lines, channels=1):
        """channels and rate of a score, and the rows of its strokes"""
        score, sound, table = (os.path.join(self.folder, name + end)
                               for end in ('.txt', '.wav', '.csv'))
        with open(score, 'w', encoding='utf-8') as file:
            file.write(';\n'.join(lines) + ';\n')
        self.call('render', score, '-o', sound, '--strokes', table, '--channels', str(channels))
        with open(table, encoding='utf-8') as file:
            strokes = list(csv.DictReader(file))
        x, rate = measure.load(sound)
        return x, rate, strokes

    def stroke(self, name, inches, hz, *lines, dynamic='f', channels=1):
        """one accent on a drum of its own: sound and rate, with the strokes"""
        return self.render(name, f'drum kettle {inches}', f'kettle tune {hz}', *lines,
                           f'stroke 1 right accent {dynamic} normal kettle', channels=channels)


class Report:
    def __init__(self):
        self.rows = []

    def row(self, what, figure, measured, good):
        self.rows.append((what, figure, measured, 'PASS' if good else 'FALLS SHORT'))
        print(f'{self.rows[-1][3]:11s} {what}: {measured} ({figure})', flush=True)

    def within(self, what, values, low, high, unit='', form='.1f'):
        """a row for numbers that shall all lie between two"""
        figure = f'{low:g} .. {high:g}' if low > -np.inf else f'≤ {high:g}'
        figure = figure if high < np.inf else f'≥ {low:g}'
        self.row(what, f'{figure} {unit}'.strip(),
                 ', '.join(format(v, form) for v in values) + f' {unit}'.rstrip(),
                 all(low <= v <= high for v in values))

    def table(self):
        lines = ['| what | figure | measured | |', '|---|---|---|---|']
        return '\n'.join(lines + [f'| {" | ".join(r)} |' for r in self.rows]) + '\n'


def write_bands(folder, name, recorded, here):
    """third octaves of recording and computation, for report.gp"""
    with open(os.path.join(folder, f'{name}.dat'), 'w', encoding='utf-8') as file:
        for c in measure.THIRDS:
            parts = [d.get(f'{part}_{c}', np.nan)
                     for part in ('onset', 'tail') for d in (recorded, here)]
            file.write(f'{c} ' + ' '.join(f'{max(v, measure.FLOOR):.2f}' for v in parts) + '\n')


def recorded_rows(report, himc):
    recordings, found = measure.recordings(), {}
    for name, (inches, hz) in STROKES.items():
        sound, rate, _ = himc.stroke(name, inches, hz)
        sound = sound[:, :LONGEST * rate]
        best = measure.compare(sound[0], rate, recordings[name])
        dry = measure.describe(sound[0], rate)
        found[name] = (best, dry)
        write_bands(himc.folder, name, recordings[name], best['is'])
    names = ', '.join(found)
    for part, when in (('onset', 'first 100 ms'), ('tail', '0.3 .. 0.8 s')):
        report.within(f'third-octave distance to a recording, {when}, {names}',
                      [best[part] for best, _ in found.values()], -np.inf, 6, 'dB')
    for name, (_, dry) in found.items():
        levels = [dry[f'octave_{low}'] for low in measure.OCTAVES]
        report.row(f'octaves from 500 Hz of the first 100 ms, {name}', '-13 -18 -25 -38 ± 4 dB',
                   ' '.join(f'{v:.0f}' for v in levels) + ' dB',
                   all(abs(v - w) <= 4 for v, w in zip(levels, (-13, -18, -25, -38))))
    report.within(f'ripple of the four strongest partials, {names}',
                  [dry['ripple'] for _, dry in found.values()], 1, 3, 'dB', '.2f')
    report.within(f'energy left after 1 s beside the recording, {names}',
                  [best['is']['left_1'] - recordings[name]['left_1']
                   for name, (best, _) in found.items()], -3, 3, 'dB')


def between_ears(sound, rate, low, high):
    """largest correlation of two channels within a millisecond"""
    band = butter(2, [low, high], 'band', fs=rate, output='sos')
    left, right = (sosfiltfilt(band, x) for x in sound[:2])
    lag = int(.001 * rate)
    both = correlate(left, right, 'same')
    middle = len(both) // 2
    return float(np.abs(both[middle - lag:middle + lag + 1]).max() /
                 np.sqrt((left ** 2).sum() * (right ** 2).sum()))


def ear_rows(report, himc):
    found = []
    for name, (inches, hz) in STROKES.items():
        sound, rate, _ = himc.stroke(name + '-ears', inches, hz, channels=2)
        found.append([between_ears(sound, rate, *band) for band in BANDS])
    below, above = [v for f in found for v in f[:2]], [f[2] for f in found]
    names = ', '.join(STROKES)
    report.within(f'interaural correlation, 40 .. 200 and 200 .. 800 Hz, {names}', below, .45, .9,
                  form='.2f')
    report.within(f'interaural correlation, 800 .. 3000 Hz, {names}', above, .2, .6, form='.2f')


def repeated(himc, name, human):
    """least and mean correlation of thirty strokes with each other"""
    beats = [f'stroke {i} right accent f' for i in range(1, 31)]
    sound, rate, strokes = himc.render(name, 'tempo 20', f'human {human} 1', *beats)
    x, rate = decimate(sound[0], 4), rate / 4
    span, lag = int(.5 * rate), int(.005 * rate)
    parts = []
    for s in strokes:
        at = int(float(s['time_s']) * rate)
        parts.append(x[at - lag:at + span + lag])
    found = []
    for a, b in itertools.combinations(parts, 2):
        windows = np.lib.stride_tricks.sliding_window_view(b, span)
        both = windows @ a[lag:lag + span]
        at = int(np.argmax(both))
        found.append(float(both[at] / np.linalg.norm(a[lag:lag + span]) /
                           np.linalg.norm(windows[at])))
    return min(found), float(np.mean(found))


def repetition_rows(report, himc):
    least, mean = repeated(himc, 'machine', 0)
    report.within('thirty equal strokes, `human 0`: least pairwise correlation', [least], .99999, 1,
                  form='.6f')
    least, mean = repeated(himc, 'human', .5)
    report.within('thirty equal strokes, `human 0.5`: mean pairwise correlation', [mean], .9, .99,
                  form='.3f')


def peak(himc, mallet, modes):
    _, _, strokes = himc.stroke(f'force-{mallet}-{modes}', 26, 146.83, f'kettle mallet {mallet}',
                                f'kettle modes {modes}')
    return float(strokes[0]['peak_force_n'])


def force_row(report, himc):
    change = [100 * (peak(himc, m, 2000) / peak(himc, m, 200) - 1) for m in MALLETS]
    report.within('peak force from 200 to 2000 modes, soft medium hard wood', change, -2, 2, '%')


def brightness_rows(report, himc):
    def mean_frequency(name, dynamic, mallet):
        sound, rate, _ = himc.stroke(name, 26, 146.83, f'kettle mallet {mallet}', dynamic=dynamic)
        return measure.centroid(sound[0], rate)

    soft_loud = [mean_frequency(d, d, 'medium') for d in ('pp', 'ff')]
    mallets = [mean_frequency(m, 'mf', m) for m in ('soft', 'wood')]
    for what, (low, high) in (('pp → ff', soft_loud), ('soft → wood', mallets)):
        report.within(f'spectral centroid of 50 ms, {what} ({low:.0f} → {high:.0f} Hz)',
                      [high / low], 1.8, np.inf, form='.2f')


def ratio_row(report, himc):
    score = os.path.join(himc.folder, 'modes.txt')
    with open(score, 'w', encoding='utf-8') as file:
        file.write('drum d 26; d radius 0.328; d tension 3990; d kettle 0.14; d uniformity 1;\n')
    modes = {(int(r['m']), int(r['n'])): float(r['frequency_hz'])
             for r in csv.DictReader(io.StringIO(himc.call('modes', score)))}
    cents = {k: 1200 * np.log2(modes[k] / modes[1, 1] / (hz / RATIOS[1, 1]))
             for k, hz in RATIOS.items() if k != (1, 1)}
    rms = [float(np.sqrt(np.mean(np.square([cents[k] for k in keys]))))
           for keys in ([k for k in cents if k[1] == 1 and k[0] > 1], list(cents))]
    report.row('ratios of the 26 inch drum to (1,1) against the measured ones', '≤ 10, ≤ 18 cents',
               f'{rms[0]:.1f} for (2..5,1), {rms[1]:.1f} cents for all', rms[0] <= 10 and rms[1] <= 18)


def loudness_rows(report, himc):
    tool = os.path.join(os.path.dirname(himc.program), '../tools/research/sound/loudness')
    pieces = ['patches/improvisation.txt', 'patches/pieces/tide.txt']
    sounds = []
    for piece in pieces:
        sounds.append(os.path.join(himc.folder, os.path.basename(piece)[:-4] + '.wav'))
        himc.call('render', piece, '-o', sounds[-1])
    said = subprocess.run([tool, *sounds], capture_output=True, text=True, check=True).stdout
    levels = [[float(v) for v in line.split()[-3:]] for line in said.splitlines()]
    report.within('loudness of the improvisation and the tide', [v[0] for v in levels], -25, -21,
                  'LUFS')
    report.within('their true peaks', [v[2] for v in levels], -np.inf, -1, 'dBTP')


def cost_row(report, himc):
    cost = json.loads(himc.call('bench', '--json'))['drum_auto_ms']
    report.within('processor time of a drum with all of it, four strokes a second', [cost / 10],
                  -np.inf, 3, '%')


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    himc, report = Himc(os.path.abspath(sys.argv[1]), sys.argv[2]), Report()
    for rows in (recorded_rows, ear_rows, repetition_rows, force_row, brightness_rows, ratio_row,
                 loudness_rows, cost_row):
        rows(report, himc)
    with open(os.path.join(himc.folder, 'report.md'), 'w', encoding='utf-8') as file:
        file.write(report.table())


if __name__ == '__main__':
    main()
