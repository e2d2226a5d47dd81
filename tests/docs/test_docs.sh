#!/bin/sh
# Links of the documentation lead somewhere; docs/results/papers.md has a row for each figure, table, algorithm and equation of the papers,
# its verdicts are those of today's program and follow from numbers, and the commands in it are there; the trials' tables are of today's program. With HIMC_LONG they run, and the numbers are compared.
. tests/support/check.sh
: "${HIMC_BUILD:=build}"
work=$(mktemp -d "$HIMC_BUILD/docs.XXXXXX")
trap 'rm -rf "$work"' EXIT

# FILE:TARGET of each link
find . -name build -prune -o -name '*.md' -print | sort | while read -r file; do
    sed '/^```/,/^```/d' "$file" | grep -oE '\]\([^) ]+\)' | sed "s|^](|$file:|; s|)\$||"
done | grep -vE ':(https?|mailto):' >"$work/links"
# the anchors of a file, as GitHub makes them from headings
anchors() {
    sed -n 's/^##* //p' "$1" | tr '[:upper:]' '[:lower:]' | sed 's/[^a-z0-9 _-]//g; s/ /-/g'
}
while IFS=: read -r file target; do
    path=${target%%#*}
    [ -n "$path" ] && path=$(dirname "$file")/$path || path=$file
    [ -e "$path" ] || echo "$file: $target"
    case $target in *'#'*) anchors "$path" | grep -qx -- "${target#*#}" || echo "$file: no heading $target" ;; esac
done <"$work/links" >"$work/lost"
check test_links_of_the_documentation_resolve [ "$(wc -l <"$work/links" | awk '{print ($1 > 50)}')$(cat "$work/lost")" = 1 ]

# one NAME NUMBER a line; a 2012 figure with parts has a row for each or for all
numbers() {
    for i in 1 2 3; do echo "CASA figure $i"; done
    for i in 1 2 3 4 5 6; do echo "preprint figure $i"; done
    for i in 1 2 3 4 5a 5b 5c 5d 5e 5f 6a 6b 7 8; do echo "2012 figure $i"; done
    for i in 1 2; do printf 'CASA equation %d\npreprint equation %d\n2012 table %d\n2012 algorithm %d\n' $i $i $i $i; done
    for i in 1 2 3 4 5 6; do echo "2012 equation $i"; done
}
# places name a paper once for several equations: "CASA figure 1, equation 1" or "2012 equations 2 and 3"
sed -n 's/^| \([^|]*\) | .*/\1/p' docs/results/papers.md | sed 's/; /\n/g' |
    sed 's/^\([^ ]*\) \(.*\), equation/\1 \2\n\1 equation/; s/^\([^ ]*\) equations \([0-9]\) and /\1 equation \2\n\1 equation /' |
    sed 's/, CASA/\nCASA/; s/, preprint/\npreprint/; s/, 2012/\n2012/' >"$work/places"
numbers | while read -r number; do
    grep -q "^$number\([ ,]\|$\)" "$work/places" || echo "$number"
done >"$work/missing"
check test_each_figure_table_and_equation_of_the_papers_has_a_row [ "$(cat "$work/missing")" = "" ]

