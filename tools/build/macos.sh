#!/bin/sh
# What the build for macOS needs, into DIR: a compiler that has Apple's free headers and the names of its libraries (zig's, from PyPI),
# as DIR/bin/cc and c++, and ODE, libsndfile and expat, crossed from Debian's sources into DIR/root.
#   tools/build/macos.sh DIR
set -eu
tools=$(cd "${0%/*}" && pwd)
mkdir -p "$1/bin"
cd "$1"
. "$tools/cross.sh"

if [ ! -d zig ]; then
    python3 -m venv zig.new
    zig.new/bin/pip -q install ziglang==0.13.0
    mv zig.new zig
fi
zig=$(ls "$PWD"/zig/lib/python3*/site-packages/ziglang/zig)
for name in cc c++ ar ranlib; do
    target=
    case $name in c*) target="-target aarch64-macos.11.0" ;; esac
    cat >bin/$name <<END
#!/bin/sh
[ "\${1:-}" != -dumpmachine ] || { echo arm64-apple-darwin20; exit; }
exec "$zig" $name $target "\$@"
END
    chmod +x bin/$name
done
# headers of Apple's, or with a capital, that ODE's stop watch takes
mkdir -p names/CoreServices names/ode
echo '#include <ode/timer.h>' >names/ode/Timer.h
cat >names/CoreServices/CoreServices.h <<END
#include <sys/time.h>
typedef struct UnsignedWide { unsigned hi, lo; } UnsignedWide;
static inline void Microseconds(UnsignedWide *now)
{
    struct timeval t;
    gettimeofday(&t, 0);
    unsigned long long all = t.tv_sec * 1000000ull + t.tv_usec;
    now->hi = all >> 32, now->lo = (unsigned)all;
}
END
cross_libraries -DCMAKE_C_FLAGS=-w -DCMAKE_CXX_FLAGS="-w -I$PWD/names" -DCMAKE_SYSTEM_NAME=Darwin -DCMAKE_C_COMPILER="$PWD/bin/cc" \
    -DCMAKE_CXX_COMPILER="$PWD/bin/c++" -DCMAKE_AR="$PWD/bin/ar" -DCMAKE_RANLIB="$PWD/bin/ranlib" -DCMAKE_INSTALL_NAME_TOOL=true \
    -DCMAKE_OSX_SYSROOT= -DCMAKE_SYSTEM_PROCESSOR=arm64 -DCMAKE_FIND_ROOT_PATH="$PWD/root"
# not by its CMakeLists.txt, which wants a file for Windows that Debian leaves out; and a Mac is no longer one without fdopen
if [ ! -e root/lib/libz.a ]; then
    unpack zlib
    echo "cross zlib"
    (cd zlib && ../bin/cc -O2 -w -DHAVE_UNISTD_H -Dfdopen=fdopen -c ./*.c && cp zlib.h zconf.h ../root/include && ../bin/ar rcs ../root/lib/libz.a ./*.o)
    rm -r zlib
fi
