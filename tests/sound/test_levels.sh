#!/usr/bin/env bash
# How loud the pieces are (make levels): -23 +-2 LUFS as broadcasters want, true peaks below full
# scale, all by one gain for all drums. The numbers are libebur128's; build/tools/research/sound/loudness prints
# them. HIMC_BUILD is where the build is (build).
cd "$(dirname "$0")/../.." || exit 1
build=$(cd "${HIMC_BUILD:-build}" && pwd) || exit 1
loudness=$build/tools/research/sound/loudness
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tests=0 failures=0

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/sound/test_levels.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}"
}

outside() { # outside VALUE LOW HIGH UNIT: says so
    awk -v x="$1" -v low="$2" -v high="$3" -v unit="$4" \
        'BEGIN { if (!(x >= low && x <= high)) print x " " unit ", expected " low " .. " high }'
}

piece() { # piece NAME: the sound in $work/NAME.wav
    local lufs range peak
    read -r lufs range peak _ <<<"$("$loudness" "$work/$1.wav")"
    echo "$1: $lufs LUFS, range $range LU, true peak $peak dBTP"
    report "${1}_is_as_loud_as_broadcasters_want" "$(outside "${lufs:-none}" -25 -21 LUFS)"
    report "${1}_has_room_below_full_scale" "$(outside "${peak:-none}" -60 -1 dBTP)"
}

render() { # render SCORE NAME: two ears
    "$build/bin/himc" render "$1" -o "$work/$2.wav" >"$work/log" 2>&1 || cat "$work/log"
}

score_of() { # score_of PATCH: its drums, its listener and its first piece
    awk '/^#X msg/ {
            text = $0
            sub(/^#X msg [0-9]+ [0-9]+ /, "", text)
            sub(/(, f [0-9]+)?;$/, "", text)
            lines = split(text, line, / \\, /)
        }
        /^#X obj .* membrane~ / {
            print "drum " $6 " " $7 + 0 ";"
            for (i = 1; i <= settings; i++) print $6 " " setting[i] ";"
        }
        /^#X msg .* place / { settings = split(text, setting, / \\, /) }
        /^#X msg .* listener / || (/^#X msg .* stroke 1 / && !played++) { for (i = 1; i <= lines; i++) print line[i] ";" }
        /^#X msg .* clear .* tempo / && !begun++ { for (i = 2; i <= lines; i++) print line[i] ";" }' "$1"
}

# the meter itself: EBU Tech 3341 asks for -23.0 +-0.1 LUFS from a sine of -23 dB in two channels
sox -n -r 48000 -b 32 -e float -c 2 "$work/sine.wav" synth 20 sine 997 gain -23
report a_sine_of_minus_23_db_in_both_channels_measures_minus_23_lufs \
    "$(outside "$("$loudness" "$work/sine.wav" | cut -d' ' -f1)" -23.1 -22.9 LUFS)"

render patches/improvisation.txt improvisation
piece improvisation
for name in tide kit grain stations; do
    render "patches/pieces/$name.txt" "$name"
    piece "$name"
done
score_of patches/05-four-timpani.pd >"$work/four.txt"
render "$work/four.txt" four_timpani
piece four_timpani

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
