/// test_measures.c: the figures of a performance beside the error of its tips: contacts that nobody
/// asked for, the longest contact, peaks of the joints.
#include "himc/body.h"

#include "session.h"

#define HEAD 0.8675 // height of a tip that touches the usual head (m)

static himc_performance *with_strokes(const char *settings)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "%s", settings);
    for (int i = 0; i < 4; i++)
        session_do(p, "stroke %d %s legato f", 2 + i, i % 2 ? "left" : "right");
    return p;
}

static void test_strokes_are_planned_and_leave_the_head_at_once(void)
{
    himc_performance *p = with_strokes("mode himc");
    session_do(p, "play");
    session_play(p, 4, NULL);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(4, s.played);
    TEST_ASSERT_EQUAL_INT(0, s.unplanned_contacts);
    TEST_ASSERT_TRUE(s.longest_contact > 0.003 && s.longest_contact < 0.015);
    TEST_ASSERT_TRUE(isnan(s.captured_rms) && isnan(s.captured_most_percent));
    TEST_ASSERT_TRUE(isnan(s.captured_speed_ratio));
    himc_performance_free(p);
}

static void find_contacts(void *user, const char *line)
{
    int unplanned;
    if (sscanf(line, "contacts: %d unplanned", &unplanned) == 1)
        *(int *)user = unplanned;
}

static void find_human(void *user, const char *line)
{
    *(bool *)user |= strcmp(line, "human 0.5, seed 7") == 0;
}

static void test_info_tells_how_human_the_player_is(void)
{
    himc_performance *p = session_new();
    bool told = false;
    session_do(p, "human 0.5 7");
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, find_human, &told);
    TEST_ASSERT_TRUE(told);
    himc_performance_free(p);
}

static void test_a_stick_laid_on_the_head_is_one_long_unplanned_contact(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "target right 0.55 -0.12 %g", HEAD + 0.2);
    session_play(p, 1, NULL);
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).unplanned_contacts);
    session_do(p, "target right 0.55 -0.12 %g", HEAD - 0.02);
    session_play(p, 3, NULL);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(1, s.unplanned_contacts);
    TEST_ASSERT_TRUE(s.longest_contact > 1.5);
    int told = 0;
    himc_performance_describe(p, HIMC_DESCRIBE_INFO, find_contacts, &told);
    TEST_ASSERT_EQUAL_INT(1, told);
    session_do(p, "reset");
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).unplanned_contacts);
    TEST_ASSERT_TRUE(himc_performance_measure(p).longest_contact == 0);
    himc_performance_free(p);
}

static himc_skeleton skeleton;

// the fastest joint at the task ticks
static void keep_fastest(void *user, const himc_tick *tick)
{
    double *most = user;
    for (int j = 0; j < HIMC_JOINTS; j++) {
        himc_vec3 rate = himc_vec3_sub(tick->body->spin[j + 1],
                                       tick->body->spin[skeleton.segment[j + 1].parent]);
        most[j] = fmax(most[j], himc_vec3_length(rate));
    }
}

static void test_the_peak_rate_is_that_of_the_fastest_joint_in_any_step(void)
{
    static const char *const modes[] = {"mode himc", "mode ik"};
    himc_skeleton_config body = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &body, &error));
    for (int i = 0; i < 2; i++) {
        double most[HIMC_JOINTS] = {0};
        himc_performance *p = with_strokes(modes[i]);
        himc_performance_on_tick(p, keep_fastest, most);
        session_do(p, "play");
        session_play(p, 4, NULL);
        himc_performance_stats s = himc_performance_measure(p);
        printf("%s: %.2f rad/s in %s, %.2f at ticks; %.1f N m in %s\n", modes[i], s.peak_rate,
               himc_joint_name(s.peak_rate_joint), most[s.peak_rate_joint], s.peak_torque,
               himc_joint_name(s.peak_torque_joint));
        for (int j = 0; j < HIMC_JOINTS; j++)
            TEST_ASSERT_TRUE(most[j] <= s.peak_rate);
        TEST_ASSERT_TRUE(most[s.peak_rate_joint] > 0.7 * s.peak_rate);
        TEST_ASSERT_TRUE(i ? s.peak_torque == 0 : s.peak_torque > 10);
        himc_performance_free(p);
    }
}

