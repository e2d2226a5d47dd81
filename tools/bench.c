/// bench.c: `himc bench`: the speed of one core. It measures a step of the whole performance
/// (control, contact, one drum) and one of the physics engine alone on the same body; the solvers
/// of inverse kinematics; the modes of a drumhead and the performers with their drums that one core
/// plays in real time.
///
/// It measures processor time, not elapsed time, and each figure is the median of five runs, so
/// other programs on the machine have little effect.
#define _POSIX_C_SOURCE 200809L
#include "cli.h"
#include "himc/himc.h"
#include "body/posture.h"
#include "control/controller.h"
#include "control/setpoint.h"
#include "body/character.h"
#include "himc/membrane.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#define RUNS 5             // chosen: odd, for a median
#define RATE 48000         // sample rate (Hz)
#define PHYSICS 10000      // the default physics rate, and the repetitions of each part (Hz)
#define BLOCK 64           // Pd's block (samples)
#define SECONDS 4          // chosen: of each performance (s)
#define MODES 1024         // chosen: of the drumhead that is measured alone
#define MODE_SAMPLES 24000 // chosen: half a second of it
#define PARTS 6
#define ROWS (PARTS + HIMC_SOLVERS) // the parts of a step, then the solvers
#define DAMPING 0.01                // chosen: of DLS and Nakamura, in the range of use (m)

enum { JSON };

static const cli_option options[] = {
    {"json", 0, NULL, "one JSON object instead of a table"},
    {0},
};

/// Median of the runs.
typedef struct figures {
    double step, engine;      ///< (us)
    double row[ROWS];         ///< (us)
    double performers, modes; ///< that one core plays in real time
} figures;

static const char *const part_name[PARTS] = {
    "targets between ticks",           "natural posture (at each tick)",
    "inverse kinematics and dynamics", "articulated inertia (in contact)",
    "reading the body back",           "physics engine alone"};

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

static double median(double *value)
{
    qsort(value, RUNS, sizeof *value, by_size);
    return value[RUNS / 2];
}

/// Four strokes a second, hands in turn.
static himc_performance *make_performance(himc_error *error)
{
    himc_performance_config config = himc_performance_default();
    config.sample_rate = RATE;
    config.physics_rate = PHYSICS;
    himc_performance *p = himc_performance_new(&config, error);
    bool good = p && cli_add_drum(p, RATE, error) && cli_tell(p, "tempo 120", NULL, error);
    for (int i = 0; good && i < 4 * SECONDS; i++) {
        char text[64];
        snprintf(text, sizeof text, "stroke %g %s legato mf", 1 + i / 2.0,
                 himc_hand_name(i % 2 ? HIMC_LEFT : HIMC_RIGHT));
        good = cli_tell(p, text, NULL, error);
    }
    if (good && cli_tell(p, "play", NULL, error))
        return p;
    himc_performance_free(p);
    return NULL;
}

/// Processor time of the performance (s); negative with the reason.
static double time_performance(himc_error *error)
{
    himc_performance *p = make_performance(error);
    if (!p)
        return -1;
    double start = cpu_seconds();
    for (int done = 0; done < SECONDS * RATE; done += BLOCK)
        himc_performance_process(p, BLOCK, NULL);
    double taken = cpu_seconds() - start;
    himc_performance_free(p);
    return taken;
}

/// A body in playing posture, on which the parts of a step work.
typedef struct bench_body {
    himc_skeleton skeleton;
    himc_posture posture;
    himc_setpoint from, to;
    himc_body_state state;
    himc_controller controller;
    himc_reference reference;
    himc_character *character;
} bench_body;

static bool make_body(bench_body *b, himc_error *error)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_pose pose;
    *b = (bench_body){.to.time = 0.004};
    if (!himc_skeleton_init(&b->skeleton, &config, error))
        return false;
    himc_posture_init(&b->posture, &b->skeleton, 0.8675);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        b->from.tip[hand].x = himc_vec3_make(0.48, hand == HIMC_LEFT ? 0.1 : -0.1, 1.0);
    memcpy(b->to.tip, b->from.tip, sizeof b->to.tip);
    himc_setpoint_complete(&b->from, &b->posture);
    himc_setpoint_complete(&b->to, &b->posture);
    memcpy(pose.joint, b->from.posture.joint, sizeof pose.joint);
    himc_pose_to_state(&b->skeleton, &pose, NULL, &b->state);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&b->controller, &control, &b->skeleton, &b->state);
    b->character = himc_character_new(&b->skeleton, error);
    if (b->character)
        himc_character_place(b->character, &b->state);
    return b->character != NULL;
}

/// One tip's displacement as rotations of the arm's joints.
static void solve(const bench_body *b, himc_solver solver, int i)
{
    himc_arm_jacobian jacobian;
    himc_vec3 rotation[HIMC_ARM_JOINTS], error = {1e-3, 2e-3, -1e-6 * i};
    himc_arm_jacobian_at(&b->state, HIMC_RIGHT, &jacobian);
    himc_ik_solve(&jacobian, solver, DAMPING, error, rotation);
}

