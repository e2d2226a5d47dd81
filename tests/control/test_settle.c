/// test_settle.c: while arms give other torques than were asked of them, trunk and legs move as
/// wanted all the same, on a fixed pelvis and on a free one; and arms that give what was asked
/// change nothing.
#include "body/dynamics.h"
#include "body/posture.h"
#include "control/balance.h"
#include "control/ik.h"
#include "control/settle.h"
#include "control/strength.h"
#include "control/tracking_error.h"

#include "bodies.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

static himc_body_state state;
static himc_articulation articulation;
static himc_controller controller;
static himc_balance balance;
static const double reserve[HIMC_HANDS] = {1, 1};
static himc_vec3 wanted[HIMC_JOINTS], asked[HIMC_JOINTS], given[HIMC_JOINTS];

static bool of_an_arm(int j)
{
    return j >= HIMC_LEFT_UPPER_ARM - 1 && j < HIMC_LEFT_UPPER_LEG - 1;
}

// a playing posture with any rates, and accelerations wanted of it
static void prepare(bool free)
{
    himc_controller_config law = himc_controller_config_default();
    himc_posture posture;
    himc_pose pose;
    himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.05, 0.8675}, {0.48, -0.05, 0.8675}}, rate[HIMC_JOINTS];
    skeleton.segment[HIMC_PELVIS].joint = free ? HIMC_JOINT_FREE : HIMC_JOINT_FIXED;
    himc_posture_init(&posture, &skeleton, 0.85);
    himc_posture_at(&posture, tip, &pose);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        rate[j] = random_vector(3);
        wanted[j] = random_vector(30);
    }
    himc_pose_to_state(&skeleton, &pose, rate, &state);
    himc_articulate(&skeleton, &state, &articulation);
    himc_controller_init(&controller, &law, &skeleton, &state);
    controller.articulation = &articulation;
    balance = (himc_balance){.carried = {random_vector(20), himc_vec3_make(10, -20, 700)}};
    controller.balance = free ? &balance : NULL;
    himc_invert(&controller, &skeleton, &state, wanted, asked);
    memcpy(given, asked, sizeof given);
}

void setUp(void)
{
    default_skeleton(1);
}
void tearDown(void)
{
}

// the largest miss of the accelerations wanted of trunk and legs (rad/s^2)
static double trunk_and_legs_miss(void)
{
    himc_vec3 relative[HIMC_JOINTS];
    double miss = 0;
    himc_balance_accelerate(controller.balance, &skeleton, &state, &articulation, given, NULL,
                            relative);
    for (int j = 0; j < HIMC_JOINTS; j++)
        if (!of_an_arm(j))
            miss = fmax(miss, himc_vec3_length(himc_vec3_sub(relative[j], wanted[j])));
    return miss;
}

// one share of what was wanted in the whole arm; the other arm, trunk and legs are left alone
static void test_an_arm_that_is_too_weak_does_the_same_slower(void)
{
    int slower = 0;
    for (int n = 0; n < 100; n++) {
        himc_vec3 before[HIMC_JOINTS], torque[HIMC_JOINTS];
        prepare(n % 2);
        controller.config.human_strength = true;
        controller.config.mode = HIMC_PIPELINE_ID; // the posture is the task
        int weak = himc_arm_joint(HIMC_LEFT, n % 2);
        memset(controller.config.strength, 0, sizeof controller.config.strength);
        controller.config.strength[weak] = 0.8 * himc_vec3_length(asked[weak]);
        memcpy(before, wanted, sizeof before);
        double most =
            himc_strength_most(&controller, &skeleton, &state, weak, reserve, asked[weak]);
        himc_slow_weak_arms(&controller, &skeleton, &state, reserve, wanted, asked);
        himc_invert(&controller, &skeleton, &state, wanted, torque);
        double share = wanted[weak].x / before[weak].x;
        TEST_ASSERT_TRUE(share >= 0.3 && share <= 1);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            bool of_it = of_an_arm(j) && (j - (HIMC_LEFT_UPPER_ARM - 1)) % HIMC_HANDS == 0;
            himc_vec3 rest = himc_vec3_madd(wanted[j], of_it ? -share : -1, before[j]);
            TEST_ASSERT_TRUE(himc_vec3_length(rest) < 1e-9);
            TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(torque[j], asked[j])) < 1e-9);
        }
        if (share > 0.31 && share < 1) { // as much as it can; a free pelvis brings the other arm in
            TEST_ASSERT_DOUBLE_WITHIN(0.02 * most, most, himc_vec3_length(asked[weak]));
            slower++;
        }
    }
    TEST_ASSERT_TRUE(slower > 20);
}

