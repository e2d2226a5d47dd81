#!/usr/bin/env bash
# A storm of packets, 100,000 a second of valid, malformed and random ones (storm.c), against `himc
# serve` and against [himc~] in Pure Data: both go on, every packet is counted, memory stays flat.
# All is counted in packets and awaited, so that it is the same on a busy machine. With HIMC_LONG
# 6 million packets, and once more against builds with the address and undefined behaviour
# sanitizers. tests/realtime/test_storm.sh adds how late blocks are beside the storm and beside a
# process that takes the same share of a core and sends nothing: HIMC_STORM_SECONDS (60) of each, in
# six turns, since a machine has bad seconds of its own.
: "${HIMC_BUILD:=build}" "${CC:=gcc}" "${HIMC_STORM_SECONDS:=60}"
dir=$HIMC_BUILD/tests/storm
port=$((20000 + 8 * $$ % 12000)) # and 7 after it; ours, should two of these run at once, and below those that the system gives
packets=200000 rate=100000
[ -n "$HIMC_LONG" ] && packets=6000000
turns=6
[ -n "$HIMC_STORM_LATENESS" ] && packets=$((HIMC_STORM_SECONDS * rate / turns))
mkdir -p "$dir"
tests=0 failures=0
pid= keeper=

report() { # report NAME WHY SAID: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/cli/test_storm.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}${3:+ $3}"
}

trap 'kill $pid $keeper 2>/dev/null' EXIT

await() { # await FILE WORDS: until the file has them, at most a minute
    for _ in $(seq 600); do
        grep -q "$2" "$1" 2>/dev/null && return
        sleep 0.1
    done
}

child() { # child PID: the process that `timeout` keeps
    tr -d ' ' <"/proc/$1/task/$1/children"
}

memory() { # memory PID: kilobytes in use
    sed -n 's/^VmRSS:[^0-9]*\([0-9]*\).*/\1/p' "/proc/$1/status"
}

number() { # number NAME: from the JSON in $dir/out
    sed -n "s/.*\"$1\": \([-0-9.]*\).*/\1/p" "$dir/out"
}

number_of() { # number_of NAME: from what storm.c printed last
    tr ' ' '\n' <"$dir/counts" | grep -A1 -x "$1" | tail -n 1
}

storm() { # storm PORT: leaves packets sent in $sent, lost by the system in $dropped, growth (kB) in $grown
    sent=0 dropped=0 why=
    for count in 50000 $packets; do # memory allocated once is allocated in the first
        before=$(memory $pid)
        "$dir/storm" "$1" $count $rate $((sent - dropped)) >"$dir/counts" || why="not all is counted within a minute"
        sent=$((sent + $(number_of sent) + 0)) dropped=$((dropped + $(number_of dropped) + 0))
        grown=$(($(memory $pid) - before))
    done
    pace=$(number_of pace)
    share=$(number_of share)
}

counts() { # counts NAME: of blocks in the last run of `himc serve`, those and all
    echo "$(number "$1") $(number blocks)"
}

# compare NAME: from a line a turn, such blocks and all in a storm, such and all beside the burner,
# what they come to. Status 1 if the storm's are more than chance explains: 3 standard deviations, those
# that counts have, or those of the turns where they differ more
compare() {
    awk -v name="$1" '{
        late += $1; blocks += $2; other += $3; others += $4
        more[NR] = $1 - $3 * $2 / $4
        sum += more[NR]
    } END {
        for (i in more) apart += (more[i] - sum / NR) ^ 2 * NR / (NR - 1)
        printf "storm: %d of %d blocks %s; burner: %d of %d", late, blocks, name, other, others
        exit sum > 3 * sqrt(apart > late + other ? apart : late + other)
    }'
}

counted() { # why not all is counted, in kinds too
    [ -z "$why" ] || { echo "$why: $(cat "$dir/counts")"; return; }
    awk -v all=$((sent - dropped)) '{
        for (i = 1; i < NF; i += 2) n[$i] = $(i + 1)
        if (n["packets"] + n["overrun"] < all) print all " arrived, " n["packets"] " taken and " n["overrun"] " lost at the socket"
        split("malformed foreign refused frequent commands", kind, " ")
        for (i in kind) if (!(n[kind[i]] > 0)) print "none is " kind[i]
    }' "$dir/counts"
}

serve() { # serve WHAT...: beside this command
    : >"$dir/out" # the last run's would be taken for this one's
    timeout 900 "$bin/himc" serve patches/improvisation.txt --port $port >"$dir/out" 2>"$dir/err" &
    keeper=$!
    await "$dir/out" listening
    pid=$(child $keeper)
    "$@"
    alive=$(kill -0 $pid 2>/dev/null || echo dead)
    kill -TERM $pid
    wait $keeper
    code=$?
    pid=
}

against_serve() { # against_serve NAME
    serve storm $port
    report himc_serve_${1}goes_on_in_a_storm "$alive$([ $code = 0 ] || echo "exit status $code: $(tail -n 1 "$dir/err")")" "$pace packets/s"
    report himc_serve_${1}counts_the_whole_storm "$(counted)" "$(number overrun) of $sent lost in the system"
    report himc_serve_${1}says_so_at_its_end \
        "$([ $(($(number packets) + $(number overrun))) -ge $((sent - dropped)) ] || tail -n 1 "$dir/out")"
    [ -n "$1" ] && return # a sanitizer's own memory grows
    report himc_serve_keeps_its_memory "$([ "$grown" -lt 8192 ] || echo "$grown kB")" "$grown kB more"
    [ -n "$HIMC_STORM_LATENESS" ] || return
    : >"$dir/late" >"$dir/slow"
    for _ in $(seq $turns); do
        serve storm $port
        late=$(counts late) slow=$(counts slow)
        serve "$dir/storm" burn $((HIMC_STORM_SECONDS / turns)) $share
        echo "$late $(counts late)" >>"$dir/late"
        echo "$slow $(counts slow)" >>"$dir/slow"
    done
    for name in late slow; do
        said=$(compare $name <"$dir/$name") && why= || why=more
        report himc_serve_is_${name}_no_more_often_than_beside_a_burner "$why" \
            "$said ($share of a core); in turns: $(paste -s -d, "$dir/$name")"
    done
}

