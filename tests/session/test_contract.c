/// test_contract.c: each function that a public header marks HIMC_RT is called with every call that
/// may wait counted from outside (tests/watch/watch.c, preloaded). The names are read from the
/// headers: a new one fails here until it is in the list.
#define _GNU_SOURCE
#include "himc/himc.h"
#include "himc/body.h"
#include "himc/drive.h"
#include "himc/loader.h"
#include "himc/membrane.h"
#include "himc/mocap.h"
#include "himc/osc.h"

#include "unity.h"

#include <ctype.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define ROUNDS 150 // of 20 ms each, while a score plays

void watch_span_begin(void) __attribute__((weak));
void watch_span_end(void) __attribute__((weak));
long watch_calls(void) __attribute__((weak));

static himc_error error;
static himc_performance *performer;
static himc_drum *drum;
static himc_membrane *head, *other;
static himc_skeleton skeleton;
static himc_body_state state;
static himc_pose pose;
static himc_limits limits;
static himc_articulation articulation;
static himc_arm_jacobian jacobian;
static himc_vec3 of_joints[HIMC_JOINTS], of_arm[HIMC_ARM_JOINTS];
static himc_command command, copy;
static himc_recording *recording;
static himc_osc *osc;
static himc_loader *loader;
static himc_player player;
static himc_event event;
static himc_drive driven; // none
static double sound[480], force[2][480], x, y;
static int whole;
static float frames[3 * 480];
static char line[HIMC_OSC_LINE];

void setUp(void)
{
}

void tearDown(void)
{
}

static void contact_step(void)
{
    himc_stick stick = {
        .head = {.stiffness = 1e8, .exponent = 2.5, .loss = 0.1, .mass = 0.03, .radius = 0.0175},
        .mass = 0.03,
        .velocity = -2};
    himc_contact_step(head, &(himc_stick *){&stick}, 1);
}

static void run_head(void)
{
    double *out[HIMC_PICKUPS] = {sound, force[0], force[1], sound, sound, sound, sound, sound};
    himc_membrane_run(head, 64, out, force[0]);
}

static const double even[HIMC_ARM_JOINTS] = {1, 1, 1, 1};
static const himc_tempo_change tempi[] = {{0, 100}, {4, 140}};

