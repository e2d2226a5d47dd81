/// test_loader_post.c: commands posted by another thread than the one that plays: the same result
/// as at once, in order, none lost; a full queue and each refusal are told to the thread that
/// posts. It is meant to run under the thread sanitizer, too.
#include "session.h"

#include "himc/loader.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

#define SCORE "build/loader-post-score.txt"
#define HITS 600    // more than twice what may wait
#define CLEARED 110 // each so many-th is `clear`: out of their order other strokes would remain

typedef struct callback {
    himc_performance *performance;
    himc_loader *loader;
    _Atomic bool stop;
    long blocks;
} callback;

// the audio thread: blocks as a sound card asks for them
static void *play_on(void *user)
{
    callback *c = user;
    float sound[2 * 64];
    for (; !atomic_load(&c->stop); c->blocks++) {
        himc_loader_run(c->loader);
        himc_performance_read(c->performance, sound, 2, 64);
        sched_yield();
    }
    return NULL;
}

static callback callback_new(void)
{
    callback c = {.performance = session_new(), .loader = himc_loader_new(&error)};
    TEST_ASSERT_NOT_NULL_MESSAGE(c.loader, error.text);
    session_do(c.performance, "drum kettle 26");
    return c;
}

static void callback_free(callback *c)
{
    himc_loader_free(c->loader);
    himc_performance_free(c->performance);
}

static bool post(callback *c, const char *text)
{
    return himc_loader_post(c->loader, c->performance, text, &error);
}

static void test_posted_commands_give_the_sound_of_the_same_commands_sent(void)
{
    static const char *const commands[] = {"kettle mallet hard",      ("score " SCORE),
                                           "stroke 1 left legato ff", "tempo 150",
                                           "kettle tension 3500",     "play"};
    static float sound[2][2 * 96000];
    FILE *file = fopen(SCORE, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs("stroke 0 right legato f; stroke 2 right accent mf;\n", file);
    fclose(file);
    for (int posted = 0; posted < 2; posted++) {
        callback c = callback_new();
        for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
            bool good = posted ? post(&c, commands[i])
                               : himc_performance_send(c.performance, commands[i], &error);
            TEST_ASSERT_TRUE_MESSAGE(good, error.text);
        }
        TEST_ASSERT_EQUAL_INT(posted, himc_loader_busy(c.loader));
        himc_loader_finish(c.loader);
        TEST_ASSERT_TRUE(himc_performance_read(c.performance, sound[posted], 2, 96000) > 0.001);
        TEST_ASSERT_EQUAL_INT(3, himc_performance_measure(c.performance).strokes);
        TEST_ASSERT_FALSE(himc_loader_refused(c.loader, &error));
        callback_free(&c);
    }
    TEST_ASSERT_EQUAL_MEMORY(sound[0], sound[1], sizeof sound[0]);
}

static void test_commands_posted_while_another_thread_plays_all_act_in_their_order(void)
{
    callback c = callback_new();
    pthread_t thread;
    char text[64];

    TEST_ASSERT_EQUAL_INT(0, pthread_create(&thread, NULL, play_on, &c));
    for (int i = 0; i < HITS; i++) {
        snprintf(text, sizeof text, i % CLEARED ? "stroke %d left legato mf" : "clear", i);
        while (!post(&c, text)) {
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "256 commands wait"), error.text);

            sched_yield();
        }
    }
    while (!post(&c, "tempo 90 40") || himc_loader_refused(c.loader, &error))
        sched_yield();
    while (!post(&c, "stroke 1e3 left legato mf nowhere"))
        sched_yield();
    himc_error refusal = {""};
    while (!himc_loader_refused(c.loader, &refusal)) // the last has been carried out
        sched_yield();
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(refusal.text, "nowhere"), refusal.text);
    atomic_store(&c.stop, true);
    pthread_join(thread, NULL);
    TEST_ASSERT_GREATER_THAN(HITS / 256, c.blocks);
    // where a stroke of theirs remains another one of that hand is refused
    const int last = (HITS - 1) / CLEARED * CLEARED;
    for (int i = 1; i <= HITS; i++)
        TEST_ASSERT_EQUAL(i <= last || i == HITS,
                          session_try(c.performance, "stroke %d left legato mf", i));
    callback_free(&c);
}

