#!/bin/sh
# `himc bench`: a step of the whole performance costs more than one of the bare engine.
: "${HIMC_BUILD:=build}"
out=$("$HIMC_BUILD/bin/himc" bench --json)
number() { # number KEY
    echo "$out" | sed -n "s/.*\"$1\": \([^,}]*\).*/\1/p"
}
if awk "BEGIN { exit !($(number step_us) > $(number engine_step_us)) }"; then
    result=PASS failures=0
else
    result="FAIL: $out" failures=1
fi
echo "tests/realtime/test_bench.sh:0:test_a_step_is_dearer_than_the_engine_alone:$result"
echo "-----------------------"
echo "1 Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
