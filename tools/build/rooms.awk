# Holds the library to its plan: includes and calls between the rooms go one way, no files call each other in a circle.
#   nm -A -g build/lib/*/*.o | awk -f tools/build/rooms.awk - lib/src/*/*.[ch]
# The rooms are the folders of lib/src, in the order of the data flow. Prints one line per fault.

function fault(text)
{
    print text
    faults++
}

BEGIN {
    rooms = split("system base body capture track plan midi control bank head drum performance osc", order, " ")
    for (i = 1; i <= rooms; i++)
        rank[order[i]] = i
    # the room of a public header
    split("vec base body body mocap capture score plan membrane head drum drum performance performance osc osc", header, " ")
    for (i = 1; i in header; i += 2)
        room_of[header[i]] = header[i + 1]
    # which outside library is known to which files
    only["^d(World|Body|Joint|Mass|Geom|Init|Close|AllocateODE|SetAlloc|SetFree|SetRealloc)"] = "^body/character$"
    only["^lo_"] = "^$"
    only["^_Z"] = "^base/linear$"
    only["^(socket|bind|sendto|recvmsg|recvfrom)$"] = "^system/udp$"
    only["^pthread_create$"] = "^system/"
    # a host's process and its terminal are not the library's
    only["^(exit|_exit|abort|printf|puts|putchar|perror|__printf_chk)$"] = "^$"
    # these may be embedded anywhere: they and all that they call need libm and the C library alone
    alone = "^(drum/(membrane|contact)|bank/|head/modes)"
}

FILENAME != "-" {
    if (match($0, /^#include "[a-z]+\/[a-z0-9_]+\.h"/)) {
        split(substr($0, 11, RLENGTH - 13), include, "/")
        file = FILENAME
        sub(/.*\/src\//, "", file)
        split(file, part, "/")
        to_room = include[1] == "himc" ? room_of[include[2]] : include[1]
        if (rank[to_room] > rank[part[1]])
            fault(FILENAME ":" FNR ": includes " include[1] "/" include[2] ".h of a later room, " to_room)
    }
    next
}

{
    file = $1
    sub(/\.o:.*/, "", file)
    sub(/.*\/lib\//, "", file)
    files[file]
    kind = $(NF - 1)
    symbol = $NF
    if (kind == "U") {
        needs[file, symbol]
        for (pattern in only)
            if (symbol ~ pattern && file !~ only[pattern])
                fault("lib/src/" file ".c: calls " symbol ", which only files like " only[pattern] " may")
        if (symbol ~ /^(lo_|dWorld|dBody|dJoint|socket$|pthread_create$)/)
            outside[file] = symbol
    } else if (kind ~ /^[TDRBV]$/)
        home[symbol] = file
}

END {
    for (pair in needs) {
        split(pair, p, SUBSEP)
        to = home[p[2]]
        if (to == "" || to == p[1])
            continue
        calls[p[1], to]
        from_room = p[1]; sub(/\/.*/, "", from_room)
        to_room = to; sub(/\/.*/, "", to_room)
        if (rank[to_room] > rank[from_room])
            fault("lib/src/" p[1] ".c: calls " p[2] " of a later room, " to_room)
    }
    # whom a file reaches, directly or not
    for (pair in calls)
        reach[pair]
    for (k in files)
        for (i in files)
            if ((i, k) in reach)
                for (j in files)
                    if ((k, j) in reach)
                        reach[i, j]
    for (f in files) {
        if ((f, f) in reach)
            fault("lib/src/" f ".c: stands in a circle of calls between files")
        if (f ~ alone)
            for (g in outside)
                if (g == f || (f, g) in reach)
                    fault("lib/src/" f ".c: needs " outside[g] " (" g "), expected libm and the C library")
        room = f
        sub(/\/.*/, "", room)
        count[room]++
    }
    exit faults > 0
}
