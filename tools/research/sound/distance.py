#!/usr/bin/env python3
"""How far a computed timpani stroke is from a recorded one, in numbers.

    distance.py measure WAVE [HZ]     describe a stroke: rows like those of recordings.csv
    distance.py compare WAVE NAME     beside a recording of recordings.csv: a row each quantity
    distance.py between NAME NAME     the same for two recordings

WAVE holds one stroke that rings on, as it is heard, with its room: nothing is added and nothing
fitted. One channel or two (ears, microphones): every quantity is the mean of both, a distance that
of all pairs. recordings.csv, beside this file, has four strokes in numbers, no audio: C2 and G2
(FluidR3, 32 kHz), A2 (WebAudioFont 0470_JCLive, 16 kHz, one channel) and F#3 (Merlin, 44.1 kHz);
drum, mallet, force, hall and microphone are unknown. HZ is the pitch of (1,1), without it the
strongest line from 50 to 260 Hz. Two recordings at unlike pitches are not compared in bands that
stay where they are. Another microphone meets 29 to 33 of about 36 targets, another real drum 11 to
23 of about 33. Needs numpy, scipy and soundfile.
"""
import csv
import os
import sys

import numpy as np
import soundfile
from scipy.signal import butter, fftconvolve, find_peaks, sosfiltfilt

# where the partial (m,1) may be, beside (1,1): the strongest line there counts
PARTIALS = {1: (.97, 1.03), 2: (1.44, 1.56), 3: (1.91, 2.06), 4: (2.36, 2.56), 5: (2.80, 3.08),
            6: (3.20, 3.56)}
SPANS = {'early': (.06, .30), 'late': (.25, 1.25)}  # (s) of the partials' levels
LINE_TOP = 900     # (Hz) of lines
STRAIGHT = 2.5     # (dB) deviation of a line from a straight decay; a hall's noise has 4 to 6
DECAY = (.15, 2.2, 35)  # a decay's beginning and end (s), and how far down (dB) it is followed
GAPS = [(0, 250), (250, 500), (500, 900), (1000, 2000), (2000, 4000)]  # (Hz) between lines
# bands as wide as the ear's (equivalent rectangular bandwidth, ERB), and their windows (s)
ERB_EDGES = (10 ** (np.linspace(*(np.log10(1 + .00437 * f) for f in (45, 4000)), 31)) - 1) / .00437
ERB_WINDOWS = [(0, .02), (.01, .04), (.03, .07), (.05, .1), (.1, .18), (.15, .25), (.25, .4),
               (.4, .6), (.6, .8)]
ERB_FLOOR = -45    # (dB) nothing below is compared
OCTAVES = [(250, 500), (500, 1000), (1000, 2000), (2000, 4000)]  # (Hz)
THIRDS = [63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800,
          1000, 1250, 1600, 2000, 2500, 3150, 4000, 5000]  # centres (Hz)
THIRDS_FLOOR = -70
WIDTHS = [(40, 200), (200, 800), (800, 3000)]  # (Hz) of what two channels have in common

# how far apart two values are, by unit; a target is the most
APART = {'cents': lambda a, b: abs(1200 * np.log2(a / b)), 'times': lambda a, b: max(a / b, b / a),
         'times fewer': lambda a, b: max(1, b / max(a, 1))}
