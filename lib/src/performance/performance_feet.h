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

#define HIMC_FEET_TOLD 64 ///< strokes under way; a drum tells no more

/// Of a foot.
typedef struct foot_last {
    double time; ///< of its last stroke (s)
    int drum;    ///< and the drum + 1; 0: there is none
} foot_last;

typedef struct performance_feet {
    foot_stroke *stroke; ///< by beat (count), owned
    int count, room;
    double played_to; ///< beat; earlier strokes have been played
    foot_last last[HIMC_HANDS];
    foot_stroke told[HIMC_FEET_TOLD]; ///< launched last; `beat` NAN of a hit
    unsigned launched;
} performance_feet;

void himc_feet_free(performance_feet *feet);
HIMC_RT void himc_feet_clear(performance_feet *feet);
/// True if the strokes that have been played are the same in two scores ...
HIMC_RT bool himc_feet_may_exchange(const performance_feet *feet, const performance_feet *other);
/// ... whose strokes are exchanged.
HIMC_RT void himc_feet_exchange(performance_feet *a, performance_feet *b);
/// Adds a stroke on a drum. False with the reason if there is no memory, or no foot plays it: an
/// ornament, a place off the head.
bool himc_feet_add(performance_feet *feet, const himc_stroke *stroke, performance_drums *drums,
                   int drum, himc_error *error);
/// Beat of the last stroke, -1 without one.
HIMC_RT double himc_feet_last(const performance_feet *feet);
/// Whether the score has strokes of a foot on that drum.
HIMC_RT bool himc_feet_plays(const performance_feet *feet, int drum);
/// Plays a stroke on a drum `delay` (s) after `t` (s). False if it is not played, which is told.
HIMC_RT bool himc_feet_hit(performance_feet *feet, const himc_stroke *stroke,
                           performance_drums *drums, int drum, double t, double delay,
                           performance_events *events);
/// Plays the strokes of a tick at `time` (s): from beat `now` of the planner's score to that of the
/// next tick. Returns how many are not played, which is told: too soon after another one, or
/// refused by a drum, as after a change of its size.
HIMC_RT int himc_feet_play(performance_feet *feet, performance_drums *drums,
                           const himc_planner *planner, double time, double now, double next,
                           performance_events *events);
/// At time `t` (s), tells the strokes whose contact has ended; returns their number, and raises
/// `force` (N) to the largest of theirs.
HIMC_RT int himc_feet_tell(const performance_feet *feet, const performance_drums *drums,
                           performance_events *events, double t, double *force);

#endif
