#!/bin/sh
# A compiler whose programs load on old Linux systems, and Debian's libraries for another machine: the C library of Debian 11, version
# 2.31 (Ubuntu 20.04 has the same), the C++ run time of its GCC, ODE, expat, zlib, and the PACKAGEs named, unpacked in FOLDER/root, not installed; FOLDER/bin has
# the compiler of this system, MACHINE-linux-gnu-gcc and -g++, that takes headers and libraries from there. A newer run time
# would ask for functions that an older C library lacks (arc4random, _dl_find_object).
#   tools/build/root.sh FOLDER amd64|arm64 [PACKAGE...]
set -eu
folder=$1 arch=$2
shift 2
case $arch in amd64) machine=x86_64-linux-gnu ;; arm64) machine=aarch64-linux-gnu ;; esac
! grep -qxF -e "$*" "$folder/root/packages" 2>/dev/null || exit 0
rm -rf "$folder/root" "$folder/bin"
mkdir -p "$folder/apt/lists/partial" "$folder/apt/cache/archives/partial" "$folder/packages" "$folder/bin"
cd "$folder"

echo "root $arch, glibc 2.31"
mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Component: main' | grep -v security | head -n 1)
key=$(ls /usr/share/keyrings/debian-archive-keyring.* 2>/dev/null | head -n 1)
echo "deb [arch=$arch${key:+ signed-by=$key}] $mirror bullseye main" >apt/sources.list
: >apt/status
options="-q -o APT::Architectures::=amd64 -o APT::Architectures::=arm64 -o APT::Sandbox::User=$(id -un) -o Dir::Etc::SourceList=$PWD/apt/sources.list
    -o Dir::Etc::SourceParts=- -o Dir::State=$PWD/apt -o Dir::State::Status=$PWD/apt/status -o Dir::Cache=$PWD/apt/cache"
(apt-get $options update && cd packages &&
    apt-get $options download $(printf "%s:$arch " libc6 libc6-dev linux-libc-dev libcrypt1 libgcc-10-dev libstdc++-10-dev libode-dev libexpat1-dev zlib1g-dev "$@")
) >apt.log 2>&1 || { tail -n 3 "$PWD/apt.log" >&2; exit 1; }
for package in packages/*.deb; do
    dpkg-deb -x "$package" root.new
done
# links to shared libraries are absolute
find root.new -type l -lname '/*' | while read -r link; do
    ln -sf "$PWD/root$(readlink "$link")" "$link"
done

root=$PWD/root own=$($machine-gcc -print-file-name=include)
for compiler in gcc g++; do
    plus=
    [ $compiler = gcc ] || plus="-isystem $root/usr/include/c++/10 -isystem $root/usr/include/$machine/c++/10"
    cat >bin/$machine-$compiler <<END
#!/bin/sh
exec $machine-$compiler --sysroot=$root -nostdinc $plus -isystem $own -isystem $root/usr/include/$machine \\
    -isystem $root/usr/include -B$root/usr/lib/$machine/ -L$root/usr/lib/gcc/$machine/10 -L$root/usr/lib/$machine -L$root/lib/$machine "\$@"
END
    chmod +x bin/$machine-$compiler
done
rm -r apt packages
echo "$*" >root.new/packages
mv root.new root
