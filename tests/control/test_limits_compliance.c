/// test_limits_compliance.c: accelerations under joint limits: the future position of a stopped
/// joint, the compensation at the tips, the speed of return, the count of limit hits; and the
/// strength table.
#include "control/controller.h"
#include "body/dynamics.h"

#include "control/limit_torque.h"
#include "control/strength.h"
#include "control/tracking_error.h"

#include "bodies.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define MOMENT 0.0056 // the time ahead at which a joint shall be within its bounds (s)
#define NECK (HIMC_NECK - 1)
#define TRUNK (HIMC_TRUNK - 1)
#define LEVEL 0.8675

static himc_controller controller;
static himc_limits limits;
static himc_saturation_counts saturation;
static himc_pose pose;
static himc_vec3 rate[HIMC_JOINTS];
static himc_body_state state;
static himc_arm_jacobian jacobian[HIMC_HANDS];
static himc_vec3 wanted[HIMC_JOINTS];

void setUp(void)
{
    himc_posture posture;
    himc_vec3 tip[HIMC_HANDS] = {{0.48, 0.05, LEVEL + 0.1}, {0.48, -0.05, LEVEL + 0.1}};
    default_skeleton(5);
    himc_posture_init(&posture, &skeleton, LEVEL);
    himc_posture_at(&posture, tip, &pose);
    memset(rate, 0, sizeof rate);
    memset(wanted, 0, sizeof wanted);
    memset(&limits, 0, sizeof limits);
    memset(&saturation, 0, sizeof saturation);
    limits.kind = HIMC_LIMITS_ELLIPSOID;
    himc_pose_to_state(&skeleton, &pose, NULL, &state);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&controller, &control, &skeleton, &state);
    controller.limits = &limits;
    controller.saturation = &saturation;
}

void tearDown(void)
{
}

// limits a joint by an ellipsoid about its present rotation and moves it `off` the centre
static void bind(int joint, himc_vec3 radius, himc_vec3 off)
{
    limits.joint[joint] = (himc_limit){.bound = true,
                                       .mean = pose.joint[joint],
                                       .axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                       .radius = radius};
    pose.joint[joint] = himc_quat_mul(pose.joint[joint], himc_quat_exp(off));
}

static void yield(void)
{
    himc_pose_to_state(&skeleton, &pose, rate, &state);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        himc_arm_jacobian_at(&state, (himc_hand)hand, &jacobian[hand]);
    himc_limits_compliance(&controller, &skeleton, &state, jacobian, wanted);
}

// a joint's acceleration in the rotating frame of its parent
static himc_vec3 seen_from_parent(int joint)
{
    int p = skeleton.segment[joint + 1].parent;
    himc_vec3 spin = himc_vec3_sub(state.spin[joint + 1], state.spin[p]);
    himc_vec3 alpha = himc_vec3_sub(wanted[joint], himc_vec3_cross(state.spin[p], spin));
    return himc_mat3_apply_transposed(&state.rotation[p], alpha);
}

// the joint's rotation after MOMENT
static himc_quat soon(int joint)
{
    himc_vec3 turn = himc_vec3_madd(himc_vec3_scale(rate[joint], MOMENT), 0.5 * MOMENT * MOMENT,
                                    seen_from_parent(joint));
    return himc_quat_mul(himc_quat_exp(turn), pose.joint[joint]);
}

static void test_a_joint_about_to_leave_its_bounds_is_on_them_a_moment_later(void)
{
    bind(NECK, himc_vec3_make(0.5, 0.3, 0.2), himc_vec3_make(0.2, 0.2, 0.1));
    rate[NECK] = himc_vec3_make(3, 2, 4);
    rate[TRUNK] = himc_vec3_make(2, -3, 8);
    wanted[NECK] = himc_vec3_make(400, 900, 1500);
    yield();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, himc_limit_measure(&limits, NECK, soon(NECK)));
}

