/// test_skeleton.c: the table of the body: its tree, masses, de Leva's numbers, refused values.
#include "himc/body.h"

#include "unity.h"

#include <string.h>

static himc_error error;
static himc_skeleton_config config;
static himc_skeleton skeleton;

void setUp(void)
{
    error.text[0] = 0;
    config = himc_skeleton_default();
}

void tearDown(void)
{
}

static void build(void)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_skeleton_init(&skeleton, &config, &error), error.text);
}

static double mass_without_sticks(void)
{
    double sum = 0;
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        sum += skeleton.segment[i].mass;
    return sum - skeleton.segment[HIMC_LEFT_STICK].mass - skeleton.segment[HIMC_RIGHT_STICK].mass;
}

static void test_body_is_a_tree_of_20_segments_19_joints_57_degrees_of_freedom(void)
{
    build();
    TEST_ASSERT_EQUAL_INT(20, HIMC_SEGMENTS);
    TEST_ASSERT_EQUAL_INT(19, HIMC_JOINTS);
    TEST_ASSERT_EQUAL_INT(57, HIMC_DOF);
    TEST_ASSERT_EQUAL_INT(-1, skeleton.segment[HIMC_PELVIS].parent);
    TEST_ASSERT_EQUAL_INT(HIMC_JOINT_FIXED, skeleton.segment[HIMC_PELVIS].joint);
    for (int i = 1; i < HIMC_SEGMENTS; i++) {
        // parents first: every sweep over the table relies on it
        TEST_ASSERT_TRUE(skeleton.segment[i].parent >= 0);
        TEST_ASSERT_TRUE(skeleton.segment[i].parent < i);
        TEST_ASSERT_EQUAL_INT(HIMC_JOINT_BALL, skeleton.segment[i].joint);
    }
}

static void test_arm_is_trunk_upper_arm_forearm_hand_stick(void)
{
    build();
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int i = himc_stick_segment((himc_hand)hand);
        for (int k = HIMC_ARM_JOINTS - 1; k >= 0; k--) {
            TEST_ASSERT_EQUAL_INT(i, himc_arm_joint((himc_hand)hand, k) + 1);
            i = skeleton.segment[i].parent;
        }
        TEST_ASSERT_EQUAL_INT(HIMC_TRUNK, i);
    }
}

static void test_every_joint_is_found_by_its_own_name(void)
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        TEST_ASSERT_EQUAL_INT(j, himc_joint_find(himc_joint_name(j)));
    TEST_ASSERT_EQUAL_INT(himc_arm_joint(HIMC_LEFT, 0), himc_joint_find("left-shoulder"));
    TEST_ASSERT_EQUAL_INT(himc_arm_joint(HIMC_RIGHT, 3), himc_joint_find("right-grip"));
    TEST_ASSERT_EQUAL_INT(-1, himc_joint_find("tail"));
    TEST_ASSERT_EQUAL_INT(-1, himc_joint_find(""));
    TEST_ASSERT_EQUAL_STRING("left-stick", himc_segment_name(HIMC_LEFT_STICK));
    TEST_ASSERT_EQUAL_STRING("pelvis", himc_segment_name(HIMC_PELVIS));
}

static void test_masses_sum_to_the_performer_in_both_anthropometries(void)
{
    for (int a = HIMC_DE_LEVA; a <= HIMC_TABLE_1; a++)
        for (double mass = 30; mass <= 200; mass += 17) {
            config.anthropometry = (himc_anthropometry)a;
            config.mass = mass;
            build();
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * mass, mass, mass_without_sticks());
        }
}

// The printed rows sum to 100 %, so a row is all of its segments: both limbs of a pair.
static void test_a_row_of_table_1_is_both_limbs_of_a_pair(void)
{
    static const struct {
        double percent;
        int segment[4], count;
    } rows[] = {{4, {HIMC_HEAD}, 1},
                {4, {HIMC_NECK}, 1},
                {46, {HIMC_TRUNK}, 1},
                {4, {HIMC_LEFT_UPPER_ARM, HIMC_RIGHT_UPPER_ARM}, 2},
                {2, {HIMC_LEFT_FOREARM, HIMC_RIGHT_FOREARM}, 2},
                {1, {HIMC_LEFT_HAND, HIMC_RIGHT_HAND}, 2},
                {0.5, {0}, 0}, // sticks, of absolute mass here
                {18, {HIMC_PELVIS}, 1},
                {14, {HIMC_LEFT_UPPER_LEG, HIMC_RIGHT_UPPER_LEG}, 2},
                {5, {HIMC_LEFT_LOWER_LEG, HIMC_RIGHT_LOWER_LEG}, 2},
                {1.5, {HIMC_LEFT_FOOT, HIMC_RIGHT_FOOT, HIMC_LEFT_TOES, HIMC_RIGHT_TOES}, 4}};
    double printed = 0, sticks = 0.5;
    config.anthropometry = HIMC_TABLE_1;
    build();
    for (int k = 0; k < 11; k++) {
        double sum = 0;
        for (int i = 0; i < rows[k].count; i++)
            sum += skeleton.segment[rows[k].segment[i]].mass;
        if (rows[k].count > 0)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, rows[k].percent / (100 - sticks),
                                      sum / mass_without_sticks());
        printed += rows[k].percent;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 100, printed);
}

