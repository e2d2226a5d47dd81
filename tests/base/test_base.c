/// test_base.c: errors are one line; ranges are refused with name, value, unit and allowed range.
#include "himc/base.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static himc_error error;

void setUp(void)
{
    memset(&error, 'x', sizeof error);
    error.text[0] = 0;
}

void tearDown(void)
{
}

static void test_error_set_formats_and_returns_false(void)
{
    TEST_ASSERT_FALSE(himc_error_set(&error, "%s: %d frames", "take", 3));
    TEST_ASSERT_EQUAL_STRING("take: 3 frames", error.text);
}

static void test_errors_may_be_null(void)
{
    TEST_ASSERT_FALSE(himc_error_set(NULL, "%d", 1));
    TEST_ASSERT_FALSE(himc_error_prefix(NULL, "%d", 1));
    TEST_ASSERT_FALSE(himc_check_range("rate", -1, 0, 1, "Hz", NULL));
}

static void test_prefix_goes_before_the_line(void)
{
    himc_error_set(&error, "no tip");
    TEST_ASSERT_FALSE(himc_error_prefix(&error, "%s:%d", "a.trc", 7));
    TEST_ASSERT_EQUAL_STRING("a.trc:7: no tip", error.text);
    himc_error_prefix(&error, "load");
    TEST_ASSERT_EQUAL_STRING("load: a.trc:7: no tip", error.text);
}

static void test_long_errors_are_cut_and_stay_strings(void)
{
    char text[2000];
    memset(text, 'a', sizeof text);
    text[sizeof text - 1] = 0;
    himc_error_set(&error, "%s", text);
    TEST_ASSERT_EQUAL_UINT(sizeof error.text - 1, strlen(error.text));
    himc_error_prefix(&error, "where");
    TEST_ASSERT_EQUAL_UINT(sizeof error.text - 1, strlen(error.text));
    TEST_ASSERT_EQUAL_STRING_LEN("where: aaa", error.text, 10);
    himc_error_prefix(&error, "%s", text);
    TEST_ASSERT_EQUAL_UINT(sizeof error.text - 1, strlen(error.text));
}

static void test_range_includes_its_ends(void)
{
    TEST_ASSERT_TRUE(himc_check_range("radius", 0.05, 0.05, 1, "m", &error));
    TEST_ASSERT_TRUE(himc_check_range("radius", 1, 0.05, 1, "m", &error));
    TEST_ASSERT_EQUAL_STRING("", error.text);
}

static void test_range_names_field_value_and_allowed_range(void)
{
    TEST_ASSERT_FALSE(himc_check_range("radius", 0, 0.05, 1, "m", &error));
    TEST_ASSERT_EQUAL_STRING("radius: 0 m, expected 0.05 .. 1 m", error.text);
    TEST_ASSERT_FALSE(himc_check_range("radius", nextafter(1, 2), 0.05, 1, "m", &error));
}

static void test_range_without_unit_has_no_stray_space(void)
{
    TEST_ASSERT_FALSE(himc_check_range("modes", 7000, 1, 4000, "", &error));
    TEST_ASSERT_EQUAL_STRING("modes: 7000, expected 1 .. 4000", error.text);
}

static void test_range_refuses_values_that_are_not_finite_even_if_unbounded(void)
{
    TEST_ASSERT_FALSE(himc_check_range("mass", NAN, 1, 2, "kg", &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "mass: nan kg"));
    TEST_ASSERT_FALSE(himc_check_range("mass", INFINITY, 0, INFINITY, "kg", &error));
    TEST_ASSERT_FALSE(himc_check_range("mass", -INFINITY, -INFINITY, 0, "kg", &error));
}

static void test_hands_have_names(void)
{
    TEST_ASSERT_EQUAL_STRING("left", himc_hand_name(HIMC_LEFT));
    TEST_ASSERT_EQUAL_STRING("right", himc_hand_name(HIMC_RIGHT));
    TEST_ASSERT_EQUAL_INT(2, HIMC_HANDS);
}

static void test_version_is_made_of_its_three_numbers(void)
{
    char text[40];
    snprintf(text, sizeof text, "%d.%d.%d", HIMC_VERSION_MAJOR, HIMC_VERSION_MINOR,
             HIMC_VERSION_PATCH);
    TEST_ASSERT_EQUAL_STRING(text, himc_version());
    TEST_ASSERT_EQUAL_STRING(text, HIMC_VERSION);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_error_set_formats_and_returns_false);
    RUN_TEST(test_errors_may_be_null);
    RUN_TEST(test_prefix_goes_before_the_line);
    RUN_TEST(test_long_errors_are_cut_and_stay_strings);
    RUN_TEST(test_range_includes_its_ends);
    RUN_TEST(test_range_names_field_value_and_allowed_range);
    RUN_TEST(test_range_without_unit_has_no_stray_space);
    RUN_TEST(test_range_refuses_values_that_are_not_finite_even_if_unbounded);
    RUN_TEST(test_hands_have_names);
    RUN_TEST(test_version_is_made_of_its_three_numbers);
    return UNITY_END();
}
