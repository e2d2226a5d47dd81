/// test_alive.c: with `alive 1` head, trunk and breath move with the music and the tips do as before.
#include "session.h"

#include "performance/performance_state.h"

static himc_performance *with_two_drums(bool alive)
{
    himc_performance *p = session_new();
    session_do(p, "drum left");
    session_do(p, "drum right");
    session_drum(p, 0, "place 0.5 0.5 0.85");
    session_drum(p, 1, "place 0.5 -0.5 0.85");
    if (alive)
        session_do(p, "alive 1");
    session_do(p, "tempo 60");
    for (int i = 0; i < 3; i++) {
        session_do(p, "stroke %d left legato mf normal left", 3 + 2 * i);
        session_do(p, "stroke %d right accent f normal right", 4 + 2 * i);
    }
    session_do(p, "play");
    return p;
}

/// The direction of the head: azimuth to the left and elevation (rad).
static void gaze(const himc_performance *p, double *azimuth, double *elevation)
{
    const himc_mat3 *r = &p->body->state.rotation[HIMC_HEAD];
    *azimuth = atan2(r->m[1][0], r->m[0][0]);
    *elevation = asin(r->m[2][0]);
}

static void test_head_turns_to_the_drum_of_the_next_stroke_and_to_the_front_after_the_last(void)
{
    himc_performance *p = with_two_drums(true);
    double azimuth, elevation, rest;
    session_play(p, 3.85, NULL); // the right drum is next
    gaze(p, &azimuth, &elevation);
    TEST_ASSERT_TRUE(azimuth < -0.3);
    session_play(p, 1, NULL); // the left one
    gaze(p, &azimuth, &elevation);
    TEST_ASSERT_TRUE(azimuth > 0.3);
    session_play(p, 6, NULL); // the conductor
    gaze(p, &azimuth, &rest);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0, azimuth);
    TEST_ASSERT_TRUE(rest > elevation + 0.2);
    himc_performance_free(p);
}

static void test_head_is_lifted_before_the_first_note(void)
{
    himc_performance *p = with_two_drums(true);
    double azimuth, before, lifted, after;
    session_play(p, 2, NULL);
    gaze(p, &azimuth, &before);
    session_play(p, 0.6, NULL);
    gaze(p, &azimuth, &lifted);
    session_play(p, 0.4, NULL);
    gaze(p, &azimuth, &after);
    TEST_ASSERT_TRUE(lifted > before + 0.05 && lifted > after + 0.05);
    himc_performance_free(p);
}

static void test_trunk_breathes_and_sways_at_rest(void)
{
    himc_performance *p = session_new();
    double low[2] = {1, 1}, high[2] = {-1, -1};
    session_do(p, "drum kettle");
    session_do(p, "alive 1");
    session_play(p, 1, NULL);
    for (int i = 0; i < 90; i++) {
        session_play(p, 0.1, NULL);
        for (int k = 0; k < 2; k++) { // forward and to the left
            double lean = p->body->state.rotation[HIMC_TRUNK].m[k][2];
            low[k] = fmin(low[k], lean);
            high[k] = fmax(high[k], lean);
        }
    }
    for (int k = 0; k < 2; k++)
        TEST_ASSERT_TRUE(high[k] - low[k] > 0.008 && high[k] - low[k] < 0.06);
    himc_performance_free(p);
}

static void test_tips_strike_as_without_and_0_is_as_never_said(void)
{
    himc_performance *p[3];
    double rms[3];
    for (int k = 0; k < 3; k++) {
        p[k] = with_two_drums(k == 1);
        if (k == 2)
            session_do(p[k], "alive 0");
        session_play(p[k], 10, NULL);
        rms[k] = himc_performance_measure(p[k]).tip_rms;
        TEST_ASSERT_EQUAL_INT(6, himc_performance_measure(p[k]).played);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, rms[0], rms[1]);
    TEST_ASSERT_EQUAL_MEMORY(&p[0]->body->state, &p[2]->body->state, sizeof p[0]->body->state);
    for (int k = 0; k < 3; k++)
        himc_performance_free(p[k]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_head_turns_to_the_drum_of_the_next_stroke_and_to_the_front_after_the_last);
    RUN_TEST(test_head_is_lifted_before_the_first_note);
    RUN_TEST(test_trunk_breathes_and_sways_at_rest);
    RUN_TEST(test_tips_strike_as_without_and_0_is_as_never_said);
    return UNITY_END();
}
