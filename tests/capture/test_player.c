/// test_player.c: from a take's skeleton back to the body that made it, for any names of joints,
/// zero pose and unit; impossible bodies are refused.
#include "read_players.h"

static void test_measures_of_a_skeleton_take_are_those_of_the_body(void)
{
    himc_skeleton_config config = another_player();
    make_take(&config);
    read_player();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.88, player->config.height);
    TEST_ASSERT_EQUAL_STRING("legs and trunk", player->height_from);
    for (int i = HIMC_LEFT_UPPER_ARM; i < HIMC_LEFT_STICK; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, skeleton.segment[i].length, player->config.length[i]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.40, player->config.stick_length);
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-6, 0,
        himc_vec3_length(himc_vec3_sub(player->hips, skeleton.segment[HIMC_PELVIS].origin)));
}

static void test_mass_that_is_not_stated_keeps_the_body_mass_index(void)
{
    himc_skeleton_config config = another_player();
    make_take(&config);
    given.height = 1.6;
    given.mass = 64; // 25 kg/m^2
    read_player();
    TEST_ASSERT_FALSE(player->mass_stated);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 25 * 1.88 * 1.88, player->config.mass);
}

static void test_mass_and_height_stated_by_the_file_are_used(void)
{
    make_take(&given);
    take->mass = 68;
    take->height = 1.71;
    read_player();
    TEST_ASSERT_TRUE(player->mass_stated);
    TEST_ASSERT_EQUAL_DOUBLE(68, player->config.mass);
    TEST_ASSERT_EQUAL_DOUBLE(1.71, player->config.height);
}

static void test_poses_of_a_skeleton_take_come_back_unchanged(void)
{
    himc_skeleton_config config = another_player();
    make_take(&config);
    read_player();
    TEST_ASSERT_EQUAL_INT(HIMC_JOINTS, known_joints());
    TEST_ASSERT_TRUE(worst_angle(0, HIMC_JOINTS) < 1e-6);
    TEST_ASSERT_TRUE(worst_tip() < 1e-6);
}

static void test_poses_survive_a_bvh_file(void)
{
    make_take(&given);
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, "build/saved-player.bvh", &error), error.text);
    himc_take_free(take);
    take = himc_take_load("build/saved-player.bvh", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    read_player();
    TEST_ASSERT_EQUAL_INT(HIMC_JOINTS, known_joints());
    TEST_ASSERT_TRUE(worst_angle(0, HIMC_JOINTS) < 1e-5);
    TEST_ASSERT_TRUE(worst_tip() < 1e-5);
}

static void test_the_mean_pose_has_intermediate_joints(void)
{
    make_take(&given);
    read_player();
    int elbow = himc_joint_find("right-elbow");
    himc_vec3 sum = {0, 0, 0};
    himc_quat back = himc_quat_conj(player->mean.joint[elbow]);
    for (int i = 0; i < FRAMES; i++)
        sum = himc_vec3_madd(sum, 1.0 / FRAMES,
                             himc_quat_log(himc_quat_mul(back, player->pose[i].joint[elbow])));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, himc_vec3_length(sum));
}

// changes the file's zero pose: segment i is rotated by align[i]
static void turn_zero_pose(const himc_quat align[HIMC_SEGMENTS])
{
    for (int i = 0; i < take->points; i++) {
        int parent = take->parents[i];
        himc_quat above = parent < 0 ? himc_quat_identity() : align[parent];
        take->offsets[i] = himc_quat_rotate(above, take->offsets[i]);
        for (int frame = 0; frame < take->frames && i < HIMC_SEGMENTS; frame++) {
            himc_quat *q = &take->rotations[(size_t)frame * (size_t)take->points + (size_t)i];
            *q = himc_quat_mul(himc_quat_mul(above, *q), himc_quat_conj(align[i]));
        }
    }
}

