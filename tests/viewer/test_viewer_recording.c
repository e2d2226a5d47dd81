/// The scene that the viewer plays back: what is refused, in which words.
#include "recording.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>
#include <zlib.h>

#define MIB ((size_t)1 << 20)

/// A scene that is being made.
static char made[2 * 1048576];
static size_t used;

void setUp(void)
{
    memcpy(made, "himcscn\001", used = 8);
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

static void put_number(void *to, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        ((unsigned char *)to)[i] = (unsigned char)(value >> 8 * i);
}

// a chunk of these bytes, packed
static void put(const char *kind, const void *bytes, size_t size)
{
    uLongf room = sizeof made - used - 8;
    TEST_ASSERT_EQUAL(Z_OK, compress2((Bytef *)made + used + 8, &room, bytes, size, 1));
    memcpy(made + used, kind, 4);
    put_number(made + used + 4, (uint32_t)room);
    used += 8 + room;
}

// rows that say to be so many, and have so many bytes
static void put_rows(uint32_t rows, size_t bytes)
{
    unsigned char *data = calloc(1, 20 + bytes);
    put_number(data + 16, rows);
    put("rows", data, 20 + bytes);
    free(data);
}

static void accept(void)
{
    himc_error error = {""};
    TEST_ASSERT_TRUE_MESSAGE(recording_check(made, used, "s.himc", &error), error.text);
}

static const char too_many[] =
    "s.himc: more than 8388608 rows, frames of heads and values of events";

static void test_rows_have_columns_and_these_their_bytes(void)
{
    put_rows(100, 100 * 4 * 3);
    size_t good = used;
    put_rows(7, 7 * 4 * 3);
    put_rows(0, 0);
    accept();
    static const uint32_t wrong[][2] = {{100, 0}, {100, 4 * 3 * 100 + 4}, {7, 7 * 4 * 2}, {0, 12}};
    for (int i = 0; i < 4; i++) {
        used = good;
        put_rows(wrong[i][0], wrong[i][1]);
        char why[80];
        snprintf(why, sizeof why, "s.himc: faulty rows at byte %zu", good);
        refuse(made, used, why);
    }
}

static void test_a_count_is_no_allocation(void)
{
    put_rows(0xffffffff, 0);
    refuse(made, used, too_many);
    setUp();
    put("ring", "\377\377\377\377", 4);
    refuse(made, used, too_many);
    setUp();
    put("ring", "\002\0\0\0abcdefghijklmn\002\0abcd", 24);
    refuse(made, used, "s.himc: faulty motion of heads at byte 8");
    setUp();
    put("ring", "\001\0\0\0abcdefghijkl\001\0\002\0abcd", 24);
    accept();
}

// one budget for all chunks, those of a scene within the scene included
static void test_rows_events_and_heads_have_one_budget(void)
{
    const size_t half = 4 * MIB;
    put_rows((uint32_t)half, 4 * half);
    put_rows((uint32_t)half, 4 * half);
    accept();
    size_t good = used;
    put("json", "[]", 2);
    refuse(made, used, too_many);
    used = good;
    put_rows(1, 4);
    refuse(made, used, too_many);
    // the second half within a scene
    setUp();
    put_rows((uint32_t)half, 4 * half);
    size_t outer = used;
    memcpy(made + used + 8, "himcscn\001", 8);
    used += 16;
    put_rows((uint32_t)half, 4 * half);
    memcpy(made + outer, "more", 4);
    put_number(made + outer + 4, (uint32_t)(used - outer - 8));
    accept();
    put_rows(1, 4);
    refuse(made, used, too_many);
}

// a list of `count` values, each this text
static void put_values(const char *text, size_t count)
{
    size_t one = strlen(text);
    char *json = malloc(count * one + 1);
    for (size_t i = 0; i < count; i++)
        memcpy(json + i * one, text, one);
    json[0] = '[';
    put("json", json, count * one);
    free(json);
}

static void test_values_count_wherever_they_stand_but_in_texts(void)
{
    static const char *const values[] = {",1", "[[", ",[", "{}", ",{}"};
    for (int i = 0; i < 5; i++) {
        setUp();
        put_values(values[i], 9 * MIB);
        refuse(made, used, too_many);
        setUp();
        put_values(values[i], 2 * MIB);
        accept();
    }
    setUp();
    char *text = malloc(20 * MIB);
    memset(text, ',', 20 * MIB);
    memcpy(text, "[\"a\\\"", 5);
    memcpy(text + 20 * MIB - 2, "\"]", 2);
    put("json", text, 20 * MIB);
    accept();
    free(text);
}

static void test_a_chunk_that_unpacks_without_end_is_refused(void)
{
    char *zeros = calloc(65, MIB);
    put("json", zeros, 64 * MIB);
    accept();
    setUp();
    put("json", zeros, 64 * MIB + 1);
    refuse(made, used,
           "s.himc: the chunk at byte 8 unpacks to more than 64 MiB, or all to more than 4 GiB");
    setUp();
    put("rows", zeros, 30);
    put_number(made + 12, (uint32_t)used - 16 - 1); // cut short
    refuse(made, used - 1, "s.himc: faulty chunk at byte 8");
    free(zeros);
}

static void test_whole_chunks_of_any_kind_are_a_scene(void)
{
    himc_error error = {""};
    const char bytes[] = "himcscn\001old \003\0\0\0abcnew \0\0\0";
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
    refuse("himcscn\001none\0\0\0\0jso", 19, "s.himc: cut short at byte 16 of 19");
    refuse("himcscn\001json\377\377\377\377", 16, "s.himc: cut short at byte 8 of 16");
    refuse("himcscn\001", 8, "s.himc: a scene without anything in it");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_whole_chunks_of_any_kind_are_a_scene);
    RUN_TEST(test_rows_have_columns_and_these_their_bytes);
    RUN_TEST(test_a_count_is_no_allocation);
    RUN_TEST(test_rows_events_and_heads_have_one_budget);
    RUN_TEST(test_values_count_wherever_they_stand_but_in_texts);
    RUN_TEST(test_a_chunk_that_unpacks_without_end_is_refused);
    RUN_TEST(test_another_file_is_no_scene);
    RUN_TEST(test_a_later_version_is_refused);
    RUN_TEST(test_a_chunk_that_is_cut_short_is_named);
    return UNITY_END();
}
