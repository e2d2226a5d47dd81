# improvisation.gp: a performance in one picture, in the manner of figure 8 of Bouënard, Gibet and
# Wanderley 2012.
#
# Three rows share their time axis: heights of the drumstick tips, contact forces, sound; on the
# left the whole piece, on the right an excerpt of it. Variables, set by gnuplot -e:
#   motion, strokes   tables of himc render
#   sound             time, least and greatest sample of each millisecond
#   from, to, length  of the excerpt and of the whole (s)
#   title, said       the line on top and the one below it
#   excerpt           caption of the excerpt
#   picture           the PNG to write
set terminal pngcairo size 1600,1000 font "DejaVu Sans,12" background "#ffffff"
set output picture
set datafile separator ","

# Okabe and Ito's colours, told apart by all eyes; the targets are darker shades of them
left_hand = "#0072b2"
right_hand = "#d55e00"
left_target = "#00263d"
right_target = "#4d1f00"
ink = "#333333"
soft = "#6b6b6b"
rule = "#e2e2e2"
shade = "#f5f1e3"
wave = "#4f5d66"

# the head is where a tip is while a force acts
set table $touches
plot motion using (column("left_force_n") > 0 ? column("left_tip_z_m") : NaN) with table, \
     motion using (column("right_force_n") > 0 ? column("right_tip_z_m") : NaN) with table
unset table
set datafile separator whitespace
stats $touches using 1 nooutput
head = STATS_median
set datafile separator ","
height(hand, what) = 100 * (column(hand."_".what."_z_m") - head)
force(hand) = strcol("hand") eq hand ? column("peak_force_n") : NaN
max(a, b) = a > b ? a : b

# the same scales left and right
stats motion using (max(height("left", "tip"), height("right", "tip"))) nooutput
height_top = STATS_max * 1.08
stats strokes using "peak_force_n" nooutput
force_top = STATS_max * 1.2
stats sound using (max(-$2, $3)) nooutput
sound_top = STATS_max * 1.1

set border 3 linecolor rgb "#9a9a9a" linewidth 1
set tics out nomirror scale 0.5 textcolor rgb ink
set grid ytics linetype 1 linecolor rgb rule linewidth 1
unset key

# where rows and columns are, in parts of the page
top(row) = 0.868 - 0.270 * row
bottom(row) = top(row) - 0.235
left(part) = part ? 0.625 : 0.058
right(part) = part ? 0.985 : 0.578

set multiplot

# title, captions, legend; they belong to the page and are drawn once, with the first panel
set label 1 title at screen 0.058,0.962 font "DejaVu Sans Bold,19" textcolor rgb ink
set label 2 said at screen 0.058,0.923 font "DejaVu Sans,13" textcolor rgb soft
set label 3 excerpt at screen 0.625,0.892 font "DejaVu Sans,12" textcolor rgb soft
set label 4 "the whole piece" at screen 0.058,0.892 font "DejaVu Sans,12" textcolor rgb soft
set label 5 "left hand" at screen 0.655,0.923 textcolor rgb left_hand
set label 6 "right hand" at screen 0.761,0.923 textcolor rgb right_hand
set label 7 "broken lines: target" at screen 0.874,0.923 textcolor rgb ink
set arrow 1 from screen 0.626,0.923 to screen 0.650,0.923 \
    nohead linewidth 4.5 linecolor rgb left_hand
set arrow 2 from screen 0.732,0.923 to screen 0.756,0.923 \
    nohead linewidth 4.5 linecolor rgb right_hand
set arrow 3 from screen 0.842,0.923 to screen 0.868,0.923 \
    nohead linewidth 1.4 dashtype (10,7) linecolor rgb "black"

do for [part = 0:1] {
    set lmargin at screen left(part)
    set rmargin at screen right(part)
    set xrange [(part ? from : 0):(part ? to : length)]
    every = part ? 1 : 5
    set xtics every
    if (part) {
        set object 1 rectangle from graph 0,0 to graph 1,1 behind \
            fillcolor rgb shade fillstyle solid noborder
    } else {
        set object 1 rectangle from from,graph 0 to to,graph 1 behind \
            fillcolor rgb shade fillstyle solid noborder
    }

    # heights
    set tmargin at screen top(0)
    set bmargin at screen bottom(0)
    set format x ""
    set yrange [-4:height_top]
    set ytics 20
    if (part == 0) { set ylabel "height of the tip (cm)" textcolor rgb ink offset 0.5,0 }
    simulated = part ? 4.5 : 2
    target = part ? 1.4 : 0.5
    plot 0 with lines linecolor rgb soft linewidth 0.8, \
         motion using 1:(height("left", "tip")) \
             with lines linecolor rgb left_hand linewidth simulated, \
         motion using 1:(height("right", "tip")) \
             with lines linecolor rgb right_hand linewidth simulated, \
         motion using 1:(height("left", "target")) \
             with lines dashtype (10,7) linecolor rgb left_target linewidth target, \
         motion using 1:(height("right", "target")) \
             with lines dashtype (10,7) linecolor rgb right_target linewidth target
    unset label
    unset arrow

    # forces; in the excerpt with their values
    set tmargin at screen top(1)
    set bmargin at screen bottom(1)
    set yrange [0:force_top]
    set ytics 40
    if (part == 0) { set ylabel "contact force (N)" }
    stem = part ? 3 : 1.8
    dot = part ? 1.2 : 0.6
    plot strokes using 1:(force("left")) with impulses linecolor rgb left_hand linewidth stem, \
         strokes using 1:(force("right")) with impulses linecolor rgb right_hand linewidth stem, \
         strokes using 1:(force("left")) \
             with points pointtype 7 pointsize dot linecolor rgb left_hand, \
         strokes using 1:(force("right")) \
             with points pointtype 7 pointsize dot linecolor rgb right_hand, \
         strokes using 1:(part ? column("peak_force_n") : NaN): \
             (sprintf("%.1f N", column("peak_force_n"))) \
             with labels offset 0,1 textcolor rgb ink

    # sound: from the least to the greatest sample of each millisecond
    set tmargin at screen top(2)
    set bmargin at screen bottom(2)
    set format x "%g"
    set xlabel "time (s)" textcolor rgb ink offset 0,0.2
    set yrange [-sound_top:sound_top]
    set ytics 0.5
    if (part == 0) { set ylabel "sound (1 = full scale)" }
    plot sound using 1:2:(0):($3 - $2) with vectors nohead linecolor rgb wave linewidth 0.8
    unset xlabel
    unset ylabel
}
unset multiplot
