#!/bin/sh
# `himc evaluate` from outside: its table, trials in pieces and on more cores, a log gone on with, what it refuses.
. tests/support/check.sh
: "${HIMC_BUILD:=build}"
himc=$(cd "$HIMC_BUILD" && pwd)/bin/himc
work=$(mktemp -d "$(cd "$HIMC_BUILD" && pwd)/evaluate.XXXXXX")
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

# refuses NAME TEXT ARGUMENT...: status 1, nothing on stdout, one line on stderr with TEXT in it
refuses() {
    name=$1
    text=$2
    shift 2
    "$himc" evaluate "$@" >stdout 2>stderr
    check "$name" [ "$? $(wc -l <stdout) $(wc -l <stderr) $(grep -cF -- "$text" stderr)" = "1 0 1 1" ]
}

two() {
    "$himc" evaluate --trials 2 --only legato,himc,computed-torque "$@"
}

# fields of a table's only row
row() {
    sed -n 2p "$1" | cut -d , -f "$2"
}

two --jobs 2 --log whole.log --csv whole.csv
check test_evaluate_succeeds [ $? = 0 ]
check test_header_is_the_published_one [ "$(head -n 1 whole.csv)" = \
    nuance,controller,law,trials,rms_mm,rms_sd_mm,amplitude_mm,rms_percent,elbow_range_ratio ]
check test_only_keeps_one_row [ "$(wc -l <whole.csv) $(row whole.csv 1-4)" = "2 legato,himc,computed-torque,2" ]
check test_percent_is_rms_of_amplitude [ "$(row whole.csv 5-8 |
    awk -F , '{e = 100 * $1 / $3 - $4; print (e < 1e-4 && e > -1e-4 && $1 > 0 && $2 > 0)}')" = 1 ]

# in pieces, on one core
two --jobs 1 --range 2-2 --log second.log --csv /dev/null
two --jobs 1 --range 1-1 --log first.log --csv first.csv
check test_a_range_has_its_trials_only [ "$(row first.csv 4)" = 1 ]
cat second.log first.log >joined.log
two --log joined.log --csv joined.csv
check test_ranges_joined_by_cat_are_the_whole cmp joined.csv whole.csv
check test_nothing_in_the_log_is_done_again [ "$(wc -l <joined.log)" = 4 ]

# a player at the rim, where habit, trunk and limits have the least room to agree
"$himc" evaluate --trials 7 --range 7-7 --only legato,himc,computed-torque --log rim.log --csv rim.csv
check test_at_the_rim_limits_leave_the_sticks_where_they_are [ "$(row rim.csv 8,9 |
    awk -F , '{print ($1 < 0.5 && $2 > 0.8 && $2 < 1.2)}')" = 1 ]
check test_at_the_rim_every_stroke_is_played [ "$(sed -n 2p rim.log | awk -F , '{print $(NF - 1) == $NF}')" = 1 ]

# stopped while it wrote its last row
head -c -9 whole.log >cut.log
two --log cut.log --csv cut.csv
check test_a_cut_off_row_is_done_again cmp cut.csv whole.csv
check test_a_log_gone_on_with_has_whole_rows [ "$(sort cut.log)" = "$(sort whole.log)" ]

refuses test_no_trials_are_refused "--trials" --trials 0
refuses test_a_range_beyond_the_trials_is_refused "--range: 2-3, expected A-B within 1-2" --trials 2 --range 2-3
refuses test_a_range_backwards_is_refused "--range: 2-1" --trials 2 --range 2-1
refuses test_an_unknown_word_is_refused "--only: legatto, expected a nuance" --trials 2 --only legatto
refuses test_no_jobs_are_refused "--jobs" --jobs 0
refuses test_one_file_for_both_tables_is_refused "x.csv: named twice" --trials 1 --log x.csv --csv x.csv
# another program's log, or one that a hand has changed: the last row of each part is played again
awk -F , -v OFS=, 'NR == 3 { $5 = 999 } { print }' whole.log >other.log
cp other.log kept.log
refuses test_a_log_of_another_program_is_refused_with_its_line "other.log:3: rms_mm: 999, expected" --trials 2 --only legato,himc,computed-torque --log other.log
check test_a_log_of_another_program_stays_as_it_is cmp other.log kept.log
cat other.log second.log >parts.log
refuses test_each_part_of_a_joined_log_is_looked_at "parts.log:3: rms_mm: 999, expected" --trials 2 --only legato,himc,computed-torque --log parts.log
check test_a_single_trial_has_no_deviation [ "$(row first.csv 6)" = nan ]
sed '2s/legato/legatto/' whole.log >foreign.log
refuses test_a_foreign_row_is_refused_with_its_line "foreign.log:2: not a row of trials" --trials 2 --log foreign.log
sed '3s/[^,]*$/nan/' whole.log >nan.log
refuses test_a_number_not_finite_is_refused_with_its_line "nan.log:3: played: nan" --trials 2 --log nan.log
refuses test_a_comma_alone_is_refused "--only: no word, expected" --trials 2 --only ,
# before the trials: they would take hours
two_hours="--trials 10000 --csv /nonexistent/x"
timeout 60 "$himc" evaluate $two_hours >stdout 2>stderr
check test_that_is_told_at_once [ $? != 124 ]
check test_a_table_that_cannot_be_written_is_refused \
    [ "$(wc -l <stdout) $(wc -l <stderr) $(grep -cF "/nonexistent/x: cannot be written" stderr)" = "0 1 1" ]
for text in 'a letter' 'a letter\nof two lines\n'; do
    printf "$text" >letter.txt
    cp letter.txt kept.txt
    refuses test_a_file_that_is_not_a_log_is_refused "letter.txt:1: not a log of trials" --trials 2 --log letter.txt
    check test_what_is_no_log_stays_as_it_is cmp letter.txt kept.txt
done

finish
