#!/bin/sh
# Puts the MIDI and MusicXML files of packages, none of which is installed, flat into FOLDER: of the games openttd-openmsx and freedoom
# (Debian), and of the corpus of music21 (PyPI).
#   tools/research/music/fetch.sh FOLDER
set -eu
mkdir -p "$1"
tests/midi/fetch.sh "$1/packages" >/dev/null
cd "$1"
[ -f packages/music21.done ] || {
    pip -q download --no-deps -d packages music21==10.5.1
    touch packages/music21.done
}
python3 - <<'END'
import glob, os, struct, zipfile
for path in glob.glob("packages/openttd-openmsx/**/*.mid", recursive=True):
    open(os.path.basename(path), "wb").write(open(path, "rb").read())
for path in glob.glob("packages/freedoom/**/*.wad", recursive=True):
    data = open(path, "rb").read()
    count, directory = struct.unpack("<II", data[4:12])
    for i in range(count):
        at, size, name = struct.unpack("<II8s", data[directory + 16 * i:directory + 16 * i + 16])
        if data[at:at + 4] == b"MThd":
            open(name.rstrip(b"\0").decode().lower() + ".mid", "wb").write(data[at:at + size])
with zipfile.ZipFile(glob.glob("packages/music21-*.whl")[0]) as wheel:
    for name in wheel.namelist():
        if name.startswith("music21/corpus/bach/"):
            open(os.path.basename(name), "wb").write(wheel.read(name))
END
