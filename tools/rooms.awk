# Holds the library to its plan: includes point one way, and outside libraries are known in one place each.
#   awk -f tools/rooms.awk lib/himc/*.h lib/src/*.[ch] pd-externals/*.[ch] tools/*.[ch]
#
# The order of the rooms is the order of the includes in lib/himc/himc.h. A room is a public header, its source, and the
# private files these include (with their sources); what it includes must stand before it. Prints one line per fault.

function fault(text)
{
    print text
    faults++
}

# follows what `file` includes on behalf of `room`
function walk(file, room,    n, i, parts, name, stem)
{
    if ((room, file) in seen)
        return
    seen[room, file] = 1
    n = split(includes[file], parts, "\n")
    for (i = 1; i < n; i++) {
        name = parts[i]
        if (name ~ /^"himc\//) {
            stem = substr(name, 7, length(name) - 9)
            if (stem != "himc" && rank[stem] > rank[room])
                fault(file ": " room " comes before " stem " in himc.h and may not include it")
            if (pure[room])
                walk("lib/himc/" stem ".h", room)
        } else if (name ~ /^"/) {
            stem = substr(name, 2, length(name) - 4)
            walk("lib/src/" stem ".h", room)
            walk("lib/src/" stem ".c", room)
        } else if (pure[room] && name !~ /^<(math|stdlib|string|stdint|stdbool|stddef|stdarg|stdio|float|ctype|assert)\.h>$/)
            fault(file ": " room " needs the C library and libm alone, not " name)
    }
}

BEGIN {
    # who may know which outside library
    home["<ode/"] = "^lib/src/character"
    home["<lo/"] = "^(lib/src/osc|viewer/|tests/)"
    home["<sndfile"] = "^tools/"
    home["m_pd.h"] = "^pd-externals/"
    # rooms that can be embedded anywhere
    pure["modes"] = pure["bank"] = pure["membrane"] = pure["contact"] = 1
}

FNR == 1 {
    files[++count] = FILENAME
}

/^ *# *include/ {
    name = $0
    sub(/^ *# *include */, "", name)
    sub(/[>"][^>"]*$/, substr(name, 1, 1) == "<" ? ">" : "\"", name)
    includes[FILENAME] = includes[FILENAME] name "\n"
    for (library in home)
        if (index(name, library) && FILENAME !~ home[library])
            fault(FILENAME ":" FNR ": only files like " home[library] " may include " name)
    if (FILENAME == "lib/himc/himc.h")
        rank[substr(name, 7, length(name) - 9)] = ++rooms
}

# a library does not end its host, nor talk to its terminal
FILENAME ~ /^lib\// && /(^|[^a-z_])(exit|abort|printf|puts|perror) *\(/ && !/^ *(\/\/|\*)/ && !/format\(printf/ {
    fault(FILENAME ":" FNR ": no exit, abort or printing in lib/")
}

END {
    if (!rooms) {
        fault("lib/himc/himc.h: missing, or includes no rooms")
        exit 1
    }
    for (i = 1; i <= count; i++)
        if (files[i] ~ /^lib\/himc\// && files[i] != "lib/himc/himc.h") {
            room = substr(files[i], 10, length(files[i]) - 11)
            if (!(room in rank))
                fault(files[i] ": not included by lib/himc/himc.h")
            else {
                walk(files[i], room)
                walk("lib/src/" room ".c", room)
            }
        }
    exit faults > 0
}
