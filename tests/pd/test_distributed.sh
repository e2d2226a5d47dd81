#!/usr/bin/env bash
# The performer in one place, the sound in another, a bad network between them: 20 ms of jitter, 5 % of
# the packets lost, others overtaking each other. patches/07-distributed.pd must strike its drum in the
# rhythm that was played, and know how many strikes are missing. All in the samples' time: packets.c
# makes the packets and their times, `pd -batch` hears them as fast as it can compute, in place of
# [netreceive]. The same over sockets, by the wall clock, is tests/realtime/test_distributed.sh.
cd "$(dirname "$0")/../.." || exit 1
: "${HIMC_BUILD:=build}" "${CC:=gcc}" "${TEST_TIMEOUT:=600}"
dir=$HIMC_BUILD/tests/distributed
seconds=12
[ -n "$HIMC_LONG" ] && seconds=60
mkdir -p "$dir"
tests=0 failures=0

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_distributed.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}${3:+ $3}"
}

"$CC" -std=c17 -O2 -Wall -Wextra -Ilib -Ilib/src tests/pd/packets.c "$HIMC_BUILD/libhimc.a" \
    -Wl,--as-needed -lode -lexpat -lz -llo -lstdc++ -lpthread -lm -o "$dir/packets" || exit 1
awk -v seconds=$seconds 'BEGIN {
    # three strokes a beat, hands in turn, at 120 beats a minute
    print "tempo 120;"
    for (i = 0; i < 6 * seconds - 12; i++)
        printf "stroke %.6f %s legato %s normal;\n", 2 + i / 3, i % 2 ? "left" : "right", i % 3 ? "mp" : "f"
}' >"$dir/score.txt"
"$dir/packets" "$dir/score.txt" 20 0.05 "$dir/sent.log" >"$dir/packets.txt" || exit 1

sed 's/^#X obj 434 172 netreceive -u -b;/#X obj 434 172 packets;/' patches/07-distributed.pd >"$dir/07-distributed.pd"
cp tests/pd/packets.pd "$dir"
cat >"$dir/driver.pd" <<'EOF'
#N canvas 0 0 300 200 12;
#X obj 10 10 loadbang;
#X msg 10 40 read packets.txt \, bang;
#X obj 10 70 qlist;
#X connect 0 0 1 0;
#X connect 1 0 2 0;
EOF
timeout "$TEST_TIMEOUT" pd -nogui -nrt -stderr -noprefs -noaudio -nomidi -r 48000 -batch -path "$HIMC_BUILD/externals/himc" \
    -path patches -open "$dir/07-distributed.pd" -send "himc-distributed 1" -open "$dir/driver.pd" >"$dir/pd" 2>&1 </dev/null
code=$?
report pd_plays_to_the_end "$([ $code = 0 ] || echo "exit status $code: $(tail -n 1 "$dir/pd")")"

# the strikes that came, beside those of the drum: TIME is in its sixth decimal at best
awk '$3 == "through" { print $2 }' "$dir/sent.log" | sort -n >"$dir/sent"
sed -n 's/^struck: strike \([^ ]*\).*/\1/p' "$dir/pd" >"$dir/struck"
last() { # the last count of that name
    sed -n "s/^counts: $1 //p" "$dir/pd" | tail -n 1
}
sent=$(wc -l <"$dir/sent") struck=$(wc -l <"$dir/struck") lost=$(grep -c lost "$dir/sent.log")
worst=$(paste "$dir/sent" "$dir/struck" | awk '
    NR > 1 && NF == 2 { e = 1000 * (($2 - b) - ($1 - a)); if (e < 0) e = -e; if (e > worst) worst = e }
    { a = $1; b = $2 }
    END { printf "%.3f", worst }')

report the_network_lost_some "$([ "$lost" -ge 2 ] || echo "only $lost of $sent")" "$lost of $((sent + lost))"
report every_strike_that_came_is_played_once "$([ "$sent" = "$struck" ] || echo "$struck of $sent")"
report every_loss_is_counted "$([ "$(last lost)" = "$lost" ] || echo "$(last lost) counted, $lost lost")"
report no_strike_is_late "$(last late)"
report rhythm_is_kept_to_1_ms \
    "$(echo "$worst" | awk '$1 >= 1 { print $1 " ms" }')" "$worst ms at worst"
report pd_reports_no_error "$(grep -m1 -i 'error\|no such' "$dir/pd")"

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
