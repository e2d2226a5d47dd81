# Sizes worth a second look, as remarks: functions over 60 lines, files over 400, comments over 100 columns.
function remark(text)
{
    print "remark: " text
}

function finish()
{
    if (lines > 400)
        remark(file ": " lines " lines, better 400 at most")
    if (wide)
        remark(file ": " wide " lines wider than 100 columns")
    wide = 0
}

FNR == 1 {
    finish()
    file = FILENAME
}

{
    lines = FNR
    # tables that a program wrote may be wide
    wide += length($0) > 100 && FILENAME !~ /_table\.c$/
}

/^[a-zA-Z].*\(/ { name = $0; sub(/\(.*/, "", name); sub(/.*[ *]/, "", name) }
/^{/ { start = FNR }
/^}$/ && start {
    length_of[++functions] = FNR - start - 1
    if (FNR - start - 1 > 60)
        remark(FILENAME ":" start ": " name " has " FNR - start - 1 " lines, better 60 at most")
    start = 0
}

END {
    finish()
    sort(length_of, functions)
    if (functions)
        print functions " functions, median " length_of[int((functions + 1) / 2)] " lines, longest " length_of[functions]
}

# insertion sort, so that any awk will do
function sort(a, n,    i, j, v)
{
    for (i = 2; i <= n; i++) {
        v = a[i]
        for (j = i - 1; j > 0 && a[j] > v; j--)
            a[j + 1] = a[j]
        a[j + 1] = v
    }
}
