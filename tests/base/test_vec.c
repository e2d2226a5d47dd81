/// test_vec.c: vectors, quaternions and matrices against each other and values computed by hand.
#include "himc/vec.h"

#include "unity.h"

#include <stdlib.h>

void setUp(void)
{
    srand(1);
}

void tearDown(void)
{
}

static double random_unit(void)
{
    return 2.0 * rand() / RAND_MAX - 1;
}

static himc_vec3 random_vector(void)
{
    double x = random_unit(), y = random_unit(), z = random_unit();
    return himc_vec3_make(x, y, z);
}

static himc_quat random_rotation(void)
{
    return himc_quat_exp(himc_vec3_scale(random_vector(), 3));
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

#define ASSERT_NEAR(a, b, tolerance) TEST_ASSERT_DOUBLE_WITHIN(tolerance, 0, distance(a, b))

static void test_quarter_turn_about_z_takes_x_to_y(void)
{
    himc_quat q = himc_quat_exp(himc_vec3_make(0, 0, HIMC_PI / 2));
    ASSERT_NEAR(himc_vec3_make(0, 1, 0), himc_quat_rotate(q, himc_vec3_make(1, 0, 0)), 1e-15);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, sqrt(0.5), q.w);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, sqrt(0.5), q.z);
}

static void test_cross_product_is_right_handed_and_perpendicular(void)
{
    himc_vec3 x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
    ASSERT_NEAR(z, himc_vec3_cross(x, y), 0);
    ASSERT_NEAR(x, himc_vec3_cross(y, z), 0);
    for (int i = 0; i < 100; i++) {
        himc_vec3 a = random_vector(), b = random_vector(), c = himc_vec3_cross(a, b);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0, himc_vec3_dot(a, c));
        double ab = himc_vec3_dot(a, b);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, himc_vec3_dot(a, a) * himc_vec3_dot(b, b) - ab * ab,
                                  himc_vec3_dot(c, c));
    }
}

static void test_unit_of_zero_stays_zero(void)
{
    himc_vec3 zero = {0, 0, 0};
    ASSERT_NEAR(zero, himc_vec3_unit(zero), 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1,
                              himc_vec3_length(himc_vec3_unit(himc_vec3_make(3, -4, 12))));
}

static void test_finite_checks_every_component(void)
{
    TEST_ASSERT_TRUE(himc_vec3_finite(himc_vec3_make(1, -2, 3)));
    TEST_ASSERT_FALSE(himc_vec3_finite(himc_vec3_make(NAN, 0, 0)));
    TEST_ASSERT_FALSE(himc_vec3_finite(himc_vec3_make(0, INFINITY, 0)));
    TEST_ASSERT_FALSE(himc_vec3_finite(himc_vec3_make(0, 0, -INFINITY)));
}

// v cos t + (k x v) sin t + k (k . v) (1 - cos t)
static himc_vec3 rodrigues(himc_vec3 rotation, himc_vec3 v)
{
    double t = himc_vec3_length(rotation);
    himc_vec3 k = himc_vec3_scale(rotation, 1 / t);
    himc_vec3 r = himc_vec3_scale(v, cos(t));
    r = himc_vec3_madd(r, sin(t), himc_vec3_cross(k, v));
    return himc_vec3_madd(r, himc_vec3_dot(k, v) * (1 - cos(t)), k);
}

static void test_exp_rotates_by_rodrigues_formula(void)
{
    for (int i = 0; i < 1000; i++) {
        himc_vec3 rotation = himc_vec3_scale(random_vector(), 6), v = random_vector();
        himc_vec3 got = himc_quat_rotate(himc_quat_exp(rotation), v);
        ASSERT_NEAR(rodrigues(rotation, v), got, 1e-14);
    }
}

static void test_product_applies_the_right_factor_first(void)
{
    for (int i = 0; i < 100; i++) {
        himc_quat a = random_rotation(), b = random_rotation();
        himc_vec3 v = random_vector();
        ASSERT_NEAR(himc_quat_rotate(a, himc_quat_rotate(b, v)),
                    himc_quat_rotate(himc_quat_mul(a, b), v), 1e-14);
        ASSERT_NEAR(v, himc_quat_rotate(himc_quat_conj(a), himc_quat_rotate(a, v)), 1e-14);
    }
}

static void test_log_undoes_exp_up_to_half_a_turn(void)
{
    for (int i = 0; i < 1000; i++) {
        double angle = HIMC_PI * i / 1000;
        himc_vec3 rotation = himc_vec3_scale(himc_vec3_unit(random_vector()), angle);
        ASSERT_NEAR(rotation, himc_quat_log(himc_quat_exp(rotation)), 1e-13);
    }
}

static void test_log_and_exp_keep_tiny_angles(void)
{
    for (double angle = 1e-3; angle > 1e-200; angle *= 0.1) {
        himc_vec3 rotation = {angle, -2 * angle, 0.5 * angle};
        himc_vec3 back = himc_quat_log(himc_quat_exp(rotation));
        TEST_ASSERT_DOUBLE_WITHIN(1e-13 * angle, angle, back.x);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13 * angle, -2 * angle, back.y);
    }
}

