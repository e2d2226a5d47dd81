/// posture_regression_learn.c: fits players, learns weights from their takes, corrects them.
///
/// A player is described by the means of his takes (rotations.h) and his measures. The weights W
/// are the least squares solution over all frames of all players, each relative to his own means
/// (singular values below 1e-3 of the largest are left out: the solution of least norm). A
/// regression has smaller amplitude than its data: its mean square is that of the explained part.
/// So the weights of each joint are then scaled until its rotations have the mean square of the
/// captured ones (reduced major axis). So the elbow moves as far as the captured one, at almost no
/// cost in angle.
///
/// One take corrects a regression by ridge regression (Hoerl and Kennard 1970), to the W + D of
///     min sum |u - (W + D) phi|^2 + PRIOR_FRAMES^2 |D|^2.
#include "control/posture_regression.h"

#include "base/linear.h"
#include "base/rotations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OFFSETS HIMC_REGRESSION_OFFSETS
#define TERMS HIMC_REGRESSION_TERMS
#define TRUNK_TERMS HIMC_REGRESSION_TRUNK_TERMS
#define ANGLES HIMC_REGRESSION_ANGLES
#define TRUNK (HIMC_TRUNK - 1) // the joint

#define UNIT_TOLERANCE 1e-3      // chosen: of a quaternion's squared length, three digits of a file
#define STRIKE_HEIGHT 0.02       // chosen: tip positions this near to the lowest are strikes (m)
#define NEGLIGIBLE_SINGULAR 1e-3 // chosen: share of the largest, below the noise of captures
#define LEAST_DEVIATION 2e-3     // chosen: no joint is captured more exactly (rad)
#define PRIOR_FRAMES 1.0         // chosen: weighs like one frame with the tip one reach away
#define LEAST_EXPLAINED 0.5      // chosen: joints with less of their mean square are not scaled
#define LEAST_RANK 3             // of a determined problem: the constant and two tip directions
#define SAME_FRAME 1e-9 // chosen: a time offset this near to a frame needs no interpolation

// Players

int himc_posture_regression_known_frames(const himc_posture_regression_take *take)
{
    return take->frames - 1 - (int)ceil((OFFSETS - 1) * HIMC_REGRESSION_OFFSET_STEP * take->rate);
}

// false, with the reason, for a take that is too short or contains invalid rotations
static bool check_take(const himc_posture_regression_take *take, himc_error *error)
{
    if (!himc_check_range("posture regression: rate of a take", take->rate, 20, 10000, "Hz", error))
        return false;
    if (himc_posture_regression_known_frames(take) < 2 * TERMS)
        return himc_error_set(
            error, "posture regression: a take of %d frames, expected %d or more", take->frames,
            take->frames - himc_posture_regression_known_frames(take) + 2 * TERMS);
    for (int i = 0; i < take->frames; i++)
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_quat q = take->pose[i].joint[j];
            if (!(fabs(himc_quat_dot(q, q) - 1) < UNIT_TOLERANCE))
                return himc_error_set(error,
                                      "posture regression: frame %d: %s: not a unit quaternion", i,
                                      himc_joint_name(j));
        }
    return true;
}

himc_vec3 himc_posture_regression_tip(const himc_skeleton *skeleton, const himc_pose *pose,
                                      himc_hand hand)
{
    himc_vec3 x = skeleton->tip;
    for (int i = himc_stick_segment(hand); i > 0; i = skeleton->segment[i].parent)
        x = himc_vec3_add(skeleton->segment[i].origin, himc_quat_rotate(pose->joint[i - 1], x));
    return himc_vec3_add(skeleton->segment[HIMC_PELVIS].origin, x);
}

// a hand's mean strike point: the mean of the lowest positions of its tip (m)
static himc_vec3 mean_strike(const himc_posture_regression_take *take, int count, himc_hand hand)
{
    double low = INFINITY, weight = 0;
    himc_vec3 sum = {0, 0, 0};
    for (int pass = 0; pass < 2; pass++)
        for (int n = 0; n < count; n++)
            for (int i = 0; i < take[n].frames; i++) {
                himc_vec3 x = himc_posture_regression_tip(take->skeleton, &take[n].pose[i], hand);
                low = pass == 0 ? fmin(low, x.z) : low;
                if (pass == 1 && x.z < low + STRIKE_HEIGHT) {
                    sum = himc_vec3_add(sum, x);
                    weight++;
                }
            }
    return himc_vec3_scale(sum, 1 / weight);
}

