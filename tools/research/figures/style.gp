# style.gp: common to the figures; variable: kind, svg or png. Colours as in the papers.
captured = "#111111"
ik = "#2a9d4a"
id = "#1f5fbf"
himc = "#d62728"
ink = "#333333"
soft = "#6b6b6b"
rule = "#e4e4e4"
bold = "DejaVu Sans Bold,19"

set encoding utf8
terminal(width, height) = sprintf("set terminal %s size %d,%d font 'DejaVu Sans,12' background '#ffffff'", \
                                  kind eq "svg" ? "svg" : "pngcairo", width, height)
# one entry of a legend on the page, to be evaluated: number, place, colour, words
legend(i, x, y, colour, words) = sprintf( \
    "set arrow %d from screen %g,%g rto screen 0.022,0 nohead linewidth 3 linecolor rgb '%s'; ", 10 + i, x, y, colour) . \
    sprintf("set label %d '%s' at screen %g,%g font ',13' textcolor rgb '%s'", 10 + i, words, x + 0.027, y, ink)
set border 3 linecolor rgb "#9a9a9a" linewidth 1
set tics out nomirror scale 0.5 textcolor rgb ink
set grid ytics linetype 1 linecolor rgb rule linewidth 1
