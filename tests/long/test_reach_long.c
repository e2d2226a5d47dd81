/// test_reach_long.c: TRAC-IK's yardstick (Beeson & Ames 2015): ten thousand random reachable
/// places, from rest, limits on. Here each is a pair, one for each stick.
#include "himc/reach.h"

#include "../ranges.h"
#include "unity.h"

#define GOALS 10000

void setUp(void)
{
    default_skeleton(20150604);
}

void tearDown(void)
{
}

static void check_goals(const himc_limits *limits, const himc_pose *rest)
{
    int solved = 0, outside = 0;
    for (int n = 0; n < GOALS; n++) {
        himc_pose pose = *rest;
        himc_body_state s;
        himc_reach_goal goal = random_goal(limits, rest);
        himc_reach(&skeleton, limits, &goal, &pose, NULL);
        himc_pose_to_state(&skeleton, &pose, NULL, &s);
        bool there = true;
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            there = there && himc_vec3_length(himc_vec3_sub(goal.tip[hand], s.tip[hand])) < 1e-5;
        solved += there;
        for (int i = 0; i < REACH_JOINTS; i++) {
            int j = reach_joint(i);
            outside += himc_limit_measure(limits, j, pose.joint[j]) > 1;
        }
    }
    TEST_ASSERT_EQUAL(0, outside);
    TEST_ASSERT_GREATER_OR_EQUAL(GOALS * 999 / 1000, solved);
}

static void test_999_of_1000_places_within_table_1_are_reached(void)
{
    himc_pose rest = rest_pose();
    himc_limits limits = himc_limits_table_1(&rest);
    check_goals(&limits, &rest);
}

static void test_999_of_1000_places_within_anatomical_limits_are_reached(void)
{
    himc_pose rest = rest_pose();
    for (int kind = HIMC_LIMITS_ELLIPSOID; kind <= HIMC_LIMITS_EULER; kind++) {
        himc_limits limits = wide_ranges((himc_limits_kind)kind);
        check_goals(&limits, &rest);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_999_of_1000_places_within_table_1_are_reached);
    RUN_TEST(test_999_of_1000_places_within_anatomical_limits_are_reached);
    return UNITY_END();
}
