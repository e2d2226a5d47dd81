/// law.h: the laws of control, inverse dynamics: the torques for the tracking errors of the joints.
///
/// A law is a file with its function and a row in law.c; its word stands in the row of `law` in
/// himc/command_rows.h. While a stick touches the head each law gives it the hand's acceleration
/// along the normal (grip.h), none in a stroke: the physics makes the rebound.
#ifndef HIMC_LAW_H
#define HIMC_LAW_H

#include "control/controller.h"
#include "control/tracking_error.h"

/// All that a law may use.
typedef struct law_input {
    const himc_controller *controller;
    const himc_skeleton *skeleton;
    const himc_body_state *state;
    const himc_reference *reference;
    const himc_arm_jacobian *jacobian; ///< of both hands
    tracking_error *error;             ///< may be changed
} law_input;

/// The torques of all joints (world frame, N m).
typedef void law_torques(const law_input *in, himc_vec3 torque[HIMC_JOINTS]);

typedef struct himc_law_row {
    const char *word;     ///< of the command `law`
    law_torques *torques; ///< HIMC_RT
    bool lands_exactly;   ///< tips lag so little that a drift before a touch can be planned away
} himc_law_row;

/// In the order of himc_law.
extern const himc_law_row himc_laws[HIMC_LAWS];

law_torques himc_law_printed, himc_law_feedforward, himc_law_computed_torque;

#endif