// mass (kg), centre (of the length), inertias (kg m^2): de Leva 1996 at 75 kg and 1.75 m, to the
// digit
static void test_arm_has_the_masses_and_inertias_of_de_leva(void)
{
    static const struct {
        int segment;
        double mass, center, inertia[3], digit;
    } known[] = {{HIMC_LEFT_UPPER_ARM, 2.0325, 0.5772, {0.0132, 0.0118, 0.0041}, 5e-5},
                 {HIMC_LEFT_FOREARM, 1.215, 0.4574, {0.0068, 0.0062, 0.0013}, 5e-5},
                 {HIMC_LEFT_HAND, 0.4575, 0.7900, {0.00135, 0.00090, 0.00055}, 5e-6}};
    build();
    for (int k = 0; k < 6; k++) {
        const himc_segment *s = &skeleton.segment[known[k / 2].segment + k % 2];
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, known[k / 2].mass, s->mass);
        TEST_ASSERT_DOUBLE_WITHIN(known[k / 2].digit, known[k / 2].inertia[0], s->inertia.x);
        TEST_ASSERT_DOUBLE_WITHIN(known[k / 2].digit, known[k / 2].inertia[1], s->inertia.y);
        TEST_ASSERT_DOUBLE_WITHIN(known[k / 2].digit, known[k / 2].inertia[2], s->inertia.z);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, -known[k / 2].center * s->length, s->center.z);
    }
}

// masses (of the body's), centres and radii of gyration (of the length), de Leva 1996; his foot is
// parted into foot and toes, which keep its mass
static void test_legs_have_the_masses_centres_and_radii_of_de_leva(void)
{
    static const struct {
        int segment;
        double mass, center, radius[3];
    } known[] = {{HIMC_LEFT_UPPER_LEG, 0.1416, 0.4095, {0.329, 0.329, 0.149}},
                 {HIMC_LEFT_LOWER_LEG, 0.0433, 0.4459, {0.255, 0.249, 0.103}},
                 {HIMC_LEFT_FOOT, 0.85 * 0.0137, 0.33, {0.124, 0.257, 0.245}},
                 {HIMC_LEFT_TOES, 0.15 * 0.0137, 0.5, {0.3, 0.35, 0.35}}};
    build();
    for (int k = 0; k < 8; k++) {
        const himc_segment *s = &skeleton.segment[known[k / 2].segment + k % 2];
        const double *radius = known[k / 2].radius, size = s->mass * s->length * s->length;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, known[k / 2].mass * 75, s->mass);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, known[k / 2].center * s->length,
                                  himc_vec3_length(s->center));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, radius[0] * radius[0] * size, s->inertia.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, radius[1] * radius[1] * size, s->inertia.y);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, radius[2] * radius[2] * size, s->inertia.z);
    }
}

// upper and middle trunk as two bodies above the waist, at de Leva's own height
static void test_trunk_is_two_parts_merged_by_parallel_axes(void)
{
    config.height = 1.741;
    config.mass = 100;
    build();
    double m1 = 15.96, z1 = 0.2155 + 0.1707 - 0.2999 * 0.1707;
    double m2 = 16.33, z2 = 0.2155 - 0.4502 * 0.2155;
    double z = (m1 * z1 + m2 * z2) / (m1 + m2), reduced = m1 * m2 / (m1 + m2);
    double apart = reduced * (z1 - z2) * (z1 - z2);
    double ix = m1 * pow(0.716 * 0.1707, 2) + m2 * pow(0.482 * 0.2155, 2) + apart;
    double iy = m1 * pow(0.454 * 0.1707, 2) + m2 * pow(0.383 * 0.2155, 2) + apart;
    double iz = m1 * pow(0.659 * 0.1707, 2) + m2 * pow(0.468 * 0.2155, 2);
    const himc_segment *trunk = &skeleton.segment[HIMC_TRUNK];
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, m1 + m2, trunk->mass);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, z, trunk->center.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, ix, trunk->inertia.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, iy, trunk->inertia.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, iz, trunk->inertia.z);
}

