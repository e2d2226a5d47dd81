#!/bin/sh
# What the page's module links with, compiled to WebAssembly from Debian's sources into DIR: expat and zlib.
#   tools/build/page.sh DIR
set -eu
tools=$(cd "${0%/*}" && pwd)
mkdir -p "$1"
cd "$1"
. "$tools/cross.sh"
unpack expat
unpack zlib
echo "page expat, zlib"
compile() {
    clang-16 --target=wasm32-wasi -O2 -w -c "$@"
}
mkdir -p include config
# neither an environment nor a clock: names are hashed with a fixed seed, and a file has a bound of bytes
cat >config/expat_config.h <<'END'
#include <stdlib.h>
#include <sys/time.h>
#define getenv(name) ((char *)0)
#define gettimeofday(time, zone) ((time)->tv_usec = 1, 0)
END
for file in xmlparse xmltok xmlrole; do
    compile -DXML_POOR_ENTROPY -DXML_NS -DXML_DTD=1 -DXML_CONTEXT_BYTES=1024 -DBYTEORDER=1234 -Iconfig \
        "$(ls expat/expat/lib/$file.c expat/lib/$file.c 2>/dev/null)" -o "$file.o"
done
cp "$(ls -d expat/expat/lib expat/lib 2>/dev/null | head -n 1)"/expat*.h zlib/zlib.h zlib/zconf.h include
for file in adler32 compress crc32 deflate inflate inffast inftrees trees zutil; do
    compile -Izlib "zlib/$file.c" -o "$file.o"
done
wasm-ld-16 -r xml*.o adler32.o compress.o crc32.o deflate.o inflate.o inffast.o inftrees.o trees.o zutil.o -o parts.o
