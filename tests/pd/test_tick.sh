#!/usr/bin/env bash
# The real-time contract in Pure Data's DSP tick: a patch with all commands in random order, a few
# every block, files among them; tests/watch/watch.c counts every call of the allocator, a lock, a
# file, printf or sleep in the DSP routines of [himc~] and [membrane~]. There is none.
# HIMC_LONG: 10 minutes of the patch's time, else 10 seconds.
cd "$(dirname "$0")/../.." || exit 1
build=$(cd "${HIMC_BUILD:-build}" && pwd) || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
seconds=10
[ -n "$HIMC_LONG" ] && seconds=600
tests=0 failures=0

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_tick.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}"
}

watched() { # watched COMMAND...: what the watch says
    LD_PRELOAD=$build/tests/watch.so timeout "${TEST_TIMEOUT:-600}" "$@" >"$work/out" 2>&1 </dev/null
    grep '^watch:' "$work/out"
}

# the watch sees what a span calls, in whatever way
cat >"$work/offender.c" <<'END'
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
void watch_span_begin(void) __attribute__((weak));
void watch_span_end(void) __attribute__((weak));
int main(void)
{
    static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
    static char text[9];
    char *volatile block = malloc(3);
    watch_span_begin();
    free(block);
    free(malloc(2));
    pthread_mutex_lock(&lock);
    close(open("/dev/null", O_RDONLY));
    usleep(1);
    snprintf(text, sizeof text, "%p", (void *)block);
    watch_span_end();
    pthread_mutex_unlock(&lock);
    return 0;
}
END
"${CC:-gcc}" -O0 "$work/offender.c" -lpthread -o "$work/offender"
said=$(watched "$work/offender")
report the_watch_counts_each_call_that_may_wait \
    "$(grep -q '^watch: 9 calls in 1 spans' <<<"$said" || echo "it says: $said")" # snprintf is vsnprintf, too

# a take for the patch
echo "drum kettle; record $work/take.bvh; stroke 1 left legato f; stroke 2 right accent f; play;" >"$work/record.txt"
"$build/bin/himc" render "$work/record.txt" --channels 1 -o "$work/record.wav" >"$work/log" 2>&1
cat >"$work/score.txt" <<'END'
kettle modes 60; kettle tension 3000; tempo 140; stroke 0.5 left legato f; stroke 1 right accent mf;
stroke 1.5 left staccato p rim; play;
END
cat >"$work/words" <<'END'
himc stroke 4 left legato f
himc stroke 4.5 right staccato ff rim other
himc hit left accent fff
himc hit right legato pp
himc hit any tenuto mf
himc latency 0
himc latency 80
himc latency auto
himc tempo 150
himc grip french
himc loop 1
himc clear
himc play
himc stop
himc seek 1
himc score score.txt
himc take take.bvh
himc units take.bvh legato
himc units clear
himc target left 0.6 0.1 0.9
himc target right 9 9 9
himc mode id
himc mode ik
himc mode himc
himc solver sdls
himc damping 0.1
himc posture 0
himc bend 0
himc elbow 1
himc weights 1 1 2 0.5
himc law computed-torque
himc gain frequency 1.2
himc gain nobody 1 1
himc limits ellipsoid
himc limits off
himc strength human
himc rate physics 8000
himc rate physics 10000
himc coupling one-way
himc player 1.8 80
himc push left-hand 20 0 0 0.1
himc push nobody 20 0 0 0.1
himc record again.bvh
himc record stop
himc info
himc reset
himc nonsense
drum radius 0.3
drum tension 3500
drum density 0.26
drum tune 140
drum modes 150
drum modes 30
drum decay 1
drum air 0
drum air 1
drum kettle usual
drum glide 0.5
drum damp 0.3
drum shape rectangle 0.5 0.5
drum shape circle
drum mallet wood
drum mallet 2e8 2.5 0.03
drum place 0.7 0 0.85
drum pickup air 0 0.5 1
drum pickups 3
drum channel 1 0.1 0.1
drum technique signal
drum technique modal
drum strike 0.1 0 3
drum strike 9 9 9
drum info
END
awk -v seconds="$seconds" 'BEGIN { srand(5); while ((getline line < ARGV[1]) > 0) word[n++] = line
    print "0 pd dsp 1;"
    for (t = 0; t < 1000 * seconds; t += d) { d = int(20 * rand()); print d " contract-" word[int(n * rand())] ";" }
    print "1 pd quit;" }' "$work/words" >"$work/messages.txt"
cat >"$work/contract.pd" <<'END'
#N canvas 0 0 500 300 12;
#X obj 10 10 loadbang;
#X msg 10 40 read messages.txt \, bang;
#X obj 10 70 qlist;
#X obj 150 10 r contract-himc;
#X obj 150 40 himc~ -signals kettle other;
#X obj 300 10 r contract-drum;
#X obj 300 40 membrane~ kettle 26 3;
#X obj 300 70 dac~;
#X obj 300 150 membrane~ other 23;
#X connect 0 0 1 0;
#X connect 1 0 2 0;
#X connect 3 0 4 0;
#X connect 5 0 6 0;
#X connect 6 0 7 0;
END
said=$(watched pd -nogui -nrt -stderr -noprefs -noaudio -nomidi -r 48000 -batch -path "$build/externals/himc" -open "$work/contract.pd")
spans=$(sed -n 's/^watch: .* calls in \([0-9]*\) spans/\1/p' <<<"$said")
report nothing_in_a_dsp_tick_may_wait "$(grep -q '^watch: 0 calls' <<<"$said" || echo "$said $(tail -n 1 "$work/out")" | tr '\n' ' ')"
report all_ticks_were_watched "$([ "${spans:-0}" -ge $((seconds * 750 * 3 - 30)) ] || echo "$spans spans")"
report every_command_is_known \
    "$(grep 'unknown\|missing' "$work/out" | grep -v 'nonsense: unknown command' | head -n 3)"

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
