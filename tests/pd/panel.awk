# What the controls of a patch say: for each message box that leads to [s $0-himc] or [s $0-drum],
# lines `performer TEXT` or `drum TEXT`, one for either end of what its number may be. $1 of a box
# right behind [r $0-NAME], or behind a [sel] or [int] of it, is between the ends of NAME's slider or number
# box; others are given here. Lines of score boxes too.
function words(from,   i, text) {
    for (i = from; i <= NF; i++)
        text = text (i > from ? " " : "") $i
    sub(/, f [0-9]+;$/, ";", text)
    sub(/;$/, "", text)
    return text
}
function say(who, text,   part, n, i) {
    n = split(text, part, / *\\, */)
    for (i = 1; i <= n; i++)
        print who, part[i]
}
function close_canvas(   i, k, from, to, text, name) {
    for (i = 0; i < links[depth]; i++) {
        split(link[depth, i], from, " ")
        if (kind[depth, from[1]] == "r")
            source[depth, from[3]] = content[depth, from[1]]
        else if (kind[depth, from[1]] ~ /^(sel|int)$/) # what it does not select, or the whole part
            source[depth, from[3]] = source[depth, from[1]]
    }
    for (i = 0; i < links[depth]; i++) {
        split(link[depth, i], from, " ")
        to = content[depth, from[3]]
        if (kind[depth, from[1]] != "msg" || kind[depth, from[3]] != "s" || to !~ /^\\\$0-(himc|drum)$/)
            continue
        to = to ~ /himc/ ? "performer" : "drum"
        text = content[depth, from[1]]
        name = source[depth, from[1]]
        if (text ~ /\\\$/ && (name in low)) {
            gsub(/\\\$1/, low[name], text)
            say(to, text)
            text = content[depth, from[1]]
            gsub(/\\\$1/, high[name], text)
        } else {
            for (k in given)
                if (index(text, k) == 1) {
                    name = given[k]
                    split(name, part, " ")
                    gsub(/\\\$1/, part[1], text)
                    gsub(/\\\$2/, part[2], text)
                    gsub(/\\\$3/, part[3], text)
                }
        }
        say(to, text)
    }
}
BEGIN {
    given["player"] = "1.75 75"
    given["gain"] = "100 10"
    given["pickup air"] = "0 0.6 1.5"
    given["pickup \\$1"] = "0.1 0.1"
    given["hit"] = "0.6 rim"
    given["score"] = given["take"] = given["record"] = "file.txt"
    given["listen"] = 9000
}
$1 == "#N" { depth++; items[depth] = links[depth] = 0; next }
$1 == "#A" {
    text = words(3)
    n = split(text, line, / *\\; */)
    for (i = 1; i <= n; i++)
        if (line[i] ~ /^kettle /)
            print "drum", substr(line[i], 8)
        else if (line[i] != "" && line[i] !~ /^comment/)
            print "performer", line[i]
    next
}
$2 == "connect" { sub(/;$/, "", $6); link[depth, links[depth]++] = $3 " " $4 " " $5 " " $6; next }
$2 == "restore" {
    close_canvas()
    for (i in source)
        delete source[i]
    depth--
    items[depth]++
    next
}
$2 == "declare" && items[depth] == 0 { next }
$1 == "#X" {
    k = items[depth]++
    kind[depth, k] = $2 == "obj" ? $5 : $2
    content[depth, k] = words($2 == "obj" ? 6 : 5)
    sub(/;$/, "", kind[depth, k])
    if ($2 == "obj" && $5 == "hsl") {
        name = $12
        sub(/-slide$/, "", name)
        low[name] = $8
        high[name] = $9
    } else if ($2 == "floatatom" && $10 ~ /-slide$/ && $6 != $7) {
        name = $10
        sub(/-slide$/, "", name)
        low[name] = $6
        high[name] = $7
    } else if ($2 == "obj" && $5 == "tgl") {
        name = $8
        low[name] = 0
        high[name] = 1
    }
}
END { close_canvas() }
