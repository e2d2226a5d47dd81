/// habit_learn.c: least squares from takes of the whole body to a habit's weights.
///
/// W is by least squares over all frames of all players, each about his own means (LAPACK's
/// dgelsd; singular values under 1e-3 of the largest are left out: the solution of least norm).
/// A regression says less than it was told: its mean square is that of what it explains. So the
/// weights of a joint are then scaled until its rotations are as far as those seen, on average (the
/// reduced major axis): an elbow that moves as far as the captured costs next to nothing in angle.
/// One take corrects a habit by ridge regression (Hoerl and Kennard 1970), the W + D of
///     min sum |u - (W + D) phi|^2 + TRUST^2 |D|^2.
#include "control/posture_regression_terms.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEGLIGIBLE 1e-3     // singular values under this share of the largest
#define LEAST_SPREAD 2e-3   // no joint is known better than this (rad)
#define TRUST 1.0           // in a habit that a take corrects, as many frames of a tip a reach away
#define LEAST_EXPLAINED 0.5 // of a joint's mean square, below which it is not scaled to all of it
#define LEAST_RANK 3        // of a problem that is determined: a tip that moves in two ways

// rows of `terms` numbers, and of the `angles` that they are to give
typedef struct problem {
    double *term, *angle;
    int rows, terms, angles;
    bool moves; // the tips do, so there is something to learn
} problem;

#define PROBLEMS (HIMC_HANDS + 1) // each arm, and the trunk

// where a tip is `ahead` seconds after frame i, linearly between frames
static himc_vec3 tip_ahead(const himc_posture_regression_take *take, int i, double ahead,
                           himc_hand hand)
{
    double at = ahead * take->rate, part = at - floor(at);
    const himc_pose *pose = &take->pose[i + (int)at];
    himc_vec3 x = himc_posture_regression_tip(take->skeleton, pose, hand);
    if (part < 1e-9)
        return x;
    himc_vec3 next = himc_posture_regression_tip(take->skeleton, pose + 1, hand);
    return himc_vec3_madd(himc_vec3_scale(x, 1 - part), part, next);
}

