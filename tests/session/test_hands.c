/// test_hands.c: a stroke that its hand cannot play is reassigned to the other hand, or given up; a
/// note says so and it is counted.
#include "session.h"

#include "body/posture.h"

static himc_performance *with_two_drums(double x, double y)
{
    himc_performance *p = session_new();
    char place[64];
    session_do(p, "drum kettle");
    session_do(p, "drum side");
    snprintf(place, sizeof place, "place %g %g 0.85", x, y);
    session_drum(p, 1, place);
    session_do(p, "tempo 60");
    return p;
}

static bool was_said(himc_performance *p, double seconds, heard *h, const char *text)
{
    himc_event event;
    bool said = false;
    for (long i = 0; i < lround(seconds * 48000); i += 480) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event)) {
            heard_event(h, &event);
            said = said || (event.kind == HIMC_EVENT_NOTE && strcmp(event.text, text) == 0);
        }
    }
    return said;
}

static void test_stroke_without_time_is_reassigned_to_the_other_hand(void)
{
    himc_performance *p = with_two_drums(0.25, 0.8);
    heard h = {0};
    session_do(p, "stroke 2 left legato f");
    session_do(p, "stroke 2.06 left legato f side");
    session_do(p, "stroke 3 right legato f");
    session_do(p, "play");
    TEST_ASSERT_TRUE(was_said(
        p, 6, &h, "stroke at beat 2.06 left side: no time to prepare it, the right hand plays it"));
    TEST_ASSERT_EQUAL_INT(3, h.strikes);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, h.strike[1].hand);
    TEST_ASSERT_EQUAL_STRING("side", h.strike[1].drum);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 2.06, h.strike[1].time);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(3, s.strokes);
    TEST_ASSERT_EQUAL_INT(3, s.played);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_stroke_that_neither_hand_can_play_is_given_up_and_missed(void)
{
    himc_performance *p = with_two_drums(0.2, 0.85);
    heard h = {0};
    session_do(p, "stroke 2 left legato f");
    session_do(p, "stroke 2 right legato f");
    session_do(p, "stroke 2.06 left legato f side");
    session_do(p, "stroke 3 right legato f");
    session_do(p, "play");
    TEST_ASSERT_TRUE(
        was_said(p, 6, &h, "stroke at beat 2.06 left side: given up, no time to prepare it"));
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(3, h.strikes);
    TEST_ASSERT_EQUAL_INT(4, s.strokes);
    TEST_ASSERT_EQUAL_INT(3, s.played);
    TEST_ASSERT_EQUAL_INT(1, s.missed);
    heard_free(&h);
    himc_performance_free(p);
}

// y of a head with its usual spot in reach of the left hand and not of the right one, 0 if there is
// none (m)
static double only_left(double away)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton skeleton;
    himc_posture posture;
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    himc_posture_init(&posture, &skeleton, 0.87);
    for (double y = 0.5; y < 2; y += 0.01) {
        himc_vec3 spot = {away, y, 0.87};
        himc_vec3 right = himc_posture_reachable(&posture, HIMC_RIGHT, spot);
        himc_vec3 left = himc_posture_reachable(&posture, HIMC_LEFT, spot);
        if (himc_vec3_length(himc_vec3_sub(right, spot)) > 0.04)
            return himc_vec3_length(himc_vec3_sub(left, spot)) < 1e-6 ? y : 0;
    }
    return 0;
}

static void test_stroke_out_of_reach_is_reassigned_to_the_nearer_hand(void)
{
    double away = -0.2, y = only_left(away);
    TEST_ASSERT_TRUE(y > 0);
    himc_performance *p = with_two_drums(away, y);
    heard h = {0};
    session_do(p, "stroke 2 right legato mf 0 0 side");
    session_do(p, "stroke 3 right legato mf kettle");
    session_do(p, "play");
    session_play(p, 6, &h);
    TEST_ASSERT_EQUAL_INT(2, h.strikes);
    TEST_ASSERT_EQUAL_INT(HIMC_LEFT, h.strike[0].hand);
    TEST_ASSERT_EQUAL_STRING("side", h.strike[0].drum);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, h.strike[1].hand);
    TEST_ASSERT_EQUAL_INT(2, himc_performance_measure(p).played);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_stroke_out_of_reach_of_both_is_missed_and_a_note_says_by_how_much(void)
{
    himc_performance *p = with_two_drums(3, 0);
    heard h = {0};
    session_do(p, "stroke 2 left legato mf kettle");
    session_do(p, "stroke 3 left legato mf side");
    session_do(p, "stroke 4 left legato mf kettle");
    session_do(p, "play");
    session_play(p, 7, &h);
    TEST_ASSERT_EQUAL_INT(2, h.notes); // of the drum, and of the stroke
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(h.note, "stroke at beat 3 left side: given up, out of reach by 1.8"), h.note);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(2, s.played);
    TEST_ASSERT_EQUAL_INT(1, s.missed);
    TEST_ASSERT_TRUE(s.tip_rms < 1e-3);
    heard_free(&h);
    himc_performance_free(p);
}

