/// limit_torque.h: what joint limits make of a controller's wishes; nothing where it has none.
#ifndef HIMC_LIMIT_TORQUE_H
#define HIMC_LIMIT_TORQUE_H

#include "control/controller.h"

/// Turns relative accelerations so that joints stay within their bounds or come back; what the tips
/// lose by that the arms' other freedoms give them, so that limits win over tips and tips over
/// posture. Counts in the controller's strain.
HIMC_RT void himc_limits_compliance(const himc_controller *controller,
                                    const himc_skeleton *skeleton, const himc_body_state *state,
                                    const himc_arm_jacobian jacobian[HIMC_HANDS],
                                    himc_vec3 wanted[HIMC_JOINTS]);

/// The paper's torque k e - d omega at joints beyond their bounds (N m), implicit over the
/// controller's step: adds what is known of it to `torque` and the rest to the joints' `resistance`
/// (kg m^2, about the child's axes). Counts in the controller's strain.
HIMC_RT void himc_limits_resist(const himc_controller *controller, const himc_skeleton *skeleton,
                                const himc_body_state *state, himc_vec3 torque[HIMC_JOINTS],
                                himc_vec3 resistance[HIMC_JOINTS]);

#endif
