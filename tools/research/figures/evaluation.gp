# evaluation.gp: figure 6(b) of Bouënard, Gibet and Wanderley 2012 remade: error of the tip over many trials, ID and
# HIMC, each nuance. Variables:
#   data         table of `claim nuances` (the printed law, servos as soft as a player's), then of spread.awk
#   kind, out    svg or png, the file to write
load "tools/research/figures/style.gp"
eval terminal(1500, 620)
set output out
array name[5] = ["legato", "tenuto", "accent", "vertical-accent", "staccato"]
array panel[4] = ["printed law, gain × 1", "printed law, gain × 3", "feedforward, gain × 3", "computed torque, gain × 3"]
set datafile separator ","
array step[4] = [5, 1, 0.5, 0.5]
array gain[4] = [1, 3, 3, 3]
array law[4] = ["printed", "printed", "feedforward", "computed-torque"]
place(what) = what eq name[1] ? 5 : what eq name[2] ? 4 : what eq name[3] ? 3 : what eq name[4] ? 2 : 1

stats data using (column("trials")) name "TRIALS" nooutput
unset key
set multiplot
eval legend(1, 0.570, 0.945, id, "ID")
eval legend(2, 0.640, 0.945, himc, "HIMC")
eval legend(3, 0.725, 0.945, captured, "standard deviation of all trials;")
set label 14 "thick: of one sequence disturbed" at screen 0.752,0.895 font ",13" textcolor rgb ink
set label 1 "Error of the tip, joint space control and HIMC" at screen 0.105,0.945 font bold textcolor rgb ink
number = TRIALS_min == TRIALS_max ? sprintf("%g", TRIALS_max) : sprintf("%g to %g", TRIALS_min, TRIALS_max)
set label 2 sprintf("%s trials of each nuance; joint limits on", number) at screen 0.105,0.885 font ",13" textcolor rgb soft
set yrange [0.4:5.6]
set ytics ("legato" 5, "tenuto" 4, "accent" 3, "vertical accent" 2, "staccato" 1) font ",13"
unset grid
set grid xtics linetype 1 linecolor rgb rule linewidth 1
set xlabel "RMS error (% of amplitude)" textcolor rgb ink
set style fill solid 0.85 noborder
set tmargin at screen 0.765
set bmargin at screen 0.130
half = 0.36
# of one controller in one panel: mean and deviations (% of amplitude), and the place of its nuance
is(control, i) = strcol("controller") eq control && strcol("law") eq law[i] && column("gain") == gain[i] ? 1 : NaN
mean(control, i) = column("mean_percent") * is(control, i)
row(control) = place(strcol("nuance")) + (control eq "id" ? 0.5 : -0.5) * half
do for [i = 1:4] {
    left = 0.105 + 0.226 * (i - 1)
    set lmargin at screen left
    set rmargin at screen left + 0.196
    set title panel[i] font ",13" textcolor rgb ink
    set xrange [0:*]
    set xtics step[i]
    if (i > 1) { set ytics ("" 5, "" 4, "" 3, "" 2, "" 1) }
    plot for [c in "id himc"] data using (0):(row(c)):(0):(mean(c, i)):(row(c) - half / 2):(row(c) + half / 2) \
             with boxxyerror linecolor rgb c eq "id" ? id : himc, \
         for [c in "id himc"] data using (mean(c, i) - column("sequence_sd")):(row(c)):(2 * column("sequence_sd")):(0) \
             with vectors nohead linewidth 5 linecolor rgb captured, \
         for [c in "id himc"] data using (mean(c, i)):(row(c)):(column("sd")) \
             with xerrorbars pointtype 0 linewidth 1.5 linecolor rgb captured
    unset label
    unset arrow
}
unset multiplot