// the trunk's orientation in the natural posture for the player's strike points
static himc_quat natural_trunk(const himc_posture_regression_take *take, int count)
{
    himc_posture posture;
    himc_pose pose;
    himc_vec3 strike[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        strike[hand] = mean_strike(take, count, (himc_hand)hand);
    himc_posture_init(&posture, take->skeleton, 0);
    posture.trunk_posture = himc_posture_trunk(&posture, strike, HIMC_GRIP_GERMAN);
    himc_posture_at(&posture, strike, &pose);
    return pose.joint[TRUNK];
}

bool himc_posture_regression_fit(himc_posture_regression_player *player,
                                 const himc_posture_regression_take *take, int count,
                                 himc_error *error)
{
    if (count < 1)
        return himc_error_set(error, "posture regression: no take of a player, expected 1 or more");
    for (int n = 0; n < count; n++)
        if (!check_take(&take[n], error))
            return false;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_rotations all = {{0}};
        for (int n = 0; n < count; n++)
            for (int i = 0; i < take[n].frames; i++)
                himc_rotations_add(&all, take[n].pose[i].joint[j]);
        player->mean.joint[j] = himc_rotations_mean(&all);
    }
    const himc_skeleton *skeleton = take->skeleton;
    player->waist = himc_skeleton_waist(skeleton);
    player->trunk = true;
    for (int n = 0; n < count; n++)
        player->trunk = player->trunk && !take[n].unseen_trunk;
    player->stick = skeleton->tip;
    for (int h = 0; h < HIMC_HANDS; h++) {
        himc_hand hand = (himc_hand)h;
        himc_vec3 sum = {0, 0, 0};
        double frames = 0;
        player->arm[hand] = true;
        for (int n = 0; n < count; frames += take[n++].frames) {
            player->arm[hand] = player->arm[hand] && !take[n].unseen_arm[hand];
            for (int i = 0; i < take[n].frames; i++) {
                const himc_pose *pose = &take[n].pose[i];
                himc_vec3 x = himc_posture_regression_tip(skeleton, pose, hand);
                x = himc_posture_regression_in_trunk(player->waist, pose->joint[TRUNK], x);
                sum = himc_vec3_add(sum, x);
            }
        }
        player->trunk = player->trunk && player->arm[hand];
        player->tip[hand] = himc_vec3_scale(sum, 1 / frames);
        player->reach[hand] = himc_vec3_length(skeleton->tip);
        for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
            player->joint[hand][k] = skeleton->segment[himc_arm_joint(hand, k) + 1].origin;
            if (k > 0)
                player->reach[hand] += himc_vec3_length(player->joint[hand][k]);
        }
    }
    player->natural_trunk = natural_trunk(take, count);
    return true;
}

// Least squares

/// A least squares problem; once solved, the first rows of `angle` are the weights.
typedef struct problem {
    double *term;  // (rows x terms)
    double *angle; // the angles to explain (rows x angles)
    int rows, terms, angles;
    bool moves;     // the tips move, so there is something to learn
    bool no_memory; // for it, or for its solution
} problem;

#define PROBLEMS (HIMC_HANDS + 1) // each arm, and the trunk
static const char *const problem_tips[PROBLEMS] = {"left tip", "right tip", "tips"};

// adds a take's rows to a problem: of an arm, or of the trunk
static void add_rows(problem *p, const himc_posture_regression_player *player,
                     const himc_posture_regression_take *take, int which)
{
    const himc_pose *mean = &player->mean;
    himc_hand hand = (himc_hand)which;
    himc_quat frame[HIMC_ARM_JOINTS];
    if (which < HIMC_HANDS)
        himc_posture_regression_frames(player, hand, frame);
    for (int i = 0; i < himc_posture_regression_known_frames(take); i++, p->rows++) {
        const himc_pose *pose = &take->pose[i];
        double *term = p->term + p->terms * (size_t)p->rows;
        himc_vec3 u[HIMC_ARM_JOINTS], tip[OFFSETS][HIMC_HANDS];
        for (int k = 0; k < OFFSETS; k++) { // by linear interpolation between frames
            double at = k * HIMC_REGRESSION_OFFSET_STEP * take->rate, part = at - floor(at);
            const himc_pose *then = pose + (int)at;
            for (int h = 0; h < HIMC_HANDS; h++) {
                tip[k][h] = himc_posture_regression_tip(take->skeleton, then, (himc_hand)h);
                if (part < SAME_FRAME)
                    continue;
                himc_vec3 next =
                    himc_posture_regression_tip(take->skeleton, then + 1, (himc_hand)h);
                tip[k][h] = himc_vec3_madd(himc_vec3_scale(tip[k][h], 1 - part), part, next);
            }
        }
        if (which == HIMC_HANDS)
            himc_posture_regression_trunk_terms(player, mean->joint[TRUNK],
                                                (const himc_vec3(*)[HIMC_HANDS])tip, term);
        else
            himc_posture_regression_terms(player, hand, pose->joint[TRUNK],
                                          (const himc_vec3(*)[HIMC_HANDS])tip, term);
        for (int k = 0; k < p->angles / 3; k++) {
            int j = which == HIMC_HANDS ? TRUNK : himc_arm_joint(hand, k);
            u[k] = himc_quat_log(himc_quat_mul(himc_quat_conj(mean->joint[j]), pose->joint[j]));
            if (which < HIMC_HANDS)
                u[k] = himc_quat_rotate(frame[k], u[k]);
        }
        memcpy(p->angle + p->angles * (size_t)p->rows, u, (size_t)p->angles * sizeof *p->angle);
    }
}

