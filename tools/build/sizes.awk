# Sizes of functions and folders of the library. Faults: median over 12 lines, 90 % over 25, one over 60; a folder of more than
# 34 files; lines over 100 columns, but for texts. Remarks: files over 800 lines.
function finish()
{
    if (lines > 800)
        print "remark: " file ": " lines " lines, better 800 at most"
}

FNR == 1 {
    finish()
    file = folder = FILENAME
    sub(/\/[^\/]*$/, "", folder)
    if (folder ~ /^lib\//)
        held[folder]++
    library = FILENAME ~ /^lib\//
}

{
    lines = FNR
    # characters, not bytes (the locale is C); tables that a program wrote may be wide
    gsub(/[\200-\277]/, "")
    if (length($0) > 100 && $0 !~ /"/ && FILENAME !~ /_table\.c$/) {
        print FILENAME ":" FNR ": wider than 100 columns"
        faults++
    }
}

/^[a-zA-Z].*\(/ { name = $0; sub(/\(.*/, "", name); sub(/.*[ *]/, "", name) }
/^{/ { start = FNR }
/^}$/ && start {
    if (library)
        length_of[++functions] = FNR - start - 1
    if (FNR - start - 1 > 60) {
        print FILENAME ":" start ": " name " has " FNR - start - 1 " lines, expected 60"
        faults += library
    }
    start = 0
}

END {
    finish()
    sort(length_of, functions)
    median = length_of[int((functions + 1) / 2)]
    most = length_of[int(0.9 * functions)]
    print functions " functions in lib, median " median " lines, 90 % " most ", longest " length_of[functions]
    faults += median > 12 || most > 25
    for (folder in held)
        if (held[folder] > 34) {
            print folder ": " held[folder] " files, expected 34"
            faults++
        }
    exit faults > 0
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
