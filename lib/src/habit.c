/// habit.c: linear regression from the tips to the arms.
///
/// With y(t) = (R' (tip(t) - waist) - mean) / reach, R the trunk's rotation, and the terms phi =
/// [1, y(t), y(t + h), y(t + 2h)] of a hand, C_k log(mean_k^-1 q_k) = W_k phi for shoulder, elbow,
/// wrist and grip: rotation vectors seen from the trunk, C_k being the mean rotation of segment k
/// in it, so that hands that hold the stick palm down or thumb up learn from each other. W is by
/// least squares over all frames of all players (LAPACK's dgelsd; singular values under 1e-3 of the
/// largest are left out: the solution of least norm). Means of rotations are the eigenvector of
/// the largest eigenvalue of sum q q' (Markley, Cheng, Crassidis and Oshman 2007).
///
/// A regression misses the tips themselves by some millimetres. With S the covariance of its
/// residuals over the arm's joints and J the tip's Jacobian, the likeliest correction that brings
/// the tip to its place is S J' (J S J')^-1 e: least squares again, weighted by how surely each joint
/// is known.
#include "himc/habit.h"

#include "difference.h"

#include <lapacke.h>
#include <stdlib.h>
#include <string.h>

#define TAPS HIMC_HABIT_TAPS
#define TERMS HIMC_HABIT_TERMS
#define ANGLES (3 * HIMC_ARM_JOINTS)
#define TRUNK (HIMC_TRUNK - 1) // the joint
#define NEGLIGIBLE 1e-3        // singular values under this share of the largest
#define LOW 0.02               // places that near the lowest are strikes (m)
#define LEAST_SPREAD 2e-3      // no joint is known better than this (rad)
#define LARGEST_STEP 0.05      // of the tip, in one correction (m)
#define CORRECTIONS 3          // quadratically converging
#define LEAST_RANK 3           // of a problem that is determined: a tip that moves in two ways

typedef struct problem {
    double *term, *angle; // (rows x TERMS), (rows x ANGLES)
    int rows, room;
} problem;

// frames of a take whose future is known
static int known_frames(const himc_habit_take *take)
{
    return take->frames - 1 - (int)ceil((TAPS - 1) * HIMC_HABIT_STEP * take->rate);
}

static bool check_take(const himc_habit_take *take, himc_error *error)
{
    if (!himc_check_range("habit: rate of a take", take->rate, 20, 10000, "Hz", error))
        return false;
    if (known_frames(take) < 2 * TERMS)
        return himc_error_set(error, "habit: a take of %d frames, allowed %d or more", take->frames,
                              take->frames - known_frames(take) + 2 * TERMS);
    for (int i = 0; i < take->frames; i++)
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_quat q = take->pose[i].joint[j];
            if (!(fabs(himc_quat_dot(q, q) - 1) < 1e-3))
                return himc_error_set(error, "habit: %s in frame %d: not a rotation",
                                      himc_joint_name(j), i);
        }
    return true;
}

