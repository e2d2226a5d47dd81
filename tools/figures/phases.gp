# phases.gp: figure 6(a) of Bouënard, Gibet and Wanderley 2012 remade from what `strokes phases` prints:
# depth and height of the right tip in the five nuances. Wanted: data; said; from, to (s); kind; out.
load "tools/figures/style.gp"
eval terminal(1500, 560)
set output out

array name[5] = ["legato", "tenuto", "accent", "vertical accent", "staccato"]
unset key
set multiplot
eval legend(1, 0.770, 0.945, captured, "captured")
eval legend(2, 0.880, 0.945, himc, "HIMC")
set label 1 "Phases of a stroke: depth and height of the stick's tip" at screen 0.05,0.945 font bold textcolor rgb ink
set label 2 said at screen 0.05,0.880 font ",13" textcolor rgb soft
set grid xtics ytics linetype 1 linecolor rgb rule linewidth 1
set xrange [-36:6]
set yrange [-3:58]
set xtics 10
set ytics 10
set tmargin at screen 0.755
set bmargin at screen 0.140
set xlabel "depth (cm)" textcolor rgb ink
during(x) = $1 >= from && $1 <= to ? x : NaN
do for [n = 0:4] {
    left = 0.05 + 0.190 * n
    set lmargin at screen left
    set rmargin at screen left + 0.172
    set title name[n + 1] font ",14" textcolor rgb ink
    if (n == 0) { set ylabel "height above the head (cm)" textcolor rgb ink } else { unset ylabel; set format y "" }
    # from where the captured tip is lowest
    stats data index n using 3 name "Z" nooutput
    stats data index n using 2:($3 < Z_min + 0.004 ? $3 : NaN) name "X" nooutput
    plot data index n using (during(100 * ($2 - X_mean_x))):(100 * ($3 - Z_min)) \
             with lines linewidth 2.2 linecolor rgb captured, \
         data index n using (during(100 * ($4 - X_mean_x))):(100 * ($5 - Z_min)) \
             with lines linewidth 1.3 linecolor rgb himc
    unset label
    unset arrow
}
unset multiplot