// what moves the tip stays as long as the strength is there for it
static void test_a_weak_arm_leaves_out_posture_before_it_is_slower(void)
{
    int whole = 0;
    for (int n = 0; n < 100; n++) {
        himc_vec3 arm[HIMC_ARM_JOINTS], before, after;
        himc_arm_jacobian jacobian;
        prepare(false);
        controller.config.human_strength = true;
        himc_arm_jacobian_at(&state, HIMC_LEFT, &jacobian);
        int weak = himc_arm_joint(HIMC_LEFT, n % 2);
        memset(controller.config.strength, 0, sizeof controller.config.strength);
        controller.config.strength[weak] = 0.9 * himc_vec3_length(asked[weak]);
        himc_arm_gather(wanted, HIMC_LEFT, arm);
        before = himc_ik_forward(&jacobian, arm);
        himc_slow_weak_arms(&controller, &skeleton, &state, reserve, wanted, asked);
        himc_arm_gather(wanted, HIMC_LEFT, arm);
        after = himc_ik_forward(&jacobian, arm);
        double share = himc_vec3_dot(after, before) / himc_vec3_dot(before, before);
        TEST_ASSERT_TRUE(share >= 0.3 - 1e-6 && share <= 1 + 1e-6);
        double aside = himc_vec3_length(himc_vec3_madd(after, -share, before));
        TEST_ASSERT_TRUE(aside < 1e-4 * himc_vec3_length(before));
        whole += share > 1 - 1e-6;
    }
    TEST_ASSERT_TRUE(whole > 20);
}

static void test_trunk_and_legs_move_as_wanted_whatever_the_arms_give(void)
{
    for (int n = 0; n < 200; n++) {
        prepare(n % 2);
        for (int j = HIMC_LEFT_UPPER_ARM - 1; j < HIMC_LEFT_UPPER_LEG - 1; j++)
            given[j] = himc_vec3_scale(asked[j], 0.3);
        double unaware = trunk_and_legs_miss();
        controller.articulation = n % 4 < 2 ? &articulation : NULL; // found where there is none
        himc_settle(&controller, &skeleton, &state, reserve, wanted, asked, given);
        TEST_ASSERT_TRUE(unaware > 0.1);
        TEST_ASSERT_TRUE(trunk_and_legs_miss() < (n % 2 ? 0.03 * unaware : 1e-9));
        for (int j = HIMC_LEFT_UPPER_ARM - 1; j < HIMC_LEFT_UPPER_LEG - 1; j++)
            TEST_ASSERT_EQUAL_DOUBLE(0.3 * asked[j].y, given[j].y);
    }
}

static void test_the_arms_accelerations_become_those_of_their_torques(void)
{
    himc_vec3 relative[HIMC_JOINTS];
    prepare(false);
    given[himc_arm_joint(HIMC_RIGHT, 0)] = himc_vec3_make(0, 0, 0);
    himc_settle(&controller, &skeleton, &state, reserve, wanted, asked, given);
    himc_forward_dynamics(&skeleton, &state, &articulation, given, NULL, relative);
    for (int j = 0; j < HIMC_JOINTS; j++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 * 1000, 0,
                                  himc_vec3_length(himc_vec3_sub(relative[j], wanted[j])));
}

static void test_arms_that_give_what_was_asked_change_nothing(void)
{
    prepare(true);
    himc_settle(&controller, &skeleton, &state, reserve, wanted, asked, given);
    TEST_ASSERT_EQUAL_MEMORY(asked, given, sizeof given);
}

static void test_a_waist_gives_no_more_than_its_strength_and_an_arms_reserve(void)
{
    double size[2];
    for (int k = 0; k < 2; k++) {
        srand(1);
        prepare(false);
        controller.config.strength[HIMC_TRUNK - 1] = 5;
        given[himc_arm_joint(HIMC_LEFT, 0)] = himc_vec3_make(0, 300, 0);
        himc_settle(&controller, &skeleton, &state, (double[]){1 + 2 * k, 1}, wanted, asked, given);
        size[k] = himc_vec3_length(given[HIMC_TRUNK - 1]);
    }
    TEST_ASSERT_TRUE(size[0] > 1 && size[0] < 5 + 1e-9);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3 * size[0], size[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_arm_that_is_too_weak_does_the_same_slower);
    RUN_TEST(test_a_weak_arm_leaves_out_posture_before_it_is_slower);
    RUN_TEST(test_trunk_and_legs_move_as_wanted_whatever_the_arms_give);
    RUN_TEST(test_the_arms_accelerations_become_those_of_their_torques);
    RUN_TEST(test_arms_that_give_what_was_asked_change_nothing);
    RUN_TEST(test_a_waist_gives_no_more_than_its_strength_and_an_arms_reserve);
    return UNITY_END();
}
