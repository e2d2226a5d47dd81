/// Export: a score as MusicXML and as MIDI, read back, is the same music.
#define _XOPEN_SOURCE 700
#include "unity.h"

#include "musicxml/export.h"
#include "musicxml/import.h"
#include "plan/score.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST 1000

static himc_error error;
static himc_score *score;
static midi_file notes;
static himc_text_lines text;

/// All strokes that were read back, of every part, on the beats of the original.
static himc_stroke back[MOST];
static bool matched[MOST];
static int count;

void setUp(void)
{
    error.text[0] = '\0';
    count = 0;
}

void tearDown(void)
{
    himc_score_free(score);
    himc_midi_file_free(&notes);
    free(text.bytes);
    score = NULL;
    text = (himc_text_lines){0};
}

static void load(const char *path)
{
    score = himc_score_load(path, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, false, &error), error.text);
}

static void parse(const char *words)
{
    score = himc_score_parse(words, "words", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_music_notes(&notes, score, false, &error), error.text);
    TEST_ASSERT_TRUE(himc_music_write(&text, &notes, "words"));
}

static void read_part(himc_score_maker *make, midi_choice choice)
{
    midi_score made;
    midi_options options = {.choice = choice};
    double lead = 0;
    if (!make(&made, text.bytes, text.size, "back", &options, &error))
        return;
    himc_score *part = himc_score_parse(made.text, "back", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(part, error.text);
    sscanf(strstr(made.text, "beat 0 of the file"), "beat 0 of the file is beat %lf", &lead);
    for (int i = 0; i < part->stroke_count && count < MOST; i++) {
        back[count] = part->strokes[i];
        matched[count] = false;
        back[count++].beat -= lead;
    }
    himc_score_free(part);
    himc_midi_score_free(&made);
}

static void read_back(himc_score_maker *make)
{
    for (midi_choice c = MIDI_TIMPANI; c < MIDI_CHOICES; c++)
        read_part(make, c);
}

static bool is_same(const himc_stroke *a, const himc_stroke *b)
{
    bool roll = a->ornament >= HIMC_ROLL_SINGLE;
    if (fabs(a->beat - b->beat) > 2e-3 || roll != (b->ornament >= HIMC_ROLL_SINGLE))
        return false;
    if (roll)
        return fabs(a->length - b->length) < 2e-3 && fabs(a->dynamic - b->dynamic) < 0.08 &&
               fabs(a->last_dynamic - b->last_dynamic) < 0.08;
    return a->hand == b->hand && a->nuance == b->nuance && a->ornament == b->ornament &&
           fabs(a->dynamic - b->dynamic) < 0.02 && strcmp(a->part, b->part) == 0;
}

// each stroke has its like among those that were read
static void expect_same(const char *name)
{
    char which[200];
    TEST_ASSERT_EQUAL_MESSAGE(score->stroke_count, count, name);
    for (int i = 0; i < score->stroke_count; i++) {
        bool found = false;
        for (int k = 0; k < count && !found; k++)
            if (!matched[k] && is_same(&score->strokes[i], &back[k]))
                found = matched[k] = true;
        snprintf(which, sizeof which, "%s: stroke at beat %g", name, score->strokes[i].beat);
        TEST_ASSERT_TRUE_MESSAGE(found, which);
    }
}

static void test_the_pieces_are_the_same_after_musicxml(void)
{
    static const char *const pieces[] = {"patches/improvisation.txt",
                                         "patches/pieces/tide.txt",
                                         "patches/pieces/kit.txt",
                                         "patches/pieces/grain.txt",
                                         "patches/pieces/zarathustra.mid",
                                         "tests/midi/scherzo.mid",
                                         "tests/midi/pedals.mid",
                                         "tests/midi/groove.mid",
                                         "tests/midi/roll.mid",
                                         "tests/fuzz/corpus/musicxml/signs",
                                         "tests/fuzz/corpus/musicxml/order"};
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; i++) {
        load(pieces[i]);
        TEST_ASSERT_TRUE(himc_music_write(&text, &notes, "piece"));
        read_back(himc_music_import);
        expect_same(pieces[i]);
        tearDown();
        setUp();
    }
}

// parts that one player has at once are parts of their own there, with hands of their own
static void test_a_piece_for_many_instruments_keeps_its_strokes(void)
{
    load("patches/pieces/stations.txt");
    TEST_ASSERT_TRUE(himc_music_write(&text, &notes, "stations"));
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(score->stroke_count, count);
}

