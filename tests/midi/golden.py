#!/usr/bin/python3
"""Writes NAME.csv for each NAME.mid of this folder and of patches/pieces: its notes as mido reads them.

    golden.py       (needs python3-mido)

A row for each note-on: time_s,channel,key,velocity,program.
"""
import glob
import os

import mido

HERE = os.path.dirname(os.path.abspath(__file__))


def tick_seconds(midi, tempo):
    """SMPTE divisions, which mido reads as they are: minus frames a second, ticks a frame."""
    division = midi.ticks_per_beat
    if division > 0:
        return tempo / 1e6 / division
    return 1.0 / (-(division >> 8) * (division & 0xFF))


def rows(path):
    midi, seconds, tempo, program = mido.MidiFile(path), 0.0, 500000, {}
    for message in mido.merge_tracks(midi.tracks):
        seconds += message.time * tick_seconds(midi, tempo)
        if message.type == "set_tempo":
            tempo = message.tempo
        elif message.type == "program_change":
            program[message.channel] = message.program
        elif message.type == "note_on" and message.velocity > 0:
            yield seconds, message.channel, message.note, message.velocity, program.get(message.channel, 0)


PIECES = os.path.join(HERE, "..", "..", "patches", "pieces")
for file in sorted(glob.glob(os.path.join(HERE, "*.mid")) + glob.glob(os.path.join(PIECES, "*.mid"))):
    with open(os.path.join(HERE, os.path.basename(file)[:-4] + ".csv"), "w") as table:
        table.write("time_s,channel,key,velocity,program\n")
        for row in rows(file):
            table.write("%.9f,%d,%d,%d,%d\n" % row)
