#!/bin/sh
# The viewer's load and delays on a machine that has nothing else to do: tests/viewer/realtime.py.
. tests/viewer/prepare.sh
exec python3 tests/viewer/realtime.py
