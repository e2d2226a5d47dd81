#!/bin/sh
# The program and the externals for Windows, run by wine, the externals in Pd 0.53 crossed by tools/build/windows.sh: the strikes of a score
# are those of this machine, digit by digit, and its sound, before it is rounded for a file, is the same within 1e-12 of full scale.
# `make test-windows` runs it.
. tests/support/check.sh
: "${HIMC_BUILD:=build}"
windows=$(realpath "$HIMC_BUILD/windows")
here=$(realpath "$HIMC_BUILD")
source=$PWD
patch=$source/tests/pd/score.pd
work=$(mktemp -d)
export WINEPREFIX=$windows/wine WINEDEBUG=-all
wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
pd=
trap 'kill $pd 2>/dev/null; rm -rf "$work"' EXIT
cd "$work" || exit 1

himc() {
    "$wine" "$windows/bin/himc.exe" "$@"
}
"$wine" cmd /c exit >/dev/null 2>&1 # makes its folder of settings

# --- the program

printf '%s\n' "tempo 120;" "stroke 0 right legato mf;" "stroke 1 left accent f;" "stroke 2 right staccato p rim;" "play;" >score.txt
"$here/bin/himc" render score.txt -o here.wav --strokes here.csv >here.log 2>&1
himc render score.txt -o there.wav --strokes there.csv >there.log 2>&1 || cat there.log
check test_three_strikes_are_played [ "$(wc -l <here.csv)" = 4 ]
check test_strikes_are_those_of_linux cmp here.csv there.csv
# a WAV file has doubles rounded, and one on an edge may come out as a neighbour, so the doubles are held against each other
doubles() { # doubles NAME COMMAND...: the samples of NAME.wav, and what they were
    of=$1 data=$(($(grep -abo data "$1.wav" | head -n 1 | cut -d : -f 1) + 8))
    shift
    "$@" heard.txt $((($(wc -c <"$of.wav") - data) / 8)) "$of.f64" "$of.f32"
    tail -c +$((data + 1)) "$of.wav" | cmp - "$of.f32"
}
{ echo "listener 2.3 0.5 1.3;"; cat score.txt; } >heard.txt
link="$source/tests/cross/doubles.c -I$source/lib -o"
gcc $link doubles "$here/libhimc.a" -lode -lexpat -lz -lstdc++ -lpthread -lm
x86_64-w64-mingw32-gcc -static $link doubles.exe "$windows/libhimc.a" -L"$windows/parts/root/lib" -lode -lexpat -lz -lstdc++ -lpthread -lws2_32 -lm
check test_sound_of_linux_is_its_doubles_rounded doubles here ./doubles
check test_sound_is_its_doubles_rounded doubles there "$wine" doubles.exe
for name in here there; do
    od -A n -v -t f8 -w8 $name.f64 >$name.txt
done
apart=$(paste here.txt there.txt | awk '{ d = $1 > $2 ? $1 - $2 : $2 - $1; if (!(d <= most)) most = d } END { printf "%d %g\n", NR, most }')
echo "$apart" | awk '{ print $1 " samples, apart by " $2 " of full scale at most" }'
# a hundred times what was measured, 1.1e-14: the last bits of two C libraries' functions
check test_sound_is_that_of_linux_to_1e-12 [ "$(echo "$apart" | awk '{ print ($1 > 100000 && $2 <= 1e-12) }')" = 1 ]
himc render score.txt -o scene.wav --scene there.himc --motion there.npz --columns all >there.log 2>&1 || cat there.log
"$here/bin/himc" render score.txt -o scene.wav --scene here.himc --motion here.npz --columns all >here.log 2>&1
# chunks of a name of four letters, a size and as many bytes; the sound is WAV there, whose size follows from the number of samples
check test_a_scene_has_its_sound [ "$(grep -ac 'snd .*RIFF.*WAVEfmt' there.himc)/$(wc -c <there.himc | awk '{ print ($1 > 800000) }')" = 1/1 ]
check test_motion_for_numpy_has_all_columns [ "$(unzip -l there.npz | awk '/npy/ { print $1, $4 }')" = "$(unzip -l here.npz | awk '/npy/ { print $1, $4 }')" ]
check test_columns_are_there [ "$(unzip -l there.npz | grep -c npy)" -gt 3 ]
mkdir -p "Pauken für zwei"
cp score.txt "Pauken für zwei/Stück.txt"
himc render "Pauken für zwei/Stück.txt" -o "Pauken für zwei/Stück.wav" >there.log 2>&1
check test_names_of_files_are_utf-8 cmp there.wav "Pauken für zwei/Stück.wav"
himc render - -o - <score.txt >piped.wav 2>there.log
check test_standard_input_and_output_are_bytes cmp there.wav piped.wav
himc render nothing.txt -o x.wav >refused 2>&1
check test_a_missing_file_is_refused_in_a_line [ "$(grep -c 'nothing.txt: cannot be read: No such file' refused)/$(wc -l <refused)" = 1/1 ]
himc render . -o x.wav >refused 2>&1
check test_a_folder_is_refused grep -q 'expected a regular file\|cannot be read' refused
himc render score.txt -o ./score.txt >refused 2>&1
check test_the_score_is_not_overwritten cmp score.txt "Pauken für zwei/Stück.txt"

