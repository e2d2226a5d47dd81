/// tracking_error.h: missing angles and rates of the joints: to their own targets, or to bring the
/// tips to theirs.
#ifndef HIMC_TRACKING_ERROR_H
#define HIMC_TRACKING_ERROR_H

#include "body/dynamics.h"
#include "control/controller.h"

/// Of each joint, in the world.
typedef struct tracking_error {
    himc_vec3 angle[HIMC_JOINTS];        ///< dq (rad)
    himc_vec3 rate[HIMC_JOINTS];         ///< q'_t - q' (rad/s)
    himc_vec3 acceleration[HIMC_JOINTS]; ///< q''_t (rad/s^2)
} tracking_error;

/// Of the first `joints` joints to their targets.
HIMC_RT void himc_tracking_error_joints(const himc_skeleton *skeleton, const himc_body_state *s,
                                        const himc_posture_motion *target, int joints,
                                        tracking_error *e);

/// The joints that this step computes: not the legs', where they are asked for the same as before.
static inline int himc_joints_computed(const himc_controller *c)
{
    return c->legs && c->legs->asked ? HIMC_LEGS - 1 : HIMC_JOINTS;
}

/// Replaces the errors of an arm's joints by those that bring its tip to `asked`, or to the nearest
/// place in reach; the old errors move into the null space.
HIMC_RT void himc_tracking_error_tip(const himc_controller *c, const himc_skeleton *skeleton,
                                     const himc_body_state *s, const himc_target *asked,
                                     himc_hand hand, const himc_arm_jacobian *jacobian,
                                     tracking_error *e);

/// Of a joint: its child's spin in the parent's, in the world (rad/s).
static inline himc_vec3 himc_relative_spin(const himc_skeleton *skeleton, const himc_body_state *s,
                                           int j)
{
    return himc_vec3_sub(s->spin[j + 1], s->spin[skeleton->segment[j + 1].parent]);
}

static inline void himc_arm_gather(const himc_vec3 *all, himc_hand hand,
                                   himc_vec3 arm[HIMC_ARM_JOINTS])
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        arm[k] = all[himc_arm_joint(hand, k)];
}

static inline void himc_arm_scatter(const himc_vec3 arm[HIMC_ARM_JOINTS], himc_hand hand,
                                    himc_vec3 *all)
{
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        all[himc_arm_joint(hand, k)] = arm[k];
}

#endif
