# report.gp: ring times of the lines of recorded and computed strokes; variable: folder
load "tools/research/figures/style.gp"
kind = "png"
eval(terminal(1100, 760))
set output folder."/lines.png"
set multiplot layout 2,2 margins 0.06,0.98,0.08,0.95 spacing 0.06,0.1
set logscale y
set xrange [40:900]
set yrange [0.3:60]
set key top right samplen 2
do for [name in "C2 G2 A2 F#3"] {
    data = folder."/".name.".dat"
    set title name.": ring time T60 (s) of the lines (Hz)"
    plot data index 0 using 1:2 with points pointtype 7 pointsize 1 linecolor rgb himc title "computed", \
         "" index 1 using 1:2:3 with yerrorbars pointtype 5 pointsize 0.8 linecolor rgb captured title "recorded", \
         "" index 2 using 1:2 with lines linewidth 2 linecolor rgb soft title "between the recorded lines: their hall"
}
