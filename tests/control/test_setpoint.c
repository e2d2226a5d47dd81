/// test_setpoint.c: between ticks tips move on quintics and joints on unit quaternions, C2 at the
/// ticks; and the contract of all that runs in a physics step: nothing is allocated.
#include "allocations.h"
#include "body/character.h"
#include "body/dynamics.h"
#include "control/setpoint.h"

#include "step_with_tips.h"
#include "unity.h"

#include <stdlib.h>
#include <string.h>

#define LEVEL 0.8675
#define PERIOD 0.004

static himc_skeleton skeleton;
static himc_posture posture;

void setUp(void)
{
    himc_skeleton_config config = himc_skeleton_default();
    himc_skeleton_init(&skeleton, &config, NULL);
    himc_posture_init(&posture, &skeleton, LEVEL);
    srand(11);
}

void tearDown(void)
{
}

static void interpolate(const himc_setpoint *from, const himc_setpoint *to, double time,
                        himc_reference *reference)
{
    himc_setpoint_course course;
    himc_setpoint_course_make(&course, from, to);
    himc_setpoint_at(&course, time, reference);
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

// a stroke of both hands at 2 Hz
static void path(double t, himc_target tip[HIMC_HANDS])
{
    double w = 4 * HIMC_PI, r = 0.19;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        double p = w * t + hand * HIMC_PI, s = sin(p), c = cos(p);
        tip[hand].x = himc_vec3_make(0.48 + 0.02 * s, hand ? -0.05 : 0.05, LEVEL + r * (1 - c));
        tip[hand].v = himc_vec3_make(0.02 * w * c, 0, r * w * s);
        tip[hand].a = himc_vec3_make(-0.02 * w * w * s, 0, r * w * w * c);
    }
}

static void tick_at(double t, himc_setpoint *tick)
{
    tick->time = t;
    path(t, tick->tip);
    himc_posture_moving(&posture, tick->tip, &tick->posture);
}

static void test_a_quintic_is_interpolated_exactly(void)
{
    himc_target from = {{0.1, 0.2, 0.3}, {1, -2, 3}, {10, 20, -30}};
    himc_target to = {{0.1, 0.1, 0.4}, {-1, 5, 0}, {0, -50, 100}};
    himc_quintic q = himc_quintic_make(&from, &to, 0.1);
    himc_setpoint a, b;
    himc_reference r;
    tick_at(0, &a);
    tick_at(0, &b);
    a.time = 7.03, b.time = 7.05; // between 0.03 and 0.05 s of that quintic
    a.tip[HIMC_RIGHT] = himc_quintic_at(&q, 0.03);
    b.tip[HIMC_RIGHT] = himc_quintic_at(&q, 0.05);
    for (int i = 0; i <= 20; i++) {
        double t = 0.03 + 0.001 * i;
        himc_target want = himc_quintic_at(&q, t);
        interpolate(&a, &b, 7 + t, &r);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, 0, distance(want.x, r.tip[HIMC_RIGHT].x));
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0, distance(want.v, r.tip[HIMC_RIGHT].v));
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0, distance(want.a, r.tip[HIMC_RIGHT].a));
    }
}

static void test_at_a_tick_the_reference_is_the_tick(void)
{
    himc_setpoint a, b;
    himc_reference r;
    tick_at(0.1, &a);
    tick_at(0.1 + PERIOD, &b);
    for (int end = 0; end < 2; end++) {
        const himc_setpoint *tick = end ? &b : &a;
        interpolate(&a, &b, tick->time, &r);
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0, distance(tick->tip[hand].x, r.tip[hand].x));
            TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0, distance(tick->tip[hand].v, r.tip[hand].v));
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(tick->tip[hand].a, r.tip[hand].a));
        }
        for (int j = 0; j < HIMC_JOINTS; j++) {
            const himc_posture_motion *p = &tick->posture, *q = &r.posture;
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1, himc_quat_dot(p->joint[j], q->joint[j]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0, distance(p->rate[j], q->rate[j]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(p->acceleration[j], q->acceleration[j]));
        }
    }
}

