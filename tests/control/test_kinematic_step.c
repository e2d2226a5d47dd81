/// test_kinematic_step.c: the pipeline `ik`: a posture from the solver, step by step, that has the
/// tips where they are asked to be and else follows the joint targets.
#include "bodies.h"

#include "control/controller.h"

#include "unity.h"

#include <string.h>

#define STEP 1e-4

static himc_controller c;
static himc_body_state state;
static himc_reference reference;
static himc_posture posture;
static himc_pose pose;
static himc_vec3 rate[HIMC_JOINTS];

// at rest in the natural posture, which is asked for too
void setUp(void)
{
    default_skeleton(1);
    himc_posture_init(&posture, &skeleton, 0.8675);
    reference = (himc_reference){.released = {false, false}};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        reference.tip[hand].x = himc_vec3_make(0.48, hand == HIMC_LEFT ? 0.1 : -0.1, 0.95);
    himc_posture_moving(&posture, reference.tip, &reference.posture);
    memcpy(pose.joint, reference.posture.joint, sizeof pose.joint);
    himc_pose_to_state(&skeleton, &pose, NULL, &state);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&c, &control, &skeleton, &state);
    c.config.mode = HIMC_PIPELINE_IK;
    c.step = STEP;
}

void tearDown(void)
{
}

static void show(int steps)
{
    for (int i = 0; i < steps; i++) {
        himc_controller_kinematic_step(&c, &skeleton, &reference, &state, &pose, rate);
        himc_pose_to_state(&skeleton, &pose, rate, &state);
    }
}

static double off(himc_hand hand)
{
    return himc_vec3_length(himc_vec3_sub(state.tip[hand], reference.tip[hand].x));
}

static void test_a_kinematic_step_at_the_targets_changes_nothing(void)
{
    himc_pose before = pose;
    show(1);
    for (int j = 0; j < HIMC_JOINTS; j++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1, fabs(himc_quat_dot(before.joint[j], pose.joint[j])));
}

static void test_tips_reach_targets_that_the_joint_targets_miss(void)
{
    static const int steps[HIMC_SOLVERS] = {[HIMC_SOLVER_DLS] = 8,
                                            [HIMC_SOLVER_PINV] = 8,
                                            [HIMC_SOLVER_TRANSPOSE] = 200,
                                            [HIMC_SOLVER_NAKAMURA] = 8,
                                            [HIMC_SOLVER_SDLS] = 8};
    for (int solver = 0; solver < HIMC_SOLVERS; solver++) {
        setUp();
        c.config.solver = (himc_solver)solver;
        reference.tip[HIMC_RIGHT].x = himc_vec3_make(0.52, -0.16, 1.02);
        show(steps[solver]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, off(HIMC_RIGHT));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, off(HIMC_LEFT));
    }
}

static void test_damping_slows_a_step_as_the_solver_says(void)
{
    double left[2];
    for (int i = 0; i < 2; i++) {
        setUp();
        c.config.damping = i == 0 ? 0.05 : 0.5;
        reference.tip[HIMC_RIGHT].x.z += 0.001;
        show(1);
        left[i] = off(HIMC_RIGHT);
    }
    TEST_ASSERT_TRUE(left[0] < 2e-5);
    TEST_ASSERT_TRUE(left[1] > 10 * left[0] && left[1] < 0.001);
}

static void test_the_null_space_is_for_the_joint_targets_or_for_nothing(void)
{
    himc_vec3 place[2];
    for (int kept = 0; kept < 2; kept++) {
        setUp();
        c.config.posture = kept;
        int j = himc_arm_joint(HIMC_RIGHT, 0); // the shoulder's turn lifts the elbow
        himc_quat turn = himc_quat_exp(himc_vec3_make(0.3, 0, 0));
        reference.posture.joint[j] = himc_quat_mul(turn, reference.posture.joint[j]);
        himc_vec3 before = state.origin[HIMC_RIGHT_FOREARM];
        show(20);
        place[kept] = himc_vec3_sub(state.origin[HIMC_RIGHT_FOREARM], before);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, off(HIMC_RIGHT));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, himc_vec3_length(place[0]));
    TEST_ASSERT_TRUE(himc_vec3_length(place[1]) > 0.02);
}

static void test_a_moving_tip_is_met_in_place_and_speed(void)
{
    double worst = 0, hurry = 0;
    for (int i = 1; i <= 2000; i++) {
        double t = i * STEP, w = 20;
        himc_target *tip = &reference.tip[HIMC_RIGHT];
        *tip = (himc_target){{0.48, -0.1, 0.95 + 0.1 * (1 - cos(w * t))},
                             {0, 0, 0.1 * w * sin(w * t)},
                             {0, 0, 0.1 * w * w * cos(w * t)}};
        himc_posture_moving(&posture, reference.tip, &reference.posture);
        show(1);
        worst = fmax(worst, off(HIMC_RIGHT));
        himc_vec3 slower = himc_vec3_sub(state.tip_velocity[HIMC_RIGHT], tip->v);
        hurry = fmax(hurry, himc_vec3_length(slower));
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, worst);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0, hurry);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_kinematic_step_at_the_targets_changes_nothing);
    RUN_TEST(test_tips_reach_targets_that_the_joint_targets_miss);
    RUN_TEST(test_damping_slows_a_step_as_the_solver_says);
    RUN_TEST(test_the_null_space_is_for_the_joint_targets_or_for_nothing);
    RUN_TEST(test_a_moving_tip_is_met_in_place_and_speed);
    return UNITY_END();
}
