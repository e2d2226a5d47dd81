/// task.h: between two task ticks (250 Hz) and at every physics step (10 kHz): targets move on
/// quintics, so that position, velocity and acceleration agree at the ticks (the two loops of the
/// 2012 paper's algorithm 2).
#ifndef HIMC_TASK_H
#define HIMC_TASK_H

#include "himc/controller.h"

/// Where tips and joints are to be at a tick, and how they are to move.
typedef struct himc_task_tick {
    double time; ///< (s)
    himc_target tip[HIMC_HANDS];
    himc_posture_motion posture;
} himc_task_tick;

/// Fills the posture of a tick from its tips.
HIMC_RT void himc_task_tick_complete(himc_task_tick *tick, const himc_posture *posture);

/// Tips and joint targets at `time` between two ticks into `reference`; contact flags are left
/// alone.
HIMC_RT void himc_task_between(const himc_task_tick *from, const himc_task_tick *to, double time,
                               himc_reference *reference);

#endif
