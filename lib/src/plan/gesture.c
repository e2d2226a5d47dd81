/// gesture.c: the shapes of the five nuances.
///
/// Speeds of the mallet head at f come from optical captures of timpani exercises (425 strokes;
/// legato 4.3, tenuto 4.2, accent 4.5, vertical accent 7.5, staccato 2.8 m/s, and 1.39 times that
/// in the louder takes). Heights and depths keep the differences between nuances of Bouënard, Gibet
/// & Wanderley 2012 (section 3): accent highest and shallow, vertical accent and staccato deep,
/// tenuto rising weakly, staccato pulled off. Peak force grows as speed^1.1, so a speed ratio of
/// 10 from ppp to fff gives 22 dB. The steepness s = v T/H of a fall from the height H to the speed
/// v in the time T is 1.9 to 2.1 here; it is monotone up to 2.5 (gesture.h).
///
/// Haste. In a short time an arm from rest reaches `most` = HIMC_HURRY T. A stroke of the speed a
/// is bent below that to
///     v = a (1 + (a/most)^k)^(-p/k),   k = 8, p = 3/4:
/// v = a while a is far below `most`, and a^(1/4) most^(3/4) far above it. v rises strictly with a
/// and with T, so louder is louder and slower is not softer; and it depends on nothing else, not on
/// the tip's state nor on the stroke before, so equal strokes at equal intervals are equal from the
/// first on: a run has no steady state to settle to, or to swing about. T is the time from the
/// hand's last touch (planner_motion.c), or from the message of a hit. A stroke with the share r of
/// its time keeps its speed and s and so is r as high.
#include "plan/gesture.h"

#include <math.h>

#define FORTE_OVER_PPP 7.2  // speed ratio; with the next, 10 from ppp to fff
#define FFF_OVER_FORTE 1.39 // speed ratio of the louder takes

// limits of all strokes; chosen: ppp can still be seen, fff is a raised arm and falls 1.6 times as
// long as a legato at f
#define LONGEST_DOWN 0.30    // (s)
#define HIGHEST_GESTURE 0.75 // (m)
#define LOWEST_GESTURE 0.03  // (m)

// hurried strokes; chosen: within 0.1 dB of what is asked up to 0.75 of `most`, and steps between
// dynamics that are heard (0.6 dB) far above it
#define BEND_KNEE 8.0         // k
#define BEND_SLOPE 0.75       // p
#define UNBENT 1e-3           // (a/most)^k: the bend is below 0.001 dB
#define HURRIED_STEEPNESS 1.6 // s of a tip that is high already, at least
#define LEAST_CLIMB 0.3       // share of the rise's time for a tip that is high already

// strokes from motion units; chosen: a unit is not stretched beyond recognition
#define UNIT_DEPTH_GROWTH 1.2 // its depth grows with its height up to this factor
#define MOST_ARC 4.0          // at its apex

/// At f. `shape` is s; height grows as speed^height_exponent below f.
static const struct profile {
    double height, speed, shape, height_exponent, dwell, rise, depth, arc, rebound, rebound_time;
} profile[HIMC_NUANCES] = {
    [HIMC_LEGATO] = {.38, 4.3, 2.1, .8, .00, .22, .08, 2, .85, 2.0},
    [HIMC_TENUTO] = {.42, 4.2, 1.9, .8, .02, .26, .08, 1, .45, 2.2},
    [HIMC_ACCENT] = {.54, 4.5, 1.9, .8, .03, .26, .04, 0, .95, 1.9},
    [HIMC_VERTICAL_ACCENT] = {.48, 7.5, 2.1, .9, .01, .22, .18, 0, .90, 2.0},
    [HIMC_STACCATO] = {.36, 2.8, 2.0, .8, .05, .24, .16, 0, .75, 0.8},
};

static double dynamic_of(double louder)
{
    double step =
        louder < 1 ? HIMC_FORTE / log(FORTE_OVER_PPP) : (1 - HIMC_FORTE) / log(FFF_OVER_FORTE);
    return HIMC_FORTE + step * log(louder);
}

double himc_gesture_dynamic(double louder)
{
    return fmax(0, fmin(dynamic_of(louder), 1));
}

double himc_gesture_dynamic_at(himc_nuance nuance, double speed)
{
    return fmin(dynamic_of(speed / profile[nuance].speed), 1);
}

himc_gesture himc_gesture_of(himc_nuance nuance, double dynamic)
{
    const struct profile *p = &profile[nuance];
    double d = dynamic - HIMC_FORTE;
    double louder =
        d < 0 ? pow(FORTE_OVER_PPP, d / HIMC_FORTE) : pow(FFF_OVER_FORTE, d / (1 - HIMC_FORTE));
    himc_gesture g = {.dwell = p->dwell,
                      .rise = p->rise,
                      .arc = p->arc,
                      .rebound = p->rebound,
                      .rebound_time = p->rebound_time};
    g.speed = p->speed * louder;
    g.height = p->height * (d < 0 ? pow(louder, p->height_exponent) : louder);
    g.height = fmin(g.height, LONGEST_DOWN * g.speed / p->shape);
    g.height = fmax(fmin(g.height, HIGHEST_GESTURE), LOWEST_GESTURE);
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
    g.height = fmax(fmin(g.speed * g.down / shape, HIGHEST_GESTURE), LOWEST_GESTURE);
    g.down = shape * g.height / g.speed;
    g.dwell = 0;
    g.rise = unit->lift;
    g.depth = unit->depth * fmin(g.height / unit->height, UNIT_DEPTH_GROWTH);
    g.arc = fmin(fmax(-unit->start, 0), MOST_ARC);
    g.rebound = unit->rebound;
    g.rebound_time = unit->pull;
    g.unit = unit;
    return g;
}

himc_gesture himc_gesture_scale(himc_gesture g, double factor)
{
    double shape = g.speed * g.down / g.height;
    g.speed = fmax(g.speed * factor, HIMC_SLOWEST_GESTURE);
    g.height = fmax(fmin(g.height * factor, HIGHEST_GESTURE), LOWEST_GESTURE);
    g.down = shape * g.height / g.speed;
    return g;
}

double himc_gesture_time(const himc_gesture *gesture, double height)
{
    double climb = fmin(fmax(1 - height / gesture->height, LEAST_CLIMB), 1);
    return gesture->down + gesture->dwell + climb * gesture->rise;
}

himc_gesture himc_gesture_bend(himc_gesture g, double most)
{
    double over = pow(g.speed / most, BEND_KNEE);
    if (over < UNBENT)
        return g;
    return himc_gesture_scale(g, pow(1 + over, -BEND_SLOPE / BEND_KNEE));
}

himc_gesture himc_gesture_squeeze(himc_gesture g, double time, double height)
{
    double share = time / himc_gesture_time(&g, height);
    if (share >= 1)
        return g;
    double shape = g.speed * g.down / g.height, full = g.height;
    g.down *= share;
    g.dwell *= share;
    g.rise *= share;
    g.depth *= share * share;
    g.height = g.speed * g.down / shape;
    // a tip that is high already stays there
    double stay = fmin(fmax(height / full, 0), 1) * share * full;
    g.height = fmin(fmax(g.height, stay), g.speed * g.down / HURRIED_STEEPNESS);
    return g;
}
