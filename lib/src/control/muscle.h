/// muscle.h: how fast muscles change their torques: activation is slow, co-contraction is there at
/// once and small.
#ifndef HIMC_MUSCLE_H
#define HIMC_MUSCLE_H

#include "control/controller.h"

/// Of the arms; plain. After a stroke's contact it lasts until the muscles are back with the law.
typedef struct himc_muscles {
    double since[HIMC_HANDS];           ///< the end of a stroke's contact (s)
    himc_vec3 active[HIMC_JOINTS];      ///< world frame (N m)
    double co_contraction[HIMC_JOINTS]; ///< of the last step, over the strength
} himc_muscles;

/// No contact has been.
HIMC_RT void himc_muscles_rest(himc_muscles *muscles);

/// What muscles get in one step.
typedef struct himc_muscle_input {
    const bool *struck;           ///< hands that touch in a stroke
    const double *reserve;        ///< of each arm (strength.h)
    const double *strength;       ///< of the joints (N m); 0: no maximum, no muscle
    const himc_vec3 *rate;        ///< what the joints' rates miss (rad/s)
    const himc_articulation *art; ///< of the arms at least
    double h;                     ///< the step (s)
} himc_muscle_input;

/// From the torques that the law asks for to those that muscles give (N m).
HIMC_RT void himc_muscles_act(himc_muscles *muscles, const himc_muscle_input *in,
                              himc_vec3 torque[HIMC_JOINTS]);

#endif
