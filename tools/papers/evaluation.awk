# evaluation.awk: docs/evaluation.md with the numbers of its tables as the trials have them (make papers).
#   awk -f evaluation.awk spread.csv database.csv docs/evaluation.md
# The first table with a row for each nuance is that of the printed law (gain 1 and 3), the second that of the two other laws.
BEGIN { FS = "," }
FNR == 1 { file++ }
file == 1 { mean[$1, $2, $3, $4] = $6; sd[$1, $2, $3, $4] = $7; own[$1, $2, $3, $4] = $8; next }
file == 2 {
    line[$1, $2] = sprintf("| %s | %s | %s | %s | %s .. %s | %s, %s, %s | %d of %d |", $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)
    next
}
# the deviation in one sequence only where a sequence was played twice
function cell(k) { return sprintf("%.2f ± %.2f", mean[k], sd[k]) (own[k] ~ /[0-9]/ ? sprintf(" (%.2f)", own[k]) : "") }
function pair(gain, nuance, law,    id, himc) {
    id = gain SUBSEP nuance SUBSEP "id" SUBSEP law
    himc = gain SUBSEP nuance SUBSEP "himc" SUBSEP law
    return sprintf(" %s | %s | %.2f |", cell(id), cell(himc), mean[id] - mean[himc])
}
/^\| legato \| .*±/ { table++ }
/^\| [a-z-]+ \| .*±/ {
    split($0, part, " [|] ")
    nuance = substr(part[1], 3)
    print "| " nuance " |" (table == 1 ? pair(1, nuance, "printed") pair(3, nuance, "printed") : pair(3, nuance, "feedforward") pair(3, nuance, "computed-torque"))
    next
}
/^\| (computed-torque|feedforward) \| / {
    split($0, part, " [|] ")
    print line[substr(part[1], 3), part[2]]
    next
}
{ print }
