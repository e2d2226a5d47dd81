#!/bin/sh
# Downloads a source package of Debian into DIR, by apt's own client, which verifies it, as root or as anyone: a private source list
# and private state leave the system's lists alone.
#   tools/build/source.sh PACKAGE DIR
set -eu
package=$1
mkdir -p "$2"
dir=$(cd "$2" && pwd)

fail() {
    echo "make: could not fetch the source package $package: $*" >&2
    exit 1
}
command -v apt-get >/dev/null || fail "no apt-get"

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
(cd "$dir" && get update && get source --download-only "$package") >"$dir/$package.log" 2>&1 ||
    { tail -n 3 "$dir/$package.log" >&2 && fail "from ${mirror:-deb.debian.org}"; }
rm -rf "$apt"
