/// limit_torque.h: what joint limits make of a controller's wishes.
#ifndef HIMC_LIMIT_TORQUE_H
#define HIMC_LIMIT_TORQUE_H

#include "himc/controller.h"

/// The joints beyond their bounds, and how each has to accelerate to come back.
typedef struct himc_limit_hits {
    int count;
    int joint[HIMC_JOINTS];
    himc_vec3 inward[HIMC_JOINTS]; ///< unit vectors of the world, along which they return
    double least[HIMC_JOINTS];     ///< accelerations along them, at least (rad/s^2)
} himc_limit_hits;

/// Finds them, and counts in the controller's strain. None if limits are off.
HIMC_RT void himc_limits_meet(const himc_controller *controller, const himc_skeleton *skeleton,
                              const himc_body_state *state, himc_limit_hits *hits);

/// Relative accelerations that go back where they must; what the tips lose by that the arms' other
/// freedoms give them, so that limits win over tips and tips over posture.
HIMC_RT void himc_limits_yield(const himc_limit_hits *hits, const himc_skeleton *skeleton,
                               const himc_body_state *state,
                               const himc_arm_jacobian jacobian[HIMC_HANDS],
                               himc_vec3 wanted[HIMC_JOINTS]);

/// Adds to torques those at the joints hit, inward only, that make them accelerate so (N m).
HIMC_RT void himc_limits_resist(const himc_limit_hits *hits, const himc_skeleton *skeleton,
                                const himc_body_state *state, himc_vec3 torque[HIMC_JOINTS]);

#endif
