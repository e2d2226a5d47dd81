#!/bin/sh
# What the build for Windows links with, crossed from Debian's sources into DIR/root: ODE, libsndfile (WAV, AIFF and AU alone) and
# expat, and an import library for what m_pd.h declares of Pd's pd.dll. With `pd` as second word also Pd itself, without a window and a sound
# card, in DIR/pd/bin, to try the externals in.
#   tools/build/windows.sh DIR [pd]
set -eu
tools=$(cd "${0%/*}" && pwd)
mkdir -p "$1"
cd "$1"
machine=x86_64-w64-mingw32
. "$tools/cross.sh"

# a name that ODE's sources write with a capital, which matters here alone
mkdir -p names
echo '#include <windows.h>' >names/Windows.h
cross_libraries -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER=$machine-gcc -DCMAKE_CXX_COMPILER=$machine-g++ \
    -DCMAKE_FIND_ROOT_PATH=/usr/$machine -DCMAKE_CXX_FLAGS="-I$PWD/names"

# the functions and variables of pd.dll that its headers declare, for the linker
{
    echo EXPORTS
    # a declaration is a record; a function's name stands before the first parenthesis, variables have none
    sed 's|/\*.*\*/||; /^#/d' /usr/include/pd/m_pd.h /usr/include/pd/m_imp.h /usr/include/pd/g_canvas.h | awk -v RS=';' '
        !match($0, /EXTERN /) { next }
        { rest = substr($0, RSTART + 7) }
        match(rest, /[a-z_0-9]+[ \n]*\(/) { print substr(rest, RSTART, RLENGTH - 1); next }
        { sub(/^[a-z_0-9]+/, "", rest); gsub(/[* \n]|\[.*\]/, "", rest); gsub(/,/, " DATA\n", rest); print rest " DATA" }' |
        sort -u
} >pd.def
$machine-dlltool -d pd.def -D pd.dll -l root/lib/pd.dll

[ "${2:-}" = pd ] && [ ! -e pd/bin/pd.com ] || exit 0
unpack puredata
echo "cross puredata"
mkdir -p pd/bin pd/objects
# the sources that Pd's own makefile for this compiler names, without those of sound cards
sed -n '/^SRC = /,/^$/p' puredata/src/makefile.mingw | grep -oE '[a-z_0-9]+\.c' | sort -u >pd/sources
{
    xargs -n 1 -P "$(nproc)" sh -c "$machine-gcc -O2 -w -DPD -DPD_INTERNAL -DUSEAPI_DUMMY -DWINVER=0x0601 -mms-bitfields \
        -DPD_LONGINTTYPE=__int64 '-DINSTALL_PREFIX=\"/\"' '-DWISH=\"wish.exe\"' -c puredata/src/\$0 -o pd/objects/\$0.o" &&
        $machine-gcc -shared -static $(sed 's|.*|pd/objects/&.o|' pd/sources | grep -v s_entry) pd/objects/s_audio_dummy.c.o \
            pd/objects/s_midi_dummy.c.o -o pd/bin/pd.dll -lws2_32 -lwinmm -lole32 -lpthread -Wl,--export-all-symbols \
            -Wl,--out-implib=pd/pd.a &&
        $machine-gcc -static pd/objects/s_entry.c.o pd/pd.a -o pd/bin/pd.com
} >pd.log 2>&1 <<END || { tail -n 5 "$PWD/pd.log" >&2; exit 1; }
$(cat pd/sources) s_audio_dummy.c s_midi_dummy.c
END
rm -r puredata
