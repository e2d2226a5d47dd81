#!/bin/sh
# The externals as neighbours of others in one Pd: each shows its setup function alone, so another external that is linked with a library
# of which [himc~] contains a part has its own.
. tests/support/check.sh
build=$(cd "${HIMC_BUILD:-build}" && pwd) || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for external in "$build"/externals/himc/*.pd_linux; do
    name=$(basename "$external" .pd_linux)
    check "test_${name}_shows_its_setup_alone" [ "$(nm -D --defined-only "$external" | awk '{ print $3 }')" = "${name%\~}_tilde_setup" ]
done

# an external with collisions, loaded after ours
cat >"$work/collide.c" <<'END'
#include <m_pd.h>
int ccdMPRPenetration(void);
int (*volatile found)(void) = ccdMPRPenetration;
void collide_setup(void) { post("collide: %s", found ? "has its library" : "calls address 0"); }
END
cc -shared -fPIC -I/usr/include/pd "$work/collide.c" -o "$work/collide.pd_linux" -l:libccd.so.2
cat >"$work/user.pd" <<'END'
#N canvas 0 0 400 300 12;
#X obj 10 10 himc~ kettle;
#X obj 10 40 membrane~ kettle;
#X obj 10 70 collide;
END
pd -nrt -nogui -stderr -noprefs -noaudio -nomidi -batch -path "$build/externals/himc" -open "$work/user.pd" -send "pd quit" >"$work/log" 2>&1
check test_an_external_loaded_later_has_its_own_library grep -q '^collide: has its library' "$work/log"
finish
