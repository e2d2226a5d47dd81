#!/bin/sh
# The program for arm64, run by qemu: the strikes of a score are those of this machine, digit by digit, and so is the sound.
# `make test-arm64` runs it.
. tests/support/check.sh
: "${HIMC_BUILD:=build}"
# the C library is this system's, as here: the bits of sin() and exp() are its
root=$(realpath "$HIMC_BUILD")/arm64/debian/root machine=aarch64-linux-gnu
libraries=/usr/$machine/lib:$root/usr/lib/$machine:$root/lib/$machine
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '%s\n' "tempo 120;" "stroke 0 right legato mf;" "stroke 1 left accent f;" "stroke 2 right staccato p rim;" "play;" >"$work/score.txt"

render() { # render NAME COMMAND...
    name=$1
    shift
    "$@" render "$work/score.txt" -o "$work/$name.wav" --strokes "$work/$name.csv" >"$work/$name.log" 2>&1 || cat "$work/$name.log"
}
render here "$HIMC_BUILD/bin/himc"
render arm64 qemu-aarch64 -L /usr/aarch64-linux-gnu -E LD_LIBRARY_PATH="$libraries" "$HIMC_BUILD/arm64/bin/himc"

check test_three_strikes_are_played [ "$(wc -l <"$work/here.csv")" = 4 ]
check test_strikes_are_those_of_this_machine cmp "$work/here.csv" "$work/arm64.csv"
check test_sound_is_that_of_this_machine cmp "$work/here.wav" "$work/arm64.wav"
needed=$(LC_ALL=C aarch64-linux-gnu-readelf -d "$HIMC_BUILD"/arm64/externals/himc/*.l_arm64 | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' |
    grep -vE '^(libc|libm|libpthread|ld-linux.*)\.so\.[0-9]+$')
check test_externals_need_the_c_library_alone [ -z "$needed" ]
finish