// solves for the weights, into the first rows of `angle`; `tips` names them in errors
static bool solve(problem *p, const char *tips, himc_error *error)
{
    int rank = 0;
    p->moves = false;
    if (p->rows == 0) // not captured
        return true;
    himc_linear outcome = himc_linear_least_squares(p->rows, p->terms, p->angles, p->term, p->angle,
                                                    NEGLIGIBLE_SINGULAR, p->angle, &rank);
    p->no_memory = outcome == HIMC_LINEAR_NO_MEMORY;
    if (p->no_memory)
        return himc_error_set(error, "posture regression: out of memory for %d frames", p->rows);
    if (outcome != HIMC_LINEAR_SOLVED)
        return himc_error_set(error, "posture regression: no singular values for the %s", tips);
    p->moves = rank >= LEAST_RANK;
    return true;
}

// gives the arm `at_rest` the weights of the other one, mirrored: of positions y changes its sign,
// of rotations x and z
static void mirror(himc_posture_regression *regression, himc_hand at_rest)
{
    for (int c = 0; c < ANGLES; c++)
        for (int t = 0; t < TERMS; t++) {
            double sign = (c % 3 == 1) == (t % 3 != 2) ? 1 : -1; // terms 2, 5, 8 are of y
            regression->weight[at_rest][c / 3][c % 3][t] =
                sign * regression->weight[1 - at_rest][c / 3][c % 3][t];
        }
    for (int c = 0; c < ANGLES; c++)
        for (int d = 0; d < ANGLES; d++) {
            double sign = (c % 3 == 1) == (d % 3 == 1) ? 1 : -1;
            regression->residual_covariance[at_rest][c][d] =
                sign * regression->residual_covariance[1 - at_rest][c][d];
        }
}

// the angle that the weights give for these terms
static double explained(const double *weight, const double *term, int terms)
{
    double sum = 0;
    for (int t = 0; t < terms; t++)
        sum += weight[t] * term[t];
    return sum;
}

// scales each joint's weights (three angles) to the mean square of the captured rotations
static void restore_amplitude(const problem *p, double *weight)
{
    for (int joint = 0; joint < p->angles; joint += 3) {
        double captured = 0, regressed = 0;
        for (int i = 0; i < p->rows; i++)
            for (int c = joint; c < joint + 3; c++) {
                double u = p->angle[p->angles * (size_t)i + c];
                double v =
                    explained(weight + p->terms * c, p->term + p->terms * (size_t)i, p->terms);
                captured += u * u;
                regressed += v * v;
            }
        if (regressed < LEAST_EXPLAINED * captured || regressed == 0)
            continue;
        for (int i = p->terms * joint; i < p->terms * (joint + 3); i++)
            weight[i] *= sqrt(captured / regressed);
    }
}

// the covariance of the residuals; replaces `angle` by the residuals
static void measure_residuals(himc_posture_regression *regression, himc_hand hand, const problem *p)
{
    double(*covariance)[ANGLES] = regression->residual_covariance[hand];
    memset(covariance, 0, sizeof regression->residual_covariance[hand]);
    for (int i = 0; i < p->rows; i++) {
        const double *term = p->term + TERMS * (size_t)i;
        double *residual = p->angle + ANGLES * (size_t)i;
        for (int c = 0; c < ANGLES; c++)
            residual[c] -= explained(regression->weight[hand][c / 3][c % 3], term, TERMS);
        for (int c = 0; c < ANGLES; c++)
            for (int d = 0; d < ANGLES; d++)
                covariance[c][d] += residual[c] * residual[d] / p->rows;
    }
    for (int c = 0; c < ANGLES; c++)
        covariance[c][c] += LEAST_DEVIATION * LEAST_DEVIATION;
}

// fills the rows of all problems, player by player; `regression` gets the first player
static bool fill_rows(himc_posture_regression *regression, problem p[PROBLEMS],
                      const himc_posture_regression_take *take, int count, himc_error *error)
{
    for (int i = 0; i < PROBLEMS; i++)
        p[i].rows = 0;
    for (int from = 0, n; from < count; from += n) {
        himc_posture_regression_player player;
        for (n = 1; from + n < count && take[from + n].skeleton == take[from].skeleton;)
            n++;
        if (!himc_posture_regression_fit(&player, take + from, n, error))
            return false;
        if (from == 0)
            regression->player = player;
        for (int k = 0; k < PROBLEMS; k++)
            for (int i = 0; (k < HIMC_HANDS ? player.arm[k] : player.trunk) && i < n; i++)
                add_rows(&p[k], &player, &take[from + i], k);
    }
    return true;
}

