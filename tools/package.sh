#!/bin/sh
# The package that Pure Data's package manager installs: one folder, himc, zipped, with binaries for Linux, samples of 32 and of 64
# bits, and for Windows, and a checksum beside it. Its name tells the machines (Deken's file names, version 1).
#   tools/package.sh BUILD VERSION
set -eu
build=$1 version=$2
name="himc[v$version](Linux-amd64-32)(Linux-amd64-64)(Windows-amd64-32).dek"
stage=$build/package
rm -rf "$stage"
mkdir -p "$stage/himc/clips" "$stage/himc/docs"
cp LICENSE README.md "$build"/externals/himc/* "$build"/externals-64/himc/*.so "$build"/windows/externals/himc/*.m_amd64 patches/techniques/* "$stage/himc"
cp -r patches "$stage/himc/patches"
cp "$build"/clips/* "$stage/himc/clips"
cp docs/*.md "$stage/himc/docs"
cp tools/package-libraries.txt "$stage/himc/LIBRARIES.txt"
strip --strip-unneeded "$stage"/himc/*.pd_linux "$stage"/himc/*.so
x86_64-w64-mingw32-strip --strip-unneeded "$stage"/himc/*.m_amd64
rm -f "$stage"/*.dek*
(cd "$stage" && zip -q -9 -r -X "$name" himc && sha256sum "$name" >"$name.sha256")
ls -l "$stage"/*.dek | awk '{ printf "%.1f MB  ", $5 / 1e6 }'
echo "$stage/$name"
