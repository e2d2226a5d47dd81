#!/bin/sh
# The viewer end to end: himc render's motion as OSC, the bridge, the page in a real Chromium.
# tests/viewer/page.py does the work; tests/viewer/sender.c plays the performer.
: "${HIMC_BUILD:=build}" "${CC:=gcc}"
export HIMC_BUILD
dir=$HIMC_BUILD/tests/viewer
for need in python3 chromedriver; do
    if [ ! -x "$HIMC_BUILD/bin/himc-viewer" ] || ! command -v $need >/dev/null; then
        echo "$0:0:test_viewer_page:IGNORE: needs what tools/deps-viewer.txt lists"
        echo "1 Tests 0 Failures 1 Ignored"
        exit 0
    fi
done
mkdir -p "$dir"
for program in sender skeleton_table; do
    "$CC" -std=c17 -O2 -Wall -Wextra -Wpedantic -Ilib tests/viewer/$program.c \
        "$HIMC_BUILD/libhimc.a" -Wl,--as-needed -lode -llo -lsndfile -llapacke -llapack -lblas \
        -lpthread -lm -o "$dir/$program" || exit 1
done
"$HIMC_BUILD/bin/himc" render patches/improvisation.txt -o "$dir/play.wav" \
    --motion "$dir/motion.csv" --strokes "$dir/strokes.csv" >/dev/null 2>&1 || exit 1
exec python3 tests/viewer/page.py
