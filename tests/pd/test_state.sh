#!/usr/bin/env bash
# dump and preset in Pure Data: a drum and a performer write their state beside the patch, are changed,
# and take it back.
cd "$(dirname "$0")/../.." || exit 1
build=$(cd "${HIMC_BUILD:-build}" && pwd) || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp tests/pd/state.pd "$work"
timeout "${TEST_TIMEOUT:-60}" pd -nogui -nosound -stderr -path "$build/externals/himc" \
    "$work/state.pd" >"$work/out" 2>&1 </dev/null
tests=0 failures=0

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_state.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}"
}

missing() { # missing LINE...: those that are not in the output
    for line; do grep -qxF -- "$line" "$work/out" || echo -n "no line '$line'; "; done
}

report a_drum_takes_its_preset_back \
    "$(missing 'drum: dump mallet wood' "drum: dump decay 5.31366 0" &&
        grep -q '^tension [0-9.]*;$' "$work/state-timpano.txt" || echo 'no tension in the file')"
report a_performer_takes_its_preset_back \
    "$(missing 'himc: dump human 0.37 3' 'himc: dump stroke 0.3 left accent f rim')"
report a_preset_is_a_name_without_a_folder \
    "$(missing 'error: membrane~: kettle: preset: a/b, expected a name, without a folder')"
report a_dumped_piece_is_a_score_that_plays \
    "$("$build/bin/himc" render "$work/state-piece.txt" -o "$work/piece.wav" 2>&1 |
        grep -q '"strokes": *1' || echo 'it has not one stroke')"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
