/// pose.c: forward kinematics along the tree in one pass, since parents stand before children in
/// the table.
///
/// p_c = p_p + R_p o_c, R_c = R_p R(q_c), w_c = w_p + R_p w_rel, tip velocity by summing w x r
/// along the arm.
#include "himc/body.h"

himc_pose himc_pose_zero(void)
{
    himc_pose pose;
    for (int j = 0; j < HIMC_JOINTS; j++)
        pose.joint[j] = himc_quat_identity();
    return pose;
}

void himc_body_state_complete(const himc_skeleton *skeleton, himc_body_state *s)
{
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        s->rotation[i] = himc_mat3_from_quat(s->orientation[i]);
        s->origin[i] = segment->origin; // the root's, in the world
        if (segment->parent >= 0)
            s->origin[i] =
                himc_vec3_add(s->origin[segment->parent],
                              himc_mat3_apply(&s->rotation[segment->parent], segment->origin));
    }
    s->velocity = himc_vec3_make(0, 0, 0);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int stick = himc_stick_segment((himc_hand)hand);
        himc_vec3 velocity = {0, 0, 0};
        himc_vec3 end = s->tip[hand] =
            himc_vec3_add(s->origin[stick], himc_mat3_apply(&s->rotation[stick], skeleton->tip));
        for (int i = stick; i >= 0; i = skeleton->segment[i].parent) {
            himc_vec3 link = himc_vec3_sub(end, s->origin[i]);
            velocity = himc_vec3_add(velocity, himc_vec3_cross(s->spin[i], link));
            end = s->origin[i];
        }
        s->tip_velocity[hand] = velocity;
    }
}

void himc_pose_to_state(const himc_skeleton *skeleton, const himc_pose *pose, const himc_vec3 *rate,
                        himc_body_state *s)
{
    s->orientation[0] = himc_quat_identity();
    s->spin[0] = himc_vec3_make(0, 0, 0);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        int parent = skeleton->segment[i].parent;
        s->orientation[i] = himc_quat_mul(s->orientation[parent], pose->joint[i - 1]);
        s->spin[i] = s->spin[parent];
        if (rate)
            s->spin[i] =
                himc_vec3_add(s->spin[i], himc_quat_rotate(s->orientation[parent], rate[i - 1]));
    }
    himc_body_state_complete(skeleton, s);
}

himc_pose himc_pose_from_state(const himc_skeleton *skeleton, const himc_body_state *s)
{
    himc_pose pose;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        int parent = skeleton->segment[j + 1].parent;
        pose.joint[j] =
            himc_quat_mul(himc_quat_conj(s->orientation[parent]), s->orientation[j + 1]);
    }
    return pose;
}

bool himc_body_state_finite(const himc_body_state *s)
{
    // a body state consists of doubles only; x - x is NaN if x is not finite, and so is the sum
    const double *number = (const double *)s;
    double sum = 0;
    for (size_t i = 0; i < sizeof *s / sizeof *number; i++)
        sum += number[i] - number[i];
    return sum == 0;
}
