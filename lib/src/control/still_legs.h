/// still_legs.h: the errors and torques of legs at rest, kept from step to step: they hang on the
/// legs' own state and targets alone, since the pelvis is fixed; private.
#ifndef HIMC_STILL_LEGS_H
#define HIMC_STILL_LEGS_H

#include "control/tracking_error.h"

#define HIMC_LEG_SEGMENTS (HIMC_SEGMENTS - HIMC_LEFT_UPPER_LEG)

/// What entered the last step, and what came out. 0: nothing yet.
struct himc_still_legs {
    bool known, torque_known; ///< of the state below; the torque is of it, too
    himc_vec3 pelvis, origin[HIMC_LEG_SEGMENTS], spin[HIMC_LEG_SEGMENTS];
    himc_quat orientation[HIMC_LEG_SEGMENTS], joint[HIMC_LEG_SEGMENTS];
    himc_mat3 rotation[HIMC_LEG_SEGMENTS];
    himc_vec3 rate[HIMC_LEG_SEGMENTS], acceleration[HIMC_LEG_SEGMENTS]; ///< of the targets
    himc_vec3 error[3][HIMC_LEG_SEGMENTS]; ///< of angle, rate, acceleration
    himc_vec3 wanted[HIMC_LEG_SEGMENTS], torque[HIMC_LEG_SEGMENTS];
};

/// himc_tracking_error_joints, of the legs' joints.
HIMC_RT void himc_still_legs_errors(himc_still_legs *legs, const himc_skeleton *skeleton,
                                    const himc_body_state *state, const himc_posture_motion *target,
                                    tracking_error *e);

/// himc_inverse_dynamics, of the legs' joints; after the errors of the same state.
HIMC_RT void himc_still_legs_torques(himc_still_legs *legs, const himc_skeleton *skeleton,
                                     const himc_body_state *state, const himc_vec3 *wanted,
                                     himc_vec3 torque[HIMC_JOINTS]);

#endif
