/// setpoint.h: between two task ticks (250 Hz) and at every physics step (10 kHz): targets move on
/// quintics, so that position, velocity and acceleration agree at the ticks (the two loops of the
/// 2012 paper's algorithm 2).
#ifndef HIMC_SETPOINT_H
#define HIMC_SETPOINT_H

#include "base/interpolate.h"
#include "control/controller.h"

/// Targets of tips and joints at a tick, and their motion.
typedef struct himc_setpoint {
    double time; ///< (s)
    himc_target tip[HIMC_HANDS];
    himc_posture_motion posture;
} himc_setpoint;

/// True if all of it is finite.
HIMC_RT bool himc_setpoint_finite(const himc_setpoint *tick);

#define HIMC_MOVING_JOINTS (HIMC_LEFT_UPPER_LEG - 1) ///< the joints before the hips

/// The motion between two ticks.
typedef struct himc_setpoint_course {
    double from, to; ///< times of the ticks (s)
    himc_quintic tip[HIMC_HANDS];
    himc_posture_motion posture; ///< at the second tick, for the legs
    bool legs;                   ///< the legs move; the caller says so
    joint_courses joints;        ///< the first HIMC_MOVING_JOINTS, the rest like the first
} himc_setpoint_course;

HIMC_RT void himc_setpoint_course_make(himc_setpoint_course *course, const himc_setpoint *from,
                                       const himc_setpoint *to);

/// Tips and joint targets at `time` into `reference`; contact flags are left alone.
HIMC_RT void himc_setpoint_at(const himc_setpoint_course *course, double time,
                              himc_reference *reference);

#endif
