/// test_rest.c: rest goes with the drum: hands wait over their drum at any height and side, the
/// stool fits the body, and a drum out of reach is told in one line.
#include "session.h"

#include "performance/performance_state.h"
#include "base/head_frame.h"

#define REST 0.085 // of the mallet over the head, as planned (m)

static himc_performance *with_drum(double angle, double distance, double height)
{
    himc_performance *p = session_new();
    char place[64];
    snprintf(place, sizeof place, "place %.6f %.6f %g", distance * cos(angle),
             distance * sin(angle), height);
    session_do(p, "drum kettle");
    session_drum(p, 0, place);
    return p;
}

/// Place of a tip on a head, z the mallet's height over it (m).
static himc_vec3 over(const himc_performance *p, int drum, himc_hand hand)
{
    himc_vec3 at =
        himc_head_frame_from_world(himc_drums_frame(&p->drums, drum), p->body->state.tip[hand]);
    at.z -= p->body->skeleton.mallet_radius;
    return at;
}

static void rests_over(const himc_performance *p, int drum, himc_hand hand)
{
    himc_vec3 at = over(p, drum, hand);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, REST, at.z);
    TEST_ASSERT_TRUE(hypot(at.x, at.y) < himc_drums_frame(&p->drums, drum)->radius);
    TEST_ASSERT_TRUE(hand == HIMC_LEFT ? at.y > 0.05 : at.y < -0.05);
}

static void play_four(himc_performance *p, const char *player, heard *h)
{
    static const char *const hand[] = {"left", "right"};
    if (player)
        session_do(p, "%s", player);
    session_do(p, "tempo 120");
    for (int i = 0; i < 4; i++)
        session_do(p, "stroke %d %s legato mf", 1 + i, hand[i % 2]);
    session_do(p, "play");
    session_play(p, 6, h);
}

static void test_hands_begin_at_rest_over_a_drum_at_any_height_and_side(void)
{
    for (int k = 0; k < 12; k++) {
        double angle = (k % 3 - 1) * 2 * HIMC_PI / 3, height = 0.4 + 0.9 * (k / 3) / 3.0;
        himc_performance *p = with_drum(angle, 0.7, height);
        session_play(p, 0.1, NULL);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            rests_over(p, 0, (himc_hand)hand);
        TEST_ASSERT_TRUE(himc_performance_measure(p).peak_force == 0);
        himc_performance_free(p);
    }
}

static void test_piece_on_a_low_or_high_head_is_played_and_ends(void)
{
    static const double height[] = {0.4, 1.0, 1.3};
    for (int k = 0; k < 3; k++) {
        himc_performance *p = with_drum(0, 0.7, height[k]);
        heard h = {0};
        play_four(p, NULL, &h);
        himc_performance_stats s = himc_performance_measure(p);
        TEST_ASSERT_EQUAL_INT(4, h.strikes);
        TEST_ASSERT_EQUAL_INT(4, s.played);
        TEST_ASSERT_EQUAL_INT(1, h.dones);
        TEST_ASSERT_EQUAL_INT(0, h.notes);
        TEST_ASSERT_TRUE(s.peak_force < 60);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            rests_over(p, 0, (himc_hand)hand);
        heard_free(&h);
        himc_performance_free(p);
    }
}

static void test_a_hand_rests_over_the_drum_of_its_last_stroke_and_not_crossed(void)
{
    for (int crossed = 0; crossed < 2; crossed++) {
        himc_performance *p = with_drum(-0.55, 0.7, 0.9);
        session_do(p, "drum left");
        session_drum(p, 1, "place 0.55 0.4 0.8");
        session_do(p, "stroke 1 left legato p normal %s", crossed ? "kettle" : "left");
        session_do(p, "stroke 3 right legato p normal %s", crossed ? "left" : "kettle");
        session_do(p, "play");
        session_play(p, 6, NULL);
        TEST_ASSERT_EQUAL_INT(2, himc_performance_measure(p).played);
        rests_over(p, 1, HIMC_LEFT);
        rests_over(p, 0, HIMC_RIGHT);
        himc_performance_free(p);
    }
}

