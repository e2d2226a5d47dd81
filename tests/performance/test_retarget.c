/// test_retarget.c: a take played by a body with longer limbs than its player's: the tips of
/// `himc`, and of `id` with bent arms, are where they were captured; captured joints alone miss by
/// the sum of the differences in length.
#include "take_players.h"

#include "himc/performance.h"

#include "unity.h"

#define RATE 48000
#define LONGER 1.03

static himc_error error;
static himc_take *take;
static himc_player *player;
static himc_performance *performance;

void setUp(void)
{
    himc_skeleton skeleton;
    himc_skeleton_config given = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &given, &error));
    take = beaten_take(&skeleton, 250, 3, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    player = himc_player_new(take, NULL, &given, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(player, error.text);
    himc_performance_config config = himc_performance_default();
    config.sample_rate = RATE;
    performance = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(performance, error.text);
}

void tearDown(void)
{
    himc_performance_free(performance);
    himc_player_free(player);
    himc_take_free(take);
}

static void tell(const char *text)
{
    himc_command c;
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&c, HIMC_PERFORMER, text, &error), error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_command(performance, &c, 0, &error), error.text);
}

static void lengthen_arms(void)
{
    for (int i = HIMC_LEFT_UPPER_ARM; i <= HIMC_RIGHT_HAND; i++)
        player->config.length[i] *= LONGER;
}

// RMS of tips from targets outside contact (m)
static double play(void)
{
    TEST_ASSERT_TRUE_MESSAGE(
        himc_performance_play_player(performance, take, player, "take", &error), error.text);
    tell("play");
    himc_performance_process(performance, 4 * RATE, NULL);
    return himc_performance_measure(performance).tip_rms;
}

static void test_himc_puts_the_tips_of_a_longer_arm_at_the_captured_positions(void)
{
    lengthen_arms();
    TEST_ASSERT_TRUE(play() < 1e-4);
}

static void test_id_with_bent_arms_puts_the_tips_at_the_captured_positions(void)
{
    lengthen_arms();
    tell("mode id");
    TEST_ASSERT_TRUE(play() < 2e-4);
}

// 3 % of upper arm, forearm and hand, 0.6 m in all
static void test_joints_as_captured_miss_by_the_difference_in_length(void)
{
    double off;
    lengthen_arms();
    tell("mode id");
    tell("bend 0");
    off = play();
    TEST_ASSERT_TRUE(off > 5e-3 && off < 25e-3);
}

static void test_joints_as_captured_have_the_tips_of_their_own_player(void)
{
    tell("mode id");
    tell("bend 0");
    TEST_ASSERT_TRUE(play() < 5e-3);
}

static void keep_mode(void *user, const char *line)
{
    if (strncmp(line, "mode", 4) == 0)
        snprintf(user, 256, "%s", line);
}

static void test_reset_bends_arms_again(void)
{
    char mode[256] = "";
    lengthen_arms();
    tell("bend 0");
    himc_performance_describe(performance, HIMC_DESCRIBE_INFO, keep_mode, mode);
    TEST_ASSERT_NOT_NULL(strstr(mode, "himc (in id, arms as captured), solver"));
    tell("reset");
    himc_performance_describe(performance, HIMC_DESCRIBE_INFO, keep_mode, mode);
    TEST_ASSERT_NOT_NULL(strstr(mode, "himc, solver"));
    tell("mode id");
    TEST_ASSERT_TRUE(play() < 2e-4);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_himc_puts_the_tips_of_a_longer_arm_at_the_captured_positions);
    RUN_TEST(test_id_with_bent_arms_puts_the_tips_at_the_captured_positions);
    RUN_TEST(test_joints_as_captured_miss_by_the_difference_in_length);
    RUN_TEST(test_joints_as_captured_have_the_tips_of_their_own_player);
    RUN_TEST(test_reset_bends_arms_again);
    return UNITY_END();
}