# what is said, the quantity, unit, target
ROWS = [
    ('distance in bands of the ear, first 0.8 s', 'erb', 'dB', 5.5),
    *((f'level of ({m},1) beside (1,1), {a:g} to {b:g} s', f'partial_{m}1_{span}', 'dB',
       6 if m < 5 else 8) for m in range(2, 7) for span, (a, b) in SPANS.items()),
    *((f'frequency of ({m},1) beside (1,1)', f'ratio_{m}1', 'cents', 40) for m in range(2, 6)),
    ('ring time of a line beside the recorded one, median', 't60_ratio', 'times', 2 ** .4),
    ('share of lines with a ring time within 1.5 times', 't60_near', '', .4),
    ('share of recorded lines without one of ours', 't60_alone', '', .5),
    ('lines within 40 dB of the strongest, 0.5 to 1.5 s', 'lines', 'times fewer', 2),
    *((f'{low} to {high} Hz after {s} s, beside its beginning', f'band_{low}_{s}', 'dB', 4)
      for low, high in OCTAVES for s in ('0.05', '0.5')),
    ('time until within 10 % of the top', 'peak_time', 's', .02),
    ('beating: how uneven the four strongest lines decay (dB)', 'ripple', 'times', 2),
    *((f'energy left after {s} s', f'left_{s}', 'dB', 3 if s < 2 else 5) for s in (.5, 1, 2)),
    *((f'difference of the two channels, {low} to {high} Hz', f'width_{low}', '', .3)
      for low, high in WIDTHS),
    ('distance in third octaves, first 0.1 s', 'thirds_onset', 'dB', 8),
    ('distance in third octaves, 0.3 to 0.8 s', 'thirds_tail', 'dB', 8),
]


def decibels(power):
    return 10 * np.log10(power + 1e-20)


def load(path):
    """all channels (channels, samples) and the sample rate"""
    x, rate = soundfile.read(path, always_2d=True)
    return x.T.astype(float), rate


def onset(x, rate):
    """the sample at which a stroke begins, to a millisecond"""
    return max(0, int(np.argmax(np.abs(x) > .02 * np.abs(x).max())) - int(.001 * rate))


def spectrum(x, rate, begin, end, bins=1 << 18):
    """frequencies (Hz) and power of the windowed part from `begin` to `end` (s)"""
    part = x[int(begin * rate):int(end * rate)]
    window = np.hanning(len(part))
    power = np.abs(np.fft.rfft(part * window, bins)) ** 2 / max((window ** 2).sum(), 1e-9)
    return np.arange(len(power)) * rate / bins, power


def band_powers(f, power, edges):
    return np.array([power[(f >= low) & (f < high)].sum() for low, high in edges])


def find_line(x, rate, low, high, begin, end):
    """frequency (Hz) of the strongest line from `low` to `high`"""
    f, power = spectrum(x, rate, begin, end)
    k = (f > low) & (f < high)
    return float(f[k][np.argmax(power[k])])


def find_lines(x, rate, begin, end, low, down, prominence):
    """frequency and level (Hz, dB) of the lines at most `down` dB below the strongest"""
    f, power = spectrum(x, rate, begin, end)
    k = (f > low) & (f < LINE_TOP)
    level = decibels(power[k])
    at, _ = find_peaks(level, height=level.max() - down, prominence=prominence,
                       distance=max(1, int(8 / f[1])))
    return [(float(f[k][i]), float(level[i] - level.max())) for i in at]


def envelope(x, rate, hz, width):
    """times (s) and levels (dB) of the band hz ± width, each 2 ms of the first 3 s"""
    x, window = x[:3 * rate], np.hanning(int(2 * rate / width))
    beat = fftconvolve(x * np.exp(-2j * np.pi * hz * np.arange(len(x)) / rate),
                       window / window.sum(), 'same')
    at = np.arange(0, len(x), max(1, int(.002 * rate)))
    return at / rate, 20 * np.log10(2 * np.abs(beat[at]) + 1e-12)


def ring_time(x, rate, hz, width, begin=DECAY[0], end=DECAY[1], down=DECAY[2]):
    """T60 of a line by a straight line through its envelope, the T60's standard error (s, with one
    value each 1/width s), and the envelope's deviation (dB); None if it cannot be told"""
    t, level = envelope(x, rate, hz, width)
    k = (t > begin) & (t < min(end, len(x) / rate - 1 / width))
    t, level = t[k], level[k]
    if len(t) < 150:
        return None
    low = np.flatnonzero(level < level[:25].max() - down)
    if len(low) and low[0] > 125:
        t, level = t[:low[0]], level[:low[0]]
    slope, start = np.polyfit(t, level, 1)
    if slope > -1:  # 60 s or more
        return None
    deviation = float((level - slope * t - start).std())
    error = deviation / np.sqrt(max(3, (t[-1] - t[0]) * width)) / t.std()
    return -60 / slope, 60 * error / slope ** 2, deviation


