/// test_bvh.c: BVH files against forward kinematics computed by hand, and files with one error.
#include "take_files.h"
#include "unity.h"

#include <locale.h>

static himc_error error;

void setUp(void)
{
}

void tearDown(void)
{
}

// a root and an arm with the end of a hand, in metres; channels and rows are inserted
#define SKELETON                                                                                   \
    "HIERARCHY\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Xposition Yposition Zposition %s\n"       \
    "\tJOINT Arm\n\t{\n\t\tOFFSET 0 1 0\n\t\tCHANNELS 3 %s\n\t\tJOINT Hand\n {\n OFFSET 0.5 0 0\n" \
    "CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 0 0.25\n}\n}\n}\n}\n"         \
    "MOTION\nFrames: %d\nFrame Time: 0.01\n%s"

static himc_take *read_arm(const char *root, const char *arm, int frames, const char *rows)
{
    char text[2000];
    snprintf(text, sizeof text, SKELETON, root, arm, frames, rows);
    return read_text(text, "arm.bvh", NULL, &error);
}

#define ZYX "Zrotation Yrotation Xrotation"

static void check_point(const himc_take *take, int frame, const char *name, double x, double y,
                        double z)
{
    int point = himc_take_find(take, name);
    TEST_ASSERT_TRUE_MESSAGE(point >= 0, name);
    himc_vec3 p = himc_take_point(take, frame, point);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-12, x, p.x, name);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-12, y, p.y, name);
    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-12, z, p.z, name);
}

