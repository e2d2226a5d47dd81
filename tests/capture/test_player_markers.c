/// test_player_markers.c: from markers back to the body: markers in joints or beside them, with
/// wrong names, with gaps, and on captured arms.
#include "read_players.h"

static void test_markers_in_the_joint_centres_give_arms_legs_and_trunk(void)
{
    himc_skeleton_config config = another_player();
    make_take(&config);
    forget_skeleton();
    read_player();
    TEST_ASSERT_TRUE(player->known[himc_joint_find("waist")]);
    TEST_ASSERT_FALSE(player->known[himc_joint_find("head")]);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int k = 0; k < HIMC_ARM_JOINTS; k++)
            TEST_ASSERT_TRUE(player->known[himc_arm_joint((himc_hand)hand, k)]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.88, player->config.height);
    TEST_ASSERT_TRUE(worst_tip() < 1e-6);
    TEST_ASSERT_TRUE(worst_angle(0, 1) < 1e-6); // the trunk
    // the arms' rotations about their own axes come from planes: near those of the natural posture
    TEST_ASSERT_TRUE(worst_angle(himc_arm_joint(HIMC_LEFT, 0), himc_arm_joint(HIMC_LEFT, 3) + 2) <
                     0.25);
}

static void test_markers_beside_the_joints_give_every_rotation(void)
{
    himc_skeleton_config config = another_player();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
    take = beaten_file("build/player.c3d", &skeleton, 250, FRAMES / 250.0, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, "build/player.c3d", &error), error.text);
    himc_take_free(take);
    take = himc_take_load("build/player.c3d", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_FALSE(himc_take_has_skeleton(take));
    read_player();
    TEST_ASSERT_EQUAL_INT(HIMC_JOINTS, known_joints());
    TEST_ASSERT_TRUE(worst_angle(0, HIMC_JOINTS) < 1e-4); // single precision over 5 cm
    TEST_ASSERT_TRUE(worst_tip() < 1e-5);
}

static void test_markers_with_permuted_names_are_not_bones(void)
{
    make_take(&given);
    forget_skeleton();
    exchange_names("RightForeArm", "LeftStick_end");
    read_player();
    TEST_ASSERT_FALSE(player->known[himc_joint_find("right-shoulder")]);
    TEST_ASSERT_FALSE(player->known[himc_joint_find("right-elbow")]);
    TEST_ASSERT_TRUE(player->known[himc_joint_find("left-elbow")]);
    TEST_ASSERT_TRUE(player->note_count >= 1);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(player->notes[0], "are the points' names right?"),
                                 player->notes[0]);
}

static void lose_frames(const char *name, int from, int to)
{
    int point = himc_take_find(take, name);
    TEST_ASSERT_TRUE(point >= 0);
    for (int i = from; i < to; i++)
        *himc_take_at(take, i, point) = himc_vec3_gap();
}

static void test_a_short_gap_of_a_marker_is_bridged(void)
{
    make_take(&given);
    forget_skeleton();
    lose_frames("RightForeArm", 100, 110);
    read_player();
    TEST_ASSERT_TRUE(player->known[himc_joint_find("right-elbow")]);
    TEST_ASSERT_TRUE(worst_tip() < 2e-3);
}

static void test_a_long_gap_of_a_marker_leaves_its_joints_natural_with_a_note(void)
{
    make_take(&given);
    forget_skeleton();
    lose_frames("RightForeArm", 100, 200);
    read_player();
    TEST_ASSERT_FALSE(player->known[himc_joint_find("right-elbow")]);
    TEST_ASSERT_TRUE(player->known[himc_joint_find("left-elbow")]);
    TEST_ASSERT_EQUAL_INT(1, player->note_count);
    TEST_ASSERT_EQUAL_STRING("right elbow: RightForeArm is missing in frames 100 .. 199, expected "
                             "gaps up to 0.2 s",
                             player->notes[0]);
}

static void test_the_arm_of_the_real_stroke_has_its_published_lengths(void)
{
    if (!load_shared("drumstroke_pearl_240hz/stroke.trc"))
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    TEST_ASSERT_DOUBLE_WITHIN(0.008, 0.2554, player->config.length[HIMC_RIGHT_UPPER_ARM]);
    TEST_ASSERT_DOUBLE_WITHIN(0.008, 0.2924, player->config.length[HIMC_RIGHT_FOREARM]);
    TEST_ASSERT_DOUBLE_WITHIN(0.008, 0.1668, player->config.length[HIMC_RIGHT_HAND]);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++) {
        TEST_ASSERT_TRUE(player->known[himc_arm_joint(HIMC_RIGHT, k)]);
        TEST_ASSERT_FALSE(player->known[himc_arm_joint(HIMC_LEFT, k)]);
    }
}

static void test_an_arm_of_anatomical_markers_is_found(void)
{
    if (!load_shared("upperlimb_pyomeca_100hz/markers_analogs.c3d"))
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    TEST_ASSERT_TRUE(player->known[himc_joint_find("right-shoulder")]);
    TEST_ASSERT_TRUE(player->known[himc_joint_find("right-elbow")]);
    TEST_ASSERT_TRUE(player->known[himc_joint_find("right-wrist")]);
    TEST_ASSERT_DOUBLE_WITHIN(0.04, 0.28, player->config.length[HIMC_RIGHT_UPPER_ARM]);
    TEST_ASSERT_DOUBLE_WITHIN(0.04, 0.25, player->config.length[HIMC_RIGHT_FOREARM]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_markers_in_the_joint_centres_give_arms_legs_and_trunk);
    RUN_TEST(test_markers_beside_the_joints_give_every_rotation);
    RUN_TEST(test_markers_with_permuted_names_are_not_bones);
    RUN_TEST(test_a_short_gap_of_a_marker_is_bridged);
    RUN_TEST(test_a_long_gap_of_a_marker_leaves_its_joints_natural_with_a_note);
    RUN_TEST(test_the_arm_of_the_real_stroke_has_its_published_lengths);
    RUN_TEST(test_an_arm_of_anatomical_markers_is_found);
    return UNITY_END();
}
