#!/bin/sh
# The program in docs/hello.md compiles as printed, plays, and reports as many strikes as it has strokes.
: "${HIMC_BUILD:=build}" "${CC:=gcc}"
dir=$HIMC_BUILD/tests/hello
tests=0
failures=0
mkdir -p "$dir"

# check NAME CONDITION... ; prints the line that Unity would
check() {
    name=$1
    shift
    tests=$((tests + 1))
    if "$@"; then
        echo "tests/test_hello.sh:0:$name:PASS"
    else
        failures=$((failures + 1))
        echo "tests/test_hello.sh:0:$name:FAIL: not so: $*"
    fi
}

sed -n '/^```c$/,/^```$/p' docs/hello.md | sed '1d;$d' >"$dir/hello.c"
check test_hello_compiles_without_warnings "$CC" -std=c17 -Wall -Wextra -Wpedantic -Werror -Ilib "$dir/hello.c" \
    "$HIMC_BUILD/libhimc.a" -lode -llapacke -lm -o "$dir/hello"
"$dir/hello" >"$dir/hello.raw" 2>"$dir/strikes"
check test_hello_plays [ $? = 0 ]
strokes=$(grep -o '"stroke [^"]*"' docs/hello.md | wc -l)
check test_hello_reports_a_strike_for_each_stroke [ "$(grep -c ' N$' "$dir/strikes")" = "$strokes" ]
peak=$(od -An -v -t f4 -w4 "$dir/hello.raw" | awk '{v = $1 < 0 ? -$1 : $1; if (v > m) m = v} END {print (m > 0.001 && m < 1000)}')
check test_hello_makes_sound [ "$peak" = 1 ]

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
