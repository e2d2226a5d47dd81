#!/bin/sh
# STK: a bank of BiQuad resonators, and one ModalBar struck four times a second.
# Debian: libstk-dev g++. Prints `WHAT VALUE LABEL` a line; exit status 77 where it is missing.
[ -e /usr/include/stk/BiQuad.h ] && command -v g++ >/dev/null || { echo "stk: not installed" >&2; exit 77; }
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
g++ -O3 -march=native -w -I/usr/include/stk "$here/stk.cpp" -lstk -o "$work/stk" && "$work/stk"
