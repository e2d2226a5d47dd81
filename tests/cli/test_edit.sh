#!/bin/sh
# `himc edit`: every change plays as if it had been written so. tests/viewer/edit.py has the tests.
: "${HIMC_BUILD:=build}"
export HIMC_BUILD
if ! command -v python3 >/dev/null; then
    echo "tests/cli/test_edit.sh:0:test_edit:IGNORE: needs python3"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
exec python3 tests/viewer/edit.py
