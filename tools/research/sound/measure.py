#!/usr/bin/env python3
"""What a recorded or computed timpani stroke is, in numbers, and how far two are apart.

    measure.py WAVE...    describe strokes: rows like those of recordings.csv beside this file

WAVE holds one stroke that rings on. Bands are levels relative to the whole, so neither loudness nor
calibration counts. A recording has a room in it and a computed stroke has none. Before the two are
compared, the computed one is therefore put into six synthetic rooms (noise that decays, one fixed
seed, rising level), and the nearest counts. Needs numpy, scipy and soundfile.
"""
import csv
import os
import sys

import numpy as np
import soundfile
from scipy.signal import butter, fftconvolve, sosfilt

THIRDS = [63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800,
          1000, 1250, 1600, 2000, 2500, 3150, 4000, 5000]  # centres (Hz)
OCTAVES = [500, 1000, 2000, 4000]  # lower edges (Hz)
ONSET, TAIL = (0, .1), (.3, .8)    # (s) from the beginning
FLOOR = -70                        # (dB) nothing below is compared: a recording's noise
ROOMS = [0, .1, .2, .35, .5, .7]   # levels beside the stroke
ROOM_T60 = [(40, 125, 2.2), (125, 250, 2.5), (250, 500, 2.8), (500, 1000, 2.6),
            (1000, 2000, 2.2), (2000, 4000, 1.8), (4000, 8000, 1.2)]  # (Hz, Hz, s) of a concert hall
BINS = 1 << 18
HERE = os.path.dirname(os.path.abspath(__file__))


def decibels(power):
    return 10 * np.log10(power + 1e-20)


def load(path):
    """all channels (channels, samples) and the sample rate"""
    x, rate = soundfile.read(path, always_2d=True)
    return x.T.astype(float), rate


def from_onset(x, rate):
    """without what comes before the stroke, to a millisecond"""
    first = int(np.argmax(np.abs(x) > .02 * np.abs(x).max())) - int(.001 * rate)
    return x[max(0, first):]


def spectrum(x, rate, begin, end):
    """frequencies (Hz) and power of the windowed part from `begin` to `end` (s)"""
    part = x[int(begin * rate):int(end * rate)]
    power = np.abs(np.fft.rfft(part * np.hanning(len(part)), BINS)) ** 2
    return np.arange(len(power)) * rate / BINS, power


def bands(x, rate, when, edges):
    """levels (dB) of bands relative to the whole"""
    f, power = spectrum(x, rate, *when)
    return [decibels(power[(f >= low) & (f < high)].sum() / power.sum()) for low, high in edges]


def thirds(x, rate, when):
    return bands(x, rate, when, [(c / 2 ** (1 / 6), c * 2 ** (1 / 6)) for c in THIRDS])


def octaves(x, rate):
    return bands(x, rate, ONSET, [(low, 2 * low) for low in OCTAVES])


def left_after(x, rate, seconds):
    """energy (dB) that is still to come, relative to the whole"""
    energy = np.cumsum(x[::-1] ** 2)[::-1]
    at = int(seconds * rate)
    return decibels(energy[at] / energy[0]) if at < len(x) else None


def partials(x, rate, top, count):
    """frequencies (Hz) of the strongest partials below `top`, strongest first"""
    f, power = spectrum(x, rate, .05, min(1.2, len(x) / rate))
    inner = power[1:-1]
    peaks = 1 + np.flatnonzero((inner > power[:-2]) & (inner >= power[2:]))
    found = []
    for i in sorted(peaks, key=lambda i: -power[i]):
        if 30 < f[i] < top and all(abs(f[i] - g) > 6 for g in found):
            found.append(float(f[i]))
        if len(found) == count:
            break
    return found


def ripple(x, rate):
    """beating: deviation (dB) of the four strongest partials from a straight decay, 0.2 to 1.2 s"""
    t, deviation = np.arange(len(x)) / rate, []
    first, last = int(.2 * rate), int(1.2 * rate)
    window = np.hanning(int(rate / 6))
    for f in partials(x, rate, 700, 4):
        beat = fftconvolve(x * np.exp(-2j * np.pi * f * t), window / window.sum(), 'same')
        level = 20 * np.log10(2 * np.abs(beat[first:last]) + 1e-9)
        if len(level) == last - first:
            k = np.arange(len(level))
            deviation.append(float((level - np.polyval(np.polyfit(k, level, 1), k)).std()))
    return float(np.mean(deviation)) if deviation else None


def centroid(x, rate, seconds=.05):
    """mean frequency (Hz) of the power of the beginning"""
    f, power = spectrum(from_onset(x, rate), rate, 0, seconds)
    return float((f * power).sum() / power.sum())


def describe(x, rate):
    x = from_onset(x, rate)
    row = dict(zip([f'onset_{c}' for c in THIRDS], thirds(x, rate, ONSET)))
    if len(x) > TAIL[1] * rate:
        row |= dict(zip([f'tail_{c}' for c in THIRDS], thirds(x, rate, TAIL)))
    row |= dict(zip([f'octave_{c}' for c in OCTAVES], octaves(x, rate)))
    row |= {'ripple': ripple(x, rate)} | {f'left_{s}': left_after(x, rate, s) for s in (.5, 1, 2)}
    for i, f in enumerate(sorted(partials(x, rate, 700, 6))):
        row[f'partial_{i}'] = f
    return {k: v for k, v in row.items() if v is not None}


def recordings(path=os.path.join(HERE, 'recordings.csv')):
    """{recording: {quantity: value}}"""
    table = {}
    with open(path, encoding='utf-8') as file:
        for r in csv.DictReader(line for line in file if not line.startswith('#')):
            table.setdefault(r['recording'], {})[r['quantity']] = float(r['value'])
    return table


def echo(rate):
    """the room's answer to a click, its energy 1"""
    dice, t = np.random.default_rng(1), np.arange(3 * rate) / rate
    y = np.zeros(len(t))
    for low, high, t60 in ROOM_T60:
        band = butter(2, [low, high], 'band', fs=rate, output='sos')
        y += sosfilt(band, dice.standard_normal(len(y))) * np.exp(-6.908 * t / t60)
    y[:int(.012 * rate)] = 0
    return y / np.sqrt((y ** 2).sum())


def distance(a, b, part, lowest, highest):
    """RMS difference (dB) of two descriptions' third octaves"""
    keep = [f'{part}_{c}' for c in THIRDS if lowest <= c <= highest and f'{part}_{c}' in b]
    apart = [max(a[k], FLOOR) - max(b[k], FLOOR) for k in keep]
    return float(np.sqrt(np.mean(np.square(apart)))) if apart else 0.


def compare(x, rate, recorded):
    """distances (dB) of a dry stroke in the nearest room, that room's level and the description"""
    x, answer = from_onset(x, rate), echo(rate)
    lowest, highest = .8 * recorded['pitch_hz'], recorded['highest_hz']
    best = None
    for level in ROOMS:
        here = describe(x + level * fftconvolve(x, answer)[:len(x)], rate)
        onset, tail = (distance(here, recorded, part, lowest, highest) for part in ('onset', 'tail'))
        if best is None or onset + tail < best['onset'] + best['tail']:
            best = {'onset': onset, 'tail': tail, 'room': level, 'is': here}
    return best


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    out = csv.writer(sys.stdout)
    out.writerow(['recording', 'quantity', 'value'])
    for path in sys.argv[1:]:
        x, rate = load(path)
        name = os.path.splitext(os.path.basename(path))[0]
        for quantity, value in describe(x[0], rate).items():
            out.writerow([name, quantity, f'{value:.3f}'])


if __name__ == '__main__':
    main()
