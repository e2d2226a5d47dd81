#!/bin/sh
# `himc serve` and [himc~] as programs: they start, print their port, refuse in one line, end cleanly.
# Each event is waited for, at most a minute; nothing depends on how long it takes.
. tests/support/check.sh
: "${HIMC_BUILD:=build}"
himc=$HIMC_BUILD/bin/himc
dir=$HIMC_BUILD/tests/osc_serve
mkdir -p "$dir"
ear=$((20000 + 8 * $$ % 12000)) # and 7 after it; ours, should two of these run at once, and below those that the system gives

await() { # await FILE WORDS: until the file has a line with them
    for _ in $(seq 600); do
        grep -q -- "$2" "$1" 2>/dev/null && return
        sleep 0.1
    done
}

server= pd=
trap 'kill $server $pd 2>/dev/null' EXIT
"$himc" serve --port 0 >"$dir/out" 2>"$dir/err" &
server=$!
await "$dir/out" '^listening at'
port=$(sed -n 's/^listening at 127.0.0.1 port //p' "$dir/out")
check test_serve_prints_its_port [ -n "$port" ]
timeout 60 "$himc" serve --port "$port" >/dev/null 2>"$dir/taken"
check test_serve_fails_when_the_port_is_taken [ $? = 1 ]
check test_a_taken_port_is_one_line [ "$(grep -c taken "$dir/taken")/$(wc -l <"$dir/taken")" = 1/1 ]
kill -TERM $server
wait $server
code=$?
server=
check test_serve_ends_cleanly_on_sigterm [ $code = 0 ]
check test_serve_reports_in_json grep -q '^{"blocks": ' "$dir/out"

sed "s/39871/$ear/g" >"$dir/osc.pd" <<'EOF'
#N canvas 0 0 400 300 12;
#X obj 10 10 loadbang;
#X obj 10 40 t b b;
#X msg 200 70 \; pd dsp 1;
#X msg 10 70 subscribe 127.0.0.1 39871 strikes \, subscribe 127.0.0.1 39871 pose 50 \, stroke 1 left accent f \, tempo 240 \, play;
#X obj 10 110 himc~ kettle;
#X obj 10 160 netreceive -u -b 39871;
#X obj 10 190 oscparse;
#X obj 10 220 list trim;
#X obj 10 250 route himc;
#X obj 10 270 route strike body status;
#X obj 10 300 print strike;
#X obj 60 300 print body;
#X obj 300 110 membrane~ kettle;
#X connect 0 0 1 0;
#X connect 1 0 3 0;
#X connect 1 1 2 0;
#X connect 3 0 4 0;
#X connect 5 0 6 0;
#X connect 6 0 7 0;
#X connect 7 0 8 0;
#X connect 8 0 9 0;
#X connect 9 0 10 0;
#X connect 9 1 11 0;
EOF
if command -v pd >/dev/null; then
    pd -nogui -nrt -stderr -noaudio -path "$HIMC_BUILD/externals/himc" -lib himc~ -lib membrane~ \
        "$dir/osc.pd" >"$dir/pd" 2>&1 </dev/null &
    pd=$!
    await "$dir/pd" '^strike: '
    for _ in $(seq 600); do
        [ "$(grep -c '^body: left-stick' "$dir/pd")" -gt 20 ] && break
        sleep 0.1
    done
    kill $pd
    wait $pd 2>/dev/null
    pd=
    check test_himc_tilde_sends_strikes_that_vanilla_objects_read grep -q '^strike: [0-9.e-]* left kettle' "$dir/pd"
    check test_himc_tilde_sends_poses [ "$(grep -c '^body: left-stick' "$dir/pd")" -gt 20 ]
fi

finish
