# evaluation.gp: figure 6(b) of Bouënard, Gibet and Wanderley 2012 remade: error of the tip over many trials, ID and
# HIMC, each nuance. Wanted:
#   gentle       of `claim nuances`: the printed law, servos as soft as a player's
#   table        of himc evaluate
#   kind, out    svg or png, the file to write
load "tools/figures/style.gp"
eval terminal(1500, 620)
set output out
array name[5] = ["legato", "tenuto", "accent", "vertical-accent", "staccato"]
array panel[4] = ["printed law, gain × 1", "printed law, gain × 3", "feedforward, gain × 3", "computed torque, gain × 3"]
array step[4] = [5, 1, 0.5, 0.25]
array law[4] = ["", "printed", "feedforward", "computed-torque"]
place(what) = what eq name[1] ? 5 : what eq name[2] ? 4 : what eq name[3] ? 3 : what eq name[4] ? 2 : 1

unset key
set multiplot
eval legend(1, 0.570, 0.945, id, "ID")
eval legend(2, 0.640, 0.945, himc, "HIMC")
eval legend(3, 0.725, 0.945, captured, "standard deviation of the trials")
set label 1 "Error of the tip, joint space control and HIMC" at screen 0.105,0.945 font bold textcolor rgb ink
set label 2 said at screen 0.105,0.885 font ",13" textcolor rgb soft
set yrange [0.4:5.6]
set ytics ("legato" 5, "tenuto" 4, "accent" 3, "vertical accent" 2, "staccato" 1) font ",13"
unset grid
set grid xtics linetype 1 linecolor rgb rule linewidth 1
set xlabel "RMS error (% of amplitude)" textcolor rgb ink
set style fill solid 0.85 noborder
set tmargin at screen 0.765
set bmargin at screen 0.130
half = 0.36
# mean and deviation in percent of amplitude
is(control, i) = strcol(2) eq control && strcol(3) eq law[i] ? 1 : NaN
mean(control, i) = is(control, i) * column(8)
most(control, i) = 100 * column(6) / column(7)
do for [i = 1:4] {
    left = 0.105 + 0.226 * (i - 1)
    set lmargin at screen left
    set rmargin at screen left + 0.196
    set title panel[i] font ",13" textcolor rgb ink
    set xrange [0:*]
    set xtics step[i]
    if (i > 1) { set ytics ("" 5, "" 4, "" 3, "" 2, "" 1) }
    if (i == 1) {
        set datafile separator whitespace
        plot gentle using (0):(place(strcol(1))):(0):2:(place(strcol(1))):(place(strcol(1)) + half) \
                 with boxxyerror linecolor rgb id, \
             gentle using (0):(place(strcol(1))):(0):4:(place(strcol(1)) - half):(place(strcol(1))) \
                 with boxxyerror linecolor rgb himc, \
             gentle using 2:(place(strcol(1)) + half / 2):3 \
                 with xerrorbars pointtype 0 linewidth 2 linecolor rgb captured, \
             gentle using 4:(place(strcol(1)) - half / 2):5 \
                 with xerrorbars pointtype 0 linewidth 2 linecolor rgb captured
    } else {
        set datafile separator ","
        plot table using (0):(place(strcol(1))):(0):(mean("id", i)):(place(strcol(1))):(place(strcol(1)) + half) \
                 with boxxyerror linecolor rgb id, \
             table using (0):(place(strcol(1))):(0):(mean("himc", i)):(place(strcol(1)) - half):(place(strcol(1))) \
                 with boxxyerror linecolor rgb himc, \
             table using (mean("id", i)):(place(strcol(1)) + half / 2):(most("id", i)) \
                 with xerrorbars pointtype 0 linewidth 2 linecolor rgb captured, \
             table using (mean("himc", i)):(place(strcol(1)) - half / 2):(most("himc", i)) \
                 with xerrorbars pointtype 0 linewidth 2 linecolor rgb captured
    }
    unset label
    unset arrow
}
unset multiplot
