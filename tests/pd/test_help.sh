#!/usr/bin/env bash
# The help patches have the whole vocabulary: each command that the manual's tables list for a
# performer stands in himc~-help.pd with its atoms, each for a drum in membrane~-help.pd, in a
# comment of the patch or of its subpatches; and what their boxes send is of the vocabulary.
# panel.awk reads the messages of a patch, panel_words.c asks the library's parser.
cd "$(dirname "$0")/../.." || exit 1
: "${HIMC_BUILD:=build}" "${CC:=gcc}"
dir=$HIMC_BUILD/tests/help
mkdir -p "$dir"
tests=0 failures=0

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_help.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}"
}

table() { # table HEADING: of the manual, one line `NAME ATOMS` a command
    awk -F ' [|] ' -v heading="### $1" '
        /^### / { inside = $0 == heading }
        inside && /^[|] `/ {
            gsub(/\\[|]/, "|")
            name = substr($1, 4, length($1) - 4)
            atoms = substr($0, length($1) + 4)
            sub(/ [|] [^|]* [|]$/, "", atoms)
            print name (atoms == "–" ? "" : " " atoms)
        }' docs/manual.md
}

comments() { # comments PATCH: one a line, however Pd has broken its lines
    tr '\n' ' ' <"$1" | awk -v RS=' ?; ?#|; $' '
        { sub(/^#/, "") }
        $1 == "X" && $2 == "text" { sub(/, f [0-9]+$/, ""); sub(/^X text [0-9]+ [0-9]+ /, ""); gsub(/ \\,/, ","); print }'
}

missing() { # missing HEADING PATCH: the commands of the one that the other has no comment for
    comments "$2" >"$dir/comments"
    table "$1" >"$dir/table"
    [ "$(wc -l <"$dir/table")" -gt 10 ] || echo "docs/manual.md has no table '$1' "
    grep -vxFf "$dir/comments" "$dir/table" | tr '\n' ';'
}

report help_of_the_performer_has_every_command "$(missing 'To the performer' pd-externals/himc~-help.pd)"
report help_of_the_drum_has_every_command "$(missing 'To a drum' pd-externals/membrane~-help.pd)"

"$CC" -std=c17 -O2 -Wall -Wextra -Ilib tests/pd/panel_words.c "$HIMC_BUILD/libhimc.a" -lm -o "$dir/words" || exit 1
for name in himc membrane; do
    # [membrane~] answers `info` itself, and both objects `save`
    awk -f tests/pd/panel.awk "pd-externals/$name~-help.pd" | grep -vxE 'drum info|drum head .*|performer pose .*|(drum|performer) save [01]' >"$dir/messages"
    report "every_message_of_the_help_of_${name}_is_of_the_vocabulary" \
        "$("$dir/words" <"$dir/messages" | sed '$d' | tr '\n' ';')$([ -s "$dir/messages" ] || echo "no messages")"
done

report boxes_of_the_help_patches_lie_beside_one_another "$(for patch in pd-externals/*-help.pd patches/techniques/*-help.pd patches/01*.pd; do
    awk -f tests/pd/overprint.awk "$patch"
done | tr '\n' ';')"
for patch in pd-externals/membrane~-help.pd patches/01*.pd; do
    report "$(basename "$patch" .pd | tr -c 'a-z0-9\n' _)_has_a_box_that_brings_the_ears_back" \
        "$(grep -qx '#X msg [0-9]* [0-9]* listener usual;' "$patch" || echo none)"
done

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
