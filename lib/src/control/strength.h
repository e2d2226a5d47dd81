/// strength.h: the largest torques of the joints.
#ifndef HIMC_STRENGTH_H
#define HIMC_STRENGTH_H

#include "control/controller.h"

/// The controller's articulation of this state, else that without the legs, computed in `own`.
HIMC_RT const himc_articulation *himc_strength_articulation(const himc_controller *controller,
                                                            const himc_skeleton *skeleton,
                                                            const himc_body_state *state,
                                                            himc_articulation *own);

/// Factor of a man's strength in a hand's arm, for the distance of its tip from its target; 1 where
/// that is small.
HIMC_RT double himc_strength_reserve(const himc_controller *controller,
                                     const himc_reference *reference, const himc_body_state *state,
                                     himc_hand hand);

/// The joint's maximum at its speed along this torque, times the reserve of its arm (N m); infinite
/// without one.
HIMC_RT double himc_strength_most(const himc_controller *controller, const himc_skeleton *skeleton,
                                  const himc_body_state *state, int joint,
                                  const double reserve[HIMC_HANDS], himc_vec3 torque);

/// Shortens a joint's torque to that maximum; false: it was within that of a man without reserve.
HIMC_RT bool himc_strength_bound(const himc_controller *controller, const himc_skeleton *skeleton,
                                 const himc_body_state *state, int joint,
                                 const double reserve[HIMC_HANDS], himc_vec3 *torque);

/// Shortens all torques so, and counts in the controller's saturation counts.
HIMC_RT void himc_strength_apply(const himc_controller *controller, const himc_skeleton *skeleton,
                                 const himc_body_state *state, const double reserve[HIMC_HANDS],
                                 himc_vec3 torque[HIMC_JOINTS]);

#endif