cat >"$dir/storm.pd" <<EOF
#N canvas 0 0 600 400 12;
#X obj 10 10 loadbang;
#X obj 10 40 t b b b b;
#X msg 300 70 \\; pd dsp 1;
#X msg 10 70 listen $port \\, subscribe 127.0.0.1 $((port + 1)) strikes \\, score improvisation.txt \\, play;
#X obj 10 110 himc~ kettle;
#X obj 300 110 membrane~ kettle;
#X obj 10 160 netreceive -u -b $((port + 1));
#X obj 10 190 oscparse;
#X obj 10 220 list trim;
#X obj 10 250 route himc;
#X obj 10 280 route status;
#X obj 10 310 print status;
#X obj 300 160 bang~;
#X obj 300 190 t b b b;
#X obj 380 220 realtime;
#X obj 300 250 timer;
#X obj 300 280 -;
#X obj 300 310 swap;
#X obj 300 340 expr max(\$f1\\, \$f2);
#X obj 420 340 f;
#X obj 420 250 metro 500;
#X obj 420 370 print late;
#X obj 500 10 r storm-quiet;
#X msg 500 40 0;
#X connect 0 0 1 0;
#X connect 1 0 3 0;
#X connect 1 1 15 0;
#X connect 1 2 14 0;
#X connect 1 3 2 0;
#X connect 1 0 20 0;
#X connect 3 0 4 0;
#X connect 6 0 7 0;
#X connect 7 0 8 0;
#X connect 8 0 9 0;
#X connect 9 0 10 0;
#X connect 10 0 11 0;
#X connect 12 0 13 0;
#X connect 13 1 14 1;
#X connect 13 0 15 1;
#X connect 14 0 16 1;
#X connect 15 0 16 0;
#X connect 16 0 17 0;
#X connect 17 0 18 0;
#X connect 18 0 18 1;
#X connect 18 0 19 1;
#X connect 20 0 19 0;
#X connect 19 0 21 0;
EOF
# real time ahead of Pd's: minus (timer - realtime)
sed -i 's/^#X obj 300 310 swap;/#X obj 300 310 * -1;/' "$dir/storm.pd"

in_pd() { # in_pd SECONDS: 0 is a storm's length
    : >"$dir/pd"
    LD_PRELOAD=$preload ASAN_OPTIONS=detect_leaks=0 timeout 900 pd -nogui -rt -stderr -noprefs -noaudio -nomidi \
        -r 48000 -path "$externals" -path patches -open "$dir/storm.pd" >"$dir/pd" 2>&1 </dev/null &
    keeper=$!
    await "$dir/pd" '^status'
    pid=$(child $keeper)
    [ "$1" = 0 ] && storm $port || sleep "$1"
    alive=$(kill -0 $pid 2>/dev/null || echo dead)
    kill -TERM $pid 2>/dev/null
    wait $keeper 2>/dev/null
    pid=
}

against_pd() { # against_pd NAME
    [ -n "$HIMC_STORM_LATENESS" ] && in_pd $HIMC_STORM_SECONDS && quiet=$(grep -a '^late' "$dir/pd" | tail -n 1)
    in_pd 0
    report himc_tilde_${1}goes_on_in_a_storm "$alive$(grep -a -m1 'ERROR: AddressSanitizer\|runtime error' "$dir/pd")" "$pace packets/s"
    report himc_tilde_${1}counts_the_whole_storm "$(counted)" "$(number_of overrun) of $sent lost in the system"
    [ -n "$1" ] && return
    report himc_tilde_keeps_its_memory "$([ "$grown" -lt 8192 ] || echo "$grown kB")" "$grown kB more"
    [ -n "$HIMC_STORM_LATENESS" ] || return
    report himc_tilde_late_blocks "" "the worst by $(grep -a '^late' "$dir/pd" | tail -n 1 | sed 's/late: //') ms; quiet: ${quiet#late: } ms"
}

"$CC" -std=c17 -O2 -Wall -Wextra tests/cli/storm.c -llo -lm -o "$dir/storm" || exit 1
bin=$HIMC_BUILD/bin externals=$HIMC_BUILD/externals/himc preload=
against_serve
against_pd
if [ -n "$HIMC_LONG" ]; then
    asan=$dir/asan
    make -s all BUILD="$asan" SANITIZE="-fsanitize=address,undefined -fno-sanitize-recover=undefined" \
        CFLAGS="-fsanitize=address,undefined -fno-sanitize-recover=undefined" LDFLAGS=-fsanitize=address,undefined >"$dir/asan.log" 2>&1
    report sanitized_programs_are_built "$([ -x "$asan/bin/himc" ] || tail -n 1 "$dir/asan.log")"
    bin=$asan/bin externals=$asan/externals/himc preload=$("$CC" -print-file-name=libasan.so)
    against_serve sanitized_
    against_pd sanitized_
fi
echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
