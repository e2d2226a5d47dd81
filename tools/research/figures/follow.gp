# follow.gp: figure 5 of Bouënard, Gibet and Wanderley 2012 remade from the table of `strokes follow`. Variables:
#   data, said   the table and the line below the title
#   kind, out    svg or png, the file to write
load "tools/research/figures/style.gp"
eval terminal(1500, 860)
set output out

set datafile separator ","
set xrange [*:*] noextend
set xtics 0.5
array of[6] = ["wrist_deg", "elbow_deg", "shoulder_deg", "tip_cm", "wrist_cm", "elbow_cm"]
stats data using (column("captured_tip_cm")) nooutput
head = STATS_min
# the tip's height is drawn from the head
shown(motion, i) = column(motion."_".of[i]) - (i == 4 ? head : 0)

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
do for [i = 1:6] {
    left = 0.065 + 0.320 * ((i - 1) % 3)
    set lmargin at screen left
    set rmargin at screen left + 0.272
    set tmargin at screen (i <= 3 ? 0.825 : 0.425)
    set bmargin at screen (i <= 3 ? 0.520 : 0.120)
    set title name[i] font ",13" textcolor rgb ink offset 0,-0.4
    if (i <= 3) { set format x "" } else { set format x "%g"; set xlabel "time (s)" textcolor rgb ink }
    set yrange [*:*]
    if (i == 6) { set ytics 1 }
    plot data using (column("time_s")):(shown("captured", i)) with lines linewidth 2.6 linecolor rgb captured, \
         data using (column("time_s")):(shown("ik", i)) with lines linewidth 1.6 linecolor rgb ik, \
         data using (column("time_s")):(shown("id", i)) with lines linewidth 1.6 linecolor rgb id, \
         data using (column("time_s")):(shown("himc", i)) with lines linewidth 1.6 linecolor rgb himc
    unset label
    unset arrow
    set ytics autofreq
}
unset multiplot
