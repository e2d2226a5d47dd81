#!/bin/sh
# The installed library as its users meet it: the examples of docs/examples are built with the flags of pkg-config, in C against the
# shared library, against the static one, and in C++; they run and do what they say.
. tests/support/check.sh
: "${HIMC_BUILD:=build}" "${CC:=gcc}" "${CXX:=g++}"
dir=$(pwd)/$HIMC_BUILD/tests/examples
rm -rf "$dir"
mkdir -p "$dir"

quiet() {
    "$@" >"$dir/log" 2>&1 || { cat "$dir/log" >&2; false; }
}
# sounds RAW: the samples are finite and some are louder than 0.001
sounds() {
    od -An -v -t f4 -w4 "$1" | awk '/nan|inf/ {bad = 1} {v = $1 < 0 ? -$1 : $1; if (v > m) m = v} END {exit bad || m < 0.001 || m > 1000}'
}

prefix=$dir/usr
check test_install_succeeds quiet make -s install BUILD="$HIMC_BUILD" PREFIX="$prefix" PDEXTRA="$prefix/pd"
# the same without the shared library, for static linking
cp -r "$prefix" "$dir/static"
rm "$dir"/static/lib/libhimc.so*
sed -i "s|$prefix|$dir/static|" "$dir/static/lib/pkgconfig/himc.pc"

flags() {
    PKG_CONFIG_PATH=$dir/$1/lib/pkgconfig pkg-config $2 --cflags --libs himc
}
build() { # PROGRAM COMPILER... : from docs/examples, its name up to a dash
    program=$1
    shift
    quiet "$@" -Wall -Wextra -Wpedantic -Werror "docs/examples/${program%%-*}.c" -o "$dir/$program" $link
}
link="$(flags usr) -lm -Wl,-rpath,$prefix/lib"
for program in hello target drum take; do
    check test_${program}_builds_with_the_shared_library build $program "$CC" -std=c17
done
check test_hello_builds_as_cxx build hello-cxx "$CXX" -x c++ -std=c++17
# where PortAudio is, with a sound card that plays to nowhere; without any it ends with one line
if pkg-config --exists portaudio-2.0; then
    link="$link $(pkg-config --cflags --libs portaudio-2.0)"
    printf 'pcm.!default {type null}\nctl.!default {type null}\n' >"$dir/.asoundrc"
    check test_live_builds build live "$CC" -std=c17
    printf 'hit third legato f\nhit right legato f nowhere\nquit\n' | HOME="$dir" "$dir/live" >"$dir/live.said" 2>"$dir/live.log"
    check test_live_tells_refused_commands_or_that_there_is_no_sound_card [ "$(grep -c 'nowhere: \|third, ' "$dir/live.said")" = 2 -o \
        "$(grep -c '^PortAudio: ' "$dir/live.log")" = 1 ]
fi
link="$(flags static --static) -lm"
check test_hello_builds_with_the_static_library build hello-static "$CC" -std=c17
check test_hello_builds_as_cxx_with_the_static_library build hello-cxx-static "$CXX" -x c++ -std=c++17

strokes=$(grep -o '"stroke [^"]*"' docs/examples/hello.c | wc -l)
for program in hello hello-cxx hello-static hello-cxx-static; do
    "$dir/$program" >"$dir/$program.raw" 2>"$dir/$program.strikes"
    check "test_$(echo $program | tr - _)_reports_a_strike_for_each_stroke" [ "$(grep -c ' N$' "$dir/$program.strikes")" = "$strokes" ]
    check "test_$(echo $program | tr - _)_sounds" sounds "$dir/$program.raw"
done
check test_hello_is_the_same_however_it_is_linked cmp "$dir/hello.raw" "$dir/hello-cxx-static.raw"
needs=$(ldd "$dir/hello-static" | grep -c libhimc)
check test_hello_static_needs_no_shared_himc [ "$needs" = 0 ]
check test_hello_needs_the_major_version [ "$(ldd "$dir/hello" | grep -c 'libhimc\.so\.0 ')" = 1 ]

off=$("$dir/target" | sed -n 's/^tip within \([0-9.]*\) mm.*/\1/p')
check test_target_is_followed_within_20_mm [ "$(echo "$off" | awk '{print ($1 > 0 && $1 < 20)}')" = 1 ]
"$dir/drum" >"$dir/drum.raw" 2>"$dir/drum.blow"
check test_drum_reports_its_blow grep -qE '^[0-9]+ N for [0-9.]+ ms$' "$dir/drum.blow"
check test_drum_sounds sounds "$dir/drum.raw"

# a capture of two tips that fall 0.4 m in 0.2 s and rise again: 4 m/s, the right one at 0.4 s and every 0.4 s, the left one between
awk 'BEGIN {
    print "PathFileType\t4\t(X/Y/Z)\ttips.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate"
    print "250\t250\t500\t2\tmm\t250\nFrame#\tTime\tLTIP\t\t\tRTIP\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n"
    for (i = 0; i < 500; i++) {
        r = i % 100 - 50
        l = (i + 50) % 100 - 50
        printf "%d\t%.3f\t500\t%.3f\t-100\t550\t%.3f\t100\n", i + 1, i / 250, 1200 - 0.16 * l * l, 1200 - 0.16 * r * r
    }
}' >"$dir/tips.trc"
"$dir/take" "$dir/tips.trc" >"$dir/take.out"
check test_take_succeeds [ $? = 0 ]
check test_take_lists_the_highest_place_of_each_point [ "$(grep : "$dir/take.out" | tr '\n' ' ')" = \
    "LTIP: 0.500 0.100 1.200 m RTIP: 0.550 -0.100 1.200 m " ]
