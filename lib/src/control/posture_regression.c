/// habit.c: a posture from the tips: the regression, and what it misses.
///
/// With y(t) = (R' (tip(t) - waist) - mean) / reach, R the trunk's rotation, and the terms phi =
/// [1, y(t), y(t + h), y(t + 2h)] of a hand, C_k log(mean_k^-1 q_k) = W_k phi for shoulder, elbow,
/// wrist and grip: rotation vectors seen from the trunk, C_k being the mean rotation of segment k
/// in it, so that hands that hold the stick palm down or thumb up learn from each other. The trunk
/// sways likewise with the terms of both hands.
///
/// A regression misses the tips themselves by some millimetres. With S the covariance of its
/// residuals over the arm's joints and J the tip's Jacobian, the likeliest correction that brings
/// the tip to its place is S J' (J S J')^-1 e: least squares again, weighted by how surely each
/// joint is known.
#include "control/posture_regression_terms.h"

#include "base/difference.h"
#include "base/quintic.h"

#include <string.h>

#define LARGEST_STEP 0.05 // of the tip, in one correction (m)
#define CORRECTIONS 3     // quadratically converging

himc_vec3 himc_posture_regression_seen(himc_vec3 waist, himc_quat trunk, himc_vec3 x)
{
    return himc_quat_rotate(himc_quat_conj(trunk), himc_vec3_sub(x, waist));
}

void himc_posture_regression_terms(const himc_posture_regression_player *player, himc_hand hand,
                                   himc_quat trunk, const himc_vec3 tip[TAPS][HIMC_HANDS],
                                   double term[TERMS])
{
    *term++ = 1;
    for (int tap = 0; tap < TAPS; tap++) {
        himc_vec3 x = himc_posture_regression_seen(player->waist, trunk, tip[tap][hand]);
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
                                         himc_quat mean, const himc_vec3 tip[TAPS][HIMC_HANDS],
                                         double term[TRUNK_TERMS])
{
    double right[TERMS];
    himc_posture_regression_terms(player, HIMC_LEFT, mean, tip, term);
    himc_posture_regression_terms(player, HIMC_RIGHT, mean, tip, right);
    memcpy(term + TERMS, right + 1, (TERMS - 1) * sizeof *term);
}

typedef struct arm {
    himc_quat frame[HIMC_ARM_JOINTS]; // of the segments, in the trunk
    himc_vec3 lever[HIMC_ARM_JOINTS]; // to the tip (m)
    himc_vec3 tip;                    // from the trunk's joint (m)
} arm;

static void place_arm(const himc_posture_regression_player *player, himc_hand hand,
                      const himc_pose *pose, arm *a)
{
    himc_quat q = himc_quat_identity();
    himc_vec3 at = {0, 0, 0};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        at = himc_vec3_add(at, himc_quat_rotate(q, player->joint[hand][k]));
        a->frame[k] = q = himc_quat_mul(q, pose->joint[himc_arm_joint(hand, k)]);
        a->lever[k] = at;
    }
    a->tip = himc_vec3_add(at, himc_quat_rotate(q, player->stick));
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        a->lever[k] = himc_vec3_sub(a->tip, a->lever[k]);
}

// turn = S J' f
static void spread_through(const double spread[ANGLES][ANGLES], const arm *a, himc_vec3 f,
                           himc_vec3 turn[HIMC_ARM_JOINTS])
{
    double g[ANGLES], sum[ANGLES];
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        himc_vec3 c = himc_vec3_cross(a->lever[k], f);
        g[3 * k] = c.x, g[3 * k + 1] = c.y, g[3 * k + 2] = c.z;
    }
    for (int c = 0; c < ANGLES; c++) {
        sum[c] = 0;
        for (int d = 0; d < ANGLES; d++)
            sum[c] += spread[c][d] * g[d];
    }
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        turn[k] = himc_vec3_make(sum[3 * k], sum[3 * k + 1], sum[3 * k + 2]);
}

static himc_vec3 moved_by(const arm *a, const himc_vec3 turn[HIMC_ARM_JOINTS])
{
    himc_vec3 moved = {0, 0, 0};
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        moved = himc_vec3_add(moved, himc_vec3_cross(turn[k], a->lever[k]));
    return moved;
}

// one step of the likeliest correction towards the tip's place (from the trunk's joint, in its
// frame)
static void correct(const himc_posture_regression *regression, himc_hand hand, himc_vec3 place,
                    himc_pose *pose)
{
    arm a;
    himc_mat3 gram;
    himc_vec3 turn[HIMC_ARM_JOINTS];
    place_arm(&regression->player, hand, pose, &a);
    for (int c = 0; c < 3; c++) {
        himc_vec3 f = {c == 0, c == 1, c == 2};
        spread_through(regression->spread[hand], &a, f, turn);
        himc_vec3 m = moved_by(&a, turn);
        gram.m[0][c] = m.x, gram.m[1][c] = m.y, gram.m[2][c] = m.z;
    }
    for (int i = 0; i < 3; i++)
        gram.m[i][i] += 1e-10;
    himc_vec3 e = himc_vec3_sub(place, a.tip);
    double far = himc_vec3_length(e);
    e = himc_vec3_scale(e, far > LARGEST_STEP ? LARGEST_STEP / far : 1);
    himc_mat3 inverse = himc_mat3_inverse_symmetric(&gram);
    spread_through(regression->spread[hand], &a, himc_mat3_apply(&inverse, e), turn);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        himc_vec3 own = himc_quat_rotate(himc_quat_conj(a.frame[k]), turn[k]);
        pose->joint[j] = himc_quat_mul(pose->joint[j], himc_quat_exp(own));
    }
}