// an arm asked for more than 8000 rad/s^2, as one whose limits hold it off its target is
static void test_a_demand_on_an_arm_is_bounded_and_keeps_its_proportions(void)
{
    int shoulder = himc_arm_joint(HIMC_LEFT, 0), elbow = himc_arm_joint(HIMC_LEFT, 1),
        other = himc_arm_joint(HIMC_RIGHT, 1);
    himc_vec3 asked[] = {{0, 6e3, 0}, {16e3, 0, 12e3}, {0, 7e3, 0}, {9e3, 0, 0}};
    wanted[shoulder] = asked[0];
    wanted[elbow] = asked[1];
    wanted[other] = asked[2];
    wanted[NECK] = asked[3];
    yield();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.4 * 6e3, wanted[shoulder].y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.4 * 16e3, wanted[elbow].x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.4 * 12e3, wanted[elbow].z);
    TEST_ASSERT_EQUAL_MEMORY(&asked[2], &wanted[other], sizeof asked[2]);
    TEST_ASSERT_EQUAL_MEMORY(&asked[3], &wanted[NECK], sizeof asked[3]);
}

// an arm that is held off its target is pulled no harder than 0.4 rad pull it
static void test_errors_of_an_arm_are_bounded_and_keep_their_proportions(void)
{
    int shoulder = himc_arm_joint(HIMC_LEFT, 0), elbow = himc_arm_joint(HIMC_LEFT, 1),
        other = himc_arm_joint(HIMC_RIGHT, 1);
    tracking_error asked, e = {.angle = {[NECK] = {0.9, 0, 0}}};
    e.angle[shoulder] = himc_vec3_make(0, 0.3, 0);
    e.angle[elbow] = himc_vec3_make(0.8, 0, 0.6);
    e.angle[other] = himc_vec3_make(0, 0.39, 0);
    asked = e;
    himc_limits_bound_errors(&controller, &e);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4 * 0.3, e.angle[shoulder].y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4 * 0.8, e.angle[elbow].x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4 * 0.6, e.angle[elbow].z);
    TEST_ASSERT_EQUAL_MEMORY(&asked.angle[other], &e.angle[other], sizeof asked.angle[0]);
    TEST_ASSERT_EQUAL_MEMORY(&asked.angle[NECK], &e.angle[NECK], sizeof asked.angle[0]);
}

// a joint at a constant rate along its bounds stays inside; its spin rotates with the parent
static void test_a_turning_parent_drives_no_joint_out_of_its_bounds(void)
{
    bind(NECK, himc_vec3_make(0.5, 0.5, 0.5), himc_vec3_make(0, 0.4995, 0));
    himc_quat q = pose.joint[NECK], mean = limits.joint[NECK].mean;
    himc_vec3 outward = himc_quat_rotate(mean, himc_vec3_make(0, 1, 0));
    himc_vec3 along = himc_quat_rotate(mean, himc_vec3_make(1, 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.999, himc_limit_measure(&limits, NECK, q));
    rate[NECK] = himc_vec3_scale(along, 2);
    rate[TRUNK] =
        himc_quat_rotate(pose.joint[TRUNK], himc_vec3_scale(himc_vec3_cross(along, outward), 60));
    himc_pose_to_state(&skeleton, &pose, rate, &state);
    int p = skeleton.segment[HIMC_NECK].parent;
    himc_vec3 spin = himc_vec3_sub(state.spin[HIMC_NECK], state.spin[p]);
    himc_vec3 carried = himc_vec3_cross(state.spin[p], spin);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 120, himc_vec3_length(carried));
    wanted[NECK] = carried;
    yield();
    TEST_ASSERT_EQUAL_MEMORY(&carried, &wanted[NECK], sizeof carried);
    TEST_ASSERT_TRUE(himc_limit_measure(&limits, NECK, soon(NECK)) < 1);
}

static void test_a_joint_far_beyond_its_bounds_returns_at_3_radians_a_second(void)
{
    bind(NECK, himc_vec3_make(0.2, 0.2, 0.2), himc_vec3_make(0, 0.5, 0));
    yield();
    himc_quat left = himc_quat_mul(himc_quat_conj(limits.joint[NECK].mean), soon(NECK));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 - 3 * MOMENT, himc_vec3_length(himc_quat_log(left)));
}

