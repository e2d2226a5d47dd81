#!/usr/bin/env bash
# Plays the patches without a window, as fast as Pd can compute: each must open and play without a
# word of complaint, strike its drums and be heard. A patch with [lib/ear] in it takes the message
# `himc-try FILE SECONDS`, plays by itself for so long, prints its strikes and writes what was heard.
# Prints Unity's lines and summary, for tests/run.sh. HIMC_BUILD is where the build is (build).
cd "$(dirname "$0")" || exit 1
root=$(cd ../.. && pwd)
build=$(cd "$root" && cd "${HIMC_BUILD:-build}" && pwd) || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tests=0 failures=0

play_pd() { # play_pd PATCH [OPTION...]: what Pd says goes to $work/log
    local patch=$1
    shift
    timeout "${TEST_TIMEOUT:-600}" "${PD:-pd}" -nogui -nrt -stderr -noprefs -noaudio -nomidi -r 48000 -batch \
        -path "${HIMC_EXTERNALS:-$build/externals}/himc" "$@" -open "$patch" >"$work/log" 2>&1 </dev/null
}

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_patches.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}"
}

complaint() { # the first line on the console, but for those that the patch prints for this test
    grep -v -m1 -e '^strike: ' -e 'biggest amplitude' -e '^himc~ [0-9.]*$' -e 'too little time for' -e '^ *$' "$work/log"
}

few_strikes() { # few_strikes LEAST DRUM...: says so if there are fewer, or none on one of these drums
    local least=$1 count
    shift
    count=$(grep -c '^strike: ' "$work/log")
    [ "$count" -ge "$least" ] || echo -n "$count strikes, not $least. "
    for drum in "$@"; do
        grep -q "^strike: [^ ]* [a-z]* $drum " "$work/log" || echo -n "none on $drum. "
    done
}

too_soft() { # how loud the file is, if that is silence or more than a loudspeaker takes
    sed -n 's/.*biggest amplitude = //p' "$work/log" |
        awk '{ n++; peak = $1 } END { if (n != 1 || peak < 0.02 || peak > 1) print "peak " peak + 0 }'
}

# patch, seconds, least number of strikes, drums that must have been struck
while read -r patch seconds least drums; do
    name=$(basename "$patch" | tr -c 'a-z0-9\n' _)
    play_pd "$root/patches/$patch.pd" -send "himc-try $work/$name.wav $seconds"
    report "${name}_plays_without_a_complaint" "$(complaint)"
    report "${name}_strikes_its_drums" "$(few_strikes $least $drums)"
    report "${name}_is_heard" "$(too_soft)"
done <<'LIST'
00-start-here 4 20 start
02-message-box-score 12 42 kettle
03-live-hits 6 12 kettle
04-follow-the-mouse 6 10 kettle
05-four-timpani 8 12 low second third high
06-duo 5 24 left-kettle right-kettle
08-midi-file 10 10 low third
09-rolls-and-grace-notes 9 40 kettle
10-two-at-one-drum 4 8 kettle
11-a-kit 6 20 kick hats snare
12-marimba 6 8 marimba
13-time-and-notes 8 12 low second third high
pieces/tide 14 7 low second third
LIST

# those that are not played here: opened, and the sound switched on
for patch in "$root"/patches/0[17]*.pd "$root"/patches/performance.pd "$root"/patches/techniques/technique~-help.pd "$root"/pd-externals/*-help.pd; do
    play_pd "$patch" -path "$root/patches/techniques" -path "$build/clips" -open quit.pd
    report "$(basename "$patch" .pd | tr -c 'a-z0-9\n' _)_opens_without_a_line_on_the_console" "$(complaint)"
done

play_pd target-signals.pd
report signals_lead_a_stick_that_strikes "$(grep -q '^himc: strike [^ ]* left kettle' "$work/log" || echo "no strike")"
report a_signal_that_is_not_a_number_is_said_once \
    "$([ "$(grep -c 'a target signal is not a finite number' "$work/log")" = 1 ] || echo "$(grep -c 'finite' "$work/log") times")"
report stick_without_signals_is_left_where_it_is "$(grep -m1 -e 'out of reach' -e 'strike [^ ]* right' "$work/log")"

play_pd press-signals.pd
report signals_below_the_head_press_the_stick_on_it_once \
    "$([ "$(grep -c '^himc: strike [^ ]* left kettle' "$work/log")" = 1 ] || grep -c 'strike' "$work/log")"

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
