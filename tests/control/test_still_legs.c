/// test_still_legs.c: a controller that keeps the errors and torques of legs at rest gives the
/// same bits as one that computes them in each step.
#include "control/still_legs.h"

#include "still_controller.h"
#include "unity.h"

#define STEPS 60
#define KNEE HIMC_LEFT_LOWER_LEG

static himc_controller keeps, plain;
static himc_still_legs legs;

void setUp(void)
{
    plain = keeps = still_controller();
    memset(&legs, 0, sizeof legs);
    keeps.legs = &legs;
}

void tearDown(void)
{
}

static void assert_same_torques(const char *when)
{
    himc_vec3 kept[HIMC_JOINTS], computed[HIMC_JOINTS];
    himc_controller_torques(&keeps, &skeleton, &state, &reference, kept);
    himc_controller_torques(&plain, &skeleton, &state, &reference, computed);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(computed, kept, sizeof kept, when);
}

// step k: the arms move always, of the legs one thing at a time, and then nothing for a while
static void change(int k)
{
    himc_vec3 little = {1e-3 * k, 0, 0};
    state.spin[HIMC_LEFT_HAND].x += 0.01;
    switch (k) {
    case 5: state.spin[KNEE] = little; break;
    case 10: state.origin[KNEE].z += 1e-12; break;
    case 15: state.orientation[KNEE] = himc_quat_exp(little); break;
    case 20: state.rotation[KNEE] = himc_mat3_from_quat(state.orientation[KNEE]); break;
    case 25: reference.posture.joint[KNEE - 1] = himc_quat_exp(little); break;
    case 30: reference.posture.rate[KNEE - 1] = little; break;
    case 35: reference.posture.acceleration[KNEE - 1] = little; break;
    case 40: keeps.config.bandwidth = plain.config.bandwidth = 12; break;
    case 45: keeps.config.law = plain.config.law = HIMC_LAW_FEEDFORWARD; break;
    case 47: state.spin[KNEE].y = 2; break;
    case 50: keeps.config.law = plain.config.law = HIMC_LAW_COMPUTED_TORQUE; break;
    case 55: state.origin[0].z += 0.01; break;
    }
}

static void test_kept_torques_are_those_computed_whatever_changes(void)
{
    for (int k = 0; k < STEPS; k++) {
        char when[32];
        change(k);
        snprintf(when, sizeof when, "step %d", k);
        assert_same_torques(when);
    }
}

static void test_another_skeleton_is_computed_anew_once_nothing_is_known(void)
{
    assert_same_torques("at first");
    for (int i = HIMC_LEFT_UPPER_LEG; i < HIMC_SEGMENTS; i++)
        skeleton.segment[i].mass *= 1.5;
    legs.known = false;
    assert_same_torques("heavier legs");
}

// a mark in what is kept comes out as long as nothing of the legs changes
static void test_legs_at_rest_are_not_computed(void)
{
    himc_vec3 torque[HIMC_JOINTS];
    himc_controller_torques(&keeps, &skeleton, &state, &reference, torque);
    legs.torque[0].x = 12345;
    state.spin[HIMC_LEFT_HAND].x += 0.01;
    himc_controller_torques(&keeps, &skeleton, &state, &reference, torque);
    TEST_ASSERT_EQUAL_DOUBLE(12345, torque[HIMC_LEFT_UPPER_LEG - 1].x);
    state.spin[KNEE].x = 1e-300;
    himc_controller_torques(&keeps, &skeleton, &state, &reference, torque);
    TEST_ASSERT_TRUE(torque[HIMC_LEFT_UPPER_LEG - 1].x < 12345);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_kept_torques_are_those_computed_whatever_changes);
    RUN_TEST(test_another_skeleton_is_computed_anew_once_nothing_is_known);
    RUN_TEST(test_legs_at_rest_are_not_computed);
    return UNITY_END();
}