def ring_time_between(x, rate, low, high, lines):
    """T60 (s) of the two widest gaps between lines: the hall's; None if there are none"""
    edges = [low, *(f for f in lines if low < f < high), high]
    gaps = sorted(((b - a, (a + b) / 2) for a, b in zip(edges, edges[1:])), reverse=True)[:2]
    found = [ring_time(x, rate, middle, max(8, wide / 4), .1, 1.5, 30)
             for wide, middle in gaps if wide > 24]
    found = [r[0] for r in found if r]
    return float(np.median(found)) if found else None


def describe_partials(x, rate, f0):
    q, seconds = {}, len(x) / rate
    for m, (low, high) in PARTIALS.items():
        hz = find_line(x, rate, f0 * low, f0 * high, .08, min(1.3, seconds))
        q[f'partial_{m}1_hz'] = hz
        for span, (begin, end) in SPANS.items():
            end = min(end, seconds - .01)
            if end - begin >= .15:
                half = max(4, 2.2 / (end - begin))
                level = decibels(band_powers(*spectrum(x, rate, begin, end),
                                             [(hz - half, hz + half)])[0])
                q[f'partial_{m}1_{span}'] = level - q.get(f'partial_11_{span}', 0)
    return {k: v for k, v in q.items() if k not in ('partial_11_early', 'partial_11_late')}


def describe_lines(x, rate, f0):
    """lines, their ring times, those of what is between them, and the beating of the strongest"""
    q, seconds, count = {}, len(x) / rate, 0
    if seconds > .9:
        q['lines'] = len(find_lines(x, rate, .5, min(1.5, seconds), .7 * f0, 40, 10))
    lines = find_lines(x, rate, .12, min(1.2, seconds), .7 * f0, 45, 12)
    spots = [f for f, _ in lines]
    for f, level in lines:
        gap = min([abs(f - g) for g in spots if g != f] + [60])
        r = ring_time(x, rate, f, float(np.clip(.45 * gap, 6, 20)))
        if r and r[2] < STRAIGHT:
            q |= {f'line_{count}_hz': f, f'line_{count}_db': level, f'line_{count}_t60': r[0],
                  f'line_{count}_t60_error': r[1]}
            count += 1
    for low, high in GAPS:
        low = low or .7 * f0
        if high < .49 * rate and seconds > .8:
            q[f'between_{low:.0f}_t60'] = ring_time_between(x, rate, low, high, spots)
    uneven = []
    for f, _ in sorted(lines, key=lambda line: -line[1])[:4]:
        t, level = envelope(x, rate, f, 12)
        k = (t > .2) & (t < min(1.2, seconds - .1))
        if k.sum() > 200:
            uneven.append((level[k] - np.polyval(np.polyfit(t[k], level[k], 1), t[k])).std())
    return q | {'ripple': float(np.mean(uneven)) if uneven else None}


def describe_octaves(x, rate):
    """levels (dB) after 50 ms and 0.5 s beside the largest of the first 50 ms"""
    q, n, seconds = {}, int(.02 * rate), len(x) / rate
    for low, high in OCTAVES:
        if high < .49 * rate:
            y = sosfiltfilt(butter(4, [low, high], 'band', fs=rate, output='sos'), x) ** 2
            level = 10 * np.log10(np.maximum(fftconvolve(y, np.ones(n) / n, 'same'), 0) + 1e-14)
            top = level[:int(.05 * rate)].max()
            q[f'band_{low}_0.05'] = level[int(.05 * rate)] - top
            if seconds > .55:
                q[f'band_{low}_0.5'] = np.median(level[int(.45 * rate):int(.55 * rate)]) - top
    return q


