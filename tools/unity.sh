#!/bin/sh
# Fetches Unity, the test framework in C of ThrowTheSwitch, into DIR/src. Debian has no package of its own for it, but the
# source package cjson carries it in tests/unity, so apt's own client fetches and verifies it, as root or as anyone:
# a private source list and private state leave the system's lists alone.
#   tools/unity.sh DIR
set -eu
mkdir -p "$1"
dir=$(cd "$1" && pwd)

fail() {
    echo "make: $*; or set UNITY_DIR to a folder that has unity.c" >&2
    exit 1
}
command -v apt-get >/dev/null || fail "no apt-get to fetch Unity with"

# the system's mirror, release and key, whichever format its lists are in
lists=$(ls /etc/apt/sources.list /etc/apt/sources.list.d/debian.sources 2>/dev/null || true)
mirror=$(cat $lists /dev/null | grep -E '^(URIs:|deb )' | grep -oE '[a-z+]+:/[^ ]+' | head -n 1)
release=$(. /etc/os-release && echo "${VERSION_CODENAME:-stable}")
key=$(ls /usr/share/keyrings/debian-archive-keyring.* 2>/dev/null | head -n 1)

apt=$dir/apt
mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial"
echo "deb-src ${key:+[signed-by=$key]} ${mirror:-http://deb.debian.org/debian} $release main" >"$apt/sources.list"

get() {
    apt-get -qq -o Dir::Etc::SourceList="$apt/sources.list" -o Dir::Etc::SourceParts=- -o Dir::State::Lists="$apt/lists" \
        -o Dir::Cache="$apt/cache" -o APT::Sandbox::User=root "$@"
}
(cd "$apt" && get update && get source --download-only cjson) >"$dir/log" 2>&1 ||
    { tail -n 3 "$dir/log" >&2 && fail "could not fetch Unity (source package cjson from ${mirror:-deb.debian.org})"; }
tar -xzf "$apt"/cjson_*.orig.tar.gz -C "$dir" --strip-components 3 --wildcards \
    '*/tests/unity/src/unity*' '*/tests/unity/examples/unity_config.h' '*/tests/unity/docs/license.txt' ||
    fail "the source package cjson no longer has Unity in tests/unity"
rm -rf "$apt"