// the weights of problem i (angles x terms)
static double *weights_of(himc_posture_regression *regression, int i)
{
    return i < HIMC_HANDS ? &regression->weight[i][0][0][0] : &regression->trunk[0][0];
}

// adds the solutions to the weights
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
    if (!fill_rows(regression, p, take, count, error))
        return false;
    for (int i = 0; i < PROBLEMS; i++)
        if (!solve(&p[i], problem_tips[i], error))
            return false;
    if (!p[HIMC_LEFT].moves && !p[HIMC_RIGHT].moves)
        return himc_error_set(error,
                              "posture regression: no drumstick tip moves: nothing to learn");
    memset(regression->weight, 0, sizeof regression->weight);
    memset(regression->trunk, 0, sizeof regression->trunk);
    add_solutions(regression, p);
    if (!fill_rows(regression, p, take, count, error))
        return false;
    for (int i = 0; i < PROBLEMS; i++)
        restore_amplitude(&p[i], weights_of(regression, i));
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        measure_residuals(regression, (himc_hand)hand, &p[hand]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (!p[hand].moves)
            mirror(regression, (himc_hand)hand);
    return true;
}

static bool allocate_all(problem p[PROBLEMS], int rows, himc_error *error)
{
    for (int i = 0; i < PROBLEMS; i++) {
        bool arm = i < HIMC_HANDS;
        int terms = arm ? TERMS : TRUNK_TERMS, angles = arm ? ANGLES : 3;
        size_t most = (size_t)(rows > terms ? rows : terms);
        p[i] = (problem){.terms = terms, .angles = angles};
        p[i].term = malloc((size_t)rows * (size_t)terms * sizeof *p[i].term);
        p[i].angle = malloc(most * (size_t)angles * sizeof *p[i].angle);
        p[i].no_memory = !p[i].term || !p[i].angle;
        if (p[i].no_memory)
            return himc_error_set(error, "posture regression: out of memory for %d frames", rows);
    }
    return true;
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
        return himc_error_set(error,
                              "posture regression: no take to learn from, expected 1 or more");
    for (int n = 0; n < count; n++) {
        if (!check_take(&take[n], error))
            return false;
        rows += himc_posture_regression_known_frames(&take[n]);
    }
    bool ok = allocate_all(p, rows, error) && learn(regression, p, take, count, error);
    free_all(p);
    return ok;
}

// learns the corrections D from the residuals, with a row for each term that holds its weight
static bool correct(himc_posture_regression *regression, problem p[PROBLEMS],
                    const himc_posture_regression_take *take, himc_error *error)
{
    if (!fill_rows(regression, p, take, 1, error))
        return false;
    for (problem *q = p; q < p + PROBLEMS; q++) {
        const double *weight = weights_of(regression, (int)(q - p));
        for (int i = 0; i < q->rows; i++)
            for (int c = 0; c < q->angles; c++)
                q->angle[q->angles * i + c] -=
                    explained(weight + q->terms * c, q->term + q->terms * i, q->terms);
        for (int t = 0; t < q->terms && q->rows > 0; t++, q->rows++) {
            memset(q->term + q->terms * q->rows, 0, (size_t)q->terms * sizeof *q->term);
            memset(q->angle + q->angles * q->rows, 0, (size_t)q->angles * sizeof *q->angle);
            q->term[q->terms * q->rows + t] = PRIOR_FRAMES;
        }
        if (!solve(q, problem_tips[q - p], error))
            return false;
    }
    add_solutions(regression, p);
    if (!fill_rows(regression, p, take, 1, error))
        return false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (regression->player.arm[hand])
            measure_residuals(regression, (himc_hand)hand, &p[hand]);
    return true;
}

bool himc_posture_regression_correct(himc_posture_regression *regression,
                                     const himc_posture_regression_take *take, bool *memory,
                                     himc_error *error)
{
    problem p[PROBLEMS] = {{0}};
    himc_posture_regression corrected = *regression;
    bool ok = check_take(take, error) &&
              allocate_all(p, himc_posture_regression_known_frames(take) + TRUNK_TERMS, error) &&
              correct(&corrected, p, take, error);
    if (memory)
        *memory = !p[HIMC_LEFT].no_memory && !p[HIMC_RIGHT].no_memory && !p[HIMC_HANDS].no_memory;
    free_all(p);
    if (ok)
        *regression = corrected;
    return ok;
}