// the functions, each with a call
#define CALLS(CALL)                                                                                \
    CALL(himc_version, himc_version())                                                             \
    CALL(himc_pose_zero, pose = himc_pose_zero())                                                  \
    CALL(himc_pose_to_state, himc_pose_to_state(&skeleton, &pose, NULL, &state))                   \
    CALL(himc_pose_from_state, pose = himc_pose_from_state(&skeleton, &state))                     \
    CALL(himc_body_state_complete, himc_body_state_complete(&skeleton, &state))                    \
    CALL(himc_body_state_finite, himc_body_state_finite(&state))                                   \
    CALL(himc_limits_table_1, limits = himc_limits_table_1(&pose))                                 \
    CALL(himc_limit_measure, himc_limit_measure(&limits, 3, pose.joint[3]))                        \
    CALL(himc_limit_closest, himc_limit_closest(&limits, 3, pose.joint[3]))                        \
    CALL(himc_arm_jacobian_at, himc_arm_jacobian_at(&state, HIMC_LEFT, &jacobian))                 \
    CALL(himc_arm_jacobian_weighted,                                                               \
         himc_arm_jacobian_weighted(&state, HIMC_LEFT, even, &jacobian))                           \
    CALL(himc_ik_solve, for (int s = 0; s < 5; s++) himc_ik_solve(&jacobian, (himc_solver)s, 0.1,  \
                                                                  (himc_vec3){0.1, 0, 0}, of_arm)) \
    CALL(himc_ik_add_null, himc_ik_add_null(&jacobian, of_joints, of_arm))                         \
    CALL(himc_inverse_dynamics, himc_inverse_dynamics(&skeleton, &state, NULL, false, of_joints))  \
    CALL(himc_articulate, himc_articulate(&skeleton, &state, &articulation))                       \
    CALL(himc_forward_dynamics,                                                                    \
         himc_forward_dynamics(&skeleton, &state, &articulation, of_joints, NULL, of_joints))      \
    CALL(himc_effective_mass,                                                                      \
         himc_effective_mass(&skeleton, &state, &articulation, HIMC_RIGHT, (himc_vec3){0, 0, 1}))  \
    CALL(himc_stroke_spot, himc_stroke_spot(&command.stroke, 0.3, &x, &y))                         \
    CALL(himc_command_table, himc_command_table(3))                                                \
    CALL(himc_command_find, himc_command_find(HIMC_DRUM, "strike"))                                \
    CALL(himc_command_copy, himc_command_copy(&copy, &command))                                    \
    CALL(himc_command_word, himc_command_word(HIMC_COMMAND_LAW, 0, 1))                             \
    CALL(himc_command_file, himc_command_file(&command, &whole))                                   \
    CALL(himc_drum_head_frame, himc_drum_head_frame(drum))                                         \
    CALL(himc_drum_membrane, himc_drum_membrane(drum))                                             \
    CALL(himc_drum_rate, himc_drum_rate(drum))                                                     \
    CALL(himc_drum_strike_at, himc_drum_strike_at(drum, 3, 0.1, 0, 3, &error);                     \
         himc_drum_strike_at(drum, 3, 9.5, 0, 3, &error))                                          \
    CALL(himc_drum_advance, himc_drum_advance(drum, 64, force[0], NULL, NULL))                     \
    CALL(himc_drum_read, himc_drum_read(drum, 0, 64, sound, sound))                                \
    CALL(himc_drum_read_channel, himc_drum_read_channel(drum, 0, 0, 64, sound))                    \
    CALL(himc_drum_watch, himc_drum_watch(drum, false))                                            \
    CALL(himc_drum_time, himc_drum_time(drum))                                                     \
    CALL(himc_drum_realign, himc_drum_realign(drum, 0))                                            \
    CALL(himc_drum_follows, himc_drum_follows(drum, drum))                                         \
    CALL(himc_drum_strike_next, himc_drum_strike_next(drum, &(himc_contact_report){0}))            \
    CALL(himc_drum_contact_next, himc_drum_contact_next(drum, &(himc_contact_onset){0}))           \
    CALL(himc_drum_technique, himc_drum_technique(drum))                                           \
    CALL(himc_drum_get_driver, himc_drum_get_driver(drum))                                         \
    CALL(himc_loader_busy, himc_loader_busy(loader))                                               \
    CALL(himc_loader_refused, himc_loader_refused(loader, &error))                                 \
    CALL(himc_membrane_head, himc_membrane_head(head))                                             \
    CALL(himc_membrane_pickups, himc_membrane_pickups(head, &whole))                               \
    CALL(himc_membrane_rate, himc_membrane_rate(head))                                             \
    CALL(himc_membrane_mode, himc_membrane_mode(head, 3))                                          \
    CALL(himc_membrane_principal, himc_membrane_principal(head, himc_membrane_head(other)))        \
    CALL(himc_membrane_audible, himc_membrane_audible(head))                                       \
    CALL(himc_membrane_watch, himc_membrane_watch(head, x += 1e-3, 0.1))                           \
    CALL(himc_membrane_push, himc_membrane_push(head, 0.1, 0, 5))                                  \
    CALL(himc_membrane_run, run_head())                                                            \
    CALL(himc_membrane_sound, himc_membrane_sound(head, 0))                                        \
    CALL(himc_membrane_watched, himc_membrane_watched(head))                                       \
    CALL(himc_membrane_energy, himc_membrane_energy(head))                                         \
    CALL(himc_membrane_state, himc_membrane_state(head, 3, &x, &y))                                \
    CALL(himc_membrane_rest, himc_membrane_rest(other))                                            \
    CALL(himc_contact_step, contact_step())                                                        \
    CALL(himc_player_known_arm, himc_player_known_arm(&player, HIMC_LEFT))                         \
    CALL(himc_recording_add, himc_recording_add(recording, &state))                                \
    CALL(himc_recording_frames, himc_recording_frames(recording))                                  \
    CALL(himc_osc_command, himc_osc_command(osc, &command, &error))                                \
    CALL(himc_osc_tick, himc_osc_tick(osc, &(himc_tick){.body = &state, .time = x}))               \
    CALL(himc_osc_event, himc_osc_event(osc, &event))                                              \
    CALL(himc_osc_publish, himc_osc_publish(osc, performer, 0.001))                                \
    CALL(himc_osc_line, himc_osc_line(osc, line))                                                  \
    CALL(himc_osc_count, himc_osc_count(osc))                                                      \
    CALL(himc_performance_drum, himc_performance_drum(performer, 0))                               \
    CALL(himc_performance_target,                                                                  \
         himc_performance_target(performer, HIMC_LEFT, (himc_vec3){9, 9, 9 + x}))                  \
    CALL(himc_performance_drive, himc_performance_drive(performer, &driven, &error))               \
    CALL(himc_performance_process,                                                                 \
         himc_performance_process(performer, 480, (double *[]){force[0], force[1]}))               \
    CALL(himc_performance_read, himc_performance_read(performer, frames, 3, 480))                  \
    CALL(himc_performance_time, himc_performance_time(performer))                                  \
    CALL(himc_performance_realign, himc_performance_realign(performer))                            \
    CALL(himc_performance_event, himc_performance_event(performer, &event))                        \
    CALL(himc_performance_measure, himc_performance_measure(performer))                            \
    CALL(himc_score_seconds, himc_score_seconds(tempi, 2, 9))                                      \
    CALL(himc_score_beat, himc_score_beat(tempi, 2, 9))

