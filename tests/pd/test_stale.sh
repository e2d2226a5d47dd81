#!/bin/sh
# [himc~] and [membrane~] are two binaries that share structs of the library. One of them built from sources with a changed struct:
# they refuse each other in one line, the strokes are silent, nothing crashes.
. tests/support/check.sh
root=$(pwd)
build=$root/${HIMC_BUILD:-build}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

play() { # play FOLDER: with the externals there
    timeout "${TEST_TIMEOUT:-600}" pd -nogui -nrt -stderr -noprefs -noaudio -nomidi -r 48000 -batch -path "$1" -open tests/pd/stale.pd \
        >"$work/log" 2>&1 </dev/null
}

# the same library but for one more field in front of a drum's others: made anew is what has that struct
mkdir -p "$work/sources/build" "$work/mixed"
cp -pr Makefile lib pd-externals tools mocap patches "$work/sources"
cp -pr "$build/lib" "$work/sources/build"
sed -i 's/^struct himc_drum {$/&\n    long changed;/' "$work/sources/lib/src/drum/drum_state.h"
check test_the_struct_is_changed grep -q '    long changed;' "$work/sources/lib/src/drum/drum_state.h"
MAKEFLAGS='' make -C "$work/sources" -j2 BUILD=build build/externals/himc/membrane~.pd_linux >"$work/log" 2>&1
check test_the_other_build_succeeds [ -f "$work/sources/build/externals/himc/membrane~.pd_linux" ]
cp "$build/externals/himc/himc~.pd_linux" "$work/sources/build/externals/himc/membrane~.pd_linux" "$work/mixed"

play "$build/externals/himc"
check test_one_build_plays [ $? = 0 ]
check test_one_build_strikes_the_drum grep -q '^himc: strike' "$work/log"
check test_one_build_has_no_error [ "$(grep -c 'another build' "$work/log")" = 0 ]
play "$work/mixed"
check test_two_builds_end_without_a_crash [ $? = 0 ]
check test_two_builds_refuse_each_other_in_one_line [ "$(grep -c 'himc~: \[membrane~ kettle\] is of another build (.*), expected both from one build: its strokes are silent' "$work/log")" = 1 ]
check test_two_builds_play_on_a_silent_drum grep -q '^himc: strike' "$work/log"

[ $failures = 0 ] || tail -n 5 "$work/log"
finish