static void test_the_peak_torque_is_within_the_strength_that_limits_it(void)
{
    himc_performance *p = with_strokes("mode himc");
    session_do(p, "play");
    session_play(p, 4, NULL);
    himc_performance_stats freely = himc_performance_measure(p);
    himc_performance_free(p);
    double most = round(0.9 * freely.peak_torque);
    p = with_strokes("mode himc");
    for (int j = 0; j < HIMC_JOINTS; j++)
        session_do(p, "strength %s %g", himc_joint_name(j), most);
    session_do(p, "play");
    session_play(p, 4, NULL);
    himc_performance_stats limited = himc_performance_measure(p);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, most, limited.peak_torque);
    himc_performance_free(p);
}

// both hands at one point: their sticks cannot be there at once, so one is struck beside it
static void test_a_stroke_moved_aside_where_hands_meet_is_counted_and_measured(void)
{
    for (int apart = 0; apart < 2; apart++) {
        heard h = {0};
        double farthest = 0, y = apart ? 0.1 : 0;
        himc_performance *p = session_new();
        session_do(p, "drum kettle");
        for (int beat = 2; beat < 4; beat++)
            for (int hand = 0; hand < HIMC_HANDS; hand++)
                session_do(p, "stroke %d %s accent f -0.1 %g", beat, hand ? "right" : "left",
                           hand ? -y : y);
        session_do(p, "play");
        session_play(p, 2, &h);
        for (int i = 0; i < h.strikes; i++)
            farthest = fmax(farthest, hypot(h.strike[i].x + 0.1, fabs(h.strike[i].y) - y));
        himc_performance_stats s = himc_performance_measure(p);
        TEST_ASSERT_EQUAL_INT(4, s.played);
        TEST_ASSERT_EQUAL_INT(apart ? 0 : 2, s.moved);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, farthest, s.moved_most);
        TEST_ASSERT_TRUE(apart || s.moved_most > 0.02);
        heard_free(&h);
        himc_performance_free(p);
    }
}

// pushes lead sticks aside by 3 to 30 mm: only those near their point count
static void test_a_stroke_is_played_within_2_cm_of_its_point_and_5_ms_of_its_time(void)
{
    int near = 0, far = 0;
    heard h = {0};
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "tempo 120");
    for (int beat = 2; beat < 26; beat += 2) {
        session_do(p, "stroke %d right accent f", beat);
        session_do(p, "at %g push right-stick 0 %g 0 0.1", beat - 0.16, 1.5 * beat);
    }
    session_do(p, "play");
    session_play(p, 15, &h);
    for (int i = 0; i < h.strikes; i++) {
        const himc_strike *s = &h.strike[i];
        double off = hypot(s->x - s->planned_x, s->y - s->planned_y);
        bool in_time = fabs(s->time - s->planned_time) <= 0.005; // false without one
        near += in_time && off <= 0.02;
        far += in_time && off > 0.02 && off < 0.2;
    }
    TEST_ASSERT_TRUE(near > 2 && far > 2);
    TEST_ASSERT_EQUAL_INT(near, himc_performance_measure(p).played);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_strokes_are_planned_and_leave_the_head_at_once);
    RUN_TEST(test_info_tells_how_human_the_player_is);
    RUN_TEST(test_a_stick_laid_on_the_head_is_one_long_unplanned_contact);
    RUN_TEST(test_the_peak_rate_is_that_of_the_fastest_joint_in_any_step);
    RUN_TEST(test_the_peak_torque_is_within_the_strength_that_limits_it);
    RUN_TEST(test_a_stroke_moved_aside_where_hands_meet_is_counted_and_measured);
    RUN_TEST(test_a_stroke_is_played_within_2_cm_of_its_point_and_5_ms_of_its_time);
    return UNITY_END();
}