static void test_a_t_pose_with_palms_down_gives_the_same_poses(void)
{
    himc_quat align[HIMC_SEGMENTS];
    make_take(&given);
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        align[i] = himc_quat_identity();
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double side = hand == HIMC_LEFT ? 1 : -1;
        himc_quat out = himc_quat_exp(himc_vec3_make(side * HIMC_PI / 2, 0, 0));
        // hanging palms face back; sideways, thumbs forward, they face down
        himc_quat roll = himc_quat_exp(himc_vec3_make(0, 0, side * HIMC_PI / 2));
        align[HIMC_LEFT_UPPER_ARM + hand] = out;
        for (int i = HIMC_LEFT_FOREARM; i <= HIMC_LEFT_STICK; i += 2)
            align[i + hand] = himc_quat_mul(out, roll);
    }
    turn_zero_pose(align);
    TEST_ASSERT_TRUE(take->offsets[HIMC_LEFT_HAND].y > 0.2); // arms are spread
    TEST_ASSERT_TRUE(take->offsets[HIMC_RIGHT_HAND].y < -0.2);
    read_player();
    TEST_ASSERT_TRUE(worst_angle(0, HIMC_JOINTS) < 1e-6);
}

static void rename_points(const char *const (*names)[2], size_t count)
{
    for (size_t i = 0; i < count; i++) {
        int point = himc_take_find(take, names[i][0]);
        TEST_ASSERT_TRUE(point >= 0);
        himc_take_set_name(take, point, names[i][1], strlen(names[i][1]));
    }
}

static void test_the_names_of_another_skeleton_are_understood(void)
{
    static const char *const names[][2] = {
        {"LeftArm", "LeftShoulder"},    {"RightArm", "RightShoulder"}, {"LeftForeArm", "LeftElbow"},
        {"RightForeArm", "RightElbow"}, {"LeftHand", "LeftWrist"},     {"RightHand", "RightWrist"},
        {"LeftUpLeg", "LeftHip"},       {"RightUpLeg", "RightHip"},    {"LeftLeg", "LeftKnee"},
        {"RightLeg", "RightKnee"},      {"LeftFoot", "LeftAnkle"},     {"RightFoot", "RightAnkle"},
        {"Spine", "lowerback"},         {"LeftStick", "mallet_l"},     {"RightStick", "mallet_r"}};
    make_take(&given);
    rename_points(names, sizeof names / sizeof names[0]);
    read_player();
    TEST_ASSERT_EQUAL_INT(HIMC_JOINTS, known_joints());
    TEST_ASSERT_TRUE(worst_angle(0, HIMC_JOINTS) < 1e-6);
}

static void test_left_and_right_exchanged_are_refused_with_a_line(void)
{
    make_take(&given);
    exchange_names("LeftArm", "RightArm");
    exchange_names("LeftForeArm", "RightForeArm");
    exchange_names("LeftHand", "RightHand");
    TEST_ASSERT_NULL(himc_player_new(take, NULL, &given, &error));
    TEST_ASSERT_EQUAL_STRING("build/player.bvh: player: the left shoulder is over the right hip, "
                             "expected over the left one: are left and right exchanged?",
                             error.text);
}

static void test_a_missing_joint_removes_only_its_own_rotations(void)
{
    static const char *const names[][2] = {{"LeftForeArm", "thing"}};
    make_take(&given);
    rename_points(names, 1);
    read_player();
    TEST_ASSERT_FALSE(player->known[himc_joint_find("left-shoulder")]);
    TEST_ASSERT_FALSE(player->known[himc_joint_find("left-elbow")]);
    TEST_ASSERT_TRUE(player->known[himc_joint_find("right-elbow")]);
    TEST_ASSERT_TRUE(player->known[himc_joint_find("waist")]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, player->config.length[HIMC_RIGHT_UPPER_ARM],
                              player->config.length[HIMC_LEFT_UPPER_ARM]);
}

static void test_a_player_of_seventeen_metres_is_refused_with_a_line(void)
{
    make_take(&given);
    for (int i = 0; i < take->points; i++)
        take->offsets[i] = himc_vec3_scale(take->offsets[i], 10);
    for (size_t i = 0; i < (size_t)take->points * (size_t)take->frames; i++)
        take->x[i] = himc_vec3_scale(take->x[i], 10);
    player = himc_player_new(take, NULL, &given, &error);
    TEST_ASSERT_NULL(player);
    TEST_ASSERT_EQUAL_STRING("build/player.bvh: player: left-upper-arm of 2.83 m, expected 0.14 .. "
                             "0.45 m: is the unit right?",
                             error.text);
}

