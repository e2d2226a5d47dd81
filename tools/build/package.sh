#!/bin/sh
# The package that Pure Data's package manager installs: one folder, himc, zipped, with binaries for Linux, on amd64 with samples of 32
# and of 64 bits and on arm64, and for Windows; beside it a checksum, and the list of objects by which the manager's search finds them. Its
# name tells the machines (Deken's file names, version 1).
#   tools/build/package.sh BUILD VERSION
set -eu
build=$1 version=$2
name="himc[v$version](Linux-amd64-32)(Linux-amd64-64)(Linux-arm64-32)(Windows-amd64-32).dek"
# for a player; what is for developers stays with the sources
docs="start manual pd panel osc viewer scene model glossary"
stage=$build/package himc=$build/package/himc
rm -rf "$stage"
mkdir -p "$himc/clips" "$himc/docs"
cp LICENSE LIBRARIES.txt README.md "$build"/linux/externals/himc/*.pd "$build"/linux/externals-64/himc/*.so "$build"/arm64/externals/himc/*.l_arm64 \
    "$build"/windows/externals/himc/*.m_amd64 patches/techniques/* "$himc"
# by the ending that each Pd looks for first: on arm64 it would take .pd_linux for its own, and .linux-arm64-32.so is unknown before 0.54
for object in "$build"/linux/externals/himc/*.pd_linux; do
    cp "$object" "$himc/$(basename "$object" .pd_linux).l_amd64"
done
cp -r patches "$himc/patches"
rm -r "$himc/patches/techniques"
cp "$build"/clips/* "$himc/clips"
for page in $docs; do
    cp "docs/$page.md" "$himc/docs"
done
strip --strip-unneeded "$himc"/*.l_amd64 "$himc"/*.linux-amd64-64.so
aarch64-linux-gnu-strip --strip-unneeded "$himc"/*.l_arm64
x86_64-w64-mingw32-strip --strip-unneeded "$himc"/*.m_amd64

# technique~ is beside the objects here
sed -i 's|techniques/technique~|technique~|' "$himc/patches/performance.pd"
sed -i 's|(\.\./patches/techniques/|(../|' "$himc/docs/pd.md"
# links to pages that are not in the package become their words, pictures go
for page in "$himc"/*.md "$himc"/docs/*.md; do
    awk -v folder="${page%/*}" '{
        done = ""
        while (match($0, /!?\[[^]]*\]\([^) ]*\)/)) {
            link = substr($0, RSTART, RLENGTH); before = substr($0, 1, RSTART - 1); $0 = substr($0, RSTART + RLENGTH)
            cut = index(link, "]("); target = substr(link, cut + 2, length(link) - cut - 2); sub(/#.*/, "", target)
            if (target != "" && target !~ /^https?:/ && system("test -e \"" folder "/" target "\""))
                link = link ~ /^!/ ? "" : substr(link, 2, cut - 2)
            done = done before link
        }
        print done $0
    }' "$page" >"$stage/page" && mv "$stage/page" "$page"
done

for help in "$himc"/*-help.pd; do
    printf '%s\t%s\n' "$(basename "$help" -help.pd)" "$(sed -n 's/^#X text [0-9]* [0-9]* DESCRIPTION \(.*\), f [0-9]*;$/\1/; T; s/ \\,/,/g; p' "$help")"
done >"$stage/$name.txt"
(cd "$stage" && zip -q -9 -r -X "$name" himc && sha256sum "$name" >"$name.sha256")
ls -l "$stage"/*.dek | awk '{ printf "%.1f MB  ", $5 / 1e6 }'
echo "$stage/$name"
