/// habit.c: linear regression from the tips to the arms.
///
/// For each hand, with the terms phi = [1, (y - mean y) / reach, y' / reach] of its tip's place y =
/// R' (tip - waist) in the trunk's frame, log(mean^-1 q_k) = W_k phi for shoulder, elbow, wrist and
/// grip, W by least squares over all frames of all players (LAPACK's dgelsd, singular values under
/// 1e-4 of the largest left out: the solution of least norm). The logarithm is taken about each
/// player's own mean rotation, the eigenvector of the largest eigenvalue of sum q q' (Markley,
/// Cheng, Crassidis and Oshman 2007). What is learned is so how a player departs from his own usual
/// posture, and lengths are told in his own arm's.
#include "himc/habit.h"

#include "difference.h"

#include <lapacke.h>
#include <stdlib.h>
#include <string.h>

#define TERMS HIMC_HABIT_TERMS
#define TRUNK (HIMC_TRUNK - 1) // the joint
#define ANGLES (3 * HIMC_ARM_JOINTS)
#define FEWEST 100      // frames of a player
#define NEGLIGIBLE 1e-4 // singular values under this share of the largest

static bool mean_rotation(const himc_pose *pose, int frames, int joint, himc_quat *mean)
{
    double a[16] = {0}, value[4];
    for (int i = 0; i < frames; i++) {
        const himc_quat q = pose[i].joint[joint];
        const double v[4] = {q.w, q.x, q.y, q.z};
        for (int k = 0; k < 16; k++)
            a[k] += v[k / 4] * v[k % 4];
    }
    if (LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', 4, a, 4, value) != 0)
        return false;
    *mean = himc_quat_unit((himc_quat){a[3], a[7], a[11], a[15]});
    return true;
}

static himc_vec3 seen_from_trunk(himc_vec3 waist, himc_quat trunk, himc_vec3 x)
{
    return himc_quat_rotate(himc_quat_conj(trunk), himc_vec3_sub(x, waist));
}

// the trunk as himc_posture_bearing has it for tips where a player's are on average
static himc_quat usual_bearing(const himc_skeleton *skeleton, const himc_habit_player *player)
{
    himc_posture posture;
    himc_pose pose;
    himc_vec3 place[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        place[hand] = himc_vec3_add(player->waist,
                                    himc_quat_rotate(player->mean.joint[TRUNK], player->tip[hand]));
    himc_posture_init(&posture, skeleton, 0);
    posture.bearing = himc_posture_bearing(place, HIMC_GRIP_GERMAN);
    himc_posture_at(&posture, place, &pose);
    return pose.joint[TRUNK];
}

bool himc_habit_meet(himc_habit_player *player, const himc_habit_motion *motion, himc_error *error)
{
    const himc_skeleton *skeleton = motion->skeleton;
    if (motion->frames < FEWEST)
        return himc_error_set(error, "habit: %d frames of a player, allowed %d or more",
                              motion->frames, FEWEST);
    player->waist = himc_vec3_add(skeleton->root, skeleton->segment[HIMC_TRUNK].origin);
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (!mean_rotation(motion->pose, motion->frames, j, &player->mean.joint[j]))
            return himc_error_set(error, "habit: %s: rotations without a mean, allowed finite ones",
                                  himc_joint_name(j));
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 sum = {0, 0, 0};
        for (int i = 0; i < motion->frames; i++)
            sum = himc_vec3_add(sum, seen_from_trunk(player->waist, motion->pose[i].joint[TRUNK],
                                                     motion->tip[i][hand].x));
        player->tip[hand] = himc_vec3_scale(sum, 1.0 / motion->frames);
        player->reach[hand] = himc_vec3_length(skeleton->tip);
        for (int k = 1; k < HIMC_ARM_JOINTS; k++)
            player->reach[hand] +=
                himc_vec3_length(skeleton->segment[himc_arm_joint((himc_hand)hand, k) + 1].origin);
        if (!himc_vec3_finite(sum))
            return himc_error_set(error, "habit: %s tip: a place that is not finite",
                                  himc_hand_name((himc_hand)hand));
    }
    player->usual = usual_bearing(skeleton, player);
    return true;
}

static void make_terms(const himc_habit_player *player, himc_hand hand, himc_quat trunk,
                       const himc_target *tip, double term[TERMS])
{
    double unit = 1 / player->reach[hand];
    himc_vec3 x = seen_from_trunk(player->waist, trunk, tip->x);
    himc_vec3 v = himc_quat_rotate(himc_quat_conj(trunk), tip->v);
    x = himc_vec3_scale(himc_vec3_sub(x, player->tip[hand]), unit);
    v = himc_vec3_scale(v, unit);
    const double all[TERMS] = {1, x.x, x.y, x.z, v.x, v.y, v.z};
    memcpy(term, all, sizeof all);
}

// a motion's rows of the least squares problem of one hand
static void fill_rows(const himc_habit_player *player, const himc_habit_motion *motion,
                      himc_hand hand, double *term, double *angle)
{
    for (int i = 0; i < motion->frames; i++) {
        const himc_pose *pose = &motion->pose[i];
        make_terms(player, hand, pose->joint[TRUNK], &motion->tip[i][hand], term + TERMS * i);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint(hand, k);
            himc_vec3 u =
                himc_quat_log(himc_quat_mul(himc_quat_conj(player->mean.joint[j]), pose->joint[j]));
            double *row = angle + ANGLES * i + 3 * k;
            row[0] = u.x, row[1] = u.y, row[2] = u.z;
        }
    }
}

