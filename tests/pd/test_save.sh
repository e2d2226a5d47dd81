#!/usr/bin/env bash
# The state in the patch: set, saved, opened again under another name and in another folder, cut and
# brought back by undo, copied. What `dump` writes is compared byte by byte, the sound bit by bit.
# Prints Unity's lines and summary, for tests/run.sh. HIMC_BUILD is where the build is (build).
cd "$(dirname "$0")/../.." || exit 1
build=$(cd "${HIMC_BUILD:-build}" && pwd) || exit 1
externals=${HIMC_EXTERNALS:-$build/externals}/himc
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/one" "$work/two"
cp tests/pd/save.pd "$work/one"
tests=0 failures=0

play_pd() { # play_pd PATCH MESSAGES: what Pd says goes to $work/log
    timeout "${TEST_TIMEOUT:-120}" "${PD:-pd}" -nogui -nrt -stderr -noprefs -noaudio -nomidi -r 48000 -batch -path "$externals" \
        -open "$work/$1" -send "$2" >"$work/log" 2>&1 </dev/null
}

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_save.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}"
}

complaint() { # the first line that is one
    grep -m1 -e '^error' -e 'consistency' -e 'no method' "$work/log"
}

# differs FILE...: those of folder two that are not as in folder one, of the performer without the drums' lines
differs() {
    for name; do
        cmp <(sed -E '/^([0-9]+-kettle|low|drum) /d; s/[0-9]+-kettle//' "$work/one/$name") \
            <(sed -E '/^([0-9]+-kettle|low|drum) /d; s/[0-9]+-kettle//' "$work/two/$name") 2>&1
    done
}

dumps='; to-drum dump drum.txt; to-himc dump himc.txt'

# numbers that Pd would write with six digits; strokes for a drum whose name depends on $0
play_pd one/save.pd "to-drum tune 121.7, mallet wood, decay 1.3, noise 0.371234567, place 0.61234567 0 0.85
    ; to-himc human 0.37 3, tempo 97.3456789, stroke 0.3 left accent f rim low, stroke 0.7 right legato 0.3333333,
    at 1.2 low damp 0.5, roll 1.1 0.5 press pp ff center, at 0.4 low tune C3, at 1.2 low damp 0.2, latency 83.14159, grip french servo
    ; pd-save.pd savetofile saved.pd $work/one 0 $dumps; record bang"
cp "$work/one/saved.pd" "$work/two"
report a_patch_is_saved_without_a_complaint "$(complaint)"
play_pd two/saved.pd "${dumps#; }; record bang"
report a_saved_patch_opens_without_a_complaint "$(complaint)"
report a_saved_patch_has_the_same_state "$(differs drum.txt himc.txt)"
report a_saved_patch_sounds_the_same_bit_by_bit \
    "$([ "$(tr -d '\0' <"$work/one/sound.wav" | wc -c)" -gt 100000 ] || echo silence; cmp "$work/one/sound.wav" "$work/two/sound.wav" 2>&1)"

# everything is cut and comes back; then copies of the two objects
rm "$work"/two/*.txt
play_pd two/saved.pd "pd-saved.pd vis 1; pd-saved.pd editmode 1; pd-saved.pd selectall; pd-saved.pd cut; pd-saved.pd undo
    $dumps; pd quit"
report undo_brings_the_state_back "$(complaint; differs drum.txt himc.txt)"
rm "$work"/two/*.txt
play_pd two/saved.pd "pd-saved.pd vis 1; pd-saved.pd editmode 1; pd-saved.pd selectall; pd-saved.pd copy; pd-saved.pd selectall
    ; pd-saved.pd cut; pd-saved.pd selectall; pd-saved.pd cut; pd-saved.pd paste; pd-saved.pd savetofile copy.pd $work/two 0; pd quit"
report a_copy_has_the_state "$([ "$(grep -c '^#A state' "$work/two/copy.pd")" = 2 ] || echo 'not two states'
    cmp <(tr '\n' ' ' <"$work/two/saved.pd" | grep -o '#A state [^#]*') <(tr '\n' ' ' <"$work/two/copy.pd" | grep -o '#A state [^#]*') 2>&1)"

# a file beside the patch, which moves with it; `save 0` keeps nothing
printf 'drum kettle;\nrecord %s/one/take.c3d;\nstroke 0.5 right legato f;\nstroke 1 left legato f;\nplay;\n' "$work" >"$work/score.txt"
"$build/bin/himc" render "$work/score.txt" -o "$work/short.wav" >"$work/log" 2>&1
play_pd one/save.pd "to-himc take take.c3d; pd-save.pd savetofile taken.pd $work/one 0; pd quit"
report a_file_beside_the_patch_is_saved_without_its_folder \
    "$(grep -q '^take ./take.c3d' <(tr '\n' ' ' <"$work/one/taken.pd" | grep -o 'take [^ ]*') || grep -o 'take [^ ]*' "$work/one/taken.pd")"
mv "$work/one/taken.pd" "$work/one/take.c3d" "$work/two"
play_pd two/taken.pd "to-himc dump himc.txt; pd quit"
report a_patch_that_has_moved_finds_its_file \
    "$(complaint; grep -qx "take $work/two/take.c3d;" "$work/two/himc.txt" || grep take "$work/two/himc.txt")"
play_pd two/saved.pd "to-himc save 0; to-drum save 0, save 3; pd-saved.pd savetofile bare.pd $work/two 0; pd quit"
report save_0_keeps_nothing "$(grep -m1 -e '^#A' "$work/two/bare.pd")"
report save_takes_a_switch "$(grep -qx 'error: membrane~: [0-9]*-kettle: save: SWITCH: 3, expected 0 .. 1, whole' "$work/log" || tail -n 2 "$work/log")"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
