/// settle.h: what an arm that is too weak does instead, and what trunk and legs do while the arms
/// give other torques than were asked of them.
#ifndef HIMC_SETTLE_H
#define HIMC_SETTLE_H

#include "control/controller.h"

/// Inverse dynamics: the torques (world frame, N m) that make the relative accelerations `wanted`
/// (rad/s^2), on a pelvis that is fixed or gives way.
HIMC_RT void himc_invert(const himc_controller *controller, const himc_skeleton *skeleton,
                         const himc_body_state *state, const himc_vec3 wanted[HIMC_JOINTS],
                         himc_vec3 torque[HIMC_JOINTS]);

/// An arm whose strength times `reserve` (strength.h) is below its torques in `asked` (N m) leaves
/// out posture and then does what is `wanted` of it slower: the accelerations (rad/s^2) of all its
/// joints get one share, and `asked` becomes the torques for them.
HIMC_RT void himc_slow_weak_arms(const himc_controller *controller, const himc_skeleton *skeleton,
                                 const himc_body_state *state, const double reserve[HIMC_HANDS],
                                 himc_vec3 wanted[HIMC_JOINTS], himc_vec3 asked[HIMC_JOINTS]);

/// himc_invert asked for `asked`, and the arms have the torques of `given`: those of trunk and legs
/// that make the accelerations wanted of them all the same are put into `given`, within their
/// strength times `reserve` (strength.h). `wanted` becomes what the arms do.
HIMC_RT void himc_settle(const himc_controller *controller, const himc_skeleton *skeleton,
                         const himc_body_state *state, const double reserve[HIMC_HANDS],
                         himc_vec3 wanted[HIMC_JOINTS], const himc_vec3 asked[HIMC_JOINTS],
                         himc_vec3 given[HIMC_JOINTS]);

#endif