static bool mean_rotation(const himc_habit_take *take, int count, int joint, himc_quat *mean)
{
    double a[16] = {0}, value[4];
    for (int n = 0; n < count; n++)
        for (int i = 0; i < take[n].frames; i++) {
            himc_quat q = take[n].pose[i].joint[joint];
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

// a posture's tip
static himc_vec3 tip_of(const himc_skeleton *skeleton, const himc_pose *pose, himc_hand hand)
{
    himc_vec3 x = skeleton->tip;
    for (int i = himc_stick_segment(hand); i > 0; i = skeleton->segment[i].parent)
        x = himc_vec3_add(skeleton->segment[i].origin, himc_quat_rotate(pose->joint[i - 1], x));
    return himc_vec3_add(skeleton->root, x);
}

static void meet_hand(himc_habit_player *player, const himc_habit_take *take, int count,
                      himc_hand hand)
{
    const himc_skeleton *skeleton = take->skeleton;
    himc_vec3 sum = {0, 0, 0};
    double frames = 0;
    for (int n = 0; n < count; frames += take[n++].frames)
        for (int i = 0; i < take[n].frames; i++) {
            const himc_pose *pose = &take[n].pose[i];
            himc_vec3 x = tip_of(skeleton, pose, hand);
            sum = himc_vec3_add(sum, seen_from_trunk(player->waist, pose->joint[TRUNK], x));
        }
    player->tip[hand] = himc_vec3_scale(sum, 1 / frames);
    player->reach[hand] = himc_vec3_length(skeleton->tip);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        player->joint[hand][k] = skeleton->segment[himc_arm_joint(hand, k) + 1].origin;
        if (k > 0)
            player->reach[hand] += himc_vec3_length(player->joint[hand][k]);
    }
}

// where a hand strikes: the mean of the lowest places its tip comes to (m)
static himc_vec3 lowest_places(const himc_habit_take *take, int count, himc_hand hand)
{
    double low = INFINITY, weight = 0;
    himc_vec3 sum = {0, 0, 0};
    for (int pass = 0; pass < 2; pass++)
        for (int n = 0; n < count; n++)
            for (int i = 0; i < take[n].frames; i++) {
                himc_vec3 x = tip_of(take->skeleton, &take[n].pose[i], hand);
                low = pass == 0 ? fmin(low, x.z) : low;
                if (pass == 1 && x.z < low + LOW) {
                    sum = himc_vec3_add(sum, x);
                    weight++;
                }
            }
    return himc_vec3_scale(sum, 1 / weight);
}

// the trunk as himc_posture_bearing has it for the places that a player strikes
static himc_quat usual_bearing(const himc_habit_take *take, int count)
{
    himc_posture posture;
    himc_pose pose;
    himc_vec3 place[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        place[hand] = lowest_places(take, count, (himc_hand)hand);
    himc_posture_init(&posture, take->skeleton, 0);
    posture.bearing = himc_posture_bearing(place, HIMC_GRIP_GERMAN);
    himc_posture_at(&posture, place, &pose);
    return pose.joint[TRUNK];
}

bool himc_habit_meet(himc_habit_player *player, const himc_habit_take *take, int count,
                     himc_error *error)
{
    if (count < 1)
        return himc_error_set(error, "habit: no take of a player, allowed 1 or more");
    for (int n = 0; n < count; n++)
        if (!check_take(&take[n], error))
            return false;
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (!mean_rotation(take, count, j, &player->mean.joint[j]))
            return himc_error_set(error, "habit: %s: no mean rotation", himc_joint_name(j));
    player->waist = himc_vec3_add(take->skeleton->root, take->skeleton->segment[HIMC_TRUNK].origin);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        meet_hand(player, take, count, (himc_hand)hand);
    player->stick = take->skeleton->tip;
    player->usual = usual_bearing(take, count);
    return true;
}

static void make_terms(const himc_habit_player *player, himc_hand hand, himc_quat trunk,
                       const himc_vec3 tip[TAPS][HIMC_HANDS], double term[TERMS])
{
    *term++ = 1;
    for (int tap = 0; tap < TAPS; tap++) {
        himc_vec3 x = seen_from_trunk(player->waist, trunk, tip[tap][hand]);
        x = himc_vec3_scale(himc_vec3_sub(x, player->tip[hand]), 1 / player->reach[hand]);
        *term++ = x.x, *term++ = x.y, *term++ = x.z;
    }
}

// the mean rotation of an arm's segments in the trunk
static void arm_frames(const himc_habit_player *player, himc_hand hand,
                       himc_quat frame[HIMC_ARM_JOINTS])
{
    himc_quat q = himc_quat_identity();
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        frame[k] = q = himc_quat_mul(q, player->mean.joint[himc_arm_joint(hand, k)]);
}

// where a tip is `ahead` seconds after frame i, linearly between frames
static himc_vec3 tip_ahead(const himc_habit_take *take, int i, double ahead, himc_hand hand)
{
    double at = ahead * take->rate, part = at - floor(at);
    const himc_pose *pose = &take->pose[i + (int)at];
    himc_vec3 x = tip_of(take->skeleton, pose, hand);
    if (part < 1e-9)
        return x;
    himc_vec3 next = tip_of(take->skeleton, pose + 1, hand);
    return himc_vec3_madd(himc_vec3_scale(x, 1 - part), part, next);
}

// a take's rows of the least squares problem of one hand
static void add_rows(problem *p, const himc_habit_player *player, const himc_habit_take *take,
                     himc_hand hand)
{
    himc_quat frame[HIMC_ARM_JOINTS];
    arm_frames(player, hand, frame);
    for (int i = 0; i < known_frames(take); i++, p->rows++) {
        const himc_pose *pose = &take->pose[i];
        himc_vec3 tip[TAPS][HIMC_HANDS];
        for (int tap = 0; tap < TAPS; tap++)
            tip[tap][hand] = tip_ahead(take, i, tap * HIMC_HABIT_STEP, hand);
        make_terms(player, hand, pose->joint[TRUNK], (const himc_vec3(*)[HIMC_HANDS])tip,
                   p->term + TERMS * (size_t)p->rows);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint(hand, k);
            himc_vec3 u =
                himc_quat_log(himc_quat_mul(himc_quat_conj(player->mean.joint[j]), pose->joint[j]));
            u = himc_quat_rotate(frame[k], u);
            memcpy(p->angle + ANGLES * (size_t)p->rows + 3 * k, &u, sizeof u);
        }
    }
}

static bool solve(himc_habit *habit, himc_hand hand, const problem *p, himc_error *error)
{
    double singular[TERMS];
    lapack_int rank = 0;
    lapack_int info = LAPACKE_dgelsd(LAPACK_ROW_MAJOR, p->rows, TERMS, ANGLES, p->term, TERMS,
                                     p->angle, ANGLES, singular, NEGLIGIBLE, &rank);
    if (info == LAPACK_WORK_MEMORY_ERROR || info == LAPACK_TRANSPOSE_MEMORY_ERROR)
        return himc_error_set(error, "habit: out of memory for %d frames", p->rows);
    if (info != 0)
        return himc_error_set(error, "habit: no singular values for the %s hand",
                              himc_hand_name(hand));
    if (rank < LEAST_RANK)
        return himc_error_set(error, "habit: the %s tip hardly moves: nothing to learn from it",
                              himc_hand_name(hand));
    for (int c = 0; c < ANGLES; c++)
        for (int t = 0; t < TERMS; t++)
            habit->weight[hand][c / 3][c % 3][t] = p->angle[ANGLES * t + c];
    return true;
}

// the covariance of what is left of the rows
static void measure_spread(himc_habit *habit, himc_hand hand, const problem *p)
{
    memset(habit->spread[hand], 0, sizeof habit->spread[hand]);
    for (int i = 0; i < p->rows; i++) {
        const double *term = p->term + TERMS * (size_t)i;
        double *left = p->angle + ANGLES * (size_t)i;
        for (int c = 0; c < ANGLES; c++)
            for (int t = 0; t < TERMS; t++)
                left[c] -= habit->weight[hand][c / 3][c % 3][t] * term[t];
        for (int c = 0; c < ANGLES; c++)
            for (int d = 0; d < ANGLES; d++)
                habit->spread[hand][c][d] += left[c] * left[d] / p->rows;
    }
    for (int c = 0; c < ANGLES; c++)
        habit->spread[hand][c][c] += LEAST_SPREAD * LEAST_SPREAD;
}

// takes from `from` on that are one player's
static int same_player(const himc_habit_take *take, int from, int count)
{
    int n = 1;
    while (from + n < count && take[from + n].skeleton == take[from].skeleton)
        n++;
    return n;
}

// all rows, player by player; `habit` becomes the first player's
static bool gather(himc_habit *habit, problem p[HIMC_HANDS], const himc_habit_take *take, int count,
                   himc_error *error)
{
    p[HIMC_LEFT].rows = p[HIMC_RIGHT].rows = 0;
    for (int from = 0, n; from < count; from += n) {
        himc_habit_player player;
        n = same_player(take, from, count);
        if (!himc_habit_meet(&player, take + from, n, error))
            return false;
        if (from == 0)
            habit->player = player;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            for (int i = 0; i < n; i++)
                add_rows(&p[hand], &player, &take[from + i], (himc_hand)hand);
    }
    return true;
}

static bool allocate(problem *p, int rows, himc_error *error)
{
    p->rows = 0;
    p->term = malloc((size_t)rows * TERMS * sizeof *p->term);
    p->angle = malloc((size_t)rows * ANGLES * sizeof *p->angle);
    return (p->term && p->angle) ||
           himc_error_set(error, "habit: out of memory for %d frames", rows);
}

bool himc_habit_learn(himc_habit *habit, const himc_habit_take *take, int count, himc_error *error)
{
    problem p[HIMC_HANDS] = {{0}};
    int rows = 0;
    if (count < 1)
        return himc_error_set(error, "habit: no take to learn from, allowed 1 or more");
    for (int n = 0; n < count; n++) {
        if (!check_take(&take[n], error))
            return false;
        rows += known_frames(&take[n]);
    }
    bool ok = allocate(&p[HIMC_LEFT], rows, error) && allocate(&p[HIMC_RIGHT], rows, error) &&
              gather(habit, p, take, count, error);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        ok = ok && solve(habit, (himc_hand)hand, &p[hand], error);
    ok = ok && gather(habit, p, take, count, error); // the solution stands where the rows were
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        if (ok)
            measure_spread(habit, (himc_hand)hand, &p[hand]);
        free(p[hand].term);
        free(p[hand].angle);
    }
    return ok;
}