static void test_pedals_come_back_as_words(void)
{
    parse("drum low 32; low tune D2; drum second 29; second tune A2; tempo 60;"
          "stroke 0 right legato f low; stroke 1 left legato f second; at 4 low tune E2;"
          "stroke 8 right legato f low; at 9 second muffle 1; stroke 12 left legato f second;");
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>D muta in E</words>"));
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>coperto</words>"));
    midi_score made;
    TEST_ASSERT_TRUE(himc_music_import(&made, text.bytes, text.size, "back", NULL, &error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "low tune D2;"), made.text);
    const char *at = strstr(made.text, "low gliss E2 0.25;");
    TEST_ASSERT_NOT_NULL_MESSAGE(at, made.text);
    while (at > made.text && at[-1] != '\n')
        at--;
    // at beat 4 of the score, after a second of the file's own
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 5, atof(at + 3));
    himc_midi_score_free(&made);
}

static void test_ornaments_rolls_spots_and_dynamics_are_written(void)
{
    parse("drum kettle; tempo 100; flam 1 right accent ff; drag 2 left legato p center;"
          "ruff 3 right staccato mf rim; roll 4 6 single pp ff; stroke 10 left tenuto fff;");
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<wedge type=\"crescendo\"/>"));
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>near rim</words>"));
    read_back(himc_music_import);
    expect_same("ornaments");
    for (int i = 0; i < count; i++)
        if (back[i].beat < 3.5)
            TEST_ASSERT_EQUAL(score->strokes[i].spot, back[i].spot);
}

static void test_midi_keeps_times_pitches_and_dynamics(void)
{
    load("patches/pieces/grain.txt");
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    midi_file file;
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, text.bytes, text.size, &error), error.text);
    TEST_ASSERT_EQUAL(0, file.cut + file.missing);
    for (int i = 0; i < notes.note_count; i++) {
        bool found = false;
        for (int k = 0; k < file.note_count && !found; k++)
            found = file.notes[k].key == notes.notes[i].key &&
                    fabs(file.notes[k].seconds - notes.notes[i].seconds) < 1e-3 &&
                    fabs(himc_midi_dynamic(file.notes[k].velocity, 0) -
                         fmin(notes.notes[i].way.dynamic, 111 / 112.0)) < 0.01;
        TEST_ASSERT_TRUE(found);
    }
    himc_midi_file_free(&file);
}

static void test_midi_has_each_grace_note(void)
{
    score = himc_score_parse("drum kettle; flam 1 right legato f; drag 2 left legato f;"
                             "ruff 3 left legato f; stroke 4 right legato f;",
                             "words", NULL, &error);
    TEST_ASSERT_TRUE(himc_music_notes(&notes, score, false, &error));
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    midi_file file;
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, text.bytes, text.size, &error), error.text);
    TEST_ASSERT_EQUAL(4 + 1 + 2 + 3, file.note_count);
    himc_midi_file_free(&file);
}

static void test_a_roll_is_a_roll_after_midi(void)
{
    score = himc_score_parse("drum kettle; tempo 60; stroke 0 right legato f; roll 2 4 single p f;",
                             "words", NULL, &error);
    TEST_ASSERT_TRUE(himc_music_notes(&notes, score, false, &error));
    TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
    read_back(himc_midi_import);
    TEST_ASSERT_EQUAL(2, count);
    TEST_ASSERT_EQUAL(HIMC_ROLL_SINGLE, back[1].ornament);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 4, back[1].length);
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 5 / 7.0, back[1].last_dynamic);
}

static void test_hats_stay_closed_and_a_foot_s_stroke_stays_the_foot_s(void)
{
    static himc_score_maker *const make[] = {himc_music_import, himc_midi_import};
    parse("setup kit; stroke 1 left legato mf rim hats; stroke 2 foot legato f hats;");
    for (int i = 0; i < 2; i++) {
        midi_score made;
        midi_options options = {.choice = MIDI_DRUMS};
        if (i == 1) {
            free(text.bytes);
            text = (himc_text_lines){0};
            TEST_ASSERT_TRUE(himc_music_write_midi(&text, &notes));
        }
        TEST_ASSERT_TRUE_MESSAGE(make[i](&made, text.bytes, text.size, "back", &options, &error),
                                 error.text);
        TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "pedal 0"), made.text);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "foot legato"), made.text);
        himc_midi_score_free(&made);
    }
}

