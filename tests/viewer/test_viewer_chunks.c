/// What himc-viewer takes from the chunks of `himc edit`.
#include "chunks.h"

#include <stdio.h>
#include <string.h>
#include <unity.h>

#define FAILED "{\"event\":\"failed\",\"text\":\"pcm a.txt:1: pcm \"}"

static unsigned char bytes[8192];
static size_t size;

void setUp(void)
{
    size = 0;
}

void tearDown(void)
{
}

static void put(const char *kind, const char *text)
{
    size_t length = strlen(text);
    memcpy(bytes + size, kind, 4);
    for (int i = 0; i < 4; i++)
        bytes[size + 4 + (size_t)i] = (unsigned char)(length >> 8 * i);
    memcpy(bytes + size + 8, text, length);
    size += 8 + length;
}

// in parts of that size
static chunks follow(size_t part)
{
    chunks c = {.left = 0};
    for (size_t at = 0; at < size; at += part)
        chunks_follow(&c, bytes + at, size - at < part ? size - at : part);
    return c;
}

static void test_letters_of_a_name_are_no_sound(void)
{
    put("edit", FAILED);
    put("file", "pcm .txt and pcm \1\0\0\0");
    for (size_t part = 1; part <= size; part++) {
        chunks c = follow(part);
        TEST_ASSERT_FALSE(c.sounds);
        TEST_ASSERT_EQUAL_STRING(FAILED, c.failed);
    }
}

static void test_a_sound_is_known_by_its_head_however_it_is_cut(void)
{
    put("over", "");
    put("edit", "{\"event\":\"text\"}");
    put("pcm ", "x");
    for (size_t part = 1; part <= size; part++) {
        chunks c = follow(part);
        TEST_ASSERT_TRUE(c.sounds);
        TEST_ASSERT_EQUAL_STRING("", c.failed);
    }
}

static void test_the_last_failure_counts_and_a_long_event_is_no_failure(void)
{
    char text[3 * CHUNKS_EVENT];
    put("edit", FAILED);
    // its tail looks like a failure
    memset(text, ' ', sizeof text);
    strcpy(text + sizeof text - sizeof FAILED, FAILED);
    put("edit", text);
    put("json", FAILED "!");
    for (size_t part = 1; part <= size; part++)
        TEST_ASSERT_EQUAL_STRING(FAILED, follow(part).failed);
    put("edit", "{\"event\":\"failed\"}");
    TEST_ASSERT_EQUAL_STRING("{\"event\":\"failed\"}", follow(7).failed);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_letters_of_a_name_are_no_sound);
    RUN_TEST(test_a_sound_is_known_by_its_head_however_it_is_cut);
    RUN_TEST(test_the_last_failure_counts_and_a_long_event_is_no_failure);
    return UNITY_END();
}
