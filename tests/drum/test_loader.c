/// test_loader.c: commands that take long, prepared by a helper thread: the same result as at once,
/// in order, while the sound goes on; and what is said when they fail. It is meant to run under the
/// thread sanitizer, too.
#include "allocations.h"
#include "drum/drum_performer.h"
#include "take_players.h"

#include "session.h"

#include "himc/loader.h"
#include "himc/membrane.h"

#include "capture/take.h"
#include "system/thread.h"

#include <pthread.h>
#include <sched.h>

#define BVH "build/loader-take.bvh"
#define SCORE "build/loader-score.txt"

// what `done` was told
static char told[16][512];
static int tellings;

static void tell(void *user, const char *text)
{
    (void)user;
    snprintf(told[tellings++ % 16], sizeof told[0], "%s", text ? text : "done");
}

static himc_loader *loader_new(void)
{
    himc_loader *loader = himc_loader_new(&error);
    TEST_ASSERT_NOT_NULL_MESSAGE(loader, error.text);
    tellings = 0;
    return loader;
}

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
}

static void write_take(void)
{
    himc_skeleton skeleton;
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_take *take = beaten_file(BVH, &skeleton, 100, 1, &error);
    TEST_ASSERT_TRUE_MESSAGE(take && himc_take_save(take, BVH, &error), error.text);
    himc_take_free(take);
}

// a performer's command through the loader
static bool ask(himc_loader *loader, himc_performance *p, const char *text)
{
    himc_command c;
    himc_load_target target = {.performance = p, .done = tell};
    return himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) &&
           himc_loader_command(loader, &target, &c, &error);
}

static bool ask_drum(himc_loader *loader, himc_drum *drum, const char *text)
{
    himc_command c;
    himc_load_target target = {.drum = drum, .done = tell};
    return himc_command_parse_text(&c, HIMC_DRUM, text, &error) &&
           himc_loader_command(loader, &target, &c, &error);
}

static himc_membrane *head_of(himc_performance *p)
{
    return himc_drum_membrane(himc_performance_drum(p, 0));
}

static int modes_of(himc_performance *p)
{
    return himc_membrane_head(head_of(p))->modes;
}

// a performer on one kettle, and the commands, at once or through a loader
static heard play(const char *const *commands, bool loaded, double sound[4800])
{
    heard h = {0};
    himc_performance *p = session_new();
    himc_loader *loader = loader_new();
    session_do(p, "drum kettle 26");
    for (; *commands; commands++)
        TEST_ASSERT_TRUE_MESSAGE(
            loaded ? ask(loader, p, *commands) : session_try(p, "%s", *commands), error.text);
    himc_loader_finish(loader);
    session_play(p, 3, &h);
    himc_drum *drum = himc_performance_drum(p, 0);
    himc_drum_read(drum, himc_drum_time(drum) - 4800, 4800, sound, NULL);
    himc_loader_free(loader);
    himc_performance_free(p);
    return h;
}

static void same_as_at_once(const char *const *commands)
{
    static double a[4800], b[4800];
    heard once = play(commands, false, a), loaded = play(commands, true, b);
    TEST_ASSERT_GREATER_THAN(2, once.strikes);
    TEST_ASSERT_EQUAL_INT(once.strikes, loaded.strikes);
    TEST_ASSERT_EQUAL_INT(once.notes, loaded.notes);
    TEST_ASSERT_EQUAL_STRING(once.note, loaded.note);
    TEST_ASSERT_EQUAL_INT(0, memcmp(a, b, sizeof a));
    for (int i = 0; i < once.strikes; i++) {
        TEST_ASSERT_TRUE(once.strike[i].time == loaded.strike[i].time);
        TEST_ASSERT_TRUE(once.strike[i].force == loaded.strike[i].force);
    }
    heard_free(&once);
    heard_free(&loaded);
}

static void test_a_take_from_the_helper_plays_as_one_loaded_at_once(void)
{
    write_take();
    same_as_at_once((const char *const[]){"take " BVH, "play", NULL});
}

