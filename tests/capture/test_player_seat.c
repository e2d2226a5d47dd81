/// test_player_seat.c: places of a take's player and drum, for any origin of the take, and the
/// lines about both.
#include "read_players.h"
#include "base/head_frame.h"

static void test_a_player_at_the_origin_keeps_its_place(void)
{
    himc_head_frame drum = usual_drum;
    make_take(&given);
    read_player();
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, himc_vec3_length(player->offset));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, skeleton.segment[HIMC_PELVIS].origin.z, player->config.seat);
    TEST_ASSERT_EQUAL_MEMORY(&usual_drum, &drum, sizeof drum);
}

static void move_take(himc_vec3 by)
{
    for (size_t i = 0; i < (size_t)take->points * (size_t)take->frames; i++)
        take->x[i] = himc_vec3_add(take->x[i], by);
}

static void test_a_distant_player_is_moved_to_the_drum(void)
{
    himc_head_frame drum = usual_drum;
    make_take(&given);
    move_take(himc_vec3_make(12, -5, 0.3));
    read_player();
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -12, player->offset.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 5, player->offset.y);
    TEST_ASSERT_DOUBLE_WITHIN(0.012, -0.3, player->offset.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.012, skeleton.segment[HIMC_PELVIS].origin.z, player->config.seat);
    TEST_ASSERT_EQUAL_MEMORY(&usual_drum, &drum, sizeof drum);
}

static void test_a_drum_that_strikes_would_miss_is_moved_under_them(void)
{
    himc_head_frame drum = usual_drum;
    drum.center = himc_vec3_make(0.9, 0.6, 0.85);
    make_take(&given);
    read_player();
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
    // struck at 0.5 m, the usual place: three quarters of the radius in front of the centre
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.5 + 0.75 * drum.radius, drum.center.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0, drum.center.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.85, drum.center.z);
}

static void test_tips_alone_seat_the_player_so_that_strikes_meet_the_usual_place(void)
{
    himc_head_frame drum = usual_drum;
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
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 3, player->offset.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -7, player->offset.y);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -2, player->offset.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, -3, player->hips.x);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 7, player->hips.y);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 2 + 0.42 * 1.75, player->hips.z);
}

static void test_a_player_who_strikes_nothing_keeps_the_height_above_the_floor(void)
{
    himc_head_frame drum = usual_drum;
    make_take(&given);
    move_take(himc_vec3_make(2, 3, 0.1));
    for (int i = 1; i < take->frames; i++)
        memcpy(himc_take_at(take, i, 0), himc_take_at(take, 0, 0),
               (size_t)take->points * sizeof *take->x);
    read_player();
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -2, player->offset.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -3, player->offset.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, player->offset.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, skeleton.segment[HIMC_PELVIS].origin.z + 0.1,
                              player->config.seat);
}

// a take of tips alone: `shape` is a function of the time from 0 to 1
static void make_tips(himc_vec3 (*shape)(double))
{
    make_take(&given);
    forget_skeleton();
    for (int k = 0; k < take->points; k++) {
        bool tip = strstr(take->names[k], "_end");
        bool left = tip && strstr(take->names[k], "eft");
        if (!tip)
            snprintf(take->names[k], TAKE_NAME, "thing%d", k);
        for (int i = 0; i < take->frames && tip; i++) {
            himc_vec3 x = shape((double)i / take->frames);
            x.y += left ? 0.1 : -0.1;
            *himc_take_at(take, i, k) = x;
        }
    }
    read_player();
}

static himc_vec3 wide_circle(double u)
{
    return himc_vec3_make(7 + 0.4 * sin(2 * HIMC_PI * u), 1, 3 + 0.4 * cos(2 * HIMC_PI * u));
}

static void test_tips_without_strikes_are_brought_into_reach_and_the_drum_out_of_the_way(void)
{
    himc_head_frame drum = usual_drum;
    himc_take_tip tips[HIMC_HANDS];
    himc_posture posture;
    make_tips(wide_circle);
    TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
    TEST_ASSERT_TRUE(himc_take_tips(take, NULL, tips, &error));
    himc_posture_init(&posture, &skeleton, usual_drum.center.z + given.mallet_radius);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; i < take->frames; i++) {
            himc_vec3 x = himc_vec3_add(tips[hand].x[i], player->offset), local;
            himc_vec3 near = himc_posture_reachable(&posture, (himc_hand)hand, x);
            TEST_ASSERT_DOUBLE_WITHIN(1.1e-3, 0, himc_vec3_length(himc_vec3_sub(near, x)));
            local = himc_head_frame_from_world(&drum, x);
            TEST_ASSERT_TRUE(hypot(local.x, local.y) > drum.radius || local.z > 0.0499);
        }
    TEST_ASSERT_TRUE(drum.center.z < usual_drum.center.z);
    TEST_ASSERT_EQUAL_DOUBLE(usual_drum.center.x, drum.center.x);
}

