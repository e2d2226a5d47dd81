/// test_bessel.c: Bessel functions and their zeros against tables and the C library.
#define _XOPEN_SOURCE 700 // jn
#include "head/bessel.h"

#include "himc/base.h"
#include "unity.h"

#include <math.h>

void setUp(void)
{
}

void tearDown(void)
{
}

// zeros j_mn to 14 digits (Abramowitz & Stegun 1964, table 9.5, and its continuation)
static const double zeros[11][5] = {
    {2.4048255576958, 5.5200781102863, 8.6537279129110, 11.791534439014, 14.930917708488},
    {3.8317059702075, 7.0155866698156, 10.173468135063, 13.323691936314, 16.470630050878},
    {5.1356223018407, 8.4172441403999, 11.619841172149, 14.795951782351, 17.959819494988},
    {6.3801618959240, 9.7610231299817, 13.015200721698, 16.223466160319, 19.409415226435},
    {7.5883424345038, 11.064709488501, 14.372536671618, 17.615966049805, 20.826932956962},
    {8.7714838159600, 12.338604197467, 15.700174079712, 18.980133875180, 22.217799896561},
    {9.9361095242177, 13.589290170541, 17.003819667816, 20.320789213567, 23.586084435581},
    {11.086370019245, 14.821268727013, 18.287582832482, 21.641541019848, 24.934927887673},
    {12.225092264005, 16.037774190888, 19.554536430997, 22.945173131875, 26.266814641177},
    {13.354300477435, 17.241220382489, 20.807047789264, 24.233885257751, 27.583748963573},
    {14.475500686555, 18.433463666967, 22.046985364698, 25.509450554183, 28.887375063530}};

static void test_bessel_zeros_agree_with_the_tables(void)
{
    for (int m = 0; m <= 10; m++)
        for (int n = 1; n <= 5; n++)
            TEST_ASSERT_DOUBLE_WITHIN(6e-13 * (1 + zeros[m][n - 1]), zeros[m][n - 1],
                                      himc_bessel_zero(m, n));
}

static void test_bessel_first_zero_of_j0_has_all_its_digits(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(5e-16, 2.404825557695772768622, himc_bessel_zero(0, 1));
    TEST_ASSERT_DOUBLE_WITHIN(5e-16, 3.831705970207512315614, himc_bessel_zero(1, 1));
}

static void test_bessel_first_zero_of_j1_is_the_constant(void)
{
    TEST_ASSERT_TRUE(himc_bessel_zero(1, 1) == HIMC_BESSEL_FIRST);
}

static void test_bessel_next_order_at_zeros_agrees_with_the_tables(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0.5191474973, himc_bessel_j(1, himc_bessel_zero(0, 1)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, -0.3001157525, himc_bessel_j(2, himc_bessel_zero(1, 2)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0.1671180997, himc_bessel_j(6, himc_bessel_zero(5, 5)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0.1438126699, himc_bessel_j(11, himc_bessel_zero(10, 5)));
}

static void test_bessel_zeros_of_high_orders_interlace_and_vanish(void)
{
    for (int m = 0; m < 90; m += 7) {
        for (int n = 1; n < 25; n += 3) {
            double z = himc_bessel_zero(m, n);
            TEST_ASSERT_TRUE(z < himc_bessel_zero(m + 1, n));
            TEST_ASSERT_TRUE(himc_bessel_zero(m + 1, n) < himc_bessel_zero(m, n + 1));
            // |J| one rounding of z away from its zero
            TEST_ASSERT_DOUBLE_WITHIN(4e-16 * z + 1e-15, 0, himc_bessel_j(m, z));
        }
    }
}

static void test_bessel_orders_agree_with_the_c_library(void)
{
    double j[101];
    for (double z = 0; z < 120; z += 0.377) {
        himc_bessel_orders(z, 100, j);
        for (int m = 0; m <= 100; m += 9) {
            TEST_ASSERT_DOUBLE_WITHIN(3e-15, jn(m, z), j[m]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-15, j[m], himc_bessel_j(m, z));
        }
    }
}

// Simpson's rule over a smooth function
static double integral_of_square(int m, double j)
{
    const int n = 2000;
    double sum = 0;
    for (int i = 0; i <= n; i++) {
        double x = (double)i / n, f = himc_bessel_j(m, j * x);
        sum += (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * x * f * f;
    }
    return sum / (3.0 * n);
}

static void test_bessel_integral_of_x_j_squared_is_half_the_next_order_squared(void)
{
    for (int m = 0; m <= 6; m += 2) {
        for (int n = 1; n <= 3; n++) {
            double j = himc_bessel_zero(m, n), next = himc_bessel_j(m + 1, j);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, next * next / 2, integral_of_square(m, j));
        }
    }
}

static void test_bessel_fast_order_zero_is_within_a_ten_millionth(void)
{
    for (double z = 0; z < 700; z += 0.013)
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, jn(0, z), himc_bessel_j0(z));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bessel_zeros_agree_with_the_tables);
    RUN_TEST(test_bessel_first_zero_of_j0_has_all_its_digits);
    RUN_TEST(test_bessel_first_zero_of_j1_is_the_constant);
    RUN_TEST(test_bessel_next_order_at_zeros_agrees_with_the_tables);
    RUN_TEST(test_bessel_zeros_of_high_orders_interlace_and_vanish);
    RUN_TEST(test_bessel_orders_agree_with_the_c_library);
    RUN_TEST(test_bessel_integral_of_x_j_squared_is_half_the_next_order_squared);
    RUN_TEST(test_bessel_fast_order_zero_is_within_a_ten_millionth);
    return UNITY_END();
}
