/// habit_learn.c: least squares from takes of the whole body to a habit's weights.
///
/// W is by least squares over all frames of all players, each about his own means (LAPACK's
/// dgelsd; singular values under 1e-3 of the largest are left out: the solution of least norm).
/// Means of rotations are the eigenvector of the largest eigenvalue of sum q q' (Markley, Cheng,
/// Crassidis and Oshman 2007).
#include "habit_terms.h"

#include <lapacke.h>
#include <stdlib.h>
#include <string.h>

#define NEGLIGIBLE 1e-3   // singular values under this share of the largest
#define LOW 0.02          // places that near the lowest are strikes (m)
#define LEAST_SPREAD 2e-3 // no joint is known better than this (rad)
#define LEAST_RANK 3      // of a problem that is determined: a tip that moves in two ways

// rows of `terms` numbers, and of the `angles` that they are to give
typedef struct problem {
    double *term, *angle;
    int rows, terms, angles;
    bool moves; // the tips do, so there is something to learn
} problem;

#define PROBLEMS (HIMC_HANDS + 1) // each arm, and the trunk

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
            sum = himc_vec3_add(sum, himc_habit_seen(player->waist, pose->joint[TRUNK], x));
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
    himc_habit_frames(player, hand, frame);
    for (int i = 0; i < known_frames(take); i++, p->rows++) {
        const himc_pose *pose = &take->pose[i];
        himc_vec3 tip[TAPS][HIMC_HANDS];
        for (int tap = 0; tap < TAPS; tap++)
            tip[tap][hand] = tip_ahead(take, i, tap * HIMC_HABIT_STEP, hand);
        himc_habit_terms(player, hand, pose->joint[TRUNK], (const himc_vec3(*)[HIMC_HANDS])tip,
                         p->term + p->terms * (size_t)p->rows);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            int j = himc_arm_joint(hand, k);
            himc_vec3 u =
                himc_quat_log(himc_quat_mul(himc_quat_conj(player->mean.joint[j]), pose->joint[j]));
            u = himc_quat_rotate(frame[k], u);
            memcpy(p->angle + p->angles * (size_t)p->rows + 3 * k, &u, sizeof u);
        }
    }
}

