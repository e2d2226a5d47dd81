/// bench_performance.c: how fast the whole performance runs, one core, and where a physics step's
/// time goes.
///
/// Prints the parts of a step in microseconds and, for the improvisation at 48 kHz and 10 kHz
/// with 57 degrees of freedom and one drum of its usual number of modes, the factor by which it
/// is faster than real time (median of five runs).
#define _POSIX_C_SOURCE 200809L
#include "himc/himc.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define STEPS 20000
#define RUNS 5
#define BLOCK 64

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

static void command(himc_performance *p, const char *text)
{
    himc_error error;
    himc_command c;
    if (!himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) ||
        !himc_performance_command(p, &c, 0, &error)) {
        fprintf(stderr, "%s\n", error.text);
        exit(1);
    }
}

static void bench_step(void)
{
    himc_error error;
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    if (!himc_skeleton_init(&skeleton, &config, &error)) {
        fprintf(stderr, "%s\n", error.text);
        exit(1);
    }
    himc_posture posture;
    himc_task_tick from = {.time = 0}, to = {.time = 0.004};
    himc_body_state state;
    himc_pose pose;
    himc_controller controller;
    himc_reference reference = {.released = {false, false}};
    himc_articulation articulation;
    himc_vec3 torque[HIMC_JOINTS], relative[HIMC_JOINTS], none[HIMC_HANDS] = {{0, 0, 0}, {0, 0, 0}};
    himc_posture_init(&posture, &skeleton, 0.8675);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        from.tip[hand].x = himc_vec3_make(0.48, hand == HIMC_LEFT ? 0.1 : -0.1, 1.0);
    memcpy(to.tip, from.tip, sizeof to.tip);
    himc_task_tick_complete(&from, &posture);
    himc_task_tick_complete(&to, &posture);
    memcpy(pose.joint, from.posture.joint, sizeof pose.joint);
    himc_pose_to_state(&skeleton, &pose, NULL, &state);
    himc_controller_init(&controller, &skeleton, &state);
    himc_character *character = himc_character_new(&skeleton, &error);
    if (!character)
        exit(1);
    himc_character_place(character, &state);
    double t[6] = {cpu_seconds()};
    for (int i = 0; i < STEPS; i++)
        himc_task_between(&from, &to, 0.001 + 1e-9 * i, &reference);
    t[1] = cpu_seconds();
    for (int i = 0; i < STEPS; i++)
        himc_controller_torques(&controller, &skeleton, &state, &reference, torque);
    t[2] = cpu_seconds();
    for (int i = 0; i < STEPS; i++) {
        himc_articulate(&skeleton, &state, &articulation);
        himc_forward_dynamics(&skeleton, &state, &articulation, torque, NULL, relative);
    }
    t[3] = cpu_seconds();
    for (int i = 0; i < STEPS; i++)
        himc_character_observe(character, &state);
    t[4] = cpu_seconds();
    for (int i = 0; i < STEPS; i++)
        himc_character_step(character, torque, none, 1e-4);
    t[5] = cpu_seconds();
    static const char *const part[] = {"targets between ticks", "inverse kinematics and dynamics",
                                       "articulated inertia (in contact)", "reading the body back",
                                       "the bare engine (dWorldStep)"};
    for (int i = 0; i < 5; i++)
        printf("%-34s %6.2f us\n", part[i], 1e6 * (t[i + 1] - t[i]) / STEPS);
    himc_character_free(character);
}

// one whole run of the improvisation; returns seconds of music per second of the processor
static double bench_piece(void)
{
    himc_error error;
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    himc_drum *drum = p ? himc_drum_new("kettle", 23, config.sample_rate, &error) : NULL;
    if (!drum || !himc_performance_add_drum(p, drum, &error)) {
        fprintf(stderr, "%s\n", error.text);
        exit(1);
    }
    command(p, "score patches/improvisation.txt");
    command(p, "play");
    himc_event event = {.kind = HIMC_EVENT_BEAT};
    double start = cpu_seconds();
    while (event.kind != HIMC_EVENT_DONE) {
        himc_performance_process(p, BLOCK, NULL);
        while (event.kind != HIMC_EVENT_DONE && himc_performance_event(p, &event)) {
        }
    }
    double factor = himc_performance_measure(p).seconds / (cpu_seconds() - start);
    himc_drum_release(drum);
    himc_performance_free(p);
    return factor;
}

int main(void)
{
    double factor[RUNS];
    bench_step();
    for (int i = 0; i < RUNS; i++)
        factor[i] = bench_piece();
    qsort(factor, RUNS, sizeof *factor, by_size);
    printf("%-34s %6.2f x real time (%.2f .. %.2f)\n", "the improvisation, one core",
           factor[RUNS / 2], factor[0], factor[RUNS - 1]);
    return 0;
}
