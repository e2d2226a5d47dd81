# check.sh: for tests that are shell scripts, which read it (`. tests/support/check.sh`): Unity's lines and summary.
tests=0 failures=0 ignored=0 script=$0

# line NAME RESULT: what Unity would print
line() {
    echo "$script:0:$1:$2"
}

# check NAME CONDITION...
check() {
    name=$1
    shift
    tests=$((tests + 1))
    if "$@"; then
        line "$name" PASS
    else
        failures=$((failures + 1))
        line "$name" "FAIL: not so: $*"
        return 1
    fi
}

# the summary; the exit status says whether all have passed
finish() {
    echo "-----------------------"
    echo "$tests Tests $failures Failures $ignored Ignored"
    exit $((failures > 0))
}