// the take as a file in another unit
static himc_take *in_units(double unit)
{
    himc_take_options options = himc_take_default();
    TEST_ASSERT_TRUE_MESSAGE(himc_take_save(take, "build/saved-player.bvh", &error), error.text);
    options.unit = 0.01 * unit; // the file has cm: read them as something else, and write again
    himc_take *scaled = himc_take_load("build/saved-player.bvh", &options, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(scaled, error.text);
    bool saved = himc_take_save(scaled, "build/saved-player.bvh", &error);
    himc_take_free(scaled);
    TEST_ASSERT_TRUE_MESSAGE(saved, error.text);
    return himc_take_load("build/saved-player.bvh", NULL, &error);
}

static void test_inches_and_feet_are_known_by_the_players_size(void)
{
    static const double units[] = {1 / 2.54, 1 / 30.48}; // of a cm
    make_take(&given);
    for (int i = 0; i < 2; i++) {
        himc_take *other = in_units(units[i]);
        TEST_ASSERT_NOT_NULL_MESSAGE(other, error.text);
        himc_player *same = himc_player_new(other, NULL, &given, &error);
        TEST_ASSERT_NOT_NULL_MESSAGE(same, error.text);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.75, same->config.height);
        himc_player_free(same);
        himc_take_free(other);
    }
}

static void test_a_skeleton_of_unknown_unit_is_refused_with_a_line(void)
{
    make_take(&given);
    himc_take *other = in_units(0.06); // 17 cm
    TEST_ASSERT_NULL(other);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "inches or feet no player's size"), error.text);
    TEST_ASSERT_NULL(strchr(error.text, '\n'));
}

static void test_metres_ten_times_too_long_are_refused_with_a_line(void)
{
    make_take(&given);
    himc_take *other = in_units(0.1);
    TEST_ASSERT_NOT_NULL_MESSAGE(other, error.text); // plausible as a child in CMU's units
    TEST_ASSERT_NULL(himc_player_new(other, NULL, &given, &error));
    himc_take_free(other);
    TEST_ASSERT_EQUAL_STRING(
        "build/saved-player.bvh: player: height: 0.987778 m, expected 1.19 .. 2.21 m", error.text);
}

static void test_a_cmu_skeleton_gives_a_player_of_human_size(void)
{
    if (!load_shared("cmu131_bvh_120hz/131_03.bvh"))
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    TEST_ASSERT_TRUE(player->config.height > 1.45 && player->config.height < 1.9);
    TEST_ASSERT_TRUE(player->known[himc_joint_find("left-elbow")]);
    TEST_ASSERT_TRUE(player->known[himc_joint_find("right-knee")]);
    // knees and elbows bend one way: backwards and forwards
    for (int i = 0; i < player->frames; i += 10) {
        himc_vec3 knee = himc_quat_log(player->pose[i].joint[himc_joint_find("left-knee")]);
        himc_vec3 elbow = himc_quat_log(player->pose[i].joint[himc_joint_find("left-elbow")]);
        TEST_ASSERT_TRUE(knee.y > -0.3);
        TEST_ASSERT_TRUE(elbow.y < 0.3);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_measures_of_a_skeleton_take_are_those_of_the_body);
    RUN_TEST(test_mass_that_is_not_stated_keeps_the_body_mass_index);
    RUN_TEST(test_mass_and_height_stated_by_the_file_are_used);
    RUN_TEST(test_poses_of_a_skeleton_take_come_back_unchanged);
    RUN_TEST(test_poses_survive_a_bvh_file);
    RUN_TEST(test_the_mean_pose_has_intermediate_joints);
    RUN_TEST(test_a_t_pose_with_palms_down_gives_the_same_poses);
    RUN_TEST(test_the_names_of_another_skeleton_are_understood);
    RUN_TEST(test_left_and_right_exchanged_are_refused_with_a_line);
    RUN_TEST(test_a_missing_joint_removes_only_its_own_rotations);
    RUN_TEST(test_a_player_of_seventeen_metres_is_refused_with_a_line);
    RUN_TEST(test_inches_and_feet_are_known_by_the_players_size);
    RUN_TEST(test_a_skeleton_of_unknown_unit_is_refused_with_a_line);
    RUN_TEST(test_metres_ten_times_too_long_are_refused_with_a_line);
    RUN_TEST(test_a_cmu_skeleton_gives_a_player_of_human_size);
    return UNITY_END();
}