// the elbow is free about two axes and stopped about the third; `lost` is the tip acceleration lost
// by the stop alone, `left` the part that is not compensated
static void stop_elbow(himc_vec3 radius, himc_vec3 off, double *lost, double *left)
{
    int elbow = himc_arm_joint(HIMC_LEFT, 1);
    bind(elbow, radius, off);
    himc_pose_to_state(&skeleton, &pose, rate, &state);
    for (int k = 0; k < HIMC_ARM_JOINTS; k++)
        wanted[himc_arm_joint(HIMC_LEFT, k)] = random_vector(20);
    himc_vec3 outward = himc_mat3_apply(&state.rotation[elbow + 1], himc_vec3_unit(off));
    wanted[elbow] = himc_vec3_madd(wanted[elbow], 200, outward);
    himc_vec3 before = himc_tip_acceleration(&skeleton, &state, HIMC_LEFT, wanted, NULL);
    himc_vec3 asked = wanted[elbow];
    yield();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1, himc_limit_measure(&limits, elbow, soon(elbow)));
    himc_vec3 lever = jacobian[HIMC_LEFT].lever[1];
    himc_vec3 taken = himc_vec3_sub(asked, wanted[elbow]);
    *lost = himc_vec3_length(himc_vec3_cross(taken, lever));
    himc_vec3 now = himc_tip_acceleration(&skeleton, &state, HIMC_LEFT, wanted, NULL);
    *left = himc_vec3_length(himc_vec3_sub(before, now));
}

static himc_vec3 limit_torque(int joint)
{
    himc_vec3 torque[HIMC_JOINTS], resistance[HIMC_JOINTS];
    memset(torque, 0, sizeof torque);
    memset(resistance, 0, sizeof resistance);
    himc_pose_to_state(&skeleton, &pose, rate, &state);
    himc_limits_resist(&controller, &skeleton, &state, torque, resistance);
    return torque[joint];
}

// a stick at random orientations and spins, also where the nearest orientation inside jumps
static void test_limit_damping_beside_servos_never_adds_energy(void)
{
    int joint = himc_arm_joint(HIMC_RIGHT, 3), against = 0;
    srand(7);
    for (int i = 0; i < 20000; i++) {
        limits.kind = i % 2 ? HIMC_LIMITS_EULER : HIMC_LIMITS_ELLIPSOID;
        limits.joint[joint] = (himc_limit){.bound = true,
                                           .mean = himc_quat_exp(random_vector(1)),
                                           .axes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                           .radius = {0.3, 0.1, 0.5},
                                           .lower = {-0.2, -0.3, -0.1},
                                           .upper = {0.1, 0.3, 0.4}};
        pose.joint[joint] = himc_quat_exp(random_vector(3));
        rate[joint] = himc_vec3_make(0, 0, 0);
        himc_vec3 pulls = limit_torque(joint);
        rate[joint] = random_vector(pow(10, i % 4));
        himc_vec3 damps = himc_vec3_sub(limit_torque(joint), pulls);
        himc_vec3 spin =
            himc_vec3_sub(state.spin[joint + 1], state.spin[skeleton.segment[joint + 1].parent]);
        double power = himc_vec3_dot(damps, spin);
        TEST_ASSERT_TRUE(power <= 1e-9 * himc_vec3_length(damps) * himc_vec3_length(spin));
        against += power < 0;
    }
    TEST_ASSERT_TRUE(against > 15000);
}

static void test_other_joints_compensate_a_stopped_elbow_at_the_tip(void)
{
    for (int i = 0; i < 3; i++) {
        himc_vec3 axis = himc_vec3_make(i == 0, i == 1, i == 2);
        himc_vec3 radius = himc_vec3_make(i == 0 ? 0.2 : 3, i == 1 ? 0.2 : 3, i == 2 ? 0.2 : 3);
        double lost, left;
        setUp();
        stop_elbow(radius, himc_vec3_scale(axis, 0.2), &lost, &left);
        TEST_ASSERT_TRUE(lost > 10);
        TEST_ASSERT_TRUE(left < 0.02 * lost); // the damping's share: measured .007, .014, .012
    }
}