def describe_bands(x, rate):
    """levels of the ear's bands beside the largest, those of third octaves beside the whole (dB)"""
    y, levels = np.concatenate([np.zeros(int(.005 * rate)), x]), []
    for begin, end in ERB_WINDOWS:
        if end * rate <= len(y):
            levels.append(decibels(band_powers(*spectrum(y, rate, begin, end, 1 << 17),
                                               list(zip(ERB_EDGES, ERB_EDGES[1:])))))
    levels = np.maximum(np.array(levels) - np.max(levels), -99)
    q = {f'erb_{k}_{w}': v for w, row in enumerate(levels) for k, v in enumerate(row)}
    thirds = {c: (c / 2 ** (1 / 6), c * 2 ** (1 / 6)) for c in THIRDS}
    for part, begin, end, bands in (('onset', 0, .1, thirds), ('tail', .3, .8, thirds),
                                    ('octave', 0, .1, {low: (low, high) for low, high in OCTAVES})):
        if end < len(x) / rate:
            f, power = spectrum(x, rate, begin, end)
            shares = decibels(band_powers(f, power, bands.values()) / power.sum())
            q |= {f'{part}_{c}': v for c, v in zip(bands, shares) if bands[c][1] < .5 * rate}
    return q


def describe(x, rate, f0):
    """{quantity: value} of one channel; levels in dB, times in s, frequencies in Hz"""
    x, n = x[onset(x, rate):], int(.01 * rate)
    power = fftconvolve(x ** 2, np.ones(n) / n, 'same')
    left = np.cumsum(x[::-1] ** 2)[::-1]
    q = {'f0': f0, 'rate_hz': rate, 'length_s': len(x) / rate}
    for part in (describe_partials(x, rate, f0), describe_lines(x, rate, f0),
                 describe_octaves(x, rate), describe_bands(x, rate)):
        q |= part
    q['peak_time'] = np.argmax(power > .9 * power[:int(.15 * rate)].max()) / rate
    q |= {f'left_{s}': decibels(left[int(s * rate)] / left[0])
          for s in (.5, 1, 2) if s * rate < len(x)}
    return {k: float(v) for k, v in q.items() if v is not None}


def describe_widths(x, rate):
    """1 less the largest correlation of two channels within a millisecond, first 0.8 s"""
    q, lag = {}, int(.001 * rate)
    x = x[:, onset(x.sum(0), rate):][:, :int(.8 * rate)]
    for low, high in WIDTHS:
        a, b = sosfiltfilt(butter(3, [low, high], 'band', fs=rate, output='sos'), x)
        both = [a[max(0, d):len(a) + min(0, d)] @ b[max(0, -d):len(b) + min(0, -d)]
                for d in range(-lag, lag + 1)]
        q[f'width_{low}'] = float(1 - np.abs(both).max() / np.sqrt((a @ a) * (b @ b) + 1e-30))
    return q


def measure(path, f0=None):
    """what a sound file is: {quantity: value} of each of its channels, at most two"""
    x, rate = load(path)
    mono = x.mean(0)
    low, high = (.96 * f0, 1.04 * f0) if f0 else (50, 260)
    f0 = find_line(mono[onset(mono, rate):], rate, low, high, .08, 1.2)
    common = describe_widths(x[:2], rate) if len(x) > 1 else {}
    return [describe(channel, rate, f0) | common for channel in x[:2]]


def recordings():
    """{recording: its channels, each {quantity: value}}"""
    table = {}
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), 'recordings.csv')
    with open(path, encoding='utf-8') as file:
        for r in csv.DictReader(file):
            name, _, channel = r['recording'].partition('.')
            channels = table.setdefault(name, {})
            channels.setdefault(channel, {})[r['quantity']] = float(r['value'])
    return {name: list(channels.values()) for name, channels in table.items()}


def means(channels):
    q = {k: float(np.mean([c[k] for c in channels if k in c])) for c in channels for k in c}
    return q | {f'ratio_{m}1': q[f'partial_{m}1_hz'] / q['partial_11_hz'] for m in PARTIALS}


def lines_of(channel):
    """(frequency beside (1,1), level in dB, T60 and its error in s) of a channel's lines"""
    for i in range(sum(k.endswith('_db') for k in channel)):
        hz, *rest = (channel[f'line_{i}_{k}'] for k in ('hz', 'db', 't60', 't60_error'))
        yield hz / channel['f0'], *rest