void himc_posture_regression_usual(himc_posture_regression *regression)
{
    *regression = (himc_posture_regression){0};
    memcpy(regression->weight, himc_posture_regression_table.weight, sizeof regression->weight);
    memcpy(regression->trunk, himc_posture_regression_table.trunk, sizeof regression->trunk);
    memcpy(regression->spread, himc_posture_regression_table.spread, sizeof regression->spread);
}

// how the trunk sways with the sticks, from where it bears itself on average
static himc_quat sway(const himc_posture_regression *regression,
                      const himc_vec3 tip[TAPS][HIMC_HANDS], himc_quat trunk)
{
    double term[TRUNK_TERMS], u[3] = {0, 0, 0};
    himc_posture_regression_trunk_terms(&regression->player, trunk, tip, term);
    for (int c = 0; c < 3; c++)
        for (int t = 0; t < TRUNK_TERMS; t++)
            u[c] += regression->trunk[c][t] * term[t];
    return himc_quat_mul(trunk, himc_quat_exp(himc_vec3_make(u[0], u[1], u[2])));
}

void himc_posture_regression_at(const himc_posture_regression *regression,
                                const himc_vec3 tip[TAPS][HIMC_HANDS], himc_pose *pose)
{
    if (regression->player.trunk)
        pose->joint[TRUNK] = sway(regression, tip, pose->joint[TRUNK]);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        if (!regression->player.arm[hand])
            continue;
        double term[TERMS];
        himc_quat frame[HIMC_ARM_JOINTS];
        himc_posture_regression_terms(&regression->player, (himc_hand)hand, pose->joint[TRUNK], tip,
                                      term);
        himc_posture_regression_frames(&regression->player, (himc_hand)hand, frame);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            double u[3] = {0, 0, 0};
            for (int c = 0; c < 3; c++)
                for (int t = 0; t < TERMS; t++)
                    u[c] += regression->weight[hand][k][c][t] * term[t];
            int j = himc_arm_joint((himc_hand)hand, k);
            himc_vec3 own =
                himc_quat_rotate(himc_quat_conj(frame[k]), himc_vec3_make(u[0], u[1], u[2]));
            pose->joint[j] = himc_quat_mul(regression->player.mean.joint[j], himc_quat_exp(own));
        }
        himc_vec3 place = himc_posture_regression_seen(regression->player.waist, pose->joint[TRUNK],
                                                       tip[0][hand]);
        for (int i = 0; i < CORRECTIONS; i++)
            correct(regression, (himc_hand)hand, place, pose);
    }
}

// a joint of a motion, `dt` later
static himc_quat joint_after(const himc_posture_motion *m, int j, double dt)
{
    himc_vec3 turn =
        himc_vec3_madd(himc_vec3_scale(m->rate[j], dt), 0.5 * dt * dt, m->acceleration[j]);
    return himc_quat_mul(himc_quat_exp(turn), m->joint[j]);
}

void himc_posture_regression_moving(const himc_posture_regression *regression,
                                    const himc_target tip[TAPS][HIMC_HANDS],
                                    himc_posture_motion *motion)
{
    const himc_posture_regression_player *player = &regression->player;
    himc_pose pose[3];
    himc_quat own = himc_quat_mul(himc_quat_conj(player->usual), player->mean.joint[TRUNK]);
    for (int i = 0; i < 3; i++) {
        double dt = (i - 1) * HIMC_DIFFERENCE_STEP;
        himc_vec3 then[TAPS][HIMC_HANDS];
        pose[i] = player->mean;
        pose[i].joint[TRUNK] = himc_quat_mul(joint_after(motion, TRUNK, dt), own);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            for (int k = 0; k < HIMC_ARM_JOINTS && !player->arm[hand]; k++)
                pose[i].joint[himc_arm_joint((himc_hand)hand, k)] =
                    joint_after(motion, himc_arm_joint((himc_hand)hand, k), dt);
        for (int tap = 0; tap < TAPS; tap++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                then[tap][hand] = himc_target_after(&tip[tap][hand], dt).x;
        himc_posture_regression_at(regression, (const himc_vec3(*)[HIMC_HANDS])then, &pose[i]);
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        motion->joint[j] = pose[1].joint[j];
        himc_differentiate(pose[0].joint[j], pose[1].joint[j], pose[2].joint[j],
                           HIMC_DIFFERENCE_STEP, &motion->rate[j], &motion->acceleration[j]);
    }
}
