/// strokes.c: captured strokes and the same strokes as the controllers play them, for figures 5 and
/// 6(a) of Bouënard, Gibet & Wanderley 2012 and figures 2 and 3 of theirs at CASA 2009 (figure 4 of
/// the preprint): `strokes follow|phases LAW GAIN FROM TO` prints a CSV table of an excerpt (s),
/// one row for every second frame.
///
/// `follow` plays the first trial of the evaluation, legato, with `ik`, `id` and `himc`: time (s),
/// then for the captured motion and each controller flexion of wrist, elbow and shoulder (degrees)
/// and heights of tip, wrist and elbow (cm), all of the right side (follow.gp, elbow.gp, tip.gp).
/// `phases` plays each nuance with `himc`: nuance, depth and height of the right tip, captured and
/// simulated (cm) (phases.gp).
///
/// `ik` follows the captured joints, bent to the tips. The papers' inverse kinematics knows the tip
/// alone: `reach` is that, equation (3) repeated as often as in the papers, from the captured pose
/// at the beginning; all that is not this arm is as captured.
///
/// Flexions are computed alike for all: of the elbow the angle between upper arm and forearm, of
/// the shoulder the angle of the upper arm from hanging in the sagittal plane, of the wrist the
/// elevation of the hand minus that of the forearm.
#include "tools/himc/trial.h"
#include "control/controller.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HAND HIMC_RIGHT
#define EVERY 2 // frames for a row; chosen: 125 rows a second, finer than a pixel
#define MOST_ROWS 1000
#define ARM 6     // values of an arm
#define MOTIONS 5 // captured, ik, id, himc, reach
#define REACH (MOTIONS - 1)
#define REACH_STEPS 40 // 10 kHz / 250 Hz, the published inner steps of a task

typedef struct excerpt {
    double from, to; // (s)
    const char *nuance;
    int motion, frame, rows; // of `value`: being filled, frames so far, rows so far
    bool reached;            // `arm` is of the frame before
    himc_quat arm[HIMC_ARM_JOINTS];
    double time[MOST_ROWS], value[MOST_ROWS][MOTIONS][ARM];
} excerpt;

static himc_vec3 origin(const himc_body_state *body, int k)
{
    return body->origin[himc_arm_joint(HAND, k) + 1];
}

static himc_vec3 along(const himc_body_state *body, int k)
{
    return himc_vec3_unit(himc_vec3_sub(origin(body, k + 1), origin(body, k)));
}

static void measure_arm(const himc_body_state *body, double value[ARM])
{
    himc_vec3 upper = along(body, 0), fore = along(body, 1), hand = along(body, 2);
    double degree = HIMC_PI / 180;
    value[0] = (asin(hand.z) - asin(fore.z)) / degree;
    value[1] = acos(himc_vec3_dot(upper, fore)) / degree;
    value[2] = atan2(upper.x, -upper.z) / degree;
    value[3] = 100 * body->tip[HAND].z;
    value[4] = 100 * origin(body, 2).z;
    value[5] = 100 * origin(body, 1).z;
}

// one step of equation (3): q <- q + J+ (X_t - X)
static void reach_step(const himc_skeleton *skeleton, himc_vec3 target, himc_pose *pose,
                       himc_body_state *state)
{
    himc_arm_jacobian jacobian;
    himc_vec3 rotation[HIMC_ARM_JOINTS];
    double damping = himc_controller_config_default().damping;
    himc_arm_jacobian_at(state, HAND, &jacobian);
    himc_ik_solve(&jacobian, HIMC_SOLVER_DLS, damping, himc_vec3_sub(target, state->tip[HAND]),
                  rotation);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        int j = himc_arm_joint(HAND, k);
        const himc_mat3 *parent = &state->rotation[skeleton->segment[j + 1].parent];
        himc_quat turn = himc_quat_exp(himc_mat3_apply_transposed(parent, rotation[k]));
        pose->joint[j] = himc_quat_unit(himc_quat_mul(turn, pose->joint[j]));
    }
    himc_pose_to_state(skeleton, pose, NULL, state);
}

static himc_body_state reach(excerpt *e, const trial_frame *frame)
{
    himc_pose pose = *frame->captured_pose;
    himc_body_state state;
    for (int k = 0; e->reached && k < HIMC_ARM_JOINTS; k++)
        pose.joint[himc_arm_joint(HAND, k)] = e->arm[k];
    himc_pose_to_state(frame->skeleton, &pose, NULL, &state);
    for (int step = 0; step < REACH_STEPS; step++)
        reach_step(frame->skeleton, frame->captured->tip[HAND], &pose, &state);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        e->arm[k] = pose.joint[himc_arm_joint(HAND, k)];
    e->reached = true;
    return state;
}

