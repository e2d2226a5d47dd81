/// engine_ode.h: the Open Dynamics Engine's copy of the body, private. A library may be built
/// without it (HIMC_NO_ODE): then `engine ode` is refused.
#ifndef HIMC_ENGINE_ODE_H
#define HIMC_ENGINE_ODE_H

#include "body/tree.h"

/// Share of a joint's drift that an engine corrects per step. Chosen: the drift is 3e-8 m then.
#define HIMC_JOINT_ERP 0.8

/// Bodies and joints of ODE. Opaque.
typedef struct himc_ode himc_ode;

/// False in a library without ODE; then all below does nothing.
HIMC_RT bool himc_ode_is_here(void);
/// Bodies and joints at rest in the zero pose, whose states these are. NULL, with an error, if
/// memory is short. Call it from the thread that will step.
himc_ode *himc_ode_new(const himc_skeleton *skeleton, const segment_states *zero,
                       himc_error *error);
void himc_ode_free(himc_ode *ode);
/// Gives ODE's bodies a state.
HIMC_RT void himc_ode_give(himc_ode *ode, const segment_states *state);
/// The same where the pelvis, which is ODE's world, has another place.
HIMC_RT void himc_ode_seat(himc_ode *ode, const segment_states *state);
/// One step of `h` seconds; `state` gets the outcome.
HIMC_RT void himc_ode_step(himc_ode *ode, const segment_forces *forces, double h,
                           segment_states *state);

#endif