// 25 g shaft and 20 g head, 0.36 m, held at 0.10 m: centre 0.252 m from the butt
static void test_default_mallet_has_the_expected_centre_and_inertias(void)
{
    build();
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const himc_segment *s = &skeleton.segment[himc_stick_segment((himc_hand)hand)];
        double center = -s->center.z, at_grip = s->inertia.y + s->mass * center * center;
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.045, s->mass);
        TEST_ASSERT_DOUBLE_WITHIN(5e-4, 0.252, center + 0.10);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 5.6e-4, s->inertia.x);
        TEST_ASSERT_DOUBLE_WITHIN(5e-5, 0.0016, at_grip);
        TEST_ASSERT_DOUBLE_WITHIN(2e-7, 3.0e-6, s->inertia.z);
    }
}

// rod and sphere integrated in slices, instead of the closed formulas
static void test_mallet_inertia_is_that_of_a_rod_and_a_ball_in_slices(void)
{
    config.stick_length = 0.42;
    config.grip = 0.13;
    config.mallet_radius = 0.025;
    build();
    int slices = 20000;
    double mass = 0, first = 0, second = 0, ball = 0.42 - 0.025 - 0.13;
    for (int i = 0; i < slices; i++) {
        double x = 0.42 * (i + 0.5) / slices - 0.13, dm = config.shaft_mass / slices;
        mass += dm, first += dm * x, second += dm * x * x;
        double u = 2 * (i + 0.5) / slices - 1, disc = 0.75 * (1 - u * u) * 2 / slices;
        double y = ball + 0.025 * u;
        dm = config.mallet_mass * disc;
        mass += dm, first += dm * y;
        second += dm * (y * y + 0.25 * 0.025 * 0.025 * (1 - u * u));
    }
    const himc_segment *s = &skeleton.segment[HIMC_RIGHT_STICK];
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, mass, s->mass);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, first / mass, -s->center.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * second, second - first * first / mass, s->inertia.x);
    TEST_ASSERT_EQUAL_DOUBLE(-ball, skeleton.tip.z);
}

static void test_left_and_right_mirror_each_other(void)
{
    build();
    for (int i = HIMC_LEFT_UPPER_ARM; i < HIMC_SEGMENTS; i += 2) {
        himc_segment l = skeleton.segment[i], r = skeleton.segment[i + 1];
        TEST_ASSERT_EQUAL_DOUBLE(l.origin.y, -r.origin.y);
        l.origin.y = r.origin.y;
        l.parent = r.parent;
        TEST_ASSERT_EQUAL_MEMORY(&l, &r, sizeof l);
    }
    TEST_ASSERT_TRUE(skeleton.segment[HIMC_LEFT_UPPER_ARM].origin.y > 0);
}

static void test_body_scales_with_height_and_mass(void)
{
    build();
    himc_skeleton small = skeleton;
    config.height *= 1.2;
    config.mass *= 1.5;
    build();
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        if (i == HIMC_LEFT_STICK || i == HIMC_RIGHT_STICK)
            continue;
        const himc_segment *a = &small.segment[i], *b = &skeleton.segment[i];
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.2 * a->length, b->length);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 1.5 * 1.44 * a->inertia.x, b->inertia.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.2 * himc_vec3_length(a->origin),
                                  himc_vec3_length(b->origin));
    }
}

static void test_stick_does_not_depend_on_the_body(void)
{
    build();
    himc_segment stick = skeleton.segment[HIMC_LEFT_STICK];
    config.height = 1.3;
    build();
    TEST_ASSERT_EQUAL_DOUBLE(stick.inertia.z, skeleton.segment[HIMC_LEFT_STICK].inertia.z);
    TEST_ASSERT_EQUAL_DOUBLE(stick.radius, skeleton.segment[HIMC_LEFT_STICK].radius);
}

static void test_inertias_obey_the_triangle_inequality(void)
{
    static const double height[] = {1.2, 1.75, 2.2};
    for (int k = 0; k < 3; k++) {
        config.height = height[k];
        build();
        for (int i = 0; i < HIMC_SEGMENTS; i++) {
            himc_vec3 j = skeleton.segment[i].inertia;
            TEST_ASSERT_TRUE_MESSAGE(j.x > 0 && j.y > 0 && j.z > 0, himc_segment_name(i));
            TEST_ASSERT_TRUE_MESSAGE(j.x + j.y >= j.z && j.y + j.z >= j.x && j.z + j.x >= j.y,
                                     himc_segment_name(i));
        }
    }
}

