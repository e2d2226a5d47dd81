/// test_muscle.c: in a stroke's contact torques hold, and come back after it; else they are the
/// law's.
#include "control/muscle.h"

#include "unity.h"

#include <math.h>
#include <string.h>

#define STEP 1e-4

static const bool none[HIMC_HANDS], left[HIMC_HANDS] = {[HIMC_LEFT] = true};
static double strength[HIMC_JOINTS];
static himc_vec3 rate[HIMC_JOINTS];
static himc_muscles muscles;
static himc_articulation art; // of limbs that nothing accelerates

void setUp(void)
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        strength[j] = 40;
    himc_muscles_rest(&muscles);
    memset(rate, 0, sizeof rate);
}
void tearDown(void)
{
}

static const double own[HIMC_HANDS] = {1, 1};

static void act_on(const bool struck[HIMC_HANDS], himc_vec3 torque[HIMC_JOINTS])
{
    himc_muscles_act(&muscles, &(himc_muscle_input){struck, own, strength, rate, &art, STEP},
                     torque);
}

static void act(const bool struck[HIMC_HANDS], double asked, himc_vec3 torque[HIMC_JOINTS])
{
    for (int j = 0; j < HIMC_JOINTS; j++)
        torque[j] = himc_vec3_make(asked, -0.5 * asked, 0);
    act_on(struck, torque);
}

static void test_without_a_contact_torques_are_those_of_the_law(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    for (int i = 0; i < 100; i++) {
        act(none, 30 * sin(i), torque);
        for (int j = 0; j < HIMC_JOINTS; j++)
            TEST_ASSERT_EQUAL_DOUBLE(30 * sin(i), torque[j].x);
    }
}

static void test_in_a_contact_torques_hold_but_for_a_share_of_the_strength(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    int arm = himc_arm_joint(HIMC_LEFT, 0), other = himc_arm_joint(HIMC_RIGHT, 0);
    act(none, 2, torque);
    for (int i = 0; i < 70; i++)
        act(left, 300, torque);
    // 7 ms of activation, 40 / 0.04 s, and 0.2 of co-contraction: the shoulder has the least
    double change = himc_vec3_length(himc_vec3_sub(torque[arm], himc_vec3_make(2, -1, 0)));
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 0.007 / 0.04 * 40 + 0.2 * 40, change);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2, muscles.co_contraction[arm]);
    TEST_ASSERT_EQUAL_DOUBLE(300, torque[other].x);
    TEST_ASSERT_EQUAL_DOUBLE(300, torque[HIMC_LEFT_UPPER_LEG - 1].x);
    TEST_ASSERT_EQUAL_DOUBLE(300, torque[HIMC_TRUNK - 1].x);
}

// in a contact, and while the arm draws on its reserve, against what the rate has too much
static void test_muscles_that_pull_on_both_sides_resist(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    double astray[HIMC_HANDS] = {1.5, 1};
    himc_muscle_input in = {none, astray, strength, rate, &art, STEP};
    int j = himc_arm_joint(HIMC_LEFT, 1), other = himc_arm_joint(HIMC_RIGHT, 1);
    rate[j] = rate[other] = himc_vec3_make(0, 0, -8);
    memset(torque, 0, sizeof torque);
    himc_muscles_act(&muscles, &in, torque);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -0.5 * 3 * 8, torque[j].z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 12.0 / 40, muscles.co_contraction[j]);
    TEST_ASSERT_EQUAL_DOUBLE(0, torque[other].z);
    memset(torque, 0, sizeof torque);
    act_on((bool[HIMC_HANDS]){false, true}, torque);
    TEST_ASSERT_EQUAL_DOUBLE(0, torque[j].z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -24, torque[other].z);
    rate[other].z = -1000; // within its strength
    act_on((bool[HIMC_HANDS]){false, true}, torque);
    TEST_ASSERT_TRUE(torque[other].z > -2 * 40 && torque[other].z < -40);
}

// at any step: a stick about its length has 2e-6 kg m^2, and a torque of the rate before the step
// would turn it back faster than it came
static void test_what_resists_a_light_stick_does_not_turn_it_back(void)
{
    himc_vec3 torque[HIMC_JOINTS] = {{0, 0, 0}};
    int j = himc_arm_joint(HIMC_LEFT, 3);
    double inertia = 2e-6;
    rate[j].z = -5;
    art.inverse[j + 1].zz = 1 / inertia;
    for (double h = 2e-3; h > 2e-5; h /= 10) {
        memset(torque, 0, sizeof torque);
        himc_muscle_input in = {left, own, strength, rate, &art, h};
        himc_muscles_rest(&muscles);
        himc_muscles_act(&muscles, &in, torque);
        double turned = h * torque[j].z / inertia;
        TEST_ASSERT_TRUE(turned < -1 && turned > rate[j].z);
    }
    art.inverse[j + 1].zz = 0;
}

// what an elbow no longer gives against a shoulder would whirl the upper arm
static void test_the_torques_of_an_arm_stay_together(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    int shoulder = himc_arm_joint(HIMC_LEFT, 0), elbow = himc_arm_joint(HIMC_LEFT, 1);
    strength[elbow] = 10; // behind long before the shoulder
    act(none, 20, torque);
    for (int i = 0; i < 100; i++) {
        for (int j = 0; j < HIMC_JOINTS; j++)
            torque[j] = himc_vec3_make(0, j == elbow ? 40 : 20, 0);
        act_on(left, torque);
        double done = (20 - torque[shoulder].x) / 20;
        TEST_ASSERT_TRUE(done > 0 && done < 0.5);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 20 - 20 * done, torque[elbow].x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, -10 + 30 * done, torque[shoulder].y);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, -10 + 50 * done, torque[elbow].y);
    }
}

static void test_after_a_contact_the_law_has_its_torques_back_evenly(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    int arm = himc_arm_joint(HIMC_LEFT, 1);
    act(none, 0, torque);
    for (int i = 0; i < 50; i++)
        act(left, 35, torque);
    double last = torque[arm].x, jump = 0;
    for (int i = 0; i < 250; i++) {
        act(none, 35, torque);
        jump = fmax(jump, fabs(torque[arm].x - last));
        last = torque[arm].x;
    }
    TEST_ASSERT_EQUAL_DOUBLE(35, last);
    // evenly: at most what 20 ms to twice the strength and 40 ms to it add in a step
    TEST_ASSERT_TRUE(jump < 1.001 * 40 * STEP * (2 / 0.020 + 1 / 0.040));
}

static void test_a_joint_without_a_strength_has_no_muscle(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    strength[himc_arm_joint(HIMC_LEFT, 2)] = 0;
    act(none, 0, torque);
    act(left, 100, torque);
    TEST_ASSERT_EQUAL_DOUBLE(100, torque[himc_arm_joint(HIMC_LEFT, 2)].x);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_a_contact_torques_are_those_of_the_law);
    RUN_TEST(test_in_a_contact_torques_hold_but_for_a_share_of_the_strength);
    RUN_TEST(test_muscles_that_pull_on_both_sides_resist);
    RUN_TEST(test_what_resists_a_light_stick_does_not_turn_it_back);
    RUN_TEST(test_the_torques_of_an_arm_stay_together);
    RUN_TEST(test_after_a_contact_the_law_has_its_torques_back_evenly);
    RUN_TEST(test_a_joint_without_a_strength_has_no_muscle);
    return UNITY_END();
}
