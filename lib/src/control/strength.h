/// strength.h: the most that the joints' torques may be.
#ifndef HIMC_STRENGTH_H
#define HIMC_STRENGTH_H

#include "control/controller.h"

/// Shortens torques to the controller's maxima, and counts in its strain.
HIMC_RT void himc_strength_apply(const himc_controller *controller, himc_vec3 torque[HIMC_JOINTS]);

#endif