static void test_zero_pose_adds_offsets_and_y_up_becomes_z_up(void)
{
    himc_take *take = read_arm(ZYX, ZYX, 1, "1 2 3 0 0 0 0 0 0 0 0 0\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_EQUAL_INT(4, himc_take_points(take));
    check_point(take, 0, "Hips", 1, -3, 2);
    check_point(take, 0, "Arm", 1, -3, 3);
    check_point(take, 0, "Hand", 1.5, -3, 3);
    check_point(take, 0, "Hand_end", 1.5, -3.25, 3);
    himc_take_free(take);
}

static void test_channel_order_decides_which_rotation_is_outermost(void)
{
    // Z then X: R = Rz(90) Rx(90) takes the bone (0.5, 0, 0) to (0, 0.5, 0); X then Z takes it to
    // (0, 0, 0.5)
    himc_take *zx =
        read_arm(ZYX, "Zrotation Xrotation Yrotation", 1, "0 0 0 0 0 0 90 90 0 0 0 0\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(zx, error.text);
    check_point(zx, 0, "Hand", 0, 0, 1.5);
    himc_take_free(zx);
    himc_take *xz =
        read_arm(ZYX, "Xrotation Zrotation Yrotation", 1, "0 0 0 0 0 0 90 90 0 0 0 0\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(xz, error.text);
    check_point(xz, 0, "Hand", 0, -0.5, 1);
    himc_take_free(xz);
}

static void test_permuted_position_channels_are_read_by_name(void)
{
    const char *text =
        "HIERARCHY\nROOT A {\nOFFSET 0 0 0\nCHANNELS 6 Zrotation Zposition Xrotation "
        "Yposition Yrotation Xposition\nEnd Site {\nOFFSET 0 1.5 0\n} }\nMOTION\r\nFrames: 1\r\n"
        "Frame Time: .01\r\n0 3 0 2 90 1\r\n";
    himc_take *take = read_text(text, "a.BVH", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    check_point(take, 0, "A", 1, -3, 2);
    check_point(take, 0, "A_end", 1, -3, 3.5);
    himc_take_free(take);
}

static void test_position_channels_of_a_joint_replace_its_offset(void)
{
    const char *text =
        "HIERARCHY\nROOT A\n{\nOFFSET 5 5 5\nCHANNELS 3 Xposition Yposition Zposition\nJOINT B\n{\n"
        "OFFSET 0 1 0\nCHANNELS 1 Xposition\nEnd Site\n{\nOFFSET 0 0.8 0\n}\n}\n}\n"
        "MOTION\nFrames: 1\nFrame Time: 0.01\n1 1 1 0.5\n";
    himc_take *take = read_text(text, "a.bvh", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    check_point(take, 0, "A", 1, -1, 1);
    check_point(take, 0, "B", 1.5, -1, 2);
    himc_take_free(take);
}

// computes the points from the rotations and offsets of the take, as its header promises
static double worst_forward_kinematics(const himc_take *take, int frame)
{
    himc_quat world[256];
    double worst = 0;
    for (int i = 0; i < himc_take_points(take); i++) {
        int parent = himc_take_parent(take, i);
        world[i] = himc_take_rotation(take, frame, i);
        if (parent < 0)
            continue;
        himc_vec3 x = himc_quat_rotate(world[parent], himc_take_offset(take, i));
        x = himc_vec3_add(himc_take_point(take, frame, parent), x);
        worst = fmax(worst, himc_vec3_length(himc_vec3_sub(x, himc_take_point(take, frame, i))));
        world[i] = himc_quat_mul(world[parent], world[i]);
    }
    return worst;
}

static void test_rotations_and_offsets_reproduce_the_points(void)
{
    himc_take *take =
        read_arm("Yrotation Zrotation Xrotation", ZYX, 2,
                 "1 2 3 10 20 30 40 50 60 70 80 90\n0 0 0 -5 170 3 1 2 3 -100 20 7\n");
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_TRUE(himc_take_has_skeleton(take));
    for (int frame = 0; frame < 2; frame++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, worst_forward_kinematics(take, frame));
    himc_take_free(take);
}

// the real capture; skipped if it is absent
static himc_take *load_hop(void)
{
    const char *path = shared_capture("cmu131_bvh_120hz/131_03.bvh");
    if (!path)
        TEST_IGNORE_MESSAGE("../shared/mocap is absent");
    himc_take *take = himc_take_load(path, NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static void test_cmu_capture_equals_independently_computed_matrices(void)
{
    // y up, metres, from rotation matrices by an independent program; frames 0 and 700
    static const struct {
        int frame;
        const char *name;
        himc_vec3 x;
    } known[] = {{0, "LFingers_end", {0.445818578, 0.815436368, -1.564029891}},
                 {0, "RFingers_end", {0.105993690, 0.776577816, -1.597158218}},
                 {0, "Head_end", {0.292280307, 1.452992689, -1.660665206}},
                 {0, "LeftToe_end", {0.367981751, 0.036321675, -1.495600866}},
                 {700, "LFingers_end", {0.582085836, 0.842439300, -0.231151743}},
                 {700, "RFingers_end", {0.382056472, 1.270593496, -0.055346103}},
                 {700, "Head_end", {0.414197315, 1.433891605, -0.168147505}},
                 {700, "LeftToe_end", {0.559302290, 0.062474213, -0.245799634}}};
    himc_take *take = load_hop();
    TEST_ASSERT_EQUAL_INT(1102, himc_take_frames(take));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 120, himc_take_rate(take));
    TEST_ASSERT_EQUAL_INT(38, himc_take_points(take));
    // the heading is rotated by some angle about the vertical: found from the first position, it
    // must fit all of them
    himc_vec3 p = himc_take_point(take, 0, himc_take_find(take, known[0].name));
    double turn = atan2(p.y, p.x) - atan2(-known[0].x.z, known[0].x.x);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        himc_vec3 k = known[i].x;
        p = himc_take_point(take, known[i].frame, himc_take_find(take, known[i].name));
        TEST_ASSERT_DOUBLE_WITHIN(2e-9, k.x * cos(turn) + k.z * sin(turn), p.x);
        TEST_ASSERT_DOUBLE_WITHIN(2e-9, k.x * sin(turn) - k.z * cos(turn), p.y);
        TEST_ASSERT_DOUBLE_WITHIN(2e-9, k.y, p.z);
    }
    himc_take_free(take);
}

static void test_cmu_player_is_of_human_size_and_faces_along_x(void)
{
    himc_take *take = load_hop();
    himc_vec3 sum = {0, 0, 0};
    double height = 0;
    int l = himc_take_find(take, "LeftHip"), r = himc_take_find(take, "RightHip");
    for (int frame = 0; frame < himc_take_frames(take); frame++) {
        sum = himc_vec3_add(
            sum, himc_vec3_sub(himc_take_point(take, frame, l), himc_take_point(take, frame, r)));
        height = fmax(height, himc_take_point(take, frame, himc_take_find(take, "Head_end")).z);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * sum.y, 0, sum.x);
    TEST_ASSERT_TRUE(sum.y > 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.25, 1.6, height);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, worst_forward_kinematics(take, 555));
    // also in the zero pose left is +y and toes point along x
    himc_vec3 toe = himc_take_offset(take, himc_take_find(take, "LeftToe_end"));
    TEST_ASSERT_TRUE(toe.x > 0.9 * himc_vec3_length(toe));
    TEST_ASSERT_TRUE(himc_take_offset(take, himc_take_find(take, "LeftHip")).y > 0.05);
    himc_take_free(take);
}

// a body of `size` units in all, two bones
static himc_take *read_of_size(double size)
{
    char text[600];
    snprintf(text, sizeof text,
             "HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\nJOINT B\n{\nOFFSET 0 %g 0\n"
             "End Site\n{\nOFFSET 0 %g 0\n}\n}\n}\nMOTION\nFrames: 1\nFrame Time: 0.01\n0.00000\n",
             size / 2, size / 2);
    return read_text(text, "size.bvh", NULL, &error);
}

static void test_units_are_guessed_from_the_skeletons_size(void)
{
    static const double size[] = {1.7, 170, 1700, 30},
                        metres[] = {1.7, 1.7, 1.7, 30 * 0.0254 / 0.45};
    for (int i = 0; i < 4; i++) {
        himc_take *take = read_of_size(size[i]);
        TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, metres[i], himc_take_point(take, 0, 2).z);
        himc_take_free(take);
    }
}

static void test_a_17_metre_player_is_refused_unless_the_unit_is_given(void)
{
    TEST_ASSERT_NULL(read_of_size(17));
    TEST_ASSERT_NOT_NULL(
        strstr(error.text, "size.bvh: skeleton: the longest path along its bones is 17 units"));
    himc_take_options options = himc_take_default();
    options.unit = 0.1;
    const char *text = "HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\n"
                       "End Site\n{\nOFFSET 0 17 0\n}\n}\n"
                       "MOTION\nFrames: 1\nFrame Time: 0.01\n0.5\n";
    himc_take *take = read_text(text, "size.bvh", &options, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    check_point(take, 0, "A_end", 0.05, 0, 1.7);
    himc_take_free(take);
}

static void refuses_rows(int frames, const char *rows, const char *reason)
{
    himc_take *take = read_arm(ZYX, ZYX, frames, rows);
    TEST_ASSERT_NULL_MESSAGE(take, reason);
    TEST_ASSERT_EQUAL_STRING(reason, error.text);
}

static void test_rows_that_do_not_fit_are_refused_with_line_and_joint(void)
{
    refuses_rows(2, "0 0 0 0 0 0 0 0 0 0 0 0\n",
                 "arm.bvh: the header says 2 frames, the file has 1 rows");
    refuses_rows(1, "", "arm.bvh: the header says 1 frames, the file has 0 rows");
    refuses_rows(1, "0 0 0 0 0 0 0 0 0 0 0\n",
                 "arm.bvh:24: the row ends before channel 3 of Hand, expected rows of 12 numbers");
    refuses_rows(1, "0 0 0 0 0 0 0 0 0 0 0 0 0\n",
                 "arm.bvh:24: after the row's last channel \"0\", expected a new line");
    refuses_rows(1, "0 0 0 0 0 0 nan 0 0 0 0 0\n",
                 "arm.bvh:24: Arm \"nan\", expected a number up to 1e8");
    refuses_rows(1, "0 0 0 0 0 0 0 0 0 1e999 0 0\n",
                 "arm.bvh:24: Hand \"1e999\", expected a number up to 1e8");
    refuses_rows(1, "0,5 0 0 0 0 0 0 0 0 0 0 0\n",
                 "arm.bvh:24: Hips \"0,5\", expected a number up to 1e8");
}

static void refuses(const char *text, const char *reason)
{
    himc_take *take = read_text(text, "x.bvh", NULL, &error);
    TEST_ASSERT_NULL_MESSAGE(take, reason);
    TEST_ASSERT_EQUAL_STRING(reason, error.text);
}

static void test_broken_hierarchies_are_refused_with_the_line(void)
{
    refuses("", "x.bvh: the file is empty");
    refuses("hello", "x.bvh:1: the first line \"hello\", expected HIERARCHY");
    refuses("HIERARCHY\nMOTION\n", "x.bvh:2: before any joint \"MOTION\", expected ROOT");
    refuses("HIERARCHY\nROOT A\n{\n}\n",
            "x.bvh:4: joint A has no OFFSET, expected one for each joint");
    refuses("HIERARCHY\nROOT A\n{\nOFFSET 0 x 0",
            "x.bvh:4: OFFSET \"x\", expected a number up to 1e8");
    refuses("HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\nCHANNELS 2 Xrotation Xrotation\n",
            "x.bvh:5: channel \"Xrotation\", expected X, Y, Z position or rotation, each once");
    refuses("HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\nCHANNELS 7\n",
            "x.bvh:5: CHANNELS \"7\", expected 0 .. 6, once for each joint");
    refuses("HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\n}\n"
            "MOTION\nFrames: 0\nFrame Time: 0.01\n",
            "x.bvh:8: Frames: \"0\", expected 1 .. 1000000");
    refuses("HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\n}\n"
            "MOTION\nFrames: 1\nFrame Time: 1\n0\n",
            "x.bvh:9: Frame Time: 1 s, expected 0.0001 .. 0.05 s");
}

static void test_deep_nesting_is_refused_without_recursion(void)
{
    size_t size = 0;
    char *text = malloc(40000);
    size += (size_t)sprintf(text, "HIERARCHY\nROOT A\n{\nOFFSET 0 0 0\n");
    for (int i = 0; i < 1000; i++)
        size += (size_t)sprintf(text + size, "JOINT B\n{\nOFFSET 0 1 0\n");
    TEST_ASSERT_NULL(himc_take_read(text, size, "deep.bvh", NULL, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "joints are nested too deeply, expected 256 levels"));
    free(text);
}

#define HUB "A_joint_with_a_name_of_forty_characters_"

// a hub with so many end sites
static himc_take *read_hub(int ends)
{
    char *text = malloc((size_t)ends * 32 + 200), *s = text;
    s += sprintf(s, "HIERARCHY\nROOT " HUB
                    "\n{\nOFFSET 0 1 0\nCHANNELS 6 Xposition Yposition Zposition " ZYX "\n");
    for (int i = 0; i < ends; i++)
        s += sprintf(s, "End Site\n{\nOFFSET 0 0.%d 0\n}\n", 1 + i % 9);
    sprintf(s, "}\nMOTION\nFrames: 1\nFrame Time: 0.01\n0 0 0 0 0 0\n");
    himc_take *take = read_text(text, "hub.bvh", NULL, &error);
    free(text);
    return take;
}

static char described[20000];

static void hear(void *user, const char *line)
{
    (void)user;
    TEST_ASSERT_TRUE(strlen(line) < 256);
    strcat(strcat(described, line), "\n");
}

static void test_end_sites_of_one_joint_have_names_of_their_own_and_all_are_listed(void)
{
    himc_take *take = read_hub(6);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    check_point(take, 0, HUB "_end", 0, 0, 0.1);
    check_point(take, 0, HUB "_end5", 0, 0, 0.5);
    himc_take_describe(take, NULL, hear, NULL);
    TEST_ASSERT_NOT_NULL(strstr(described, "joints 7: " HUB " " HUB "_end\n    " HUB "_end2 "));
    TEST_ASSERT_NOT_NULL(strstr(described, " " HUB "_end6\n"));
    himc_take_free(take);
    TEST_ASSERT_NULL(read_hub(4096));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, ": too many joints, expected 4096"),
                                 error.text);
}

static void test_every_prefix_of_a_file_is_refused_or_read(void)
{
    char text[2000];
    snprintf(text, sizeof text, SKELETON, ZYX, ZYX, 2,
             "1 2 3 0 0 0 0 0 0 0 0 0\n1 2 3 0 0 0 0 0 0 0 0 0.5\n");
    size_t whole = strlen(text);
    for (size_t size = 0; size < whole; size++) {
        // a copy of exact size, so that the address sanitizer detects a byte too far
        char *bytes = malloc(size + (size == 0));
        memcpy(bytes, text, size);
        himc_take *take = himc_take_read(bytes, size, "cut.bvh", NULL, &error);
        TEST_ASSERT_TRUE(take == NULL || size + 3 >= whole);
        himc_take_free(take);
        free(bytes);
    }
}

int main(void)
{
    // a locale with decimal commas, if installed, must not change a number
    setlocale(LC_ALL, "de_DE.UTF-8");
    UNITY_BEGIN();
    RUN_TEST(test_zero_pose_adds_offsets_and_y_up_becomes_z_up);
    RUN_TEST(test_channel_order_decides_which_rotation_is_outermost);
    RUN_TEST(test_permuted_position_channels_are_read_by_name);
    RUN_TEST(test_position_channels_of_a_joint_replace_its_offset);
    RUN_TEST(test_rotations_and_offsets_reproduce_the_points);
    RUN_TEST(test_cmu_capture_equals_independently_computed_matrices);
    RUN_TEST(test_cmu_player_is_of_human_size_and_faces_along_x);
    RUN_TEST(test_units_are_guessed_from_the_skeletons_size);
    RUN_TEST(test_a_17_metre_player_is_refused_unless_the_unit_is_given);
    RUN_TEST(test_rows_that_do_not_fit_are_refused_with_line_and_joint);
    RUN_TEST(test_broken_hierarchies_are_refused_with_the_line);
    RUN_TEST(test_deep_nesting_is_refused_without_recursion);
    RUN_TEST(test_end_sites_of_one_joint_have_names_of_their_own_and_all_are_listed);
    RUN_TEST(test_every_prefix_of_a_file_is_refused_or_read);
    return UNITY_END();
}