// a hit is counted when a joint reaches its bounds, and again after it has been at 0.85 of them
static void visit(double measure, double outward)
{
    himc_quat mean = limits.joint[NECK].mean;
    pose.joint[NECK] = himc_quat_mul(mean, himc_quat_exp(himc_vec3_make(0, 0.4 * measure, 0)));
    memset(wanted, 0, sizeof wanted);
    himc_pose_to_state(&skeleton, &pose, rate, &state);
    wanted[NECK] = himc_mat3_apply(&state.rotation[HIMC_NECK], himc_vec3_make(0, outward, 0));
    yield();
}

static void test_a_joint_hits_its_bounds_again_once_it_has_left_them(void)
{
    bind(NECK, himc_vec3_make(0.4, 0.4, 0.4), himc_vec3_make(0, 0, 0));
    visit(0.99, 1000);
    TEST_ASSERT_EQUAL_INT(1, saturation.hits[NECK]);
    visit(0.86, 0);
    TEST_ASSERT_TRUE(saturation.held[NECK]);
    visit(0.99, 1000);
    TEST_ASSERT_EQUAL_INT(1, saturation.hits[NECK]);
    visit(0.84, 0);
    TEST_ASSERT_FALSE(saturation.held[NECK]);
    visit(0.99, 1000);
    TEST_ASSERT_EQUAL_INT(2, saturation.hits[NECK]);
}

// so little that the angle beyond is of no use, and nothing moves the joint
static void test_a_joint_at_rest_a_little_beyond_its_bounds_is_on_them_a_moment_later(void)
{
    bind(NECK, himc_vec3_make(0.2, 0.2, 0.2), himc_vec3_make(0, 0.205, 0));
    saturation.farthest[NECK] = 1;
    yield();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, himc_limit_measure(&limits, NECK, soon(NECK)));
}

// the angle is not computed in each step, but the largest is that of all steps
static void test_the_farthest_angle_beyond_is_that_of_all_steps(void)
{
    static const double reach[] = {0.02, 0.3, 1};
    double farthest = 0, before = 0;
    long records = 0;
    bind(NECK, himc_vec3_make(0.2, 0.1, 0.003), himc_vec3_make(0, 0, 0));
    for (int i = 0; i < 3000; i++) {
        himc_vec3 off = random_vector(reach[i % 3] * i / 3000);
        pose.joint[NECK] = himc_quat_mul(limits.joint[NECK].mean, himc_quat_exp(off));
        rate[NECK] = random_vector(5);
        yield();
        himc_quat near = himc_limit_closest(&limits, NECK, pose.joint[NECK]);
        himc_quat beyond = himc_quat_mul(near, himc_quat_conj(pose.joint[NECK]));
        farthest = fmax(farthest, himc_vec3_length(himc_quat_log(beyond)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, farthest, saturation.farthest[NECK]);
        records += farthest > before;
        before = farthest;
    }
    TEST_ASSERT_TRUE(records > 10);
}

// Fice et al. 2014: neck 51 N m; Holzbaur et al. 2007: shoulder 68 +- 28, wrist 10 +- 5; Delp et
// al. 1996: wrist 12; the rest are round figures (strength.c)
static void test_strength_of_75_kg_is_that_of_the_table(void)
{
    static const struct {
        const char *joint;
        double strength; // (N m)
    } table[] = {
        {"waist", 250},         {"neck", 50},       {"head", 50},        {"left-shoulder", 80},
        {"right-shoulder", 80}, {"left-elbow", 70}, {"right-elbow", 70}, {"left-wrist", 12},
        {"right-wrist", 12},    {"left-grip", 5},   {"right-grip", 5},   {"left-hip", 200},
        {"right-hip", 200},     {"left-knee", 200}, {"right-knee", 200}, {"left-ankle", 130},
        {"right-ankle", 130},   {"left-toes", 15},  {"right-toes", 15}};
    TEST_ASSERT_EQUAL_INT(HIMC_JOINTS, sizeof table / sizeof table[0]);
    himc_controller_set_human_strength(&controller.config, 75);
    for (int i = 0; i < HIMC_JOINTS; i++) {
        int j = himc_joint_find(table[i].joint);
        TEST_ASSERT_TRUE_MESSAGE(j >= 0, table[i].joint);
        TEST_ASSERT_EQUAL_DOUBLE(table[i].strength, controller.config.strength[j]);
    }
}

// Hill 1938: a muscle that shortens pulls less, none at 20 rad/s; a stretched one pulls in full
static void test_strength_falls_with_the_speed_along_the_torque(void)
{
    static const double speed[] = {0, 5, 10, 25, -10}, left[] = {8, 6, 4, 0, 8};
    int elbow = himc_arm_joint(HIMC_LEFT, 1);
    controller.config.strength[elbow] = 8;
    for (int i = 0; i < 5; i++) {
        himc_vec3 torque[HIMC_JOINTS] = {[0] = {0, 0, 0}};
        state.spin[elbow + 1] = himc_vec3_madd(state.spin[skeleton.segment[elbow + 1].parent],
                                               speed[i], himc_vec3_make(0.6, 0, 0.8));
        torque[elbow] = himc_vec3_make(0.6 * 30, 0, 0.8 * 30);
        himc_strength_apply(&controller, &skeleton, &state, (double[]){1, 1}, torque);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, left[i], himc_vec3_length(torque[elbow]));
    }
}

