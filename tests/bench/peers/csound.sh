#!/bin/sh
# Csound: 200 `mode` filters at 48 kHz in blocks of 64: modes that one core plays in real time.
# Debian: csound. Prints `WHAT VALUE LABEL` a line; exit status 77 where it is missing.
command -v csound >/dev/null || { echo "csound: not installed" >&2; exit 77; }
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
# the score's length is twice measured, so that the start is not counted
song() {
    cat <<CSD
<CsoundSynthesizer>
<CsOptions>
-n -d -m0
</CsOptions>
<CsInstruments>
sr = 48000
ksmps = 64
nchnls = 1
0dbfs = 1
instr 1
aimp mpulse 1, 0.25
asig mode aimp, 100 + 5 * p4, 3000
out asig
endin
</CsInstruments>
<CsScore>
{200 MODE
i 1 0 $1 \$MODE.
}
e
</CsScore>
</CsoundSynthesizer>
CSD
}
processor_time() { # of the best of three runs (s)
    song "$1" >"$work/bank.csd"
    for _ in 1 2 3; do
        bash -c 'TIMEFORMAT=%U; time csound "$1" >/dev/null 2>&1' - "$work/bank.csd" 2>&1
    done | sort -n | head -n 1
}
processor_time 1 >"$work/1" && processor_time 5 >"$work/5"
paste "$work/1" "$work/5" | awk '$2 > $1 { printf "modes_per_core %.0f Csound mode, 200 modes\n", 200 * 4 / ($2 - $1) }'
