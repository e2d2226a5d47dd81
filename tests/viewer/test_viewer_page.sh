#!/bin/sh
# The viewer end to end: the motion of himc render as OSC, the viewer, the page in a real Chromium.
# tests/viewer/page.py has the tests; tests/viewer/sender.c sends what a performer would.
. tests/viewer/prepare.sh
exec python3 tests/viewer/page.py page