static void test_position_velocity_and_acceleration_agree_across_a_tick(void)
{
    himc_setpoint a, b, c;
    himc_reference before, after;
    tick_at(0.1, &a);
    tick_at(0.1 + PERIOD, &b);
    tick_at(0.1 + 2 * PERIOD, &c);
    interpolate(&a, &b, b.time, &before);
    interpolate(&b, &c, b.time, &after);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0, distance(before.tip[hand].x, after.tip[hand].x));
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0, distance(before.tip[hand].v, after.tip[hand].v));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(before.tip[hand].a, after.tip[hand].a));
    }
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_posture_motion *p = &before.posture, *q = &after.posture;
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1, fabs(himc_quat_dot(p->joint[j], q->joint[j])));
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0, distance(p->rate[j], q->rate[j]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(p->acceleration[j], q->acceleration[j]));
    }
}

static void test_joints_are_unit_quaternions_with_rates_that_are_their_differences(void)
{
    himc_setpoint a, b;
    himc_reference r0, r, r1;
    double h = 1e-6;
    tick_at(0.1, &a);
    tick_at(0.1 + PERIOD, &b);
    for (int i = 1; i < 20; i++) {
        double t = a.time + PERIOD * i / 20;
        interpolate(&a, &b, t - h, &r0);
        interpolate(&a, &b, t, &r);
        interpolate(&a, &b, t + h, &r1);
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_quat q = r.posture.joint[j];
            himc_quat moved =
                himc_quat_mul(r1.posture.joint[j], himc_quat_conj(r0.posture.joint[j]));
            himc_vec3 rate = himc_vec3_scale(himc_quat_log(moved), 0.5 / h);
            himc_vec3 change = himc_vec3_sub(r1.posture.rate[j], r0.posture.rate[j]);
            change = himc_vec3_scale(change, 0.5 / h);
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1, himc_quat_dot(q, q));
            TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, distance(rate, r.posture.rate[j]));
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(change, r.posture.acceleration[j]));
        }
    }
}

static void test_between_ticks_the_joints_stay_on_the_true_motion(void)
{
    himc_setpoint a, b, truth;
    himc_reference r;
    for (double start = 0; start < 0.5; start += 0.02) {
        tick_at(start, &a);
        tick_at(start + PERIOD, &b);
        tick_at(start + 0.3 * PERIOD, &truth);
        interpolate(&a, &b, truth.time, &r);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(truth.tip[hand].x, r.tip[hand].x));
        for (int j = 0; j < HIMC_JOINTS; j++) {
            himc_quat off =
                himc_quat_mul(himc_quat_conj(truth.posture.joint[j]), r.posture.joint[j]);
            TEST_ASSERT_DOUBLE_WITHIN(5e-7, 0, himc_vec3_length(himc_quat_log(off)));
        }
    }
}

static void test_the_sign_of_a_quaternion_does_not_matter(void)
{
    himc_setpoint a, b, c;
    himc_reference r, s;
    tick_at(0.1, &a);
    tick_at(0.1 + PERIOD, &b);
    c = b;
    for (int j = 0; j < HIMC_JOINTS; j += 2)
        c.posture.joint[j] = himc_quat_scale(c.posture.joint[j], -1);
    interpolate(&a, &b, 0.1 + 0.4 * PERIOD, &r);
    interpolate(&a, &c, 0.1 + 0.4 * PERIOD, &s);
    for (int j = 0; j < HIMC_JOINTS; j++) {
        const himc_posture_motion *p = &r.posture, *q = &s.posture;
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1, fabs(himc_quat_dot(p->joint[j], q->joint[j])));
        TEST_ASSERT_EQUAL_DOUBLE(0, distance(p->rate[j], q->rate[j]));
        TEST_ASSERT_EQUAL_DOUBLE(0, distance(p->acceleration[j], q->acceleration[j]));
    }
}