static void test_a_walking_player_is_held_and_a_swaying_one_is_not_walking(void)
{
    himc_head_frame drum = usual_drum;
    make_take(&given);
    himc_vec3 before = *himc_take_at(take, 100, take->points - 1);
    for (int i = 0; i < take->frames; i++)
        for (int k = 0; k < take->points; k++)
            himc_take_at(take, i, k)->x += 0.002 * (i - 0.5 * (take->frames - 1));
    read_player();
    TEST_ASSERT_TRUE(player->walks);
    TEST_ASSERT_EQUAL_INT(1, player->note_count);
    TEST_ASSERT_TRUE(worst_angle(0, HIMC_JOINTS) < 1e-6); // relative to the hips
    for (int twice = 0; twice < 2; twice++) {             // the motion is removed only once
        TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
        himc_vec3 after = *himc_take_at(take, 100, take->points - 1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, himc_vec3_length(himc_vec3_sub(after, before)));
    }
}

static void hear(void *user, const char *line)
{
    char *all = user;
    TEST_ASSERT_TRUE(strlen(line) < 256);
    strcat(strcat(all, line), "\n");
}

static void test_description_has_height_mass_and_place_of_the_head(void)
{
    char all[4096] = "";
    himc_head_frame drum = usual_drum;
    make_take(&given);
    read_player();
    himc_player_sit(player, take, NULL, &drum, NULL);
    himc_player_describe(player, &drum, hear, all);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(all, "player: 1.750 m tall (by legs and trunk), 75.0 kg (by a body mass index of"),
        all);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(all, "seat: hip joints 0.735 m above the floor"), all);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(all, "drumhead: centre 0.700 m in front of the player"),
                                 all);
}

static void test_the_seat_says_how_it_follows_from_the_take(void)
{
    static const struct {
        double moved, head; // the take, and the drum's height (m)
        const char *said;
    } seats[] = {{0, 0.85, "above the floor, as the take shows;"},
                 {0.3, 0.85, "above the floor, lowered by 0.3"},
                 {-0.2, 0.85, "above the floor, raised by 0."},
                 {0, 1.9, "1.300 m above the floor, the most allowed;"},
                 {0, 0.2, "0.300 m above the floor, the least allowed;"}};
    for (size_t i = 0; i < sizeof seats / sizeof *seats; i++) {
        char all[4096] = "";
        himc_head_frame drum = usual_drum;
        drum.center.z = seats[i].head;
        make_take(&given);
        move_take(himc_vec3_make(0, 0, seats[i].moved));
        read_player();
        TEST_ASSERT_TRUE(himc_player_sit(player, take, NULL, &drum, NULL));
        himc_player_describe(player, &drum, hear, all);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(all, seats[i].said), all);
        tearDown();
        setUp();
    }
}

static void test_a_hand_that_is_given_as_a_tip_is_named(void)
{
    for (int hand = 0; hand < 2; hand++) {
        himc_take_options options = himc_take_default();
        options.right_tip = hand ? "RightHand" : NULL;
        make_take(&given);
        player = himc_player_new(take, &options, &given, &error);
        TEST_ASSERT_NOT_NULL_MESSAGE(player, error.text);
        char all[4096] = "";
        himc_player_describe(player, NULL, hear, all);
        TEST_ASSERT_TRUE_MESSAGE(
            !!strstr(all, "note: RightHand is 0.00 m from the wrist: a hand") == hand, all);
        TEST_ASSERT_NULL_MESSAGE(strstr(all, "Left"), all);
        tearDown();
        setUp();
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_player_at_the_origin_keeps_its_place);
    RUN_TEST(test_a_distant_player_is_moved_to_the_drum);
    RUN_TEST(test_a_drum_that_strikes_would_miss_is_moved_under_them);
    RUN_TEST(test_tips_alone_seat_the_player_so_that_strikes_meet_the_usual_place);
    RUN_TEST(test_a_player_who_strikes_nothing_keeps_the_height_above_the_floor);
    RUN_TEST(test_tips_without_strikes_are_brought_into_reach_and_the_drum_out_of_the_way);
    RUN_TEST(test_a_walking_player_is_held_and_a_swaying_one_is_not_walking);
    RUN_TEST(test_description_has_height_mass_and_place_of_the_head);
    RUN_TEST(test_the_seat_says_how_it_follows_from_the_take);
    RUN_TEST(test_a_hand_that_is_given_as_a_tip_is_named);
    return UNITY_END();
}
