# measures.gp: what limbs that are measured wrong cost joint space control, from what `claim measures` prints. Wanted:
# data; said; kind; out.
load "tools/figures/style.gp"
eval terminal(1500, 560)
set output out

# a block for each
array shade[4] = ["#7b3294", "#d95f02", "#1b7f8c", "#a6761d"]
array law[4] = ["printed law, gain × 1", "printed law, gain × 3", "feedforward, gain × 3", "computed torque, gain × 3"]
unset key
set multiplot
do for [i = 1:4] { eval legend(i, 0.06 + 0.19 * (i - 1), 0.835, shade[i], law[i]) }
set label 1 "Limbs not quite as long as measured: why HIMC misses less" at screen 0.06,0.945 font bold textcolor rgb ink
set label 2 said at screen 0.06,0.890 font ",13" textcolor rgb soft
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
     for [i = 0:3] data index i using 1:2 \
         with linespoints linewidth 2 dashtype 2 pointtype 6 linecolor rgb shade[i + 1] notitle, \
     for [i = 0:3] data index i using 1:3 \
         with linespoints linewidth 2.2 pointtype 7 linecolor rgb shade[i + 1] notitle

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
     for [i = 0:3] data index i using 1:4:5 with yerrorbars linewidth 1.2 pointtype 0 linecolor rgb shade[i + 1], \
     for [i = 0:3] data index i using 1:4 with linespoints linewidth 2.4 pointtype 7 linecolor rgb shade[i + 1]
unset multiplot