// in a loop with a tempo that always changes, each reassigned stroke sounds once
static void test_reassigned_strokes_are_played_once_however_often_they_are_planned(void)
{
    himc_performance *p = with_two_drums(0.2, -0.9);
    heard h = {0};
    session_do(p, "stroke 0 left legato f");
    session_do(p, "stroke 0.06 left legato f side");
    session_do(p, "stroke 1 right legato f");
    session_do(p, "loop 1");
    session_do(p, "play");
    for (int i = 0; i < 120; i++) {
        session_do(p, "tempo %g", 60 + 0.5 * (i & 1));
        session_play(p, 0.1, &h);
    }
    int side = 0, left = 0;
    for (int i = 0; i < h.strikes; i++) {
        side += strcmp(h.strike[i].drum, "side") == 0;
        left += h.strike[i].hand == HIMC_LEFT;
    }
    TEST_ASSERT_TRUE(left >= 5);
    TEST_ASSERT_INT_WITHIN(1, left, side);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_note_at_the_end_counts_the_strokes_not_played_as_written(void)
{
    himc_performance *p = with_two_drums(3, 0);
    heard h = {0};
    for (int i = 0; i < 5; i++)
        session_do(p, "stroke %d right legato mf side", 2 + i);
    session_do(p, "stroke 8 left legato mf kettle");
    session_do(p, "play");
    session_play(p, 12, &h);
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    TEST_ASSERT_EQUAL_INT(7, h.notes); // the drum, each of them, and the count
    TEST_ASSERT_EQUAL_STRING("in all 0 strokes softer, 0 by the other hand, 5 given up", h.note);
    TEST_ASSERT_EQUAL_INT(5, himc_performance_measure(p).missed);
    heard_free(&h);
    himc_performance_free(p);
}

// no arm folds itself up in front of the chest, whatever the hand and the way
static void test_ways_between_far_drums_go_round_the_body(void)
{
    static const double place[][2] = {
        {0.251, 0.843}, {0.832, 0.287}, {0.763, -0.439}, {0.251, -0.843}};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int from = 0; from < 4; from++)
            for (int to = 0; to < 4; to++) {
                himc_performance *p = session_new();
                heard h = {0};
                for (int i = 0; i < 4; i++) {
                    session_do(p, "drum d%d 26", i);
                    session_do(p, "d%d place %g %g 0.85", i, place[i][0], place[i][1]);
                }
                session_do(p, "strength human");
                session_do(p, "stroke 2 %s legato mf d%d", hand ? "right" : "left", from);
                session_do(p, "stroke 4 %s legato mf d%d", hand ? "right" : "left", to);
                session_do(p, "play");
                session_play(p, 3, &h);
                himc_performance_stats s = himc_performance_measure(p);
                char what[64];
                snprintf(what, sizeof what, "hand %d from %d to %d: %.3g rad/s, %.4g N m", hand,
                         from, to, s.peak_rate, s.peak_torque);
                TEST_ASSERT_EQUAL_INT_MESSAGE(2, s.played, what);
                TEST_ASSERT_TRUE_MESSAGE(s.peak_rate < 50 && s.peak_torque < 500, what);
                heard_free(&h);
                himc_performance_free(p);
            }
}

// the last milliseconds are planned anew from where the stick is
static void test_a_hit_that_a_push_has_moved_lands_on_its_time(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "drum kettle");
    session_do(p, "latency 150");
    session_play(p, 1, &h);
    for (int i = 0; i < 8; i++) {
        session_do(p, "hit left legato mf");
        session_play(p, 0.11, &h);
        session_do(p, "push left-forearm 0 0 %d 0.03", i % 2 ? 400 : -400);
        session_play(p, 0.39, &h);
    }
    TEST_ASSERT_EQUAL_INT(8, h.strikes);
    for (int i = 0; i < h.strikes; i++)
        TEST_ASSERT_DOUBLE_WITHIN(3e-4, h.strike[i].planned_time, h.strike[i].time);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_hit_that_a_push_has_moved_lands_on_its_time);
    RUN_TEST(test_ways_between_far_drums_go_round_the_body);
    RUN_TEST(test_stroke_without_time_is_reassigned_to_the_other_hand);
    RUN_TEST(test_stroke_that_neither_hand_can_play_is_given_up_and_missed);
    RUN_TEST(test_stroke_out_of_reach_is_reassigned_to_the_nearer_hand);
    RUN_TEST(test_stroke_out_of_reach_of_both_is_missed_and_a_note_says_by_how_much);
    RUN_TEST(test_reassigned_strokes_are_played_once_however_often_they_are_planned);
    RUN_TEST(test_a_note_at_the_end_counts_the_strokes_not_played_as_written);
    return UNITY_END();
}