// a take's rows of the least squares problem of one hand
static void add_rows(problem *p, const himc_posture_regression_player *player,
                     const himc_posture_regression_take *take, himc_hand hand)
{
    himc_quat frame[HIMC_ARM_JOINTS];
    himc_posture_regression_frames(player, hand, frame);
    for (int i = 0; i < himc_posture_regression_known_frames(take); i++, p->rows++) {
        const himc_pose *pose = &take->pose[i];
        himc_vec3 tip[TAPS][HIMC_HANDS];
        for (int tap = 0; tap < TAPS; tap++)
            tip[tap][hand] = tip_ahead(take, i, tap * HIMC_REGRESSION_STEP, hand);
        himc_posture_regression_terms(player, hand, pose->joint[TRUNK],
                                      (const himc_vec3(*)[HIMC_HANDS])tip,
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

static void add_trunk_rows(problem *p, const himc_posture_regression_player *player,
                           const himc_posture_regression_take *take)
{
    himc_quat mean = player->mean.joint[TRUNK];
    for (int i = 0; i < himc_posture_regression_known_frames(take); i++, p->rows++) {
        himc_vec3 tip[TAPS][HIMC_HANDS];
        for (int tap = 0; tap < TAPS; tap++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                tip[tap][hand] = tip_ahead(take, i, tap * HIMC_REGRESSION_STEP, (himc_hand)hand);
        himc_posture_regression_trunk_terms(player, mean, (const himc_vec3(*)[HIMC_HANDS])tip,
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
    p->moves = false;
    if (p->rows == 0) // nobody showed it
        return true;
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
static void mirror(himc_posture_regression *regression, himc_hand unseen)
{
    for (int c = 0; c < ANGLES; c++)
        for (int t = 0; t < TERMS; t++) {
            double sign = (c % 3 == 1) == (t % 3 != 2) ? 1 : -1; // terms 2, 5, 8 are of y
            regression->weight[unseen][c / 3][c % 3][t] =
                sign * regression->weight[1 - unseen][c / 3][c % 3][t];
        }
    for (int c = 0; c < ANGLES; c++)
        for (int d = 0; d < ANGLES; d++) {
            double sign = (c % 3 == 1) == (d % 3 == 1) ? 1 : -1;
            regression->spread[unseen][c][d] = sign * regression->spread[1 - unseen][c][d];
        }
}

static double explained(const double *weight, const double *term, int terms)
{
    double sum = 0;
    for (int t = 0; t < terms; t++)
        sum += weight[t] * term[t];
    return sum;
}

// each joint's weights, of three angles, so that it turns as far as it was seen to
static void restore_extent(const problem *p, double *weight)
{
    for (int joint = 0; joint < p->angles; joint += 3) {
        double seen = 0, said = 0;
        for (int i = 0; i < p->rows; i++)
            for (int c = joint; c < joint + 3; c++) {
                double u = p->angle[p->angles * (size_t)i + c];
                double v =
                    explained(weight + p->terms * c, p->term + p->terms * (size_t)i, p->terms);
                seen += u * u;
                said += v * v;
            }
        if (said < LEAST_EXPLAINED * seen || said == 0)
            continue;
        for (int i = p->terms * joint; i < p->terms * (joint + 3); i++)
            weight[i] *= sqrt(seen / said);
    }
}

// the covariance of what is left of the rows
static void measure_spread(himc_posture_regression *regression, himc_hand hand, const problem *p)
{
    memset(regression->spread[hand], 0, sizeof regression->spread[hand]);
    for (int i = 0; i < p->rows; i++) {
        const double *term = p->term + TERMS * (size_t)i;
        double *left = p->angle + ANGLES * (size_t)i;
        for (int c = 0; c < ANGLES; c++)
            left[c] -= explained(regression->weight[hand][c / 3][c % 3], term, TERMS);
        for (int c = 0; c < ANGLES; c++)
            for (int d = 0; d < ANGLES; d++)
                regression->spread[hand][c][d] += left[c] * left[d] / p->rows;
    }
    for (int c = 0; c < ANGLES; c++)
        regression->spread[hand][c][c] += LEAST_SPREAD * LEAST_SPREAD;
}

// takes from `from` on that are one player's
static int same_player(const himc_posture_regression_take *take, int from, int count)
{
    int n = 1;
    while (from + n < count && take[from + n].skeleton == take[from].skeleton)
        n++;
    return n;
}

// all rows, player by player; `habit` becomes the first player's
static bool gather(himc_posture_regression *regression, problem p[PROBLEMS],
                   const himc_posture_regression_take *take, int count, himc_error *error)
{
    for (int i = 0; i < PROBLEMS; i++)
        p[i].rows = 0;
    for (int from = 0, n; from < count; from += n) {
        himc_posture_regression_player player;
        n = same_player(take, from, count);
        if (!himc_posture_regression_fit(&player, take + from, n, error))
            return false;
        if (from == 0)
            regression->player = player;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            for (int i = 0; player.arm[hand] && i < n; i++)
                add_rows(&p[hand], &player, &take[from + i], (himc_hand)hand);
        for (int i = 0; player.trunk && i < n; i++)
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

// the weights of problem i, `terms` for each of its angles
static double *weights_of(himc_posture_regression *regression, int i)
{
    return i < HIMC_HANDS ? &regression->weight[i][0][0][0] : &regression->trunk[0][0];
}

// the solutions, which stand where the rows were, added to the weights
static void add_solutions(himc_posture_regression *regression, const problem p[PROBLEMS])
{
    for (int i = 0; i < PROBLEMS; i++)
        for (int c = 0; c < p[i].angles && p[i].rows > 0; c++)
            for (int t = 0; t < p[i].terms; t++)
                weights_of(regression, i)[p[i].terms * c + t] += p[i].angle[p[i].angles * t + c];
}

static bool learn(himc_posture_regression *regression, problem p[PROBLEMS],
                  const himc_posture_regression_take *take, int count, himc_error *error)
{
    static const char *const whose[PROBLEMS] = {"left tip", "right tip", "tips"};
    if (!gather(regression, p, take, count, error))
        return false;
    for (int i = 0; i < PROBLEMS; i++)
        if (!solve(&p[i], whose[i], error))
            return false;
    if (!p[HIMC_LEFT].moves && !p[HIMC_RIGHT].moves)
        return himc_error_set(error, "habit: no tip moves: nothing to learn from it");
    memset(regression->weight, 0, sizeof regression->weight);
    memset(regression->trunk, 0, sizeof regression->trunk);
    add_solutions(regression, p);
    if (!gather(regression, p, take, count, error))
        return false;
    for (int i = 0; i < PROBLEMS; i++)
        restore_extent(&p[i], weights_of(regression, i));
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        measure_spread(regression, (himc_hand)hand, &p[hand]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (!p[hand].moves)
            mirror(regression, (himc_hand)hand);
    return true;
}

static bool allocate_all(problem p[PROBLEMS], int rows, himc_error *error)
{
    return allocate(&p[HIMC_LEFT], rows, TERMS, ANGLES, error) &&
           allocate(&p[HIMC_RIGHT], rows, TERMS, ANGLES, error) &&
           allocate(&p[HIMC_HANDS], rows, TRUNK_TERMS, 3, error);
}

static void free_all(problem p[PROBLEMS])
{
    for (int i = 0; i < PROBLEMS; i++) {
        free(p[i].term);
        free(p[i].angle);
    }
}

bool himc_posture_regression_learn(himc_posture_regression *regression,
                                   const himc_posture_regression_take *take, int count,
                                   himc_error *error)
{
    problem p[PROBLEMS] = {{0}};
    int rows = 0;
    if (count < 1)
        return himc_error_set(error, "habit: no take to learn from, allowed 1 or more");
    for (int n = 0; n < count; n++) {
        if (!himc_posture_regression_check(&take[n], error))
            return false;
        rows += himc_posture_regression_known_frames(&take[n]);
    }
    bool ok = allocate_all(p, rows, error) && learn(regression, p, take, count, error);
    free_all(p);
    return ok;
}

// a problem about its correction: what the weights leave, and a row for each that holds it where
// it is
static void ask_correction(problem *p, const double *weight)
{
    if (p->rows == 0)
        return;
    for (int i = 0; i < p->rows; i++)
        for (int c = 0; c < p->angles; c++)
            p->angle[p->angles * i + c] -=
                explained(weight + p->terms * c, p->term + p->terms * i, p->terms);
    for (int t = 0; t < p->terms; t++, p->rows++) {
        memset(p->term + p->terms * p->rows, 0, (size_t)p->terms * sizeof *p->term);
        memset(p->angle + p->angles * p->rows, 0, (size_t)p->angles * sizeof *p->angle);
        p->term[p->terms * p->rows + t] = TRUST;
    }
}

static bool correct(himc_posture_regression *regression, problem p[PROBLEMS],
                    const himc_posture_regression_take *take, himc_error *error)
{
    static const char *const whose[PROBLEMS] = {"left tip", "right tip", "tips"};
    if (!gather(regression, p, take, 1, error))
        return false;
    for (int i = 0; i < PROBLEMS; i++) {
        ask_correction(&p[i], weights_of(regression, i));
        if (!solve(&p[i], whose[i], error))
            return false;
    }
    add_solutions(regression, p);
    if (!gather(regression, p, take, 1, error))
        return false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (regression->player.arm[hand])
            measure_spread(regression, (himc_hand)hand, &p[hand]);
    return true;
}

bool himc_posture_regression_correct(himc_posture_regression *regression,
                                     const himc_posture_regression_take *take, himc_error *error)
{
    problem p[PROBLEMS] = {{0}};
    himc_posture_regression corrected = *regression;
    bool ok = himc_posture_regression_check(take, error) &&
              allocate_all(p, himc_posture_regression_known_frames(take) + TRUNK_TERMS, error) &&
              correct(&corrected, p, take, error);
    free_all(p);
    if (ok)
        *regression = corrected;
    return ok;
}
