# Boxes and comments of a patch that lie on one another, and cords that go up to their [send], from
# the text of the patch: a letter is 7 wide and a line 15 high at Pd's size 12 (measured). Canvases,
# sliders and the like are behind the others or have no text, and are left out.
function lines(text, width,   word, n, i, used, count) { # wrapped as Pd does, between words
    n = split(text, word, " ")
    count = 1
    widest = 0
    for (i = 1; i <= n; i++) {
        if (used > 0 && used + 1 + length(word[i]) > width) {
            count++
            used = 0
        }
        used += (used > 0) + length(word[i])
        if (used > widest)
            widest = used
    }
    return count
}
function add(x, y, kind, text, width,   k) {
    k = count[depth]++
    gsub(/\\;/, ";", text)
    gsub(/ \\,/, ",", text)
    gsub(/\\/, "", text)
    high[depth, k] = 15 * lines(text, width)
    left[depth, k] = x
    top[depth, k] = y
    wide[depth, k] = 7 * widest + (kind == "msg" ? 8 : 0)
    what[depth, k] = kind
    said[depth, k] = text
}
function close_canvas(   i, k, end, from) {
    for (i = 0; i < count[depth]; i++)
        for (k = i + 1; k < count[depth]; k++)
            if (what[depth, i] && what[depth, k] && left[depth, i] < left[depth, k] + wide[depth, k] &&
                left[depth, k] < left[depth, i] + wide[depth, i] && top[depth, i] < top[depth, k] + high[depth, k] &&
                top[depth, k] < top[depth, i] + high[depth, i])
                print name[depth] ": \"" said[depth, i] "\" on \"" said[depth, k] "\""
    for (i = 0; i < links[depth]; i++) {
        split(link[depth, i], end, " ")
        from = end[1]
        if (said[depth, end[3]] ~ /^s / && top[depth, from] + high[depth, from] > top[depth, end[3]])
            print name[depth] ": a cord up from \"" said[depth, from] "\""
    }
}
{ sub(/\r$/, "") }
$1 == "#N" { depth++; count[depth] = links[depth] = 0; name[depth] = NF > 7 ? $7 : FILENAME; next }
$1 == "#X" && $2 == "connect" { sub(/;$/, ""); link[depth, links[depth]++] = $3 " " $4 " " $5; next }
$1 == "#X" && $2 == "restore" {
    close_canvas()
    depth--
    sub(/;$/, "")
    text = $5
    for (i = 6; i <= NF; i++)
        text = text " " $i
    add($3, $4, "obj", text, 60)
    next
}
$1 == "#X" && $2 ~ /^(text|msg|obj|floatatom|symbolatom|listbox)$/ {
    kind = $2
    x = $3
    y = $4
    width = 60
    text = $0
    sub(/;$/, "", text)
    if (match(text, /, f [0-9]+$/)) {
        width = substr(text, RSTART + 4) + 0
        text = substr(text, 1, RSTART - 1)
    }
    sub(/^#X [a-z]+ [-0-9]+ [-0-9]+ ?/, "", text)
    drawn = kind ~ /atom|listbox/ || text ~ /^(cnv|tgl|bng|[hv]sl|[hv]radio|vu|nbx|ear|array|table|declare)( |$)/
    add(x, y, drawn ? "" : kind, drawn ? "" : text, width)
}
END { close_canvas() }
