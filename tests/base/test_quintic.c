/// test_quintic.c: both end states are exact, minimum jerk is the known curve, any quintic is
/// recovered from its ends.
#include "base/quintic.h"

#include "unity.h"

#include <stdlib.h>

void setUp(void)
{
    srand(2);
}

void tearDown(void)
{
}

static double random_unit(void)
{
    return 2.0 * rand() / RAND_MAX - 1;
}

static himc_vec3 random_vector(double scale)
{
    double x = random_unit(), y = random_unit(), z = random_unit();
    return himc_vec3_make(scale * x, scale * y, scale * z);
}

static himc_target random_target(void)
{
    himc_target t = {random_vector(1), random_vector(5), random_vector(100)};
    return t;
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static void assert_state(const himc_target *want, const himc_target *got, double relative)
{
    TEST_ASSERT_DOUBLE_WITHIN(relative, 0, distance(want->x, got->x));
    TEST_ASSERT_DOUBLE_WITHIN(relative * 10, 0, distance(want->v, got->v));
    TEST_ASSERT_DOUBLE_WITHIN(relative * 200, 0, distance(want->a, got->a));
}

static void test_both_ends_have_the_given_position_velocity_and_acceleration(void)
{
    for (int i = 0; i < 1000; i++) {
        double duration = 0.02 + 0.5 * (1 + random_unit());
        himc_target from = random_target(), to = random_target();
        himc_quintic q = himc_quintic_make(&from, &to, duration);
        himc_target start = himc_quintic_at(&q, 0), end = himc_quintic_at(&q, duration);
        assert_state(&from, &start, 1e-15);
        assert_state(&to, &end, 1e-12 + 1e-13 / (duration * duration));
    }
}

static void test_rest_to_rest_is_minimum_jerk_with_peak_speed_1_875(void)
{
    himc_target from = {.x = {0, 0, 0}}, to = {.x = {1, -2, 0.5}};
    double duration = 0.4;
    himc_quintic q = himc_quintic_make(&from, &to, duration);
    for (int i = 0; i <= 100; i++) {
        double u = i / 100.0, s = u * u * u * (10 - 15 * u + 6 * u * u);
        himc_target at = himc_quintic_at(&q, u * duration);
        TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0, distance(himc_vec3_scale(to.x, s), at.x));
    }
    himc_target middle = himc_quintic_at(&q, duration / 2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, 1.875 / duration, middle.v.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-11, 0, himc_vec3_length(middle.a));
}

static void test_stroke_down_is_monotone_up_to_speed_ratio_2_5(void)
{
    static const double ratio[] = {2.0, 2.49, 2.6};
    for (int k = 0; k < 3; k++) {
        himc_target from = {.x = {0, 0, 0.3}}, to = {.v = {0, 0, -ratio[k] * 0.3 / 0.2}};
        himc_quintic q = himc_quintic_make(&from, &to, 0.2);
        bool monotone = true;
        for (int i = 0; i <= 1000; i++)
            monotone = monotone && himc_quintic_at(&q, 0.2 * i / 1000).v.z <= 1e-12;
        TEST_ASSERT_EQUAL_INT(ratio[k] <= 2.5, monotone);
    }
}

static void test_derivatives_are_those_of_the_position(void)
{
    himc_target from = random_target(), to = random_target();
    himc_quintic q = himc_quintic_make(&from, &to, 0.3);
    double h = 1e-5;
    for (int i = 1; i < 20; i++) {
        double t = 0.3 * i / 20;
        himc_target before = himc_quintic_at(&q, t - h), at = himc_quintic_at(&q, t);
        himc_target after = himc_quintic_at(&q, t + h);
        himc_vec3 v = himc_vec3_scale(himc_vec3_sub(after.x, before.x), 0.5 / h);
        himc_vec3 a = himc_vec3_scale(himc_vec3_sub(after.v, before.v), 0.5 / h);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, distance(v, at.v));
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, distance(a, at.a));
    }
}

static void test_any_quintic_is_recovered_from_its_ends(void)
{
    for (int i = 0; i < 100; i++) {
        himc_quintic q;
        for (int k = 0; k < 6; k++)
            q.c[k] = random_vector(1);
        double duration = 0.5 + 0.4 * random_unit();
        himc_target from = himc_quintic_at(&q, 0), to = himc_quintic_at(&q, duration);
        himc_quintic back = himc_quintic_make(&from, &to, duration);
        for (int k = 0; k <= 10; k++) {
            himc_target a = himc_quintic_at(&q, k * duration / 10);
            himc_target b = himc_quintic_at(&back, k * duration / 10);
            assert_state(&a, &b, 1e-13);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_both_ends_have_the_given_position_velocity_and_acceleration);
    RUN_TEST(test_rest_to_rest_is_minimum_jerk_with_peak_speed_1_875);
    RUN_TEST(test_stroke_down_is_monotone_up_to_speed_ratio_2_5);
    RUN_TEST(test_derivatives_are_those_of_the_position);
    RUN_TEST(test_any_quintic_is_recovered_from_its_ends);
    return UNITY_END();
}
