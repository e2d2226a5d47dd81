/// strength.h: the largest torques of the joints.
#ifndef HIMC_STRENGTH_H
#define HIMC_STRENGTH_H

#include "control/controller.h"

/// Shortens torques to the controller's maxima at the joints' speeds, and counts in its saturation
/// counts.
HIMC_RT void himc_strength_apply(const himc_controller *controller, const himc_skeleton *skeleton,
                                 const himc_body_state *state, himc_vec3 torque[HIMC_JOINTS]);

#endif
