/// nudge.h: a take's tip led aside for a while: the command `nudge`.
#ifndef HIMC_NUDGE_H
#define HIMC_NUDGE_H

#include "base/quintic.h"

/// A tip is `way` off its captured path at `time`, and on it again `span` before and after. With it
/// path, velocity and acceleration stay continuous. The height is left alone at strikes: they stay
/// strikes of the same speed.
typedef struct himc_nudge {
    himc_hand hand;
    double time;       ///< in the take (s)
    double span;       ///< (s)
    himc_vec3 way;     ///< (m)
    double rise, fall; ///< span of the height before and after, between the strikes around (s)
} himc_nudge;

#define HIMC_NUDGES 256 ///< of a take; chosen: more than anyone drags

/// How far a nudge leads aside at `t` (s): position, velocity, acceleration.
HIMC_RT himc_target himc_nudge_at(const himc_nudge *nudge, double t);

#endif
