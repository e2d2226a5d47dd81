#!/bin/sh
# Fetches Unity, the test framework in C of ThrowTheSwitch, into DIR/src. Debian has no package of its own for it, but the
# source package cjson carries it in tests/unity.
#   tools/build/unity.sh DIR
set -eu
hint() {
    echo "make: $*; or set UNITY_DIR to a folder that has unity.c" >&2
    exit 1
}
"${0%/*}/source.sh" cjson "$1" || hint "no Unity"
tar -xzf "$1"/cjson_*.orig.tar.gz -C "$1" --strip-components 3 --wildcards \
    '*/tests/unity/src/unity*' '*/tests/unity/examples/unity_config.h' '*/tests/unity/docs/license.txt' ||
    hint "the source package cjson no longer has Unity in tests/unity"
