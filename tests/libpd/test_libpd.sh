#!/bin/sh
# Both objects as plain C files in a program that contains Pure Data (tests/libpd/embed.c): they say what they say in Debian's Pd,
# alone and in four instances at once, a thread each, where the thread sanitizer finds nothing but a counter of Pd's scheduler that all
# instances add to and none needs; and no symbol of ours can clash. `make test-libpd LIBPD=path` runs it.
. tests/support/check.sh
: "${HIMC_BUILD:=build}"
here=$(realpath "$HIMC_BUILD")
dir=$here/libpd

build() { # build NAME OPTION...
    kind=$1
    shift
    { cmake -S tests/libpd -B "$dir/$kind" -DLIBPD="$LIBPD" "$@" && cmake --build "$dir/$kind" -j "$(nproc)" --target embed; } \
        >"$dir/$kind.log" 2>&1
}
mkdir -p "$dir"
check test_program_builds build one
check test_program_with_instances_builds build many -DPD_MULTI=ON
check test_program_without_a_performer_builds build drum -DHIMC_PERFORMER=OFF
thread=-fsanitize=thread
check test_program_for_the_thread_sanitizer_builds build threads -DPD_MULTI=ON -DCMAKE_C_FLAGS=$thread -DCMAKE_CXX_FLAGS=$thread
check test_our_symbols_are_prefixed [ -z "$(nm -g --defined-only "$dir"/one/himc/libhimc*.a | awk 'NF == 3 { print $3 }' |
    grep -vE '^(himc_|membrane_tilde_setup$|_Z.*10himc_eigen|_ZT|DW\.ref\.)')" ]
cd tests/pd || exit 1
play() { # play COMMAND...: what it prints of strikes and levels
    "$@" 2>&1 </dev/null | grep '^strike: '
}
pd="pd -nrt -nogui -stderr -noaudio -nomidi -r 48000 -batch -path $here/externals/himc -open"
play $pd score.pd >"$dir/pd.txt"
play "$dir/one/embed" score.pd 4 >"$dir/one.txt"
check test_pd_strikes_three_times [ "$(grep -c '^strike: strike' "$dir/pd.txt")" = 3 ]
check test_program_says_what_pd_says cmp "$dir/pd.txt" "$dir/one.txt"
play $pd drum-alone.pd >"$dir/pd-drum.txt"
play "$dir/drum/embed" drum-alone.pd 1 >"$dir/drum.txt"
check test_drum_sounds_in_pd [ "$(grep -c 'strike 0.1 \|level: [3-9]' "$dir/pd-drum.txt")" -gt 10 ]
check test_drum_without_a_performer_sounds_as_in_pd cmp "$dir/pd-drum.txt" "$dir/drum.txt"
"$dir/many/embed" score.pd 4 4 2>/dev/null >"$dir/many.txt"
for i in 0 1 2 3; do
    awk -v i=$i '/^instance/ { now = $2 } now == i && /^strike: /' "$dir/many.txt" >"$dir/instance.txt"
    check test_instance_${i}_says_what_pd_says cmp "$dir/pd.txt" "$dir/instance.txt"
done
echo race:sched_tick >"$dir/known.txt"
race() {
    TSAN_OPTIONS="suppressions=$dir/known.txt" "$dir/threads/embed" score.pd 4 4 >"$dir/threads.txt" 2>"$dir/race.log"
}
check test_instances_play_without_a_race race || head -n 20 "$dir/race.log"
check test_all_strike_under_the_sanitizer [ "$(grep -c '^strike: strike' "$dir/threads.txt")" = 12 ]

finish
