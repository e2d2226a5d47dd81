#!/usr/bin/env python3
"""A blind test of computed timpani beside recorded ones (docs/results/listen.md).

    listen.py prepare FOLDER [PROGRAM]    render the six strokes into FOLDER, NAME-computed.wav each
    listen.py hear FOLDER [PLAYER]        play each pair twice in random order, and keep the answers

FOLDER also has your recordings, NAME-recorded.wav. The computed stroke is heard by two ears in the
default room as it is; `hear` brings both of a pair to one length, power and number of channels.
PROGRAM is build/bin/himc; PLAYER any program that plays a WAV file, aplay if not given. The answers
are added to FOLDER/answers.csv. Needs numpy, scipy and soundfile.
"""
import csv
import math
import os
import random
import subprocess
import sys
import tempfile
import time

import numpy as np
import soundfile
from scipy.signal import resample_poly

import distance

ROLL = [f'stroke {1 + i / 8:g} {"left" if i % 2 else "right"} legato {d} normal timpano'
        for i, d in enumerate(['p'] * 8 + ['mp'] * 8 + ['mf'] * 8 + ['f'] * 8)]
# name: drum (inches), note, further lines of its score
PAIRS = {
    'C2-f': (32, 'C2', ['stroke 1 right accent f normal timpano']),
    'G2-f': (29, 'G2', ['stroke 1 right accent f normal timpano']),
    'D3-mf': (26, 'D3', ['stroke 1 right legato mf normal timpano']),
    'A3-p': (23, 'A3', ['stroke 1 right legato p normal timpano']),
    'D3-ff-wood': (26, 'D3', ['timpano mallet wood', 'stroke 1 right accent ff normal timpano']),
    'G2-roll': (29, 'G2', ['tempo 100'] + ROLL),
}
FADE = .02  # (s) at the end


def prepare(folder, program='build/bin/himc'):
    os.makedirs(folder, exist_ok=True)
    for name, (inches, note, lines) in PAIRS.items():
        score = os.path.join(folder, name + '.txt')
        with open(score, 'w', encoding='utf-8') as file:
            file.write(';\n'.join(['human 0.5', f'drum timpano {inches}', f'timpano tune {note}',
                                   *lines]) + ';\n')
        sound = os.path.join(folder, name + '-computed.wav')
        subprocess.run([program, 'render', score, '-o', sound], check=True,
                       stdout=subprocess.DEVNULL)
        print(f'{sound}: a recording to stand beside it is {name}-recorded.wav')


def match(recorded, computed):
    """both with the channels, rate and length that both have, and one power"""
    (x, rate), (y, own) = distance.load(recorded), distance.load(computed)
    y = resample_poly(y, rate, own, axis=1)
    x, y = (z[:, distance.onset(z.sum(0), rate):] for z in (x, y))
    channels, n = np.minimum(x.shape, y.shape)
    x, y = x[:channels, :n], y[:channels, :n]
    y = y * np.sqrt((x ** 2).sum() / (y ** 2).sum())
    end = np.minimum(1, np.arange(n)[::-1] / (FADE * rate))
    top = max(np.abs(x).max(), np.abs(y).max()) / .7
    return (x * end / top).T, (y * end / top).T, rate


def ask(sounds, rate, player, work):
    """plays two sounds until the listener has chosen; 1 or 2, and how sure"""
    while True:
        for i, sound in enumerate(sounds):
            path = os.path.join(work, 'sound.wav')
            soundfile.write(path, sound, rate)
            print(f'   {i + 1} …', flush=True)
            subprocess.run([player, path], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                           check=True)
            time.sleep(.4)
        said = input('which is the recording, 1 or 2, and how sure, 1 to 3 (for example: 2 3)? '
                     'Enter plays both again: ').split()
        if len(said) == 2 and said[0] in '12' and said[1] in '123':
            return int(said[0]), int(said[1])


def chance(right, of):
    """probability of so many right answers or more by guessing"""
    return sum(math.comb(of, k) for k in range(right, of + 1)) / 2 ** of


def hear(folder, player='aplay'):
    trials = [(name, first) for name in PAIRS for first in ('recorded', 'computed')]
    trials = [t for t in trials if os.path.exists(os.path.join(folder, t[0] + '-recorded.wav'))]
    if not trials:
        sys.exit(f'listen: {folder}: no recording, expected {", ".join(PAIRS)}, each -recorded.wav')
    random.shuffle(trials)
    right, answers = 0, os.path.join(folder, 'answers.csv')
    with tempfile.TemporaryDirectory() as work, open(answers, 'a', encoding='utf-8') as file:
        out = csv.writer(file)
        for number, (name, first) in enumerate(trials):
            print(f'{number + 1} of {len(trials)}')
            pair = [os.path.join(folder, f'{name}-{k}.wav') for k in ('recorded', 'computed')]
            recorded, computed, rate = match(*pair)
            sounds = [recorded, computed] if first == 'recorded' else [computed, recorded]
            choice, sure = ask(sounds, rate, player, work)
            good = (choice == 1) == (first == 'recorded')
            right += good
            out.writerow([time.strftime('%F %T'), name, first, choice, sure, int(good)])
    print(f'{right} of {len(trials)} right; by guessing so many or more with probability '
          f'{chance(right, len(trials)):.2g}. {answers}')


def main():
    does = {'prepare': prepare, 'hear': hear}
    if len(sys.argv) not in (3, 4) or sys.argv[1] not in does:
        sys.exit(__doc__)
    does[sys.argv[1]](*sys.argv[2:])


if __name__ == '__main__':
    main()
