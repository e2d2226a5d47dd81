# Holds the library's public door small: counts the functions of the public headers, and names those without a user.
#   awk -f tools/build/door.awk lib/himc/*.h lib/src/*/*.[ch] tools/*/*.[ch] ...   (every file that may use a function but the tests)
# A user is a file other than the one that defines the function. Prints one line per fault and the counts.

FNR == 1 {
    public = FILENAME ~ /^lib\/himc\//
    if (FILENAME == "lib/himc/himc.h")
        umbrella = 1
    else
        umbrella = 0
}

# the core is what himc.h includes
umbrella && /^#include "himc\// {
    name = $2
    gsub(/"/, "", name)
    core["lib/" name]
}

{
    sub(/\/\/.*/, "")
    rest = $0
    at_margin = rest ~ /^[a-zA-Z]/
    while (match(rest, /himc_[a-z0-9_]+/)) {
        name = substr(rest, RSTART, RLENGTH)
        called = substr(rest, RSTART + RLENGTH, 1) == "("
        rest = substr(rest, RSTART + RLENGTH)
        if (public && at_margin && called && !($0 ~ /^typedef/)) {
            if (!(name in door))
                door[name] = FILENAME
            at_margin = 0
        } else if (at_margin && called && !public)
            defines[FILENAME, name]
        else
            uses[FILENAME, name]
    }
}

END {
    for (pair in uses) {
        split(pair, p, SUBSEP)
        if (p[2] in door && p[1] != door[p[2]] && !((p[1], p[2]) in defines))
            users[p[2]]++
    }
    for (name in door) {
        all++
        inner += door[name] in core
        if (!users[name]) {
            print door[name] ": " name " has no user outside its own file"
            faults++
        }
    }
    print inner " functions in the core, " all " in all public headers"
    if (inner > 70 || all > 200) {
        print "expected 70 in the core and 200 in all"
        faults++
    }
    exit faults > 0
}
