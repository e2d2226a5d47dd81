# follow.gp: figure 5 of Bouënard, Gibet and Wanderley 2012 remade, the data from strokes.c:
#   gnuplot -e "data='follow.txt'; said='...'; out='strokes.svg'; kind='svg'" follow.gp
load "tools/figures/style.gp"
@terminal_wide
set output out

# captured is the same in all blocks; columns 2 .. 7 captured, 8 .. 13 simulated
set xrange [from:to]
set xtics 0.5
stats data index 0 using 5 nooutput
head = STATS_min
value(c) = c % 6 == 5 ? 100 * (column(c) - head) : c % 6 == 2 || c % 6 == 3 || c % 6 == 4 ? column(c) : 100 * column(c)

set multiplot
set label 1 title at screen 0.065,0.960 font ",19" textcolor rgb ink
set label 2 said at screen 0.065,0.917 font ",13" textcolor rgb soft
array name[6] = ["(a) wrist flexion (°)", "(b) elbow flexion (°)", "(c) shoulder flexion (°)", \
                 "(d) stick's tip above the head (cm)", "(e) height of the wrist (cm)", \
                 "(f) height of the elbow (cm)"]
do for [i = 0:5] {
    left = 0.065 + 0.320 * (i % 3)
    set lmargin at screen left
    set rmargin at screen left + 0.272
    set tmargin at screen (i < 3 ? 0.825 : 0.425)
    set bmargin at screen (i < 3 ? 0.520 : 0.120)
    set title name[i + 1] font ",13" textcolor rgb ink offset 0,-0.4
    if (i < 3) { set format x "" } else { set format x "%g"; set xlabel "time (s)" textcolor rgb ink }
    set yrange [*:*]
    if (i == 0) { @legend } else { unset key }
    c = i + 2
    plot data index 0 using 1:(value(c)) with lines linewidth 2.6 linecolor rgb captured title "captured", \
         data index 0 using 1:(value(c + 6)) with lines linewidth 1.6 linecolor rgb ik title "IK", \
         data index 1 using 1:(value(c + 6)) with lines linewidth 1.6 linecolor rgb id title "ID", \
         data index 2 using 1:(value(c + 6)) with lines linewidth 1.6 linecolor rgb himc title "HIMC"
    unset label
}
unset multiplot
