#!/bin/sh
# A piece edited on the page, in a real Chromium: the second half of tests/viewer/page.py.
. tests/viewer/prepare.sh
exec python3 tests/viewer/page.py edit
