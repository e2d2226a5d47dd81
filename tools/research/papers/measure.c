/// measure.c: what papers.sh asks of the library itself, as rows `name,value`.
///
/// `measure facts`: rates, the upper body, table 1, joint limits learned from a capture, strength,
/// the motion database, the drum of figure 8. It takes a second and depends on nothing but the
/// program. `measure costs`: processor time of one trial by `himc` and by `id` (s), each the median
/// of five; `make trials` keeps it, since it depends on the machine.
#define _POSIX_C_SOURCE 200809L
#include "mocap/parts.h"
#include "tools/himc/trial.h"
#include "control/strength.h"
#include "drum/drum_performer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define DEGREES (180 / HIMC_PI)
#define RUNS 5              // chosen: odd, for a median
#define TRUNK_OF_TABLE 46.0 // 2012 paper, table 1 (%)
#define STICKS_OF_TABLE 0.5
#define FAR 3.0    // chosen: so many times as far from the mean as captured
#define STRONG 1e4 // chosen: above what any joint has (N m)
#define HEAD_SCORE "score tools/research/figures/blows.txt"

static himc_error error;

static void fail(void)
{
    fprintf(stderr, "measure: %s\n", error.text);
    exit(1);
}

static void fact(const char *name, double value)
{
    printf("%s,%.9g\n", name, value);
}

static double part(himc_vec3 v, int i)
{
    return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

static double determinant(const himc_mat3 *a)
{
    double det = 0;
    for (int i = 0; i < 3; i++)
        det += a->m[0][i] * (a->m[1][(i + 1) % 3] * a->m[2][(i + 2) % 3] -
                             a->m[1][(i + 2) % 3] * a->m[2][(i + 1) % 3]);
    return det;
}

static void measure_rates(void)
{
    himc_performance_config rates = himc_performance_default();
    fact("sample_rate", rates.sample_rate);
    fact("physics_rate", rates.physics_rate);
    fact("task_rate", rates.task_rate);
    fact("nuances", HIMC_NUANCES);
}

// the segments that the trunk carries, itself included; what the printed masses sum to
static void measure_body(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    config.anthropometry = HIMC_TABLE_1;
    himc_skeleton s;
    bool upper[HIMC_SEGMENTS] = {[HIMC_TRUNK] = true};
    int bodies = 0, joints = 0;
    if (!himc_skeleton_init(&s, &config, &error))
        fail();
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        int parent = s.segment[i].parent;
        upper[i] = upper[i] || (parent >= 0 && upper[parent]);
        bodies += upper[i];
        joints += upper[i] && parent >= 0;
    }
    fact("segments", HIMC_SEGMENTS);
    fact("upper_bodies", bodies);
    fact("upper_joints", joints);
    fact("upper_freedoms", 3 * joints);
    // the program's shares sum to one without the sticks
    fact("printed_mass", TRUNK_OF_TABLE * s.mass / s.segment[HIMC_TRUNK].mass + STICKS_OF_TABLE);
    fact("thigh_share", 100 * s.segment[HIMC_LEFT_UPPER_LEG].mass / s.mass);
}

// the ellipsoids of table 1: neck and left arm
static void measure_table_1(void)
{
    static const int joint[] = {HIMC_NECK - 1, HIMC_LEFT_UPPER_ARM - 1, HIMC_LEFT_FOREARM - 1,
                                HIMC_LEFT_HAND - 1};
    himc_pose zero = himc_pose_zero();
    himc_limits limits = himc_limits_table_1(&zero);
    int axes = 0, mirrored = 0;
    for (int k = 0; k < 4; k++) {
        const himc_limit *l = &limits.joint[joint[k]];
        for (int i = 0; i < 3; i++)
            axes += l->bound && part(l->radius, i) > 0;
        mirrored += determinant(&l->axes) < 0;
    }
    fact("half_axes", axes);
    fact("mirrored", mirrored);
    fact("wrist_deg", DEGREES * limits.joint[joint[3]].radius.x);
}

