# report.gp: third octaves of recorded and computed strokes; variable: folder
load "tools/research/figures/style.gp"
kind = "png"
eval(terminal(1100, 760))
set output folder."/thirds.png"
set multiplot layout 2,2 margins 0.07,0.98,0.08,0.95 spacing 0.06,0.1
set logscale x 2
set xrange [55:5800]
set yrange [-72:0]
set xtics (63, 125, 250, 500, "1k" 1000, "2k" 2000, "4k" 4000)
set key top right samplen 2
do for [name in "C2 G2"] {
    do for [part in "onset tail"] {
        column = part eq "onset" ? 2 : 4
        when = part eq "onset" ? "the first 100 ms" : "0.3 to 0.8 s"
        set title sprintf("%s, %s: level (dB) of the third octaves (Hz)", name, when)
        plot folder."/".name.".dat" using 1:column with linespoints linewidth 2 linecolor rgb captured title "recorded", \
             "" using 1:column+1 with linespoints linewidth 2 linecolor rgb himc title "computed, in the nearest room"
    }
}
