# curves.gp: one quantity of the table of `strokes follow` for some of its motions: figures 2 and 3 of Bouënard, Gibet and
# Wanderley at CASA 2009, which are figure 4 of their preprint. Variables:
#   data, said   the table and the line below the title
#   title, axis  what is drawn
#   quantity     its columns' ending: elbow_deg, tip_cm
#   motions      the columns' beginnings, each also a colour of style.gp
#   kind, out    svg or png, the file to write
load "tools/research/figures/style.gp"
# the papers' inverse kinematics, from the tip alone
reach = himc
eval terminal(1000, 480)
set output out
set datafile separator ","
set xrange [*:*] noextend
set xlabel "time (s)" textcolor rgb ink
set ylabel axis textcolor rgb ink
set lmargin at screen 0.085
set rmargin at screen 0.975
set tmargin at screen 0.800
set bmargin at screen 0.135
unset key
set label 1 title at screen 0.085,0.945 font bold textcolor rgb ink
set label 2 said at screen 0.085,0.875 font ",13" textcolor rgb soft
name(m) = m eq "captured" ? "captured" : m eq "reach" ? "IK from the tip" : m eq "id" ? "ID" : "HIMC"
do for [i = 1:words(motions)] {
    eval legend(i, 0.60 + 0.13 * (i - 1), 0.945, value(word(motions, i)), name(word(motions, i)))
}
plot for [m in motions] data using (column("time_s")):(column(m."_".quantity)) \
     with lines linewidth (m eq "captured" ? 2.6 : 1.8) linecolor rgb value(m)
