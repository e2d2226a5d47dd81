/// The scene that the viewer plays back: what is refused, in which words.
#include "recording.h"

#include <string.h>
#include <unity.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void refuse(const char *bytes, size_t size, const char *why)
{
    himc_error error = {""};
    TEST_ASSERT_FALSE(recording_check(bytes, size, "s.himc", &error));
    TEST_ASSERT_EQUAL_STRING(why, error.text);
}

static void test_whole_chunks_of_any_kind_are_a_scene(void)
{
    himc_error error = {""};
    const char bytes[] = "himcscn\001json\003\0\0\0abcnew \0\0\0";
    TEST_ASSERT_TRUE_MESSAGE(recording_check(bytes, sizeof bytes, "s.himc", &error), error.text);
}

static void test_another_file_is_no_scene(void)
{
    const char *why = "s.himc: not a scene (himc render --scene makes one)";
    refuse("", 0, why);
    refuse("himcscn", 7, why);
    refuse("time_s,a\n0,1\n", 13, why);
}

static void test_a_later_version_is_refused(void)
{
    refuse("himcscn\002json\0\0\0", 16, "s.himc: version 2 of scenes, this viewer reads 1");
}

static void test_a_chunk_that_is_cut_short_is_named(void)
{
    refuse("himcscn\001json\003\0\0\0ab", 18, "s.himc: cut short at byte 8 of 18");
    refuse("himcscn\001json\0\0\0\0jso", 19, "s.himc: cut short at byte 16 of 19");
    refuse("himcscn\001json\377\377\377\377", 16, "s.himc: cut short at byte 8 of 16");
    refuse("himcscn\001", 8, "s.himc: a scene without anything in it");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_whole_chunks_of_any_kind_are_a_scene);
    RUN_TEST(test_another_file_is_no_scene);
    RUN_TEST(test_a_later_version_is_refused);
    RUN_TEST(test_a_chunk_that_is_cut_short_is_named);
    return UNITY_END();
}
