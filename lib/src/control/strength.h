/// strength.h: the largest torques of the joints.
#ifndef HIMC_STRENGTH_H
#define HIMC_STRENGTH_H

#include "control/controller.h"

/// Shortens a joint's torque to its maximum at the joint's speed; false: it has not.
HIMC_RT bool himc_strength_bound(const himc_controller *controller, const himc_skeleton *skeleton,
                                 const himc_body_state *state, int joint, himc_vec3 *torque);

/// Shortens all torques so, and counts in the controller's saturation counts.
HIMC_RT void himc_strength_apply(const himc_controller *controller, const himc_skeleton *skeleton,
                                 const himc_body_state *state, himc_vec3 torque[HIMC_JOINTS]);

#endif
