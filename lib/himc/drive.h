/// drive.h: a performer's joints driven from outside, by a controller of one's own or a learner.
#ifndef HIMC_DRIVE_H
#define HIMC_DRIVE_H

#include "himc/body.h"
#include "himc/performance.h"

HIMC_BEGIN

/// What drives joints. Where `aimed`, a joint of mode `id` is to have `rotation` and `rate` (in its
/// parent's frame); in `himc` they are the posture of the null space. Where `turned`, `torque` (on
/// the child, about its own axes) takes the place of the controller's; neither strength nor limits
/// act on it. Without effect in `ik`. In the order of himc_joint_name.
typedef struct himc_drive {
    bool aimed[HIMC_JOINTS], turned[HIMC_JOINTS];
    himc_quat rotation[HIMC_JOINTS]; ///< unit
    himc_vec3 rate[HIMC_JOINTS];     ///< (rad/s)
    himc_vec3 torque[HIMC_JOINTS];   ///< (N m)
} himc_drive;

/// Drives joints so from now to the next call, or to a reset; NULL: the performer alone does.
/// False, and nothing changed, with the reason: a rotation of no unit length, a number that is not
/// finite.
HIMC_RT bool himc_performance_drive(himc_performance *performance, const himc_drive *drive,
                                    himc_error *error);

HIMC_END

#endif
