#!/bin/sh
# What the build for Windows links with, crossed from Debian's sources into DIR/root: ODE and libsndfile (WAV, AIFF and AU alone), and
# an import library for what m_pd.h declares of Pd's pd.dll. With `pd` as second word also Pd itself, without a window and a sound
# card, in DIR/pd/bin, to try the externals in.
#   tools/windows.sh DIR [pd]
set -eu
tools=$(cd "${0%/*}" && pwd)
mkdir -p "$1"
cd "$1"
cross=x86_64-w64-mingw32
jobs=-j$(nproc)

# the newest source of a package, unpacked into a folder of its name
unpack() {
    [ ! -d "$1" ] || return 0
    "$tools/source.sh" "$1" "sources/$1"
    mkdir "$1.new"
    tar -xaf sources/"$1"/*.orig.tar.* -C "$1.new" --strip-components 1
    mv "$1.new" "$1"
}

# with_cmake PACKAGE LIBRARY OPTION...
with_cmake() {
    package=$1 library=$2
    shift 2
    [ ! -e "root/lib/$library" ] || return 0
    unpack "$package"
    echo "cross $package"
    { cmake -S "$package" -B "$package/cross" -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_C_COMPILER=$cross-gcc \
        -DCMAKE_CXX_COMPILER=$cross-g++ -DCMAKE_FIND_ROOT_PATH=/usr/$cross -DCMAKE_FIND_ROOT_PATH_MODE_PROGRAM=NEVER \
        -DCMAKE_FIND_ROOT_PATH_MODE_LIBRARY=ONLY -DCMAKE_FIND_ROOT_PATH_MODE_INCLUDE=ONLY -DCMAKE_BUILD_TYPE=Release \
        -DBUILD_SHARED_LIBS=OFF -DCMAKE_INSTALL_PREFIX="$PWD/root" "$@" && cmake --build "$package/cross" $jobs -t install; } \
        >"$package.log" 2>&1 || { tail -n 5 "$PWD/$package.log" >&2; exit 1; }
}

# a name that ODE's sources write with a capital, which matters here alone
mkdir -p names
echo '#include <windows.h>' >names/Windows.h
with_cmake ode libode.a -DCMAKE_CXX_FLAGS="-I$PWD/names" -DODE_DOUBLE_PRECISION=ON -DODE_WITH_DEMOS=OFF -DODE_WITH_TESTS=OFF \
    -DODE_WITH_LIBCCD=OFF -DODE_WITH_GIMPACT=OFF -DODE_WITH_OPCODE=OFF
cp root/lib/libode_doubles.a root/lib/libode.a
with_cmake libsndfile libsndfile.a -DBUILD_PROGRAMS=OFF -DBUILD_EXAMPLES=OFF -DBUILD_TESTING=OFF -DENABLE_EXTERNAL_LIBS=OFF \
    -DENABLE_MPEG=OFF

# the functions and variables of pd.dll that its headers declare, for the linker
{
    echo EXPORTS
    # a declaration is a record; a function's name stands before the first parenthesis, variables have none
    sed 's|/\*.*\*/||; /^#/d' /usr/include/pd/m_pd.h /usr/include/pd/g_canvas.h | awk -v RS=';' '
        !match($0, /EXTERN /) { next }
        { rest = substr($0, RSTART + 7) }
        match(rest, /[a-z_0-9]+[ \n]*\(/) { print substr(rest, RSTART, RLENGTH - 1); next }
        { sub(/^[a-z_0-9]+/, "", rest); gsub(/[* \n]|\[.*\]/, "", rest); gsub(/,/, " DATA\n", rest); print rest " DATA" }' |
        sort -u
} >pd.def
$cross-dlltool -d pd.def -D pd.dll -l root/lib/pd.dll

[ "${2:-}" = pd ] && [ ! -e pd/bin/pd.com ] || exit 0
unpack puredata
echo "cross puredata"
mkdir -p pd/bin pd/objects
# the sources that Pd's own makefile for this compiler names, without those of sound cards
sed -n '/^SRC = /,/^$/p' puredata/src/makefile.mingw | grep -oE '[a-z_0-9]+\.c' | sort -u >pd/sources
{
    xargs -n 1 -P "$(nproc)" sh -c "$cross-gcc -O2 -w -DPD -DPD_INTERNAL -DUSEAPI_DUMMY -DWINVER=0x0601 -mms-bitfields \
        -DPD_LONGINTTYPE=__int64 '-DINSTALL_PREFIX=\"/\"' '-DWISH=\"wish.exe\"' -c puredata/src/\$0 -o pd/objects/\$0.o" &&
        $cross-gcc -shared -static $(sed 's|.*|pd/objects/&.o|' pd/sources | grep -v s_entry) pd/objects/s_audio_dummy.c.o \
            pd/objects/s_midi_dummy.c.o -o pd/bin/pd.dll -lws2_32 -lwinmm -lole32 -lpthread -Wl,--export-all-symbols \
            -Wl,--out-implib=pd/pd.a &&
        $cross-gcc -static pd/objects/s_entry.c.o pd/pd.a -o pd/bin/pd.com
} >pd.log 2>&1 <<END || { tail -n 5 "$PWD/pd.log" >&2; exit 1; }
$(cat pd/sources) s_audio_dummy.c s_midi_dummy.c
END