typedef struct arm {
    himc_quat frame[HIMC_ARM_JOINTS]; // of the segments, in the trunk
    himc_vec3 lever[HIMC_ARM_JOINTS]; // to the tip (m)
    himc_vec3 tip;                    // from the trunk's joint (m)
} arm;

static void place_arm(const himc_habit_player *player, himc_hand hand, const himc_pose *pose,
                      arm *a)
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
static void correct(const himc_habit *habit, himc_hand hand, himc_vec3 place, himc_pose *pose)
{
    arm a;
    himc_mat3 gram;
    himc_vec3 turn[HIMC_ARM_JOINTS];
    place_arm(&habit->player, hand, pose, &a);
    for (int c = 0; c < 3; c++) {
        himc_vec3 f = {c == 0, c == 1, c == 2};
        spread_through(habit->spread[hand], &a, f, turn);
        himc_vec3 m = moved_by(&a, turn);
        gram.m[0][c] = m.x, gram.m[1][c] = m.y, gram.m[2][c] = m.z;
    }
    for (int i = 0; i < 3; i++)
        gram.m[i][i] += 1e-10;
    himc_vec3 e = himc_vec3_sub(place, a.tip);
    double far = himc_vec3_length(e);
    e = himc_vec3_scale(e, far > LARGEST_STEP ? LARGEST_STEP / far : 1);
    himc_mat3 inverse = himc_mat3_inverse_symmetric(&gram);
    spread_through(habit->spread[hand], &a, himc_mat3_apply(&inverse, e), turn);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(hand, k);
        himc_vec3 own = himc_quat_rotate(himc_quat_conj(a.frame[k]), turn[k]);
        pose->joint[j] = himc_quat_mul(pose->joint[j], himc_quat_exp(own));
    }
}

