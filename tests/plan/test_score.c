/// Score files.
#include "unity.h"

#include "plan/score.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static himc_error error;

void setUp(void)
{
    error.text[0] = '\0';
}

void tearDown(void)
{
}

static himc_score *parse(const char *text)
{
    return himc_score_parse(text, "s.txt", NULL, &error);
}

static void refused(const char *text, const char *expected)
{
    TEST_ASSERT_NULL(parse(text));
    TEST_ASSERT_EQUAL_STRING(expected, error.text);
}

static void test_score_sorts_strokes_and_keeps_other_lines_in_order(void)
{
    himc_score *s =
        parse("comment a; b 1 2;\ndrum kettle 26;\nkettle tune 110;\nkettle place 0.7 0 0.85;\n"
              "b2 tune 120;");
    TEST_ASSERT_NULL(s); // "b 1 2" is no command
    s = parse("comment anything (at) all;\ndrum kettle 26;\nkettle tune 110;\n"
              "stroke 3 left legato f;\nstroke 1\n  right accent p rim kettle;\nmode himc;\n"
              "tempo 120; tempo 60 2;\nstroke 1 left tenuto mf");
    TEST_ASSERT_NOT_NULL_MESSAGE(s, error.text);
    TEST_ASSERT_EQUAL_INT(3, s->stroke_count);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, s->strokes[0].hand); // stable among equal beats
    TEST_ASSERT_EQUAL_INT(HIMC_LEFT, s->strokes[1].hand);
    TEST_ASSERT_EQUAL_DOUBLE(3, s->strokes[2].beat);
    TEST_ASSERT_EQUAL_INT(2, s->tempo_count);
    TEST_ASSERT_EQUAL_DOUBLE(120, s->tempi[0].bpm);
    TEST_ASSERT_EQUAL_INT(3, s->line_count);
    TEST_ASSERT_EQUAL_STRING("kettle", s->lines[1].drum);
    TEST_ASSERT_EQUAL_INT(HIMC_COMMAND_TUNE, s->lines[1].command.id);
    TEST_ASSERT_EQUAL_INT(3, s->lines[1].line);
    TEST_ASSERT_EQUAL_STRING("kettle", s->lines[0].command.atom[0].symbol);
    TEST_ASSERT_EQUAL_INT(7, s->lines[2].line);
    himc_score_free(s);
}