static void test_measured_lengths_are_used_and_move_the_next_joint(void)
{
    config.length[HIMC_LEFT_UPPER_ARM] = 0.333;
    config.length[HIMC_RIGHT_FOREARM] = 0.222;
    config.length[HIMC_LEFT_HAND] = 0.111;
    build();
    const himc_segment *s = skeleton.segment;
    TEST_ASSERT_EQUAL_DOUBLE(0.333, s[HIMC_LEFT_UPPER_ARM].length);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -0.333, s[HIMC_LEFT_FOREARM].origin.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -0.222, s[HIMC_RIGHT_HAND].origin.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, -0.111, s[HIMC_LEFT_STICK].origin.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5772 * 0.333, -s[HIMC_LEFT_UPPER_ARM].center.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.2817 * 1.75 / 1.741, s[HIMC_RIGHT_UPPER_ARM].length);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 75, mass_without_sticks());
}

static void test_seat_is_as_configured_or_from_the_height(void)
{
    build();
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.42 * 1.75, skeleton.segment[HIMC_PELVIS].origin.z);
    config.seat = 0.9;
    build();
    TEST_ASSERT_EQUAL_DOUBLE(0.9, skeleton.segment[HIMC_PELVIS].origin.z);
}

static void refused(double *field, double value, const char *name)
{
    double good = *field;
    *field = value;
    error.text[0] = 0;
    memset(&skeleton, 0xA5, sizeof skeleton);
    himc_skeleton before = skeleton;
    TEST_ASSERT_FALSE_MESSAGE(himc_skeleton_init(&skeleton, &config, &error), name);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(name, error.text, strlen(name), error.text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "expected"), error.text);
    TEST_ASSERT_EQUAL_MEMORY(&before, &skeleton, sizeof skeleton);
    *field = good;
}

static void test_ranges_are_refused_with_the_name_of_the_field(void)
{
    const struct {
        double *field, low, high;
        const char *name;
    } c[] = {{&config.height, 1.2, 2.2, "height: "},
             {&config.mass, 30, 200, "mass: "},
             {&config.stick_length, 0.2, 0.6, "stick length: "},
             {&config.shaft_mass, 0.005, 0.2, "shaft mass: "},
             {&config.mallet_mass, 0.005, 0.2, "mallet mass: "},
             {&config.mallet_radius, 0.005, 0.05, "mallet radius: "},
             {&config.grip, 0.02, 0.18, "grip: "},
             {&config.seat, 0.3, 1.3, "seat: "},
             {&config.length[HIMC_LEFT_HAND], 0.02, 1, "left-hand: "},
             {&config.length[HIMC_TRUNK], 0.02, 1, "trunk: "}};
    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        refused(c[i].field, 0.99 * c[i].low, c[i].name);
        refused(c[i].field, 1.01 * c[i].high, c[i].name);
        refused(c[i].field, -1, c[i].name);
        refused(c[i].field, NAN, c[i].name);
        refused(c[i].field, INFINITY, c[i].name);
        double good = *c[i].field;
        *c[i].field = c[i].low;
        if (c[i].field != &config.stick_length) // the grip's own range depends on it
            build();
        *c[i].field = c[i].high;
        build();
        *c[i].field = good;
    }
}

static void test_length_of_a_stick_is_not_silently_ignored(void)
{
    config.length[HIMC_LEFT_STICK] = 0.5;
    bool taken = himc_skeleton_init(&skeleton, &config, &error);
    TEST_ASSERT_TRUE(!taken || fabs(skeleton.segment[HIMC_LEFT_STICK].length - 0.5) < 1e-12);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_body_is_a_tree_of_20_segments_19_joints_57_degrees_of_freedom);
    RUN_TEST(test_arm_is_trunk_upper_arm_forearm_hand_stick);
    RUN_TEST(test_every_joint_is_found_by_its_own_name);
    RUN_TEST(test_masses_sum_to_the_performer_in_both_anthropometries);
    RUN_TEST(test_a_row_of_table_1_is_both_limbs_of_a_pair);
    RUN_TEST(test_arm_has_the_masses_and_inertias_of_de_leva);
    RUN_TEST(test_legs_have_the_masses_centres_and_radii_of_de_leva);
    RUN_TEST(test_trunk_is_two_parts_merged_by_parallel_axes);
    RUN_TEST(test_default_mallet_has_the_expected_centre_and_inertias);
    RUN_TEST(test_mallet_inertia_is_that_of_a_rod_and_a_ball_in_slices);
    RUN_TEST(test_left_and_right_mirror_each_other);
    RUN_TEST(test_body_scales_with_height_and_mass);
    RUN_TEST(test_stick_does_not_depend_on_the_body);
    RUN_TEST(test_inertias_obey_the_triangle_inequality);
    RUN_TEST(test_measured_lengths_are_used_and_move_the_next_joint);
    RUN_TEST(test_seat_is_as_configured_or_from_the_height);
    RUN_TEST(test_ranges_are_refused_with_the_name_of_the_field);
    RUN_TEST(test_length_of_a_stick_is_not_silently_ignored);
    return UNITY_END();
}