static void test_a_score_from_the_helper_plays_as_one_loaded_at_once(void)
{
    write_take();
    write_text(
        SCORE,
        "kettle modes 150; kettle tension 4000; kettle mallet hard; drum small 23; drum other;\n"
        "units " BVH " legato; small place 0.8 -0.6 0.85; player 1.9 90;\n"
        "stroke 1 left legato f; stroke 1.5 right accent mf; tempo 120;\n"
        "stroke 2 left legato mf normal other; small tension 3000; play;\n");
    same_as_at_once((const char *const[]){"score " SCORE, NULL});
}

static void test_a_score_with_a_take_loads_it_as_a_job_of_its_own(void)
{
    write_take();
    write_text(SCORE, "mode id; take " BVH "; kettle modes 90; play;\n");
    same_as_at_once((const char *const[]){"score " SCORE, NULL});
}

static void test_units_and_a_recording_begin_as_at_once(void)
{
    write_take();
    same_as_at_once((const char *const[]){"units " BVH " accent", "stroke 1 left accent f",
                                          "stroke 1.5 right accent f", "stroke 2 left accent f",
                                          "record build/loader-record.bvh", "play", NULL});
}

static void test_what_comes_behind_a_load_waits_for_it(void)
{
    himc_performance *p = session_new();
    himc_loader *loader = loader_new();
    session_do(p, "drum kettle 26");
    himc_drum *drum = himc_performance_drum(p, 0);
    TEST_ASSERT_TRUE(ask_drum(loader, drum, "modes 300"));
    TEST_ASSERT_TRUE(ask_drum(loader, drum, "place 1 0 0.9"));
    TEST_ASSERT_TRUE(ask_drum(loader, drum, "modes 40"));
    TEST_ASSERT_TRUE(ask(loader, p, "player 1.7 60"));
    TEST_ASSERT_EQUAL_INT(HIMC_MODES_AUTO, modes_of(p));
    TEST_ASSERT_FALSE(himc_drum_head_frame(drum)->center.x == 1);
    while (modes_of(p) == HIMC_MODES_AUTO)
        himc_loader_run(loader);
    TEST_ASSERT_EQUAL_INT(300, modes_of(p));
    himc_loader_finish(loader);
    TEST_ASSERT_EQUAL_INT(40, modes_of(p));
    TEST_ASSERT_TRUE(himc_drum_head_frame(drum)->center.x == 1);
    TEST_ASSERT_EQUAL_INT(4, tellings);
    TEST_ASSERT_EQUAL_STRING("done", told[3]);
    TEST_ASSERT_FALSE(himc_loader_run(loader));
    himc_loader_free(loader);
    himc_performance_free(p);
}

static void test_a_failed_load_is_told_in_its_line_and_the_next_go_on(void)
{
    himc_performance *p = session_new();
    himc_loader *loader = loader_new();
    session_do(p, "drum kettle 26");
    write_text(SCORE, "kettle modes 90; stroke 1 left legato f; take missing.bvh;\n");
    TEST_ASSERT_TRUE(ask(loader, p, "take missing.bvh"));
    TEST_ASSERT_TRUE(ask(loader, p, "score " SCORE));
    TEST_ASSERT_TRUE(ask(loader, p, "record stop"));
    TEST_ASSERT_TRUE(ask(loader, p, "rate physics 9000"));
    TEST_ASSERT_TRUE(ask_drum(loader, himc_performance_drum(p, 0), "shape missing.txt"));
    himc_loader_finish(loader);
    TEST_ASSERT_EQUAL_INT(5, tellings);
    TEST_ASSERT_NOT_NULL(strstr(told[0], "missing.bvh"));
    TEST_ASSERT_NOT_NULL(strstr(told[1], SCORE ":1: missing.bvh"));
    TEST_ASSERT_EQUAL_STRING("record: stop: nothing is being recorded, expected FILE", told[2]);
    TEST_ASSERT_EQUAL_STRING("done", told[3]);
    TEST_ASSERT_NOT_NULL(strstr(told[4], "missing.txt"));
    TEST_ASSERT_EQUAL_INT(HIMC_MODES_AUTO, modes_of(p)); // nothing of the score was installed
    himc_loader_free(loader);
    himc_performance_free(p);
}