// of all poses and bound joints: how far outside the captured are, and where those end that lie
// FAR times as far; 1 is on the bounds
static void measure_kind(const char *name, himc_limits *limits, himc_limits_kind kind,
                         const himc_pose *pose, int frames)
{
    double captured = 0, back = 0;
    char text[64];
    limits->kind = kind;
    for (int j = 0; j < HIMC_JOINTS; j++)
        for (int f = 0; f < frames && limits->joint[j].bound; f++) {
            himc_quat q = pose[f].joint[j], mean = limits->joint[j].mean;
            himc_vec3 off = himc_quat_log(himc_quat_mul(himc_quat_conj(mean), q));
            himc_quat far = himc_quat_mul(mean, himc_quat_exp(himc_vec3_scale(off, FAR)));
            captured = fmax(captured, himc_limit_measure(limits, j, q));
            if (himc_limit_measure(limits, j, far) > 1) {
                himc_quat closest = himc_limit_closest(limits, j, far);
                back = fmax(back, himc_limit_measure(limits, j, closest));
            }
        }
    snprintf(text, sizeof text, "%s_captured", name);
    fact(text, captured);
    snprintf(text, sizeof text, "%s_back", name);
    fact(text, back);
}

static void measure_limits(void)
{
    himc_mocap_config config = himc_mocap_default();
    himc_mocap *mocap = himc_mocap_new(&config, &error);
    int frames = mocap ? himc_mocap_frames(mocap) : 0;
    himc_pose *pose = mocap ? malloc((size_t)frames * sizeof *pose) : NULL;
    himc_limits limits;
    if (!pose)
        fail();
    for (int f = 0; f < frames; f++)
        pose[f] = himc_mocap_pose(mocap, f / HIMC_MOCAP_RATE);
    if (!himc_limits_learn(&limits, pose, frames, 0, &error))
        fail();
    measure_kind("ellipsoid", &limits, HIMC_LIMITS_ELLIPSOID, pose, frames);
    measure_kind("euler", &limits, HIMC_LIMITS_EULER, pose, frames);
    free(pose);
    himc_mocap_free(mocap);
}

// torques far above a joint's strength, of a body at rest: what is left, over the maximum
static void measure_strength(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton s;
    if (!himc_skeleton_init(&s, &config, &error))
        fail();
    himc_pose pose = himc_pose_zero();
    himc_body_state state;
    himc_pose_to_state(&s, &pose, NULL, &state);
    himc_controller_config control = himc_controller_config_default();
    himc_controller c;
    himc_vec3 torque[HIMC_JOINTS];
    double free_torque = 0, most = 0;
    for (int strong = 0; strong < 2; strong++) {
        himc_controller_init(&c, &control, &s, &state);
        for (int j = 0; j < HIMC_JOINTS; j++)
            torque[j] = himc_vec3_make(STRONG, STRONG, STRONG);
        himc_strength_apply(&c, &s, &state, (double[]){1, 1}, torque);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            double size = himc_vec3_length(torque[j]);
            free_torque += strong ? 0 : size / (STRONG * sqrt(3)) / HIMC_JOINTS;
            most = strong ? fmax(most, size / control.strength[j]) : 0;
        }
        himc_controller_set_human_strength(&control, s.mass);
    }
    fact("torque_without", free_torque);
    fact("torque_with", most);
    fact("wrist_strength", control.strength[HIMC_LEFT_HAND - 1]);
}