// against long double: at the ends of the polynomials and between
static void test_log_and_exp_are_exact_to_rounding(void)
{
    for (int i = 0; i < 20000; i++) {
        himc_vec3 r = himc_vec3_scale(himc_vec3_unit(random_vector()), HIMC_PI * i / 20000);
        long double half = hypotl(hypotl(r.x, r.y), r.z) / 2, square;
        long double s = half > 0 ? sinl(half) / half / 2 : 0.5L;
        himc_quat q = himc_quat_exp(r);
        TEST_ASSERT_DOUBLE_WITHIN(5e-16, 0, (double)(q.w - cosl(half)));
        TEST_ASSERT_DOUBLE_WITHIN(5e-16, 0, (double)(q.y - r.y * s));
        square = (long double)q.x * q.x + (long double)q.y * q.y + (long double)q.z * q.z;
        if (i > 0)
            s = 2 * atan2l(sqrtl(square), q.w) / sqrtl(square);
        himc_vec3 back = himc_quat_log(q);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15 * (1 + fabs(back.x)), 0, (double)(back.x - s * q.x));
    }
}

static void test_log_takes_the_shorter_way_and_ignores_the_sign(void)
{
    for (int i = 0; i < 1000; i++) {
        himc_quat q = himc_quat_exp(himc_vec3_scale(random_vector(), 10));
        himc_vec3 a = himc_quat_log(q), b = himc_quat_log(himc_quat_scale(q, -1));
        TEST_ASSERT_TRUE(himc_vec3_length(a) <= HIMC_PI + 1e-14);
        ASSERT_NEAR(a, b, 1e-13);
    }
}

static void test_matrix_and_quaternion_are_the_same_rotation(void)
{
    for (int i = 0; i < 1000; i++) {
        himc_quat q = random_rotation();
        himc_mat3 r = himc_mat3_from_quat(q);
        himc_vec3 v = random_vector();
        ASSERT_NEAR(himc_quat_rotate(q, v), himc_mat3_apply(&r, v), 1e-14);
        ASSERT_NEAR(v, himc_mat3_apply_transposed(&r, himc_mat3_apply(&r, v)), 1e-14);
    }
}

static void test_matrix_to_quaternion_and_back_at_every_largest_component(void)
{
    static const double near_half_turn[] = {0, 1, 2, 3, 3.1415, HIMC_PI};
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 50; k++) {
            himc_vec3 axis = k < 3 ? himc_vec3_make(k == 0, k == 1, k == 2) : random_vector();
            axis = himc_vec3_unit(axis);
            himc_quat q = himc_quat_exp(himc_vec3_scale(axis, near_half_turn[i]));
            himc_quat back = himc_quat_from_mat3(himc_mat3_from_quat(q));
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, 1, fabs(himc_quat_dot(q, back)));
            TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1, himc_quat_dot(back, back));
        }
}

static void test_matrix_from_axes_has_them_as_columns(void)
{
    himc_vec3 x = {0, 1, 0}, y = {0, 0, 1}, z = {1, 0, 0};
    himc_mat3 r = himc_mat3_from_axes(x, y, z);
    ASSERT_NEAR(x, himc_mat3_apply(&r, himc_vec3_make(1, 0, 0)), 0);
    ASSERT_NEAR(y, himc_mat3_apply(&r, himc_vec3_make(0, 1, 0)), 0);
    ASSERT_NEAR(z, himc_mat3_apply(&r, himc_vec3_make(0, 0, 1)), 0);
}

static void test_matrix_product_applies_the_right_matrix_first(void)
{
    himc_mat3 a = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}}, b = {{{0, -1, 2}, {3, 1, 0}, {5, 2, 1}}};
    himc_mat3 c = himc_mat3_mul(&a, &b);
    himc_vec3 v = {0.5, -2, 3};
    ASSERT_NEAR(himc_mat3_apply(&a, himc_mat3_apply(&b, v)), himc_mat3_apply(&c, v), 1e-12);
    TEST_ASSERT_EQUAL_DOUBLE(21, c.m[0][0]);
}

static void test_symmetric_inverse_times_matrix_is_one(void)
{
    for (int i = 0; i < 100; i++) {
        himc_vec3 p = random_vector(), q = random_vector(), r = random_vector();
        himc_mat3 b = himc_mat3_from_axes(p, q, r);
        himc_mat3 t = {{{p.x, p.y, p.z}, {q.x, q.y, q.z}, {r.x, r.y, r.z}}};
        himc_mat3 a = himc_mat3_mul(&b, &t);
        for (int k = 0; k < 3; k++)
            a.m[k][k] += 0.1;
        himc_mat3 inverse = himc_mat3_inverse_symmetric(&a), one = himc_mat3_mul(&inverse, &a);
        for (int k = 0; k < 9; k++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-11, k % 4 == 0, one.m[k / 3][k % 3]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_quarter_turn_about_z_takes_x_to_y);
    RUN_TEST(test_cross_product_is_right_handed_and_perpendicular);
    RUN_TEST(test_unit_of_zero_stays_zero);
    RUN_TEST(test_finite_checks_every_component);
    RUN_TEST(test_exp_rotates_by_rodrigues_formula);
    RUN_TEST(test_product_applies_the_right_factor_first);
    RUN_TEST(test_log_undoes_exp_up_to_half_a_turn);
    RUN_TEST(test_log_and_exp_keep_tiny_angles);
    RUN_TEST(test_log_and_exp_are_exact_to_rounding);
    RUN_TEST(test_log_takes_the_shorter_way_and_ignores_the_sign);
    RUN_TEST(test_matrix_and_quaternion_are_the_same_rotation);
    RUN_TEST(test_matrix_to_quaternion_and_back_at_every_largest_component);
    RUN_TEST(test_matrix_from_axes_has_them_as_columns);
    RUN_TEST(test_matrix_product_applies_the_right_matrix_first);
    RUN_TEST(test_symmetric_inverse_times_matrix_is_one);
    return UNITY_END();
}
