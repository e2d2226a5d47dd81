/// limit_torque.h: joint limits in the laws of control; without limits these do nothing.
#ifndef HIMC_LIMIT_TORQUE_H
#define HIMC_LIMIT_TORQUE_H

#include "control/controller.h"
#include "control/tracking_error.h"

/// Changes relative accelerations so that joints stay within their bounds or come back; the arms'
/// other degrees of freedom compensate at the tips. So limits have priority over tips, and tips
/// over posture. Counts in the controller's saturation counts.
HIMC_RT void himc_limits_compliance(const himc_controller *controller,
                                    const himc_skeleton *skeleton, const himc_body_state *state,
                                    const himc_arm_jacobian jacobian[HIMC_HANDS],
                                    himc_vec3 wanted[HIMC_JOINTS]);

/// The paper's torque k e - d omega at joints beyond their bounds (N m), implicit over the
/// controller's step: adds its known part to `torque` and the rest to the joints' `resistance`
/// (kg m^2, about the child's axes). Counts in the controller's saturation counts.
HIMC_RT void himc_limits_resist(const himc_controller *controller, const himc_skeleton *skeleton,
                                const himc_body_state *state, himc_vec3 torque[HIMC_JOINTS],
                                himc_vec3 resistance[HIMC_JOINTS]);

/// Bounds the errors of the joints of arms that have limits.
HIMC_RT void himc_limits_bound_errors(const himc_controller *controller, tracking_error *errors);

#endif
