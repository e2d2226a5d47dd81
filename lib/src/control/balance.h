/// balance.h: control of a body whose pelvis is free: torques that move the joints as wanted while
/// the pelvis gives way.
#ifndef HIMC_BALANCE_H
#define HIMC_BALANCE_H

#include "body/dynamics.h"
#include "body/support.h"
#include "control/controller.h"
#include "body/stand.h"
#include "control/tracking_error.h"

/// What holds the body; computed again in each step by himc_balance_feel, except the
/// acceleration and what `stand` keeps.
typedef struct himc_balance {
    himc_spatial acceleration;   ///< of the pelvis in the last step (rad/s^2, m/s^2); 0 at first
    himc_spatial carried;        ///< wrench of all supports, about the pelvis' origin (N m, N)
    himc_vec3 felt[HIMC_JOINTS]; ///< torques of the joints that act as the supports do (N m)
    himc_stand stand;
} himc_balance;

/// The acceleration of a pelvis that is free in the last step; NULL: it is fixed.
static inline const himc_spatial *himc_pelvis_acceleration(const himc_controller *controller)
{
    return controller->balance ? &controller->balance->acceleration : NULL;
}

/// Takes up where and how the supports press in this state.
HIMC_RT void himc_balance_feel(himc_balance *balance, const himc_support *support,
                               const himc_skeleton *skeleton, const himc_body_state *state);

/// himc_forward_dynamics with the supports of this body too (NULL: the pelvis is fixed); returns
/// the pelvis' acceleration.
HIMC_RT himc_spatial himc_balance_accelerate(
    const himc_balance *balance, const himc_skeleton *skeleton, const himc_body_state *state,
    const himc_articulation *articulation, const himc_vec3 torque[HIMC_JOINTS],
    const himc_vec3 *tip_force, himc_vec3 relative[HIMC_JOINTS]);

/// Relative accelerations (rad/s^2) of hips, knees and ankles in place of `wanted`: a soft posture,
/// whatever bandwidth and gains are, and what keeps one who stands on his feet; `step` is the time
/// to the next (s).
HIMC_RT void himc_balance_legs(himc_balance *balance, const himc_body_state *state,
                               const tracking_error *error, double step,
                               himc_vec3 wanted[HIMC_JOINTS]);

/// The torques (world frame, N m) that make the relative accelerations `wanted` (rad/s^2) while the
/// supports press as they do; keeps the pelvis' acceleration.
HIMC_RT void himc_balance_torques(const himc_controller *controller, const himc_skeleton *skeleton,
                                  const himc_body_state *state, const himc_vec3 wanted[HIMC_JOINTS],
                                  himc_vec3 torque[HIMC_JOINTS]);

#endif
