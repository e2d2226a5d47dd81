/// research.h: functions that the papers' trials need beyond the commands; for this repository's
/// own tools, not installed.
#ifndef HIMC_RESEARCH_H
#define HIMC_RESEARCH_H

#include "control/posture_regression.h"
#include "himc/performance.h"

/// From now on, in mode `himc`, the null-space target is a player's posture regression (copied)
/// instead of the natural posture; NULL for the natural one again. The regression's player should
/// have the performer's body.
HIMC_RT void himc_performance_set_posture_regression(himc_performance *performance,
                                                     const himc_posture_regression *regression);

#endif
