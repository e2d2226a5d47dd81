#!/bin/sh
# The order of the rooms, who knows which library, the public symbols, sizes: that part of `make lint` which takes a second.
if tools/build/lint.sh "${HIMC_BUILD:=build}"; then result=PASS; else result="FAIL: see above"; fi
echo "tests/docs/test_layout.sh:0:the_library_keeps_its_layout:$result"
echo "1 Tests $([ "$result" = PASS ]; echo $?) Failures 0 Ignored"
[ "$result" = PASS ]
