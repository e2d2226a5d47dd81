/// posture_regression.c: a pose from the tips by a posture regression.
///
/// With y(t) = (R' (tip(t) - waist) - mean) / reach, R the trunk's orientation, and the terms phi =
/// [1, y(t), y(t + h), y(t + 2h)] of one arm: C_k log(mean_k^-1 q_k) = W_k phi for shoulder, elbow,
/// wrist and grip. These are rotation vectors in the trunk's frame, C_k being the mean orientation
/// of segment k in it, so palms down and thumbs up can learn from each other. The trunk's rotation
/// is linear in the terms of both hands in the same way.
///
/// The regression misses the tips by some millimetres. With S the covariance of its residuals over
/// the arm's joints and J the tip's Jacobian, the likeliest correction that brings the tip to its
/// position is S J' (J S J')^-1 e: least squares, each joint weighted by its uncertainty.
#include "control/posture_regression.h"

#include "base/quintic.h"

#include <string.h>

#define OFFSETS HIMC_REGRESSION_OFFSETS
#define TERMS HIMC_REGRESSION_TERMS
#define TRUNK_TERMS HIMC_REGRESSION_TRUNK_TERMS
#define ANGLES HIMC_REGRESSION_ANGLES
#define TRUNK (HIMC_TRUNK - 1) // the joint

#define LARGEST_CORRECTION 0.05 // of the tip, in one step; chosen: the Jacobian still holds (m)
#define CORRECTION_STEPS 3      // chosen: quadratic convergence from millimetres to 1e-5 m
#define REGULARISATION 1e-10    // of J S J'; chosen: (10 um)^2, keeps a straight arm finite (m^2)

himc_vec3 himc_posture_regression_in_trunk(himc_vec3 waist, himc_quat trunk, himc_vec3 x)
{
    return himc_quat_rotate(himc_quat_conj(trunk), himc_vec3_sub(x, waist));
}

void himc_posture_regression_terms(const himc_posture_regression_player *player, himc_hand hand,
                                   himc_quat trunk, const himc_vec3 tip[OFFSETS][HIMC_HANDS],
                                   double term[TERMS])
{
    *term++ = 1;
    for (int k = 0; k < OFFSETS; k++) {
        himc_vec3 x = himc_posture_regression_in_trunk(player->waist, trunk, tip[k][hand]);
        x = himc_vec3_scale(himc_vec3_sub(x, player->tip[hand]), 1 / player->reach[hand]);
        *term++ = x.x, *term++ = x.y, *term++ = x.z;
    }
}

void himc_posture_regression_frames(const himc_posture_regression_player *player, himc_hand hand,
                                    himc_quat frame[HIMC_ARM_JOINTS])
{
    himc_quat q = himc_quat_identity();
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        frame[k] = q = himc_quat_mul(q, player->mean.joint[himc_arm_joint(hand, k)]);
}

void himc_posture_regression_trunk_terms(const himc_posture_regression_player *player,
                                         himc_quat mean, const himc_vec3 tip[OFFSETS][HIMC_HANDS],
                                         double term[TRUNK_TERMS])
{
    double right[TERMS];
    himc_posture_regression_terms(player, HIMC_LEFT, mean, tip, term);
    himc_posture_regression_terms(player, HIMC_RIGHT, mean, tip, right);
    memcpy(term + TERMS, right + 1, (TERMS - 1) * sizeof *term);
}

// rotation = S J' f
static void apply_covariance(const double covariance[ANGLES][ANGLES], const himc_arm_levers *a,
                             himc_vec3 f, himc_vec3 rotation[HIMC_ARM_JOINTS])
{
    double g[ANGLES], sum[ANGLES];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 c = himc_vec3_cross(a->lever[k], f);
        g[3 * k] = c.x, g[3 * k + 1] = c.y, g[3 * k + 2] = c.z;
    }
    for (int c = 0; c < ANGLES; c++) {
        sum[c] = 0;
        for (int d = 0; d < ANGLES; d++)
            sum[c] += covariance[c][d] * g[d];
    }
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        rotation[k] = himc_vec3_make(sum[3 * k], sum[3 * k + 1], sum[3 * k + 2]);
}

