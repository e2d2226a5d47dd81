# papers.awk: the rows of papers.sh. A table's values are value[TABLE, LINE, COLUMN], its number of lines is count[TABLE].
BEGIN {
    FS = ","
    # limits of verdicts, ours where the papers have no number; docs/results/papers.md names them
    CORRELATED = 0.8; NEAR = 0.25 # consistent: at least, and RMS distance over swing at most
    MORE = 1.05; LESS = 0.95      # ranges that are exaggerated, lost
    ALTERED = 0.1                 # ranges that differ by more
    ABOUT_LEAST = 1.5; ABOUT_MOST = 2.5 # about 2 %
    split("legato tenuto accent vertical-accent staccato", nuance, " ")
}
FNR == 1 {
    split(FILENAME, part, "/")
    for (i in part)
        if (part[i] ~ /\.csv$/)
            table = substr(part[i], 1, length(part[i]) - 4)
    for (i = 1; i <= NF; i++)
        column[name[i] = $i]
    next
}
{
    count[table]++
    for (i = 1; i <= NF; i++)
        value[table, count[table], name[i]] = $i
}

function abs(x) { return x < 0 ? -x : x }
function num(x, digits) { return sprintf("%." digits "f", x) }

# RMS distance of two columns of the strokes
function apart(t, a, b,    i, s) {
    for (i = 1; i <= count[t]; i++)
        s += (value[t, i, a] - value[t, i, b]) ^ 2
    return sqrt(s / count[t])
}
# range of a column, of the lines with `what` in column `which` if given
function range(t, a, which, what,    i, v, lo, hi, any) {
    for (i = 1; i <= count[t]; i++)
        if (!which || value[t, i, which] == what) {
            v = value[t, i, a] + 0
            lo = !any || v < lo ? v : lo
            hi = !any || v > hi ? v : hi
            any = 1
        }
    return hi - lo
}
function correlation(t, a, b,    i, n, x, y, sx, sy, xx, yy, xy) {
    n = count[t]
    for (i = 1; i <= n; i++) {
        x = value[t, i, a]
        y = value[t, i, b]
        sx += x; sy += y; xx += x * x; yy += y * y; xy += x * y
    }
    return (n * xy - sx * sy) / sqrt((n * xx - sx * sx) * (n * yy - sy * sy))
}
# the shift of a, in whole rows, that is nearest to b; `shifted` is the RMS distance that is left
function shift_of(t, a, b,    shift, i, s, best, at) {
    for (shift = 0; shift <= 12; shift++) {
        s = 0
        for (i = 13; i <= count[t]; i++)
            s += (value[t, i, b] - value[t, i - shift, a]) ^ 2
        if (shift == 0 || s < best) { best = s; at = shift }
    }
    shifted = sqrt(best / (count[t] - 12))
    return at
}
# how late b is (ms)
function late(t, a, b) { return 1000 * shift_of(t, a, b) * (value[t, 2, "time_s"] - value[t, 1, "time_s"]) }
# RMS distance of b from a, without that lag
function without_lag(t, a, b) { shift_of(t, a, b); return shifted }
# the value in column `out` of the line in which the columns of `keys` (a b c) have the `words`
function find(t, keys, words, out,    i, k, n, key, word, same) {
    n = split(keys, key, " ")
    split(words, word, " ")
    for (i = 1; i <= count[t]; i++) {
        same = 1
        for (k = 1; k <= n; k++)
            same = same && value[t, i, key[k]] == word[k]
        if (same)
            return value[t, i, out]
    }
    print "papers.awk: " t ": no line " words >"/dev/stderr"
    exit 1
}
function choices(command,    word) { return split(find("commands", "name", command, "grammar"), word, "|") }

