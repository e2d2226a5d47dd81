/// test_player_seat.c: where a take's player sits and where its drum stands, wherever its room was,
/// and what is said of both.
#include "read_players.h"

static void test_a_seated_player_keeps_the_place_it_has_in_our_world(void)
{
    himc_place drum = usual_drum;
    make_take(&given);
    read_player();
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, himc_vec3_length(player->offset));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, skeleton.root.z, player->config.seat);
    TEST_ASSERT_EQUAL_MEMORY(&usual_drum, &drum, sizeof drum);
}

static void move_take(himc_vec3 by)
{
    for (size_t i = 0; i < (size_t)take->points * (size_t)take->frames; i++)
        take->x[i] = himc_vec3_add(take->x[i], by);
}

static void test_a_player_far_off_is_brought_before_the_drum(void)
{
    himc_place drum = usual_drum;
    make_take(&given);
    move_take(himc_vec3_make(12, -5, 0.3));
    read_player();
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -12, player->offset.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 5, player->offset.y);
    TEST_ASSERT_DOUBLE_WITHIN(0.012, -0.3, player->offset.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.012, skeleton.root.z, player->config.seat);
    TEST_ASSERT_EQUAL_MEMORY(&usual_drum, &drum, sizeof drum);
}

static void test_a_drum_that_would_be_missed_is_moved_under_the_strikes(void)
{
    himc_place drum = usual_drum;
    drum.center = himc_vec3_make(0.9, 0.6, 0.85);
    make_take(&given);
    read_player();
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum));
    // struck at 0.5 m, the usual spot: three quarters of the radius before the centre
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.5 + 0.75 * drum.radius, drum.center.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0, drum.center.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.85, drum.center.z);
}

static void test_tips_alone_put_the_player_where_the_strikes_meet_the_usual_spot(void)
{
    himc_place drum = usual_drum;
    make_take(&given);
    move_take(himc_vec3_make(-3, 7, 2));
    forget_skeleton();
    for (int i = 0; i < take->points; i++)
        if (!strstr(take->names[i], "_end"))
            snprintf(take->names[i], TAKE_NAME, "thing%d", i);
    read_player();
    TEST_ASSERT_FALSE(player->placed);
    TEST_ASSERT_EQUAL_INT(0, player->lengths);
    TEST_ASSERT_EQUAL_INT(0, known_joints());
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum));
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 3, player->offset.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -7, player->offset.y);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -2, player->offset.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, -3, player->hips.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 7, player->hips.y);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 2 + 0.42 * 1.75, player->hips.z);
}

static void test_a_walking_player_is_told_from_a_swaying_one(void)
{
    make_take(&given);
    for (int i = 0; i < take->frames; i++)
        for (int k = 0; k < take->points; k++)
            himc_take_at(take, i, k)->x += 0.002 * i;
    read_player();
    TEST_ASSERT_TRUE(player->walks);
    TEST_ASSERT_EQUAL_INT(1, player->note_count);
    TEST_ASSERT_TRUE(worst_angle(0, HIMC_JOINTS) < 1e-6); // about the hips, wherever they are
}

static void hear(void *user, const char *line)
{
    char *all = user;
    TEST_ASSERT_TRUE(strlen(line) < 256);
    strcat(strcat(all, line), "\n");
}

static void test_description_says_how_tall_how_heavy_and_where_the_head_goes(void)
{
    char all[4096] = "";
    himc_place drum = usual_drum;
    make_take(&given);
    read_player();
    himc_player_sit(player, take, NULL, &drum);
    himc_player_describe(player, &drum, hear, all);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(all, "player: 1.750 m tall (by legs and trunk), 75.0 kg (by a body mass index of"),
        all);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(all, "seat: hip joints 0.735 m above the floor"), all);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(all, "drumhead: centre 0.700 m before the player"), all);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_seated_player_keeps_the_place_it_has_in_our_world);
    RUN_TEST(test_a_player_far_off_is_brought_before_the_drum);
    RUN_TEST(test_a_drum_that_would_be_missed_is_moved_under_the_strikes);
    RUN_TEST(test_tips_alone_put_the_player_where_the_strikes_meet_the_usual_spot);
    RUN_TEST(test_a_walking_player_is_told_from_a_swaying_one);
    RUN_TEST(test_description_says_how_tall_how_heavy_and_where_the_head_goes);
    return UNITY_END();
}
