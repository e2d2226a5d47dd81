/// alive.h: head, weight and breath of a player who plays; nothing of it moves the tips.
#ifndef HIMC_ALIVE_H
#define HIMC_ALIVE_H

#include "body/posture.h"

/// The next stroke of either hand.
typedef struct himc_next_stroke {
    double in;    ///< time until it (s); infinite: none is known
    double since; ///< time since the one before (s); infinite: none was played
    himc_vec3 at; ///< place on the head (m)
} himc_next_stroke;

/// Adds to a goal of the trunk, at time `t` (s): head and gaze to the drum of the next stroke, or
/// forward to the conductor in rests; weight to that side; breath; a gesture before a first note.
HIMC_RT void himc_alive_add(const himc_posture *posture, const himc_next_stroke *next, double t,
                            himc_trunk_posture *goal);

#endif
