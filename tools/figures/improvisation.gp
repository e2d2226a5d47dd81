# improvisation.gp: a performance in one picture, in the manner of figure 8 of Bouënard, Gibet and Wanderley 2012.
#
# Three rows share their time axis: heights of the drumstick tips, contact forces, sound; on the left the whole
# piece, on the right an excerpt of it. Wanted, by gnuplot -e:
#   motion, strokes   tables of himc render
#   sound             time, least and greatest sample of each millisecond
#   from, to, length  of the excerpt and of the whole (s)
#   said              the line under the title
#   picture           the PNG to write
set terminal pngcairo size 1600,1000 font "DejaVu Sans,12" background "#ffffff"
set output picture
set datafile separator ","

# Okabe and Ito's colours, told apart by all eyes
left_hand = "#0072b2"
right_hand = "#d55e00"
ink = "#333333"
pale = "#8a8a8a"
grid = "#e4e4e4"
shade = "#f2efe4"
wave = "#5b6770"

# a tip touches the head where it is while a force acts
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
stats strokes using "peak_force_n" nooutput
force_top = STATS_max * 1.2
stats motion using (height("left", "tip")) nooutput
height_top = STATS_max
stats motion using (height("right", "tip")) nooutput
height_top = (height_top > STATS_max ? height_top : STATS_max) * 1.08
stats sound using (abs($2) > abs($3) ? abs($2) : abs($3)) nooutput
sound_top = STATS_max * 1.12

set border 3 linecolor rgb pale linewidth 1
set tics out nomirror scale 0.5 textcolor rgb ink
set grid ytics linetype 1 linecolor rgb grid linewidth 1
set style fill solid 1 noborder
unset key

# where the rows and columns are, in parts of the page
row_top(i) = 0.875 - 0.272 * i
row_bottom(i) = row_top(i) - 0.235
column_left(i) = i ? 0.625 : 0.06
column_right(i) = i ? 0.985 : 0.575

set multiplot
set label 1 "From a score to a sounding timpani" at screen 0.06,0.963 font "DejaVu Sans Bold,19" textcolor rgb ink
set label 2 said at screen 0.06,0.928 font "DejaVu Sans,12.5" textcolor rgb "#666666"
set label 3 "{/:Bold left}" at screen 0.885,0.963 textcolor rgb left_hand font "DejaVu Sans,13"
set label 4 "{/:Bold right}" at screen 0.93,0.963 textcolor rgb right_hand font "DejaVu Sans,13"
set label 5 "simulated, broken line: target" at screen 0.985,0.928 right textcolor rgb "#666666" font "DejaVu Sans,12.5"

do for [c = 0:1] {
    set lmargin at screen column_left(c)
    set rmargin at screen column_right(c)
    set xrange [(c ? from : 0):(c ? to : length)]
    step = c ? 1 : 5
    set xtics step
    thick = c ? 2.4 : 1.3
    thin = c ? 1 : 0.6
    if (c == 0) {
        set object 1 rectangle from from,graph 0 to to,graph 1 behind fillcolor rgb shade fillstyle solid noborder
    } else {
        set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb shade fillstyle solid noborder
    }

    # heights
    set tmargin at screen row_top(0)
    set bmargin at screen row_bottom(0)
    set format x ""
    set yrange [-4:height_top]
    set ytics 10
    if (c == 0) { set ylabel "height of the tip (cm)" textcolor rgb ink offset 0.5,0 } else { unset ylabel }
    plot 0 with lines linecolor rgb pale linewidth 0.8 notitle, \
         motion using 1:(height("left", "tip")) with lines linecolor rgb left_hand linewidth thick, \
         motion using 1:(height("right", "tip")) with lines linecolor rgb right_hand linewidth thick, \
         motion using 1:(height("left", "target")) with lines dashtype (6,6) linecolor rgb "#00334f" linewidth thin, \
         motion using 1:(height("right", "target")) with lines dashtype (6,6) linecolor rgb "#5e2900" linewidth thin
    unset label 1; unset label 2; unset label 3; unset label 4; unset label 5

    # forces
    set tmargin at screen row_top(1)
    set bmargin at screen row_bottom(1)
    set yrange [0:force_top]
    set ytics 20
    if (c == 0) { set ylabel "contact force (N)" }
    plot strokes using 1:(force("left")) with impulses linecolor rgb left_hand linewidth (c ? 3 : 1.8), \
         strokes using 1:(force("right")) with impulses linecolor rgb right_hand linewidth (c ? 3 : 1.8), \
         strokes using 1:(force("left")) with points pointtype 7 pointsize (c ? 1.1 : 0.6) linecolor rgb left_hand, \
         strokes using 1:(force("right")) with points pointtype 7 pointsize (c ? 1.1 : 0.6) linecolor rgb right_hand, \
         strokes using 1:(c ? column("peak_force_n") : NaN):(sprintf("%.1f N", column("peak_force_n"))) \
             with labels offset 0,1 textcolor rgb ink font "DejaVu Sans,12"

    # sound
    set tmargin at screen row_top(2)
    set bmargin at screen row_bottom(2)
    set format x "%g"
    set xlabel "time (s)" textcolor rgb ink offset 0,0.2
    set yrange [-sound_top:sound_top]
    set ytics autofreq
    if (c == 0) { set ylabel "sound" }
    plot sound using 1:2:3 with filledcurves linecolor rgb wave
    unset xlabel
    unset object 1
}
unset multiplot