# a row with a verdict
function print_row(place, there, here, verdict, command) {
    printf "| %s | %s | %s | %s | `%s` |\n", place, there, here, verdict, command
}
# `good`, a comparison of measured numbers, decides between "agrees" and `otherwise`, which follows from numbers too
function row(place, there, here, good, command, otherwise) {
    print_row(place, there, here, good ? "agrees" : otherwise ? otherwise : "does not agree", command)
}
# the same of a diagram or a design, whose parts are here and play
function built(place, there, here, good, command) {
    print_row(place, there, here, good ? "built" : "not built", command)
}
# the same where the input was chosen to give the number of the paper
function fitted(place, there, here, good, command) {
    print_row(place, there, here, good ? "fitted" : "not fitted", command)
}
# no number decides: `what` is our word, which the command lets one judge
function stated(place, there, here, what, command) {
    print_row(place, there, here, "stated: " what, command)
}
# the same of a height, of which the printed law's lag is the most; distances by it, without the lag, by computed torque
function nearer_late(himc, id, himc_shape, id_shape, himc_best, id_best) {
    return himc < id || himc_shape >= id_shape ? nearer(himc, id, himc_best, id_best) : "agrees without the law's lag, with it not"
}
# the verdict on "HIMC nearer than ID", from distances by the printed law, then by computed torque
function nearer(himc, id, himc_best, id_best) {
    return himc < id ? "agrees" : himc_best < id_best ? "by computed torque, not by theirs" : "does not agree"
}
# from `first` to `last` the durations of blows (ms)
function contacts(t, first, last) { return num(1000 * value[t, first, "duration_s"], 1) " to " num(1000 * value[t, last, "duration_s"], 1) " ms" }
function few_ms(t,    i, good) {
    good = 1
    for (i = 1; i <= 5; i++)
        good = good && value[t, i, "duration_s"] > 0.001 && value[t, i, "duration_s"] < 0.01
    return good
}
# whether sound rises with the force, and blow 4 is louder than blow 5 by more than its force explains; list_l is over the fifth
function rings(blows, loud,    i) {
    list_l = ""
    for (i = 1; i <= 5; i++)
        list_l = list_l (i > 1 ? ", " : "") num(value[loud, i, "rms"] / value[loud, 5, "rms"], 2)
    return value[loud, 1, "rms"] < value[loud, 2, "rms"] && value[loud, 2, "rms"] < value[loud, 3, "rms"] && value[loud, 4, "rms"] / value[loud, 5, "rms"] > value[blows, 4, "peak_force_n"] / value[blows, 5, "peak_force_n"]
}
function forces(t, first,    i, text) {
    for (i = first; i <= 5; i++)
        text = text (i > first ? ", " : "") num(value[t, i, "peak_force_n"], 1)
    return text
}
# two-way agrees, one-way, which is that of the papers, or not
function by_coupling(two, one) {
    return two && one ? "agrees" : two ? "by two-way coupling, not by theirs" : one ? "by their one-way coupling; by two-way, the default, not" : "does not agree"
}
# of default servos: errors with limbs right and 2 % wrong; whether those of id rise by more than those of himc
function measured(law, wrong, what) { return find("measures", "gain law error_percent", "3 " law " " wrong, what) }
function grown(law, who) { return num(measured(law, 0, who "_percent"), 2) " and " num(measured(law, 2, who "_percent"), 2) }
function greater(law) { return measured(law, 2, "difference") > measured(law, 2, "difference_sd") }
function adds_up(law) { return measured(law, 2, "difference") - measured(law, 0, "difference") > measured(law, 2, "difference_sd") }
function fact(what) { return find("facts", "name", what, "value") + 0 }
# whether the strokes of nuance n are deeper than those of the first three by more than the deviation of a difference of two strokes
function deeper(n,    k, good) {
    good = 1
    for (k = 1; k <= 3; k++)
        good = good && fact("depth_" nuance[n]) - fact("depth_" nuance[k]) > sqrt(fact("depth_sd_" nuance[n]) ^ 2 + fact("depth_sd_" nuance[k]) ^ 2)
    return good
}
function cost(what) { return find("costs", "name", what, "value") + 0 }
function landed_percent(words) { return 100 * find("landed", "controller law", words, "landed") / find("landed", "controller law", words, "strokes") }
function landed_of(words) { return find("landed", "controller law", words, "landed") " of " find("landed", "controller law", words, "strokes") " (" num(landed_percent(words), 0) " %)" }
function landings(law) { return "`id` " landed_of("id " law) ", `himc` " landed_of("himc " law) }
# relation of two ways to measure a joint's motion: goes along with it, and is never far from it
function consistent(angle,    a, b) {
    a = "captured_" angle "_deg"; b = "reach_" angle "_deg"
    return correlation("strokes", a, b) > CORRELATED && apart("strokes", a, b) < NEAR * range("strokes", a)
}
# the same in words
function consistency(angle,    a, b) {
    a = "captured_" angle "_deg"; b = "reach_" angle "_deg"
    return "IK from the tip: correlation " num(correlation("strokes", a, b), 2) ", RMS " num(apart("strokes", a, b) / range("strokes", a), 2) " of the swing"
}
# largest difference of a column of two tables (0 .. )
function differ(t, u,    i, k, d, most) {
    for (i = 1; i <= count[t]; i++)
        for (k in column)
            if (k ~ /_tip_[xyz]_m$/) {
                d = abs(value[t, i, k] - value[u, i, k])
                if (d > most) most = d
            }
    return most + 0
}
# energy that came or went without a work, and the work of all joints in size, of a piece (J)
function balance(t,    i, k, sum, first, work) {
    for (i = 1; i <= count[t]; i++) {
        sum = 0
        for (k in column) {
            if (k ~ /^(kinetic|potential)_j$/) sum += value[t, i, k]
            if (k ~ /(_work|^placed|^numerical)_j$/) sum -= value[t, i, k]
            if (i == count[t] && k ~ /_work_j$/) work += abs(value[t, i, k])
        }
        if (i == 1) first = sum
    }
    done = work
    return abs(sum - first)
}

