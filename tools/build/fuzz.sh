#!/bin/sh
# Runs fuzz targets linked with libFuzzer, one after the other; the last line is their sum.
#   tools/build/fuzz.sh BUILD SECONDS TARGET...
# What they learn stays in BUILD/corpus and is where the next run begins. An input that fails is left in BUILD/failed, what
# the target said in BUILD/logs. Each run adds a line to BUILD/executions.txt: day, commit, target, seconds, executions, end.
build=$1
seconds=$2
shift 2
mkdir -p "$build/logs" "$build/failed"
commit=$(git describe --always --dirty 2>/dev/null)
faults=0
for target; do
    name=$(basename "$target")
    name=${name#fuzz_}
    mkdir -p "$build/corpus/$name" "tests/fuzz/corpus/$name"
    times >"$build/before" # processor time of all children so far
    "$target" -max_total_time="$seconds" -max_len=32768 -timeout=25 -rss_limit_mb=3000 -print_final_stats=1 \
        -artifact_prefix="$build/failed/$name-" "$build/corpus/$name" "tests/fuzz/corpus/$name" >"$build/logs/$name.txt" 2>&1
    if [ $? = 0 ]; then
        end=ok
    else
        end=FAILED
        faults=$((faults + 1))
    fi
    count=$(sed -n 's/^stat::number_of_executed_units: *//p' "$build/logs/$name.txt")
    echo "$(date -u +%F) $commit $name $seconds ${count:-0} $end" >>"$build/executions.txt"
    times >"$build/after"
    awk -v name="$name" -v count="${count:-0}" -v end="$end" '
        FNR % 2 == 0 { gsub(/[ms]/, " "); before = now; now = 60 * $1 + $2 + 60 * $3 + $4 }
        END { printf "%-16s %9d executions, %6d a second of processor time  %s\n", name, count, count / (now - before + 1e-3), end }
    ' "$build/before" "$build/after"
    [ $end = ok ] || grep -m1 -E 'ERROR:|runtime error:|broken promise:' "$build/logs/$name.txt"
    rmdir "tests/fuzz/corpus/$name" 2>/dev/null
done
awk '{ sum += $5; failed += $6 != "ok" } END { printf "%d executions in all in %s, %d runs failed\n", sum, FILENAME, failed }' \
    "$build/executions.txt"
echo "$# targets, $faults failed"
[ $faults = 0 ]
