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

#endif
