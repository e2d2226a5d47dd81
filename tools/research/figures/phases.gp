# phases.gp: figure 6(a) of Bouënard, Gibet and Wanderley 2012 remade from the table of `strokes phases`: depth and height of
# the right tip in the five nuances. Variables: data, said, kind, out.
load "tools/research/figures/style.gp"
eval terminal(1500, 560)
set output out

set datafile separator ","
array nuance[5] = ["legato", "tenuto", "accent", "vertical-accent", "staccato"]
array name[5] = ["legato", "tenuto", "accent", "vertical accent", "staccato"]
unset key
set multiplot
eval legend(1, 0.770, 0.945, captured, "captured")
eval legend(2, 0.880, 0.945, himc, "HIMC")
set label 1 "Phases of a stroke: depth and height of the stick's tip" at screen 0.05,0.945 font bold textcolor rgb ink
set label 2 said at screen 0.05,0.880 font ",13" textcolor rgb soft
set grid xtics ytics linetype 1 linecolor rgb rule linewidth 1
set xtics 10
set ytics 10
set tmargin at screen 0.755
set bmargin at screen 0.140
set xlabel "depth (cm)" textcolor rgb ink
of(n, x) = strcol("nuance") eq nuance[n] ? column(x) : NaN
do for [n = 1:5] {
    left = 0.05 + 0.190 * (n - 1)
    set lmargin at screen left
    set rmargin at screen left + 0.172
    set title name[n] font ",14" textcolor rgb ink
    if (n == 1) { set ylabel "height above the head (cm)" textcolor rgb ink } else { unset ylabel; set format y "" }
    # the origin is the mean place within 4 mm of the lowest height of the captured tip
    set autoscale # stats leaves out what is out of range
    stats data using (of(n, "captured_height_cm")) name "Z" nooutput
    stats data using (of(n, "captured_height_cm") < Z_min + 0.4 ? of(n, "captured_depth_cm") : NaN) name "X" nooutput
    set xrange [-36:6]
    set yrange [-3:58]
    plot data using (of(n, "captured_depth_cm") - X_mean):(of(n, "captured_height_cm") - Z_min) \
             with lines linewidth 2.2 linecolor rgb captured, \
         data using (of(n, "himc_depth_cm") - X_mean):(of(n, "himc_height_cm") - Z_min) \
             with lines linewidth 1.3 linecolor rgb himc
    unset label
    unset arrow
}
unset multiplot
