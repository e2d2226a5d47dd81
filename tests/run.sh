#!/bin/sh
# Runs test programs, JOBS at a time (one more than processors: some wait), and adds up what they report.
#   tests/run.sh PROGRAM...
# A program prints Unity's lines: `FILE:LINE:NAME:PASS|FAIL: why|IGNORE: why`, then `N Tests N Failures N Ignored`. One line
# is printed per program, what failed or was ignored in full, and last of all `N passed, N failed`. A program that
# crashes, runs longer than TEST_TIMEOUT seconds (600: for a program that hangs, on any machine), or ends without its
# summary counts as one more failure.
: "${JOBS:=$(($(nproc 2>/dev/null || echo 1) + 1))}" "${TEST_TIMEOUT:=600}" "${HIMC_BUILD:=build}"
PATH=/usr/bin:$PATH # Debian's python3, for which deps installs numpy, before one of the user's own
export HIMC_BUILD TEST_TIMEOUT PATH
logs=$HIMC_BUILD/tests/logs
times=$HIMC_BUILD/tests/times

# runs one program; leaves its output in NAME.log and `passed failed ignored` in NAME.sum
one() {
    name=$(basename "$1" .sh)
    start=$(date +%s.%N)
    timeout -k 5 "$TEST_TIMEOUT" "$1" >"$logs/$name.log" 2>&1 </dev/null
    code=$?
    time=$(date +%s.%N | awk -v start="$start" '{printf "%.1f", $1 - start}')
    case $code in
        0) trouble= ;;
        124 | 137) trouble="still running after $TEST_TIMEOUT s" ;;
        129 | 1[3-9]?) trouble="killed by signal $((code - 128))" ;;
        *) trouble="exit status $code" ;;
    esac
    awk -v name="$name" -v time="$time" -v trouble="$trouble" -v sum="$logs/$name.sum" '
        / Tests? .* Failures? .* Ignored/ { tests += $1; failures += $3; ignored += $5; seen = 1; next }
        /:(FAIL|IGNORE)(:|$)/ { lines = lines "    " $0 "\n"; next }
        !/:PASS$|^-+$|^OK$|^FAIL$|^$/ { rest = rest "    " $0 "\n" }
        END {
            # a failing program says so by its exit status too; count it once
            if (trouble == "" && !seen)
                trouble = "ended without a summary"
            if (trouble != "" && !(seen && failures > 0)) {
                failures++
                tests++
                lines = lines rest "    " name ": " trouble "\n"
            } else if (failures > 0)
                lines = lines rest
            passed = tests - failures - ignored
            print passed, failures + 0, ignored + 0 >sum
            printf "%-4s %-28s %3d passed", failures ? "FAIL" : "ok", name, passed
            if (failures) printf ", %d failed", failures
            if (ignored) printf ", %d ignored", ignored
            printf "  (%s s)\n%s", time, lines
        }' "$logs/$name.log" >"$logs/$name.out"
    cat "$logs/$name.out"
    echo "$time $1" >"$logs/$name.time"
}

if [ "$1" = --one ]; then
    one "$2"
    exit 0
fi

# what took longest in the run before begins first, and what has not run yet
rm -rf "$logs"
mkdir -p "$logs"
touch "$times"
printf '%s\n' "$@" | awk 'FILENAME != "-" { took[$2] = $1; next } { print ($1 in took ? took[$1] : 1e6), $1 }' "$times" - |
    sort -s -k 1,1nr | cut -d ' ' -f 2 | xargs -r -n 1 -P "$JOBS" "$0" --one
cat "$logs"/*.time "$times" /dev/null | sort -s -u -k 2,2 >"$times.new" && mv "$times.new" "$times"
cat "$logs"/*.sum /dev/null | awk -v programs=$# '
    { passed += $1; failed += $2; ignored += $3 }
    END {
        if (NR < programs) failed += programs - NR
        if (ignored) printf "%d ignored\n", ignored
        printf "%d passed, %d failed\n", passed, failed
        exit failed > 0 || programs == 0
    }'
