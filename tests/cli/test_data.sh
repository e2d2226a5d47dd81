#!/bin/sh
# Data out of the program: columns of motion, the standard streams, JSON, and what is refused by name.
. tests/support/check.sh
: "${HIMC_BUILD:=build}" "${HIMC_SHARED:=../shared}"
root=$PWD
himc=$(cd "$HIMC_BUILD" && pwd)/bin/himc
work=$(mktemp -d "$(cd "$HIMC_BUILD" && pwd)/data.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

# refuses NAME TEXT ARGUMENT...: status 1 and one line on stderr with TEXT in it
refuses() {
    name=$1
    text=$2
    shift 2
    timeout 120 "$himc" "$@" >stdout 2>stderr </dev/null
    check "$name" [ "$?$(wc -l <stdout)$(wc -l <stderr)$(grep -cF -- "$text" stderr)" = 1011 ]
}

printf 'stroke 1 right accent f;\nstroke 2 left tenuto mf;\n' >piece.txt

"$himc" render piece.txt -o a.wav --motion a.csv --columns work,energy,torques,rates,powers --quiet >out 2>err
check test_quiet_leaves_one_object [ "$?$(cat err)$(wc -l <out)" = 01 ]
check test_columns_are_those_asked_for [ "$(head -n 1 a.csv | tr ',' '\n' | grep -c -e _work_j -e _torque_ -e _rate_ -e _power_w)" = $((19 + 2 + 1 + 1 + 57 + 57 + 19)) ]
# kinetic + potential = what they were + works, in every row
check test_energy_balance_closes_in_the_table [ "$(awk -F, '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /_work_j$|^placed_j|^numerical_j|_contact_work_j|^push_work_j/) work[i]
                                        else if ($i ~ /^kinetic_j|^potential_j/) held[i]; next }
    { sum = all = 0; for (i in held) sum += $i; for (i in work) { sum -= $i; all += ($i - was[i]) ^ 2 > 0 ? (($i - was[i]) ^ 2) ^ 0.5 : 0; was[i] = $i }
      if (NR == 2) { first = sum; all = 0 } done += all; worst = (sum - first) ^ 2 > worst ? (sum - first) ^ 2 : worst }
    END { print (done > 1 && worst ^ 0.5 <= 1e-6 * done) }' a.csv)" = 1 ]
check test_power_is_torque_times_rate [ "$(awk -F, '
    NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { p = 0; split("x y z", axis, " "); for (k in axis) p += $at["right-elbow_torque_" axis[k] "_n_m"] * $at["right-elbow_rate_" axis[k] "_rad_s"]
      bad += (p - $at["right-elbow_power_w"]) ^ 2 > 1e-12 }
    END { print bad + 0 }' a.csv)" = 0 ]

"$himc" render --columns help >out
check test_columns_help_lists_groups [ "$?$(grep -c '^  \(tips\*\|torques\|energy\|null-space\) ' out)" = 04 ]
HIMC_MARKDOWN=1 "$himc" render --columns help >table.md
sed -n '/^| group |/,/^$/p' "$root/docs/data.md" | sed '/^$/d' >documented.md
check test_the_documented_columns_are_those_of_the_program cmp documented.md table.md
refuses test_an_unknown_group_is_refused '--columns: "torque", expected all, usual or groups' \
    render piece.txt -o x.wav --motion x.csv --columns torque
refuses test_columns_need_a_table "--columns: no --motion F given" render piece.txt -o x.wav --columns tips

# the standard streams
"$himc" render - -o - --motion b.csv --columns energy --quiet <piece.txt >b.wav 2>err
check test_sound_goes_to_a_pipe_as_to_a_file cmp a.wav b.wav
check test_the_object_then_goes_to_stderr [ "$(grep -c '^{"seconds"' err)" = 1 ]
"$himc" render piece.txt -o c.wav --strokes - 2>/dev/null | head -n 1 >out
check test_strokes_go_to_stdout [ "$(cut -d, -f 1-4,9 out)" = time_s,hand,drum,nuance,impulse_n_s ]
"$himc" modes - --json <piece.txt | tr -d ' \n' >out
check test_modes_are_json [ "$(head -c 18 out)$(tail -c 2 out)" = '[{"m":0,"n":1,"fre}]' ]
check test_info_is_json [ "$("$himc" info - --json <piece.txt | sed -n 2p)" = '  ["strokes", "2"],' ]

# settings of the command line
"$himc" render piece.txt -o d.wav --mode ik --law printed --solver pinv --player 1.6,55 --set "limits ellipsoid" \
    --set "tempo 90" --motion d.npz --columns all --quiet >/dev/null 2>err
check test_settings_of_the_command_line_are_taken [ "$?$(cat err)" = 0 ]
"$himc" render piece.txt -o a.wav --motion a.sto --columns work,energy,torques,rates,powers --quiet >/dev/null
{ sed -n '/^endheader/,$p' a.sto | sed 1d | tr '\t' ,; } >sto.csv
check test_a_storage_file_has_the_rows_of_the_csv [ "$(sed 1s/^time,/time_s,/ sto.csv | awk -F, '
    NR == FNR { for (i = 1; i <= NF; i++) csv[FNR, i] = $i; rows = FNR; columns = NF; next }
    FNR == 1 { for (i = 1; i <= NF; i++) bad += $i != csv[1, i]; next }
    { for (i = 1; i <= NF; i++) bad += ($i - csv[FNR, i]) ^ 2 > 1e-18 * ($i ^ 2 + 1); bad += NF != columns }
    END { print bad + 0, FNR - rows, (rows > 100) }' a.csv -)" = "0 0 1" ]
check test_its_header_counts_them [ "$(sed -n 's/^n[RC].*=//p' a.sto | tr '\n' ' ')" = "$(sed 1d sto.csv | awk -F, 'END { print NR, NF " " }')" ]
check test_a_numpy_file_is_a_zip [ "$(head -c 2 d.npz)$(tail -c 22 d.npz | head -c 2)" = PKPK ]
refuses test_a_wrong_player_is_refused "--player: player: MASS" render piece.txt -o x.wav --player 1.8,8000
refuses test_a_wrong_setting_is_refused "--set: lims: unknown command" render piece.txt -o x.wav --set "lims off"

# an error of a take names its file once
printf 'PathFileType\t4\t(X/Y/Z)\tx.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n100\t100\t2\t1\tmm\t100\t1\t2\nFrame#\tTime\tabc\t\t\n\t\tX1\tY1\tZ1\n\n1\t0\t1\t2\t3\n2\t0.01\t1\t2\t3\n' >tipless.trc
printf 'units tipless.trc legato;' >tipless.txt
for call in "render tipless.trc -o x.wav" "render tipless.txt -o x.wav" "evaluate --take tipless.trc"; do
    check "test_a_file_is_named_once_by_${call%% *}" [ "$("$himc" $call 2>&1 | grep -o 'tipless\.trc' | wc -l)" = 1 ]
done

# unknown files are named for what they are
printf 'stroke 0 left accent f\nstroke 1 right accent f;\n' >lost.txt
refuses test_a_missing_semicolon_is_suggested 'lost.txt:1: stroke 0 left accent f: a ; is missing, before "stroke"' info lost.txt
printf 'RIFF    WAVE' >sound.txt
refuses test_a_sound_is_named "sound.txt: a sound or a film" info sound.txt
cp a.csv takes.amc
refuses test_acclaim_has_a_way_out "Acclaim motion, which is not read: convert it" info takes.amc
cp a.csv takes.fbx
refuses test_fbx_has_a_way_out "import it into Blender and export .bvh" render takes.fbx -o x.wav
refuses test_a_csv_without_markers_has_a_way_out "NAME_x_m" info a.csv
"$himc" render piece.txt -o a.wav --motion tips.csv --columns tips --quiet >/dev/null
check test_the_motion_of_a_render_is_a_take [ "$("$himc" info tips.csv | grep -c -e '^tip: ' -e '^strikes: 2')" = 3 ]

# the controllers on one's own capture
stroke=$(cd "$root" && cd "$HIMC_SHARED" 2>/dev/null && pwd)/mocap/drumstroke_pearl_240hz/stroke.trc
if [ -f "$stroke" ]; then
    "$himc" evaluate --take "$stroke" --csv own.csv --figure own.svg --quiet
    ended=$?
    check test_the_figure_has_a_bar_for_each [ "$(grep -c '^<rect' own.svg)$(tail -n 1 own.svg)" = "7</svg>" ]
    check test_own_captures_get_a_row_for_each_controller_and_law [ "$ended$(cut -d, -f 2-3 own.csv | tr '\n' ' ')" = \
        "0controller,law ik,none id,printed id,feedforward id,computed-torque himc,printed himc,feedforward himc,computed-torque " ]
    check test_computed_torque_follows_the_capture_best [ "$(awk -F, '$2 == "himc" { percent[$3] = $9 }
        END { print (percent["computed-torque"] < 1 && percent["printed"] > 2) }' own.csv)" = 1 ]
    for order in "player 1.64 58; take $stroke" "take $stroke; player 1.64 58"; do
        printf 'law printed; %s;\n' "$order" >order.txt
        "$himc" render order.txt -o /dev/null --quiet | grep -o '"captured_rms_percent": [0-9.]*'
    done | sort | uniq -c >orders
    check test_player_and_take_may_come_in_any_order [ "$(sed 's/ *\([0-9]*\) .*: \([0-9]\).*/\1 \2/' orders)" = "2 4" ]
fi
refuses test_a_take_without_analog_channels_says_so "--analog: tips.csv has no analog channels" info tips.csv --analog x.csv
reach=$(dirname "$stroke")/../upperlimb_pyomeca_100hz/markers_analogs.c3d
if [ -f "$reach" ]; then
    "$himc" info "$reach" --analog analog.csv >out
    check test_analog_samples_are_written [ "$?$(head -n 1 analog.csv | tr ',' '\n' | wc -l) $(wc -l <analog.csv) $(grep ^analog: out)" = \
        "039 11601 analog: 38 channels of 11600 samples at 2000 Hz" ]
fi
if [ -n "${HIMC_LONG-}" ] && [ -f "$reach" ]; then
    "$himc" evaluate --take "$stroke" "$reach" --right-tip RTIP,Daphnee:INDEX --csv both.csv --quiet
    check test_a_reaching_arm_teaches_no_stroke [ "$(grep -v markers_analogs both.csv | cut -d, -f 2-)" = "$(cut -d, -f 2- own.csv)" ]
fi
# what the table does not explain is told in a line: strokes that did not land, a posture that was not learned
"$himc" render piece.txt -o a.wav --set "record recorded.bvh" --quiet >out
"$himc" evaluate --take recorded.bvh --csv recorded.csv 2>err
check test_rows_with_lost_strokes_are_explained \
    [ "$(awk -F, 'NR > 1 && $5 < $4' recorded.csv | wc -l)" = "$(grep -c '^note: recorded.bvh: .* plays [0-9]* of [0-9]* strokes ' err)" ]
# Percentages are of the captured amplitude, however the strokes are played; these are on two drums, between which the take's one drum is put.
# It is the mean height of the tips above the head (0.85 m) and a mallet's radius, from one stroke of a hand to the next.
printf 'drum near;\ndrum far;\nnear place 0.45 -0.4 0.85;\nfar place 0.45 0.4 0.85;\nstroke 1 right accent ff near;\nstroke 2 left legato p far;
stroke 3 right tenuto mp near;\nstroke 4 left staccato mp far;\n' >apart.txt
"$himc" render apart.txt -o a.wav --motion apart.csv --columns tips --strokes hits.csv --set "record apart.bvh" --quiet >/dev/null
"$himc" evaluate --take apart.bvh --csv own.csv --quiet
check test_own_captures_are_compared_in_percent_of_their_own_amplitude [ "$(awk -F, '
    FILENAME == "hits.csv" { if (FNR > 1) { n++; at[n] = $1; from[n] = last[$2]; hand[n] = $2; last[$2] = $1 } next }
    FILENAME == "apart.csv" && FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    FILENAME == "apart.csv" { for (k = 1; k <= n; k++) if ($1 <= at[k] && $1 > from[k] + 0 && (z = $column[hand[k] "_tip_z_m"] - 0.8675) > top[k]) top[k] = z; next }
    FNR == 1 { for (k = 1; k <= n; k++) wanted += 1000 * top[k] / n; next }
    { rows++; kinds[$8]; bad += ($8 / wanted - 1) ^ 2 > 0.01 ^ 2 || ($9 * $8 / 100 / $6 - 1) ^ 2 > 1e-8 }
    END { for (k in kinds) different++; print rows, different, bad + 0 }' hits.csv apart.csv own.csv)" = "7 1 0" ]
check test_the_published_law_is_explained grep -q "id printed plays 0 of 2 strokes .*the law as published" err
check test_a_posture_that_was_not_learned_is_explained [ "$(grep -c 'built-in posture.*one more take' err)" = 1 ]
refuses test_own_captures_must_be_takes "score.txt: not a take by its suffix" evaluate --take score.txt

# the commands of the first ten minutes, as they stand there (evaluate has been, above)
mkdir -p start/patches
sed -n '/^```score/,/^```$/p' "$root/docs/start.md" | grep -v '^```' >start/strokes.txt
head -n 12 "$root/patches/improvisation.txt" >start/patches/improvisation.txt
(cd start && grep '^    himc [^e]' "$root/docs/start.md" | while read -r _ arguments; do
    eval "$himc $arguments" >/dev/null 2>err || { echo "himc $arguments: $(cat err)"; break; }
done) >failed
check test_the_commands_of_the_first_ten_minutes_run [ "$(cat failed)" = "" ]
check test_they_leave_what_they_say [ -s start/strokes.npz -a -s start/mine.bvh -a -s start/strokes.html ]

finish
