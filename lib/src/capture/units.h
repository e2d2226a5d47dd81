/// units.h: motion units: strokes cut out of a take, played instead of the built-in ones;
/// the gestures (plan) play them.
///
/// A unit is the fall of a tip from its apex to the touch, with a few numbers for the motion before
/// and after it. To play it, it is stretched in time and size, so one unit serves all dynamics and
/// tempi; the most similar one is preferred.
#ifndef HIMC_UNITS_H
#define HIMC_UNITS_H

#include "himc/command.h"
#include "himc/mocap.h"

typedef struct himc_unit {
    himc_nuance nuance;
    himc_hand hand;
    himc_spot spot; ///< HIMC_SPOT_XY: any
    int grip;       ///< a himc_grip
    double height;  ///< of the apex over the touch (m)
    double speed;   ///< of impact (m/s)
    double down;    ///< time of the fall (s)
    double lift;    ///< time of the rise before it (s)
    double depth;   ///< largest horizontal distance from the touch (m)
    double rebound; ///< height of the rebound (heights)
    double pull;    ///< duration of the rebound (rebound height / rebound speed)
    double start;   ///< acceleration at the apex (heights/down^2)
    double bend[3]; ///< shape of the fall: b0, b1, b2 in units.c
} himc_unit;

/// Cuts the strokes of both hands out of a take; the caller sets nuance, spot and grip. Strokes
/// that are not one clear fall are left out. Writes at most `capacity` units, returns the number of
/// all, or -1 with the reason: no tips, no strokes.
int himc_units_cut(himc_take *take, const himc_take_options *options, himc_unit *units,
                   int capacity, himc_error *error);

/// Height (heights) and its first two derivatives by the share, at a share 0 .. 1 of the time of
/// the fall, for a speed `landing` at the touch (heights per fall).
HIMC_RT void himc_unit_at(const himc_unit *unit, double share, double landing, double fall[3]);

#endif
