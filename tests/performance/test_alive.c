/// test_alive.c: with `alive 1` head, trunk and breath move with the music and the tips do as
/// before.
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

/// Angle between the direction of the head and that to a drum's centre (degrees).
static double away(const himc_performance *p, int drum)
{
    const himc_body_state *s = &p->body->state;
    himc_vec3 ahead = himc_mat3_apply(&s->rotation[HIMC_HEAD], himc_vec3_make(1, 0, 0));
    himc_vec3 to = himc_vec3_sub(himc_drums_frame(&p->drums, drum)->center, s->origin[HIMC_HEAD]);
    return acos(himc_vec3_dot(ahead, himc_vec3_unit(to))) * 180 / HIMC_PI;
}

static void test_before_a_stroke_the_head_looks_at_its_drum_as_near_as_eyes_turn(void)
{
    himc_performance *p = with_two_drums(true);
    for (int i = 0; i < 6; i++) { // strokes at 3 s and every second after
        session_play(p, i ? 1 : 2.8, NULL);
        int next = i % 2;
        printf("%.1f degrees from the next drum, %.1f from the other\n", away(p, next),
               away(p, !next));
        TEST_ASSERT_TRUE(away(p, next) < 15 && away(p, !next) > 60);
    }
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

/// Two strokes, then the drum is damped from beat 3 to 4.
static himc_performance *with_damping(bool alive, const char *more)
{
    char text[512];
    himc_performance *p = session_new();
    snprintf(text, sizeof text,
             "drum kettle; alive %d; tempo 60; stroke 1 right legato f; stroke 2 left legato mf; "
             "stroke 6 right legato mf; "
             "at 3 kettle damp 1; at 4 kettle damp 0; %s play;",
             alive, more);
    session_score(p, "build/alive.txt", text);
    return p;
}

/// Height of the lower hand's fingers over the head (m), infinite beside it; its speed (m/s).
static double fingers(const himc_performance *p, double *speed)
{
    const himc_body_state *s = &p->body->state;
    double least = INFINITY;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const himc_head_frame *head = himc_drums_frame(&p->drums, 0);
        int stick = himc_stick_segment((himc_hand)hand);
        himc_vec3 at = himc_head_frame_from_world(head, s->origin[stick]);
        if (hypot(at.x, at.y) > head->radius || at.z > least)
            continue;
        least = at.z;
        *speed = himc_vec3_length(s->tip_velocity[hand]);
    }
    return least;
}

/// Plays to the time of a beat of with_damping, and on.
static void play_to_beat(himc_performance *p, double beat, double more, heard *h)
{
    for (int i = 0; i < 800 && himc_planner_beat(p->motion->planner, step_time(p)) < beat; i++)
        session_play(p, 0.01, h);
    session_play(p, more, h);
}

static void test_a_free_hand_lies_on_a_damped_head_in_time_and_rises_again(void)
{
    himc_performance *p = with_damping(true, "");
    heard h = {0};
    double speed = 0;
    play_to_beat(p, 2.3, 0, &h);
    TEST_ASSERT_TRUE(fingers(p, &speed) > 0.06);
    play_to_beat(p, 3, 0.01, &h);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.035, fingers(p, &speed));
    TEST_ASSERT_TRUE(speed < 0.05);
    play_to_beat(p, 3.9, 0, &h);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.035, fingers(p, &speed));
    play_to_beat(p, 4, 1, &h);
    TEST_ASSERT_TRUE(fingers(p, &speed) > 0.06);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(2, s.played);
    TEST_ASSERT_EQUAL_INT(0, s.unplanned_contacts);
    TEST_ASSERT_TRUE(s.tip_rms < 2e-5);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_head_is_damped_in_time_without_a_free_hand(void)
{
    himc_performance *p =
        with_damping(true, "stroke 3.2 right legato mf; stroke 3.3 left legato mf;");
    heard h = {0};
    double speed;
    play_to_beat(p, 2.99, 0, &h);
    TEST_ASSERT_FALSE(himc_drums_damped(&p->drums, 0));
    play_to_beat(p, 3, 0.01, &h);
    TEST_ASSERT_TRUE(himc_drums_damped(&p->drums, 0));
    TEST_ASSERT_TRUE(fingers(p, &speed) > 0.06);
    play_to_beat(p, 3.5, 1, &h);
    TEST_ASSERT_EQUAL_INT(4, himc_performance_measure(p).played);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_hand_comes_to_a_damping_that_nobody_foresaw(void)
{
    himc_performance *p = session_new();
    double speed = 0;
    session_do(p, "drum kettle");
    session_do(p, "alive 1");
    session_play(p, 0.5, NULL);
    session_drum(p, 0, "damp 1");
    session_play(p, 0.3, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.035, fingers(p, &speed));
    session_drum(p, 0, "damp 0");
    session_play(p, 1, NULL);
    TEST_ASSERT_TRUE(fingers(p, &speed) > 0.06);
    himc_performance_free(p);
}

/// The wrist that avoids the other arm is high, and its stick points down.
static void test_a_hand_that_comes_to_damp_strikes_no_head(void)
{
    static const char *const score[] = {
        "stroke 1 left legato mf low; stroke 2 right legato mf kettle; stroke 4 left legato f low; "
        "stroke 10 right legato mf low; at 4.35 low damp 1; at 4.65 kettle damp 1; play;",
        "stroke 1 left legato mf low; stroke 4 left legato mf kettle; stroke 5 left legato mf low; "
        "at 1.45 low damp 1; at 1.45 kettle damp 1; play;"};
    for (int k = 0; k < 2; k++) {
        himc_performance *p = session_new();
        char text[400];
        snprintf(text, sizeof text, "drum kettle 26; drum low 29; alive 1; %s", score[k]);
        session_score(p, "build/damp.txt", text);
        session_play(p, 8, NULL);
        TEST_ASSERT_EQUAL_INT(k == 0 ? 4 : 3, himc_performance_measure(p).played);
        TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).unplanned_contacts);
        himc_performance_free(p);
    }
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
    RUN_TEST(test_before_a_stroke_the_head_looks_at_its_drum_as_near_as_eyes_turn);
    RUN_TEST(test_head_is_lifted_before_the_first_note);
    RUN_TEST(test_trunk_breathes_and_sways_at_rest);
    RUN_TEST(test_a_free_hand_lies_on_a_damped_head_in_time_and_rises_again);
    RUN_TEST(test_a_head_is_damped_in_time_without_a_free_hand);
    RUN_TEST(test_a_hand_comes_to_a_damping_that_nobody_foresaw);
    RUN_TEST(test_a_hand_that_comes_to_damp_strikes_no_head);
    RUN_TEST(test_tips_strike_as_without_and_0_is_as_never_said);
    return UNITY_END();
}
