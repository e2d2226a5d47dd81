#!/bin/sh
# `himc fit`: drums of known size, tuning, losses and mallet are found again in their sound; bad recordings are refused.
# tests/cli/fit.py has the tests. HIMC_LONG=1: 20 drums in place of 2.
: "${HIMC_BUILD:=build}"
export HIMC_BUILD
if ! command -v python3 >/dev/null; then
    echo "tests/cli/test_fit.sh:0:test_fit:IGNORE: needs python3"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
PYTHONPATH=tests/viewer exec python3 -B tests/cli/fit.py