static void measure_database(void)
{
    himc_mocap_config c = himc_mocap_default();
    himc_mocap_statistics strokes[HIMC_NUANCES] = {0};
    char name[64];
    int sequences = 0, least = 1000, all = 0;
    for (c.player = 0; c.player < HIMC_MOCAP_PLAYERS; c.player++)
        for (int n = 0; n < HIMC_NUANCES; n++)
            for (int spot = 0; spot < TRIAL_SPOTS; spot++) {
                c.nuance = (himc_nuance)n;
                c.spot = (himc_spot)spot;
                himc_mocap *mocap = himc_mocap_new(&c, &error);
                if (!mocap)
                    fail();
                int strikes = himc_mocap_touches(mocap);
                least = strikes < least ? strikes : least;
                all += strikes;
                sequences++;
                himc_mocap_measure(mocap, &strokes[n]);
                himc_mocap_free(mocap);
            }
    trial_config shown = trial_default(&(trial_kind){.nuance = HIMC_LEGATO}, 1); // by strokes.c
    fact("grip", himc_mocap_player[trial_sequence(&shown).player].french);
    fact("players", HIMC_MOCAP_PLAYERS);
    fact("sequences", sequences);
    fact("least_strikes", least);
    fact("strikes", all);
    for (int n = 0; n < HIMC_NUANCES; n++) {
        snprintf(name, sizeof name, "depth_%s", himc_nuance_name((himc_nuance)n));
        fact(name, 1e3 * himc_mocap_mean(&strokes[n], HIMC_MOCAP_DEPTH));
        snprintf(name, sizeof name, "depth_sd_%s", himc_nuance_name((himc_nuance)n));
        fact(name, 1e3 * himc_mocap_deviation(&strokes[n], HIMC_MOCAP_DEPTH));
        snprintf(name, sizeof name, "height_%s", himc_nuance_name((himc_nuance)n));
        fact(name, 1e3 * himc_mocap_mean(&strokes[n], HIMC_MOCAP_TIP_HEIGHT));
    }
}

static void measure_drum(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    himc_command c;
    if (!p)
        fail();
    himc_performance_make_drums(p, true);
    if (!himc_command_parse_text(&c, HIMC_PERFORMER, HEAD_SCORE, &error) ||
        !himc_performance_command(p, &c, 0, &error))
        fail();
    himc_drum *drum = himc_performance_drum(p, 0);
    fact("inches", himc_drum_inches(drum));
    fact("exponent", himc_drum_mallet(drum, HIMC_RIGHT)->exponent);
    himc_performance_free(p);
}

static double cpu_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void measure_costs(void)
{
    static const himc_pipeline controls[] = {HIMC_PIPELINE_HIMC, HIMC_PIPELINE_ID};
    static const char *const names[] = {"himc_s", "id_s"};
    double taken[2][RUNS];
    for (int run = -1; run < RUNS; run++) // the first is not counted: it learns the regression
        for (int k = 0; k < 2; k++) {
            trial_kind kind = {HIMC_LEGATO, controls[k], HIMC_LAW_COMPUTED_TORQUE};
            trial_config config = trial_default(&kind, 1);
            trial_result result;
            double start = cpu_seconds();
            if (!trial_run(&config, &result, &error))
                fail();
            if (run >= 0)
                taken[k][run] = cpu_seconds() - start;
        }
    for (int k = 0; k < 2; k++) {
        qsort(taken[k], RUNS, sizeof *taken[k], by_size);
        fact(names[k], taken[k][RUNS / 2]);
    }
    trial_kind kind = {.nuance = HIMC_LEGATO};
    trial_config config = trial_default(&kind, 1);
    himc_mocap_config sequence = trial_sequence(&config);
    himc_mocap *mocap = himc_mocap_new(&sequence, &error);
    if (!mocap)
        fail();
    fact("take_s", himc_mocap_length(mocap));
    himc_mocap_free(mocap);
}

int main(int count, char **word)
{
    bool facts = count == 2 && !strcmp(word[1], "facts");
    if (!facts && (count != 2 || strcmp(word[1], "costs"))) {
        fprintf(stderr, "usage: measure facts|costs\n");
        return 1;
    }
    puts("name,value");
    if (!facts) {
        measure_costs();
        return 0;
    }
    measure_rates();
    measure_body();
    measure_table_1();
    measure_limits();
    measure_strength();
    measure_database();
    measure_drum();
    return 0;
}
