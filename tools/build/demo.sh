#!/bin/sh
# Plays patches/01-improvisation.pd in Pure Data without its window and the same score by himc render,
# and draws the performance.
#   tools/build/demo.sh
# Run from the repository's root after make (make demo does both). Leaves improvisation.wav (Pd's
# sound), strokes.csv, motion.csv and improvisation.png in build/demo. Fails if Pd and himc render
# do not sound alike to the last bit.
set -eu
build=${HIMC_BUILD:-build}
out=$build/demo
himc=$build/bin/himc
externals=$build/externals/himc
patch=patches/01-improvisation.pd
score=patches/improvisation.txt
mkdir -p "$out"
work=$(mktemp -d "$out/work.XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

fail() {
    echo "make demo: $*" >&2
    exit 1
}

# offset of the samples in a WAV file (bytes)
samples_at() {
    head -c 4096 "$1" | LC_ALL=C grep -abo data | head -n 1 | awk -F: '{print $1 + 8}'
}

# sample rate of a WAV file (Hz)
rate_of() {
    od -An -t u4 -j 24 -N 4 "$1" | tr -d ' '
}

# seconds of sound in a WAV file of one channel of floats
length_of() {
    echo "$(wc -c <"$1") $(samples_at "$1") $(rate_of "$1")" | awk '{print ($1 - $2) / 4 / $3}'
}

# a number from the last line of himc render
number() {
    tail -n 1 "$work/render.log" | sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p"
}

seconds_since() {
    date +%s.%N | awk -v start="$1" '{print $1 - start}'
}

play_in_pd() {
    start=$(date +%s.%N)
    pd -nogui -nrt -noprefs -noaudio -nomidi -stderr -r 48000 -batch -path "$externals" -open "$patch" \
        -send "himc-record $(cd "$work" && pwd)/pd.wav" >"$work/pd.log" 2>&1 ||
        fail "Pd ended with status $?: $(tail -n 1 "$work/pd.log")"
    pd_time=$(seconds_since "$start")
    [ -s "$work/pd.wav" ] || fail "Pd wrote no sound: $(tail -n 1 "$work/pd.log")"
    mv "$work/pd.wav" "$out/improvisation.wav"
}

# Pd stops recording when the performer is at rest, himc render when the drum is; the common part
# must be equal
compare() {
    tail -c "+$(($(samples_at "$1") + 1))" "$1" >"$work/a"
    tail -c "+$(($(samples_at "$2") + 1))" "$2" >"$work/b"
    shorter=$({ wc -c <"$work/a"; wc -c <"$work/b"; } | sort -n | head -n 1)
    cmp -n "$shorter" "$work/a" "$work/b" >"$work/cmp.log" 2>&1
}

# time, least and greatest sample of each millisecond
envelope() {
    od -An -v -t f4 -w4 -j "$(samples_at "$1")" "$1" | awk -v rate="$(rate_of "$1")" '
        { if ($1 < low) low = $1; if ($1 > high) high = $1 }
        NR >= (bin + 1) * rate / 1000 {
            printf "%.4f,%g,%g\n", (bin + 0.5) / 1000, low, high
            bin++
            low = high = $1
        }'
}

# five strokes as in figure 8: three of rising force, then two of nearly equal force, the second
# after a rest; in a piece without such strokes, those around the loudest. Prints from, to (s) and
# the caption.
find_excerpt() {
    awk -F, '
        NR > 1 { t[++n] = $1; f[n] = $8 }
        END {
            best = 0.2
            for (i = 1; i + 4 <= n; i++) {
                if (f[i + 2] > f[top]) top = i + 2
                unlike = f[i + 4] > 0 ? f[i + 3] / f[i + 4] - 1 : 1
                if (unlike < 0) unlike = -unlike
                rising = f[i] < f[i + 1] && f[i + 1] < f[i + 2] && f[i + 3] < f[i + 2]
                rest = t[i + 4] - t[i + 3] > 2 * (t[i + 3] - t[i + 2])
                if (rising && rest && unlike < best) {
                    best = unlike
                    at = i
                }
            }
            what = "excerpt: three strokes of rising force, then two equal ones"
            if (!at) {
                at = top > 2 ? top - 2 : 1
                what = "excerpt: the loudest stroke and those around it"
            }
            last = at + 4 > n ? n : at + 4
            margin = 0.1 * (t[last] - t[at])
            print t[at] - margin, t[last] + margin, what
        }' "$1"
}

draw() {
    find_excerpt "$out/strokes.csv" >"$work/excerpt"
    read -r from to what <"$work/excerpt"
    envelope "$out/improvisation.wav" >"$work/sound.csv"
    gnuplot -e "motion = '$out/motion.csv'; strokes = '$out/strokes.csv'" \
        -e "sound = '$work/sound.csv'" \
        -e "from = $from; to = $to; length = $(length_of "$out/improvisation.wav")" \
        -e "title = 'Timpani improvisation by a simulated percussionist'" \
        -e "said = '$landed strokes on time and in place, sticks $apart mm (RMS) off target'" \
        -e "excerpt = '$what'; picture = '$work/picture.png'" \
        tools/research/figures/improvisation.gp >"$work/gnuplot.log" 2>&1 ||
        fail "gnuplot: $(tail -n 1 "$work/gnuplot.log")"
    mv "$work/picture.png" "$out/improvisation.png"
}

[ -x "$himc" ] && [ -e "$externals" ] || fail "$himc or $externals is missing; make builds them"

echo "Pure Data plays $patch ..."
play_in_pd
echo "himc render plays $score ..."
"$himc" render "$score" --channels 1 -o "$work/render.wav" --strokes "$out/strokes.csv" \
    --motion "$out/motion.csv" --quiet >"$work/render.log" || exit 1
landed="$(number played) of $(number strokes)"
apart=$(number tip_rms_mm | awk '{printf "%.2g", $1}')
echo "gnuplot draws ..."
draw

alike="sound alike to the last bit"
status=0
if ! compare "$out/improvisation.wav" "$work/render.wav"; then
    alike="DIFFER: $(cat "$work/cmp.log")"
    status=1
fi
length=$(length_of "$out/improvisation.wav")
echo
echo "in $out: improvisation.wav ($length s, from Pd), improvisation.png, strokes.csv, motion.csv"
echo "strokes   $landed landed within 5 ms and 2 cm of their place in the score," \
    "at up to $(number peak_force_n) N"
echo "sticks    $apart mm (RMS) off their targets," \
    "$(number tip_rms_percent | awk '{printf "%.2g", $1}') % of the height of a stroke"
echo "speed     Pd $(echo "$length $pd_time" | awk '{printf "%.1f", $1 / $2}') x real time," \
    "himc render $(number realtime_factor | awk '{printf "%.1f", $1}') x; the two $alike"
echo "live      pd -path $externals $patch"
exit $status
