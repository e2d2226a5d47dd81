#!/usr/bin/env bash
# How loud the pieces are (make levels): -23 +-2 LUFS as broadcasters want, true peaks below full
# scale, all by one gain for all drums. The numbers are libebur128's; build/tools/sound/loudness prints
# them. HIMC_BUILD is where the build is (build).
cd "$(dirname "$0")/../.." || exit 1
root=$PWD
build=$(cd "${HIMC_BUILD:-build}" && pwd) || exit 1
loudness=$build/tools/sound/loudness
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
        'BEGIN { if (!(x >= low && x <= high)) print x " " unit ", allowed " low " .. " high }'
}

piece() { # piece NAME: the sound in $work/NAME.wav
    local lufs range peak
    read -r lufs range peak <<<"$("$loudness" "$work/$1.wav")"
    echo "$1: $lufs LUFS, range $range LU, true peak $peak dBTP"
    report "${1}_is_as_loud_as_broadcasters_want" "$(outside "${lufs:-none}" -25 -21 LUFS)"
    report "${1}_has_room_below_full_scale" "$(outside "${peak:-none}" -60 -1 dBTP)"
}

in_pd() { # in_pd PATCH SECONDS: what a patch with [lib/ear] in it plays by itself
    (cd tests/pd && timeout "${TEST_TIMEOUT:-900}" pd -nogui -nrt -stderr -noprefs -noaudio -nomidi -r 48000 -batch \
        -path "$build/externals/himc" -open "$root/patches/$1.pd" \
        -send "himc-try $work/$(basename "$1").wav $2" >"$work/log" 2>&1 </dev/null)
}

# the meter itself: EBU Tech 3341 asks for -23.0 +-0.1 LUFS from a sine of -23 dB in two channels
sox -n -r 48000 -b 32 -e float -c 2 "$work/sine.wav" synth 20 sine 997 gain -23
report a_sine_of_minus_23_db_in_both_channels_measures_minus_23_lufs \
    "$(outside "$("$loudness" "$work/sine.wav" | cut -d' ' -f1)" -23.1 -22.9 LUFS)"

"$build/bin/himc" render patches/improvisation.txt -o "$work/improvisation.wav" >"$work/log" 2>&1
piece improvisation
in_pd pieces/tide 132
piece tide
in_pd 05-four-timpani 14
piece 05-four-timpani

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
