# claim.gp: on what the published claim depends, from the table of `claim rates`. Variables: data, kind, out.
load "tools/research/figures/style.gp"
eval terminal(1500, 900)
set output out

set datafile separator ","

# one shade for each gain, from the softest
array shade[3] = ["#7b3294", "#d95f02", "#1b7f8c"]
array limits[2] = ["on", "off"]
only(g, l, x) = column("gain") == g && strcol("limits") eq limits[l] ? x : NaN
unset key
set multiplot
eval legend(1, 0.545, 0.916, shade[1], "gain × 1, soft as a player")
eval legend(2, 0.740, 0.916, shade[2], "gain × 2")
eval legend(3, 0.830, 0.916, shade[3], "gain × 3, our default")
stats data using (column("trials")) name "TRIALS" nooutput
stats data using (column("difference") - column("difference_sd")) name "LOW" nooutput
stats data using (column("difference") + column("difference_sd")) name "HIGH" nooutput
least = floor(LOW_min - 0.3)
most = ceil((HIGH_max > 2 ? HIGH_max : 2) + 0.3)
set label 1 "HIMC against joint space control: what the published 2 % depend on" \
    at screen 0.06,0.958 font bold textcolor rgb ink
set label 2 sprintf("printed law, legato made slower and faster; mean and deviation of %g trials", TRIALS_max) at screen 0.06,0.916 font ",13" textcolor rgb soft
set xrange [0.9:3.1]
set xtics 0.5
do for [i = 1:2] {
    set lmargin at screen 0.06 + 0.5 * (i - 1)
    set rmargin at screen 0.485 + 0.5 * (i - 1)
    set title "joint limits ".limits[i] font ",15" textcolor rgb ink
    set tmargin at screen 0.820
    set bmargin at screen 0.500
    set format x ""
    set yrange [0:*]
    unset xlabel
    set ylabel "RMS error of the tip\n(% of amplitude)" textcolor rgb ink
    if (i == 1) { set key top left vertical samplen 4 reverse Left textcolor rgb ink } else { unset key }
    plot keyentry with linespoints linewidth 2 dashtype 2 pointtype 6 linecolor rgb ink title "ID", \
         keyentry with linespoints linewidth 2 pointtype 7 linecolor rgb ink title "HIMC", \
         for [g = 1:3] data using (column("strokes_per_s")):(only(g, i, column("id_percent"))) \
             with linespoints linewidth 2 dashtype 2 pointtype 6 linecolor rgb shade[g] notitle, \
         for [g = 1:3] data using (column("strokes_per_s")):(only(g, i, column("himc_percent"))) \
             with linespoints linewidth 2.2 pointtype 7 linecolor rgb shade[g] notitle
    unset label
    unset arrow
    unset title
    set tmargin at screen 0.450
    set bmargin at screen 0.095
    set format x "%g"
    set yrange [least:most]
    set xlabel "strokes with each hand (1/s)" textcolor rgb ink
    set ylabel "ID minus HIMC\n(points of amplitude)"
    unset key
    set label 4 "as published" at 2.55,2 offset 0,0.7 textcolor rgb himc
    plot 2 with lines linewidth 2 dashtype 3 linecolor rgb himc, \
         0 with lines linewidth 1 linecolor rgb soft, \
         for [g = 1:3] data using (column("strokes_per_s")):(only(g, i, column("difference"))):(column("difference_sd")) \
             with yerrorbars linewidth 1.2 pointtype 0 linecolor rgb shade[g], \
         for [g = 1:3] data using (column("strokes_per_s")):(only(g, i, column("difference"))) \
             with linespoints linewidth 2.4 pointtype 7 linecolor rgb shade[g]
    unset label
}
unset multiplot