void himc_habit_at(const himc_habit *habit, const himc_vec3 tip[TAPS][HIMC_HANDS], himc_pose *pose)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double term[TERMS];
        himc_quat frame[HIMC_ARM_JOINTS];
        make_terms(&habit->player, (himc_hand)hand, pose->joint[TRUNK], tip, term);
        arm_frames(&habit->player, (himc_hand)hand, frame);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            double u[3] = {0, 0, 0};
            for (int c = 0; c < 3; c++)
                for (int t = 0; t < TERMS; t++)
                    u[c] += habit->weight[hand][k][c][t] * term[t];
            int j = himc_arm_joint((himc_hand)hand, k);
            himc_vec3 own =
                himc_quat_rotate(himc_quat_conj(frame[k]), himc_vec3_make(u[0], u[1], u[2]));
            pose->joint[j] = himc_quat_mul(habit->player.mean.joint[j], himc_quat_exp(own));
        }
        himc_vec3 place = seen_from_trunk(habit->player.waist, pose->joint[TRUNK], tip[0][hand]);
        for (int i = 0; i < CORRECTIONS; i++)
            correct(habit, (himc_hand)hand, place, pose);
    }
}

void himc_habit_moving(const himc_habit *habit, const himc_target tip[TAPS][HIMC_HANDS],
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
        himc_vec3 then[TAPS][HIMC_HANDS];
        himc_vec3 turned = himc_vec3_madd(himc_vec3_scale(rate, dt), 0.5 * dt * dt, turning);
        pose[i] = player->mean;
        pose[i].joint[TRUNK] = himc_quat_mul(himc_quat_exp(turned), trunk);
        for (int tap = 0; tap < TAPS; tap++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                then[tap][hand] = himc_target_after(&tip[tap][hand], dt).x;
        himc_habit_at(habit, (const himc_vec3(*)[HIMC_HANDS])then, &pose[i]);
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        motion->joint[j] = pose[1].joint[j];
        himc_differentiate(pose[0].joint[j], pose[1].joint[j], pose[2].joint[j], &motion->rate[j],
                           &motion->acceleration[j]);
    }
}