static bool solve(himc_habit *habit, himc_hand hand, int rows, double *term, double *angle,
                  himc_error *error)
{
    double singular[TERMS];
    lapack_int rank = 0;
    lapack_int info = LAPACKE_dgelsd(LAPACK_ROW_MAJOR, rows, TERMS, ANGLES, term, TERMS, angle,
                                     ANGLES, singular, NEGLIGIBLE, &rank);
    if (info == LAPACK_WORK_MEMORY_ERROR)
        return himc_error_set(error, "habit: out of memory");
    if (info != 0)
        return himc_error_set(error, "habit: %s hand: postures or tips that are not finite",
                              himc_hand_name(hand));
    if (rank < 3)
        return himc_error_set(error, "habit: the %s tip does not move, so nothing is to be learned",
                              himc_hand_name(hand));
    for (int c = 0; c < ANGLES; c++)
        for (int t = 0; t < TERMS; t++)
            habit->weight[hand][c / 3][c % 3][t] = angle[ANGLES * t + c];
    return true;
}

static bool learn_hand(himc_habit *habit, himc_hand hand, const himc_habit_player *player,
                       const himc_habit_motion *motion, int count, himc_error *error)
{
    size_t rows = 0;
    for (int i = 0; i < count; i++)
        rows += (size_t)motion[i].frames;
    double *term = malloc(rows * TERMS * sizeof *term);
    double *angle = malloc(rows * ANGLES * sizeof *angle);
    bool ok = term && angle;
    if (!ok)
        himc_error_set(error, "habit: out of memory for %zu frames", rows);
    for (size_t i = 0, row = 0; ok && i < (size_t)count; row += (size_t)motion[i++].frames)
        fill_rows(&player[i], &motion[i], hand, term + TERMS * row, angle + ANGLES * row);
    ok = ok && solve(habit, hand, (int)rows, term, angle, error);
    free(term);
    free(angle);
    return ok;
}

bool himc_habit_learn(himc_habit *habit, const himc_habit_motion *motion, int count,
                      himc_error *error)
{
    if (count < 1)
        return himc_error_set(error, "habit: no player to learn from");
    himc_habit_player *player = malloc((size_t)count * sizeof *player);
    bool ok = player || himc_error_set(error, "habit: out of memory");
    for (int i = 0; ok && i < count; i++)
        ok = himc_habit_meet(&player[i], &motion[i], error);
    for (int hand = 0; ok && hand < HIMC_HANDS; hand++)
        ok = learn_hand(habit, (himc_hand)hand, player, motion, count, error);
    if (ok)
        habit->player = player[0];
    free(player);
    return ok;
}

void himc_habit_at(const himc_habit *habit, const himc_target tip[HIMC_HANDS], himc_pose *pose)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double term[TERMS];
        make_terms(&habit->player, (himc_hand)hand, pose->joint[TRUNK], &tip[hand], term);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            double u[3] = {0, 0, 0};
            for (int c = 0; c < 3; c++)
                for (int t = 0; t < TERMS; t++)
                    u[c] += habit->weight[hand][k][c][t] * term[t];
            int j = himc_arm_joint((himc_hand)hand, k);
            pose->joint[j] = himc_quat_mul(habit->player.mean.joint[j],
                                           himc_quat_exp(himc_vec3_make(u[0], u[1], u[2])));
        }
    }
}

void himc_habit_moving(const himc_habit *habit, const himc_target tip[HIMC_HANDS],
                       himc_posture_motion *motion)
{
    const himc_habit_player *player = &habit->player;
    himc_pose pose[3];
    himc_vec3 rate = motion->rate[TRUNK], turning = motion->acceleration[TRUNK];
    himc_quat trunk =
        himc_quat_mul(motion->joint[TRUNK],
                      himc_quat_mul(himc_quat_conj(player->usual), player->mean.joint[TRUNK]));
    for (int i = 0; i < 3; i++) {
        double dt = (i - 1) * DIFFERENCE;
        himc_target then[HIMC_HANDS];
        himc_vec3 turned = himc_vec3_madd(himc_vec3_scale(rate, dt), 0.5 * dt * dt, turning);
        pose[i] = player->mean;
        pose[i].joint[TRUNK] = himc_quat_mul(himc_quat_exp(turned), trunk);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            then[hand] = himc_target_after(&tip[hand], dt);
        himc_habit_at(habit, then, &pose[i]);
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        motion->joint[j] = pose[1].joint[j];
        himc_differentiate(pose[0].joint[j], pose[1].joint[j], pose[2].joint[j], &motion->rate[j],
                           &motion->acceleration[j]);
    }
}
