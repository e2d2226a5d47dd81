/// The motion that the viewer plays back: what is refused, in which words.
#include "motion.h"

#include <string.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void accept(const char *text)
{
    himc_error error = {""};
    TEST_ASSERT_TRUE_MESSAGE(motion_check(text, strlen(text), "m.csv", &error), error.text);
}

static void refuse_bytes(const char *text, size_t size, const char *why)
{
    himc_error error = {""};
    TEST_ASSERT_FALSE_MESSAGE(motion_check(text, size, "m.csv", &error), text);
    TEST_ASSERT_EQUAL_STRING(why, error.text);
}

static void refuse(const char *text, const char *why)
{
    refuse_bytes(text, strlen(text), why);
}

static void test_rows_of_as_many_numbers_as_names_are_a_motion(void)
{
    accept("time_s,a\n0,1\n1,2\n");
    accept("time_s,a\n0,1\n1,2");
    accept("time_s,a\r\n-1,+1e-3\r\n.5,-2.\r\n\r\n");
    accept("time_s,a\n\n0,1\n\n1,2\n\n");
}

static void test_another_table_is_no_motion(void)
{
    const char *why =
        "m.csv:1: not a motion: its first column must be time_s (himc render --motion)";
    refuse("", why);
    refuse("time_s", why);
    refuse("x,time_s\n0,1\n", why);
    refuse("\ntime_s,a\n0,1\n1,2\n", why);
    refuse_bytes("time_s,a\0\n0,1\n1,2\n", 18, "m.csv: not a text");
}

static void test_a_faulty_row_is_named(void)
{
    refuse("time_s,a\n0,1\n1\n", "m.csv:3: 1 numbers, wanted 2");
    refuse("time_s,a\n0,1\n1,2,3\n", "m.csv:3: 3 numbers, wanted 2");
    refuse("time_s,a\n0,\n", "m.csv:2: : not a number");
    refuse("time_s,a\n0,nan\n", "m.csv:2: nan: not a number");
    refuse("time_s,a\n0,1e999\n", "m.csv:2: 1e999: not a number");
    refuse("time_s,a\n0,1 \n", "m.csv:2: 1 : not a number");
    refuse("time_s,a\n0,\033[31m\n", "m.csv:2: ?[31m: not a number");
    refuse("time_s,a\n0,1\n0,1\n", "m.csv:3: time 0 s, allowed only above 0 s");
    refuse("time_s,a\n0,1\n-1,1\n", "m.csv:3: time -1 s, allowed only above 0 s");
}

static void test_fewer_than_two_rows_are_refused(void)
{
    refuse("time_s,a\n", "m.csv: 0 rows, wanted at least 2");
    refuse("time_s,a\n0,1\n", "m.csv: 1 rows, wanted at least 2");
}

static void test_a_word_of_any_length_is_refused_in_one_line(void)
{
    char text[3000] = "time_s,a\n0,";
    size_t used = strlen(text);
    memset(text + used, '7', sizeof text - used - 1);
    refuse(text, "m.csv:2: 7777777777777777777777777777777777777777: not a number");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_rows_of_as_many_numbers_as_names_are_a_motion);
    RUN_TEST(test_another_table_is_no_motion);
    RUN_TEST(test_a_faulty_row_is_named);
    RUN_TEST(test_fewer_than_two_rows_are_refused);
    RUN_TEST(test_a_word_of_any_length_is_refused_in_one_line);
    return UNITY_END();
}
