# score.awk: the time of each stroke and tempo of a score (s): `time stroke HAND NUANCE` and `time tempo BPM -`.
# A tempo holds from its beat on; without one it holds from the beginning.
function when(beat) {
    return at + (beat - from) * 60 / bpm
}
{
    sub(/;.*/, "")
}
$1 == "tempo" {
    at = NF > 2 ? when($3) : 0
    from = NF > 2 ? $3 : 0
    bpm = $2
    change[++changes] = at " " from " " bpm
}
$1 == "stroke" {
    beat[++strokes] = $2
    how[strokes] = $3 " " $4
}
END {
    for (i = 1; i <= changes; i++) {
        split(change[i], now, " ")
        printf "%.6f tempo %g -\n", now[1], now[3]
    }
    for (i = 1; i <= strokes; i++) {
        for (k = 1; k <= changes; k++) {
            split(change[k], now, " ")
            if (now[2] <= beat[i])
                time = now[1] + (beat[i] - now[2]) * 60 / now[3]
        }
        printf "%.6f stroke %s\n", time, how[i]
    }
}
