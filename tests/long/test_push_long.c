/// test_push_long.c: six pushes in every combination of pipeline, law, gains and piece.
#include "pushes.h"

static const struct {
    int segment;
    himc_vec3 direction;
} pushes[] = {
    {HIMC_RIGHT_HAND, {1, 0, 0}}, {HIMC_LEFT_STICK, {0, 0, 1}},     {HIMC_RIGHT_STICK, {0, 1, 0}},
    {HIMC_TRUNK, {0, 1, 0}},      {HIMC_RIGHT_FOREARM, {0, 0, -1}}, {HIMC_HEAD, {-1, 0, 0}},
};

static void all_of(int which)
{
    static const double gains[] = {0.1, 1, 10};
    if (!push_available(&push_pieces[which]))
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    for (int i = 0; i < 18; i++) {
        push_case c = {&push_pieces[which], i / 9, i / 3 % 3, gains[i % 3], 10000, 0, {0, 0, 0}};
        push_result still = push_play(&c);
        TEST_ASSERT_TRUE(still.finite && still.lost == 0);
        for (size_t k = 0; k < sizeof pushes / sizeof *pushes; k++) {
            c.segment = pushes[k].segment;
            c.direction = pushes[k].direction;
            push_recovers(&c, &still);
        }
    }
}

static void test_pushes_in_the_improvisation(void)
{
    all_of(0);
}

static void test_pushes_in_a_real_stroke(void)
{
    all_of(1);
}

static void test_pushes_in_a_motion_of_the_whole_body(void)
{
    all_of(2);
}

static void test_pushes_in_markers_of_one_arm(void)
{
    all_of(3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_pushes_in_the_improvisation);
    RUN_TEST(test_pushes_in_a_real_stroke);
    RUN_TEST(test_pushes_in_a_motion_of_the_whole_body);
    RUN_TEST(test_pushes_in_markers_of_one_arm);
    return UNITY_END();
}