static bool in_excerpt(excerpt *e, const trial_frame *frame)
{
    return frame->time >= e->from && frame->time <= e->to && e->frame++ % EVERY == 0;
}

static void keep_follow(void *user, const trial_frame *frame)
{
    excerpt *e = user;
    himc_body_state reached = reach(e, frame);
    if (!in_excerpt(e, frame) || e->rows == MOST_ROWS)
        return;
    e->time[e->rows] = frame->time;
    measure_arm(frame->captured, e->value[e->rows][0]);
    measure_arm(&reached, e->value[e->rows][REACH]);
    measure_arm(frame->simulated_body, e->value[e->rows++][e->motion]);
}

static void print_phase(void *user, const trial_frame *frame)
{
    excerpt *e = user;
    himc_vec3 a = frame->captured->tip[HAND], b = frame->simulated->tip[HAND];
    if (in_excerpt(e, frame))
        printf("%s,%.2f,%.2f,%.2f,%.2f\n", e->nuance, 100 * a.x, 100 * a.z, 100 * b.x, 100 * b.z);
}

static bool play(trial_kind kind, double gain, void (*frame)(void *, const trial_frame *),
                 excerpt *e, himc_error *error)
{
    trial_result result;
    trial_config config = trial_default(&kind, 1);
    config.gain = gain;
    config.frame = frame;
    config.user = e;
    e->frame = e->rows = 0;
    e->reached = false;
    return trial_run(&config, &result, error);
}

static void print_follow(const excerpt *e, const char *const motions[MOTIONS])
{
    static const char *const columns[ARM] = {"wrist_deg", "elbow_deg", "shoulder_deg",
                                             "tip_cm",    "wrist_cm",  "elbow_cm"};
    printf("time_s");
    for (int i = 0; i < MOTIONS * ARM; i++)
        printf(",%s_%s", motions[i / ARM], columns[i % ARM]);
    for (int row = 0; row < e->rows; row++) {
        printf("\n%.3f", e->time[row]);
        for (int i = 0; i < MOTIONS * ARM; i++)
            printf(",%.2f", e->value[row][i / ARM][i % ARM]);
    }
    puts("");
}

static bool follow(himc_law law, double gain, excerpt *e, himc_error *error)
{
    static const himc_pipeline order[] = {HIMC_PIPELINE_IK, HIMC_PIPELINE_ID, HIMC_PIPELINE_HIMC};
    static const char *const motions[MOTIONS] = {"captured", "ik", "id", "himc", "reach"};
    for (e->motion = 1; e->motion < REACH; e->motion++)
        if (!play((trial_kind){HIMC_LEGATO, order[e->motion - 1], law}, gain, keep_follow, e,
                  error))
            return false;
    print_follow(e, motions);
    return true;
}

static bool phases(himc_law law, double gain, excerpt *e, himc_error *error)
{
    puts("nuance,captured_depth_cm,captured_height_cm,himc_depth_cm,himc_height_cm");
    for (int n = 0; n < HIMC_NUANCES; n++) {
        e->nuance = himc_nuance_name((himc_nuance)n);
        if (!play((trial_kind){(himc_nuance)n, HIMC_PIPELINE_HIMC, law}, gain, print_phase, e,
                  error))
            return false;
    }
    return true;
}

static int find_law(const char *name)
{
    trial_kind kind = {HIMC_LEGATO, HIMC_PIPELINE_ID, HIMC_LAW_PRINTED};
    for (int law = 0; law < HIMC_LAW_COUNT; law++) {
        kind.law = (himc_law)law;
        if (!strcmp(name, trial_law_name(&kind).text))
            return law;
    }
    return -1;
}

int main(int count, char **word)
{
    static excerpt e;
    himc_error error;
    int law = count == 6 ? find_law(word[2]) : -1;
    double gain = count == 6 ? atof(word[3]) : 0;
    if (law < 0 || !(gain > 0) || (strcmp(word[1], "follow") && strcmp(word[1], "phases"))) {
        fprintf(stderr, "usage: strokes follow|phases LAW GAIN FROM TO\n");
        return 1;
    }
    e.from = atof(word[4]);
    e.to = atof(word[5]);
    bool (*make)(himc_law, double, excerpt *, himc_error *) =
        strcmp(word[1], "follow") ? phases : follow;
    if (make((himc_law)law, gain, &e, &error))
        return 0;
    fprintf(stderr, "strokes: %s\n", error.text);
    return 1;
}
