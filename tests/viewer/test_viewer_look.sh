#!/bin/sh
# What the viewer draws, in a real Chromium: the seat, the grip, the drums, the cameras, the memory.
# tests/viewer/look.py has the tests.
. tests/viewer/prepare.sh
exec python3 tests/viewer/look.py
