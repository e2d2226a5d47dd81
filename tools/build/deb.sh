#!/bin/sh
# Debian packages of the files under version control, in BUILD/debian, as lintian likes them.
#   tools/build/deb.sh BUILD
set -eu
dir=$1/debian
rm -rf "$dir"
mkdir -p "$dir/himc"
git ls-files -z | tar -c --null -T - | tar -x -C "$dir/himc"
(cd "$dir/himc" && dpkg-buildpackage -us -uc) >"$dir/log" 2>&1 || { tail -n 10 "$dir/log" >&2; exit 1; }
rm -r "$dir/himc"
lintian --fail-on error,warning --suppress-tags bad-distribution-in-changes-file "$dir"/himc_*.changes
ls -l "$dir"/*.deb | awk '{ printf "%.1f MB  %s\n", $5 / 1e6, $NF }'
