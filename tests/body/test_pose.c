/// test_pose.c: forward kinematics against positions computed by hand and against differences.
#include "himc/body.h"

#include "bodies.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

void setUp(void)
{
    default_skeleton(3);
}

void tearDown(void)
{
}

static himc_pose random_pose(void)
{
    himc_pose pose;
    for (int j = 0; j < HIMC_JOINTS; j++)
        pose.joint[j] = himc_quat_exp(random_vector(1.5));
    return pose;
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static void test_zero_pose_stands_with_arms_and_sticks_hanging(void)
{
    himc_pose pose = himc_pose_zero();
    himc_body_state s;
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    double k = 1.75 / 1.741; // from de Leva's reference height
    double shoulder = skeleton.segment[HIMC_PELVIS].origin.z + k * (0.1457 + 0.345);
    double grip = shoulder - k * (0.2817 + 0.2689 + 0.0862), reach = 0.36 - 0.0175 - 0.10;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double y = (hand == HIMC_LEFT ? 0.185 : -0.185) * k;
        himc_vec3 tip = himc_vec3_make(0, y, grip - reach);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0, distance(tip, s.tip[hand]));
        TEST_ASSERT_EQUAL_DOUBLE(0, himc_vec3_length(s.tip_velocity[hand]));
    }
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-14, 0, distance(skeleton.segment[HIMC_PELVIS].origin, s.origin[HIMC_PELVIS]));
    for (int i = 0; i < HIMC_SEGMENTS; i++)
        TEST_ASSERT_EQUAL_DOUBLE(1, s.orientation[i].w);
}

// shoulder rotated until the arm points forward, elbow bent until the forearm points up, wrist and
// grip straight
static void test_bent_arm_is_where_hand_computation_puts_it(void)
{
    himc_pose pose = himc_pose_zero();
    himc_quat quarter = himc_quat_exp(himc_vec3_make(0, -HIMC_PI / 2, 0));
    pose.joint[himc_arm_joint(HIMC_RIGHT, 0)] = quarter;
    pose.joint[himc_arm_joint(HIMC_RIGHT, 1)] = quarter;
    himc_body_state s;
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    const himc_segment *segment = skeleton.segment;
    himc_vec3 shoulder = s.origin[HIMC_RIGHT_UPPER_ARM];
    double up = segment[HIMC_RIGHT_FOREARM].length + segment[HIMC_RIGHT_HAND].length;
    himc_vec3 tip = himc_vec3_add(
        shoulder, himc_vec3_make(segment[HIMC_RIGHT_UPPER_ARM].length, 0, up - skeleton.tip.z));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0, distance(tip, s.tip[HIMC_RIGHT]));
}

static void test_pose_to_state_and_back_is_the_same_pose(void)
{
    for (int n = 0; n < 200; n++) {
        himc_pose pose = random_pose();
        himc_body_state s;
        himc_pose_to_state(&skeleton, &pose, NULL, &s);
        himc_pose back = himc_pose_from_state(&skeleton, &s);
        for (int j = 0; j < HIMC_JOINTS; j++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1, himc_quat_dot(pose.joint[j], back.joint[j]));
    }
}

static void test_segments_stay_joined_and_rigid_in_any_pose(void)
{
    for (int n = 0; n < 200; n++) {
        himc_pose pose = random_pose();
        himc_body_state s;
        himc_pose_to_state(&skeleton, &pose, NULL, &s);
        for (int i = 1; i < HIMC_SEGMENTS; i++) {
            const himc_segment *segment = &skeleton.segment[i];
            himc_vec3 link = himc_vec3_sub(s.origin[i], s.origin[segment->parent]);
            himc_vec3 local = himc_mat3_apply_transposed(&s.rotation[segment->parent], link);
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0, distance(segment->origin, local));
            himc_vec3 v = random_vector(1);
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0,
                                      distance(himc_mat3_apply(&s.rotation[i], v),
                                               himc_quat_rotate(s.orientation[i], v)));
        }
    }
}