// one step of the likeliest correction that brings the tip to `target` (from the waist, in the
// trunk's frame)
static void correct_tip(const himc_posture_regression *regression, himc_hand hand, himc_vec3 target,
                        himc_pose *pose)
{
    const double(*covariance)[ANGLES] = regression->residual_covariance[hand];
    const himc_posture_regression_player *player = &regression->player;
    himc_arm_levers a = himc_arm_levers_at(himc_vec3_make(0, 0, 0), himc_quat_identity(),
                                           player->joint[hand], player->stick, pose, hand);
    himc_mat3 gram;
    himc_vec3 rotation[HIMC_ARM_JOINTS];
    for (int c = 0; c < 3; c++) {
        himc_vec3 f = {c == 0, c == 1, c == 2};
        apply_covariance(covariance, &a, f, rotation);
        himc_vec3 m = {0, 0, 0};
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) // J x
            m = himc_vec3_add(m, himc_vec3_cross(rotation[k], a.lever[k]));
        gram.m[0][c] = m.x, gram.m[1][c] = m.y, gram.m[2][c] = m.z;
    }
    for (int i = 0; i < 3; i++)
        gram.m[i][i] += REGULARISATION;
    himc_vec3 e = himc_vec3_sub(target, a.at[HIMC_ARM_JOINTS]);
    double distance = himc_vec3_length(e);
    e = himc_vec3_scale(e, distance > LARGEST_CORRECTION ? LARGEST_CORRECTION / distance : 1);
    himc_mat3 inverse = himc_mat3_inverse_symmetric(&gram);
    apply_covariance(covariance, &a, himc_mat3_apply(&inverse, e), rotation);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        himc_vec3 own = himc_quat_rotate(himc_quat_conj(a.frame[k + 1]), rotation[k]);
        pose->joint[j] = himc_quat_mul(pose->joint[j], himc_quat_exp(own));
    }
}

void himc_posture_regression_default(himc_posture_regression *regression)
{
    *regression = (himc_posture_regression){0};
    memcpy(regression->weight, himc_posture_regression_table.weight, sizeof regression->weight);
    memcpy(regression->trunk, himc_posture_regression_table.trunk, sizeof regression->trunk);
    memcpy(regression->residual_covariance, himc_posture_regression_table.residual_covariance,
           sizeof regression->residual_covariance);
}

// the rotation vector of a row of three weights
static himc_vec3 weighted(const double *weight, const double *term, int terms)
{
    double u[3] = {0, 0, 0};
    for (int c = 0; c < 3; c++)
        for (int t = 0; t < terms; t++)
            u[c] += weight[c * terms + t] * term[t];
    return himc_vec3_make(u[0], u[1], u[2]);
}

void himc_posture_regression_at(const himc_posture_regression *regression,
                                const himc_vec3 tip[OFFSETS][HIMC_HANDS], himc_pose *pose)
{
    const himc_posture_regression_player *player = &regression->player;
    double term[TRUNK_TERMS];
    himc_quat frame[HIMC_ARM_JOINTS];
    if (player->trunk) { // it turns with the tips from its mean orientation
        himc_posture_regression_trunk_terms(player, pose->joint[TRUNK], tip, term);
        himc_vec3 turn = weighted(regression->trunk[0], term, TRUNK_TERMS);
        pose->joint[TRUNK] = himc_quat_mul(pose->joint[TRUNK], himc_quat_exp(turn));
    }
    for (int i = 0; i < HIMC_HANDS; i++) {
        himc_hand hand = (himc_hand)i;
        if (!player->arm[hand])
            continue;
        himc_posture_regression_terms(player, hand, pose->joint[TRUNK], tip, term);
        himc_posture_regression_frames(player, hand, frame);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint(hand, k);
            himc_vec3 u = weighted(regression->weight[hand][k][0], term, TERMS);
            himc_vec3 own = himc_quat_rotate(himc_quat_conj(frame[k]), u);
            pose->joint[j] = himc_quat_mul(player->mean.joint[j], himc_quat_exp(own));
        }
        himc_vec3 target =
            himc_posture_regression_in_trunk(player->waist, pose->joint[TRUNK], tip[0][hand]);
        for (int step = 0; step < CORRECTION_STEPS; step++)
            correct_tip(regression, hand, target, pose);
    }
}

void himc_posture_regression_moving(const himc_posture_regression *regression,
                                    const himc_target tip[OFFSETS][HIMC_HANDS],
                                    himc_posture_motion *motion)
{
    const himc_posture_regression_player *player = &regression->player;
    himc_quat own = himc_quat_mul(himc_quat_conj(player->natural_trunk), player->mean.joint[TRUNK]);
    himc_pose pose[3];
    for (int i = 0; i < 3; i++) {
        double dt = (i - 1) * HIMC_DIFFERENCE_STEP;
        himc_vec3 then[OFFSETS][HIMC_HANDS];
        // the player's mean, with the natural motion of the trunk and of arms not captured
        pose[i] = player->mean;
        pose[i].joint[TRUNK] = himc_quat_mul(himc_posture_joint_after(motion, TRUNK, dt), own);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            for (int k = 0; k < HIMC_ARM_JOINTS && !player->arm[hand]; k++) {
                int j = himc_arm_joint((himc_hand)hand, k);
                pose[i].joint[j] = himc_posture_joint_after(motion, j, dt);
            }
            for (int k = 0; k < OFFSETS; k++)
                then[k][hand] = himc_target_after(&tip[k][hand], dt).x;
        }
        himc_posture_regression_at(regression, (const himc_vec3(*)[HIMC_HANDS])then, &pose[i]);
    }
    himc_posture_differentiate(pose, HIMC_DIFFERENCE_STEP, 0, HIMC_JOINTS, motion);
}