// lines and tempi are copied to more room as they come: each keeps its atoms
static void test_a_score_of_many_lines_keeps_each_and_sorts_its_tempi(void)
{
    char text[4000] = "", name[16];
    for (int i = 0; i < 70; i++)
        sprintf(text + strlen(text), "drum d%d 2%d;\n tempo %d %d;\n", i, i % 10, 60 + i, 70 - i);
    himc_score *s = parse(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(s, error.text);
    TEST_ASSERT_EQUAL_INT(70, s->line_count);
    TEST_ASSERT_EQUAL_INT(71, s->tempo_count); // and the default at 0
    for (int i = 0; i < 70; i++) {
        sprintf(name, "d%d", i);
        TEST_ASSERT_EQUAL_STRING(name, s->lines[i].command.atom[0].symbol);
        TEST_ASSERT_EQUAL_DOUBLE(20 + i % 10, s->lines[i].command.atom[1].number);
        TEST_ASSERT_EQUAL_INT(1 + 2 * i, s->lines[i].line);
        TEST_ASSERT_EQUAL_DOUBLE(1 + i, s->tempi[1 + i].beat);
        TEST_ASSERT_EQUAL_DOUBLE(129 - i, s->tempi[1 + i].bpm);
    }
    himc_score_free(s);
}

static void test_changes_of_heads_are_sorted_by_beat_and_keep_their_lines(void)
{
    char text[4000] = "drum low;\n";
    for (int i = 0; i < 40; i++) // 20 .. 1, 20 .. 1
        sprintf(text + strlen(text), "at %d low tension %d;\n", 20 - i % 20, 1000 + i);
    himc_score *s = parse(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(s, error.text);
    TEST_ASSERT_EQUAL_INT(1, s->line_count);
    TEST_ASSERT_EQUAL_INT(40, s->change_count);
    for (int i = 0; i < 40; i++) {
        int written = 19 - i / 2 + 20 * (i % 2);
        TEST_ASSERT_EQUAL_DOUBLE(1 + i / 2, s->changes[i].beat);
        TEST_ASSERT_EQUAL_STRING("low", s->changes[i].drum);
        TEST_ASSERT_EQUAL_DOUBLE(1000 + written, s->changes[i].command.atom[0].number);
        TEST_ASSERT_EQUAL_INT(2 + written, s->changes[i].line);
    }
    himc_score_free(s);
}

static void test_strokes_and_changes_have_their_order_in_the_file(void)
{
    static const double beat[] = {5, 4, 3, 3, 2, 1, 2, 6};
    himc_score *s = parse("drum low; drum high; stroke 5 left legato f;\nat 4 low damp 1;\n"
                          "stroke 3 right accent p; at 3 high tune C3; tempo 90;\n"
                          "at 2 low tune D3; stroke 1 left legato f; at 2 low damp 0;\n"
                          "at 6 push head 1 2 3 0.1;");
    TEST_ASSERT_NOT_NULL_MESSAGE(s, error.text);
    TEST_ASSERT_EQUAL_INT(8, s->stroke_count + s->change_count);
    for (int i = 0; i < 8; i++) {
        int at = s->order[i];
        TEST_ASSERT_EQUAL_DOUBLE(beat[i], at < 0 ? s->changes[-1 - at].beat : s->strokes[at].beat);
        TEST_ASSERT_EQUAL_INT(i != 0 && i != 2 && i != 5, at < 0);
    }
    himc_score_free(s);
}

static void test_a_command_that_a_comment_without_its_end_takes_with_it_is_reported(void)
{
    himc_score *s = parse("comment Overture\n\n  stroke 1 left legato f;\n"
                          "comment of two\nlines, play it at 3;\ncomment a\ncomment b\n"
                          "low tune A2;\nstroke 2 left legato f;\ncomment the end");
    TEST_ASSERT_NOT_NULL_MESSAGE(s, error.text);
    TEST_ASSERT_EQUAL_INT(1, s->stroke_count);
    TEST_ASSERT_EQUAL_STRING(
        "s.txt:3: \"stroke 1 left legato f\" is left out: no ; ends the comment before it, in line "
        "1\ns.txt:8: \"low tune A2\" is left out: no ; ends the comment before it, in line 6\n",
        s->report);
    TEST_ASSERT_EQUAL_INT(2, s->left_out);
    himc_score_free(s);
}

static void test_empty_score_has_the_default_tempo(void)
{
    himc_score *s = parse("");
    TEST_ASSERT_NOT_NULL(s);
    TEST_ASSERT_EQUAL_INT(0, s->stroke_count);
    TEST_ASSERT_EQUAL_DOUBLE(100, s->tempi[0].bpm);
    himc_score_free(s);
}

static void test_errors_name_file_and_line(void)
{
    refused(
        "play;\nstroke 1 left legatto f;",
        "s.txt:2: stroke: NUANCE: legatto, expected legato tenuto accent vertical-accent staccato");
    refused("kettle tun 110;", "s.txt:1: kettle: tun: unknown command, did you mean tune?");
    refused("kettle play;", "s.txt:1: kettle: play: a command for the performer, not for a drum");
    refused(
        "tune 110;",
        "s.txt:1: tune: a command for a drum, not for the performer: its name comes before it (`kettle tune`)");
    refused(
        "tune A2;",
        "s.txt:1: tune: a command for a drum, not for the performer: its name comes before it (`kettle tune`)");
    refused("kettle tune;", "s.txt:1: kettle: tune: HZ missing, expected tune HZ | NOTE");
    refused("drum kettle 26;\ndrum kettle;\ndrum kettle 32;",
            "s.txt:3: drum: kettle is made with 26 inches on line 1 already");
    refused("drum kettle;\n\nkettle radius 0;",
            "s.txt:3: kettle: radius: RADIUS: 0, expected 0.05 .. 1 m");
    refused("play;\n# loud\nstroke 1 left legato f;",
            "s.txt:2: #: a comment is written comment ...;");
    refused("//loud: f;", "s.txt:1: //loud:: a comment is written comment ...;");
    refused("play;\ntempo 90\nstroke 1 left legato f;",
            "s.txt:2: tempo 90: a ; is missing, before \"stroke\"");
    refused("drum low;\ntempo 90\nlow tune A2;",
            "s.txt:2: tempo 90: a ; is missing, before \"low\"");
    refused("score other.txt;", "s.txt:1: score: not allowed in a score");
    refused(
        "stroke 1 left legato f;\nstroke 1.01 left legato f;",
        "s.txt:2: stroke: BEAT: 1.01 is 0.006 s after the last stroke of the left hand, expected "
        "0.04 s or more");
    TEST_ASSERT_NULL(parse("\nstrok 1 left legato f;"));
    TEST_ASSERT_NOT_NULL(
        strstr(error.text, "s.txt:2: strok: unknown command, did you mean stroke?"));
    TEST_ASSERT_NULL(parse("drum kettle; kettle tun 110;"));
    TEST_ASSERT_NOT_NULL(
        strstr(error.text, "s.txt:1: kettle: tun: unknown command, did you mean tune?"));
    TEST_ASSERT_NULL(himc_score_load("/no/such/file.txt", &error));
    TEST_ASSERT_EQUAL_STRING("/no/such/file.txt: cannot be read: No such file or directory",
                             error.text);
    TEST_ASSERT_NULL(himc_score_load("tests", &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "tests: "));
    TEST_ASSERT_NULL(himc_score_load("/proc/self/environ", &error)); // zeros among its letters
    TEST_ASSERT_EQUAL_STRING(
        "/proc/self/environ: not a text file; expected a score, MIDI, MusicXML or a take",
        error.text);
}

// room for a path and 256 characters more; a word that long once ended the program
static void test_a_statement_of_more_than_1280_characters_is_refused_in_one_line(void)
{
    char text[3000];
    for (int length = 1279; length < 2900; length = length < 1290 ? length + 1 : length + 97) {
        memset(text, 'x', (size_t)length);
        text[length] = '\0';
        TEST_ASSERT_NULL(parse(text));
        TEST_ASSERT_NULL(strchr(error.text, '\n'));
        if (length > 1279) {
            TEST_ASSERT_EQUAL_STRING(
                "s.txt:1: more than 1280 characters without a ;, expected a score, commands "
                "that each end with one",
                error.text);
        }
    }
    for (size_t i = 0; i + 2 < sizeof text; i += 2) // words enough
        memcpy(text + i, "\nx", 3);
    refused(text, "s.txt:2: more than 1280 characters without a ;, expected a score, commands "
                  "that each end with one");
}

static void test_a_byte_order_mark_is_skipped(void)
{
    himc_score *s = parse("\xEF\xBB\xBFtempo 90;\nstroke 1 left legato mf;");
    TEST_ASSERT_NOT_NULL_MESSAGE(s, error.text);
    TEST_ASSERT_EQUAL_DOUBLE(90, s->tempi[0].bpm);
    TEST_ASSERT_EQUAL_INT(1, s->stroke_count);
    himc_score_free(s);
}

static void test_seconds_and_beat_are_inverse_through_tempo_changes(void)
{
    himc_tempo_change map[] = {{0, 120}, {4, 60}, {8, 180}};
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2, himc_score_seconds(map, 3, 4));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 6, himc_score_seconds(map, 3, 8));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 7, himc_score_seconds(map, 3, 11));
    for (double beat = -3; beat < 20; beat += 0.37)
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, beat,
                                  himc_score_beat(map, 3, himc_score_seconds(map, 3, beat)));
}

