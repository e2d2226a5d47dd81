// One line of text stays one, whatever names, files and packets bring into it.
#include "base/line.h"

#include "capture/player.h"
#include "performance/performance_events.h"
#include "plan/planner_state.h"
#include "himc/performance.h"

#include "unity.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static const char *cleaned(const char *text)
{
    static himc_error error;
    himc_error_set(&error, "%s", text);
    return error.text;
}

static void test_text_of_musicians_stays(void)
{
    static const char *const good[] = {"",
                                       "Fränzchens große Pauke",
                                       "Dvořák, Čajkovskij, Чайковский",
                                       "ティンパニ 定音鼓 팀파니",
                                       "\U0001D11E \U0001F941 \U0010FFFF",
                                       "~ \u00A0 \uD7FF \uE000 \uFFFD"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        TEST_ASSERT_EQUAL_STRING(good[i], cleaned(good[i]));
}

static void test_control_characters_become_question_marks(void)
{
    TEST_ASSERT_EQUAL_STRING("?[31mred?a?b?c?d?", cleaned("\x1B[31mred\na\rb\tc\x7F"
                                                          "d\x01"));
    TEST_ASSERT_EQUAL_STRING("a?b?c?d", cleaned("a\xC2\x80"
                                                "b\xC2\x9B"
                                                "c\xC2\x9F"
                                                "d")); // C1
    TEST_ASSERT_EQUAL_STRING("a?b?c", cleaned("a\u2028b\u2029c"));
    TEST_ASSERT_EQUAL_STRING("a?b?c?d?e", cleaned("a\u202Ab\u202Ec\u2066d\u2069e"));
}

static void test_bytes_that_are_not_utf8_become_question_marks(void)
{
    static const struct {
        const char *in, *out;
    } bad[] = {{"a\x9B"
                "31mb",
                "a?31mb"}, // C1 in Latin-1
               {"\xFC"
                "ber",
                "?ber"}, // Latin-1
               {"a\xC0\x8A"
                "b",
                "a??b"}, // a newline in two bytes
               {"a\xE0\x80\x8A"
                "b",
                "a???b"}, // in three
               {"a\xF0\x80\x80\x8A"
                "b",
                "a????b"}, // in four
               {"a\xC1\xBF"
                "b\xE0\x9F\xBF"
                "c",
                "a??b???c"},
               {"\xED\xA0\x80", "???"},      // a surrogate
               {"\xF4\x90\x80\x80", "????"}, // above the last character
               {"\xF8\x88\x80\x80\x80", "?????"},
               {"\xFE\xFF", "??"},
               {"a\xC3", "a?"}, // cut off
               {"a\xE2\x82", "a??"},
               {"a\xF0\x9F\xA5", "a???"},
               {"\xC3\n", "??"},
               {"\xE2\x82\x1B", "???"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        TEST_ASSERT_EQUAL_STRING(bad[i].out, cleaned(bad[i].in));
}

// each pair of bytes between two letters: the letters stay, and nothing in between is a control
static void test_no_two_bytes_make_a_control_character(void)
{
    for (int a = 1; a < 256; a++)
        for (int b = 1; b < 256; b++) {
            char text[8];
            snprintf(text, sizeof text, "<%c%c>", a, b);
            const unsigned char *out = (const unsigned char *)cleaned(text);
            size_t n = strlen((const char *)out);
            if (a == 0xC2 && b >= 0x80 && b < 0xA0) {
                TEST_ASSERT_EQUAL_STRING("<?>", (const char *)out);
                continue;
            }
            TEST_ASSERT_TRUE(n == 4 && out[0] == '<' && out[3] == '>');
            bool pair = out[1] >= 0xC2 && out[1] < 0xE0;
            uint32_t code = (out[1] & 0x1Fu) << 6 | (out[2] & 0x3Fu);
            TEST_ASSERT_TRUE(pair ? out[2] >> 6 == 2 && code >= 0xA0
                                  : out[1] >= ' ' && out[1] < 0x7F && out[2] >= ' ' &&
                                        out[2] < 0x7F);
        }
}

static void test_a_character_cut_at_the_end_of_the_line_is_none(void)
{
    himc_error error;
    char text[2 * sizeof error.text] = "";
    for (size_t i = 0; i + 2 < sizeof text; i += 2)
        memcpy(text + i, "ü", 3);
    himc_error_set(&error, "%s", text); // 511 bytes: the last character is cut in two
    TEST_ASSERT_EQUAL_UINT(sizeof error.text - 1, strlen(error.text));
    TEST_ASSERT_EQUAL_INT('?', error.text[sizeof error.text - 2]);
    himc_error_set(&error, "%.508s", text);
    himc_error_prefix(&error, "ab");
    TEST_ASSERT_EQUAL_STRING_LEN("ab: üü", error.text, 8);
    TEST_ASSERT_EQUAL_INT('?', error.text[strlen(error.text) - 1]);
}

static void test_a_prefix_is_cleaned_too(void)
{
    himc_error error;
    himc_error_set(&error, "why");
    himc_error_prefix(&error, "%s:%d", "bad\n\x1B.txt", 3);
    TEST_ASSERT_EQUAL_STRING("bad??.txt:3: why", error.text);
}

static void test_no_command_brings_a_second_line(void)
{
    static const char *const bad[] = {"push \\\n\x1B[2J 1 2 3 1",
                                      "score \\\nnowhere.txt",
                                      "take nowhere\x1B[31m.bvh",
                                      "gain \\\n 1 2",
                                      "strength \\\n 1",
                                      "tempo 1;\x1B[2J\ntempo 2",
                                      "\x1B[2J\\\n",
                                      "record \\\n.bvh/x.bvh"};
    himc_error error;
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        himc_command command;
        TEST_ASSERT_FALSE_MESSAGE(
            himc_command_parse_text(&command, HIMC_PERFORMER, bad[i], &error) &&
                himc_performance_command(p, &command, 0, &error),
            bad[i]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strchr(error.text, '?'), error.text);
        for (const char *s = error.text; *s; s++)
            TEST_ASSERT_TRUE_MESSAGE((unsigned char)*s >= ' ', error.text);
    }
    himc_performance_free(p);
}

static void keep(void *user, const char *line)
{
    *(himc_word *)user = (himc_word){""};
    snprintf(((himc_word *)user)->text, sizeof(himc_word), "%s", line);
}

// `himc info`, notes of takes, players, planner and performer
static void test_lines_about_files_are_cleaned_too(void)
{
    himc_word heard;
    himc_event event;
    static himc_planner planner;
    himc_planner_note said;
    performance_events events = {.count = 0};
    himc_player player = {.note_count = 0};
    himc_tell(&(himc_line_sink){keep, &heard}, "tip %s", "\x1B[31m");
    TEST_ASSERT_EQUAL_STRING("tip ?[31m", heard.text);
    himc_events_note(&events, "%s", "a\nb");
    TEST_ASSERT_TRUE(himc_events_take(&events, &event));
    TEST_ASSERT_EQUAL_STRING("a?b", event.text);
    himc_planner_say(&planner, PLANNER_GIVEN_UP, "%s", "a\nb");
    TEST_ASSERT_TRUE(himc_planner_note_next(&planner, &said));
    TEST_ASSERT_EQUAL_STRING("a?b", said.text);
    himc_player_note(&player, "%s", "a\nb");
    TEST_ASSERT_EQUAL_STRING("a?b", player.notes[0]);
}

static void test_a_drum_has_a_name_of_plain_characters(void)
{
    static const char *const bad[] = {"a\xC2\x9B"
                                      "b",
                                      "a\xFC"
                                      "b",
                                      "a\u202E"
                                      "b",
                                      "a\x1B"
                                      "b"};
    himc_error error;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        TEST_ASSERT_NULL_MESSAGE(himc_drum_new(bad[i], 23, 48000, &error), bad[i]);
    himc_drum *drum = himc_drum_new("große-Pauke", 23, 48000, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(drum, error.text);
    himc_drum_release(drum);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_text_of_musicians_stays);
    RUN_TEST(test_control_characters_become_question_marks);
    RUN_TEST(test_bytes_that_are_not_utf8_become_question_marks);
    RUN_TEST(test_no_two_bytes_make_a_control_character);
    RUN_TEST(test_a_character_cut_at_the_end_of_the_line_is_none);
    RUN_TEST(test_a_prefix_is_cleaned_too);
    RUN_TEST(test_no_command_brings_a_second_line);
    RUN_TEST(test_lines_about_files_are_cleaned_too);
    RUN_TEST(test_a_drum_has_a_name_of_plain_characters);
    return UNITY_END();
}