static void test_contact_flags_are_left_alone(void)
{
    himc_setpoint a, b;
    himc_reference r = {.released = {true, false}, .normal = {{1, 2, 3}, {4, 5, 6}}};
    tick_at(0, &a);
    tick_at(PERIOD, &b);
    interpolate(&a, &b, 0.001, &r);
    TEST_ASSERT_TRUE(r.released[HIMC_LEFT] && !r.released[HIMC_RIGHT]);
    TEST_ASSERT_EQUAL_DOUBLE(6, r.normal[HIMC_RIGHT].z);
}

static void run_all_rt(himc_character *character, himc_setpoint tick[2])
{
    himc_controller controller;
    himc_reference reference = {.released = {false, false}};
    himc_body_state state;
    himc_vec3 torque[HIMC_JOINTS], relative[HIMC_JOINTS] = {{0, 0, 0}};
    himc_pose pose = himc_pose_zero();
    himc_body_state copy;
    himc_articulation art;
    himc_posture_init(&posture, &skeleton, LEVEL);
    himc_posture_at(&posture, (himc_vec3[]){tick[0].tip[0].x, tick[0].tip[1].x}, &pose);
    himc_pose_to_state(&skeleton, &pose, NULL, &state);
    himc_controller_config control = himc_controller_config_default();
    himc_controller_init(&controller, &control, &skeleton, &state);
    himc_posture_reachable(&posture, HIMC_LEFT, himc_vec3_make(3, 0, 1));
    himc_posture_moving(&posture, tick[0].tip, &tick[0].posture);
    interpolate(&tick[0], &tick[1], 0.001, &reference);
    himc_character_place(character, &state);
    for (int solver = HIMC_SOLVER_DLS; solver < HIMC_SOLVERS; solver++)
        for (int law = HIMC_LAW_PRINTED; law <= HIMC_LAW_COMPUTED_TORQUE; law++)
            for (int n = 0; n < 20; n++) {
                controller.config.solver = (himc_solver)solver;
                controller.config.law = (himc_law)law;
                reference.released[HIMC_LEFT] = n % 2;
                reference.normal[HIMC_LEFT] = himc_vec3_make(0, 0, 1);
                himc_character_observe(character, &state);
                himc_controller_torques(&controller, &skeleton, &state, &reference, torque);
                step_with_tips(character, &skeleton, torque, (himc_vec3[]){{0, 0, n}, {1, 0, 0}},
                               1e-4);
            }
    copy = state;
    pose = himc_pose_from_state(&skeleton, &copy);
    himc_pose_to_state(&skeleton, &pose, NULL, &copy);
    himc_articulate(&skeleton, &copy, &art);
    himc_forward_dynamics(&skeleton, &copy, &art, torque, NULL, relative);
    himc_tip_acceleration(&skeleton, &copy, HIMC_LEFT, relative, NULL);
    himc_effective_mass(&skeleton, &copy, &art, HIMC_LEFT, himc_vec3_make(0, 0, 1));
    himc_controller_gain(&controller, 0, 1000, 10);
    himc_controller_configure(&controller, &control);
}

static void test_nothing_is_allocated_from_task_to_character(void)
{
    himc_setpoint tick[2] = {{.time = 0}, {.time = 0.004}};
    for (int k = 0; k < 2; k++) {
        path(tick[k].time, tick[k].tip);
        himc_posture_moving(&posture, tick[k].tip, &tick[k].posture);
    }
    himc_character *character = himc_character_new(&skeleton, NULL);
    watch_allocations();
    run_all_rt(character, tick);
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
    himc_character_free(character);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_quintic_is_interpolated_exactly);
    RUN_TEST(test_at_a_tick_the_reference_is_the_tick);
    RUN_TEST(test_position_velocity_and_acceleration_agree_across_a_tick);
    RUN_TEST(test_joints_are_unit_quaternions_with_rates_that_are_their_differences);
    RUN_TEST(test_between_ticks_the_joints_stay_on_the_true_motion);
    RUN_TEST(test_the_sign_of_a_quaternion_does_not_matter);
    RUN_TEST(test_contact_flags_are_left_alone);
    RUN_TEST(test_nothing_is_allocated_from_task_to_character);
    return UNITY_END();
}
