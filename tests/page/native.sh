#!/bin/sh
# Builds tests/page/play.c twice: as usual, and as WebAssembly has it, with musl's libm and with Eigen's sums in their
# plain order, without vectors.
#   tests/page/native.sh OUT-DIR         writes play and, where musl-tools are, play-musl
: "${HIMC_BUILD:=build}" "${CC:=gcc}" "${CXX:=g++}"
out=$1
mkdir -p "$out"
build() {
    "$CC" -std=c17 -O2 -ffp-contract=off -I. -Ilib -Ilib/src -Iviewer -I"$HIMC_BUILD/viewer" tests/page/play.c viewer/engine/engine.c \
        viewer/scene.c viewer/scene_encode.c tools/himc/live.c tools/himc/cli.c tools/himc/file.c \
        -Wl,--start-group "$@" "$HIMC_BUILD/libhimc.a" -Wl,--end-group -Wl,--as-needed -lode -lexpat -lz -lstdc++ -lpthread -lm
}
build -o "$out/play" || exit 1
musl=$(ls /usr/lib/*-linux-musl/libc.a 2>/dev/null | head -n 1)
[ -n "$musl" ] || exit 0
# the members of musl's archive that come from its folder math
members=$(ar t "$musl" | grep -xE '(__)?(a?(sin|cos|tan)h?|atan2|sincos|rem_pio2|rem_pio2_large|exp|exp2|exp10|expm1|expo2|log|log2|log10|log1p|pow|hypot|cbrt|fmod|lgamma|lgamma_r|tgamma|erf|j[01n]|math_[a-z]*|exp_data|log_data|log2_data|pow_data|signgam|polevl|scalbn)\.l?o')
(cd "$out" && rm -f libmusl-math.a && ar x "$musl" $members && ar rcs libmusl-math.a $members && rm -f $members) || exit 1
"$CXX" -std=c++17 -O3 -fno-math-errno -fno-trapping-math -ffp-contract=off -DEIGEN_DONT_VECTORIZE -isystem /usr/include/eigen3 -Ilib -Ilib/src \
    -c lib/src/base/linear.cpp -o "$out/linear.o" || exit 1
build "$out/linear.o" "$out/libmusl-math.a" -o "$out/play-musl"
