/// law.h: the laws of control: torques, or accelerations for inverse dynamics, for the tracking
/// errors of the joints.
///
/// A law is a file with its function himc_law_NAME and a row of HIMC_LAWS in himc/command_rows.h.
/// While a stick touches the head each law gives it the hand's acceleration along the normal
/// (grip.h), none in a stroke: the physics makes the rebound.
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

/// For all joints (world frame), torques (N m) or the relative accelerations (rad/s^2) that torques
/// are to make.
typedef void law_function(const law_input *in, himc_vec3 out[HIMC_JOINTS]);

typedef struct himc_law_row {
    law_function *find; ///< HIMC_RT
    /// it gives accelerations; then tips lag so little that a drift before a touch can be planned
    /// away
    bool accelerates;
} himc_law_row;

extern const himc_law_row himc_laws[HIMC_LAW_COUNT];
#define HIMC_LAW_FUNCTION(ID, name, word, accelerates) law_function himc_law_##name;
HIMC_LAWS(HIMC_LAW_FUNCTION)

#endif
