#!/bin/sh
# pmpd~: a mesh of 20 by 20 masses, struck four times a second, in Pure Data's batch mode. Debian: pd-pmpd puredata-core.
# Prints `WHAT VALUE LABEL` a line; exit status 77 where it is missing.
command -v pd >/dev/null && [ -e "/usr/lib/pd/extra/pmpd/pmpd~.pd_linux" ] || { echo "pmpd~: not installed" >&2; exit 77; }
work=$(mktemp -d) && trap 'rm -rf "$work"' EXIT
# 0 loadbang, 1 pmpd~, 2 metro, 3 a blow, 4 the messages that make the mesh, 5 the end, 6 dac~
patch() { # SECONDS
    echo '#N canvas 0 0 450 300 12;'
    echo '#X obj 10 10 loadbang;'
    echo '#X obj 10 200 pmpd~ 1 1;'
    echo '#X obj 100 40 metro 250;'
    echo '#X msg 100 70 forceX 210 1;'
    awk 'BEGIN {
        printf "#X msg 10 40 reset"
        for (i = 0; i < 400; i++) {
            edge = i < 20 || i >= 380 || i % 20 == 0 || i % 20 == 19
            printf " \\, mass %g 0", edge ? 0 : 1
        }
        for (i = 0; i < 400; i++) {
            if (i % 20 < 19) printf " \\, link %d %d 0.05 0.001", i, i + 1
            if (i < 380) printf " \\, link %d %d 0.05 0.001", i, i + 20
        }
        print " \\, outPos 0 210 1;"
    }'
    echo "#X obj 200 40 delay $(($1 * 1000));"
    echo '#X obj 10 240 dac~;'
    echo '#X msg 200 70 \; pd quit;'
    echo '#X msg 300 70 \; pd dsp 1;'
    for cord in "0 0 4 0" "4 0 1 0" "0 0 2 0" "2 0 3 0" "3 0 1 0" "0 0 5 0" "5 0 7 0" "0 0 8 0" "1 0 6 0"; do
        echo "#X connect $cord;"
    done
}
processor_time() { # of the best of three runs (s)
    patch "$1" >"$work/mesh.pd"
    for _ in 1 2 3; do
        bash -c 'TIMEFORMAT=%U; time pd -batch -noprefs -r 48000 -path /usr/lib/pd/extra/pmpd "$1" >"$2" 2>&1' - "$work/mesh.pd" "$work/log"
    done 2>&1 | sort -n | head -n 1
}
short=$(processor_time 1) && long=$(processor_time 11)
grep -q "couldn't create" "$work/log" && { cat "$work/log" >&2; exit 1; }
echo "$short $long" | awk '$2 > $1 { printf "drum_ms_per_s %.3f pmpd~, a mesh of 20 by 20\n", 100 * ($2 - $1) }'