static void *policy_of_a_helper(void *policy)
{
    himc_system_give_way();
    *(int *)policy = sched_getscheduler(0);
    return NULL;
}

// as in Pure Data with -rt, which the system allows root and members of its audio group
static void test_helpers_of_a_host_of_real_time_priority_have_none(void)
{
    struct sched_param urgent = {.sched_priority = 6}, usual = {.sched_priority = 0};
    if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &urgent) != 0)
        TEST_IGNORE_MESSAGE("real-time priority is not allowed here");
    himc_performance *p = session_new();
    himc_loader *loader = loader_new();
    ask(loader, p, "take missing.bvh");
    himc_loader_run(loader);
    pthread_t network;
    int policy = -1;
    TEST_ASSERT_EQUAL_INT(0, pthread_create(&network, NULL, policy_of_a_helper, &policy));
    pthread_join(network, NULL);
    TEST_ASSERT_EQUAL_INT(SCHED_OTHER, policy);
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &usual);
    himc_loader_finish(loader);
    TEST_ASSERT_EQUAL_INT(1, tellings);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told[0], "missing.bvh"), told[0]);
    himc_loader_free(loader);
    himc_performance_free(p);
}

static void test_the_257th_command_that_waits_is_dropped_with_a_line(void)
{
    himc_performance *p = session_new();
    himc_loader *loader = loader_new();
    session_do(p, "drum kettle 26");
    TEST_ASSERT_TRUE(ask(loader, p, "take missing.bvh"));
    for (int i = 1; i < 256; i++)
        TEST_ASSERT_TRUE(ask(loader, p, "clear"));
    TEST_ASSERT_FALSE(ask(loader, p, "clear"));
    TEST_ASSERT_EQUAL_STRING("more than 256 commands wait: this one is dropped", error.text);
    TEST_ASSERT_TRUE(ask(loader, p, "clear")); // counted
    himc_loader_finish(loader);
    TEST_ASSERT_EQUAL_INT(257, tellings);
    TEST_ASSERT_EQUAL_STRING("2 commands dropped: more than 256 waited", told[256 % 16]);
    TEST_ASSERT_TRUE(ask(loader, p, "clear"));
    himc_loader_free(loader);
    himc_performance_free(p);
}

static void test_a_drum_changed_meanwhile_keeps_both_changes(void)
{
    himc_performance *p = session_new();
    himc_loader *loader = loader_new();
    session_do(p, "drum kettle 26");
    himc_drum *drum = himc_performance_drum(p, 0);
    write_text(SCORE, "kettle decay 0.7;\n");
    TEST_ASSERT_TRUE(ask_drum(loader, drum, "modes 300"));
    TEST_ASSERT_TRUE(ask(loader, p, "score " SCORE));
    himc_loader_run(loader);
    session_drum(p, 0, "tension 4321");
    while (modes_of(p) != 300)
        himc_loader_run(loader);
    while (himc_loader_run(loader) && tellings == 1)
        session_drum(p, 0, "damp 0.25"); // each portion finds it as it was tried
    himc_loader_finish(loader);
    const himc_head *head = himc_membrane_head(himc_drum_membrane(drum));
    TEST_ASSERT_TRUE(head->tension == 4321);
    TEST_ASSERT_EQUAL_INT(300, head->modes);
    TEST_ASSERT_TRUE(head->damp == 0.25 &&
                     head->decay_constant == (float)(log(1000) / (double)0.7f));
    himc_loader_free(loader);
    himc_performance_free(p);
}

