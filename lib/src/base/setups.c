/// setups.c: set-ups as lines of a score. Heights are of usual stands; where no source is named,
/// places are chosen so that one player reaches every instrument from one place.
#include "base/setups.h"

#include <stdio.h>
#include <string.h>

const char himc_setup_kit[] = "instrument snare snare 14; snare place .52 .02 .72;"
                              "instrument hats hi-hat 14; hats place .42 .46 .88;"
                              "instrument high-tom tom 10; high-tom place .74 .29 .88 .2;"
                              "instrument tom tom 12; tom place .84 0 .88 .2;"
                              "instrument floor tom 16; floor place .42 -.42 .7;"
                              "instrument crash crash 18; crash place .6 -.66 .98 .25;"
                              "instrument ride ride 20; ride place .14 -.9 .88 .2;"
                              "instrument kick kick 22; kick place .8 .1 .4 .8;";

const char himc_setup_around[] =
    "instrument low-floor tom 18; low-floor place .12 -.66 .7;"
    "instrument mid-tom tom 14; mid-tom place .73 -.34 .86;"
    "instrument china china 18; china place .5 -.86 1.05 .3;"
    "instrument splash splash 10; splash place .95 .12 1.1 .3;"
    "instrument crash-16 crash 16; crash-16 place .7 .64 1.1 .3;"
    "instrument cowbell cowbell; cowbell place .8 .15 1;"
    "instrument tambourine tambourine; tambourine place .3 -.6 1;"
    "instrument high-bongo bongo 7; high-bongo place .2 .6 .9;"
    "instrument low-bongo bongo 8.5; low-bongo place .2 .84 .9;"
    "instrument high-conga conga 11; high-conga place .1 .7 .75;"
    "instrument low-conga conga 12.5; low-conga place -.1 .9 .75;"
    "instrument high-timbale timbale 13; high-timbale place .3 -.8 .9;"
    "instrument low-timbale timbale 14; low-timbale place 0 -.85 .9;"
    "instrument agogo agogo; agogo place .36 .76 1;"
    "instrument claves claves; claves place .5 .66 .95;"
    "instrument high-block wood-block 900; high-block place .64 .44 .95;"
    "instrument low-block wood-block 640; low-block place .6 .56 .95;"
    "instrument middle-block wood-block 760; middle-block place .56 .68 .95;"
    "instrument low-cowbell cowbell 420; low-cowbell place .84 -.2 1.05;"
    "instrument high-cowbell cowbell 720; high-cowbell place .84 -.02 1.05;"
    "instrument triangle triangle; triangle place .5 .2 1.2;"
    "instrument bass-drum bass-drum 32; bass-drum place .25 .84 .85;"
    "instrument tam-tam tam-tam 32; tam-tam place .08 -.94 .85;"
    "instrument temple-blocks temple-blocks; temple-blocks place .7 .02 .94;";

// the caps, as high as both hands reach over
const char himc_setup_bells[] = "instrument bells tubular-bell C4 F5; bells place .55 0 1.25;";

const himc_setup himc_setups[] = {
    {"kit", himc_setup_kit},
    // four timpani around a player, the lowest at the left, tuned in the middle of their ranges
    {"timpani", "drum low 32; low place .251 .843 .85; low tune E2;"
                "drum second 29; second place .832 .287 .85; second tune A2;"
                "drum third 26; third place .763 -.439 .85; third tune D3;"
                "drum high 23; high place .251 -.843 .85; high tune G3;"},
    // skins in the middle, wood behind them, metal at the sides
    {"multi", "instrument snare snare 14; snare place .46 .06 .82;"
              "instrument timpano timpano 29; timpano place .66 -.56 .85; timpano tune A2;"
              "instrument tom tom 12; tom place .58 .46 .86;"
              "instrument blocks temple-blocks; blocks place .58 .02 1;"
              "instrument crash crash 18; crash place .22 .86 .92 .2;"
              "instrument triangle triangle; triangle place .8 .32 1.15;"
              "instrument tam-tam tam-tam 32; tam-tam place .08 -.94 .85;"},
    {"xylophone", "instrument xylophone xylophone F4 C7; xylophone place .45 0 .87;"},
    {"marimba", "instrument marimba marimba C3 C6; marimba place .5 0 .87;"},
    {"bells", himc_setup_bells},
};

bool himc_setup_find(const char *text, const char *name, const char **made, int *length,
                     double place[4])
{
    char line[64];
    int head = snprintf(line, sizeof line, "instrument %s ", name);
    const char *at = strstr(text, line);
    if (!at)
        return false;
    *made = at + head;
    *length = (int)strcspn(*made, ";");
    head = snprintf(line, sizeof line, "; %s place ", name);
    at = strstr(text, line);
    place[3] = 0;
    return at &&
           sscanf(at + head, "%lf %lf %lf %lf", &place[0], &place[1], &place[2], &place[3]) >= 3;
}
