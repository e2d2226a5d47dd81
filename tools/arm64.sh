#!/bin/sh
# Debian's libraries for arm64, unpacked beside the build, not installed: packages of two machines with one header do not stand on one
# system.
#   tools/arm64.sh FOLDER
set -eu
mkdir -p "$1/lists/partial" "$1/packages"
cd "$1"
[ ! -e root/usr/lib/aarch64-linux-gnu/libz.a ] || exit 0
options="-q -o APT::Architectures::=$(dpkg --print-architecture) -o APT::Architectures::=arm64 -o Dir::State::lists=$PWD/lists \
    -o APT::Sandbox::User=$(id -un)"
apt-get $options update >apt.log 2>&1
cd packages
for package in libode-dev libode8 libccd2 libsndfile1-dev libsndfile1 libflac12 libvorbis0a libvorbisenc2 libopus0 libogg0 libmpg123-0 libmp3lame0 zlib1g-dev zlib1g; do
    apt-get $options download "$package:arm64" >>../apt.log 2>&1 || { cat ../apt.log >&2; exit 1; }
done
for package in *.deb; do
    dpkg-deb -x "$package" ../root
done
