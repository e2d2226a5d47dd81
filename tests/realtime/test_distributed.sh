#!/usr/bin/env bash
# The performer in one process, the sound in another, a bad network between them: `himc serve` at
# 127.0.0.2, relay.c at 127.0.0.3 (20 ms of jitter, 5 % of the packets lost, others overtaking each
# other), patches/07-distributed.pd at 127.0.0.1, whose drum must be struck in the rhythm that was
# played, and which must know how many strikes are missing. All by the wall clock, on a machine at rest.
cd "$(dirname "$0")/../.." || exit 1
: "${HIMC_BUILD:=build}" "${CC:=gcc}"
dir=$HIMC_BUILD/tests/realtime/distributed
port=$((20000 + 8 * $$ % 12000)) # and 7 after it; ours, should two of these run at once, and below those that the system gives
seconds=12 latency=50
[ -n "$HIMC_LONG" ] && seconds=60
mkdir -p "$dir"
tests=0 failures=0

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/realtime/test_distributed.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}${3:+ $3}"
}

finish() {
    kill $server $pd 2>/dev/null
    wait $server $pd 2>/dev/null
}
trap finish EXIT

"$CC" -std=c17 -O2 -Wall -Wextra tests/realtime/relay.c -llo -o "$dir/relay" || exit 1
awk -v seconds=$seconds 'BEGIN {
    # three strokes a beat, hands in turn, at 120 beats a minute
    print "tempo 120;"
    for (i = 0; i < 6 * seconds - 12; i++)
        printf "stroke %.6f %s legato %s normal;\n", 2 + i / 3, i % 2 ? "left" : "right", i % 3 ? "mp" : "f"
}' >"$dir/score.txt"

"$HIMC_BUILD/bin/himc" serve "$dir/score.txt" --bind 127.0.0.2 --port $port >"$dir/serve" 2>&1 &
server=$!
sed "s/listen 9001/listen $((port + 2))/; s/on-time 50/on-time $latency/" patches/07-distributed.pd >"$dir/07-distributed.pd"
pd -nogui -nrt -stderr -noprefs -noaudio -nomidi -r 48000 -path "$HIMC_BUILD/externals/himc" -path patches \
    -open "$dir/07-distributed.pd" -send "himc-distributed $((port + 2))" >"$dir/pd" 2>&1 </dev/null &
pd=$!
for _ in $(seq 100); do
    grep -q listening "$dir/serve" && break
    sleep 0.1
done
sleep 1 # Pd's patch loads
sleep $((seconds + 2)) | "$dir/relay" 127.0.0.3 $((port + 1)) $port $((port + 2)) 20 0.05 >"$dir/relay.log"
report relay_ran_to_its_end "$([ "${PIPESTATUS[1]}" = 0 ] || echo "exit status ${PIPESTATUS[1]}")"
finish

# the strikes that came, beside those of the drum: TIME is in its sixth decimal at best
awk '$3 == "through" { print $2 }' "$dir/relay.log" | sort -n >"$dir/sent"
sed -n 's/^struck: strike \([^ ]*\).*/\1/p' "$dir/pd" >"$dir/struck"
last() { # the last count of that name
    sed -n "s/^counts: $1 //p" "$dir/pd" | tail -n 1
}
sent=$(wc -l <"$dir/sent") struck=$(wc -l <"$dir/struck") lost=$(grep -c lost "$dir/relay.log")
worst=$(paste "$dir/sent" "$dir/struck" | awk '
    NR > 1 && NF == 2 { e = 1000 * (($2 - b) - ($1 - a)); if (e < 0) e = -e; if (e > worst) worst = e }
    { a = $1; b = $2 }
    END { printf "%.3f", worst }')

report relay_lost_some "$([ "$lost" -ge 2 ] || echo "only $lost of $sent")" "$lost of $((sent + lost))"
report every_strike_that_came_is_played_once "$([ "$sent" = "$struck" ] || echo "$struck of $sent")"
report every_loss_is_counted "$([ "$(last lost)" = "$lost" ] || echo "$(last lost) counted, $lost lost")"
report no_strike_is_late "$(last late)"
report rhythm_is_kept_to_1_ms \
    "$(echo "$worst" | awk '$1 >= 1 { print $1 " ms" }')" "$worst ms at worst"
report pd_reports_no_error "$(grep -m1 -i 'error\|no such' "$dir/pd")"

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