strikes=$(sed -n 's/^\([0-9.]*\) s \([a-z]*\) .*/\1 \2/p' "$dir/take.out" | tr '\n' ' ')
check test_take_lists_the_strikes_of_both_tips [ "$strikes" = \
    "0.200 left 0.400 right 0.600 left 0.800 right 1.000 left 1.200 right 1.400 left 1.600 right 1.800 left " ]
check test_take_tells_their_speed_and_place [ "$(grep -c ' 4\.00 m/s at 0\.5[05]0 -\{0,1\}0\.100 0\.800 m$' "$dir/take.out")" = 9 ]
check test_take_refuses_a_file_that_is_not_there [ "$("$dir/take" "$dir/none.trc" 2>&1 | wc -l)" = 1 ]

# each public header alone, as C and as C++; the declaration is for headers that have macros alone
for header in lib/himc/*.h; do
    base=$(basename "$header" .h)
    printf '#include <himc/%s.h>\nint himc_test(void);\n' "$base" >"$dir/$base.c"
    check "test_${base}_h_is_c_by_itself" quiet "$CC" -std=c17 -Wall -Wextra -Wpedantic -Werror $(flags usr) -fsyntax-only "$dir/$base.c"
    check "test_${base}_h_is_cxx_by_itself" quiet "$CXX" -x c++ -std=c++17 -Wall -Wextra -Wpedantic -Werror $(flags usr) -fsyntax-only "$dir/$base.c"
done

# what else is installed, and that all of it goes again
calls=$("$prefix/bin/himc" --help | sed -n 's/^  \([a-z]*\) .*/\1/p')
for page in $(ls "$prefix/bin") $(printf 'himc-%s ' $calls); do
    check "test_${page}_has_a_manual_page" grep -q '^\.SH SYNOPSIS$' "$prefix/share/man/man1/$page.1"
done
offers() { # offers WORD...: what bash offers for the last of them
    bash -c '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _himc; echo "${COMPREPLY[@]}"' \
        "$prefix/share/bash-completion/completions/himc" "$@"
}
check test_bash_completes_a_call [ "$(offers himc eva)" = evaluate ]
check test_bash_completes_an_option [ "$(offers himc render --str)" = --strokes ]
unstripped() { # binaries with what only a debugger needs
    for file in $(find "$prefix" -name '*.pd_*' -o -name 'libhimc.*' ! -type l -o -path '*/bin/*' -type f); do
        readelf -S "$file" 2>&1 | grep -q '\.debug_info' && echo "$file"
    done
}
check test_installed_files_are_stripped [ -z "$(unstripped)" ]
# dead: links of the installed documentation to what is not there
dead_links() {
    for page in "$prefix"/share/doc/himc/*.md "$prefix"/share/doc/himc/docs/*.md "$prefix"/share/doc/himc/docs/results/*.md; do
        sed '/^```/,/^```/d' "$page" | grep -oE '\]\([^) ]+\)' | sed 's/^](//; s/)$//; s/#.*//' | grep -v '^[a-z]*:' | while read -r to; do
            [ -z "$to" ] || [ -e "${page%/*}/$to" ] || echo "$page: $to"
        done
    done
}
check test_installed_documentation_has_no_dead_link [ -z "$(dead_links)" ]
check test_installed_documentation_has_its_links [ "$(cat "$prefix"/share/doc/himc/docs/*.md | grep -c '](manual.md')" -ge 5 ]
check test_licences_are_installed [ -s "$prefix/share/doc/himc/LIBRARIES.txt" ]
check test_patches_are_installed [ -s "$prefix/pd/himc/patches/pieces/tide.pd" ]
check test_installed_panel_names_the_technique_beside_the_objects [ "$(grep -c ' technique~ kettle' "$prefix/pd/himc/patches/performance.pd")" = 1 ]
spaced="$dir/with a space"
check test_install_takes_a_prefix_with_a_space quiet make -s install BUILD="$HIMC_BUILD" PREFIX="$spaced" PDEXTRA="$spaced/pd"
check test_a_prefix_with_a_space_has_the_same_files [ "$(cd "$spaced" && find . | sort)" = "$(cd "$prefix" && find . | sort)" ]
check test_pkg_config_quotes_the_space [ "$(PKG_CONFIG_PATH="$spaced/lib/pkgconfig" pkg-config --cflags himc)" = \
    "-I$dir/with\\ a\\ space/include " ]
check test_uninstall_takes_a_prefix_with_a_space quiet make -s uninstall BUILD="$HIMC_BUILD" PREFIX="$spaced" PDEXTRA="$spaced/pd"
check test_nothing_is_left_in_a_prefix_with_a_space [ -z "$(find "$spaced" ! -type d)" ]
touch "$prefix/pd/himc/of-the-user"
check test_uninstall_succeeds quiet make -s uninstall BUILD="$HIMC_BUILD" PREFIX="$prefix" PDEXTRA="$prefix/pd"
check test_uninstall_leaves_what_is_not_ours [ "$(find "$prefix" ! -type d)" = "$prefix/pd/himc/of-the-user" ]

finish