#define DEFINE(NAME, STATEMENT)   \
    static void call_##NAME(void) \
    {                             \
        watch_span_begin();       \
        STATEMENT;                \
        watch_span_end();         \
    }
CALLS(DEFINE)

static const struct {
    const char *name;
    void (*call)(void);
} calls[] = {
#define ROW(NAME, STATEMENT) {#NAME, call_##NAME},
    CALLS(ROW)};
#define COUNT (sizeof calls / sizeof *calls)

static bool is_listed(const char *name)
{
    for (size_t i = 0; i < COUNT; i++)
        if (strcmp(calls[i].name, name) == 0)
            return true;
    return false;
}

// the name of the function that is declared after a mark
static const char *name_after(const char *mark, char name[64])
{
    const char *open = strchr(mark, '('), *from = open;
    while (isalnum((unsigned char)from[-1]) || from[-1] == '_')
        from--;
    snprintf(name, 64, "%.*s", (int)(open - from), from);
    return name;
}

static void test_every_function_of_the_headers_with_the_mark_is_in_the_list(void)
{
    glob_t headers;
    size_t found = 0;
    char text[300], name[64];
    TEST_ASSERT_EQUAL_INT(0, glob("lib/himc/*.h", 0, NULL, &headers));
    for (size_t i = 0; i < headers.gl_pathc; i++) {
        FILE *file = fopen(headers.gl_pathv[i], "r");
        while (fgets(text, sizeof text, file)) {
            bool inlined = strncmp(text, "HIMC_RT static", 14) == 0 && strstr(text, "himc_vec3");
            if (strncmp(text, "HIMC_RT ", 8) != 0 || inlined || !strchr(text, '('))
                continue;
            found++;
            TEST_ASSERT_TRUE_MESSAGE(is_listed(name_after(text, name)), name);
        }
        fclose(file);
    }
    globfree(&headers);
    TEST_ASSERT_EQUAL_INT(COUNT, found);
}

static void say(const char *text, int delay)
{
    himc_command c;
    bool ok = himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) &&
              himc_performance_command(performer, &c, delay, &error);
    TEST_ASSERT_TRUE_MESSAGE(ok, error.text);
}

