/// units.h: motion units: strokes cut out of a take, to be played in place of the built-in ones.
///
/// A unit is the fall of a tip from its apex to the touch and what comes before and after it in
/// numbers. It is played by stretching it in time and size, so one unit serves all dynamics and
/// tempi; nearer ones are preferred.
#ifndef HIMC_UNITS_H
#define HIMC_UNITS_H

#include "himc/command.h"
#include "himc/mocap.h"

typedef struct himc_unit {
    himc_nuance nuance;
    himc_hand hand;
    himc_spot spot; ///< HIMC_SPOT_XY: any
    int grip;       ///< himc_grip
    double height;  ///< of the apex over the touch (m)
    double speed;   ///< of impact (m/s)
    double down;    ///< time of the fall (s)
    double lift;    ///< time of the rise before it (s)
    double depth;   ///< largest distance from the place of the touch along the floor (m)
    double rebound; ///< height of the rebound, in heights
    double pull;    ///< its time, in rebound heights over rebound speed
    double start;   ///< acceleration at the apex (heights/down^2)
    double bend[3]; ///< the fall's own shape (unit.c)
} himc_unit;

/// Cuts the strokes of both hands out of a take; nuance, spot and grip are for the caller to say.
/// Strokes that are not one clear fall are left out. Writes at most `capacity` into `units`,
/// returns how many there are, or -1 with the reason: no tips, no strokes.
int himc_units_cut(himc_take *take, const himc_take_options *options, himc_unit *units,
                   int capacity, himc_error *error);

/// Height (heights), speed and acceleration (by the share of the fall) at the share 0 .. 1 of the
/// fall, if it is to land with the speed `landing` (heights per fall).
HIMC_RT void himc_unit_at(const himc_unit *unit, double share, double landing, double fall[3]);

#endif
