#!/bin/sh
# Faust: a bank of 200 two-pole resonators in double precision, scalar and -vec: modes that one core plays in real time
# at 48 kHz in blocks of 64. Debian: faust g++. Prints `WHAT VALUE LABEL` a line; exit status 77 where it is missing.
command -v faust >/dev/null && command -v g++ >/dev/null || { echo "faust: not installed" >&2; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
{ echo "MODES = 200;" && cat "$here/bank.dsp"; } >bank.dsp
for way in "" "-vec -vs 32"; do
    # shellcheck disable=SC2086
    faust -double $way -a "$here/faust.cpp" bank.dsp -o bank.cpp &&
        g++ -O3 -march=native -ffast-math -w bank.cpp -o bank || exit 1
    echo "modes_per_core $(./bank 200) Faust${way:+ -vec}, 200 modes"
done
