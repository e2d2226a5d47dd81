#!/bin/sh
# Installs the Debian packages of the given lists that are missing. Silent and instant if there are none.
#   tools/build/deps.sh LIST...
set -eu

if ! command -v dpkg-query >/dev/null; then
    echo "make deps: not a Debian system; install what $* name by hand, then use make check" >&2
    exit 1
fi

wanted=$(sed 's/#.*//' "$@")
present=$(dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' $wanted 2>/dev/null | sed -n 's/^ii *//p')
missing=
for package in $wanted; do
    echo "$present" | grep -qx "$package" || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" = 0 ]; then
    root=
elif command -v sudo >/dev/null; then
    root=sudo
else
    echo "make deps: missing, and neither root nor sudo to install it: apt-get install$missing" >&2
    exit 1
fi

mkdir -p build
log=build/deps.log
start=$(date +%s)
echo "installing$missing"
install() {
    $root apt-get -qq update &&
        $root env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends install $missing
}
if ! install >$log 2>&1; then
    tail -n 5 $log >&2
    echo "make deps: apt-get failed; the whole of what it said is in $log" >&2
    exit 1
fi
echo "installed in $(($(date +%s) - start)) s"
