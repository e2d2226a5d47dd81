# style.gp: what the figures of motion share; wants `kind`, svg or png. Colours as in the papers.
captured = "#111111"
ik = "#2a9d4a"
id = "#1f5fbf"
himc = "#d62728"
ink = "#333333"
soft = "#6b6b6b"
rule = "#e4e4e4"

set encoding utf8
scale = 1.0
terminal_wide = kind eq "svg" \
    ? "set terminal svg size 1500,860 font 'DejaVu Sans,12' background '#ffffff' dynamic" \
    : "set terminal pngcairo size 1500,860 font 'DejaVu Sans,12' background '#ffffff'"
legend = "set key at screen 0.985,0.965 horizontal right samplen 2.5 width 1 textcolor rgb ink font ',13'"
set border 3 linecolor rgb "#9a9a9a" linewidth 1
set tics out nomirror scale 0.5 textcolor rgb ink
set grid ytics linetype 1 linecolor rgb rule linewidth 1
