# score.gp: figure 5 of Bouënard, Gibet and Wanderley 2009 (Real-time simulation and interaction of percussion
# gestures, preprint) remade: a score of legato and accent beats, and the heights of both tips while it is played. Variables:
#   beats        of score.awk
#   motion       table of himc render
#   kind, out    svg or png, the file to write
load "tools/research/figures/style.gp"
eval terminal(1500, 900)
set output out
set datafile separator ","
set table $touches
plot motion using (column("left_force_n") > 0 ? column("left_tip_z_m") : NaN) with table, \
     motion using (column("right_force_n") > 0 ? column("right_tip_z_m") : NaN) with table
unset table
set datafile separator whitespace
stats $touches using 1 nooutput
head = STATS_median
stats beats using 1 nooutput
last = STATS_max + 1

set multiplot
set lmargin at screen 0.065
set rmargin at screen 0.985
set xrange [0.5:last]
set xtics 1
set label 1 "Legato and accent beats under a varying tempo" at screen 0.065,0.958 font bold textcolor rgb ink
how = "the score, notes where they sound: right hand stems up, left hand stems down, > an accent; " \
    . "below, the tips of the virtual timpanist"
set label 2 how at screen 0.065,0.916 font ",13" textcolor rgb soft

# the score: notes stand where they sound, so a hurrying tempo draws them together
set tmargin at screen 0.870
set bmargin at screen 0.690
set yrange [-3.6:5.6]
unset ytics
unset grid
unset key
set border 0
unset xtics
is(what) = strcol(2) eq what
hand(side, y) = is("stroke") && strcol(3) eq side ? y : NaN
accent(side, y) = strcol(4) eq "accent" ? hand(side, y) : NaN
note = 2.1
stem = 0.047
plot 0 with lines linewidth 1.2 linecolor rgb ink, \
     beats using ($1 + stem):(hand("right", 0)):(0):(2.6) with vectors nohead linewidth 1.6 linecolor rgb ink, \
     beats using ($1 - stem):(hand("left", 0)):(0):(-2.6) with vectors nohead linewidth 1.6 linecolor rgb ink, \
     beats using 1:(hand("right", 0)) with points pointtype 7 pointsize note linecolor rgb ink, \
     beats using 1:(hand("left", 0)) with points pointtype 7 pointsize note linecolor rgb ink, \
     beats using 1:(accent("right", -1.5)):(">") with labels font bold textcolor rgb himc, \
     beats using 1:(accent("left", 1.5)):(">") with labels font bold textcolor rgb himc, \
     beats using (is("tempo") ? ($1 < 0.6 ? 0.6 : $1) : NaN):(4.6):(sprintf("♩ = %g", $3)) \
         with labels left font ",13" textcolor rgb ink
unset label

set datafile separator ","
set border 3
set xtics 1
set ytics 20
set grid xtics ytics linetype 1 linecolor rgb rule linewidth 1
set yrange [*:*]
stats motion using (100 * (column("right_tip_z_m") - head)) name "R" nooutput
stats motion using (100 * (column("left_tip_z_m") - head)) name "L" nooutput
set yrange [-4:1.08 * (R_max > L_max ? R_max : L_max)]
set ylabel "right tip above\nthe head (cm)" textcolor rgb ink
set format x ""
set tmargin at screen 0.665
set bmargin at screen 0.390
plot 0 with lines linewidth 0.8 linecolor rgb soft, \
     motion using 1:(100 * (column("right_tip_z_m") - head)) with lines linewidth 2 linecolor rgb himc
set ylabel "left tip above\nthe head (cm)"
set format x "%g"
set xlabel "time (s)" textcolor rgb ink
set tmargin at screen 0.355
set bmargin at screen 0.080
plot 0 with lines linewidth 0.8 linecolor rgb soft, \
     motion using 1:(100 * (column("left_tip_z_m") - head)) with lines linewidth 2 linecolor rgb himc
unset multiplot
