# What bash and zsh offer after `himc`: its calls, their options, then files. Reads what `himc --help` and `himc CALL --help` print.
#   for c in '' CALL...; do echo "== $c"; himc $c --help; done | awk -v shell=bash|zsh -f tools/build/completions.awk

/^== / { call = $2; next }
call == "" && /^  [a-z]+ +[a-z]/ { calls = calls " " $1 }
call != "" && match($0, /--[a-z-]+/) && /^ +-/ { options[call] = options[call] " " substr($0, RSTART, RLENGTH) }

END {
    sub(/^ /, "", calls)
    if (shell == "zsh")
        print "#compdef himc\n\nlocal -A options\noptions=("
    else
        print "_himc() {\n    local word=${COMP_WORDS[COMP_CWORD]} options="
    n = split(calls, name, " ")
    if (shell == "zsh") {
        for (i = 1; i <= n; i++)
            print "    " name[i] " '--help" options[name[i]] "'"
        print ")\nif ((CURRENT == 2)); then\n    compadd -- " calls " --help --version"
        print "elif [[ $PREFIX == -* ]]; then\n    compadd -- ${=options[$words[2]]}\nelse\n    _files\nfi"
        exit
    }
    print "    if [ \"$COMP_CWORD\" = 1 ]; then\n        COMPREPLY=($(compgen -W \"" calls " --help --version\" -- \"$word\"))\n        return\n    fi"
    print "    case ${COMP_WORDS[1]} in"
    for (i = 1; i <= n; i++)
        print "        " name[i] ") options='--help" options[name[i]] "' ;;"
    print "    esac\n    case $word in"
    print "        -*) COMPREPLY=($(compgen -W \"$options\" -- \"$word\")) ;;\n        *) COMPREPLY=($(compgen -f -- \"$word\")) ;;"
    print "    esac\n}\ncomplete -o filenames -F _himc himc"
}
