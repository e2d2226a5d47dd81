/// research.h: what the papers' trials ask of a performance beyond its commands; for this
/// repository's own tools, not installed.
#ifndef HIMC_RESEARCH_H
#define HIMC_RESEARCH_H

#include "control/posture_regression.h"
#include "himc/performance.h"

/// From now on, in mode `himc`, the null space of the tips is for a player's habit (copied) rather
/// than for the natural posture; NULL for the latter again. The habit's player should be the
/// performer's body.
HIMC_RT void himc_performance_set_posture_regression(himc_performance *performance,
                                                     const himc_posture_regression *regression);

/// From now on the simulated segments have `factor` (HIMC_SEGMENTS, 0.2 .. 5; NULL for 1) times the
/// mass and inertia that the controller assumes: the effect of an uncertain body on control. The
/// body is rebuilt at the pose of the targets. False with the reason if a factor is out of range
/// or memory is short.
bool himc_performance_set_weights(himc_performance *performance, const double *factor,
                                  himc_error *error);

#endif
