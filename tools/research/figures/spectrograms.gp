# spectrograms.gp: spectrograms of the four sounds of sounds.c, by spectrogram.c:
#   gnuplot -e "folder='build/figures'; out='spectrograms.png'" spectrograms.gp
set terminal pngcairo size 1200,1300 font "DejaVu Sans,11" background "#ffffff"
set output out
set multiplot layout 4,1
set palette defined (0 "#ffffff", 0.45 "#8fb8d8", 0.75 "#1f5f8f", 1 "#0a1a2a")
set cbrange [-90:-20]
set cblabel "dB"
set yrange [40:1400]
set ylabel "Hz"
set tics out
set title "scale: D3 E3 F#3 G3 A3 and back, by the pedal"
plot folder."/scale.txt" using 1:2:3 with image notitle
set title "roll: pp to ff to pp"
plot folder."/roll.txt" using 1:2:3 with image notitle
set title "glissando: D3 to A3 and back while it rings"
plot folder."/glissando.txt" using 1:2:3 with image notitle
set title "mallets: soft, medium, hard, wood; the same stroke"
set xlabel "s"
plot folder."/mallets.txt" using 1:2:3 with image notitle
unset multiplot
