/// test_stretch.c: tip targets out of an arm's reach: the nearest reachable point, its motion, and
/// the torques for it.
#include "body/stretch.h"

#include "control/controller.h"

#include "unity.h"

#include <string.h>

static himc_error error;
static himc_skeleton skeleton;

void setUp(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    TEST_ASSERT_TRUE(himc_skeleton_init(&skeleton, &config, &error));
}

void tearDown(void)
{
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static void test_reach_of_an_arm_is_nearly_the_sum_of_its_segments(void)
{
    double length = skeleton.segment[HIMC_RIGHT_UPPER_ARM].length +
                    skeleton.segment[HIMC_RIGHT_FOREARM].length +
                    himc_vec3_length(skeleton.segment[HIMC_RIGHT_STICK].origin) +
                    himc_vec3_length(skeleton.tip);
    TEST_ASSERT_DOUBLE_WITHIN(0.003 * length, length, himc_stretch(&skeleton, HIMC_RIGHT));
    TEST_ASSERT_TRUE(himc_stretch(&skeleton, HIMC_RIGHT) < length);
}

static void test_a_target_in_reach_stays_unchanged(void)
{
    himc_target t = {{0.5, 0.2, -0.1}, {1, 2, 3}, {4, 5, 6}}, s;
    s = himc_stretch_towards(&t, himc_vec3_make(0.1, 0.1, 0), 0.6);
    TEST_ASSERT_EQUAL_MEMORY(&t, &s, sizeof t);
}

static const himc_vec3 shoulder = {0.1, -0.2, 1.2};

// a curve that is out of reach everywhere
static himc_target curve(double t)
{
    return (himc_target){
        {1.3 + 0.2 * sin(3 * t), -0.6 * t, 1.2 + 0.3 * cos(2 * t)},
        {0.6 * cos(3 * t), -0.6, -0.6 * sin(2 * t)},
        {-1.8 * sin(3 * t), 0, -1.2 * cos(2 * t)},
    };
}

static himc_target stretched(double t)
{
    himc_target x = curve(t);
    return himc_stretch_towards(&x, shoulder, 0.9);
}

static void test_a_target_out_of_reach_is_replaced_in_the_same_direction(void)
{
    for (double t = 0; t < 1; t += 0.1) {
        himc_vec3 target = himc_vec3_sub(curve(t).x, shoulder),
                  reached = himc_vec3_sub(stretched(t).x, shoulder);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.9, himc_vec3_length(reached));
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-12, 0, himc_vec3_length(himc_vec3_cross(himc_vec3_unit(target), reached)));
    }
}

static void test_velocity_and_acceleration_are_those_of_the_replaced_target(void)
{
    const double h = 1e-4;
    for (double t = 0; t < 1; t += 0.1) {
        himc_target a = stretched(t - h), b = stretched(t), c = stretched(t + h);
        himc_vec3 v = himc_vec3_scale(himc_vec3_sub(c.x, a.x), 0.5 / h);
        himc_vec3 twice = himc_vec3_sub(himc_vec3_add(a.x, c.x), himc_vec3_scale(b.x, 2));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(v, b.v));
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, distance(himc_vec3_scale(twice, 1 / (h * h)), b.a));
    }
}

static void at_rest(himc_posture *posture, himc_body_state *state, himc_reference *reference)
{
    himc_pose pose;
    himc_posture_init(posture, &skeleton, 0.8675);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        reference->tip[hand] =
            (himc_target){{0.48, hand == HIMC_LEFT ? 0.1 : -0.1, 0.95}, {0.3, 0, -0.2}, {1, -1, 2}};
    himc_vec3 x[HIMC_HANDS] = {reference->tip[0].x, reference->tip[1].x};
    himc_posture_at(posture, x, &pose);
    himc_pose_to_state(&skeleton, &pose, NULL, state);
    himc_posture_moving(posture, reference->tip, &reference->posture);
}

static void test_torques_for_a_tip_out_of_reach_are_those_for_the_nearest_point(void)
{
    himc_posture posture;
    himc_body_state state;
    himc_controller c;
    himc_vec3 far[HIMC_JOINTS], near[HIMC_JOINTS];
    himc_reference reference;
    memset(&reference, 0, sizeof reference);
    at_rest(&posture, &state, &reference);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&c, &control, &skeleton, &state);
    reference.tip[HIMC_RIGHT].x = himc_vec3_make(1.6, -0.5, 1.4);
    himc_controller_torques(&c, &skeleton, &state, &reference, far);
    reference.tip[HIMC_RIGHT] =
        himc_stretch_towards(&reference.tip[HIMC_RIGHT], state.origin[HIMC_RIGHT_UPPER_ARM],
                             himc_stretch(&skeleton, HIMC_RIGHT));
    himc_controller_torques(&c, &skeleton, &state, &reference, near);
    for (int j = 0; j < HIMC_JOINTS; j++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * (1 + himc_vec3_length(near[j])), 0,
                                  distance(far[j], near[j]));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_reach_of_an_arm_is_nearly_the_sum_of_its_segments);
    RUN_TEST(test_a_target_in_reach_stays_unchanged);
    RUN_TEST(test_a_target_out_of_reach_is_replaced_in_the_same_direction);
    RUN_TEST(test_velocity_and_acceleration_are_those_of_the_replaced_target);
    RUN_TEST(test_torques_for_a_tip_out_of_reach_are_those_for_the_nearest_point);
    return UNITY_END();
}