function spread(gain, law, who, n) { return find("spread", "gain nuance controller law", gain " " nuance[n] " " who " " law, "mean_percent") }
function deviation(gain, law, who, n, which) { return find("spread", "gain nuance controller law", gain " " nuance[n] " " who " " law, which) }
# id minus himc, of each nuance; `ahead` counts nuances in which himc has the smaller error, `about_2` by 1.5 to 2.5 %
function differences(gain, law,    n, text, d) {
    ahead = about_2 = most_ahead = 0
    for (n = 1; n <= 5; n++) {
        d = spread(gain, law, "id", n) - spread(gain, law, "himc", n)
        ahead += d > 0
        about_2 += d > ABOUT_LEAST && d < ABOUT_MOST
        if (d > most_ahead) most_ahead = d
        text = text (n > 1 ? ", " : "") num(d, 2)
    }
    return text
}
# trials of each number of table t: of a gain and law, or all lines; a range where they differ
function trials_of(t, gain, law,    i, n, lo, hi) {
    for (i = 1; i <= count[t]; i++)
        if (!law || value[t, i, "gain"] == gain && value[t, i, "law"] == law) {
            n = value[t, i, "trials"] + 0
            lo = !hi || n < lo ? n : lo
            hi = n > hi ? n : hi
        }
    return (lo == hi ? lo : lo " to " hi) " trials each"
}
function smaller_in() { return ahead ? "smaller in " ahead " of 5 nuances, by " num(most_ahead, 2) " % at most" : "" }
# whether each sequence of a nuance was played twice or more: a deviation from fewer trials is chance
function repeated(    i, enough) {
    enough = 2 * fact("sequences") / 5
    for (i = 1; i <= count["spread"]; i++)
        if (value["spread", i, "trials"] + 0 < enough || value["spread", i, "sequence_sd"] !~ /[0-9]/)
            return 0
    return count["spread"] > 0
}
# nuances in which himc has the smaller deviation
function steadier(gain, law, which,    n, less) {
    for (n = 1; n <= 5; n++)
        less += deviation(gain, law, "himc", n, which) < deviation(gain, law, "id", n, which)
    return less
}

# of the score of figure 5: mean height (cm) of strokes of a nuance above the head
function apexes(    i, k, hand, tip, from, to, z, t) {
    k = 1
    for (i = 1; i <= count["beats"]; i++) {
        hand = value["beats", i, "hand"]
        tip = hand "_tip_z_m"
        to = value["beats", i, "time_s"]
        from = hand in before ? before[hand] : to - 2
        before[hand] = to
        high[i] = -9
        for (k = 1; k <= count["motion"]; k++) {
            t = value["motion", k, "time_s"]
            z = value["motion", k, tip]
            if (t > from && t < to && z > high[i]) high[i] = z
            if (t <= to) low[i] = z
        }
        rise[i] = 100 * (high[i] - low[i])
        long[i] = to - from
        kind = value["beats", i, "nuance"]
        sum[kind] += rise[i]
        seen[kind]++
    }
}

