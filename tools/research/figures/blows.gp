# blows.gp: figure 8 of Bouënard, Gibet and Wanderley 2012 remade: five strokes, where they meet the head, how hard, and the
# sound. Variables:
#   strokes, sound   of himc render (one channel)
#   out, kind        the file to write, svg or png
load "tools/research/figures/style.gp"
eval terminal(1200, 700)
set output out
set datafile separator ","
radius = 0.2921 # of 23 inches
set table $blow
plot strokes using (column("time_s")):(column("x_m")):(column("y_m")):(column("peak_force_n")) with table
unset table
set datafile separator whitespace
stats $blow using 4 name "FORCE" nooutput
array time[FORCE_records]
stats $blow using (time[int($0) + 1] = $1) nooutput
wave = "'".sound."' binary format='%float' skip=80"
eval "stats ".wave." using (abs($1)) name 'PEAK' nooutput"

unset key
set multiplot
set label 1 "Five strokes on a head of 23 inches: place, force, sound" at screen 0.075,0.955 font bold textcolor rgb ink
set label 2 "the third the hardest; the fourth on the ringing head, the fifth, about as hard, on the head at rest" \
    at screen 0.075,0.905 font ",13" textcolor rgb soft
do for [i = 1:FORCE_records] {
    set lmargin at screen 0.075 + 0.184 * (i - 1)
    set rmargin at screen 0.075 + 0.184 * (i - 1) + 0.170
    if (i > 1) { set format y ""; unset ylabel }
    set tmargin at screen 0.84
    set bmargin at screen 0.55
    unset xtics; unset ytics; unset border; unset grid
    set size ratio -1
    set xrange [-1.1 * radius:1.1 * radius]
    set yrange [-1.1 * radius:1.1 * radius]
    # as the player sees the head: x away from him, y to his left
    set object 1 circle at 0,0 size radius fillstyle empty border linecolor rgb ink linewidth 1.5
    plot $blow every ::i-1::i-1 using (-$3):2 with points pointtype 7 pointsize 2 linecolor rgb himc
    unset object 1
    unset label
    set size noratio
    set border 3; set xtics 0.1; set ytics; set grid ytics linetype 1 linecolor rgb rule linewidth 1
    set tmargin at screen 0.52
    set bmargin at screen 0.37
    set xrange [-1:1]
    set yrange [0:FORCE_max * 1.35]
    set ytics 50
    unset xtics
    if (i == 1) { set ylabel "force (N)" textcolor rgb ink }
    set boxwidth 0.5
    set style fill solid 0.85 noborder
    plot $blow every ::i-1::i-1 using (0):4 with boxes linecolor rgb himc, \
         $blow every ::i-1::i-1 using (0):4:(sprintf("%.1f N", $4)) with labels offset 0,0.8 textcolor rgb ink
    set tmargin at screen 0.31
    set bmargin at screen 0.10
    set xrange [0:0.35]
    set yrange [-1.1 * PEAK_max:1.1 * PEAK_max]
    set ytics 0.1
    set xtics 0.1
    set xlabel "time from the stroke (s)" textcolor rgb ink
    if (i == 1) { set ylabel "sound (1: full scale)" textcolor rgb ink }
    eval "plot ".wave." using ($0 / 48000 - time[i] + 0.02):1 every ::int(48000*(time[i]-0.02))::int(48000*(time[i]+0.33)) with lines linewidth 0.8 linecolor rgb captured"
    unset xlabel
    set ytics autofreq
}
unset multiplot
