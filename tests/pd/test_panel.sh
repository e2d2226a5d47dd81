#!/usr/bin/env bash
# The panel, patches/performance.pd: every message a control can make is of the vocabulary, and in a
# Pd without a window every control can be moved, end to end, without an error. Pd runs in real time;
# what it is to print is awaited, at most a minute, so that it is the same on a busy machine.
# panel.awk reads the patch, panel_words.c asks the library's parser.
cd "$(dirname "$0")/../.." || exit 1
: "${HIMC_BUILD:=build}" "${CC:=gcc}"
dir=$HIMC_BUILD/tests/panel
patch=patches/performance.pd
port=$((20000 + 8 * $$ % 12000)) # and 7 after it; ours, should two of these run at once, and below those that the system gives
mkdir -p "$dir"
tests=0 failures=0

report() { # report NAME WHY: passed if WHY is empty
    tests=$((tests + 1))
    [ -z "$2" ] || failures=$((failures + 1))
    echo "tests/pd/test_panel.sh:${BASH_LINENO[0]}:$1:${2:+FAIL: }${2:-PASS}${3:+ $3}"
}

"$CC" -std=c17 -O2 -Wall -Wextra -Ilib tests/pd/panel_words.c "$HIMC_BUILD/libhimc.a" -lm -o "$dir/words" || exit 1
awk -f tests/pd/panel.awk "$patch" >"$dir/messages"
"$dir/words" <"$dir/messages" >"$dir/parsed"
wrong=$(sed '$d' "$dir/parsed" | tr '\n' ';')
report every_message_of_the_panel_is_of_the_vocabulary "$wrong" "$(tail -n 1 "$dir/parsed")"
report the_panel_says_all_that_figure_6_shows "$(
    for word in subscribe unsubscribe mode solver limits gain grip hit tempo rate technique radius density \
        tension modes decay mallet pickup score play stop; do
        grep -qw "$word" "$dir/messages" patches/lib/receiver.pd || echo -n "no $word "
    done)"

# the panel with names that can be sent to, and a driver that moves each control from end to end
sed 's/\\\$0-/panel-/g; s|techniques/technique~|technique~|; s/9011/'$port'/; s/9000/'$((port + 7))'/' "$patch" >"$dir/panel.pd"
awk -v port=$port -v clear="$dir/clear.txt" '
    function move(name, value) { if (name ~ /^panel-/) print "15 " name " " value ";" }
    BEGIN {
        print "200 pd dsp 1;"
        split("viewer avatar sound other", row, " ")
        for (i = 1; i <= 4; i++)
            print "10 panel-" row[i] "-port " port + i ";"
    }
    { sub(/;$/, "") }
    $5 == "hsl" && $12 !~ /level/ { name = $12; sub(/-slide$/, "", name); move(name, $8); move(name, $9); move("panel-as-made", "bang") }
    $5 == "vradio" || $5 == "hradio" { for (i = 0; i < $9; i++) move($10, i); move($10, 0) }
    $5 == "tgl" && $8 !~ /-(dsp|loop)$/ { move($8, 1); if ($8 !~ /-listen/) on[++n] = $8 }
    $5 == "bng" && $10 !~ /-(page|score|take|record|edit|record-stop|reset)$/ { move($10, "bang") }
    $2 == "floatatom" && $10 ~ /-(hz|rate)-slide$/ {
        name = $10
        sub(/-slide$/, "", name)
        # a task has to be a whole part of a second long, and physics faster than it
        move(name, name ~ /physics/ ? 12000 : name ~ /task/ ? 200 : 50)
    }
    $2 == "floatatom" && $10 ~ /pickup/ { name = $10; sub(/-slide$/, "", name); move(name, $6); move(name, $7) }
    END {
        print "10 panel-as-made bang;"
        print "10 panel-reset bang;"
        print "10 panel-mode 1;"
        print "10 panel-grip 1;"
        print "10 panel-improvisation bang;"
        print "10 panel-box bang;"
        print "3000 panel-info bang;"
        print "10 panel-hit-left-accent bang;"
        for (i = 1; i <= n; i++)
            print "15 " on[i] " 0;" >clear
        # sent after all the others: when it comes, they are gone
        print "10 panel-himc subscribe 127.0.0.1 " port + 6 " pose 100;" >clear
    }' "$dir/panel.pd" >"$dir/moves.txt"
{
    echo '#N canvas 0 0 400 300 12;'
    echo '#X obj 10 10 loadbang;'
    echo '#X msg 10 40 read moves.txt \, bang;'
    echo '#X obj 10 70 qlist;'
    echo '#X connect 0 0 1 0;'
    echo '#X connect 1 0 2 0;'
    at=3
    for name in viewer avatar sound other last; do
        at_port=$((port + at / 5 + 1 + (at == 23)))
        echo "#X obj 10 100 netreceive -u -b $at_port;"
        echo '#X obj 10 130 oscparse;'
        echo '#X obj 10 160 list trim;'
        echo "#X obj 10 190 list split 2;"
        echo "#X obj 10 220 print at-$name;"
        for i in 0 1 2 3; do echo "#X connect $((at + i)) 0 $((at + i + 1)) 0;"; done
        at=$((at + 5))
    done
    for name in stat-physics stat-task last-force last-beat joint-name; do
        echo "#X obj 10 250 r panel-$name;"
        echo "#X obj 10 280 print $name;"
        echo "#X connect $at 0 $((at + 1)) 0;"
        at=$((at + 2))
    done
    # the shell, at the fifth port: clear, then quit
    echo "#X obj 10 10 netreceive -u $((port + 5));"
    echo '#X obj 10 40 route clear quit;'
    echo '#X msg 10 70 read clear.txt \, bang;'
    echo '#X obj 10 100 qlist;'
    echo '#X msg 90 70 \; pd quit;'
    echo "#X connect $at 0 $((at + 1)) 0;"
    echo "#X connect $((at + 1)) 0 $((at + 2)) 0;"
    echo "#X connect $((at + 2)) 0 $((at + 3)) 0;"
    echo "#X connect $((at + 1)) 1 $((at + 4)) 0;"
} >"$dir/driver.pd"
timeout 300 pd -nogui -nrt -stderr -noprefs -noaudio -nomidi -r 48000 -path "$HIMC_BUILD/externals/himc" \
    -path patches -path patches/techniques "$dir/panel.pd" "$dir/driver.pd" >"$dir/pd" 2>&1 </dev/null &
