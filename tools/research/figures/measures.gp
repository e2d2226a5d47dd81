# measures.gp: the error that wrongly measured limbs cause, from the table of `claim measures`. Variables: data, kind, out.
load "tools/research/figures/style.gp"
eval terminal(1500, 560)
set output out

set datafile separator ","

# one shade for each law and gain
array shade[4] = ["#7b3294", "#d95f02", "#1b7f8c", "#a6761d"]
array words[4] = ["printed law, gain × 1", "printed law, gain × 3", "feedforward, gain × 3", "computed torque, gain × 3"]
array law[4] = ["printed", "printed", "feedforward", "computed-torque"]
array gain[4] = [1, 3, 3, 3]
only(i, x) = strcol("law") eq law[i] && column("gain") == gain[i] ? x : NaN
stats data using (column("trials")) name "TRIALS" nooutput
unset key
set multiplot
do for [i = 1:4] { eval legend(i, 0.06 + 0.19 * (i - 1), 0.835, shade[i], words[i]) }
set label 1 "Limbs not quite as long as measured: why HIMC misses less" at screen 0.06,0.945 font bold textcolor rgb ink
set label 2 sprintf("legato, joint limits on; mean and deviation of %g trials", TRIALS_max) at screen 0.06,0.890 font ",13" textcolor rgb soft
set tmargin at screen 0.770
set bmargin at screen 0.140
set xlabel "standard deviation of each limb's length (%)" textcolor rgb ink
set xrange [-0.05:2.05]
set xtics 0.5

set lmargin at screen 0.06
set rmargin at screen 0.485
set ylabel "RMS error of the tip\n(% of amplitude)" textcolor rgb ink
set logscale y
set yrange [0.1:30]
set ytics (0.1, 0.2, 0.5, 1, 2, 5, 10, 20)
set key at graph 0.03,0.64 left top vertical samplen 4 reverse Left textcolor rgb ink
plot keyentry with linespoints linewidth 2 dashtype 2 pointtype 6 linecolor rgb ink title "ID", \
     keyentry with linespoints linewidth 2 pointtype 7 linecolor rgb ink title "HIMC", \
     for [i = 1:4] data using (column("error_percent")):(only(i, column("id_percent"))) \
         with linespoints linewidth 2 dashtype 2 pointtype 6 linecolor rgb shade[i] notitle, \
     for [i = 1:4] data using (column("error_percent")):(only(i, column("himc_percent"))) \
         with linespoints linewidth 2.2 pointtype 7 linecolor rgb shade[i] notitle

unset label
unset arrow
unset key
unset logscale
set lmargin at screen 0.56
set rmargin at screen 0.985
set yrange [*:*]
set ytics auto
set ylabel "ID minus HIMC\n(points of amplitude)"
set label 4 "as published" at 0,2 offset 0,0.7 textcolor rgb himc
plot 2 with lines linewidth 2 dashtype 3 linecolor rgb himc, \
     0 with lines linewidth 1 linecolor rgb soft, \
     for [i = 1:4] data using (column("error_percent")):(only(i, column("difference"))):(column("difference_sd")) \
         with yerrorbars linewidth 1.2 pointtype 0 linecolor rgb shade[i], \
     for [i = 1:4] data using (column("error_percent")):(only(i, column("difference"))) \
         with linespoints linewidth 2.4 pointtype 7 linecolor rgb shade[i]
unset multiplot
