# follow.gp: figure 5 of Bouënard, Gibet and Wanderley 2012 remade from what `strokes follow` prints. Wanted:
#   data, said   the table and the line below the title
#   from, to     of the excerpt (s)
#   kind, out    svg or png, the file to write
load "tools/figures/style.gp"
eval terminal(1500, 860)
set output out

# captured is the same in all blocks; columns 2 .. 7 captured, 8 .. 13 simulated
set xrange [from:to]
set xtics 0.5
stats data index 0 using 5 nooutput
head = STATS_min
# of the six, three are angles and the fourth is shown from the head
which(c) = (c - 2) % 6
shown(c) = which(c) < 3 ? column(c) : 100 * (column(c) - (which(c) == 3 ? head : 0))

unset key
set multiplot
eval legend(1, 0.660, 0.960, captured, "captured")
eval legend(2, 0.765, 0.960, ik, "IK")
eval legend(3, 0.835, 0.960, id, "ID")
eval legend(4, 0.905, 0.960, himc, "HIMC")
set label 1 "Captured strokes and what the controllers make of them" at screen 0.065,0.960 font bold textcolor rgb ink
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
    if (i == 5) { set ytics 1 }
    c = i + 2
    plot data index 0 using 1:(shown(c)) with lines linewidth 2.6 linecolor rgb captured, \
         data index 0 using 1:(shown(c + 6)) with lines linewidth 1.6 linecolor rgb ik, \
         data index 1 using 1:(shown(c + 6)) with lines linewidth 1.6 linecolor rgb id, \
         data index 2 using 1:(shown(c + 6)) with lines linewidth 1.6 linecolor rgb himc
    unset label
    unset arrow
    set ytics autofreq
}
unset multiplot
