#!/bin/sh
# Looks at the sources as a reviewer would, after a build with warnings as errors. Exit status 1 if anything must change.
#   tools/build/lint.sh BUILD FILE...
# Without files only what takes a second and needs no other program (tests/docs/test_layout.sh).
build=$1
shift
faults=0
check() {
    echo "lint: $1"
    shift
    "$@" || faults=$((faults + 1))
}

# none GREP...: it finds nothing; that it cannot look is a fault
none() {
    "$@"
    [ $? = 1 ]
}
no_stray_whitespace() {
    none git grep --untracked -nIE '[[:blank:]]+$|^ *	' -- . ':!Makefile' ':!*/Makefile' ':!*.mk' ':!debian/rules' ':!*.pd' ':!docs/figures/*.svg' ':!mocap' ':!tests/fuzz/corpus'
}
prefixed_symbols() {
    nm -g --defined-only "$build/libhimc.a" | awk 'NF == 3 && $3 !~ /^(himc_|_Z.*10himc_eigen|_ZTI|_ZTS|DW\.ref\.)/ { print "no himc_ prefix: " $3; bad = 1 } END { exit bad }'
}
rooms() {
    nm -A -g $(ls lib/src/*/*.c lib/src/*/*.cpp mocap/*.c tools/himc/*.c | grep -v mocap/generate |
        sed "s|^lib/src/|lib/|; s|^mocap/|mocap-o/|; s|^\(.*\)\.c[p]*$|$build/\1.o|") |
        awk -f tools/build/rooms.awk - lib/himc/*.h lib/src/*/*.[ch] mocap/*.[ch] tools/himc/*.[ch]
}
door() {
    awk -f tools/build/door.awk lib/himc/*.h lib/src/*/*.[ch] tools/himc/*.[ch] tools/research/*/*.[ch] mocap/*.[ch] viewer/*.[ch] \
        pd-externals/*.[ch] docs/examples/*.c python/himc/*.c
}
one_opener() {
    none git grep --untracked -nE '\<(fopen|open|openat|creat|sf_open|canvas_open|sys_open)\(' -- 'lib/*.c' 'tools/*.c' 'viewer/*.c' 'pd-externals/*.c' \
        ':!lib/src/base/file.c' ':!lib/src/system/files.c'
}
# the shared library shows the functions of the public headers and nothing else
shared_symbols() {
    nm -D --defined-only "$build"/libhimc.so.* | sed 's/.* //' | sort >"$build/shown"
    sed 's|//.*||' lib/himc/*.h | grep -E '^[a-zA-Z].*himc_[a-z0-9_]+\(' | grep -vE '^(static|HIMC_RT static|typedef)' |
        sed -E 's/.*[ *](himc_[a-z0-9_]+)\(.*/\1/' | sort >"$build/declared"
    diff "$build/declared" "$build/shown"
}

sizes() {
    find lib tools pd-externals viewer mocap tests -name '*.[ch]' -o -name '*.cpp' | LC_ALL=C sort | LC_ALL=C xargs awk -f tools/build/sizes.awk
}

check "includes and calls between rooms and files; who knows which library" rooms
check "the public headers" door
check "symbols of the shared library" shared_symbols
check "names the library shows its host" prefixed_symbols
check "files are opened by base/file.c and system/files.c alone" one_opener
check "sizes" sizes
check "what is excused among mutants" tests/mutants/mutants.py --check
if [ $# -gt 0 ]; then
    check "stray blanks and tabs" no_stray_whitespace
    check "layout (make format mends it)" clang-format --dry-run -Werror "$@"
    check "cppcheck" cppcheck -q -j2 --std=c11 --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
        --suppress=uninitvar --suppress=legacyUninitvar --suppress=missingInclude --suppress=checkersReport -Ilib -Ilib/src -I. \
        lib/src tools mocap pd-externals
fi

[ $faults = 0 ] && echo "lint: clean"
[ $faults = 0 ]
