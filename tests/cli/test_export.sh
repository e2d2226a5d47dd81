#!/bin/sh
# `himc export`: the model has the body's own numbers. tests/cli/export.py has the tests.
#   MUJOCO_PYTHON: a python3 that has mujoco (`make bench-peers` makes one), which then judges the mass matrix
: "${HIMC_BUILD:=build}" "${MUJOCO_PYTHON:=build/peers/bin/python}"
export HIMC_BUILD
"$MUJOCO_PYTHON" -c 'import mujoco' 2>/dev/null || MUJOCO_PYTHON=python3
if ! command -v "$MUJOCO_PYTHON" >/dev/null; then
    echo "tests/cli/test_export.sh:0:test_export:IGNORE: needs python3"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
PYTHONPATH=tests/viewer exec "$MUJOCO_PYTHON" -B tests/cli/export.py
