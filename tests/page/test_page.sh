#!/bin/sh
# The page that plays by itself, in a real Chromium: tests/page/page.py has the tests.
: "${HIMC_BUILD:=build}"
export HIMC_BUILD
HIMC_MADE=$HIMC_BUILD/tests/page/$(basename "$0" .sh) # of its own: such tests run side by side
export HIMC_MADE
if [ ! -e "$HIMC_BUILD/himc.html" ] || ! command -v chromedriver >/dev/null || ! command -v python3 >/dev/null; then
    echo "$0:0:$(basename "$0" .sh):IGNORE: needs what tools/build/deps-page.txt and tools/build/deps-browser.txt list"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
tests/page/native.sh "$HIMC_MADE" || exit 1
exec python3 tests/page/page.py