// of all torques as strong, what is given is nearest to the asked one in what it accelerates
static void test_a_weak_joint_lacks_torque_where_its_limb_is_heavy(void)
{
    int shoulder = himc_arm_joint(HIMC_LEFT, 0);
    himc_articulation art;
    himc_articulate_upper(&skeleton, &state, &art);
    controller.config.strength[shoulder] = 8;
    for (int n = 0; n < 200; n++) {
        himc_vec3 torque[HIMC_JOINTS] = {[0] = {0, 0, 0}}, other = himc_vec3_unit(random_vector(1));
        himc_vec3 asked = himc_vec3_scale(himc_vec3_unit(random_vector(1)), n % 2 ? 9 : 40);
        state.spin[shoulder + 1] = state.spin[skeleton.segment[shoulder + 1].parent];
        torque[shoulder] = asked;
        himc_strength_apply(&controller, &skeleton, &state, (double[]){1, 1}, torque);
        himc_vec3 lacks = himc_vec3_sub(asked, torque[shoulder]);
        himc_vec3 would = himc_vec3_madd(asked, -8, other);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 8, himc_vec3_length(torque[shoulder]));
        TEST_ASSERT_TRUE(
            himc_vec3_dot(lacks, himc_symmetric_apply(&art.inverse[shoulder + 1], lacks)) <=
            himc_vec3_dot(would, himc_symmetric_apply(&art.inverse[shoulder + 1], would)) + 1e-4);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_joint_about_to_leave_its_bounds_is_on_them_a_moment_later);
    RUN_TEST(test_a_demand_on_an_arm_is_bounded_and_keeps_its_proportions);
    RUN_TEST(test_errors_of_an_arm_are_bounded_and_keep_their_proportions);
    RUN_TEST(test_a_turning_parent_drives_no_joint_out_of_its_bounds);
    RUN_TEST(test_a_joint_far_beyond_its_bounds_returns_at_3_radians_a_second);
    RUN_TEST(test_limit_damping_beside_servos_never_adds_energy);
    RUN_TEST(test_other_joints_compensate_a_stopped_elbow_at_the_tip);
    RUN_TEST(test_a_joint_hits_its_bounds_again_once_it_has_left_them);
    RUN_TEST(test_a_joint_at_rest_a_little_beyond_its_bounds_is_on_them_a_moment_later);
    RUN_TEST(test_the_farthest_angle_beyond_is_that_of_all_steps);
    RUN_TEST(test_strength_of_75_kg_is_that_of_the_table);
    RUN_TEST(test_strength_falls_with_the_speed_along_the_torque);
    RUN_TEST(test_a_weak_joint_lacks_torque_where_its_limb_is_heavy);
    return UNITY_END();
}
