# claim.gp: what the published claim depends on, from what `claim rates` prints. Wanted: data; said; kind; out.
load "tools/figures/style.gp"
eval terminal(1500, 900)
set output out

# one shade for each gain, from the softest; a block for each gain with limits and without
array gain[3] = ["gain × 1 (as soft as a player)", "gain × 2", "gain × 3 (our default)"]
array shade[3] = ["#7b3294", "#d95f02", "#1b7f8c"]
array side[2] = ["joint limits on", "joint limits off"]
set multiplot
set label 1 "HIMC against joint space control: what the published 2 % depend on" at screen 0.06,0.958 font bold textcolor rgb ink
set label 2 said at screen 0.06,0.916 font ",13" textcolor rgb soft
set xrange [0.9:3.1]
set xtics 0.5
do for [i = 0:1] {
    set lmargin at screen 0.06 + 0.5 * i
    set rmargin at screen 0.485 + 0.5 * i
    set title side[i + 1] font ",15" textcolor rgb ink
    set tmargin at screen 0.820
    set bmargin at screen 0.500
    set format x ""
    set yrange [0:*]
    unset xlabel
    set ylabel "RMS error of the tip\n(% of amplitude)" textcolor rgb ink
    if (i == 0) { set key top left vertical samplen 4 reverse Left textcolor rgb ink } else { unset key }
    plot keyentry with linespoints linewidth 2 dashtype 2 pointtype 6 linecolor rgb ink title "ID", \
         keyentry with linespoints linewidth 2 pointtype 7 linecolor rgb ink title "HIMC", \
         for [g = 0:2] data index 2 * g + i using 1:2 \
             with linespoints linewidth 2 dashtype 2 pointtype 6 linecolor rgb shade[g + 1] notitle, \
         for [g = 0:2] data index 2 * g + i using 1:3 \
             with linespoints linewidth 2.2 pointtype 7 linecolor rgb shade[g + 1] notitle
    unset label
    unset title
    set tmargin at screen 0.450
    set bmargin at screen 0.095
    set format x "%g"
    set yrange [*:*]
    set xlabel "strokes with each hand (1/s)" textcolor rgb ink
    set ylabel "ID minus HIMC\n(points of amplitude)"
    if (i == 0) { set key top right vertical samplen 3 reverse Left textcolor rgb ink } else { unset key }
    plot 2 with lines linewidth 2 dashtype 3 linecolor rgb himc title (i == 0 ? "as published, about 2" : ""), \
         0 with lines linewidth 1 linecolor rgb soft notitle, \
         for [g = 0:2] data index 2 * g + i using 1:4:5 \
             with yerrorbars linewidth 1.2 pointtype 0 linecolor rgb shade[g + 1] notitle, \
         for [g = 0:2] data index 2 * g + i using 1:4 \
             with linespoints linewidth 2.4 pointtype 7 linecolor rgb shade[g + 1] title gain[g + 1]
}
unset multiplot
