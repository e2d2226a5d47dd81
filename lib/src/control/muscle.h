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

/// One step of `h` (s) from the torques that the law asks for to those that muscles of that
/// strength give (N m; 0: no maximum, no muscle), with hands that touch in a stroke.
HIMC_RT void himc_muscles_act(himc_muscles *muscles, const bool struck[HIMC_HANDS],
                              const double strength[HIMC_JOINTS], double h,
                              himc_vec3 torque[HIMC_JOINTS]);

#endif