// at the start it is there, later it goes there
static void test_a_hand_waits_over_the_drum_of_its_first_stroke(void)
{
    enum { AT_THE_START, AFTER_A_SEEK, LATER, AFTER_ANOTHER_PIECE, CASES };
    char score[200];
    for (int when = 0; when < CASES; when++) {
        himc_performance *p = with_drum(-0.55, 0.7, 0.9);
        session_do(p, "drum left");
        session_drum(p, 1, "place 0.55 0.4 0.8");
        if (when == LATER)
            session_play(p, 0.1, NULL);
        if (when == AFTER_ANOTHER_PIECE) {
            play_four(p, NULL, NULL);
            session_do(p, "clear");
        }
        snprintf(score, sizeof score,
                 "%sstroke 2 left legato p normal left; stroke 3 left legato p normal kettle;"
                 "stroke 3 right legato p normal kettle;",
                 when == AFTER_A_SEEK ? "stroke 1 left legato p normal kettle; seek 2;" : "");
        session_score(p, "build/rest.txt", score);
        bool there = when == AT_THE_START || when == AFTER_A_SEEK;
        session_play(p, there ? 0.01 : 4, NULL);
        rests_over(p, 1, HIMC_LEFT);
        rests_over(p, 0, HIMC_RIGHT);
        TEST_ASSERT_TRUE(!there || himc_performance_measure(p).peak_rate < 0.5);
        himc_performance_free(p);
    }
}

/// Plays on for 5 s; counts the notes that begin so.
static int count_notes(himc_performance *p, const char *begin, heard *h)
{
    himc_event event;
    int count = 0;
    for (int i = 0; i < 500; i++) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event)) {
            heard_event(h, &event);
            count += event.kind == HIMC_EVENT_NOTE && !strncmp(event.text, begin, strlen(begin));
        }
    }
    return count;
}

static void test_drum_out_of_reach_is_told_in_one_line_and_its_piece_ends(void)
{
    static const struct {
        double angle, distance, height;
        const char *said;
    } drum[] = {{0, 1.6, 0.85, "drum kettle is too far by "},
                {0, 0.7, 2.2, "drum kettle is too high by "},
                {0, 0.7, 0.05, "drum kettle is too low by "}};
    for (int k = 0; k < 3; k++) {
        himc_performance *p = with_drum(drum[k].angle, drum[k].distance, drum[k].height);
        heard h = {0};
        session_do(p, "stroke 1 left legato mf");
        session_do(p, "play");
        int said = count_notes(p, drum[k].said, &h);
        session_do(p, "play");
        said += count_notes(p, drum[k].said, &h);
        TEST_ASSERT_EQUAL_INT_MESSAGE(1, said, drum[k].said);
        TEST_ASSERT_EQUAL_INT(2, h.dones);
        TEST_ASSERT_EQUAL_INT(0, h.strikes);
        heard_free(&h);
        himc_performance_free(p);
    }
}

static void test_a_child_gets_a_stool_that_fits(void)
{
    himc_performance *p = with_drum(0, 0.7, 0.85);
    heard h = {0};
    play_four(p, "player 1.2 30", &h);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_INT(4, s.played);
    TEST_ASSERT_TRUE(s.tip_rms < 2e-5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.53 * 1.2, p->body->skeleton.segment[HIMC_PELVIS].origin.z);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_usual_body_and_drum_keep_the_usual_stool(void)
{
    himc_performance *p = with_drum(0, 0.7, 0.85);
    TEST_ASSERT_TRUE(p->body->skeleton.segment[HIMC_PELVIS].origin.z ==
                     himc_skeleton_seat(&p->settings.skeleton));
    himc_performance_free(p);
}

static void test_head_raised_past_resting_sticks_is_not_struck_from_below(void)
{
    himc_performance *p = with_drum(0, 0.7, 0.85);
    heard h = {0};
    session_play(p, 0.5, &h);
    session_drum(p, 0, "place 0.7 0 0.97");
    session_play(p, 3, &h);
    TEST_ASSERT_EQUAL_INT(0, h.strikes);
    TEST_ASSERT_TRUE(himc_performance_measure(p).peak_force < 0.01);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        rests_over(p, 0, (himc_hand)hand);
    session_do(p, "hit left legato mf");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_hands_begin_at_rest_over_a_drum_at_any_height_and_side);
    RUN_TEST(test_piece_on_a_low_or_high_head_is_played_and_ends);
    RUN_TEST(test_a_hand_rests_over_the_drum_of_its_last_stroke_and_not_crossed);
    RUN_TEST(test_a_hand_waits_over_the_drum_of_its_first_stroke);
    RUN_TEST(test_drum_out_of_reach_is_told_in_one_line_and_its_piece_ends);
    RUN_TEST(test_a_child_gets_a_stool_that_fits);
    RUN_TEST(test_usual_body_and_drum_keep_the_usual_stool);
    RUN_TEST(test_head_raised_past_resting_sticks_is_not_struck_from_below);
    return UNITY_END();
}
