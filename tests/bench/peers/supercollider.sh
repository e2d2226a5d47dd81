#!/bin/sh
# SuperCollider: Klank with 200 modes, and MembraneCircle struck four times a second, offline in blocks of 64 at 48 kHz.
# Debian: supercollider-server supercollider-language sc3-plugins-server sc3-plugins-language. Prints `WHAT VALUE LABEL` a line;
# exit status 77 where it is missing.
command -v scsynth >/dev/null && command -v sclang >/dev/null || { echo "supercollider: not installed" >&2; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
export WORK="$work" QTWEBENGINE_DISABLE_SANDBOX=1 QT_QPA_PLATFORM=offscreen HOME="$work" XDG_RUNTIME_DIR="$work"
timeout 120 sclang "$here/supercollider.scd" >"$work/log" 2>&1 </dev/null
[ -e "$work/drum21.osc" ] || { tail -n 3 "$work/log" >&2; exit 1; }
processor_time() { # of the best of three runs (s)
    for _ in 1 2 3; do
        bash -c 'TIMEFORMAT=%U; time scsynth -N "$1" _ /dev/null 48000 WAV int16 -o 1 >/dev/null 2>&1' - "$work/$1.osc" 2>&1
    done | sort -n | head -n 1
}
for what in bank drum; do
    echo "$what $(processor_time ${what}1) $(processor_time ${what}21)"
done | awk '
    $1 == "bank" && $3 > $2 { printf "modes_per_core %.0f SuperCollider Klank, 200 modes\n", 200 * 20 / ($3 - $2) }
    $1 == "drum" && $3 > $2 { printf "drum_ms_per_s %.3f SuperCollider MembraneCircle\n", 1e3 * ($3 - $2) / 20 }'
