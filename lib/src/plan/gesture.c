/// gesture.c: the shapes of the five nuances.
///
/// Speeds of the mallet head at f come from optical captures of timpani exercises (425 strokes;
/// legato 4.3, tenuto 4.2, accent 4.5, vertical accent 7.5, staccato 2.8 m/s, and 1.39 times that
/// in the louder takes); heights and depths keep what Bouënard, Gibet & Wanderley 2012 (section
/// 3) tell nuances apart by: the accent highest and shallow, vertical accent and staccato deep,
/// tenuto rising weakly, staccato pulled off. Peak force goes with speed^1.1, so a ratio of 10
/// from ppp to fff gives 22 dB. A quintic from rest at the height H to the speed v in the time T
/// falls without turning as long as s = v T/H <= 2.5; s here is 1.9 to 2.1. A stroke given the
/// share r < 1 of its time keeps its speed and s and so is r as high, as long as nobody must be
/// stronger for it than STRONGEST: v/T grows with 1/r, and is bent towards that limit smoothly,
/// so that louder stays louder.
#include "plan/gesture.h"

#include <math.h>

#define FORTE (5.0 / 7)
#define SOFTEST 7.2
#define LOUDEST 1.39
#define LONGEST_DOWN 0.30
#define HIGHEST 0.75
#define LOWEST 0.03
#define STEEPEST 2.4   // largest s used
#define STRONGEST 55.0 // speed over time of a downstroke in a hurry (m/s^2)
#define LEAST_SPEED 1.0

/// At f. `shape` is s; `reach` says how height follows speed: height ~ speed^reach.
static const struct profile {
    double height, speed, shape, reach, dwell, lift, depth, arc, rebound, pull;
} profile[HIMC_NUANCES] = {
    [HIMC_LEGATO] = {.38, 4.3, 2.1, .8, .00, .22, .08, 2, .85, 2.0},
    [HIMC_TENUTO] = {.42, 4.2, 1.9, .8, .02, .26, .08, 1, .45, 2.2},
    [HIMC_ACCENT] = {.54, 4.5, 1.9, .8, .03, .26, .04, 0, .95, 1.9},
    [HIMC_VERTICAL_ACCENT] = {.48, 7.5, 2.1, .9, .01, .22, .18, 0, .90, 2.0},
    [HIMC_STACCATO] = {.36, 2.8, 2.0, .8, .05, .24, .16, 0, .75, 0.8},
};

himc_gesture himc_gesture_of(himc_nuance nuance, double dynamic)
{
    const struct profile *p = &profile[nuance];
    double d = dynamic - FORTE;
    double louder = d < 0 ? pow(SOFTEST, d / FORTE) : pow(LOUDEST, d / (1 - FORTE));
    himc_gesture g = {
        .dwell = p->dwell, .lift = p->lift, .arc = p->arc, .rebound = p->rebound, .pull = p->pull};
    g.speed = p->speed * louder;
    g.height = p->height * (d < 0 ? pow(louder, p->reach) : louder);
    g.height = fmin(g.height, LONGEST_DOWN * g.speed / p->shape);
    g.height = fmax(fmin(g.height, HIGHEST), LOWEST);
    g.down = p->shape * g.height / g.speed;
    g.depth = p->depth * g.height / p->height;
    return g;
}

himc_gesture himc_gesture_from(const himc_unit *unit, himc_nuance nuance, double dynamic)
{
    himc_gesture g = himc_gesture_of(nuance, dynamic);
    double shape = unit->speed * unit->down / unit->height;
    // between a softer fall in the same time and one as long as its height asks for
    g.down = unit->down * sqrt(fmin(unit->speed / g.speed, 1));
    g.height = fmax(fmin(g.speed * g.down / shape, HIGHEST), LOWEST);
    g.down = shape * g.height / g.speed;
    g.dwell = 0;
    g.lift = unit->lift;
    g.depth = unit->depth * fmin(g.height / unit->height, 1.2);
    g.arc = fmin(fmax(-unit->start, 0), 4);
    g.rebound = unit->rebound;
    g.pull = unit->pull;
    g.unit = unit;
    return g;
}

double himc_gesture_time(const himc_gesture *gesture, double height)
{
    double climb = fmin(fmax(1 - height / gesture->height, 0.3), 1);
    return gesture->down + gesture->dwell + climb * gesture->lift;
}

/// `speed` bent so that it stays below `most`, hardly changed while it is far below.
static double bend(double speed, double most)
{
    return speed / pow(1 + pow(speed / most, 4), 0.25);
}

himc_gesture himc_gesture_squeeze(himc_gesture g, double time, double height)
{
    double share = time / himc_gesture_time(&g, height);
    if (share >= 1)
        return g;
    double shape = g.speed * g.down / g.height, full = g.height;
    g.down *= share;
    g.dwell *= share;
    g.lift *= share;
    g.depth *= share * share;
    g.speed = fmax(bend(g.speed, STRONGEST * g.down), fmin(g.speed, LEAST_SPEED));
    g.height = g.speed * g.down / shape;
    // a tip that is high already stays there
    double stay = fmin(fmax(height / full, 0), 1) * share * full;
    g.height = fmin(fmax(g.height, stay), g.speed * g.down / 1.6);
    return g;
}
