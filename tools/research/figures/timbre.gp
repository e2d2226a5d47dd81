# timbre.gp: spectra of single strokes, three panels, from what `timbre` prints. Variables: data, kind, out.
load "tools/research/figures/style.gp"
eval terminal(900, 900)
set output out
set multiplot layout 3,1
set grid
set yrange [-110:-30]
set xrange [40:1600]
set ylabel "level (dB)"
set key top right
set title "where: medium mallet, 3 m/s"
plot data index 0 using 1:2 with lines title "center", '' index 0 using 1:3 with lines title "normal", \
     '' index 0 using 1:4 with lines title "rim"
set title "with what: normal place, 3 m/s"
plot data index 1 using 1:2 with lines title "soft", '' index 1 using 1:3 with lines title "medium", \
     '' index 1 using 1:4 with lines title "hard", '' index 1 using 1:5 with lines title "wood"
set title "how hard: medium mallet, normal place"
set xlabel "frequency (Hz)"
plot data index 2 using 1:2 with lines title "pp, 0.5 m/s", '' index 2 using 1:3 with lines title "mf, 2 m/s", \
     '' index 2 using 1:4 with lines title "ff, 8 m/s"
unset multiplot