static void make_all(void)
{
    himc_skeleton_config body = himc_skeleton_default();
    himc_performance_config config = himc_performance_default();
    himc_osc_config network = himc_osc_default();
    himc_head round = himc_head_default();
    network.port = -1;
    pose = himc_pose_zero();
    performer = himc_performance_new(&config, &error);
    drum = himc_drum_new("kettle", 26, 48000, &error);
    head = himc_membrane_new(&round, 48000, &error);
    other = himc_membrane_new(&round, 48000, &error);
    osc = himc_osc_new(&network, &error);
    loader = himc_loader_new(&error);
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &body, &error));
    recording = himc_recording_new("build/contract.bvh", &skeleton, 250, 60, &error);
    TEST_ASSERT_TRUE_MESSAGE(performer && drum && head && other && osc && loader && recording,
                             error.text);
    TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_PERFORMER,
                                             "subscribe 127.0.0.1 9 pose 250", &error));
    himc_performance_make_drums(performer, true);
    say("drum own 26", 0);
    for (int i = 0; i < 12; i++) {
        char text[80];
        snprintf(text, sizeof text, "stroke %g %s legato f", 1 + i / 3.0, i % 2 ? "left" : "right");
        say(text, 0);
    }
    say("roll 5.5 2 press mf", 0);
    say("roll 8 2 double p", 0);
    say("limits euler", 0);
    say("strength human", 0);
    say("play", 0);
}

static void test_nothing_that_may_wait_is_called(void)
{
    if (!watch_span_begin)
        TEST_IGNORE_MESSAGE("a sanitizer stands in front of libc");
    make_all();
    for (whole = 0; whole < ROUNDS;) {
        int round = whole;
        say(round % 3 ? "hit left accent fff" : "hit right staccato p rim", 7);
        say(round % 40 < 20 ? "mode himc" : "mode id", 9);
        say("push nobody 1 1 1 0.1", 11);
        for (size_t i = 0; i < COUNT; i++) {
            long before = watch_calls();
            whole = round;
            calls[i].call();
            TEST_ASSERT_EQUAL_INT_MESSAGE(before, watch_calls(), calls[i].name);
        }
        whole = round + 1;
    }
    himc_performance_stats stats = himc_performance_measure(performer);
    TEST_ASSERT_GREATER_THAN(3, stats.hits);
    himc_osc_free(osc);
    himc_loader_free(loader);
    himc_recording_free(recording);
    himc_membrane_free(head);
    himc_membrane_free(other);
    himc_drum_release(drum);
    himc_performance_free(performer);
}

// The host only tries the lock of the loader, and wakes the helper for two stages of a load: when
// there is something to prepare, which is not counted here if it succeeds at once, and to free.
static void test_the_host_of_a_loader_never_waits_for_its_helper(void)
{
    if (!watch_span_begin)
        TEST_IGNORE_MESSAGE("a sanitizer stands in front of libc");
    drum = himc_drum_new("kettle", 26, 48000, &error);
    himc_load_target target = {.drum = drum};
    for (int i = 0; i < 5; i++) {
        const char *text = i % 2 ? "modes 300" : "modes 900";
        loader = himc_loader_new(&error);
        TEST_ASSERT_TRUE(himc_command_parse_text(&command, HIMC_DRUM, text, &error));
        TEST_ASSERT_TRUE(himc_loader_command(loader, &target, &command, &error));
        himc_loader_run(loader); // makes the job
        long before = watch_calls();
        while (himc_loader_busy(loader)) {
            watch_span_begin();
            himc_loader_run(loader);
            watch_span_end();
        }
        TEST_ASSERT_LESS_OR_EQUAL(before + 2, watch_calls());
        himc_loader_free(loader);
    }
    himc_drum_release(drum);
}

int main(int argc, char **argv)
{
    (void)argc;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    char path[600];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 16);
    char *slash = length > 0 ? memrchr(path, '/', (size_t)length) : NULL;
    if (!watch_span_begin && slash && !getenv("LD_PRELOAD")) {
        strcpy(slash, "/watch.so");
        setenv("LD_PRELOAD", path, 1);
        execv("/proc/self/exe", argv);
    }
#endif
    UNITY_BEGIN();
    RUN_TEST(test_every_function_of_the_headers_with_the_mark_is_in_the_list);
    RUN_TEST(test_nothing_that_may_wait_is_called);
    RUN_TEST(test_the_host_of_a_loader_never_waits_for_its_helper);
    return UNITY_END();
}
