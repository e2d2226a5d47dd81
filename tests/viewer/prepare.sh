# Sourced by the tests of the page: builds the sender and renders the motion it sends, or prints an
# ignored test and ends where the browser is missing.
: "${HIMC_BUILD:=build}" "${CC:=gcc}"
export HIMC_BUILD
HIMC_MADE=$HIMC_BUILD/tests/viewer/$(basename "$0" .sh) # of its own: such tests run side by side
export HIMC_MADE
dir=$HIMC_MADE
for need in python3 chromedriver; do
    if [ ! -x "$HIMC_BUILD/bin/himc-viewer" ] || ! command -v $need >/dev/null; then
        echo "$0:0:$(basename "$0" .sh):IGNORE: needs what tools/build/deps-viewer.txt and tools/build/deps-browser.txt list"
        echo "1 Tests 0 Failures 1 Ignored"
        exit 0
    fi
done
mkdir -p "$dir"
for program in sender perform; do
    "$CC" -std=c17 -O2 -Wall -Wextra -Wpedantic -Ilib tests/viewer/$program.c "$HIMC_BUILD/libhimc.a" \
        -Wl,--as-needed -lode -lexpat -lz -llo -lstdc++ -lpthread -lm -o "$dir/$program" || exit 1
done
"$HIMC_BUILD/bin/himc" render patches/improvisation.txt -o "$dir/play.wav" \
    --motion "$dir/motion.csv" --strokes "$dir/strokes.csv" --scene "$dir/play.himc" >/dev/null 2>&1 &&
    for piece in four seated pedal standing; do
        "$HIMC_BUILD/bin/himc" render tests/viewer/$piece.txt -o "$dir/$piece.wav" --scene "$dir/$piece.himc" \
            >/dev/null 2>&1 || exit 1
    done || exit 1
