#!/bin/sh
# The installed library as its users meet it: the examples of docs/examples are built with the flags of pkg-config, in C against the
# shared library, against the static one, and in C++; they run and do what they say.
: "${HIMC_BUILD:=build}" "${CC:=gcc}" "${CXX:=g++}"
dir=$(pwd)/$HIMC_BUILD/tests/examples
tests=0
failures=0
rm -rf "$dir"
mkdir -p "$dir"

# check NAME CONDITION... ; prints the line that Unity would
check() {
    name=$1
    shift
    tests=$((tests + 1))
    if "$@"; then
        echo "tests/test_examples.sh:0:$name:PASS"
    else
        failures=$((failures + 1))
        echo "tests/test_examples.sh:0:$name:FAIL: not so: $*"
    fi
}
quiet() {
    "$@" >"$dir/log" 2>&1 || { cat "$dir/log" >&2; false; }
}
# sounds RAW: the samples are finite and some are louder than 0.001
sounds() {
    od -An -v -t f4 -w4 "$1" | awk '/nan|inf/ {bad = 1} {v = $1 < 0 ? -$1 : $1; if (v > m) m = v} END {exit bad || m < 0.001 || m > 1000}'
}

prefix=$dir/usr
check test_install_succeeds quiet make -s install BUILD="$HIMC_BUILD" PREFIX="$prefix" PDEXTRA="$prefix/pd"
# the same without the shared library, for static linking
cp -r "$prefix" "$dir/static"
rm "$dir"/static/lib/libhimc.so*
sed -i "s|$prefix|$dir/static|" "$dir/static/lib/pkgconfig/himc.pc"

flags() {
    PKG_CONFIG_PATH=$dir/$1/lib/pkgconfig pkg-config $2 --cflags --libs himc
}
build() { # PROGRAM COMPILER... : from hello.c, target.c or drum.c
    program=$1
    shift
    quiet "$@" -Wall -Wextra -Wpedantic -Werror "docs/examples/${program%%-*}.c" -o "$dir/$program" $link
}
link="$(flags usr) -lm -Wl,-rpath,$prefix/lib"
for program in hello target drum; do
    check test_${program}_builds_with_the_shared_library build $program "$CC" -std=c17
done
check test_hello_builds_as_cxx build hello-cxx "$CXX" -x c++ -std=c++17
link="$(flags static --static) -lm"
check test_hello_builds_with_the_static_library build hello-static "$CC" -std=c17
check test_hello_builds_as_cxx_with_the_static_library build hello-cxx-static "$CXX" -x c++ -std=c++17

strokes=$(grep -c '"stroke [^"]*"' docs/examples/hello.c)
strokes=$(grep -o '"stroke [^"]*"' docs/examples/hello.c | wc -l)
for program in hello hello-cxx hello-static hello-cxx-static; do
    "$dir/$program" >"$dir/$program.raw" 2>"$dir/$program.strikes"
    check "test_$(echo $program | tr - _)_reports_a_strike_for_each_stroke" [ "$(grep -c ' N$' "$dir/$program.strikes")" = "$strokes" ]
    check "test_$(echo $program | tr - _)_sounds" sounds "$dir/$program.raw"
done
check test_hello_is_the_same_however_it_is_linked cmp "$dir/hello.raw" "$dir/hello-cxx-static.raw"
needs=$(ldd "$dir/hello-static" | grep -c libhimc)
check test_hello_static_needs_no_shared_himc [ "$needs" = 0 ]
check test_hello_needs_the_major_version [ "$(ldd "$dir/hello" | grep -c 'libhimc\.so\.0 ')" = 1 ]

off=$("$dir/target" | sed -n 's/^tip within \([0-9.]*\) mm.*/\1/p')
check test_target_is_followed_within_20_mm [ "$(echo "$off" | awk '{print $1 > 0 && $1 < 20}')" = 1 ]
"$dir/drum" >"$dir/drum.raw" 2>"$dir/drum.blow"
check test_drum_reports_its_blow grep -qE '^[0-9]+ N for [0-9.]+ ms$' "$dir/drum.blow"
check test_drum_sounds sounds "$dir/drum.raw"

# each public header alone, as C and as C++
for header in lib/himc/*.h; do
    name=$(basename "$header" .h)
    echo "#include <himc/$name.h>" >"$dir/$name.c"
    check "test_${name}_h_is_c_by_itself" quiet "$CC" -std=c17 -Wall -Wextra -Wpedantic -Werror $(flags usr) -fsyntax-only "$dir/$name.c"
    check "test_${name}_h_is_cxx_by_itself" quiet "$CXX" -x c++ -std=c++17 -Wall -Wextra -Wpedantic -Werror $(flags usr) -fsyntax-only "$dir/$name.c"
done

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
