#!/bin/sh
# `himc lesson`: planted faults are named, nothing is invented. tests/cli/lesson.py has the tests, lesson_takes.py makes the takes.
#   HIMC_LONG=1: all takes instead of some 50; HIMC_SEED=1000: takes that were never used for tuning
: "${HIMC_BUILD:=build}"
export HIMC_BUILD
if ! command -v python3 >/dev/null; then
    echo "tests/cli/test_lesson.sh:0:test_lesson:IGNORE: needs python3"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
PYTHONPATH=tests/viewer exec python3 -B tests/cli/lesson.py
