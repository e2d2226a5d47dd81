/// kinematic_step.c: inverse kinematics alone, pipeline 1 of the 2012 paper: a pose without
/// dynamics.
///
/// The body moves for a step at its present rates, and is then corrected by its tracking errors
/// (tracking_error.h): the tips by the solver, the rest by the joint targets in their null space.
/// So each physics step is one Newton step of the solver, from about 1e-5 m off.
#include "control/tracking_error.h"

static himc_vec3 in_parent(const himc_skeleton *skeleton, const himc_body_state *s, int j,
                           himc_vec3 v)
{
    return himc_mat3_apply_transposed(&s->rotation[skeleton->segment[j + 1].parent], v);
}

void himc_controller_kinematic_step(const himc_controller *c, const himc_skeleton *skeleton,
                                    const himc_reference *reference, himc_body_state *s,
                                    himc_pose *pose, himc_vec3 rate[HIMC_JOINTS])
{
    tracking_error e;
    *pose = himc_pose_from_state(skeleton, s);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        rate[j] = in_parent(skeleton, s, j, himc_relative_spin(skeleton, s, j));
        himc_quat rotate = himc_quat_exp(himc_vec3_scale(rate[j], c->step));
        pose->joint[j] = himc_quat_mul(rotate, pose->joint[j]);
    }
    himc_pose_to_state(skeleton, pose, rate, s);
    himc_tracking_error_joints(skeleton, s, &reference->posture, HIMC_JOINTS, &e);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_arm_jacobian jacobian;
        himc_arm_jacobian_weighted(s, (himc_hand)hand, c->config.weight, &jacobian);
        himc_tracking_error_tip(c, skeleton, s, &reference->tip[hand], (himc_hand)hand, &jacobian,
                                &e);
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_vec3 spin = himc_vec3_add(himc_relative_spin(skeleton, s, j), e.rate[j]);
        himc_quat rotate = himc_quat_exp(in_parent(skeleton, s, j, e.angle[j]));
        rate[j] = in_parent(skeleton, s, j, spin);
        pose->joint[j] = himc_quat_unit(himc_quat_mul(rotate, pose->joint[j]));
    }
}
