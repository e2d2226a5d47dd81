#!/bin/sh
# The package for Pure Data, as a new user gets it: unpacked into an empty folder of externals, found by name and by path, its
# help and its patches opened from there. `make deken` runs it.
#   tests/pd/test_package.sh FILE.dek
# With the Pd that `make test-windows` crosses, on Windows, too, by wine.
: "${HIMC_BUILD:=build}"
package=$(realpath "$1")
windows=$(realpath "$HIMC_BUILD/windows" 2>/dev/null)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tests=0 failures=0 ignored=0
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
    (cd "$work" && HOME=$home timeout 120 ${PD:-pd -nrt} -nogui -stderr -noaudio -nomidi -r 48000 -batch "$@" -open "$patch" \
        >"$work/raw" 2>&1 </dev/null; tr -d '\r' <"$work/raw" >"$work/log")
}

# nothing but the greeting
silent() {
    grep -v -e '^himc~ [0-9.]*$' "$work/log" | head -n 3
}

report package_is_smaller_than_10_MB "$([ "$(wc -c <"$package")" -lt 10000000 ] || wc -c <"$package")"
report checksum_agrees "$(cd "$(dirname "$package")" && sha256sum --quiet -c "$(basename "$package").sha256" 2>&1)"
report package_unpacks "$(unzip -q "$package" -d "$home/.local/lib/pd/extra" 2>&1)"
himc=$home/.local/lib/pd/extra/himc
for file in LICENSE README.md himc-meta.pd himc~-help.pd membrane~-help.pd technique~.pd clips/clips.txt \
    patches/01-improvisation.pd patches/lib/recorder.pd docs/manual.md; do
    report "package_has_$file" "$([ -s "$himc/$file" ] || echo "no $file")"
done

# what is in it belongs to players, is there once, and says whose it is
report no_file_is_there_twice "$(find "$himc" -type f -exec md5sum {} + | sort | awk '$1 == last { print $2 } { last = $1 }')"
for owner in "three.js authors" "Russell L. Smith" "Benoit Jacob" "GCC Runtime Library Exception" "mingw-w64 project" "Lockless"; do
    report "licences_name_$owner" "$(grep -q "$owner" "$himc/LIBRARIES.txt" || echo "not in LIBRARIES.txt")"
done
dead_links() {
    for page in "$himc"/*.md "$himc"/docs/*.md; do
        grep -oE '\]\([^)# ]+' "$page" | sed 's/^](//' | grep -v '^https\?:' | while read -r target; do
            [ -e "${page%/*}/$target" ] || echo "${page##*/}: $target"
        done
    done
}
report links_lead_somewhere "$(dead_links)"
report each_help_is_in_the_list_of_objects "$(for help in "$himc"/*-help.pd; do
    grep -q "^$(basename "$help" -help.pd)	[^ ].* " "$package.txt" || echo "$help"
done)"
report each_line_of_the_list_is_an_object "$(cut -f 1 "$package.txt" | while read -r object; do
    ls "$himc/$object".[plm]* >/dev/null 2>&1 || echo "$object"
done)"

# the binaries: of the machines in the package's name, for C libraries since 2020 (glibc 2.31), and neighbours of others
newest=2.31
export LC_ALL=C
pd_names=$work/pd_names
nm -D --defined-only "$(command -v pd)" | awk '{ print $3 }' | sort >"$pd_names"
linux_fault() { # linux_fault FILE: what keeps it from being loaded
    needs=$(objdump -T "$1" 2>/dev/null | grep -o 'GLIBC_[0-9.]*' | sed 's/GLIBC_//' | sort -V | tail -n 1)
    [ "$(printf '%s\n' "$needs" $newest | sort -V | tail -n 1)" = $newest ] || echo "needs glibc $needs"
    readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/needs \1/p' | grep -vE ' (libc|libm|libpthread|ld-linux.*)\.so\.[0-9]+$'
    shown=$(nm -D --defined-only "$1" | awk '{ print $3 }')
    [ "$shown" = "$(basename "$1" | sed 's/~.*/_tilde_setup/')" ] || echo "shows" $shown
    nm -D --undefined-only "$1" | awk '$1 == "U" && $2 !~ /@/ { print "lacks", $2 }' | sort -k 2 | join -1 2 -v 1 - "$pd_names"
}
windows_fault() {
    shown=$(x86_64-w64-mingw32-objdump -p "$1" | sed -n '/Ordinal\/Name Pointer/,/^$/s/.*\[ *[0-9]*\] //p')
    [ "$shown" = "$(basename "$1" | sed 's/~.*/_tilde_setup/')" ] || echo "shows" $shown
    x86_64-w64-mingw32-objdump -p "$1" | sed -n 's/.*DLL Name: /needs /p' | grep -viE ' (kernel32|msvcrt|user32|ws2_32|pd).dll$'
}
for file in himc~.l_amd64 himc~.linux-amd64-64.so himc~.l_arm64 himc~.m_amd64; do
    for object in himc membrane; do
        file=$object~.${file#*.}
        case $file in *.m_amd64) why=$(windows_fault "$himc/$file" 2>&1) ;; *) why=$(linux_fault "$himc/$file") ;; esac
        report "${file}_needs_the_system_alone_and_shows_its_setup_alone" "$(echo $why)"
    done
done
report arm64_is_arm64 "$(readelf -h "$himc/himc~.l_arm64" | grep -q AArch64 || echo "another machine")"

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
# the Pd and the C library of Debian 11, of 2020: started by their own loader, on arm64 by qemu
older() { # older FOLDER MACHINE LOADER
    root=$(realpath "$HIMC_BUILD")/$1/debian/root
    libraries=$root/lib/$2-linux-gnu:$root/usr/lib/$2-linux-gnu
    case $2 in aarch64) run="qemu-aarch64 -L $root" ;; *) run= ;; esac
    PD="$run $root/lib/$2-linux-gnu/$3 --library-path $libraries $root/usr/bin/puredata -nrt"
    report "$2_objects_are_found_with_glibc_2.31" "$(sounds himc/ "")"
    unset PD
}
older linux x86_64 ld-linux-x86-64.so.2
older arm64 aarch64 ld-linux-aarch64.so.1
if [ -e "$windows/parts/pd/bin/pd.com" ]; then
    # Windows has the folder elsewhere, so its path is given
    export WINEPREFIX=$windows/wine WINEDEBUG=-all
    wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
    PD="$wine $windows/parts/pd/bin/pd.com -path $home/.local/lib/pd/extra"
    report objects_are_found_on_windows "$(sounds himc/ "")"
    unset PD
else
    echo "tests/pd/test_package.sh:0:objects_are_found_on_windows:IGNORE: no Pd for Windows, make test-windows crosses it"
    ignored=1
fi
for patch in "$himc"/*-help.pd "$himc"/patches/[01]*.pd "$himc"/patches/performance.pd "$himc"/patches/pieces/*.pd; do
    play "$patch" -send "pd quit"
    report "$(basename "$patch" .pd)_opens_with_nothing_to_say" "$(silent)"
done
play "$himc/patches/01-improvisation.pd" -send "himc-record $work/improvisation.wav"
report patch_01_sounds "$([ "$(wc -c <"$work/improvisation.wav" 2>/dev/null || echo 0)" -gt 4000000 ] || tail -n 2 "$work/log")"

echo "-----------------------"
echo "$tests Tests $failures Failures $ignored Ignored"
[ $failures = 0 ]
