# Holds the project to its plan: includes and calls between the rooms go one way, no files call each other in a circle, neither
# through functions nor through inline functions of headers.
#   nm -A -g build/lib/*/*.o build/mocap-o/*.o build/tools/himc/*.o | awk -f tools/build/rooms.awk - lib/himc/*.h lib/src/*/*.[ch] mocap/*.[ch] ...
# The rooms are the folders of lib/src, in the order of the data flow, then mocap/ and the program. A file is its .c and its .h, a
# public header belongs to the file of its name. Prints one line per fault.

function fault(text)
{
    print text
    faults++
}

function room_in(file)
{
    sub(/\/[^\/]*$/, "", file)
    return file
}

# room/name of a source or an object
function name_of(path)
{
    sub(/\.[a-z]+(:.*)?$/, "", path)
    sub(/^.*mocap(-o)?\//, "mocap/", path)
    sub(/^.*tools\//, "tools/", path)
    sub(/^.*lib\/(src\/)?/, "", path)
    if (path ~ /^himc\//)
        path = room_of[substr(path, 6)] "/" substr(path, 6)
    return path
}

function check_include(    include, to)
{
    split(substr($0, 11), include, /[\/.]/)
    to = include[1] == "himc" ? room_of[include[2]] : include[1]
    if (rank[to] > rank[room_in(file)])
        fault(FILENAME ":" FNR ": includes " include[1] "/" include[2] ".h of a later room, " to)
}

# the names that a line calls; those of inline functions of headers and, in headers, of any function count in the end
function note_calls(line,    called)
{
    sub(/\/\/.*/, "", line)
    while (match(line, /[a-z_][a-z0-9_]*\(/)) {
        called = substr(line, RSTART, RLENGTH - 1)
        line = substr(line, RSTART + RLENGTH)
        told[file, called, is_header]
    }
}

function add_call(from, called, to)
{
    if (to == "" || to == from)
        return
    calls[from, to]
    if (rank[room_in(to)] > rank[room_in(from)])
        fault(from ": calls " called " of a later room, " room_in(to))
}

BEGIN {
    rooms = split("system base body capture track plan midi musicxml control bank head drum performance osc mocap tools/himc", order, " ")
    for (i = 1; i <= rooms; i++)
        rank[order[i]] = i
    # the room of a public header
    split("vec base body body mocap capture score plan membrane head drum drum performance performance osc osc", header, " ")
    for (i = 1; i in header; i += 2)
        room_of[header[i]] = header[i + 1]
    # which outside library is known to which files
    only["^d(World|Body|Joint|Mass|Geom|Init|Close|AllocateODE|SetAlloc|SetFree|SetRealloc)"] = "^body/engine_ode$"
    only["^lo_"] = "^$"
    only["^_Z"] = "^base/linear$"
    only["^(socket|bind|sendto|recvmsg|recvfrom)$"] = "^system/udp$"
    only["^pthread_create$"] = "^system/"
    # a host's process and its terminal are not the library's
    only["^(exit|_exit|abort|printf|puts|putchar|perror|__printf_chk)$"] = "^$"
    # these may be embedded anywhere: they and all that they call need libm and the C library alone
    alone = "^(drum/(membrane|contact)|bank/|head/(modes|round|rectangle|grid_kind))"
}

FILENAME == "-" {
    file = name_of($1)
    files[file]
    kind = $(NF - 1)
    symbol = $NF
    if (kind == "U") {
        needs[file, symbol]
        for (pattern in only)
            if (file !~ /^(mocap|tools)\// && symbol ~ pattern && file !~ only[pattern])
                fault(file ": calls " symbol ", which only files like " only[pattern] " may")
        if (symbol ~ /^(lo_|dWorld|dBody|dJoint|socket$|pthread_create$)/)
            outside[file] = symbol
    } else if (kind ~ /^[TDRBV]$/)
        home[symbol] = file
    next
}

FNR == 1 {
    file = name_of(FILENAME)
    is_header = FILENAME ~ /\.h$/
    files[file]
}

FILENAME !~ /^lib\/himc\// && /^#include "[a-z]+\/[a-z0-9_]+\.h"/ { check_include() }

# an inline function of a header; its name may stand in the next line
is_header && /^[A-Z_ ]*static inline/ { inline = 1 }
inline {
    text = $0
    gsub(/__attribute__\(\([a-z_]*\)\)/, "", text)
    if (match(text, /[A-Za-z_][A-Za-z0-9_]*\(/)) {
        inline_home[substr(text, RSTART, RLENGTH - 1)] = file
        inline = 0
    }
}

/^[ \t]/ { note_calls($0) }

END {
    for (pair in needs) {
        split(pair, p, SUBSEP)
        add_call(p[1], p[2], home[p[2]])
    }
    for (pair in told) {
        split(pair, p, SUBSEP)
        if (p[2] in inline_home)
            add_call(p[1], p[2], inline_home[p[2]])
        else if (p[3])
            add_call(p[1], p[2], home[p[2]])
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
        if ((f, f) in reach) {
            circle = ""
            for (g in files)
                if ((f, g) in calls && (g, f) in reach)
                    circle = circle " " g
            fault(f ": stands in a circle of calls between files, by" circle)
        }
        if (f ~ alone)
            for (g in outside)
                if (g == f || (f, g) in reach)
                    fault(f ": needs " outside[g] " (" g "), expected libm and the C library")
    }
    exit faults > 0
}