static char *long_score(int strokes)
{
    char *text = malloc((size_t)strokes * 48 + 1), *s = text;
    for (int i = 0; i < strokes; i++)
        s += sprintf(s, "stroke %d %s legato mf normal;\n", i / 2, i & 1 ? "left" : "right");
    return text;
}

static void test_long_scores_are_read_and_too_long_ones_refused(void)
{
    char *text = long_score(4000);
    himc_score *s = parse(text);
    TEST_ASSERT_NOT_NULL(s);
    TEST_ASSERT_EQUAL_INT(4000, s->stroke_count);
    himc_score_free(s);
    free(text);
    text = long_score(200001);
    refused(text, "s.txt:200001: stroke: one too many, expected 200000 strokes");
    free(text);
}

static void test_more_than_10000_lines_or_tempi_are_refused(void)
{
    char *text = malloc(10001 * 24), *s = text;
    for (int i = 0; i < 10001; i++)
        s += sprintf(s, "grip french;\n");
    refused(text, "s.txt:10001: one line too many, expected 10000 besides strokes");
    s = text;
    for (int i = 0; i < 10001; i++)
        s += sprintf(s, "tempo 90 %d;\n", i);
    refused(text, "s.txt:10001: tempo: one too many, expected 10000");
    free(text);
}

static void test_random_text_never_breaks_the_reader(void)
{
    static const char alphabet[] = "stroke left legato f drum tune 0123456789 .-e;;\n\\ #,";
    char text[400];
    unsigned seed = 7;
    for (int k = 0; k < 20000; k++) {
        size_t n = (seed = seed * 1664525u + 1013904223u) >> 24;
        for (size_t i = 0; i < n; i++)
            text[i] =
                alphabet[((seed = seed * 1664525u + 1013904223u) >> 10) % (sizeof alphabet - 1)];
        text[n] = '\0';
        error.text[0] = '\0';
        himc_score *s = parse(text);
        TEST_ASSERT_TRUE(s || (strncmp(error.text, "s.txt:", 6) == 0 && !strchr(error.text, '\n')));
        himc_score_free(s);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_score_sorts_strokes_and_keeps_other_lines_in_order);
    RUN_TEST(test_a_score_of_many_lines_keeps_each_and_sorts_its_tempi);
    RUN_TEST(test_changes_of_heads_are_sorted_by_beat_and_keep_their_lines);
    RUN_TEST(test_strokes_and_changes_have_their_order_in_the_file);
    RUN_TEST(test_a_command_that_a_comment_without_its_end_takes_with_it_is_reported);
    RUN_TEST(test_empty_score_has_the_default_tempo);
    RUN_TEST(test_errors_name_file_and_line);
    RUN_TEST(test_a_statement_of_more_than_1280_characters_is_refused_in_one_line);
    RUN_TEST(test_a_byte_order_mark_is_skipped);
    RUN_TEST(test_seconds_and_beat_are_inverse_through_tempo_changes);
    RUN_TEST(test_long_scores_are_read_and_too_long_ones_refused);
    RUN_TEST(test_more_than_10000_lines_or_tempi_are_refused);
    RUN_TEST(test_random_text_never_breaks_the_reader);
    return UNITY_END();
}