END {
    follow = "make build/figures/strokes.png"
    s = "strokes"
    # the papers' inverse kinematics, from the tip alone, is the column `reach`
    elbow = apart(s, "captured_elbow_deg", "reach_elbow_deg")
    swing = range(s, "captured_elbow_deg")
    agree = correlation(s, "captured_elbow_deg", "reach_elbow_deg")
    id = apart(s, "captured_tip_cm", "id_tip_cm")
    himc = apart(s, "captured_tip_cm", "himc_tip_cm")
    id_best = apart("strokes-default", "captured_tip_cm", "id_tip_cm")
    himc_best = apart("strokes-default", "captured_tip_cm", "himc_tip_cm")
    id_shape = without_lag(s, "captured_tip_cm", "id_tip_cm")
    himc_shape = without_lag(s, "captured_tip_cm", "himc_tip_cm")
    tips = "RMS of the tip's height: `id` " num(id, 2) " cm, `himc` " num(himc, 2) " cm by the printed law; " num(id_best, 2) " and " num(himc_best, 2) " by computed torque; printed, shifted by its lag (" late(s, "captured_tip_cm", "id_tip_cm") " and " late(s, "captured_tip_cm", "himc_tip_cm") " ms), " num(id_shape, 2) " and " num(himc_shape, 2) " cm"
    arm = "RMS distance " num(elbow, 1) "° of a swing of " num(swing, 0) "°, correlation " num(agree, 2) "; the swing is " num(range(s, "reach_elbow_deg") / swing, 2) " times the captured one"

    grip = "; legato in a german grip (" num(fact("grip"), 2) " of 1), theirs french"
    print "| place | there | here | verdict | remade by |"
    print "|---|---|---|---|---|"

    # CASA 2009
    place = "CASA figure 1, equation 1; preprint equation 2"
    built(place, "joint space control, Cartesian control by IK and ID", choices("mode") " pipelines (`himc`, `id`, `ik`), " choices("solver") " solvers of the IK", choices("mode") == 3 && choices("solver") > 1, "himc help solver")
    stated("CASA equation 2, preprint equation 1", "τ = k_s (Θ^S − Θ^T) − k_d Θ̇^S", "the opposite sign of k_s, as in 2012; as printed the joint runs away", "misprint", "build/tests/test_controller")
    row("CASA figure 2, preprint figure 4 top", "elbow flexion by IK consistent with the captured one", arm grip, consistent("elbow"), "make build/figures/elbow.png")
    print_row("CASA figure 3, preprint figure 4 bottom", "the tip is nearer in hybrid control than in ID control", tips grip, nearer_late(himc, id, himc_shape, id_shape, himc_best, id_best), "make build/figures/tip.png")
    print_row("CASA 4", "ID adds the errors of the joints, to a greater error than HIMC's", trials_of("measures") ", error with limbs right and 2 % wrong: printed law, `id` " grown("printed", "id") ", `himc` " grown("printed", "himc") " % of amplitude; computed torque, `id` " grown("computed-torque", "id") ", `himc` " grown("computed-torque", "himc") "", "ID adds them: " (adds_up("printed") ? "agrees" : "does not agree") "; a greater error: " (greater("printed") ? "agrees" : greater("computed-torque") ? "by computed torque, not by theirs" : "does not agree"), "make build/figures/measures.png")
    row("CASA 4, preprint, 2012 section 3.3.1", "the IK in every simulation step costs computing time", num(cost("take_s"), 0) " s of a take: " num(cost("himc_s"), 2) " s by `himc`, " num(cost("id_s"), 2) " s by `id`, " num(100 * (cost("himc_s") / cost("id_s") - 1), 0) " % more", cost("himc_s") > cost("id_s") && cost("himc_s") < cost("take_s"), "make build/trials/costs.csv")

    # preprint
    stated("preprint figure 1, 2012 figure 2", "motion, interaction, sound; visual and sound feedback", "one library; viewer and Pd by OSC", "built", "himc serve --help")
    built("preprint figure 2, 2012 figure 4", "tracking in joint space or by the end effectors", choices("mode") " modes: `id`, `himc`; `ik` without forces", choices("mode") == 3, "himc help mode")
    built("preprint figure 3, 2012 figure 7", "clients and servers on OSC; motion 250 Hz, physics 10 000 Hz, graphics 33 Hz, sound 44 kHz", "motion " fact("task_rate") " Hz, physics " fact("physics_rate") " Hz, sound " fact("sample_rate") " Hz; poses at the rate that a client asks for", fact("task_rate") == 250 && fact("physics_rate") == 10000 && fact("sample_rate") >= 44100, "tests/pd/test_distributed.sh")
    apexes()
    fast = slow = 0
    for (i = 1; i <= count["beats"]; i++)
        if (value["beats", i, "nuance"] == "legato" && long[i] < 2) {
            if (!fast || long[i] < long[fast]) fast = i
            if (!slow || long[i] > long[slow]) slow = i
        }
    row("preprint figure 5", "legato and accent beats, tempo varying", "accents rise " num(sum["accent"] / seen["accent"], 0) " cm, legato " num(sum["legato"] / seen["legato"], 0) " cm; a legato gesture of " num(long[fast], 2) " s rises " num(rise[fast], 0) " cm, of " num(long[slow], 2) " s " num(rise[slow], 0) " cm; " count["beats"] " of 22 strokes", sum["accent"] / seen["accent"] > sum["legato"] / seen["legato"] && count["beats"] == 22, "make build/figures/legato-accent.png")
    built("preprint figure 6", "panel: grip (2), nuance (5), tempo; clips, signals, modal sound with size, mass, tension", "grip, nuance (" fact("nuances") "), `technique` (" choices("technique") ": modal, signal, clip), `radius`, `density`, `tension` while it sounds", fact("nuances") == 5 && choices("technique") == 3, "tests/pd/test_panel.sh")
    row("preprint, Results; 2012 section 3.3", "19 joints, 57 degrees of freedom", value["body", 1, "joints"] " joints, " value["body", 1, "freedoms"] " degrees of freedom", value["body", 1, "joints"] == 19 && value["body", 1, "freedoms"] == 57, "himc render SCORE -o /dev/null --motion - --columns joints")
    row("2012 section 3.3", "upper body: 11 bodies, 11 joints, 33 degrees of freedom", "trunk and all that it carries: " fact("upper_bodies") " bodies, " fact("upper_joints") " joints, " fact("upper_freedoms") " degrees of freedom", fact("upper_bodies") == 11 && fact("upper_joints") == 11 && fact("upper_freedoms") == 33, "build/tools/research/papers/measure facts")
    built("2012 section 3.3", "ODE's internal maxima of force and torque", "`strength`: torques of any size leave joints at " num(fact("torque_with"), 3) " of their maximum (wrist " fact("wrist_strength") " N m); the trials here run without it", abs(fact("torque_with") - 1) < 1e-9 && abs(fact("torque_without") - 1) < 1e-9, "build/tools/research/papers/measure facts")
    landed = find("database", "law nuance", "computed-torque all", "landed"); strokes = find("database", "law nuance", "computed-torque all", "strokes")
    print_row("preprint, Results", "captured at 250 Hz, high enough", landed " of " strokes " strokes of such captures land", landed == strokes && strokes == fact("strikes") ? "agrees, of motion that was synthesized and sampled at this rate" : "does not agree", "make build/trials/database.csv")
    stated("preprint, Results", "sound and motion on two machines", "performer and drum on two sockets", "built", "tests/realtime/test_distributed.sh")

    # 2012
    built("2012 figure 1", "pipelines IK, HIMC, ID", choices("mode") " modes; tips of legato, computed torque: " num(find("evaluation", "nuance controller law", "legato ik none", "rms_percent"), 2) ", " num(find("evaluation", "nuance controller law", "legato himc computed-torque", "rms_percent"), 2) ", " num(find("evaluation", "nuance controller law", "legato id computed-torque", "rms_percent"), 2) " % of amplitude", choices("mode") == 3, "himc evaluate --trials 1 --only legato")
    apart_m = differ("blows-motion", "blows-ode")
    built("2012 figure 3, equation 1", "kinematic layer of joints, dynamic layer of rigid bodies", fact("segments") " segments; tips by ODE and by our own solver of its equations: " (apart_m < 1e-9 ? "less than 1e-9" : apart_m) " m apart after " num(value["blows-motion", count["blows-motion"], "time_s"], 0) " s", fact("segments") == value["body", 1, "joints"] + 1 && count["blows-motion"] > 1000 && apart_m < 1e-6, "tools/research/papers/papers.sh")
    built("2012 section 3.1", "limits as Euler angles, or ellipsoids around a mean quaternion, from captures", "`limits` " choices("limits") " (off, ellipsoid, euler); a capture's outermost pose is at " num(fact("euler_captured"), 3) " of the Euler bounds and at " num(fact("ellipsoid_captured"), 3) " of the ellipsoids; one three times as far goes back to " num(fact("euler_back"), 3) " and " num(fact("ellipsoid_back"), 3), choices("limits") == 3 && abs(fact("euler_captured") - 1) < 1e-6 && abs(fact("ellipsoid_captured") - 1) < 1e-6 && abs(fact("euler_back") - 1) < 1e-6 && abs(fact("ellipsoid_back") - 1) < 1e-6, "build/tools/research/papers/measure facts")
    row("2012 table 1, masses", "4, 4, 46, 4, 2, 1, 0.5, 18, 14, 5, 1.5 % of the body", "the rows, a pair each, sum to " num(fact("printed_mass"), 1) " %; an option, de Leva (1996) is the default", abs(fact("printed_mass") - 100) < 0.05, "build/tools/research/papers/measure facts")
    built("2012 table 1, ellipsoids; 2012 algorithm 1", "12 half axes, 3 for each of neck, shoulder, elbow, wrist", fact("half_axes") " half axes; read as degrees of half the angle, the wrist bends by " num(fact("wrist_deg"), 1) "°; " fact("mirrored") " of the 4 triples mirror, and log(q̄ Q) is read as log(q̄⁻¹ Q)", fact("half_axes") == 12, "build/tools/research/papers/measure facts")
    fitted("2012 section 2.4", "45 sequences: 3 percussionists, 5 modes, 3 locations, at least 10 strikes each", "synthetic: " fact("sequences") " sequences by " fact("players") " players, " fact("least_strikes") " strikes or more each (" fact("strikes") ")", fact("sequences") == 45 && fact("players") == 3 && fact("least_strikes") >= 10, "make mocap")
    row("2012 algorithm 2", "250 Hz and 10 000 Hz: 40 steps suffice for the IK to converge", "after 40 steps the tip is " num(10 * apart(s, "captured_tip_cm", "reach_tip_cm"), 3) " mm off (RMS)", apart(s, "captured_tip_cm", "reach_tip_cm") < 0.1, "build/tools/research/figures/strokes follow printed 0.333333 2.2 5")
    row("2012 equations 2 and 3", "q_t = q + J⁻¹ (X_t − X), PD with absolute damping", "`law printed`: the tip is " late(s, "captured_tip_cm", "himc_tip_cm") " ms late in `himc`, " late(s, "captured_tip_cm", "id_tip_cm") " ms in `id`; `law computed-torque`: " late("strokes-default", "captured_tip_cm", "himc_tip_cm") " ms", late(s, "captured_tip_cm", "himc_tip_cm") > 0 && late("strokes-default", "captured_tip_cm", "himc_tip_cm") == 0, follow)
    angle[1] = "wrist"; angle[2] = "elbow"; angle[3] = "shoulder"
    for (i = 1; i <= 3; i++) {
        a = "captured_" angle[i] "_deg"
        text[i] = "RMS `ik` " num(apart(s, a, "ik_" angle[i] "_deg"), 1) ", IK from the tip " num(apart(s, a, "reach_" angle[i] "_deg"), 1) ", `id` " num(apart(s, a, "id_" angle[i] "_deg"), 1) ", `himc` " num(apart(s, a, "himc_" angle[i] "_deg"), 1) "°; by computed torque `himc` " num(apart("strokes-default", a, "himc_" angle[i] "_deg"), 1) "°"
    }
    print_row("2012 figure 5a, wrist flexion", "IK consistent; HIMC nearer than ID", text[1] "; " consistency("wrist"), "IK " (consistent("wrist") ? "agrees" : "does not agree") "; HIMC " nearer(apart(s, "captured_wrist_deg", "himc_wrist_deg"), apart(s, "captured_wrist_deg", "id_wrist_deg"), apart("strokes-default", "captured_wrist_deg", "himc_wrist_deg"), apart("strokes-default", "captured_wrist_deg", "id_wrist_deg")), follow)
    print_row("2012 figure 5b, elbow flexion", "IK consistent; HIMC nearer than ID", text[2] "; " consistency("elbow"), "IK " (consistent("elbow") ? "agrees" : "does not agree") "; HIMC " nearer(apart(s, "captured_elbow_deg", "himc_elbow_deg"), apart(s, "captured_elbow_deg", "id_elbow_deg"), apart("strokes-default", "captured_elbow_deg", "himc_elbow_deg"), apart("strokes-default", "captured_elbow_deg", "id_elbow_deg")), follow)
    altered = range(s, "reach_shoulder_deg") / range(s, "captured_shoulder_deg")
    row("2012 figure 5c, shoulder flexion", "the IK alters the shoulder's motion", text[3] "; the IK from the tip moves it " num(altered, 2) " times as far", abs(altered - 1) > ALTERED, follow)
    print_row("2012 figure 5d, tip's height", "HIMC nearer than ID", "as CASA figure 3", nearer_late(himc, id, himc_shape, id_shape, himc_best, id_best), follow)
    wrist_id = apart(s, "captured_wrist_cm", "id_wrist_cm"); wrist_himc = apart(s, "captured_wrist_cm", "himc_wrist_cm")
    wrist_id_best = apart("strokes-default", "captured_wrist_cm", "id_wrist_cm"); wrist_himc_best = apart("strokes-default", "captured_wrist_cm", "himc_wrist_cm")
    wrist_id_shape = without_lag(s, "captured_wrist_cm", "id_wrist_cm"); wrist_himc_shape = without_lag(s, "captured_wrist_cm", "himc_wrist_cm")
    print_row("2012 figure 5e, wrist's height", "HIMC nearer than ID", "RMS `id` " num(wrist_id, 1) ", `himc` " num(wrist_himc, 1) " cm by the printed law, " num(wrist_id_shape, 1) " and " num(wrist_himc_shape, 1) " shifted back by its lag; " num(wrist_id_best, 2) " and " num(wrist_himc_best, 2) " cm by computed torque", nearer_late(wrist_himc, wrist_id, wrist_himc_shape, wrist_id_shape, wrist_himc_best, wrist_id_best), follow)
    loss = range(s, "reach_elbow_cm") / range(s, "captured_elbow_cm")
    id_loss = range(s, "id_elbow_cm") / range(s, "captured_elbow_cm"); himc_loss = range(s, "himc_elbow_cm") / range(s, "captured_elbow_cm")
    print_row("2012 figure 5f, elbow's height", "ID amplifies; HIMC loses motion, because of the IK", "range over captured: `id` " num(id_loss, 2) ", `himc` " num(himc_loss, 2) ", IK from the tip " num(loss, 2), "ID " (id_loss > MORE ? "amplifies" : "does not amplify") "; the IK " (loss < LESS ? "loses it" : "does not lose it") ", HIMC " (himc_loss < LESS ? "loses it" : "does not"), follow)
    large = ""
    for (i = 1; i <= 3; i++) {
        ratio = range(s, "id_" angle[i] "_deg") / range(s, "captured_" angle[i] "_deg")
        text[i] = num(ratio, 2)
        if (ratio > MORE) large = large (large ? ", " : "") angle[i]
    }
    row("2012 section 3.3.1", "ID exaggerates the motion", "range of `id` over captured: wrist " text[1] ", elbow " text[2] ", shoulder " text[3] ", tip " num(range(s, "id_tip_cm") / range(s, "captured_tip_cm"), 2), large == "wrist, elbow, shoulder", follow, large ? "of the " large " only" : "")
    for (n = 1; n <= 5; n++) {
        depth[n] = fact("depth_" nuance[n])
        height[n] = fact("height_" nuance[n])
        separate = n == 1 ? "" : ", "
        list_m = list_m separate num(depth[n], 0)
        list_h = list_h separate num(height[n], 0)
        list_d = list_d separate num(10 * range("phases", "captured_depth_cm", "nuance", nuance[n]), 0)
        list_r = list_r separate num(10 * range("phases", "captured_height_cm", "nuance", nuance[n]), 0)
        least = n == 1 || depth[n] < depth[least] ? n : least
        tall = n == 1 || height[n] > height[tall] ? n : tall
    }
    taken = "; in the picture "
    print_row("2012 figure 6a, depth", "accent the smallest, vertical accent and staccato much greater", "the database was fitted to it: legato to staccato " list_m taken list_d " mm", "accent the smallest: " (least == 3 ? "fitted" : "not fitted") "; vertical accent much greater: " (deeper(4) ? "fitted" : "not fitted") "; staccato: " (deeper(5) ? "fitted" : "not fitted"), "make build/figures/phases.png")
    fitted("2012 figure 6a, height", "accent the highest", "the same: " list_h taken list_r " mm", tall == 3, "make build/figures/phases.png")
    evaluation = "make build/figures/evaluation.png"
    order = ", ID minus HIMC: "
    t = differences(1, "printed"); row("2012 figure 6b, error, player's servos", "HIMC smaller by about 2 % of amplitude", trials_of("spread", 1, "printed") order t, about_2 == 5, evaluation, smaller_in())
    t = differences(3, "printed"); row("2012 figure 6b, error, default servos", "the same", trials_of("spread", 3, "printed") order t, about_2 == 5, evaluation, smaller_in())
    t = differences(3, "feedforward"); row("2012 figure 6b, velocity and gravity fed forward", "the same", trials_of("spread", 3, "feedforward") order t, about_2 == 5, evaluation, smaller_in())
    t = differences(3, "computed-torque"); row("2012 figure 6b, computed torque", "the same", trials_of("spread", 3, "computed-torque") order t, about_2 == 5, evaluation, smaller_in())
    row("2012 section 3.3.2, what reaches 2 %: limbs", "about 2 % of amplitude", trials_of("measures") ", limbs 1.5 and 2 % wrong, computed torque: " num(find("measures", "law error_percent", "computed-torque 1.5", "difference"), 2) " and " num(find("measures", "law error_percent", "computed-torque 2", "difference"), 2) "; fed forward: " num(find("measures", "law error_percent", "feedforward 1.5", "difference"), 2) " and " num(find("measures", "law error_percent", "feedforward 2", "difference"), 2), find("measures", "gain law error_percent", "3 printed 2", "difference") > ABOUT_LEAST, "make build/figures/measures.png", find("measures", "law error_percent", "computed-torque 2", "difference") > ABOUT_LEAST && find("measures", "law error_percent", "feedforward 2", "difference") > ABOUT_LEAST ? "by laws of ours; by theirs " num(find("measures", "gain law error_percent", "3 printed 2", "difference"), 2) : "")
    off = find("claim", "gain limits strokes_per_s", "1 off 1", "difference"); on = find("claim", "gain limits strokes_per_s", "1 on 1", "difference"); quick = find("claim", "gain limits strokes_per_s", "1 on 3", "difference")
    row("2012 section 3.3.2, what reaches 2 %: slow strokes", "about 2 % of amplitude", trials_of("claim") ", printed law, one stroke a second: " num(off, 2) " without limits, " num(on, 2) " with; three a second: " num(quick, 2), on > ABOUT_LEAST && on < ABOUT_MOST, "make build/figures/claim.png", off > ABOUT_LEAST && off < ABOUT_MOST ? "without joint limits, which the papers have; with them not" : "")
    for (i = 1; i <= 4; i++)
        own[i] = steadier(i == 1 ? 1 : 3, i < 3 ? "printed" : i == 3 ? "feedforward" : "computed-torque", "sequence_sd")
    if (!repeated())
        stated("2012 figure 6b, deviation", "smaller for HIMC", "too few trials of one sequence in these tables", "not measured", evaluation)
    else
        row("2012 figure 6b, deviation", "smaller for HIMC", trials_of("spread", 1, "printed") ", in how many of 5 nuances, trials of one sequence: " own[1] " (player's servos), " own[2] ", " own[3] ", " own[4] "; all trials: " steadier(1, "printed", "sd") ", " steadier(3, "printed", "sd") ", " steadier(3, "feedforward", "sd") ", " steadier(3, "computed-torque", "sd"), own[1] + own[2] == 10, evaluation, own[2] == 5 ? "of trials of one sequence, not by the player's servos (" own[1] " of 5)" : own[3] + own[4] == 10 ? "of trials of one sequence, by laws of ours; by theirs in " own[1] + own[2] " of 10" : "")
    own_law = landed_percent("himc printed") > landed_percent("id printed")
    others = landed_percent("himc computed-torque") > landed_percent("id computed-torque") && landed_percent("himc feedforward") > landed_percent("id feedforward")
    print_row("2012 section 3.3.2, at the impact", "2 % change the sound drastically", "strokes that land, printed law: " landings("printed") "; fed forward, " landings("feedforward") "; computed torque, " landings("computed-torque"), (own_law ? "landings agree" : others ? "landings agree by laws of ours; by theirs " (landed_percent("himc printed") < landed_percent("id printed") ? "the opposite" : "not") : "does not agree") "; the sound is not measured", "make build/trials/landed.csv")
    row("2012 section 3.3.1", "runs in real time", "a step with a drum " num(cost("step_us"), 1) " of " num(1e6 / fact("physics_rate"), 0) " µs; " int(cost("performers_per_core")) " performers on one core", cost("step_us") < 1e6 / fact("physics_rate") && cost("performers_per_core") > 1, "himc bench")
    stated("2012 section 3.3.3, place of the IK", "the IK inside the physics loop, not before it", "inside, so targets may change while it plays (`target`, `hit`)", "built", "himc help target")
    for (i = 1; i <= 2; i++)
        equal[i] = value["equal-" (i == 1 ? "two-way" : "one-way"), 2, "peak_force_n"] / value["equal-" (i == 1 ? "two-way" : "one-way"), 3, "peak_force_n"]
    built("2012 section 3.3.3", "targets changed while it plays; no reaction of the membrane on the stick", "`target`, `hit`; of two equal blows (" num(value["equal-two-way", 2, "velocity_m_s"], 2) ", " num(value["equal-two-way", 3, "velocity_m_s"], 2) " m/s) the one on the ringing head has " num(equal[1], 3) " times the force by `coupling two-way`, " num(equal[2], 3) " one-way", choices("coupling") == 2 && abs(equal[1] - 1) > abs(equal[2] - 1) && abs(value["equal-two-way", 2, "velocity_m_s"] / value["equal-two-way", 3, "velocity_m_s"] - 1) < 0.001, "himc render tools/research/figures/equal-blows.txt -o /dev/null --strokes -")
    profile = 1
    for (i = 1; i <= 5; i++)
        profile = profile && value["blows", i, "impulse_n_s"] > 0 && value["blows", i, "impulse_n_s"] < value["blows", i, "peak_force_n"] * value["blows", i, "duration_s"]
    built("2012 table 2", "place, shape, compression and force of an impact become a force profile", "a strike has place (" num(value["blows", 1, "x_m"], 2) ", " num(value["blows", 1, "y_m"], 2) " m), force, impulse, duration; the mallet has shape and exponent (" fact("exponent") ")", profile, "himc render SCORE -o /dev/null --strokes -")
    stated("2012 equation 4", "M ż + K z = f", "M z̈ + K z = f, as in equation 5", "misprint", "build/tests/test_membrane")
    row("2012 equation 5", "modes of the membrane", "frequency of (2,1), (0,2) over (0,1): " num(find("modes", "m n", "2 1", "ratio") / find("modes", "m n", "0 1", "ratio"), 4) ", " num(find("modes", "m n", "0 2", "ratio") / find("modes", "m n", "0 1", "ratio"), 4) "; zeros of Bessel functions 2.1355, 2.2954", abs(find("modes", "m n", "2 1", "ratio") / find("modes", "m n", "0 1", "ratio") - 2.1355) < 1e-3, "himc modes tools/research/figures/blows.txt")
    k = "`coupling one-way`"
    built("2012 equation 6, Hertz's law", "F = k c^α", "the same with losses (Hunt & Crossley): α " fact("exponent") "; harder blows have shorter contacts, " contacts("blows", 1, 3) "; " k ", " contacts("one-way", 1, 3), fact("exponent") >= 1.5 && value["blows", 1, "duration_s"] > value["blows", 2, "duration_s"] && value["blows", 2, "duration_s"] > value["blows", 3, "duration_s"], "himc render tools/research/figures/blows.txt -o /dev/null --strokes -")
    stated("2012 equation 6, k and α", "k ∝ F_m, α = f(φ), the contact's shape", k ": stiffness times the largest force over 100 N; α is the mallet's, 1 to 4 (felt " fact("exponent") ", wood 1.5)", "built", "himc help mallet")
    print_row("2012 section 2.4", "contact of a few milliseconds", contacts("blows", 3, 1) "; " k ", " contacts("one-way", 3, 1), by_coupling(few_ms("blows"), few_ms("one-way")), "himc render tools/research/figures/blows.txt -o /dev/null --strokes -")
    fitted("2012 figure 8, forces", "106.9, 65, 62.3 N of the last three strokes", forces("blows", 3) " N at " num(value["blows", 3, "velocity_m_s"], 1) ", " num(value["blows", 4, "velocity_m_s"], 1) ", " num(value["blows", 5, "velocity_m_s"], 1) " m/s, `two-way`, dynamics chosen for them; " k " " forces("one-way", 3) " N", abs(value["blows", 3, "peak_force_n"] - 106.9) < 2 && abs(value["blows", 4, "peak_force_n"] - 65) < 2 && abs(value["blows", 5, "peak_force_n"] - 62.3) < 2, "make build/figures/blows.png")
    two = rings("blows", "loud"); text[1] = list_l
    one = rings("one-way", "loud-one-way"); text[2] = list_l
    print_row("2012 figure 8, sound", "amplitude rises with the force; the fourth stroke sounds louder than the fifth", "RMS over that of the fifth: " text[1] ", the fourth with " num(value["blows", 4, "peak_force_n"] / value["blows", 5, "peak_force_n"], 2) " times the force; " k ": " text[2] ", " num(value["one-way", 4, "peak_force_n"] / value["one-way", 5, "peak_force_n"], 2) " times the force", by_coupling(two, one), "make build/figures/blows.png")
    row("2012 section 4.3", "membrane of 23 inches", num(fact("inches"), 1) " inches, principal mode " num(find("modes", "m n", "1 1", "frequency_hz"), 1) " Hz", abs(fact("inches") - 23) < 0.05, "himc modes tools/research/figures/blows.txt")
    lack = balance("improvisation")
    row("2012 section 4.3, animation", "an improvisation from tips alone", value["played", 1, "played"] " of " value["played", 1, "strokes"] " strokes played; energy balances to " sprintf("%.0e", lack / done) " of the joints' work", value["played", 1, "played"] == value["played", 1, "strokes"] && value["played", 1, "missed"] == 0 && lack < 1e-6 * done, "make build/figures/improvisation.png")
}
