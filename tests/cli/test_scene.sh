#!/bin/sh
# `himc render --scene`: the same as the tables say. tests/viewer/record.py has the tests.
: "${HIMC_BUILD:=build}"
export HIMC_BUILD
if ! command -v python3 >/dev/null; then
    echo "tests/cli/test_scene.sh:0:test_scene:IGNORE: needs python3"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
exec python3 tests/viewer/record.py
