#!/bin/sh
# Faults put into the library one at a time, to see that a test notices each (make mutants).
#   tests/mutants/run.sh [NUMBER...]     of mutants in tests/mutants/table.txt; all without one
#   tests/mutants/run.sh --check         only whether each stands in its file, exactly once
# A mutant is one object compiled anew and linked before the library; of a header, all objects that include it. The tests of its heading run one after the other, in a
# folder of its own, until one fails: then it is killed, if that test passes without it. What no test notices has survived. JOBS
# mutants run at a time. The environment has COMPILE, LINK and LIBS of the Makefile. Fails if less than 95 of 100 are killed, or
# if the table is wrong.
: "${JOBS:=$(nproc 2>/dev/null || echo 1)}" "${HIMC_BUILD:=build}" "${MUTANT_TIMEOUT:=300}"
export HIMC_BUILD MUTANT_TIMEOUT COMPILE LINK LIBS
table=tests/mutants/table.txt
out=$HIMC_BUILD/mutants

# prints FILE, TESTS and the mutated source of one mutant, or fails if its old text is not there exactly once
mutate() {
    awk -v wanted="$1" -v source="$2/source.c" -v heading="$2/heading" '
        /^# / || /^$/ { next }
        /^\[.*\]$/ { split(substr($0, 2, length($0) - 2), part, / *\| */); next }
        ++n == wanted {
            at = index($0, " ==> ")
            if (!at || !(1 in part)) exit 1
            old = substr($0, 1, at - 1)
            new = substr($0, at + 5)
            while ((getline line < part[1]) > 0) text = text line "\n"
            where = index(text, old)
            if (!where || index(substr(text, where + 1), old)) exit 1
            printf "%s%s%s", substr(text, 1, where - 1), new, substr(text, where + length(old)) >source
            print part[1], part[2] >heading
            print part[1] ": " $0
            found = 1
        }
        END { exit !found }' $table
}

# runs a program in the folder DIR/run; its output is in DIR/log
run() {
    (cd "$1/run" && HIMC_SHARED=$OLDPWD/../shared timeout -k 5 "$MUTANT_TIMEOUT" "$2" >../log 2>&1 </dev/null)
}

# true if a test passes without a mutant; asked once for each
passes() {
    test -e "$out/passed/$2" || { run "$1" "$PWD/$HIMC_BUILD/tests/$2" && touch "$out/passed/$2"; }
}

# compiles what FILE is a part of, mutated, in the folder DIR
compile() {
    mkdir "$2/objects"
    case $1 in
        *.h)
            header=${1#lib/src/}
            mkdir -p "$2/include/$(dirname "$header")"
            mv "$2/source.c" "$2/include/$header"
            sources=$(grep -rl --include=*.c "\"$header\"" lib/src)
            ;;
        *) sources=$2/source.c ;;
    esac
    for source in $sources; do
        $COMPILE -w -iquote "$2/include" -I"$(dirname "$1")" -c "$source" -o "$2/objects/$(basename "$source").o" || return
    done
}

# says what became of one mutant: killed, survived, or wrong in the table
one() {
    dir=$(mktemp -d "$out/$1.XXXXXX") && mkdir -p "$dir/run/build" || exit 1
    if ! name=$(mutate "$1" "$dir"); then
        echo "wrong    $1 the old text is not in its file exactly once"
        rm -rf "$dir"
        return
    fi
    read -r file tests <"$dir/heading"
    if ! compile "$file" "$dir" 2>"$dir/log"; then
        echo "wrong    $1 $name: does not compile"
        rm -rf "$dir"
        return
    fi
    for folder in *; do
        test "$folder" = build || ln -sT "$PWD/$folder" "$dir/run/$folder"
    done
    for test in $tests; do
        case $test in
            test_air | test_air_galerkin) more=$HIMC_BUILD/tools/air/galerkin.o ;;
            *) more= ;;
        esac
        if ! $LINK $HIMC_BUILD/tests/$test.o $HIMC_BUILD/tests/unity.o "$dir"/objects/*.o $more $HIMC_BUILD/libhimc.a $LIBS -o "$dir/$test"; then
            echo "wrong    $1 $name: does not link with $test"
            rm -rf "$dir"
            return
        fi
        run "$dir" "../$test" && continue
        if passes "$dir" "$test"; then
            echo "killed   $1 $name ($test)"
        else
            echo "wrong    $1 $name: $test fails without it"
        fi
        rm -rf "$dir"
        return
    done
    echo "survived $1 $name"
    rm -rf "$dir"
}

if [ "$1" = --one ]; then
    one "$2"
    exit 0
fi

if [ "$1" = --check ]; then
    awk '/^# / || /^$/ { next }
        /^\[.*\]$/ {
            split(substr($0, 2, length($0) - 2), part, / *\| */)
            text = ""
            while ((getline line < part[1]) > 0) text = text line "\n"
            close(part[1])
            next
        }
        {
            n++
            old = substr($0, 1, index($0, " ==> ") - 1)
            where = old == "" ? 0 : index(text, old)
            if (where && !index(substr(text, where + 1), old)) next
            print "mutant " n ": not exactly once in " part[1] ": " $0
            bad = 1
        }
        END { exit bad }' $table
    exit
fi

count=$(grep -cv '^# \|^\[\|^$' $table)
rm -rf "$out/passed"
mkdir -p "$out/passed"
if [ $# -gt 0 ]; then printf '%s\n' "$@"; else seq "$count"; fi | xargs -n 1 -P "$JOBS" "$0" --one | tee "$out/log"
awk '{ n[$1]++ }
    END {
        printf "%d killed, %d survived", n["killed"], n["survived"]
        if (n["wrong"]) printf ", %d wrong", n["wrong"]
        print ""
        exit n["wrong"] > 0 || n["killed"] < 0.95 * NR
    }' "$out/log"
