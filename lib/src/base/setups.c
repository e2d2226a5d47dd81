/// setups.c: set-ups as lines of a score. Heights are of usual stands; where no source is named,
/// places are chosen so that one player reaches every instrument from one place.
#include "base/setups.h"

const himc_setup himc_setups[] = {
    // four timpani around a player, the lowest at the left, tuned in the middle of their ranges
    {"timpani", "drum low 32; low place .251 .843 .85; low tune E2;"
                "drum second 29; second place .832 .287 .85; second tune A2;"
                "drum third 26; third place .763 -.439 .85; third tune D3;"
                "drum high 23; high place .251 -.843 .85; high tune G3;"},
    {"xylophone", "instrument xylophone xylophone F4 C7; xylophone place .45 0 .87;"},
    {"marimba", "instrument marimba marimba C3 C6; marimba place .5 0 .87;"},
};