static void test_a_gliss_comes_back_as_a_gliss(void)
{
    static const char *const lines[] = {"at 4 low gliss E2 2;", "at 9 low gliss D2 1;",
                                        "at 9 second gliss B2 0.5;", "at 12 low gliss F2 1.5;"};
    parse("drum low 32; low tune D2; drum second 29; second tune A2; tempo 60;"
          "roll 4 4 single p f low; stroke 9 right legato f low; stroke 9 left legato f second;"
          "roll 12 2 single f low;"
          "at 4 low gliss E2 2; at 9 low gliss D2 1; at 9 second gliss B2 .5;"
          "at 12 low gliss F2 1.5;");
    TEST_ASSERT_NOT_NULL(strstr(text.bytes, "<words>gliss. D to E</words>"));
    midi_score made;
    TEST_ASSERT_TRUE(himc_music_import(&made, text.bytes, text.size, "back", NULL, &error));
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, lines[i]), made.text);
    TEST_ASSERT_NULL_MESSAGE(strstr(made.text, "damp"), made.text); // it is heard
    himc_midi_score_free(&made);
    read_back(himc_music_import);
    expect_same("gliss");
}

static void test_strokes_on_hoop_and_shell_come_back(void)
{
    parse(
        "setup kit; stroke 1 left legato mf crossstick snare; stroke 2 left legato mf rimshot snare;"
        "stroke 2.5 right legato mf snare; stroke 3 left legato mf click snare;"
        "stroke 4 right legato mf shell tom; stroke 4 foot legato mf kick;"
        "stroke 5 right legato f rimshot tom; stroke 6 left legato f snare;");
    TEST_ASSERT_NULL(notes.said);
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(score->stroke_count, count);
    for (int i = 0; i < count; i++) {
        bool found = false;
        for (int k = 0; k < count && !found; k++)
            found = is_same(&score->strokes[i], &back[k]) &&
                    strcmp(score->strokes[i].drum, back[k].drum) == 0 &&
                    score->strokes[i].spot == back[k].spot;
        TEST_ASSERT_TRUE(found);
    }
}

static void test_spots_without_a_key_are_told_and_come_back_normal(void)
{
    parse(
        "setup kit; stroke 1 left legato mf rim snare; stroke 2 left legato mf crossstick snare;"
        "stroke 3 left legato mf rimshot tom; drum kettle; stroke 5 left legato mf click kettle;");
    TEST_ASSERT_EQUAL_STRING("2 spots are not written: the instrument has no key for it\n",
                             notes.said);
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(4, count);
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, back[0].spot); // the timpano's part is read first
    TEST_ASSERT_EQUAL(HIMC_SPOT_NORMAL, back[1].spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_CROSSSTICK, back[2].spot);
    TEST_ASSERT_EQUAL(HIMC_SPOT_RIMSHOT, back[3].spot);
}

// `timbales` alone are the French timpani
static void test_a_timbale_is_a_drum_also_under_another_name(void)
{
    parse("instrument high-timbale timbale 13; instrument t timbale 14;"
          "stroke 0 right legato f high-timbale; stroke 1 left legato f t;");
    for (int i = 0; i < 2; i++)
        TEST_ASSERT_EQUAL_INT(MIDI_DRUMS, notes.notes[i].choice);
    read_back(himc_music_import);
    TEST_ASSERT_EQUAL(2, count);
}

static void test_a_score_without_strokes_is_refused(void)
{
    score = himc_score_parse("drum kettle;", "words", NULL, &error);
    TEST_ASSERT_FALSE(himc_music_notes(&notes, score, false, &error));
    TEST_ASSERT_EQUAL_STRING("no stroke that notation has, expected a score with strokes",
                             error.text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_pieces_are_the_same_after_musicxml);
    RUN_TEST(test_a_piece_for_many_instruments_keeps_its_strokes);
    RUN_TEST(test_pedals_come_back_as_words);
    RUN_TEST(test_ornaments_rolls_spots_and_dynamics_are_written);
    RUN_TEST(test_midi_keeps_times_pitches_and_dynamics);
    RUN_TEST(test_midi_has_each_grace_note);
    RUN_TEST(test_a_roll_is_a_roll_after_midi);
    RUN_TEST(test_hats_stay_closed_and_a_foot_s_stroke_stays_the_foot_s);
    RUN_TEST(test_a_gliss_comes_back_as_a_gliss);
    RUN_TEST(test_strokes_on_hoop_and_shell_come_back);
    RUN_TEST(test_spots_without_a_key_are_told_and_come_back_normal);
    RUN_TEST(test_a_timbale_is_a_drum_also_under_another_name);
    RUN_TEST(test_a_score_without_strokes_is_refused);
    return UNITY_END();
}
