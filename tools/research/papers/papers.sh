#!/bin/sh
# papers.sh: one row of Markdown for each figure, table and claim of the three papers: the value there, the value here, the
# verdict, the command that remakes it. From the repository's root, after make:
#   tools/research/papers/papers.sh [FOLDER [KEPT]]
# PHASES are the times (ms) at which a fourth stroke is played, ten if none are given; fewer change digits of two rows.
# FOLDER has the tables of `make trials` (docs/figures). All else is measured here: three scores are played, the library is asked
# (measure.c, its rows of commands). A verdict follows from these numbers (papers.awk), or is "stated". In KEPT all tables are left.
set -eu
himc=${HIMC_BUILD:-build}/bin/himc
tables=${1:-docs/figures}
work=$(mktemp -d "${HIMC_BUILD:-build}/papers.XXXXXX")
trap 'rm -rf "$work"' EXIT

"$himc" render tools/research/figures/blows.txt --channels 1 -o "$work/blows.wav" --strokes "$work/blows.csv" --motion "$work/blows-motion.csv" \
    --columns tips --quiet >/dev/null
"$himc" render tools/research/figures/blows.txt -o /dev/null --motion "$work/blows-ode.csv" --columns tips --set 'engine ode' --quiet >/dev/null
"$himc" render tools/research/figures/blows.txt --channels 1 -o "$work/one-way.wav" --strokes "$work/one-way.csv" --set 'coupling one-way' \
    --quiet >/dev/null
for coupling in two-way one-way; do
    "$himc" render tools/research/figures/equal-blows.txt -o /dev/null --strokes "$work/equal-$coupling.csv" --set "coupling $coupling" --quiet >/dev/null
done
"$himc" render tools/research/figures/legato-accent.txt -o /dev/null --strokes "$work/beats.csv" --motion "$work/motion.csv" \
    --columns tips,joints --quiet >/dev/null
"$himc" render patches/improvisation.txt -o /dev/null --motion "$work/improvisation.csv" --columns energy,work --quiet |
    sed 's/.*"strokes": \([0-9]*\), "played": \([0-9]*\), "missed": \([0-9]*\).*/strokes,played,missed\n\1,\2,\3/' >"$work/played.csv"
"${HIMC_BUILD:-build}/tools/research/papers/measure" facts >"$work/facts.csv"
head -n 1 "$work/motion.csv" | tr ',' '\n' | awk '/_x_rad$/ { joints++ } /_rad$/ { freedoms++ }
    END { print "joints,freedoms"; print joints "," freedoms }' >"$work/body.csv"
"$himc" modes tools/research/figures/blows.txt >"$work/modes.csv"
# loud NAME: RMS of the sound of NAME.wav in the half second after each stroke of NAME.csv, or up to the next one
loud() {
    echo rms
    tail -n +2 "$work/$1.csv" | cut -d , -f 1 >"$work/times"
    od -An -v -t f4 -w4 -j 80 "$work/$1.wav" | awk -v rate=48000 '
        NR == FNR { at[++count] = int($1 * rate); next }
        { now = FNR - 1; while (first < count && now >= at[first + 1]) first++
          if (first && now < at[first] + rate / 2) sum[first] += $1 * $1 }
        END { for (i = 1; i <= count; i++) { n = rate / 2; if (i < count && at[i + 1] - at[i] < n) n = at[i + 1] - at[i]; print sqrt(sum[i] / n) } }' "$work/times" -
}
# phases COMMAND: the same of blows.txt, root mean square over those times of the fourth stroke within a period of the principal mode
# (7 ms): the head that still rings meets it at another phase each time
times=${PHASES:-0 0.7 1.4 2.1 2.8 3.5 4.2 4.9 5.6 6.3}
phases() {
    for ms in $times; do
        awk -v ms=$ms '$1 == "stroke" && $2 == 5.4 { $2 += ms / 1000 } 1' tools/research/figures/blows.txt >"$work/phase.txt"
        "$himc" render "$work/phase.txt" --channels 1 -o "$work/phase.wav" --strokes "$work/phase.csv" --set "$1" --quiet >/dev/null
        loud phase
    done | awk '/rms/ { i = 0; rows++; next } { i++; sum[i] += $1 * $1; if (i > n) n = i } END { print "rms"; for (i = 1; i <= n; i++) print sqrt(sum[i] / rows) }'
}
phases 'coupling two-way' >"$work/loud.csv"
phases 'coupling one-way' >"$work/loud-one-way.csv"
# words of a command's grammar: WORDS,row
sed -n 's/.*HIMC_[A-Z]*_ROW([A-Z_]*, *\([a-z]*\), [^"]*, "\([^"]*\)".*/\1,\2/p' lib/himc/command_rows.h |
    sed '1i name,grammar' >"$work/commands.csv"
# the first and the last row of the improvisation: what is between balances too if these do
sed -i -n '1p; 2p; $p' "$work/improvisation.csv"
cp "$tables"/*.csv "$work"
[ -z "${2-}" ] || cp "$work"/*.csv "$2"
awk -f tools/research/papers/papers.awk "$work"/*.csv
