/// dynamics.h: forward dynamics with implicit servos, and the tips' accelerations; private.
#ifndef HIMC_DYNAMICS_H
#define HIMC_DYNAMICS_H

#include "himc/body.h"

/// Articulated inertias of all segments, legs included, where each joint resists its own relative
/// acceleration by `resistance` about the child's axes (kg m^2). This models a servo integrated
/// implicitly over a step, D = h Kd + h^2 Kp (Tan, Liu & Turk 2011). himc_forward_dynamics then
/// writes the legs' joints too; himc_effective_mass does not allow such an articulation.
HIMC_RT void himc_articulate_resisting(const himc_skeleton *skeleton, const himc_body_state *state,
                                       const himc_vec3 resistance[HIMC_JOINTS],
                                       himc_articulation *articulation);

/// Acceleration of a drumstick tip (m/s^2) under the joints' relative accelerations (rad/s^2)
/// (HIMC_JOINTS; NULL for zero).
HIMC_RT himc_vec3 himc_tip_acceleration(const himc_skeleton *skeleton, const himc_body_state *state,
                                        himc_hand hand, const himc_vec3 *relative);

#endif
