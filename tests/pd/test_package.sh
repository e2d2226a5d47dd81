#!/bin/sh
# The package for Pure Data, as a new user gets it: unpacked into an empty folder of externals, found by name and by path, its
# help and its patches opened from there. `make deken` runs it.
#   tests/pd/test_package.sh FILE.dek
package=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tests=0 failures=0
home=$work/home
mkdir -p "$home/.local/lib/pd/extra"

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_package.sh:0:$1:${2:+FAIL: }${2:-PASS}"
}

play() { # play PATCH [OPTION...]: what Pd says is in $work/log; its home is the new user's
    patch=$1
    shift
    (cd "$work" && HOME=$home timeout 120 "${PD:-pd}" -nogui -nrt -stderr -noaudio -nomidi -r 48000 -batch "$@" -open "$patch" \
        >"$work/log" 2>&1 </dev/null)
}

# nothing but the greeting
silent() {
    grep -v -e '^himc~ [0-9.]*$' "$work/log" | head -n 3
}

report package_is_smaller_than_10_MB "$([ "$(wc -c <"$package")" -lt 10000000 ] || wc -c <"$package")"
report checksum_agrees "$(cd "$(dirname "$package")" && sha256sum --quiet -c "$(basename "$package").sha256" 2>&1)"
report package_unpacks "$(unzip -q "$package" -d "$home/.local/lib/pd/extra" 2>&1)"
himc=$home/.local/lib/pd/extra/himc
for file in LICENSE README.md LIBRARIES.txt himc-meta.pd himc~-help.pd membrane~-help.pd technique~.pd clips/clips.txt \
    patches/01-improvisation.pd patches/lib/recorder.pd docs/manual.md; do
    report "package_has_$file" "$([ -s "$himc/$file" ] || echo "no $file")"
done

# a patch that makes both, declared or by prefix, and says what it hears of a blow
sounds() { # sounds PREFIX DECLARE
    cat >"$work/user.pd" <<EOF
#N canvas 0 0 400 300 12;
${2:+#X declare $2;
}#X obj 10 10 ${2:+declare }${2:-t b};
#X obj 10 40 $1himc~ kettle;
#X obj 10 70 $1membrane~ kettle;
#X obj 10 110 env~ 4096;
#X obj 10 140 print level;
#X obj 200 10 loadbang;
#X obj 200 40 t b b b;
#X msg 200 70 \; pd dsp 1;
#X msg 300 70 strike 0.2 0 3;
#X obj 200 110 delay 300;
#X msg 200 140 \; pd quit;
#X connect 2 0 3 0;
#X connect 3 0 4 0;
#X connect 5 0 6 0;
#X connect 6 0 9 0;
#X connect 6 1 8 0;
#X connect 6 2 7 0;
#X connect 8 0 2 0;
#X connect 9 0 10 0;
EOF
    play "$work/user.pd"
    grep -e '^error' -e 'create' "$work/log" | head -n 2
    awk '$1 == "level:" && $2 > most { most = $2 } END { if (!(most > 60)) print "loudest " most + 0 " dB" }' "$work/log"
}
report objects_are_found_where_the_patch_declares_the_library "$(sounds "" "-path himc")"
report objects_are_found_by_prefix "$(sounds himc/ "")"
for patch in "$himc"/*-help.pd "$himc"/patches/[01]*.pd "$himc"/patches/performance.pd "$himc"/patches/pieces/*.pd; do
    play "$patch" -send "pd quit"
    report "$(basename "$patch" .pd)_opens_with_nothing_to_say" "$(silent)"
done
play "$himc/patches/01-improvisation.pd" -send "himc-record $work/improvisation.wav"
report patch_01_sounds "$([ "$(wc -c <"$work/improvisation.wav" 2>/dev/null || echo 0)" -gt 4000000 ] || tail -n 2 "$work/log")"

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
