#!/usr/bin/env python3
"""How near the computed timpano is to recorded ones: `make sound-report`.

    report.py PROGRAM FOLDER    renders strokes with PROGRAM (build/bin/himc) as they are heard by
                                default, two ears in the room, measures them, and writes
                                FOLDER/report.md and the data of FOLDER's plot

A row has what was measured and its target, met or MISSED; a target that is missed is no error. The
recordings are numbers only (distance.py, recordings.csv).
"""
import csv
import itertools
import os
import subprocess
import sys

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.signal import decimate

import distance

# the usual drum for the note, tuned as in the recording (inches, Hz)
STROKES = {'C2': (32, 64.4), 'G2': (29, 99.4), 'A2': (29, 109.9), 'F#3': (23, 186.2)}
LOUD = {'C2': 32, 'D3': 26, 'A3': 23}  # of one stroke: note, inches
PIECES = ['patches/improvisation.txt', 'patches/pieces/tide.txt']
MALLETS = ['soft', 'medium', 'hard', 'wood']
D3 = ('drum d 26', 'd tune D3')


class Himc:
    """the program, and a folder for what it renders"""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        os.makedirs(folder, exist_ok=True)

    def call(self, *command):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f'sound-report: {" ".join(command)}: {done.stderr.strip()}')
        return done.stdout

    def render(self, name, *lines):
        """path of the sound of a score, and the rows of its strokes"""
        score, sound, table = (os.path.join(self.folder, name + end)
                               for end in ('.txt', '.wav', '.csv'))
        with open(score, 'w', encoding='utf-8') as file:
            file.write(';\n'.join(lines) + ';\n')
        self.call(self.program, 'render', score, '-o', sound, '--strokes', table)
        with open(table, encoding='utf-8') as file:
            return sound, list(csv.DictReader(file))

    def stroke(self, name, inches, tune, how='legato mf'):
        return self.render(name, f'drum d {inches}', f'd tune {tune}', 'tempo 60',
                           f'stroke 1 right {how}')


def row(what, values, low, high, unit):
    target = f'{low} to {high}' if low > -np.inf and high < np.inf else \
        f'at most {high}' if high < np.inf else f'at least {low}'
    return (what, ', '.join(f'{v:.3g}' for v in values), f'{target} {unit}'.rstrip(),
            'met' if all(low <= v <= high for v in values) else 'MISSED')


def write_lines(folder, name, ours, real):
    """lines (Hz) and ring times (s) for report.gp: ours, recorded, between the recorded lines"""
    with open(os.path.join(folder, f'{name}.dat'), 'w', encoding='utf-8') as file:
        for channels in (ours, real):
            for f, _, t60, error in (line for c in channels for line in distance.lines_of(c)):
                file.write(f'{f * channels[0]["f0"]:.1f} {t60:.3f} {error:.3f}\n')
            file.write('\n\n')
        between = distance.means(real)
        for low, high in distance.GAPS[:3]:
            low = low or .7 * between['f0']
            t60 = between.get(f'between_{low:.0f}_t60', np.nan)
            file.write(f'{low:.0f} {t60}\n{high} {t60}\n\n')


def variation(himc):
    """mean correlation of thirty strokes with each other, each pair at its best within 5 ms"""
    sound, strokes = himc.render('human', 'tempo 20', 'human 0.5 1',
                                 *(f'stroke {i} right accent f' for i in range(1, 31)))
    x, rate = distance.load(sound)
    x, rate = decimate(x[0], 4), rate // 4
    span, lag, best = rate // 2, rate // 200, []
    starts = [int(float(s['time_s']) * rate) for s in strokes]
    for a, b in itertools.combinations(starts, 2):
        fixed, moved = x[a:a + span], sliding_window_view(x[b - lag:b + lag + span], span)
        best.append((moved @ fixed / np.linalg.norm(moved, axis=1)).max() / np.linalg.norm(fixed))
    return np.mean(best)


def force_change(himc, mallet):
    """change (%) of the peak force from 200 to 2000 modes"""
    few, many = (float(himc.render(f'force-{mallet}-{modes}', *D3, f'd mallet {mallet}',
                                   f'd modes {modes}', 'stroke 1 right accent f'
                                   )[1][0]['peak_force_n']) for modes in (200, 2000))
    return 100 * (many / few - 1)


def brightness(himc, dynamic, mallet):
    """mean frequency (Hz) of the power of a stroke's first 50 ms"""
    sound, _ = himc.render(f'bright-{dynamic}-{mallet}', *D3, f'd mallet {mallet}',
                           f'stroke 1 right accent {dynamic}')
    x, rate = distance.load(sound)
    f, power = distance.spectrum(x[0][distance.onset(x[0], rate):], rate, 0, .05)
    return (f * power).sum() / power.sum()


def loudness(himc, sounds):
    """integrated and largest momentary loudness (LUFS) of each, and its true peak (dBTP)"""
    tool = os.path.join(os.path.dirname(himc.program), '../tools/research/sound/loudness')
    lines = himc.call(tool, *sounds).splitlines()
    return np.array([[float(v) for v in line.split()] for line in lines]).T[[0, 3, 2]]


def other_rows(himc):
    sounds = [os.path.join(himc.folder, os.path.basename(p)[:-4] + '.wav') for p in PIECES]
    for piece, sound in zip(PIECES, sounds):
        himc.call(himc.program, 'render', piece, '-o', sound)
    whole, _, peaks = loudness(himc, sounds)
    _, moment, _ = loudness(himc, [himc.stroke(f'loud-{note}', inches, note)[0]
                                   for note, inches in LOUD.items()])
    return [row('loudness of the improvisation and the tide', whole, -25, -21, 'LUFS'),
            row('their true peaks', peaks, -np.inf, -1, 'dBTP'),
            row(f'loudest 0.4 s of one stroke mf, {", ".join(LOUD)}', moment, -30, np.inf, 'LUFS'),
            row('likeness of thirty strokes, `human 0.5`: mean correlation', [variation(himc)],
                .9, .99, ''),
            row(f'peak force from 200 to 2000 modes, {", ".join(MALLETS)}',
                [force_change(himc, m) for m in MALLETS], -2, 2, '%'),
            row('mean frequency of 50 ms, pp to ff, soft to wood',
                [brightness(himc, 'ff', 'medium') / brightness(himc, 'pp', 'medium'),
                 brightness(himc, 'mf', 'wood') / brightness(himc, 'mf', 'soft')], 1.8, np.inf,
                'times')]


def table(head, rows):
    return '\n'.join(f'| {" | ".join(r)} |' for r in [head, ['---'] * len(head), *rows]) + '\n'


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    himc = Himc(os.path.abspath(sys.argv[1]), sys.argv[2])
    known, found, first = distance.recordings(), {}, []
    for name, (inches, hz) in STROKES.items():
        ours = distance.measure(himc.stroke(name, inches, hz)[0], hz)
        write_lines(himc.folder, name, ours, known[name])
        found[name] = distance.verdict(ours, known[name])
        _, apart, _, _, target, met = found[name][0]
        first.append((name, apart, target, met, distance.summary(found[name])))
    summary = table(('recording', 'distance in bands of the ear, dB', 'target', '', 'targets met'),
                    first) + '\n' + table(('what', 'ours', 'target', ''), other_rows(himc))
    print(summary, end='')
    with open(os.path.join(himc.folder, 'report.md'), 'w', encoding='utf-8') as file:
        file.write(summary)
        for name, rows in found.items():
            file.write(f'\n## {name}\n\n' + table(('quantity', 'ours', 'recorded', 'apart',
                                                  'target', ''), rows))


if __name__ == '__main__':
    main()
