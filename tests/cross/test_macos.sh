#!/bin/sh
# What is crossed to macOS, which this machine cannot run: Mach-O for arm64, and nothing needed but the system's library and Pd's own
# functions. `make check-macos` runs it.
#   tests/cross/test_macos.sh BUILD
. tests/support/check.sh
macos=$1
export LC_ALL=C

kind() {
    llvm-objdump --macho --private-header "$1" | tail -n 1 | awk '{ print $2, $5 }'
}
libraries() {
    llvm-objdump --macho --dylibs-used "$@" | sed -n 's/^\t\([^ ]*\).*/\1/p' | grep -v '~' | sort -u | tr '\n' ' '
}
check test_program_is_for_arm64 [ "$(kind "$macos/bin/himc")" = "ARM64 EXECUTE" ]
check test_program_needs_the_system_alone [ "$(libraries "$macos/bin/himc")" = "/usr/lib/libSystem.B.dylib " ]
for object in himc membrane; do
    file=$macos/externals/himc/$object~.d_arm64
    check "test_${object}_is_for_arm64" [ "$(kind "$file")" = "ARM64 DYLIB" ]
    check "test_${object}_needs_the_system_alone" [ "$(libraries "$file")" = "/usr/lib/libSystem.B.dylib " ]
    llvm-nm -gU --format=just-symbols "$file" >"$macos/shown.txt"
    check "test_${object}_shows_its_setup" grep -qx "_${object}_tilde_setup" "$macos/shown.txt"
    # what it must have and the linker has not found in the system's library is Pd's
    llvm-nm -m -u "$file" | grep -v -e weak -e '(from ' | sed 's/.* external _//' >"$macos/lacks.txt"
    check "test_${object}_lacks_pd_alone" [ "$(grep -cx gensym "$macos/lacks.txt")/$(grep -cvxFf "$macos/pd.txt" "$macos/lacks.txt")" = 1/0 ]
done

finish