pd=$!
trap 'kill $pd 2>/dev/null' EXIT

heard() { # heard WORD...: says which of these lines Pd has not written, after a minute
    for word in "$@"; do
        for _ in $(seq 600); do
            grep -q -- "$word" "$dir/pd" && continue 2
            sleep 0.1
        done
        echo -n "no '$word' "
    done
}
controls=$(heard '^himc~: mode id' '^himc~: grip french' 'joint-name: symbol waist')
receivers=$(heard 'at-viewer: .*himc body' 'at-viewer: .*himc targets' 'at-viewer: .*membrane kettle' \
    'at-viewer: .*himc strike' 'at-avatar: .*VMC Ext' 'at-other: .*himc body')
played=$(heard 'last-force: [1-9]' 'last-beat: 4')
status=$(heard 'stat-physics: 10000' 'stat-task: 250')
echo 'clear;' >/dev/udp/127.0.0.1/$((port + 5))
for _ in $(seq 600); do
    [ "$(grep -c '^at-last' "$dir/pd")" -ge 4000 ] && break # 200 poses
    sleep 0.1
done
echo 'quit;' >/dev/udp/127.0.0.1/$((port + 5))
wait $pd
code=$?
report the_panel_opens_and_every_control_moves "$([ $code = 0 ] || echo "exit status $code: $(tail -n 1 "$dir/pd")")"
report no_control_makes_an_error \
    "$(grep -i 'error\|no such\|failed\|couldn' "$dir/pd" | head -n 3 | tr '\n' ';')"
report controls_reach_the_performer "$controls"
report ticks_of_a_row_register_a_receiver "$receivers"
report the_panel_shows_what_is_played "$played"
report the_panel_hears_its_own_status "$status"
# the first half of the last receiver's lines is time enough for those still on their way
report clearing_the_ticks_removes_the_receivers "$(awk '
    /^at-last/ { last++ }
    /^at-/ && !/^at-last/ && last > 2000 { still++ }
    END { if (last < 4000) print "only " last + 0 " lines of the last receiver"; if (still) print still " packets still" }' "$dir/pd")"

echo "-----------------------"
echo "$tests Tests $failures Failures 0 Ignored"
[ $failures = 0 ]
