#!/bin/sh
# Looks at the sources as a reviewer would, after a build with warnings as errors. Exit status 1 if anything must change.
#   tools/lint.sh LIBRARY.a FILE...
library=$1
shift
faults=0
check() {
    echo "lint: $1"
    shift
    "$@" || faults=$((faults + 1))
}

no_stray_whitespace() {
    ! git grep --untracked -nIE '[[:blank:]]+$|^ *	' -- . ':!Makefile' ':!*/Makefile' ':!*.mk' ':!*.pd' ':!docs/figures/*.svg' ':!mocap'
}
prefixed_symbols() {
    nm -g --defined-only "$library" | awk 'NF == 3 && $3 !~ /^himc_/ { print "no himc_ prefix: " $3; bad = 1 } END { exit bad }'
}

check "layout (make format mends it)" clang-format --dry-run -Werror "$@"
check "stray blanks and tabs" no_stray_whitespace
check "the rooms and who knows what" awk -f tools/rooms.awk "$@"
check "names the library shows its host" prefixed_symbols
check "cppcheck" cppcheck -q -j2 --std=c11 --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
    --suppress=uninitvar --suppress=legacyUninitvar --suppress=missingInclude --suppress=checkersReport -Ilib lib/src tools pd-externals
check "sizes" awk -f tools/sizes.awk "$@"

[ $faults = 0 ] && echo "lint: clean"
[ $faults = 0 ]
