#!/bin/sh
# papers.sh: one row of Markdown for each figure, table and claim of the three papers: the value there, the value here, the
# verdict, the command that remakes it. From the repository's root, after make:
#   tools/papers/papers.sh [FOLDER]
# FOLDER has the tables of the trials (docs/figures). Two pieces of five and 22 strokes are played; all else is read from these
# tables, from docs/evaluation.md and from the library's rows of commands. Verdicts follow from the numbers (papers.awk).
set -eu
himc=${HIMC_BUILD:-build}/bin/himc
tables=${1:-docs/figures}
work=$(mktemp -d "${HIMC_BUILD:-build}/papers.XXXXXX")
trap 'rm -rf "$work"' EXIT

"$himc" render tools/figures/blows.txt --channels 1 -o "$work/blows.wav" --strokes "$work/blows.csv" --quiet >/dev/null
"$himc" render tools/figures/legato-accent.txt -o /dev/null --strokes "$work/beats.csv" --motion "$work/motion.csv" \
    --columns tips,joints --quiet >/dev/null
head -n 1 "$work/motion.csv" | tr ',' '\n' | awk '/_x_rad$/ { joints++ } /_rad$/ { freedoms++ }
    END { print "joints,freedoms"; print joints "," freedoms }' >"$work/body.csv"
"$himc" modes tools/figures/blows.txt >"$work/modes.csv"
# RMS of the sound in the half second after each stroke, or up to the next one
{
    echo rms
    tail -n +2 "$work/blows.csv" | cut -d , -f 1 >"$work/times"
    od -An -v -t f4 -w4 -j 80 "$work/blows.wav" | awk -v rate=48000 '
        NR == FNR { at[++count] = int($1 * rate); next }
        { now = FNR - 1; while (first < count && now >= at[first + 1]) first++
          if (first && now < at[first] + rate / 2) sum[first] += $1 * $1 }
        END { for (i = 1; i <= count; i++) { n = rate / 2; if (i < count && at[i + 1] - at[i] < n) n = at[i + 1] - at[i]; print sqrt(sum[i] / n) } }' "$work/times" -
} >"$work/loud.csv"
# words of a command's grammar: WORDS,row
sed -n 's/.*HIMC_COMMAND_ROW([A-Z_]*, *\([a-z]*\), [^"]*, "\([^"]*\)".*/\1,\2/p' lib/himc/command_rows.h |
    sed '1i name,grammar' >"$work/commands.csv"
# the undisturbed database: law,nuance,...
sed -n 's/^| \(\(computed-torque\|feedforward\) | .*\) |$/\1/p' docs/evaluation.md |
    sed 's/ | /,/g; 1i law,nuance,outside,all,elbow,angles_a,angles_b,angles_c,landed' >"$work/database.csv"

awk -f tools/papers/papers.awk "$tables"/strokes.csv "$tables"/strokes-default.csv "$tables"/phases.csv "$tables"/evaluation.csv \
    "$tables"/spread.csv "$tables"/claim.csv "$tables"/measures.csv "$work"/*.csv
