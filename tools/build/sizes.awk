# Sizes of functions, lines and folders. Faults: a function of the library over 60 lines without `long: REASON` in the comment above
# it; a folder of the library with more than 34 files; lines over 100 columns, but for texts. Remarks: files over 800 lines, long
# functions elsewhere.
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
    reason = 0
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

/^\/\/.* long: ./ { reason = 1 }
/^[a-zA-Z].*\(/ { name = $0; sub(/\(.*/, "", name); sub(/.*[ *]/, "", name) }
/^{/ { start = FNR }
/^}/ {
    length_of = FNR - start - 1
    if (/^}$/ && start && length_of > 60 && !reason) {
        print FILENAME ":" start ": " name " has " length_of " lines, expected 60 or a reason"
        faults += library
    }
    start = reason = 0
}

END {
    finish()
    for (folder in held)
        if (held[folder] > 34) {
            print folder ": " held[folder] " files, expected 34"
            faults++
        }
    exit faults > 0
}