static void test_a_drum_that_changes_all_the_time_does_not_hold_up_a_load(void)
{
    static const char *const loads[] = {"score " SCORE, "take " BVH};
    himc_performance *p = session_new();
    himc_loader *loader = loader_new();
    double tension = 3000;
    session_do(p, "drum kettle 26");
    himc_drum *drum = himc_performance_drum(p, 0);
    write_take();
    write_text(SCORE, "kettle modes 90; kettle decay 0.7; stroke 1 left legato f;\n");
    for (int i = 0; i < 3; i++) {
        long runs = 0;
        TEST_ASSERT_TRUE(i < 2 ? ask(loader, p, loads[i]) : ask_drum(loader, drum, "modes 60"));
        for (char text[64]; himc_loader_run(loader); runs++) {
            snprintf(text, sizeof text, "tension %g", tension++);
            session_drum(p, 0, text);
            snprintf(text, sizeof text, "place %g 0 0.85", 0.6 + 0.001 * (runs % 100));
            session_drum(p, 0, text);
            TEST_ASSERT_LESS_THAN(1000000, runs);
        }
        TEST_ASSERT_EQUAL_STRING("done", told[i]);
        TEST_ASSERT_EQUAL_INT(i < 2 ? 90 : 60, modes_of(p));
    }
    himc_loader_free(loader);
    himc_performance_free(p);
}

// a head exchanged while it sounds goes on as one that was changed in place
static void test_a_head_from_the_helper_sounds_on_as_one_changed_in_place(void)
{
    static const char *const change[] = {"tension 2500", "pickups 4", "damp 0.4", "modes 160",
                                         "radius 0.31",  "glide 0.5", NULL};
    for (int i = 0; change[i]; i++) {
        static double sound[2][4800];
        double loudest = 0;
        for (int loaded = 0; loaded < 2; loaded++) {
            himc_command c;
            himc_drum *drum = himc_drum_new("kettle", 26, 48000, &error);
            TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, 0.1, 0.02, 3, &error));
            himc_drum_advance(drum, 1500, NULL, NULL, NULL);
            TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, change[i], &error));
            bool good = loaded ? himc_job_carry_out(himc_drum_job(drum, &c, &error), &error)
                               : himc_drum_command(drum, &c, &error);
            TEST_ASSERT_TRUE_MESSAGE(good, error.text);
            himc_drum_advance(drum, 4800, NULL, NULL, NULL);
            himc_drum_read(drum, 1500, 4800, sound[loaded], NULL);
            himc_drum_release(drum);
        }
        for (int k = 0; k < 4800; k++)
            loudest = fmax(loudest, fabs(sound[0][k]));
        TEST_ASSERT_TRUE(loudest > 1e-3);
        for (int k = 0; k < 4800; k++)
            TEST_ASSERT_TRUE_MESSAGE(fabs(sound[0][k] - sound[1][k]) <= 1e-9 * loudest, change[i]);
    }
}

static void test_a_head_is_installed_without_the_allocator(void)
{
    if (!CAN_FAIL_ALLOCATIONS)
        TEST_IGNORE_MESSAGE("the sanitizer has an allocator of its own");
    himc_loader *loader = loader_new();
    himc_drum *drum = himc_drum_new("kettle", 26, 48000, &error);
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, 0.1, 0.02, 3, &error));
    himc_drum_advance(drum, 100, NULL, NULL, NULL);
    TEST_ASSERT_TRUE(ask_drum(loader, drum, "modes 500"));
    himc_loader_run(loader); // the job is made
    watch_allocations();
    while (himc_loader_run(loader))
        sched_yield();
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
    TEST_ASSERT_EQUAL_INT(500, himc_membrane_head(himc_drum_membrane(drum))->modes);
    himc_loader_free(loader);
    himc_drum_release(drum);
}