def ring_times(ours, real):
    """T60 of ours beside each recorded line whose T60 is sure: the strongest within 2.5 %"""
    ratios, alone = [], 0
    own = [line for channel in ours for line in lines_of(channel)]
    for f, level, t60, error in (line for channel in real for line in lines_of(channel)):
        if error <= .35 * t60 and level >= -35:
            near = [line for line in own if abs(line[0] / f - 1) < .025]
            alone += not near
            if near:
                ratios.append(max(near, key=lambda line: line[1])[2] / t60)
    if not ratios:
        return {}
    near = np.abs(np.log2(ratios)) <= .585
    return {'t60_ratio': 2 ** np.median(np.log2(ratios)), 't60_near': near.mean(),
            't60_alone': alone / (alone + len(ratios))}


def bands_apart(a, b):
    """RMS difference (dB) of two channels in the ear's bands, at the level with the least"""
    keys = [k for k in a if k.startswith('erb_') and k in b]
    a, b = (np.array([q[k] for k in keys]) for q in (a, b))
    a, b = np.maximum(a - a.max(), ERB_FLOOR), b - b.max()
    return min(np.sqrt(np.mean((a - np.maximum(b + gain, ERB_FLOOR)) ** 2))
               for gain in range(-12, 13))


def thirds_apart(a, b, part):
    keys = [k for c in THIRDS if c >= .8 * b['f0'] and (k := f'{part}_{c}') in a and k in b]
    apart = [max(a[k], THIRDS_FLOOR) - max(b[k], THIRDS_FLOOR) for k in keys]
    return np.sqrt(np.mean(np.square(apart)))


def verdict(ours, real):
    """(what, ours, recorded, apart, target, met) of each quantity that both have"""
    a, b = means(ours), means(real)
    a |= ring_times(ours, real)
    b |= {'t60_ratio': 1, 't60_near': 1, 't60_alone': 0, 'erb': 0, 'thirds_onset': 0,
          'thirds_tail': 0}
    if abs(a['f0'] / b['f0'] - 1) < .04:
        a['erb'] = np.mean([bands_apart(o, r) for o in ours for r in real])
        a |= {f'thirds_{part}': thirds_apart(a, b, part) for part in ('onset', 'tail')}
    rows = []
    for what, key, unit, target in ROWS:
        if key in a and key in b:
            apart = APART.get(unit, lambda x, y: abs(x - y))(a[key], b[key])
            rows.append((what, f'{a[key]:.3g}', f'{b[key]:.3g}', f'{apart:.3g} {unit}'.rstrip(),
                         f'{target:.3g}', 'met' if apart <= target + 1e-9 else 'MISSED'))
    return rows


def summary(rows):
    """targets met of how many"""
    return f'{sum(r[-1] == "met" for r in rows)} of {len(rows)}'


def main():
    does, *rest = sys.argv[1:] or ['']
    known = recordings()
    names = {'measure': [], 'compare': rest[1:], 'between': rest}.get(does)
    if names is None or len(rest) not in ((1, 2) if does == 'measure' else (2,)):
        sys.exit(__doc__)
    for name in names:
        if name not in known:
            sys.exit(f'distance: no recording {name}, expected {", ".join(known)}')
    if does == 'measure':
        channels, out = measure(rest[0], *map(float, rest[1:])), csv.writer(sys.stdout)
        name = os.path.splitext(os.path.basename(rest[0]))[0]
        for end, channel in zip(('.L', '.R') if len(channels) > 1 else ('',), channels):
            out.writerows((name + end, k, f'{v:.4g}') for k, v in channel.items())
        return
    real = known[rest[1]]
    rows = verdict(known[rest[0]] if does == 'between' else measure(rest[0], real[0]['f0']), real)
    for row in rows:
        print(f'{row[0]:58}{row[1]:>9}{row[2]:>9}  {row[3]:18}{row[4]:>5}  {row[5]}')
    print(f'targets met: {summary(rows)}')


if __name__ == '__main__':
    main()
