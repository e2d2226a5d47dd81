/// setpoint.h: between two task ticks (250 Hz) and at every physics step (10 kHz): targets move on
/// quintics, so that position, velocity and acceleration agree at the ticks (the two loops of the
/// 2012 paper's algorithm 2).
#ifndef HIMC_SETPOINT_H
#define HIMC_SETPOINT_H

#include "control/controller.h"

/// Targets of tips and joints at a tick, and their motion.
typedef struct himc_setpoint {
    double time; ///< (s)
    himc_target tip[HIMC_HANDS];
    himc_posture_motion posture;
} himc_setpoint;

/// Fills the posture of a tick from its tips.
HIMC_RT void himc_setpoint_complete(himc_setpoint *tick, const himc_posture *posture);

/// Tips and joint targets at `time` between two ticks into `reference`; contact flags are left
/// alone.
HIMC_RT void himc_setpoint_interpolate(const himc_setpoint *from, const himc_setpoint *to,
                                       double time, himc_reference *reference);

#endif
