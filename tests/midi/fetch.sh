#!/bin/sh
# Puts the MIDI files of two Debian packages, games that are not installed, into FOLDER and prints their names.
#   tests/midi/fetch.sh FOLDER
set -eu
mkdir -p "$1"
cd "$1"
for package in freedoom openttd-openmsx; do
    [ -d "$package" ] && continue
    apt-get -qq -o APT::Sandbox::User=root download "$package" >&2
    dpkg -x "$package"_*.deb "$package.new"
    mv "$package.new" "$package"
done
find "$PWD" -name '*.mid' -o -name '*.wad' | sort
