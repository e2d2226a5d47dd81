/// performance_feet.h: strokes that a foot plays, on the pedal of a bass drum.
#ifndef HIMC_PERFORMANCE_FEET_H
#define HIMC_PERFORMANCE_FEET_H

#include "performance/performance_drums.h"
#include "performance/performance_events.h"
#include "plan/planner.h"

/// A stroke of the score.
typedef struct foot_stroke {
    double beat;     ///< (beats)
    double x, y;     ///< on the head (m)
    double velocity; ///< of the beater (m/s)
    int drum;
    himc_nuance nuance;
} foot_stroke;

typedef struct performance_feet {
    foot_stroke *stroke; ///< by beat (count), owned
    int count, room;
    double played_to; ///< beat; earlier strokes have been played
} performance_feet;

void himc_feet_free(performance_feet *feet);
HIMC_RT void himc_feet_clear(performance_feet *feet);
/// Adds a stroke on a drum. False with the reason if there is no memory, or no foot plays it: an
/// ornament, a place off the head.
bool himc_feet_add(performance_feet *feet, const himc_stroke *stroke, performance_drums *drums,
                   int drum, himc_error *error);
/// Beat of the last stroke, -1 without one.
HIMC_RT double himc_feet_last(const performance_feet *feet);
/// Plays a stroke on a drum `delay` (s) from now.
HIMC_RT bool himc_feet_hit(const himc_stroke *stroke, performance_drums *drums, int drum,
                           double delay, himc_error *error);
/// Plays the strokes of a tick: from beat `now` of the planner's score to that of the next tick.
/// One that a drum refuses, as after a change of its size, is told.
HIMC_RT void himc_feet_play(performance_feet *feet, performance_drums *drums,
                            const himc_planner *planner, double now, double next,
                            performance_events *events);
/// At time `t` (s), tells the strokes whose contact has ended; returns their number.
HIMC_RT int himc_feet_tell(const performance_drums *drums, performance_events *events, double t);

#endif
