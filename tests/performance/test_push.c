/// test_push.c: pushed with 200 N for 100 ms, a performer never loses its body and is back within a
/// second, whatever the law, the gains and the rate. tests/long has all combinations.
#include "pushes.h"
#include "body/character.h"

static void pushed(int which, push_case c)
{
    c.piece = &push_pieces[which];
    if (!push_available(c.piece))
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    push_case without = c;
    without.segment = 0;
    push_result still = push_play(&without);
    TEST_ASSERT_TRUE(still.finite && still.lost == 0);
    push_recovers(&c, &still);
}

static void test_the_hand_pushed_forward_comes_back_by_computed_torque(void)
{
    pushed(0, (push_case){.mode = 0,
                          .law = HIMC_LAW_COMPUTED_TORQUE,
                          .gain = 1,
                          .physics = 10000,
                          .segment = HIMC_RIGHT_HAND,
                          .direction = {1, 0, 0}});
}

static void test_a_stick_pushed_up_comes_back_by_the_printed_law_at_gains_of_a_tenth(void)
{
    pushed(0, (push_case){.mode = 0,
                          .law = HIMC_LAW_PRINTED,
                          .gain = 0.1,
                          .physics = 10000,
                          .segment = HIMC_LEFT_STICK,
                          .direction = {0, 0, 1}});
}

static void test_the_trunk_pushed_aside_comes_back_by_feedforward_at_gains_ten_times(void)
{
    pushed(0, (push_case){.mode = 1,
                          .law = HIMC_LAW_FEEDFORWARD,
                          .gain = 10,
                          .physics = 1000,
                          .segment = HIMC_TRUNK,
                          .direction = {0, 1, 0}});
}

static void test_a_real_stroke_is_found_again_after_a_push_of_the_forearm(void)
{
    pushed(1, (push_case){.mode = 0,
                          .law = HIMC_LAW_FEEDFORWARD,
                          .gain = 1,
                          .physics = 10000,
                          .segment = HIMC_RIGHT_FOREARM,
                          .direction = {0, 0, -1}});
}

static void test_a_push_acts_as_a_force_for_its_time(void)
{
    himc_character *c;
    himc_skeleton body;
    himc_body_state before, after;
    const himc_vec3 none[HIMC_JOINTS] = {{0, 0, 0}};
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&body, &config, &error));
    c = himc_character_new(&body, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(c, error.text);
    himc_character_observe(c, &before);
    world_contact push = {.segment = HIMC_LEFT_STICK,
                          .at = body.segment[HIMC_LEFT_STICK].center,
                          .force = {10, 0, 0}};
    TEST_ASSERT_TRUE(himc_character_step(c, none, &push, 1, 1e-4));
    himc_character_observe(c, &after);
    // the hanging stick alone at first: F h / m at most, since the hand holds its other end
    double v = after.tip_velocity[HIMC_LEFT].x,
           free = 10 * 1e-4 / body.segment[HIMC_LEFT_STICK].mass;
    TEST_ASSERT_TRUE(v > 0.5 * free && v < 3 * free);
    push.force.x = NAN;
    TEST_ASSERT_FALSE(himc_character_step(c, none, &push, 1, 1e-4));
    himc_character_free(c);
}

static void refused(const char *text, const char *why)
{
    himc_performance *p = session_new();
    TEST_ASSERT_FALSE(session_try(p, "%s", text));
    TEST_ASSERT_EQUAL_STRING_LEN(why, error.text, strlen(why));
    himc_performance_free(p);
}

static void test_pushes_of_unknown_segments_or_too_hard_are_refused_in_one_line(void)
{
    refused("push pelvis 1 0 0 1",
            "push: pelvis: `stance fixed` holds it, expected `stance seated` or `standing`");
    refused("push tail 1 0 0 1", "push: SEGMENT: tail, expected pelvis trunk neck");
    refused("push trunk 1 0 2000 1", "push: FZ: 2000, expected -1000 .. 1000 N");
    refused("push trunk 1 0 0 -1", "push: SECONDS: -1, expected 0 .. 10 s");
    refused("push trunk 1 0 0", "push: SECONDS missing");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_push_acts_as_a_force_for_its_time);
    RUN_TEST(test_pushes_of_unknown_segments_or_too_hard_are_refused_in_one_line);
    RUN_TEST(test_the_hand_pushed_forward_comes_back_by_computed_torque);
    RUN_TEST(test_a_stick_pushed_up_comes_back_by_the_printed_law_at_gains_of_a_tenth);
    RUN_TEST(test_the_trunk_pushed_aside_comes_back_by_feedforward_at_gains_ten_times);
    RUN_TEST(test_a_real_stroke_is_found_again_after_a_push_of_the_forearm);
    return UNITY_END();
}