# --- the externals

check test_dlls_need_pd_and_windows_alone [ -z "$(x86_64-w64-mingw32-objdump -p "$windows"/externals/himc/*.m_amd64 "$windows/bin/himc.exe" |
    sed -n 's/.*DLL Name: //p' | grep -viE '^(kernel32|msvcrt|user32|ws2_32|pd|advapi32)\.dll$')" ]
play() { # play PATH_OF_EXTERNALS PD...
    path=$1
    shift
    timeout 300 "$@" -nogui -stderr -noaudio -nomidi -r 48000 -batch -path "$path" -open "$patch" 2>&1 </dev/null | tr -d '\r'
}
play "$here/externals/himc" pd -nrt >here.log
play "$windows/externals/himc" "$wine" "$windows/parts/pd/bin/pd.com" >there.log
check test_pd_strikes_three_times [ "$(grep -c '^strike: strike' here.log)" = 3 ]
check test_pd_says_what_it_says_on_linux cmp here.log there.log

# --- the network: commands in, strikes out, by Pd's own objects

port=$((20000 + 8 * $$ % 12000))
sed -e "s/PORT/$port/g" -e "s/EAR/$((port + 1))/g" >osc.pd <<'EOF'
#N canvas 0 0 400 300 12;
#X obj 10 40 himc~ kettle;
#X obj 10 70 membrane~ kettle 26;
#X obj 200 10 loadbang;
#X obj 200 40 t b b b b;
#X msg 200 100 0 right legato mf;
#X obj 200 130 oscformat himc stroke;
#X obj 200 160 list prepend send;
#X obj 200 190 list trim;
#X obj 200 220 netsend -u -b;
#X msg 300 100 connect 127.0.0.1 PORT;
#X msg 10 10 listen PORT \, subscribe 127.0.0.1 EAR strikes;
#X msg 400 100 \; pd dsp 1;
#X obj 10 160 netreceive -u -b EAR;
#X obj 10 190 oscparse;
#X obj 10 220 list trim;
#X obj 10 250 route himc;
#X obj 10 270 route strike;
#X obj 10 300 print heard;
#X msg 500 100 play;
#X obj 500 70 delay 1000;
#X obj 200 70 delay 500;
#X connect 2 0 3 0;
#X connect 3 0 19 0;
#X connect 3 0 20 0;
#X connect 3 1 9 0;
#X connect 3 2 10 0;
#X connect 3 3 11 0;
#X connect 20 0 4 0;
#X connect 4 0 5 0;
#X connect 5 0 6 0;
#X connect 6 0 7 0;
#X connect 7 0 8 0;
#X connect 9 0 8 0;
#X connect 10 0 0 0;
#X connect 12 0 13 0;
#X connect 13 0 14 0;
#X connect 14 0 15 0;
#X connect 15 0 16 0;
#X connect 16 0 17 0;
#X connect 19 0 18 0;
#X connect 18 0 0 0;
EOF
"$wine" "$windows/parts/pd/bin/pd.com" -nogui -stderr -noaudio -nomidi -r 48000 -path "$windows/externals/himc" -open osc.pd >osc.log 2>&1 </dev/null &
pd=$!
for _ in $(seq 300); do
    grep -q '^heard: ' osc.log && break
    sleep 0.1
done
check test_a_stroke_by_osc_comes_back_as_a_strike grep -q '^heard: .* right kettle ' osc.log
[ $failures = 0 ] || tail -n 5 ./*.log

finish
