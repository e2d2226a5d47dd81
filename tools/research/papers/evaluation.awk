# evaluation.awk: docs/results/evaluation.md with the numbers of its tables as the trials have them (make papers).
#   awk -f evaluation.awk spread.csv database.csv docs/results/evaluation.md
# Three rows of the requirements are of database.csv. The first table with a row for each nuance is that of the printed law (gain 1 and 3), the second that of the two other laws.
BEGIN { FS = "," }
FNR == 1 { file++ }
file == 1 { mean[$1, $2, $3, $4] = $6; count($1 SUBSEP $4, $5 + 0); next }
file == 2 {
    if ($2 == "all") { outside[$1] = $3; all[$1] = $4; angles[$1] = sprintf("%.2f°, %.2f°, %.2f°", $7, $8, $9); most[$1] = $7 > $8 ? ($7 > $9 ? $7 : $9) : ($8 > $9 ? $8 : $9); landed[$1] = sprintf("%d of %d strokes landed", $10, $11) }
    if ($1 == "feedforward" && $2 != "all" && $3 > most_outside + 0) { most_outside = $3; worst = $2 }
    line[$1, $2] = sprintf("| %s | %s | %s | %s | %s .. %s | %s, %s, %s | %d of %d |", $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11)
    next
}
# trials of each number of a gain and law, least and most
function count(k, n) {
    if (!(k in least) || n < least[k]) least[k] = n
    if (n > most_of[k]) most_of[k] = n
}
function trials(gain, law,    k) { k = gain SUBSEP law; return least[k] == most_of[k] ? least[k] : least[k] " to " most_of[k] }
/^Trials of each number: / {
    print "Trials of each number: printed law, gain × 1, " trials(1, "printed") "; gain × 3, " trials(3, "printed") "; fed forward " trials(3, "feedforward") "; computed torque " trials(3, "computed-torque") "."
    next
}
function pair(gain, nuance, law,    id, himc) {
    id = gain SUBSEP nuance SUBSEP "id" SUBSEP law
    himc = gain SUBSEP nuance SUBSEP "himc" SUBSEP law
    return sprintf(" %.2f | %.2f | %.2f |", mean[id], mean[himc], mean[id] - mean[himc])
}
/^\| legato \|/ { table++ }
/^\| (legato|tenuto|accent|vertical-accent|staccato) \|/ {
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
# what the requirements ask of all sequences: the cells `here` of their rows
function met(good) { return good ? "met" : "not met" }
function here(text) { match($0, /^[|][^|]*[|][^|]*[|]/); print substr($0, 1, RLENGTH) " " text " |" }
/^\| tips in `himc`, default law/ { here(outside["computed-torque"] " % / " all["computed-torque"] " %, " landed["computed-torque"] ": " met(outside["computed-torque"] + 0 <= 0.05) " / " met(all["computed-torque"] + 0 <= 0.3)); next }
/^\| `feedforward` at 2 strokes/ { here(outside["feedforward"] " %, " landed["feedforward"] ": " met(outside["feedforward"] + 0 <= 0.6) " over all; " worst ", the largest, " most_outside); next }
/^\| shoulder, elbow, wrist against/ { here(angles["computed-torque"] " over all: " met(most["computed-torque"] <= 1)); next }
{ print }
