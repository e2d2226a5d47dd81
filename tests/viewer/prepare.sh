# Sourced by the tests of the page: builds the sender and renders the motion it sends, once for all of them, or prints
# an ignored test and ends where the browser is missing.
: "${HIMC_BUILD:=build}" "${CC:=gcc}"
export HIMC_BUILD
HIMC_MADE=$HIMC_BUILD/tests/viewer/$(basename "$0" .sh) # of its own: such tests run side by side
export HIMC_MADE
for need in python3 chromedriver; do
    if [ ! -x "$HIMC_BUILD/bin/himc-viewer" ] || ! command -v $need >/dev/null; then
        echo "$0:0:$(basename "$0" .sh):IGNORE: needs what tools/build/deps-viewer.txt and tools/build/deps-browser.txt list"
        echo "1 Tests 0 Failures 1 Ignored"
        exit 0
    fi
done
prepare() {
    for program in sender perform; do
        "$CC" -std=c17 -O2 -Wall -Wextra -Wpedantic -Ilib tests/viewer/$program.c "$HIMC_BUILD/libhimc.a" \
            -Wl,--as-needed -lode -lexpat -lz -llo -lstdc++ -lpthread -lm -o "$1/$program" || return 1
    done
    "$HIMC_BUILD/bin/himc" render patches/improvisation.txt -o "$1/play.wav" \
        --motion "$1/motion.csv" --strokes "$1/strokes.csv" --scene "$1/play.himc" >/dev/null 2>&1 || return 1
    for piece in four seated pedal standing; do
        "$HIMC_BUILD/bin/himc" render tests/viewer/$piece.txt -o "$1/$piece.wav" --scene "$1/$piece.himc" \
            >/dev/null 2>&1 || return 1
    done
    touch "$1/stamp"
}
made=$HIMC_BUILD/tests/viewer/made
mkdir -p "$made" "$HIMC_MADE"
(
    flock 9 # the first one prepares, the others wait for it
    if [ ! -e "$made/stamp" ] || [ -n "$(find "$HIMC_BUILD/bin/himc" patches/improvisation.txt tests/viewer/*.c tests/viewer/*.txt -newer "$made/stamp")" ]; then
        rm -f "$made"/*
        prepare "$made"
    fi
) 9>"$made.lock" && cp -p "$made"/* "$HIMC_MADE" || exit 1
