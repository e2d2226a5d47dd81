# A manual page of what `himc CALL --help` prints: usage, one line that says what it does, paragraphs, options.
#   himc CALL --help | awk -v call=CALL -v version=0.1.0 -f tools/build/man.awk        (call is empty for himc itself)

function text(s)
{
    gsub(/\\/, "\\\\", s)
    gsub(/-/, "\\-", s)
    return s ~ /^['.]/ ? "\\&" s : s
}

function section(name)
{
    if (now != name)
        print ".SH " name
    now = name
}

BEGIN { title = "himc" (call == "" ? "" : "-" call) }

/^usage: / { usage = substr($0, 8); next }
/^himc [0-9].*: / { does = $0; sub(/^[^:]*: /, "", does); begin(); next }
NF && does == "" { does = $0; begin(); next }
!NF { paragraph = 1; next }
/^ +(-[a-z], )?--[a-z]/ {
    section("OPTIONS")
    match($0, /^ +(-[a-z], )?--[a-z-]+( [^ ]+)?/)
    option = substr($0, 1, RLENGTH)
    about = substr($0, RLENGTH + 1)
    sub(/^ +/, "", option)
    sub(/^ +/, "", about)
    print ".TP\n.B " text(option) "\n" text(about)
    next
}
/^  [a-z]+ +[a-z]/ {
    section("CALLS")
    print ".TP\n.BR himc\\-" $1 " (1)"
    sub(/^  [a-z]+ +/, "")
    print text($0)
    next
}
{
    section("DESCRIPTION")
    if (paragraph)
        print ".PP"
    paragraph = 0
    print text($0)
}

function begin()
{
    print ".TH " toupper(title) " 1 \"\" \"himc " version "\" \"himc\""
    print ".SH NAME\n" text(title) " \\- " text(does)
    print ".SH SYNOPSIS\n" text(usage == "" ? "himc CALL ..." : usage)
    paragraph = 0
}

END {
    print ".SH SEE ALSO"
    print call == "" ? "The manual, in the folder of himc's documentation: all commands of scores, patches and OSC." : ".BR himc (1)"
}