static void test_an_instrument_that_was_posted_is_there_for_the_next_command(void)
{
    callback c = callback_new();
    TEST_ASSERT_TRUE_MESSAGE(post(&c, "setup kit"), error.text);
    TEST_ASSERT_TRUE_MESSAGE(post(&c, "snare tune 220"), error.text);
    TEST_ASSERT_TRUE_MESSAGE(post(&c, "snare wires 0"), error.text);
    himc_loader_finish(c.loader);
    bool refused = himc_loader_refused(c.loader, &error);
    TEST_ASSERT_FALSE_MESSAGE(refused, error.text);
    callback_free(&c);
}

static void test_one_run_changes_one_head_at_most(void)
{
    callback c = callback_new();
    for (int i = 0; i < 3; i++)
        TEST_ASSERT_TRUE(post(&c, i == 1 ? "kettle tension 3000" : "kettle tension 4000"));
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_TRUE(himc_loader_busy(c.loader));
        himc_loader_run(c.loader);
    }
    TEST_ASSERT_FALSE(himc_loader_busy(c.loader));
    callback_free(&c);
}

static void test_a_full_queue_is_told_and_takes_again_after_a_run(void)
{
    callback c = callback_new();
    for (int i = 0; i < HIMC_LOADER_POSTS; i++)
        TEST_ASSERT_TRUE_MESSAGE(post(&c, "clear"), error.text);
    TEST_ASSERT_FALSE(post(&c, "clear"));
    TEST_ASSERT_EQUAL_STRING("256 commands wait: this one is not taken", error.text);
    himc_loader_run(c.loader);
    TEST_ASSERT_TRUE_MESSAGE(post(&c, "clear"), error.text);
    himc_loader_finish(c.loader);
    TEST_ASSERT_FALSE(himc_loader_busy(c.loader));
    TEST_ASSERT_FALSE(himc_loader_refused(c.loader, &error));
    callback_free(&c);
}

static void test_what_is_no_command_is_refused_where_it_is_posted(void)
{
    callback c = callback_new();
    TEST_ASSERT_FALSE(post(&c, "stroke 1 third legato f"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "third"), error.text);
    TEST_ASSERT_FALSE(post(&c, "kettle tension much"));
    TEST_ASSERT_FALSE(himc_loader_busy(c.loader));
    callback_free(&c);
}

static void test_refusals_come_back_in_order_and_those_beyond_64_are_counted(void)
{
    callback c = callback_new();
    char text[64];
    for (int i = 0; i < 70; i++) {
        snprintf(text, sizeof text, "take missing%d.bvh", i);
        TEST_ASSERT_TRUE_MESSAGE(post(&c, text), error.text);
    }
    himc_loader_finish(c.loader);
    for (int i = 0; i < 64; i++) {
        snprintf(text, sizeof text, "missing%d.bvh", i);
        TEST_ASSERT_TRUE(himc_loader_refused(c.loader, &error));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, text), error.text);
    }
    TEST_ASSERT_TRUE(himc_loader_refused(c.loader, &error));
    TEST_ASSERT_EQUAL_STRING("6 further commands were refused", error.text);
    TEST_ASSERT_FALSE(himc_loader_refused(c.loader, &error));
    callback_free(&c);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_posted_commands_give_the_sound_of_the_same_commands_sent);
    RUN_TEST(test_commands_posted_while_another_thread_plays_all_act_in_their_order);
    RUN_TEST(test_an_instrument_that_was_posted_is_there_for_the_next_command);
    RUN_TEST(test_one_run_changes_one_head_at_most);
    RUN_TEST(test_a_full_queue_is_told_and_takes_again_after_a_run);
    RUN_TEST(test_what_is_no_command_is_refused_where_it_is_posted);
    RUN_TEST(test_refusals_come_back_in_order_and_those_beyond_64_are_counted);
    return UNITY_END();
}