static void add_trunk_rows(problem *p, const himc_habit_player *player, const himc_habit_take *take)
{
    himc_quat mean = player->mean.joint[TRUNK];
    for (int i = 0; i < known_frames(take); i++, p->rows++) {
        himc_vec3 tip[TAPS][HIMC_HANDS];
        for (int tap = 0; tap < TAPS; tap++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                tip[tap][hand] = tip_ahead(take, i, tap * HIMC_HABIT_STEP, (himc_hand)hand);
        himc_habit_trunk_terms(player, mean, (const himc_vec3(*)[HIMC_HANDS])tip,
                               p->term + p->terms * (size_t)p->rows);
        himc_vec3 u =
            himc_quat_log(himc_quat_mul(himc_quat_conj(mean), take->pose[i].joint[TRUNK]));
        memcpy(p->angle + p->angles * (size_t)p->rows, &u, sizeof u);
    }
}

// the weights into the first rows of `angle`
static bool solve(problem *p, const char *whose, himc_error *error)
{
    double singular[TRUNK_TERMS];
    lapack_int rank = 0;
    lapack_int info = LAPACKE_dgelsd(LAPACK_ROW_MAJOR, p->rows, p->terms, p->angles, p->term,
                                     p->terms, p->angle, p->angles, singular, NEGLIGIBLE, &rank);
    if (info == LAPACK_WORK_MEMORY_ERROR || info == LAPACK_TRANSPOSE_MEMORY_ERROR)
        return himc_error_set(error, "habit: out of memory for %d frames", p->rows);
    if (info != 0)
        return himc_error_set(error, "habit: no singular values for the %s", whose);
    p->moves = rank >= LEAST_RANK;
    return true;
}

// an arm that was not seen moves like the other one in a mirror: y changes its sign, of rotations x
// and z do
static void mirror(himc_habit *habit, himc_hand unseen)
{
    for (int c = 0; c < ANGLES; c++)
        for (int t = 0; t < TERMS; t++) {
            double sign = (c % 3 == 1) == (t % 3 != 2) ? 1 : -1; // terms 2, 5, 8 are of y
            habit->weight[unseen][c / 3][c % 3][t] =
                sign * habit->weight[1 - unseen][c / 3][c % 3][t];
        }
    for (int c = 0; c < ANGLES; c++)
        for (int d = 0; d < ANGLES; d++) {
            double sign = (c % 3 == 1) == (d % 3 == 1) ? 1 : -1;
            habit->spread[unseen][c][d] = sign * habit->spread[1 - unseen][c][d];
        }
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
static bool gather(himc_habit *habit, problem p[PROBLEMS], const himc_habit_take *take, int count,
                   himc_error *error)
{
    for (int i = 0; i < PROBLEMS; i++)
        p[i].rows = 0;
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
        for (int i = 0; i < n; i++)
            add_trunk_rows(&p[HIMC_HANDS], &player, &take[from + i]);
    }
    return true;
}

static bool allocate(problem *p, int rows, int terms, int angles, himc_error *error)
{
    *p = (problem){.terms = terms, .angles = angles};
    p->term = malloc((size_t)rows * (size_t)terms * sizeof *p->term);
    p->angle = malloc((size_t)rows * (size_t)angles * sizeof *p->angle);
    return (p->term && p->angle) ||
           himc_error_set(error, "habit: out of memory for %d frames", rows);
}

static void take_weights(himc_habit *habit, const problem p[PROBLEMS])
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int c = 0; c < ANGLES; c++)
            for (int t = 0; t < TERMS; t++)
                habit->weight[hand][c / 3][c % 3][t] = p[hand].angle[ANGLES * t + c];
    for (int c = 0; c < 3; c++)
        for (int t = 0; t < TRUNK_TERMS; t++)
            habit->trunk[c][t] = p[HIMC_HANDS].angle[3 * t + c];
}

static bool learn(himc_habit *habit, problem p[PROBLEMS], const himc_habit_take *take, int count,
                  himc_error *error)
{
    static const char *const whose[PROBLEMS] = {"left tip", "right tip", "tips"};
    if (!gather(habit, p, take, count, error))
        return false;
    for (int i = 0; i < PROBLEMS; i++)
        if (!solve(&p[i], whose[i], error))
            return false;
    if (!p[HIMC_LEFT].moves && !p[HIMC_RIGHT].moves)
        return himc_error_set(error, "habit: no tip moves: nothing to learn from it");
    take_weights(habit, p);
    if (!gather(habit, p, take, count, error)) // the solutions stand where the rows were
        return false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        measure_spread(habit, (himc_hand)hand, &p[hand]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (!p[hand].moves)
            mirror(habit, (himc_hand)hand);
    return true;
}

bool himc_habit_learn(himc_habit *habit, const himc_habit_take *take, int count, himc_error *error)
{
    problem p[PROBLEMS] = {{0}};
    int rows = 0;
    if (count < 1)
        return himc_error_set(error, "habit: no take to learn from, allowed 1 or more");
    for (int n = 0; n < count; n++) {
        if (!check_take(&take[n], error))
            return false;
        rows += known_frames(&take[n]);
    }
    bool ok = allocate(&p[HIMC_LEFT], rows, TERMS, ANGLES, error) &&
              allocate(&p[HIMC_RIGHT], rows, TERMS, ANGLES, error) &&
              allocate(&p[HIMC_HANDS], rows, TRUNK_TERMS, 3, error) &&
              learn(habit, p, take, count, error);
    for (int i = 0; i < PROBLEMS; i++) {
        free(p[i].term);
        free(p[i].angle);
    }
    return ok;
}
