/// test_format.c: the texts of lines are those of libc, for all conversions that are
/// in use.
#include "base/format.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static unsigned seed = 7;

static double chance(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) / 16777216.0;
}

#define SAME(...)                                         \
    do {                                                  \
        char a[200], b[200];                              \
        snprintf(a, sizeof a, __VA_ARGS__);               \
        size_t n = himc_format(b, sizeof b, __VA_ARGS__); \
        TEST_ASSERT_EQUAL_STRING(a, b);                   \
        TEST_ASSERT_EQUAL_INT(strlen(a), n);              \
    } while (0)

static void same_number(double x)
{
    SAME("%g", x);
    SAME("%.0g|%.2g|%.3g|%.4g|%.5g|%.6g|%.9g", x, x, x, x, x, x, x);
    if (fabs(x) < 1e9)
        SAME("%.0f|%.1f|%.2f|%.3f|%.4f|%.6f", x, x, x, x, x, x);
    if (fabs(x) < 1e6)
        SAME("%.9f", x);
}

static void test_numbers_are_those_of_libc(void)
{
    static const double some[] = {0,     -0.0,     1,   0.5,     1.5,    2.5,    0.125,   0.375,
                                  99999, 999999.5, 1e6, 9.9e-5,  1e-4,   0.1f,   1e300,   5e-324,
                                  1e-5,  123456.5, 1e9, -1234.5, 0.9999, 999.95, 2.5e-10, 1e308};
    for (size_t i = 0; i < sizeof some / sizeof *some; i++)
        same_number(some[i]);
    same_number(NAN);
    same_number(INFINITY);
    same_number(-INFINITY);
    for (int i = 0; i < 100000; i++)
        same_number((chance() - 0.5) * pow(10, floor(40 * chance() - 20)));
    for (int i = 0; i < 100000; i++) // few digits, as people write them, often half way
        same_number(rint(chance() * 20000) / 16 * pow(10, floor(8 * chance() - 4)));
}

static void test_words_and_whole_numbers_are_those_of_libc(void)
{
    SAME("%s, %.3s, %.*s and %c 100 %%", "one", "fourteen", 2, "two", 'x');
    SAME("%d %d %d %ld %ld %zu %u", 0, -7, -2147483647 - 1, -5L, 123456789012L, (size_t)18, 3u);
    SAME("%.200s", "");
}

static void test_what_does_not_fit_is_cut_off(void)
{
    char b[8];
    TEST_ASSERT_EQUAL_INT(7, himc_format(b, sizeof b, "%s %d", "long", 123456));
    TEST_ASSERT_EQUAL_STRING("long 12", b);
    TEST_ASSERT_EQUAL_INT(0, himc_format(b, 1, "text"));
    TEST_ASSERT_EQUAL_STRING("", b);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_numbers_are_those_of_libc);
    RUN_TEST(test_words_and_whole_numbers_are_those_of_libc);
    RUN_TEST(test_what_does_not_fit_is_cut_off);
    return UNITY_END();
}
