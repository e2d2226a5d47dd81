# evaluation.gp: figure 6(b) of Bouënard, Gibet and Wanderley 2012 remade: error of the tip over many trials, ID and
# HIMC, each nuance. Wanted:
#   gentle       of `claim nuances`: the printed law, servos as soft as a player's
#   table        the same columns for the other laws, of spread.awk
#   kind, out    svg or png, the file to write
load "tools/figures/style.gp"
eval terminal(1500, 620)
set output out
array name[5] = ["legato", "tenuto", "accent", "vertical-accent", "staccato"]
array panel[4] = ["printed law, gain × 1", "printed law, gain × 3", "feedforward, gain × 3", "computed torque, gain × 3"]
array step[4] = [5, 1, 0.5, 0.5]
array law[4] = ["printed", "printed", "feedforward", "computed-torque"]
place(what) = what eq name[1] ? 5 : what eq name[2] ? 4 : what eq name[3] ? 3 : what eq name[4] ? 2 : 1

unset key
set multiplot
eval legend(1, 0.570, 0.945, id, "ID")
eval legend(2, 0.640, 0.945, himc, "HIMC")
eval legend(3, 0.725, 0.945, captured, "standard deviation of all trials;")
set label 14 "thick: of one sequence disturbed" at screen 0.752,0.895 font ",13" textcolor rgb ink
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
# mean and deviations in percent of amplitude: of one control under one law
is(control, i) = strcol(2) eq control && strcol(3) eq law[i] ? 1 : NaN
do for [i = 1:4] {
    left = 0.105 + 0.226 * (i - 1)
    set lmargin at screen left
    set rmargin at screen left + 0.196
    set title panel[i] font ",13" textcolor rgb ink
    set xrange [0:*]
    set xtics step[i]
    if (i > 1) { set ytics ("" 5, "" 4, "" 3, "" 2, "" 1) }
    data = i == 1 ? gentle : table
    plot data using (0):(place(strcol(1))):(0):($4 * is("id", i)):(place(strcol(1))):(place(strcol(1)) + half) \
             with boxxyerror linecolor rgb id, \
         data using (0):(place(strcol(1))):(0):($4 * is("himc", i)):(place(strcol(1)) - half):(place(strcol(1))) \
             with boxxyerror linecolor rgb himc, \
         for [down = 0:1] data using ($4 * is(down ? "himc" : "id", i) - $6):(place(strcol(1)) + (0.5 - down) * half):(2 * $6):(0) \
             with vectors nohead linewidth 5 linecolor rgb captured, \
         for [down = 0:1] data using ($4 * is(down ? "himc" : "id", i)):(place(strcol(1)) + (0.5 - down) * half):5 \
             with xerrorbars pointtype 0 linewidth 1.5 linecolor rgb captured
    unset label
    unset arrow
}
unset multiplot
