/// test_reach.c: tips that some posture reaches are reached from rest, with every joint within its
/// limits; what is out of reach is come near to.
#include "himc/reach.h"

#include "ranges.h"
#include "unity.h"

#include <string.h>

#define GOALS 1000

static himc_pose rest;

void setUp(void)
{
    default_skeleton(7);
    rest = rest_pose();
}

void tearDown(void)
{
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static double largest_measure(const himc_limits *limits, const himc_pose *pose)
{
    double most = 0;
    for (int i = 0; i < REACH_JOINTS; i++) {
        int j = reach_joint(i);
        most = fmax(most, himc_limit_measure(limits, j, pose->joint[j]));
    }
    return most;
}

static void check_goals(const himc_limits *limits)
{
    int solved = 0;
    for (int n = 0; n < GOALS; n++) {
        himc_body_state s;
        himc_pose pose = rest;
        himc_reach_result result;
        himc_reach_goal goal = random_goal(limits, &rest);
        bool reached = himc_reach(&skeleton, limits, &goal, &pose, &result);
        himc_pose_to_state(&skeleton, &pose, NULL, &s);
        double missing = fmax(distance(s.tip[0], goal.tip[0]), distance(s.tip[1], goal.tip[1]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, result.missing, missing);
        TEST_ASSERT_EQUAL(missing <= goal.tolerance, reached);
        TEST_ASSERT_TRUE(largest_measure(limits, &pose) <= 1);
        solved += missing < 1e-5;
    }
    TEST_ASSERT_GREATER_OR_EQUAL(GOALS * 999 / 1000, solved);
}

static void test_tips_within_table_1_around_the_natural_posture_are_reached(void)
{
    himc_limits limits = himc_limits_table_1(&rest);
    check_goals(&limits);
}

static void test_tips_within_anatomical_ellipsoids_are_reached(void)
{
    himc_limits limits = wide_ranges(HIMC_LIMITS_ELLIPSOID);
    check_goals(&limits);
}

static void test_tips_within_anatomical_boxes_are_reached(void)
{
    himc_limits limits = wide_ranges(HIMC_LIMITS_EULER);
    check_goals(&limits);
}

static void test_joints_without_limits_reach_too(void)
{
    himc_limits limits = {.kind = HIMC_LIMITS_OFF};
    check_goals(&limits);
}

static void test_a_place_out_of_reach_is_pointed_at(void)
{
    himc_pose pose = rest;
    himc_body_state s;
    himc_reach_result result;
    himc_reach_goal goal = himc_reach_default();
    himc_limits limits = wide_ranges(HIMC_LIMITS_ELLIPSOID);
    goal.tip[HIMC_LEFT] = himc_vec3_make(3, 0.2, 1.2);
    goal.tip[HIMC_RIGHT] = himc_vec3_make(3, -0.2, 1.2);
    TEST_ASSERT_FALSE(himc_reach(&skeleton, &limits, &goal, &pose, &result));
    TEST_ASSERT_EQUAL(goal.tries, result.tries);
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    TEST_ASSERT_TRUE(s.tip[HIMC_LEFT].x > 1.1 && s.tip[HIMC_RIGHT].x > 1.1);
    TEST_ASSERT_TRUE(largest_measure(&limits, &pose) <= 1);
}

static void test_a_held_trunk_stays_and_a_free_hand_is_not_asked(void)
{
    himc_pose pose = rest;
    himc_body_state s;
    himc_reach_goal goal = himc_reach_default();
    goal.trunk = 0;
    goal.free[HIMC_LEFT] = true;
    goal.tip[HIMC_RIGHT] = himc_vec3_make(0.6, -0.3, 1.1);
    TEST_ASSERT_TRUE(himc_reach(&skeleton, NULL, &goal, &pose, NULL));
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(goal.tip[HIMC_RIGHT], s.tip[HIMC_RIGHT]));
    for (int k = -1; k < HIMC_ARM_JOINTS; k++) {
        int j = k < 0 ? HIMC_TRUNK - 1 : himc_arm_joint(HIMC_LEFT, k);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1, fabs(himc_quat_dot(rest.joint[j], pose.joint[j])));
    }
}

static void test_a_posture_that_begins_outside_its_limits_ends_within(void)
{
    himc_limits limits = himc_limits_table_1(&rest);
    himc_reach_goal goal = random_goal(&limits, &rest);
    himc_pose pose = rest;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        pose.joint[himc_arm_joint((himc_hand)hand, 1)] = himc_quat_exp(himc_vec3_make(1, 1, 1));
    himc_reach(&skeleton, &limits, &goal, &pose, NULL);
    TEST_ASSERT_TRUE(largest_measure(&limits, &pose) <= 1);
}

static void test_the_same_goal_gives_the_same_posture(void)
{
    himc_limits limits = wide_ranges(HIMC_LIMITS_EULER);
    for (int n = 0; n < 50; n++) {
        himc_reach_goal goal = random_goal(&limits, &rest);
        himc_pose a = rest, b = rest;
        himc_reach(&skeleton, &limits, &goal, &a, NULL);
        himc_reach(&skeleton, &limits, &goal, &b, NULL);
        TEST_ASSERT_EQUAL_MEMORY(&a, &b, sizeof a);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_tips_within_table_1_around_the_natural_posture_are_reached);
    RUN_TEST(test_tips_within_anatomical_ellipsoids_are_reached);
    RUN_TEST(test_tips_within_anatomical_boxes_are_reached);
    RUN_TEST(test_joints_without_limits_reach_too);
    RUN_TEST(test_a_place_out_of_reach_is_pointed_at);
    RUN_TEST(test_a_held_trunk_stays_and_a_free_hand_is_not_asked);
    RUN_TEST(test_a_posture_that_begins_outside_its_limits_ends_within);
    RUN_TEST(test_the_same_goal_gives_the_same_posture);
    return UNITY_END();
}
