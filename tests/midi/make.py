#!/usr/bin/env python3
"""Writes the MIDI files of this folder and of patches/pieces, byte by byte, without any library.

The music is in the public domain: figures of the timpani in Beethoven's ninth symphony (1824, second
movement), Strauss's Also sprach Zarathustra (1896), Haydn's symphony 103 (1795); the rest is made up
for the tests.
"""
import os
import struct

HERE = os.path.dirname(os.path.abspath(__file__))


def number(value):
    out = [value & 0x7F]
    while value > 0x7F:
        value >>= 7
        out.append(0x80 | value & 0x7F)
    return bytes(reversed(out))


def track(events, running=False, end=True):
    """events: (tick, bytes). With `running` a status byte is left out where it may be."""
    out, at, status = b"", 0, None
    for tick, data in sorted(events, key=lambda e: e[0]):
        out += number(tick - at)
        at = tick
        same = running and data[0] < 0xF0 and data[0] == status
        out += data[1:] if same else data
        status = data[0] if data[0] < 0xF0 else None
    if end:
        out += b"\0\xff\x2f\0"
    return b"MTrk" + struct.pack(">I", len(out)) + out


def write(name, kind, division, tracks):
    with open(os.path.join(HERE, name), "wb") as f:
        f.write(b"MThd" + struct.pack(">IHHH", 6, kind, len(tracks), division & 0xFFFF) + b"".join(tracks))


def tempo(tick, bpm):
    return tick, b"\xff\x51\x03" + struct.pack(">I", round(60e6 / bpm))[1:]


def name(text):
    return 0, b"\xff\x03" + number(len(text)) + text.encode()


def program(channel, value):
    return 0, bytes([0xC0 | channel, value])


def note(tick, length, key, velocity, channel=0, zero=True):
    """`zero`: the note ends by a note-on of velocity 0."""
    off = bytes([0x90 | channel, key, 0]) if zero else bytes([0x80 | channel, key, 64])
    return [(tick, bytes([0x90 | channel, key, velocity])), (tick + length, off)]


def scherzo():
    """Octaves in F, dotted, molto vivace; the tempo broadens at the end."""
    q, events = 480, [name("Timpani in F"), tempo(0, 348), tempo(480 * 24, 290.5), tempo(480 * 36, 261.25)]
    for bar in range(16):
        key = 53 if bar % 4 < 2 else 41
        if bar % 4 in (0, 2):
            events += note(bar * 3 * q, 180, key, 112) + note(bar * 3 * q + 3 * q // 2, 100, key, 90)
            events += note(bar * 3 * q + 2 * q, 240, key, 104)
    write("scherzo.mid", 0, q, [track(events, running=True)])


def zarathustra():
    """C and G in turn, under a held chord of another instrument; tempi in a track of their own."""
    q = 96
    tempi = [tempo(0, 60), tempo(q * 4, 54), tempo(q * 9 + 48, 66.6), tempo(q * 9 + 60, 48)]
    drum, chord = [program(2, 47)], [program(1, 61)]
    for i in range(13):
        drum += note(q * 4 + i * 32, 16, 48 if i % 2 == 0 else 43, 127 - 3 * i, 2, zero=False)
    drum += note(q * 10, q * 2, 48, 127, 2)
    chord += note(0, q * 12, 60, 80, 1) + note(0, q * 12, 67, 80, 1)
    write("../../patches/pieces/zarathustra.mid", 1, q, [track(tempi), track(drum, running=True), track(chord)])


def roll():
    """A roll on E flat, thirteen strokes a second, growing and dying away."""
    q, events = 240, [program(3, 47), tempo(0, 60)]
    for i in range(40):
        events += note(i * 18, 9, 51, 30 + (80 if 15 <= i < 25 else 4 * min(i, 39 - i)), 3)
    write("roll.mid", 0, q, [track(events)])


def pedals():
    """A bass line of eleven pitches for four drums: they have to be retuned. One pitch is too low, two
    notes come too fast for a pedal."""
    q, events = 192, [name("Pauken"), tempo(0, 100)]
    line = [38, 45, 50, 53, 40, 47, 52, 55, 41, 48, 33]
    for i, key in enumerate(line):
        events += note(i * 3 * q, q, key, 64 + 5 * i, 4)
    for i, key in enumerate([58, 59, 57, 58, 59, 57]):
        events += note(34 * q + i * 24, 12, key, 100, 4)
    write("pedals.mid", 1, q, [track(events)])


def groove():
    """A drum kit: bass drum, snare, toms, and cymbals that no head can play; three at once."""
    q, events = 120, [tempo(0, 112), tempo(120 * 8, 126.5)]
    for bar in range(4):
        at = bar * 4 * q
        for eighth in range(8):
            events += note(at + eighth * q // 2, 20, 42, 70, 9)
        for beat in (0, 2, 2.5):
            events += note(at + round(beat * q), 30, 36, 110, 9)
        for beat in (1, 3):
            events += note(at + beat * q, 30, 38, 100, 9, zero=False)
        events += note(at, 200, 49, 120, 9) + note(at + round(3.5 * q), 20, 37, 60, 9)
    for i, key in enumerate([50, 50, 48, 47, 45, 43, 41, 41]):
        events += note(16 * q + i * 30, 20, key, 90 + i, 9)
    events += [e for key in (36, 38, 41, 60, 35) for e in note(20 * q, 60, key, 127, 9)]
    write("groove.mid", 0, q, [track(events, running=True, end=False)])


def frames():
    """25 frames a second of 40 ticks: no beats at all."""
    events = [program(0, 47)] + [e for i in range(6) for e in note(i * 700, 300, 45, 40 + 15 * i)]
    write("frames.mid", 0, -(25 << 8) + 40, [track(events)])


for write_file in (scherzo, zarathustra, roll, pedals, groove, frames):
    write_file()
