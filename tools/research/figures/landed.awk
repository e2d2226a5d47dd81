# landed.awk: from the log of himc evaluate, strokes that land within 5 ms and 2 cm, and all strokes, of each controller and law,
# of the trials 1 .. `trials`.
BEGIN { FS = ","; OFS = ","; print "controller,law,landed,strokes" }
$4 !~ /^[0-9]+$/ || $4 > trials + 0 || seen[$0]++ { next }
{
    row = $2 OFS $3
    if (!(row in strokes)) order[++rows] = row
    landed[row] += $NF
    strokes[row] += $(NF - 1)
}
END {
    for (i = 1; i <= rows; i++)
        print order[i], landed[order[i]], strokes[order[i]]
}
