#!/bin/sh
# The viewer without a browser: what it serves, which clients it refuses, how it treats OSC.
# tests/viewer/bridge.py has the tests.
: "${HIMC_BUILD:=build}"
export HIMC_BUILD
if [ ! -x "$HIMC_BUILD/bin/himc-viewer" ] || ! command -v python3 >/dev/null; then
    echo "tests/viewer/test_viewer.sh:0:test_viewer:IGNORE: needs himc-viewer and python3"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
exec python3 tests/viewer/bridge.py