// the pose a time h later, each joint rotated by its rate in the parent's frame
static himc_pose turned(const himc_pose *pose, const himc_vec3 rate[], double h)
{
    himc_pose next;
    for (int j = 0; j < HIMC_JOINTS; j++)
        next.joint[j] = himc_quat_mul(himc_quat_exp(himc_vec3_scale(rate[j], h)), pose->joint[j]);
    return next;
}

static void test_tip_velocity_is_the_difference_of_the_tip(void)
{
    double h = 1e-5;
    for (int n = 0; n < 100; n++) {
        himc_pose pose = random_pose();
        himc_vec3 rate[HIMC_JOINTS];
        for (int j = 0; j < HIMC_JOINTS; j++)
            rate[j] = random_vector(5);
        himc_body_state s, before, after;
        himc_pose earlier = turned(&pose, rate, -h), later = turned(&pose, rate, h);
        himc_pose_to_state(&skeleton, &pose, rate, &s);
        himc_pose_to_state(&skeleton, &earlier, NULL, &before);
        himc_pose_to_state(&skeleton, &later, NULL, &after);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            himc_vec3 v = himc_vec3_sub(after.tip[hand], before.tip[hand]);
            v = himc_vec3_scale(v, 0.5 / h);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(v, s.tip_velocity[hand]));
        }
        for (int i = 1; i < HIMC_SEGMENTS; i++) {
            himc_quat moved =
                himc_quat_mul(after.orientation[i], himc_quat_conj(before.orientation[i]));
            himc_vec3 spin = himc_vec3_scale(himc_quat_log(moved), 0.5 / h);
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(spin, s.spin[i]));
        }
    }
}

static void test_complete_restores_all_that_follows_from_orientations_and_spins(void)
{
    himc_pose pose = random_pose();
    himc_vec3 rate[HIMC_JOINTS];
    for (int j = 0; j < HIMC_JOINTS; j++)
        rate[j] = random_vector(5);
    himc_body_state s, bare;
    memset(&s, 0, sizeof s);
    himc_pose_to_state(&skeleton, &pose, rate, &s);
    memset(&bare, 0xFF, sizeof bare);
    memcpy(bare.orientation, s.orientation, sizeof s.orientation);
    memcpy(bare.spin, s.spin, sizeof s.spin);
    himc_body_state_complete(&skeleton, &bare);
    TEST_ASSERT_EQUAL_MEMORY(&s, &bare, sizeof s);
}

static void test_finite_sees_every_number_of_the_state(void)
{
    himc_pose pose = random_pose();
    himc_body_state s;
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    TEST_ASSERT_TRUE(himc_body_state_finite(&s));
    double *number = (double *)&s;
    for (size_t i = 0; i < sizeof s / sizeof *number; i++) {
        double good = number[i];
        number[i] = i % 2 ? NAN : INFINITY;
        char where[64];
        snprintf(where, sizeof where, "number %zu of %zu", i, sizeof s / sizeof *number);
        TEST_ASSERT_FALSE_MESSAGE(himc_body_state_finite(&s), where);
        number[i] = good;
    }
    TEST_ASSERT_TRUE(himc_body_state_finite(&s));
}

static void test_opposite_infinities_do_not_cancel(void)
{
    himc_pose pose = himc_pose_zero();
    himc_body_state s;
    himc_pose_to_state(&skeleton, &pose, NULL, &s);
    s.spin[3].x = INFINITY;
    s.spin[4].y = -INFINITY;
    TEST_ASSERT_FALSE(himc_body_state_finite(&s));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_zero_pose_stands_with_arms_and_sticks_hanging);
    RUN_TEST(test_bent_arm_is_where_hand_computation_puts_it);
    RUN_TEST(test_pose_to_state_and_back_is_the_same_pose);
    RUN_TEST(test_segments_stay_joined_and_rigid_in_any_pose);
    RUN_TEST(test_tip_velocity_is_the_difference_of_the_tip);
    RUN_TEST(test_complete_restores_all_that_follows_from_orientations_and_spins);
    RUN_TEST(test_finite_sees_every_number_of_the_state);
    RUN_TEST(test_opposite_infinities_do_not_cancel);
    return UNITY_END();
}
