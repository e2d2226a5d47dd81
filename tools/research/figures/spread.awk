# spread.awk: spread of the trials' errors from the log of himc evaluate, with the columns of `claim nuances`: gain over the
# stiffness of a player (3, the default), nuance, controller, law, trials, mean RMS error (% of amplitude), standard
# deviation of all trials, deviation within a sequence (trials whose numbers differ by nine; NaN if there are no two). Trials above `trials` are
# left out, as `himc evaluate --trials` does: a log may have more of some rows than of others.
BEGIN { FS = ","; SEQUENCES = 9 }
$4 !~ /^[0-9]+$/ || $4 > trials + 0 || $2 == "ik" || seen[$0]++ { next }
{
    row = $1 "," $2 "," $3
    if (!(row in n)) order[++rows] = row
    x = 100 * $5 / $7
    n[row]++; sum[row] += x; squares[row] += x * x
    own = row SUBSEP ($4 - 1) % SEQUENCES
    if (!(own in m)) sequences[row]++
    m[own]++; part[own] += x
}
END {
    for (own in m) { split(own, key, SUBSEP); between[key[1]] += part[own] ^ 2 / m[own] }
    for (i = 1; i <= rows; i++) {
        row = order[i]; mean = sum[row] / n[row]
        all = n[row] > 1 ? sqrt((squares[row] - n[row] * mean ^ 2) / (n[row] - 1)) : 0
        free = n[row] - sequences[row]
        same = free > 0 ? sprintf("%.4f", sqrt((squares[row] - between[row]) / free)) : "NaN"
        printf "3,%s,%d,%.4f,%.4f,%s\n", row, n[row], mean, all, same
    }
}