static void do_row(bench_body *b, int part, int i)
{
    static const himc_vec3 none[HIMC_HANDS];
    himc_articulation articulation;
    himc_vec3 torque[HIMC_JOINTS] = {{0, 0, 0}}, relative[HIMC_JOINTS];
    if (part == 0)
        himc_setpoint_interpolate(&b->from, &b->to, 0.001 + 1e-9 * i, &b->reference);
    else if (part == 1)
        himc_setpoint_complete(&b->to, &b->posture);
    else if (part == 2)
        himc_controller_torques(&b->controller, &b->skeleton, &b->state, &b->reference, torque);
    else if (part == 3) {
        himc_articulate(&b->skeleton, &b->state, &articulation);
        himc_forward_dynamics(&b->skeleton, &b->state, &articulation, torque, NULL, relative);
    } else if (part == 4)
        himc_character_observe(b->character, &b->state);
    else if (part >= PARTS)
        solve(b, (himc_solver)(part - PARTS), i);
    else
        himc_character_step(b->character, torque, none, 1.0 / PHYSICS);
}

static bool time_rows(double row[ROWS], himc_error *error)
{
    bench_body b;
    if (!make_body(&b, error))
        return false;
    for (int k = 0; k < ROWS; k++) {
        double start = cpu_seconds();
        for (int i = 0; i < PHYSICS; i++)
            do_row(&b, k, i);
        row[k] = 1e6 * (cpu_seconds() - start) / PHYSICS;
    }
    himc_character_free(b.character);
    return true;
}

/// Modes that a core computes in real time. The drumhead is tuned so low that all of them are below
/// half the sample rate, and has almost no losses, since modes that have died away cost nothing.
static double time_modes(himc_error *error)
{
    himc_head head = himc_head_default();
    static double first[BLOCK], watched[BLOCK], *const sound = first;
    head.modes = MODES;
    head.decay_constant = 0.1;
    head.decay_square = 0;
    himc_membrane *membrane = himc_membrane_new(&head, RATE, error);
    if (!membrane)
        return -1;
    himc_membrane_push(membrane, 0.11, 0.07, 100);
    double start = cpu_seconds();
    for (int i = 0; i < MODE_SAMPLES; i += BLOCK)
        himc_membrane_run(membrane, BLOCK, &sound, watched);
    double taken = cpu_seconds() - start;
    himc_membrane_free(membrane);
    return MODES * ((double)MODE_SAMPLES / RATE) / taken;
}

static bool measure(figures *out, himc_error *error)
{
    double performers[RUNS], modes[RUNS], row[ROWS][RUNS], now[ROWS];
    for (int i = 0; i < RUNS; i++) {
        double taken = time_performance(error);
        modes[i] = time_modes(error);
        if (taken < 0 || modes[i] < 0 || !time_rows(now, error))
            return false;
        performers[i] = SECONDS / taken;
        for (int k = 0; k < ROWS; k++)
            row[k][i] = now[k];
    }
    out->performers = median(performers);
    out->modes = median(modes);
    out->step = 1e6 / (out->performers * PHYSICS);
    for (int k = 0; k < ROWS; k++)
        out->row[k] = median(row[k]);
    out->engine = out->row[PARTS - 1];
    return true;
}

static void print_table(const figures *f)
{
    printf("one step in all                    %8.2f us at %d Hz, with one drum at %d Hz\n",
           f->step, PHYSICS, RATE);
    for (int k = 0; k < PARTS; k++)
        printf("  %-32s %8.2f us\n", part_name[k], f->row[k]);
    printf("step / engine alone                %8.2f\n", f->step / f->engine);
    puts("inverse kinematics of one arm, by solver");
    for (int k = 0; k < HIMC_SOLVERS; k++)
        printf("  %-32s %9.3f us\n", himc_command_word(HIMC_COMMAND_SOLVER, 0, k).text,
               f->row[PARTS + k]);
    printf("modes per core                     %8.0f\n", f->modes);
    printf("performers per core                %8.2f (times real time)\n", f->performers);
}

static int run(const cli_arguments *arguments)
{
    himc_error error;
    figures f;
    if (!measure(&f, &error))
        return cli_fail(&cli_bench, "%s", error.text);
    if (arguments->value[JSON])
        printf("{\"step_us\": %.3f, \"engine_step_us\": %.3f, \"step_ratio\": %.3f, "
               "\"modes_per_core\": %.0f, \"performers_per_core\": %.3f}\n",
               f.step, f.engine, f.step / f.engine, f.modes, f.performers);
    else
        print_table(&f);
    return cli_finish(&cli_bench);
}

const cli_call cli_bench = {
    "bench",
    "",
    "",
    "measures the cost of a step, of modes and of performers on this machine",
    "Processor time of one core, each figure the median of five runs.",
    options,
    run,
};