// what was prepared for another sample rate takes the one that is there when it is installed
static void test_the_sample_rate_may_change_while_a_load_is_prepared(void)
{
    static const char *const loads[] = {"score " SCORE, "drum third 29", "take " BVH};
    himc_performance *p = session_new();
    session_do(p, "drum kettle 26");
    write_take();
    write_text(SCORE, "drum second 29; kettle modes 90; stroke 1 left legato f second;\n");
    for (int i = 0; i < 4; i++) {
        double rate = i % 2 ? 48000 : 44100;
        himc_drum *kettle = himc_performance_drum(p, 0);
        himc_loader *loader = loader_new();
        TEST_ASSERT_TRUE_MESSAGE(
            i < 3 ? ask(loader, p, loads[i]) : ask_drum(loader, kettle, "modes 70"), error.text);
        himc_loader_run(loader); // the job is made
        TEST_ASSERT_TRUE_MESSAGE(himc_performance_set_rate(p, rate, &error), error.text);
        himc_loader_finish(loader);
        himc_loader_free(loader);
        TEST_ASSERT_EQUAL_STRING("done", told[0]);
        for (int k = 0; himc_performance_drum(p, k); k++) {
            himc_drum *drum = himc_performance_drum(p, k);
            TEST_ASSERT_EQUAL_DOUBLE(rate, himc_drum_rate(drum));
            TEST_ASSERT_EQUAL_DOUBLE(rate, himc_membrane_rate(himc_drum_membrane(drum)));
        }
    }
    TEST_ASSERT_EQUAL_STRING("third", himc_drum_name(himc_performance_drum(p, 2)));
    TEST_ASSERT_EQUAL_INT(70, modes_of(p));
    himc_performance_free(p);
}

// the thread sanitizer sees whether the helper touches what plays
static void test_the_sound_goes_on_while_the_helper_works(void)
{
    static const char *const loads[] = {"score " SCORE, "take " BVH, "units " BVH " legato",
                                        "record build/loader-record.bvh", "record stop"};
    write_take();
    write_text(SCORE, "kettle modes 200; drum other 29; stroke 1 left legato f other;\n"
                      "stroke 2 right legato f; kettle shape rectangle 0.6 0.5; play;\n");
    himc_performance *p = session_new();
    himc_loader *loader = loader_new();
    session_do(p, "drum kettle 26");
    session_do(p, "score " SCORE);
    for (int i = 0; i < 15; i++) {
        long blocks = 0;
        TEST_ASSERT_TRUE_MESSAGE(ask(loader, p, loads[i % 5]), error.text);
        TEST_ASSERT_TRUE(ask_drum(loader, himc_performance_drum(p, 0), "modes 260"));
        for (; himc_loader_run(loader); blocks++)
            himc_performance_process(p, 64, NULL);
        TEST_ASSERT_GREATER_THAN(0, blocks);
        himc_performance_process(p, 4800, NULL);
    }
    TEST_ASSERT_EQUAL_INT(30, tellings);
    // one that is under way, and one that waits, are dropped with the loader
    TEST_ASSERT_TRUE(ask(loader, p, "take " BVH) && ask(loader, p, "score " SCORE));
    himc_loader_run(loader);
    himc_loader_free(loader);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_take_from_the_helper_plays_as_one_loaded_at_once);
    RUN_TEST(test_a_score_from_the_helper_plays_as_one_loaded_at_once);
    RUN_TEST(test_a_score_with_a_take_loads_it_as_a_job_of_its_own);
    RUN_TEST(test_units_and_a_recording_begin_as_at_once);
    RUN_TEST(test_what_comes_behind_a_load_waits_for_it);
    RUN_TEST(test_a_failed_load_is_told_in_its_line_and_the_next_go_on);
    RUN_TEST(test_helpers_of_a_host_of_real_time_priority_have_none);
    RUN_TEST(test_the_257th_command_that_waits_is_dropped_with_a_line);
    RUN_TEST(test_a_drum_changed_meanwhile_keeps_both_changes);
    RUN_TEST(test_a_drum_that_changes_all_the_time_does_not_hold_up_a_load);
    RUN_TEST(test_a_head_from_the_helper_sounds_on_as_one_changed_in_place);
    RUN_TEST(test_a_head_is_installed_without_the_allocator);
    RUN_TEST(test_the_sample_rate_may_change_while_a_load_is_prepared);
    RUN_TEST(test_the_sound_goes_on_while_the_helper_works);
    return UNITY_END();
}
