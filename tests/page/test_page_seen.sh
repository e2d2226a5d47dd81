#!/bin/sh
# The same page on screens of phones, by keys alone, by axe-core's rules, in Firefox: tests/page/page.py has the tests.
: "${HIMC_BUILD:=build}"
export HIMC_BUILD
HIMC_MADE=$HIMC_BUILD/tests/page/test_page_seen
export HIMC_MADE
if [ -z "$HIMC_LONG" ]; then
    echo "$0:0:test_page_seen:IGNORE: HIMC_LONG=1"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
if [ ! -e "$HIMC_BUILD/himc.html" ] || ! command -v chromedriver >/dev/null || ! command -v python3 >/dev/null; then
    echo "$0:0:test_page_seen:IGNORE: needs what tools/build/deps-page.txt and tools/build/deps-browser.txt list"
    echo "1 Tests 0 Failures 1 Ignored"
    exit 0
fi
exec python3 tests/page/page.py seen
