#!/usr/bin/env bash
# What `dump` answers goes back, without its first word, into another performer of the same drums, and from
# one drum into another: the state is the same. Commands to drums by way of [himc~].
cd "$(dirname "$0")/../.." || exit 1
build=$(cd "${HIMC_BUILD:-build}" && pwd) || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp tests/pd/sent-back.pd "$work"
timeout "${TEST_TIMEOUT:-60}" pd -nogui -nosound -stderr -path "$build/externals/himc" \
    "$work/sent-back.pd" >"$work/out" 2>&1 </dev/null
tests=0 failures=0

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_sent_back.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}"
}

said() { # said WHAT...: how often each is in the output, if not once
    local what n
    for what; do
        n=$(grep -cF -- "$what" "$work/out")
        [ "$n" = 1 ] || echo -n "'$what' $n times; "
    done
}

report a_performers_dump_makes_the_same_state \
    "$(for line in 'kettle kettle 0.11;' 'at 12 kettle tune C3;' 'at 2 kettle damp 1;' 'tempo 120 4;' 'kettle noise 0.25;'; do
        grep -qx -- "$line" "$work/one.txt" || echo -n "no $line "
    done
    diff <(grep -v '^drum ' "$work/one.txt") <(grep -v '^drum ' "$work/two.txt"))"
report a_drums_dump_makes_the_same_drum "$(diff "$work/three.txt" "$work/four.txt")"
report a_drum_that_is_not_there_is_named "$(said \
    'himc~: kettle: tuen: unknown command' 'himc~: kettle: a drum, expected a command')$(grep -c \
    'himc~: mid: no drum (kettle' "$work/out" | sed 's/^2$//')"
report no_drum_has_the_name_of_a_command "$(said 'himc~: drum stop: the name of a command' \
    'membrane~: drum stop: the name of a command' 'himc~: stop: tune is one atom too many')"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
