/// Heads that change at beats of a score: pedals and damping, `at BEAT DRUM COMMAND`.
#include "session.h"

#include "allocations.h"
#include "himc/membrane.h"

#define SCORE "build/head-changes.txt"
#define DRUM "drum low 26; low tune A2; tempo 120; "
#define STROKES "stroke 1 right legato f; stroke 3 left legato f; stroke 5.5 right legato f; "

static void load(himc_performance *p, const char *text)
{
    session_score(p, SCORE, text);
}

static himc_performance *with_score(const char *text)
{
    himc_performance *p = session_new();
    load(p, text);
    return p;
}

static himc_membrane *head(himc_performance *p, int drum)
{
    return himc_drum_membrane(himc_performance_drum(p, drum));
}

static double pitch(himc_performance *p)
{
    return himc_membrane_principal(head(p, 0), himc_membrane_head(head(p, 0)));
}

static double damping(himc_performance *p)
{
    return himc_membrane_head(head(p, 0))->damp;
}

#define A2 110.0
#define D3 146.832

static void test_a_pedal_and_a_hand_act_on_their_beats(void)
{
    himc_performance *p = with_score(DRUM "at 4 low tune D3; at 2 low damp 1; at 2.5 low damp 0; "
                                          "at 4 low damp 0.5; " STROKES "play;");
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    session_play(p, 0.99, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_play(p, 0.02, NULL); // beat 2 is at 1 s
    TEST_ASSERT_EQUAL_DOUBLE(1, damping(p));
    session_play(p, 0.25, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    session_play(p, 0.75, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, damping(p)); // both lines of the beat
    himc_performance_free(p);
}

static void read_all(himc_performance *p, double *sound, long from, long to)
{
    for (long at = from; at < to; at += 480) {
        himc_performance_process(p, 480, NULL);
        himc_drum_read(himc_performance_drum(p, 0), (uint64_t)at, 480, sound + at, NULL);
    }
}

// the head prepared ahead sounds as one that a command makes at that moment, to the last bit
static void test_a_change_sounds_as_the_command_given_then(void)
{
    enum { LENGTH = 3 * 48000, AT = 72000 }; // beat 3.0 at 120 per minute
    static double written[LENGTH], given[LENGTH];
    himc_performance *p = with_score(DRUM "at 3 low tune C3; " STROKES "play;");
    read_all(p, written, 0, LENGTH);
    himc_performance_free(p);
    p = with_score(DRUM STROKES "play;");
    read_all(p, given, 0, AT);
    session_drum(p, 0, "tune C3");
    read_all(p, given, AT, LENGTH);
    himc_performance_free(p);
    TEST_ASSERT_EQUAL_MEMORY(given, written, sizeof given);
    TEST_ASSERT_TRUE(fabs(given[AT + 1000]) > 1e-4); // it rang
}

static void test_changes_need_no_memory_and_follow_the_transport(void)
{
    himc_performance *p =
        with_score(DRUM "at 1.5 low tune D3; at 2 low damp 1; " STROKES "loop 1; play;");
    session_play(p, 0.5, NULL);
    watch_allocations();
    session_play(p, 1.0, NULL);
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(1, damping(p));
    session_play(p, 2.0, NULL); // a round is 6 beats, 3 s
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_do(p, "seek 1.75");
    session_play(p, 0.1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_do(p, "stop");
    session_play(p, 2.0, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p)); // beat 2 was not played
    himc_performance_free(p);
}

// the listener came after the score: the heads made ahead do not fit, and are computed then
static void test_changes_act_on_a_drum_that_has_changed_meanwhile(void)
{
    himc_performance *p = with_score(DRUM "at 2 low tune D3; " STROKES);
    session_do(p, "listener 2 0 1.4");
    session_drum(p, 0, "pickups 2");
    session_do(p, "play");
    session_play(p, 1.1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    int pickups;
    himc_membrane_pickups(head(p, 0), &pickups);
    TEST_ASSERT_EQUAL_INT(2, pickups);
    himc_performance_free(p);
}

static void test_a_queued_score_changes_heads_from_its_own_beats_on(void)
{
    himc_performance *p =
        with_score(DRUM "at 1 low tune D3; at 3 low tune C3; stroke 1 right legato f; "
                        "stroke 3.5 left legato f; play;"); // 4 beats: 2 s
    session_play(p, 0.6, NULL);
    load(p, "at 1 low tune E3; stroke 1 right legato f; stroke 3 left legato f;");
    session_play(p, 0.2, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    session_play(p, 1.0, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.813, pitch(p));
    session_play(p, 1.5, NULL); // past beat 1 of the second at its tempo of 100
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 164.814, pitch(p));
    session_do(p, "seek 3.2"); // back into the first, where it was when it ended
    session_play(p, 0.1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.813, pitch(p));
    himc_performance_free(p);
}

static void test_clear_and_another_score_end_the_changes(void)
{
    for (int other = 0; other < 2; other++) {
        himc_performance *p = with_score(DRUM "at 1 low tune D3; stroke 1 right legato f;");
        if (other)
            load(p, "stroke 2 right legato f;");
        else
            session_do(p, "clear");
        session_do(p, "stroke 3 left legato f");
        session_do(p, "play");
        session_play(p, 1.5, NULL);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
        himc_performance_free(p);
    }
}

static void refused(const char *text, const char *expected)
{
    himc_performance *p = session_new();
    FILE *file = fopen(SCORE, "w");
    fputs(text, file);
    fclose(file);
    TEST_ASSERT_FALSE(session_try(p, "score " SCORE));
    TEST_ASSERT_EQUAL_STRING(expected, error.text);
    TEST_ASSERT_NULL(himc_performance_drum(p, 0)); // and nothing was done
    himc_performance_free(p);
}

static void test_a_wrong_change_is_refused_with_its_line(void)
{
    refused("drum low;\nat 2 low mallet hard;",
            SCORE ":2: at: mallet, allowed what changes a head: tune, tension, damp, decay, glide");
    refused("drum low;\n\nat 2 low tune;",
            SCORE ":3: low: tune: HZ missing, allowed tune HZ | NOTE");
    refused("drum low;\nat -1 low tune A2;", SCORE ":2: at: BEAT: allowed 0 .. 1e+06");
    refused("drum low;\nat low tune A2;", SCORE ":2: at: BEAT: allowed 0 .. 1e+06");
    refused("drum low;\nat 2 low;",
            SCORE ":2: at: allowed at BEAT DRUM COMMAND ..., at BEAT push ...");
    refused("drum low 60;\nat 7 low damp 1; at 8 low tune 2000;",
            SCORE ":2: low: tune: 2000 Hz, allowed 2.58125 .. 215.288 Hz");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_pedal_and_a_hand_act_on_their_beats);
    RUN_TEST(test_a_change_sounds_as_the_command_given_then);
    RUN_TEST(test_changes_need_no_memory_and_follow_the_transport);
    RUN_TEST(test_changes_act_on_a_drum_that_has_changed_meanwhile);
    RUN_TEST(test_a_queued_score_changes_heads_from_its_own_beats_on);
    RUN_TEST(test_clear_and_another_score_end_the_changes);
    RUN_TEST(test_a_wrong_change_is_refused_with_its_line);
    return UNITY_END();
}