mkdir "$work/kept"
phases="0 3.5" # of ten
[ -z "${HIMC_LONG-}" ] || phases=
PHASES=$phases tools/research/papers/papers.sh docs/figures "$work/kept" >"$work/table"
sed -n '/^| place |/,$p' docs/results/papers.md >"$work/documented"
verdicts() {
    awk -F ' [|] ' '{ print $1, $(NF - 1), $NF }' "$1"
}
verdicts "$work/table" >"$work/verdicts"
check test_verdicts_of_the_papers_are_those_of_today [ "$(verdicts "$work/documented" | diff - "$work/verdicts")" = "" ]
sed -i 100q "$work/kept/motion.csv" # what follows spoils its numbers anyway
# A verdict that no measured number moves is typed in. All numbers but those that name a row become others, in four ways, or larger by a
# factor; a verdict that is the same each time must say so.
for way in 1 2 3 4 "5 1.4" "6 2"; do
    scale=${way#? }
    way=${way%% *}
    [ "$way" -gt 4 ] || scale=0
    mkdir "$work/$way"
    for table in "$work"/kept/*.csv; do
        awk -F , -v OFS=, -v way=$way -v scale=$scale 'FNR == 1 { for (i = 1; i <= NF; i++) key[i] = $i ~ /^(time_s|gain|nuance|controller|law|limits|strokes_per_s|error_percent|m|n|name|hand|drum)$/ }
            FNR > 1 { for (i = 1; i <= NF; i++) if (!key[i]) { gsub(/[|]/, "/", $i)
                if ($i ~ /^[-+.0-9]/) $i = scale ? scale * $i : (way % 2 ? 1 : -1) * (1 + (FNR * 7919 + i * 104729 + way * 31337) % 997 / 37) } }
            { print }' "$table" >"$work/$way/$(basename "$table")"
    done
    awk -f tools/research/papers/papers.awk "$work/$way"/*.csv >"$work/spoilt-$way"
    verdicts "$work/spoilt-$way" | sed 1,2d
done | cat - "$work/verdicts" | sort | uniq -c | awk '$1 >= 7' >"$work/still"
check test_no_verdict_is_typed_in_or_it_says_stated [ "$(wc -l <"$work/still" | awk '{print ($1 > 0)}')$(grep -v 'stated: ' "$work/still")" = 1 ]
# deviation TRIALS PLAYER DEFAULT OTHER: the row's verdict if HIMC's deviation is so many times that of ID by the printed law with the
# player's and the default servos, and by the other laws
deviation() {
    mkdir -p "$work/deviation"
    cp "$work"/kept/*.csv "$work/deviation"
    awk -F , -v OFS=, -v trials="$1" -v player="$2" -v default="$3" -v other="$4" 'FNR > 1 { $5 = trials; $7 = $8 = $3 == "id" ? 1 : $4 != "printed" ? other : $1 == 1 ? player : default } { print }' \
        "$work/kept/spread.csv" >"$work/deviation/spread.csv"
    awk -f tools/research/papers/papers.awk "$work"/deviation/*.csv | awk -F ' [|] ' '/figure 6b, deviation/ { print $4 }'
}
check test_a_deviation_of_few_trials_is_not_measured [ "$(deviation 17 .5 .5 .5)$(deviation 100 nan .5 .5)" = "stated: not measuredstated: not measured" ]
check test_a_smaller_deviation_by_the_papers_law_agrees [ "$(deviation 18 .5 .5 2)" = agrees ]
check test_a_deviation_says_by_which_servos_and_laws_it_is_smaller [ "$(deviation 100 2 .5 .5)$(deviation 100 2 2 .5)" = \
    "of trials of one sequence, not by the player's servos (0 of 5)of trials of one sequence, by laws of ours; by theirs in 0 of 10" ]
check test_a_larger_deviation_does_not_agree [ "$(deviation 100 2 2 2)" = "does not agree" ]
check test_nothing_agrees_without_a_number [ "$(awk -F ' [|] ' '$4 == "agrees" && $3 !~ /[0-9]/' "$work/documented")" = "" ]

# trials are played again as the tables of `make trials` have them: of each nuance one, of all with HIMC_LONG; a number that differs
# by more than another C library makes (5e-4, tools/himc/evaluate_log.c) says that the tables are older than the program
again="legato,himc,computed-torque tenuto,id,computed-torque accent,himc,feedforward vertical-accent,id,printed staccato,ik"
[ -z "${HIMC_LONG-}" ] || again=all
for only in $again; do
    [ "$only" = all ] && only= || only="--only $only"
    "$HIMC_BUILD/bin/himc" evaluate --trials 1 $only --log "$work/log.csv" --csv /dev/null --quiet
done
awk -F , 'NR == FNR { for (i = 5; i <= NF; i++) old[$1, $2, $3, i] = $i; next }
    FNR > 1 { for (i = 5; i <= NF; i++) if ((d = old[$1, $2, $3, i] - $i) * d > 2.5e-7 * $i * $i) { print; next } }' docs/figures/first.csv "$work/log.csv" >"$work/moved"
check test_tables_of_the_trials_are_of_this_program [ "$(wc -l <"$work/log.csv" | awk '{print ($1 > 5)}')$(cat "$work/moved")" = 1 ]
awk -f tools/research/papers/evaluation.awk docs/figures/spread.csv docs/figures/database.csv docs/results/evaluation.md >"$work/evaluation.md"
check test_the_evaluation_page_has_the_numbers_of_the_trials cmp docs/results/evaluation.md "$work/evaluation.md"
check test_tables_of_the_trials_name_their_commit grep -qE '^commit [0-9a-f]{40}, [-0-9]{10}, trials: gain 1 [0-9]+, gain 3 [0-9]+$' docs/figures/trials.txt

# exists COMMAND: it could be run
exists() {
    case $1 in
    make\ *) ! make -n ${1#make } 2>&1 | grep 'No rule to make' ;;
    himc\ help\ *) "$HIMC_BUILD/bin/himc" help "${1##* }" ;;
    himc\ *) "$HIMC_BUILD/bin/himc" "$(echo "$1" | cut -d ' ' -f 2)" --help ;;
    build/tools/*) ! make -n ${1%% *} 2>&1 | grep 'No rule to make' ;;
    build/*) [ -x "$HIMC_BUILD/${1#build/}" ] ;;
    *) [ -x "$1" ] ;;
    esac >"$work/said" 2>&1
}
sed -n 's/.* | `\(.*\)` |$/\1/p' "$work/documented" | sort -u >"$work/commands"
while read -r command; do
    exists "$command" || echo "$command"
done <"$work/commands" >"$work/absent"
check test_commands_of_the_papers_are_there [ "$(wc -l <"$work/commands" | awk '{print ($1 > 20)}')$(cat "$work/absent")" = 1 ]

if [ -n "${HIMC_LONG-}" ]; then
    if command -v doxygen >/dev/null; then
        check test_each_public_name_has_its_comment doxygen docs/Doxyfile
    fi
    check test_numbers_of_the_papers_are_those_of_today cmp "$work/documented" "$work/table"
    # the table of own captures, where these are
    mocap=${HIMC_SHARED:-../shared}/mocap
    if [ -d "$mocap" ]; then
        sed -n '/^## Your own captures/,$p' docs/results/evaluation.md | sed -n '/himc evaluate --take drum/,/--left-tip/p' | sed 's/.*himc //; s/\\$//' |
            (himc=$(cd "$HIMC_BUILD" && pwd)/bin/himc && cd "$mocap" && xargs "$himc") >"$work/own.csv" 2>"$work/said"
        awk -F , 'FNR > 1 && $3 != "feedforward" { n[$1]++; line[$1] = line[$1] sprintf(" | %.3g mm", $6); if (n[$1] == 5) print line[$1] " |" }' "$work/own.csv" >"$work/own"
        check test_the_table_of_own_captures_is_of_this_program [ "$(wc -l <"$work/own") $(grep -cF -f "$work/own" docs/results/evaluation.md)" = "3 3" ]
    fi
    # strokes and phases played again; what takes hours is read
    strokes=$HIMC_BUILD/tools/research/figures/strokes
    cp docs/figures/*.csv "$work"
    make "$strokes" >"$work/said" 2>&1
    "$strokes" follow printed 0.333333 2.2 5 >"$work/strokes.csv"
    "$strokes" follow computed-torque 1 2.2 5 >"$work/strokes-default.csv"
    "$strokes" phases printed 0.333333 2 4.6 >"$work/phases.csv"
    tools/research/papers/papers.sh "$work" >"$work/anew"
    verdicts "$work/anew" >"$work/verdicts-anew"
    check test_strokes_played_again_have_the_same_verdicts cmp "$work/verdicts" "$work/verdicts-anew"
    # figures need gnuplot, which make figures installs
    grep -v -e '^make build/trials' -e '^himc bench' -e '^tests/' "$work/commands" | while read -r command; do
        case $command in
        himc*) command="$HIMC_BUILD/bin/$(echo "$command" | sed 's|SCORE|tools/research/figures/blows.txt|')" ;;
        esac
        env -u HIMC_LONG $command >"$work/said" 2>&1 || echo "$command"
    done >"$work/failed"
    check test_commands_of_the_papers_run [ "$(cat "$work/failed")" = "" ]
fi

finish
