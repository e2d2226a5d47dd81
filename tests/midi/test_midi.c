/// MIDI files: the reader held against mido's, and the scores made of them.
#define _XOPEN_SOURCE 700
#include "unity.h"

#include "base/setups.h"
#include "himc/performance.h"
#include "midi/import.h"
#include "midi/part.h"
#include "musicxml/score_file.h"
#include "base/file.h"
#include "base/line.h"
#include "performance/research.h"
#include "plan/score.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static himc_error error;
static midi_score made;
static himc_score *score;

void setUp(void)
{
    error.text[0] = '\0';
}

void tearDown(void)
{
    himc_midi_score_free(&made);
    himc_score_free(score);
    score = NULL;
}

static char *load(const char *name, size_t *size)
{
    char path[128];
    bool piece = strcmp(name, "zarathustra") == 0; // it belongs to a patch
    snprintf(path, sizeof path, "%s/%s.mid", piece ? "patches/pieces" : "tests/midi", name);
    char *bytes = himc_file_load(path, 1 << 20, size, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(bytes, error.text);
    return bytes;
}

// a file of one track, from its events; 96 ticks a quarter note at 120 a minute: 192 a second

#define QUARTER 96

typedef struct builder {
    uint8_t bytes[4096];
    size_t size;
} builder;

static void put(builder *b, const void *bytes, size_t size)
{
    TEST_ASSERT_TRUE(b->size + size <= sizeof b->bytes);
    memcpy(b->bytes + b->size, bytes, size);
    b->size += size;
}

#define PUT(b, ...) put(b, (uint8_t[]){__VA_ARGS__}, sizeof(uint8_t[]){__VA_ARGS__})

static void begin(builder *b)
{
    b->size = 0;
    put(b, "MThd\0\0\0\6\0\0\0\1\0\140MTrk\0\0\0\0", 22);
}

/// After `delta` ticks (below 128 * 128).
static void event(builder *b, int delta, int status, int first, int second)
{
    PUT(b, 0x80 | (uint8_t)(delta >> 7), delta & 0x7f, (uint8_t)status, (uint8_t)first,
        (uint8_t)second);
}

static void end(builder *b)
{
    size_t length = b->size - 22;
    for (int i = 0; i < 4; i++)
        b->bytes[18 + i] = (uint8_t)(length >> (24 - 8 * i));
}

/// Notes of timpani, each `length` ticks long, one every `step` ticks.
static void timpani(builder *b, const int *keys, int count, int step, int length)
{
    begin(b);
    PUT(b, 0, 0xc0, 47);
    for (int i = 0; i < count; i++) {
        event(b, i ? step - length : 0, 0x90, keys[i], 80);
        event(b, length, 0x80, keys[i], 0);
    }
    end(b);
}

static void import(const builder *b, const midi_options *options)
{
    TEST_ASSERT_TRUE_MESSAGE(
        himc_midi_import(&made, b->bytes, b->size, "test.mid", options, &error), error.text);
    score = himc_score_parse(made.text, "made.txt", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    // and can be played: no line of it is refused
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    bool good = himc_performance_load_text(p, made.text, "made", &error);
    himc_performance_free(p);
    TEST_ASSERT_TRUE_MESSAGE(good, error.text);
}

static void refused(const builder *b, const char *expected)
{
    TEST_ASSERT_FALSE(himc_midi_import(&made, b->bytes, b->size, "test.mid", NULL, &error));
    TEST_ASSERT_EQUAL_STRING(expected, error.text);
}

static void reported(const char *line)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.report, line), made.report);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "comment "), made.text);
}

// the reader

static void compare_with_mido(const char *name)
{
    size_t size;
    char *bytes = load(name, &size), path[128], line[200];
    midi_file file;
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, bytes, size, &error), error.text);
    free(bytes);
    snprintf(path, sizeof path, "tests/midi/%s.csv", name);
    FILE *table = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(table, path);
    int row = -1;
    for (; fgets(line, sizeof line, table); row++) {
        double seconds;
        int channel, key, velocity, program;
        if (row < 0)
            continue; // the names of the columns
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            5, sscanf(line, "%lf,%d,%d,%d,%d", &seconds, &channel, &key, &velocity, &program),
            line);
        TEST_ASSERT_LESS_THAN_INT_MESSAGE(file.note_count, row, name);
        const midi_note *note = &file.notes[row];
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-8, seconds, note->seconds, line);
        TEST_ASSERT_EQUAL_INT_MESSAGE(channel, note->channel, line);
        TEST_ASSERT_EQUAL_INT_MESSAGE(key, note->key, line);
        TEST_ASSERT_EQUAL_INT_MESSAGE(velocity, note->velocity, line);
        TEST_ASSERT_EQUAL_INT_MESSAGE(program, note->program, line);
    }
    fclose(table);
    TEST_ASSERT_EQUAL_INT_MESSAGE(row, file.note_count, name);
    himc_midi_file_free(&file);
}

static void test_the_reader_finds_the_notes_that_mido_finds(void)
{
    static const char *const name[] = {"scherzo", "zarathustra", "roll",
                                       "pedals",  "groove",      "frames"};
    for (size_t i = 0; i < sizeof name / sizeof *name; i++)
        compare_with_mido(name[i]);
}

static void test_tracks_of_format_2_follow_each_other(void)
{
    builder b;
    midi_file file;
    begin(&b);
    b.bytes[9] = 2;
    event(&b, QUARTER, 0x99, 36, 90);
    event(&b, QUARTER, 0x99, 36, 0);
    end(&b);
    builder one = b;
    put(&b, one.bytes + 14, one.size - 14);
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, b.bytes, b.size, &error), error.text);
    TEST_ASSERT_EQUAL_INT(2, file.note_count);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, file.notes[0].seconds);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, file.notes[1].seconds);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, file.notes[1].off);
    himc_midi_file_free(&file);
}

static void test_a_last_track_without_a_byte_is_a_track(void)
{
    builder b;
    midi_file file;
    begin(&b);
    event(&b, QUARTER, 0x99, 36, 90);
    end(&b);
    b.bytes[11] = 2;
    put(&b, "MTrk\0\0\0\0", 8);
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, b.bytes, b.size, &error), error.text);
    TEST_ASSERT_EQUAL_INT(2, file.tracks);
    TEST_ASSERT_EQUAL_INT(0, file.missing);
    himc_midi_file_free(&file);
}

static void test_a_note_ends_at_its_note_off_or_with_the_file(void)
{
    builder b;
    midi_file file;
    begin(&b);
    event(&b, 0, 0x99, 36, 90);
    event(&b, 0, 0x99, 43, 90);
    event(&b, QUARTER, 0x99, 36, 0);
    event(&b, QUARTER, 0x99, 36, 90);
    event(&b, QUARTER, 0x99, 36, 0);
    end(&b);
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, b.bytes, b.size, &error), error.text);
    TEST_ASSERT_EQUAL_INT(3, file.note_count);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, file.notes[0].off);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, file.notes[1].off);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, file.notes[2].off);
    himc_midi_file_free(&file);
    // or where its key is struck again; at 29.97 frames a second of 100 ticks
    begin(&b);
    b.bytes[12] = 256 - 29;
    b.bytes[13] = 100;
    event(&b, 0, 0x99, 36, 90);
    event(&b, 2997, 0x99, 36, 90);
    event(&b, 2997, 0x99, 36, 0);
    end(&b);
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, b.bytes, b.size, &error), error.text);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1, file.notes[0].off);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2, file.notes[1].off);
    himc_midi_file_free(&file);
}

// wherever a file ends, what was there is kept, or one line refuses it
static void test_a_file_cut_anywhere_is_read_up_to_there_or_refused_in_a_line(void)
{
    size_t size;
    char *bytes = load("zarathustra", &size);
    int read = 0, notes = 0;
    for (size_t cut = 0; cut < size; cut++) {
        midi_file file;
        char *part = malloc(cut + 1); // of its size, for the address sanitizer
        memcpy(part, bytes, cut);
        bool good = himc_midi_file_read(&file, part, cut, &error);
        TEST_ASSERT_TRUE(good || (error.text[0] && himc_line_is_clean(error.text)));
        if (good) {
            TEST_ASSERT_TRUE(file.note_count >= notes);
            notes = file.note_count;
            read += file.cut;
            TEST_ASSERT_TRUE(file.cut + file.missing > 0); // and that is told
            TEST_ASSERT_TRUE(file.cut_at >= 0 && file.cut_at < 60);
            himc_midi_file_free(&file);
        }
        free(part);
    }
    free(bytes);
    TEST_ASSERT_EQUAL_INT(16, notes);
    TEST_ASSERT_GREATER_THAN_INT(100, read); // cut in the middle of an event
}

static void test_a_bad_file_is_refused_in_one_line(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 60, 90);
    end(&b);
    refused(&b, "track 1: data without a status byte");
    begin(&b);
    PUT(&b, 0, 0x90, 60, 200);
    end(&b);
    refused(&b, "track 1: a data byte above 127");
    begin(&b);
    PUT(&b, 0x81, 0x81, 0x81, 0x81, 0, 0x90, 60, 90);
    end(&b);
    refused(&b, "track 1: a number of more than 4 bytes");
    begin(&b);
    PUT(&b, 0, 0xf4);
    end(&b);
    refused(&b, "track 1: a status byte that files do not have");
    begin(&b);
    // data after an exclusive message: it has ended the running status
    PUT(&b, 0, 0x90, 60, 1, 0, 0xf0, 1, 0xf7, 0, 60, 0);
    end(&b);
    refused(&b, "track 1: data without a status byte");
    begin(&b);
    b.bytes[9] = 3;
    refused(&b, "MIDI format 3, expected 0 .. 2");
    begin(&b);
    b.bytes[13] = 0;
    refused(&b, "a division of 0 ticks, expected 1 or more");
    begin(&b);
    b.bytes[7] = 200;
    refused(&b, "a header of 200 bytes, expected 6 .. 14");
    b.size = 14;
    b.bytes[7] = 6;
    refused(&b, "a MIDI file without a track");
    b.size = 13;
    refused(&b, "not a MIDI file: it does not begin with MThd and 6 bytes");
    begin(&b);
    event(&b, 0, 0x90, 60, 90);
    end(&b);
    refused(&b, "nothing to play: 1 note, none of a drum (channel 10)");
}

// the score

static void test_velocities_become_dynamics_by_both_curves(void)
{
    static const int velocity[] = {16, 32, 48, 64, 80, 96, 112, 127};
    static const double square[] = {.17, .32, .44, .54, .63, .71, .86, 1};
    for (int i = 0; i < 8; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.006, square[i], himc_midi_dynamic(velocity[i], 22));
        if (i < 7) // pp is 32 where notation programs write 33; the steps are k/7
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, i / 7.0, himc_midi_dynamic(velocity[i], 0));
    }
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_midi_dynamic(1, 0));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1, himc_midi_dynamic(127, 0));
}

// each stroke comes when its note does, through the tempo map, which stays as it was
static void test_strokes_keep_the_times_of_their_notes_through_a_tempo_map(void)
{
    size_t size;
    char *bytes = load("scherzo", &size);
    midi_file file;
    TEST_ASSERT_TRUE(himc_midi_file_read(&file, bytes, size, &error));
    TEST_ASSERT_TRUE(himc_midi_import(&made, bytes, size, "scherzo.mid", NULL, &error));
    free(bytes);
    score = himc_score_parse(made.text, "made.txt", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_EQUAL_INT(3, score->tempo_count);
    TEST_ASSERT_EQUAL_INT(file.note_count, score->stroke_count);
    const double lead = 6; // beats, more than a second
    TEST_ASSERT_NOT_NULL(strstr(made.text, "comment beat 0 of the file is beat 6 here;"));
    double origin = himc_score_seconds(score->tempi, score->tempo_count, lead);
    for (int i = 0; i < score->stroke_count; i++) {
        double at = himc_score_seconds(score->tempi, score->tempo_count, score->strokes[i].beat);
        TEST_ASSERT_DOUBLE_WITHIN(2e-5, file.notes[i].seconds, at - origin);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, file.notes[i].beat, score->strokes[i].beat - lead);
    }
    himc_midi_file_free(&file);
}

static int drums_of(const himc_score *s)
{
    int drums = 0;
    for (int i = 0; i < s->line_count; i++)
        drums += s->lines[i].command.id == HIMC_COMMAND_MAKE_DRUM;
    return drums;
}

static void test_two_pitches_are_two_drums_and_no_pedal_moves(void)
{
    builder b;
    timpani(&b, (int[]){48, 43, 48, 43, 43, 48}, 6, QUARTER, QUARTER - 1);
    import(&b, NULL);
    TEST_ASSERT_EQUAL_INT(2, drums_of(score));
    TEST_ASSERT_EQUAL_INT(6, score->stroke_count);
    TEST_ASSERT_NULL(strstr(made.report, "pedal"));
    for (int i = 1; i < 6; i++) // each pitch on a drum of its own
        TEST_ASSERT_EQUAL_INT((i == 1 || i == 3 || i == 4),
                              strcmp(score->strokes[0].drum, score->strokes[i].drum) != 0);
}

static void test_five_pitches_are_played_on_four_drums_by_a_pedal(void)
{
    builder b;
    timpani(&b, (int[]){38, 43, 48, 53, 40}, 5, 4 * QUARTER, QUARTER);
    import(&b, NULL);
    reported("5 of 5 notes for timpani are played");
    reported("1 change of pitch by pedal");
    TEST_ASSERT_EQUAL_STRING("low", score->strokes[4].drum); // D to E, the shortest way
}

static void test_a_pedal_glides_between_two_pitches(void)
{
    static const int key[2][2] = {{38, 40}, {40, 38}}; // D to E and E to D
    for (int i = 0; i < 2; i++) {
        builder b;
        timpani(&b, (int[]){key[i][0], 43, 48, 53, key[i][1]}, 5, 4 * QUARTER, QUARTER);
        import(&b, NULL);
        TEST_ASSERT_NOT_NULL(strstr(made.text, i == 0 ? "low tune D2;" : "low tune E2;"));
        TEST_ASSERT_NOT_NULL(
            strstr(made.text, i == 0 ? "low gliss E2 0.25;" : "low gliss D2 0.25;"));
        TEST_ASSERT_EQUAL_INT(3, score->change_count); // with a hand that damps before
        tearDown();
    }
}

static void test_a_pitch_that_no_pedal_reaches_in_time_is_reported(void)
{
    builder b;
    timpani(&b, (int[]){38, 39, 40, 41, 42, 38, 39}, 7, QUARTER / 4, 12); // 8 a second, in E flat
    import(&b, NULL);
    int played = score->stroke_count;
    TEST_ASSERT_LESS_THAN_INT(7, played);
    char line[80];
    snprintf(line, sizeof line, "%d of 7 notes for timpani are played", played);
    reported(line);
    reported("no drum could be tuned to");
}

// 0.7 of the time to the next one, whenever in the file that is
static void test_a_note_that_ends_well_before_the_next_is_damped(void)
{
    static const int keys[12] = {45, 45, 45, 45, 45, 45, 45, 45, 45, 45, 45, 45};
    builder b;
    timpani(&b, keys, 12, 384, 307); // 0.8
    import(&b, NULL);
    TEST_ASSERT_NULL(strstr(made.report, "damped"));
    himc_midi_score_free(&made);
    himc_score_free(score);
    timpani(&b, keys, 12, 384, 230); // 0.6
    import(&b, NULL);
    reported("11 notes are damped at their end");
}

static void test_pitches_outside_the_timpani_are_moved_by_octaves(void)
{
    builder b;
    timpani(&b, (int[]){30, 84}, 2, QUARTER, 40);
    import(&b, NULL);
    reported("2 notes are moved by octaves to what is built");
    TEST_ASSERT_EQUAL_INT(2, score->stroke_count);
}

/// Hands of the strokes as letters.
static const char *hands(void)
{
    static char text[64];
    int i = 0;
    for (; i < score->stroke_count && i < 63; i++)
        text[i] = score->strokes[i].hand == HIMC_LEFT ? 'L' : 'R';
    text[i] = '\0';
    return text;
}

// from eight a second down to one, on each of the four drums
static void test_one_drum_is_played_hand_by_hand(void)
{
    static const int gap[] = {23, 48, 96, 2 * QUARTER}; // beside the note's 12: 0.12 s .. 1 s
    static const int key[] = {38, 45, 49, 57};
    for (int i = 0; i < 16; i++) {
        builder b;
        int k = key[i / 4], keys[12] = {k, k, k, k, k, k, k, k, k, k, k, k};
        timpani(&b, keys, 12, gap[i % 4], 12);
        import(&b, NULL);
        TEST_ASSERT_TRUE_MESSAGE(
            !strcmp(hands(), "RLRLRLRLRLRL") || !strcmp(hands(), "LRLRLRLRLRLR"), hands());
        tearDown();
    }
}

// it grows, stays loud, dies away; the file's own strokes are not kept
static void test_fast_repeats_of_a_timpano_are_rolls(void)
{
    score = himc_score_load("tests/midi/roll.mid", &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_NOT_NULL(strstr(score->report, "40 notes are played as 3 rolls\n"));
    TEST_ASSERT_EQUAL_INT(3, score->stroke_count);
    const himc_stroke *s = score->strokes;
    const double rise[3] = {0.5, 0, -0.5}; // of the dynamic
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT(HIMC_ROLL_SINGLE, s[i].ornament);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, rise[i], s[i].last_dynamic - s[i].dynamic);
        if (i > 0) // without a gap
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, s[i].beat, s[i - 1].beat + s[i - 1].length);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 4, s[2].beat + s[2].length); // 40 notes of 75 ms, after a beat
}

static void test_slower_fewer_or_shared_strokes_and_drum_fills_are_no_rolls(void)
{
    builder b;
    timpani(&b, (int[]){48, 48, 48, 48, 48}, 5, 22, 10); // 8.7 a second
    import(&b, NULL);
    TEST_ASSERT_EQUAL_INT(5, score->stroke_count);
    tearDown();
    timpani(&b, (int[]){48, 48, 48, 43, 43, 43}, 6, 20, 10); // three on each drum
    import(&b, NULL);
    TEST_ASSERT_EQUAL_INT(6, score->stroke_count);
    tearDown();
    timpani(&b, (int[]){48, 48, 48, 48, 43, 48}, 6, 20, 10); // four 16ths and the next beat
    import(&b, NULL);
    TEST_ASSERT_EQUAL_INT(6, score->stroke_count);
    tearDown();
    begin(&b);
    for (int i = 0; i < 6; i++)
        event(&b, 20, 0x99, 38, 90);
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_EQUAL_INT(6, score->stroke_count);
    TEST_ASSERT_NULL(strstr(made.report, "roll"));
}

// two or four 16ths on each of four drums at 80, 100 and 120 a minute: all are played, and no arm
// crosses the other one over a drum, which bodies can not in that time
static void test_16ths_over_four_drums_are_played_without_crossing(void)
{
    static const char *const order[] = {"low", "second", "third", "high"};
    const int step[] = {36, 29, 24}, key[] = {43, 48, 50, 55};
    for (int k = 0; k < 6; k++) {
        builder b;
        int keys[32], at[32] = {0};
        for (int i = 0; i < 32; i++)
            keys[i] = key[i / (k % 2 ? 2 : 4) % 4];
        timpani(&b, keys, 32, step[k / 2], 10);
        import(&b, NULL);
        reported("32 of 32 notes for timpani are played");
        TEST_ASSERT_EQUAL_INT(32, score->stroke_count);
        for (int i = 0; i < 32; i++) {
            const himc_stroke *s = &score->strokes[i];
            for (int d = 0; d < 4; d++)
                at[i] = strcmp(s->drum, order[d]) == 0 ? d : at[i];
            bool other = i > 0 && s->hand != s[-1].hand;
            int out = other ? at[i] - at[i - 1] : 0; // to the right
            TEST_ASSERT_TRUE_MESSAGE(s->hand == HIMC_LEFT ? out <= 0 : out >= 0, hands());
        }
        TEST_ASSERT_NOT_NULL(strstr(hands(), "RLR")); // not hand for hand a drum
        tearDown();
    }
}

// up to the stroke on another drum, which comes where no hand could leave the file's own strokes
static void test_a_roll_goes_on_to_a_stroke_on_another_drum(void)
{
    const int steps[] = {20, 12}; // 9.6, 16 a second
    for (int k = 0; k < 2; k++) {
        builder b;
        int keys[33];
        for (int i = 0; i < 33; i++)
            keys[i] = i < 32 ? 48 : 43;
        timpani(&b, keys, 33, steps[k], 10);
        import(&b, NULL);
        reported("33 of 33 notes for timpani are played");
        TEST_ASSERT_EQUAL_INT_MESSAGE(2, score->stroke_count, made.text);
        TEST_ASSERT_EQUAL_INT(HIMC_ROLL_SINGLE, score->strokes[0].ornament);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 32.0 * steps[k] / QUARTER, score->strokes[0].length);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, score->strokes[0].beat + score->strokes[0].length,
                                  score->strokes[1].beat);
        tearDown();
    }
}

// 32nds that lead to a quarter note: it is a stroke, as loud as they are or not
static void test_a_long_note_after_fast_ones_is_their_aim(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xc0, 47);
    for (int i = 0; i < 9; i++) {
        event(&b, i ? 2 : 0, 0x90, 48, 80);
        event(&b, i < 8 ? 10 : 96, 0x80, 48, 0);
    }
    end(&b);
    import(&b, NULL);
    reported("9 of 9 notes for timpani are played");
    TEST_ASSERT_EQUAL_INT_MESSAGE(2, score->stroke_count, made.text);
    const himc_stroke *s = score->strokes;
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, s[0].beat + s[0].length, s[1].beat);
    TEST_ASSERT_EQUAL_INT(HIMC_PLAIN, s[1].ornament);
}

// as programs write a tremolo of a chord
static void test_fast_strokes_of_two_drums_at_the_same_times_are_a_roll_on_both(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xc0, 47);
    for (int i = 0; i < 16; i++) {
        event(&b, i ? 6 : 0, 0x90, 43, 80);
        event(&b, 0, 0x90, 48, 80);
        event(&b, 6, 0x80, 43, 0);
        event(&b, 0, 0x80, 48, 0);
    }
    end(&b);
    import(&b, NULL);
    reported("32 of 32 notes for timpani are played");
    reported("32 notes are played as 2 rolls");
    TEST_ASSERT_EQUAL_INT_MESSAGE(2, score->stroke_count, made.text);
    const himc_stroke *s = score->strokes;
    TEST_ASSERT_TRUE(strcmp(s[0].drum, s[1].drum) != 0);
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL_INT(HIMC_ROLL_SINGLE, s[i].ornament);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, s[0].beat, s[i].beat);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 2, s[i].length);
    }
}

static void test_two_drums_in_the_middle_are_played_by_sides(void)
{
    builder b;
    timpani(&b, (int[]){45, 45, 49, 49, 45, 45, 49, 49}, 8, QUARTER, 90); // 0.5 s
    import(&b, NULL);
    TEST_ASSERT_EQUAL_STRING("second", score->strokes[0].drum);
    TEST_ASSERT_EQUAL_STRING("third", score->strokes[2].drum);
    TEST_ASSERT_EQUAL_STRING("LLRRLLRR", hands());
}

static void test_outer_drums_are_played_by_the_hand_of_their_side(void)
{
    builder b;
    timpani(&b, (int[]){38, 57, 38, 57}, 4, 40, 30); // 0.21 s
    import(&b, NULL);
    TEST_ASSERT_EQUAL_STRING("low", score->strokes[0].drum);
    TEST_ASSERT_EQUAL_STRING("LRLR", hands());
}

static int lines_with(const char *text, const char *what)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, what)); at += strlen(what))
        count++;
    return count;
}

static void test_what_two_hands_cannot_play_is_reported(void)
{
    size_t size;
    char *bytes = load("groove", &size);
    TEST_ASSERT_TRUE(himc_midi_import(&made, bytes, size, "groove.mid", NULL, &error));
    free(bytes);
    reported("71 of 73 notes for drums are played");
    reported("1 note is one stroke with another at the same time on its head"); // 35 and 36
    reported("1 note is not played: both hands are busy");                      // of five at once
    TEST_ASSERT_EQUAL_INT(4, lines_with(made.text, " crossstick snare;"));      // side sticks
}

// feet play the bass drum, and open and close the hi-hat before its stroke
static void test_feet_play_their_pedals(void)
{
    static const int keys[] = {36, 42, 46, 46, 42, 44};
    builder b;
    begin(&b);
    for (int i = 0; i < 6; i++)
        event(&b, i ? QUARTER : 0, 0x99, keys[i], 90);
    end(&b);
    import(&b, NULL);
    reported("6 of 6 notes for drums are played");
    TEST_ASSERT_EQUAL_INT(HIMC_FOOT, score->strokes[0].hand);
    TEST_ASSERT_EQUAL_STRING("kick", score->strokes[0].drum);
    TEST_ASSERT_EQUAL_INT(HIMC_FOOT, score->strokes[5].hand);
    TEST_ASSERT_EQUAL_STRING("hats", score->strokes[5].drum);
    TEST_ASSERT_EQUAL_INT(2, lines_with(made.text, "hats pedal 1;"));
    TEST_ASSERT_EQUAL_INT(1, lines_with(made.text, "hats pedal 0;"));
    TEST_ASSERT_EQUAL_INT(3, score->change_count);
    for (int i = 0; i < 3; i++) {
        double ahead = score->strokes[i < 2 ? i + 1 : 4].beat - score->changes[i].beat;
        TEST_ASSERT_TRUE(ahead > 0 && ahead < 0.07);
    }
    tearDown();
    // a foot closes open hats, and strikes them while a stick does
    begin(&b);
    event(&b, 0, 0x99, 46, 90);
    event(&b, QUARTER, 0x99, 44, 90);
    event(&b, QUARTER, 0x99, 42, 90);
    event(&b, 0, 0x99, 44, 90);
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_EQUAL_INT(4, score->stroke_count);
    TEST_ASSERT_EQUAL_INT(1, lines_with(made.text, "hats pedal 1;"));
    TEST_ASSERT_TRUE(score->changes[1].beat < score->strokes[1].beat);
}

// each key of General MIDI's map is played, or told by its name
static void test_every_key_is_played_or_told(void)
{
    builder b;
    begin(&b);
    for (int key = 30; key <= 82; key++)
        event(&b, key > 30 ? QUARTER : 0, 0x99, key, 90);
    end(&b);
    TEST_ASSERT_TRUE(himc_midi_import(&made, b.bytes, b.size, "test.mid", NULL, &error));
    reported("1 of hand clap: no such instrument here");
    reported("1 of open cuica: no such instrument here");
    reported("1 of key 30: no sound in General MIDI");
    reported("1 of ride cymbal 2: played on ride");
    TEST_ASSERT_NOT_NULL(strstr(made.text, " click snare;"));
    TEST_ASSERT_NOT_NULL(strstr(made.text, " crossstick snare;"));
    TEST_ASSERT_NOT_NULL(strstr(made.text, " rimshot snare;"));
    int told = lines_with(made.report, ": no such instrument here") +
               lines_with(made.report, ": no sound in General MIDI") +
               lines_with(made.report, ": no room for one more");
    TEST_ASSERT_EQUAL_INT(53, lines_with(made.text, "\nstroke ") + told);
    TEST_ASSERT_EQUAL_INT(HIMC_DRUMS, lines_with(made.text, "\ninstrument "));
}

// a set-up's instruments play what they can, found by their name or their kind
static void test_drums_are_played_on_a_set_up(void)
{
    static const int keys[] = {38, 48, 49, 36, 81, 42};
    const char *path = "/tmp/himc-midi-setup.txt";
    builder b;
    begin(&b);
    for (int i = 0; i < 6; i++)
        event(&b, i ? QUARTER : 0, 0x99, keys[i], 90);
    end(&b);
    import(&b, &(midi_options){.setup = "multi"});
    reported("4 of 6 notes for drums are played");
    reported("1 of bass drum 1: no kick in the set-up");
    reported("1 of closed hi-hat: no hats in the set-up");
    TEST_ASSERT_NOT_NULL(strstr(made.text, "\nsetup multi;\n"));
    TEST_ASSERT_NULL(strstr(made.text, "\ninstrument "));
    TEST_ASSERT_EQUAL_STRING("tom", score->strokes[1].drum);
    FILE *file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs("instrument mine snare 13; mine place .5 .1 .8; instrument boom kick 20;", file);
    fclose(file);
    tearDown();
    begin(&b);
    for (int i = 0; i < 6; i++)
        event(&b, i ? QUARTER : 0, 0x99, keys[i], 90);
    end(&b);
    import(&b, &(midi_options){.setup = path});
    reported("2 of 6 notes for drums are played");
    TEST_ASSERT_EQUAL_STRING("mine", score->strokes[0].drum);
    TEST_ASSERT_EQUAL_STRING("boom", score->strokes[1].drum);
    file = fopen(path, "w"); // the name is more than the size
    TEST_ASSERT_NOT_NULL(file);
    fputs("instrument other snare 14; instrument snare snare 12;", file);
    fclose(file);
    tearDown();
    import(&b, &(midi_options){.setup = path});
    TEST_ASSERT_EQUAL_STRING("snare", score->strokes[0].drum);
    remove(path);
    tearDown();
    begin(&b);
    event(&b, 0, 0x99, 38, 90);
    end(&b);
    TEST_ASSERT_FALSE(himc_midi_import(&made, b.bytes, b.size, "t.mid",
                                       &(midi_options){.setup = "attic"}, &error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "setup: attic"), error.text);
    TEST_ASSERT_FALSE(himc_midi_import(&made, b.bytes, b.size, "t.mid",
                                       &(midi_options){.choice = MIDI_MARIMBA, .setup = "kit"},
                                       &error));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "a set-up is for drums"), error.text);
}

static void test_keyboards_are_played_on_their_bars(void)
{
    static const int keys[] = {60, 64, 67, 72, 61, 30};
    builder b;
    begin(&b);
    PUT(&b, 0, 0xc0, 12);
    for (int i = 0; i < 6; i++)
        event(&b, i ? QUARTER : 0, 0x90, keys[i], 90);
    event(&b, 0, 0x90, 79, 90); // with the last
    end(&b);
    import(&b, NULL);
    reported("7 of 7 notes for marimba are played");
    reported("1 note is moved by octaves to what is built");
    TEST_ASSERT_NOT_NULL(strstr(made.text, "instrument marimba marimba F#3 G5;"));
    static const char *const part[] = {"C4", "E4", "G4", "C5", "C#4"};
    for (int i = 0; i < 5; i++)
        TEST_ASSERT_EQUAL_STRING(part[i], score->strokes[i].part);
    // of two at once the left hand has the lower one
    int low = strcmp(score->strokes[5].part, "F#3") ? 6 : 5;
    TEST_ASSERT_EQUAL_INT(HIMC_LEFT, score->strokes[low].hand);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, score->strokes[11 - low].hand);
}

static void test_tubular_bells_hang_where_the_set_up_has_them(void)
{
    builder b;
    const char *setup = strstr(himc_setup_bells, "bells place ") + strlen("bells place ");
    char placed[80], line[80];
    double x, y, z;
    begin(&b);
    PUT(&b, 0, 0xc0, 14);
    event(&b, 0, 0x90, 65, 90);
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_EQUAL_INT(3, sscanf(setup, "%lf %lf %lf", &x, &y, &z));
    const char *at = strstr(made.text, "tubular-bell place ");
    TEST_ASSERT_NOT_NULL_MESSAGE(at, made.text);
    snprintf(placed, sizeof placed, "tubular-bell place %.3g %.3g %.3g", x, y, z);
    snprintf(line, sizeof line, "%.*s", (int)strlen(placed), at);
    TEST_ASSERT_EQUAL_STRING(placed, line);
}

// of a chord of three the softest is left out
static void test_the_loud_notes_of_a_chord_are_played(void)
{
    builder b;
    begin(&b);
    event(&b, 0, 0x99, 41, 100);
    event(&b, 0, 0x99, 38, 40);
    event(&b, 0, 0x99, 50, 110);
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_EQUAL_INT(2, score->stroke_count);
    TEST_ASSERT_EQUAL_INT(1, made.left_out);
    for (int i = 0; i < 2; i++)
        TEST_ASSERT_TRUE(strcmp(score->strokes[i].drum, "snare") != 0);
}

static void test_the_part_is_chosen(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xff, 3, 6, 'P', 'A', 'U', 'K', 'E', 'N', 0, 0xff, 3, 1, 'x');
    event(&b, 0, 0x92, 45, 90);
    event(&b, QUARTER, 0x99, 36, 90);
    event(&b, QUARTER, 0x99, 36, 90);
    end(&b);
    import(&b, NULL);
    reported("1 of 1 notes for timpani are played");
    reported("2 notes for other percussion are not asked for");
    tearDown();
    import(&b, &(midi_options){.choice = MIDI_DRUMS});
    reported("2 of 2 notes for drums are played");
    reported("1 note for other percussion is not asked for");
}

// a channel of a track is a player, whose program may change
static void test_a_program_changes_the_instrument(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xc0, 47);
    event(&b, 0, 0x90, 45, 90);
    PUT(&b, 0, 0xc0, 13);
    event(&b, QUARTER, 0x90, 72, 90);
    event(&b, QUARTER, 0x99, 38, 90);
    end(&b);
    import(&b, NULL);
    reported("2 of 2 notes for timpani xylophone are played");
    reported("1 note for other percussion is not asked for: drums");
    TEST_ASSERT_EQUAL_STRING("xylophone", score->strokes[1].drum);
    TEST_ASSERT_EQUAL_STRING("C5", score->strokes[1].part);
    tearDown();
    import(&b, &(midi_options){.all = true});
    reported("3 of 3 notes for timpani drums xylophone are played");
    TEST_ASSERT_EQUAL_STRING("snare", score->strokes[2].drum);
    tearDown();
    import(&b, &(midi_options){.choice = MIDI_XYLOPHONE});
    reported("1 of 1 notes for xylophone are played");
    tearDown();
    TEST_ASSERT_FALSE(himc_midi_import(&made, b.bytes, b.size, "test.mid",
                                       &(midi_options){.all = true, .setup = "kit"}, &error));
    TEST_ASSERT_EQUAL_STRING(
        "a set-up is for drums, expected none: timpani has instruments of its own", error.text);
}

// "Player 3: ..." joins tracks; other names do not
static void test_tracks_of_one_player_are_played_together(void)
{
    static const char *const names[][2] = {{"Player 3: Timpani", "Player 3: tam-tam"},
                                           {"Player 3: Timpani", "Player 4: tam-tam"},
                                           {"Player: Timpani", "Player: tam-tam"},
                                           {"Player 12: Timpani", "Player 12: tam-tam"}};
    for (int k = 0; k < 4; k++) {
        uint8_t bytes[256] = "MThd\0\0\0\6\0\1\0\2\0\140";
        size_t size = 14;
        for (int i = 0; i < 2; i++) {
            size_t name = strlen(names[k][i]);
            const uint8_t events[] = {0, (uint8_t)(i ? 0x99 : 0x90), i ? 36 : 45, 90, 0, 0xff, 47,
                                      0};
            memcpy(bytes + size, "MTrk\0\0\0", 7);
            bytes[size + 7] = (uint8_t)(4 + name + sizeof events);
            memcpy(bytes + size + 8, (uint8_t[]){0, 0xff, 3, (uint8_t)name}, 4);
            memcpy(bytes + size + 12, names[k][i], name);
            memcpy(bytes + size + 12 + name, events, sizeof events);
            size += 12 + name + sizeof events;
        }
        TEST_ASSERT_TRUE_MESSAGE(himc_midi_import(&made, bytes, size, "t.mid", NULL, &error),
                                 error.text);
        reported(k % 3 == 0 ? "2 of 2 notes for timpani drums are played"
                            : "1 note for other percussion is not asked for: drums");
        TEST_ASSERT_EQUAL(k % 3 == 0, strstr(made.text, "instrument tam-tam") != NULL);
        himc_midi_score_free(&made);
    }
}

// a file's name and tracks come from strangers
static void test_a_name_stays_one_comment(void)
{
    builder b;
    timpani(&b, (int[]){48}, 1, QUARTER, 40);
    TEST_ASSERT_TRUE(
        himc_midi_import(&made, b.bytes, b.size, "../a;b\nclear \xff.mid", NULL, &error));
    TEST_ASSERT_EQUAL_STRING_LEN("comment made of a_b_clear__.mid by himc import;\n", made.text,
                                 48);
}

static void test_a_tempo_that_scores_do_not_have_leaves_the_times(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xff, 0x51, 3, 0, 0, 100); // 600000 a minute
    event(&b, 10000, 0x99, 36, 90);
    PUT(&b, 0, 0xff, 0x51, 3, 7, 0xa1, 0x20); // 120
    event(&b, QUARTER, 0x99, 36, 90);
    end(&b);
    import(&b, NULL);
    reported("the tempo map is not kept: beats are half seconds");
    TEST_ASSERT_EQUAL_INT(1, score->tempo_count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1, score->strokes[1].beat - score->strokes[0].beat);
}

static void test_score_file_loads_midi_and_keeps_its_report(void)
{
    score = himc_score_load("patches/pieces/zarathustra.mid", &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_EQUAL_INT(14, score->stroke_count);
    TEST_ASSERT_EQUAL_STRING_LEN("14 of 14 notes for timpani are played\n", score->report, 38);
    himc_score *text = himc_score_load("patches/improvisation.txt", &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(text, error.text);
    TEST_ASSERT_NULL(text->report);
    himc_score_free(text);
}

// over the network a file is read in one folder only, MIDI as any other
static void test_a_midi_file_outside_the_folder_is_refused(void)
{
    char folder[PATH_MAX];
    TEST_ASSERT_NOT_NULL(realpath("tests/midi", folder));
    score = himc_score_load_in(folder, "roll.mid", &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    TEST_ASSERT_NULL(himc_score_load_in(folder, "../../patches/pieces/zarathustra.mid", &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "no such file in the folder given by --files"));
}

// controllers

static void test_volume_and_expression_scale_velocities(void)
{
    for (int control = 7; control <= 11; control += 4) {
        builder b;
        begin(&b);
        event(&b, 0, 0xc2, 47, 0);
        b.size--; // a program has one byte
        event(&b, 0, 0xb2, control, 100);
        event(&b, 0, 0x92, 45, 96);
        event(&b, 2 * QUARTER, 0x82, 45, 0);
        event(&b, 0, 0xb2, control, 50);
        event(&b, 0, 0x92, 45, 96);
        event(&b, 2 * QUARTER, 0x82, 45, 0);
        end(&b);
        import(&b, NULL);
        TEST_ASSERT_EQUAL(2, score->stroke_count);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, himc_midi_dynamic(96, 0), score->strokes[0].dynamic);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, himc_midi_dynamic(48, 0), score->strokes[1].dynamic);
        tearDown();
    }
    // what is first said in the middle of a piece is less than the usual before
    builder b;
    begin(&b);
    PUT(&b, 0, 0xc2, 47);
    event(&b, 0, 0x92, 45, 96);
    event(&b, 2 * QUARTER, 0x82, 45, 0);
    event(&b, 0, 0xb2, 11, 64);
    event(&b, 0, 0x92, 45, 96);
    event(&b, 2 * QUARTER, 0x82, 45, 0);
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, himc_midi_dynamic(96, 0), score->strokes[0].dynamic);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, himc_midi_dynamic(48.4, 0), score->strokes[1].dynamic);
}

// a timpani note of two quarters whose controller or pressure rises and falls
static void swell(builder *b, int status, int first, const int *value, int count)
{
    begin(b);
    PUT(b, 0, 0xc2, 47);
    if (status == 0xb2)
        event(b, 0, 0xb2, first, 127);
    event(b, 0, 0x92, 45, 120);
    for (int i = 0; i < count; i++) {
        int two = status == 0xd2 ? value[i] : first;
        event(b, i ? 2 * QUARTER / count : 0, status, two, value[i]);
        b->size -= status == 0xd2;
    }
    event(b, 2 * QUARTER / count, 0x82, 45, 0);
    end(b);
}

static void test_a_swell_on_a_held_note_is_the_crescendo_of_a_roll(void)
{
    builder b;
    swell(&b, 0xb2, 11, (int[]){30, 45, 60, 75, 90, 105, 120, 127}, 8);
    import(&b, NULL);
    TEST_ASSERT_EQUAL(HIMC_ROLL_SINGLE, score->strokes[0].ornament);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 1.75, score->strokes[0].length);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, himc_midi_dynamic(120 * 30 / 127.0, 0),
                              score->strokes[0].dynamic);
    TEST_ASSERT_DOUBLE_WITHIN(0.07, himc_midi_dynamic(120, 0), score->strokes[0].last_dynamic);
    reported("1 of 1 notes for timpani are played");
    tearDown();
    // and back
    swell(&b, 0xb2, 11, (int[]){30, 70, 100, 127, 127, 100, 70, 30}, 8);
    import(&b, NULL);
    TEST_ASSERT_TRUE_MESSAGE(score->stroke_count >= 2, made.text);
    bool rises = false, falls = false;
    for (const himc_stroke *s = score->strokes; s < score->strokes + score->stroke_count; s++) {
        rises |= !falls && s->last_dynamic > s->dynamic + 0.2;
        falls |= rises && s->last_dynamic < s->dynamic - 0.2;
    }
    TEST_ASSERT_TRUE_MESSAGE(rises && falls, made.text);
    reported("1 of 1 notes for timpani are played");
}

static void test_pressure_swells_and_a_fading_note_is_a_stroke(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xc2, 47);
    event(&b, 0, 0x92, 45, 60);
    for (int i = 0; i < 8; i++)
        event(&b, QUARTER / 4, 0xa2, 45, 16 * i);
    event(&b, 1, 0x82, 45, 0);
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_EQUAL(HIMC_ROLL_SINGLE, score->strokes[0].ornament);
    tearDown();
    begin(&b);
    PUT(&b, 0, 0xc2, 47);
    event(&b, 0, 0x92, 45, 60);
    for (int i = 0; i < 8; i++)
        PUT(&b, QUARTER / 4, 0xd2, (uint8_t)(16 * i));
    event(&b, 1, 0x82, 45, 0);
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_EQUAL(HIMC_ROLL_SINGLE, score->strokes[0].ornament);
    tearDown();
    begin(&b); // by a step
    PUT(&b, 0, 0xc2, 47);
    event(&b, 0, 0x92, 45, 60);
    for (int i = 0; i < 4; i++)
        PUT(&b, QUARTER / 2, 0xd2, (uint8_t)(10 * i));
    event(&b, 1, 0x82, 45, 0);
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_EQUAL(HIMC_ROLL_SINGLE, score->strokes[0].ornament);
    tearDown();
    swell(&b, 0xb2, 11, (int[]){127, 110, 90, 70, 50, 30, 10, 0}, 8);
    import(&b, NULL);
    TEST_ASSERT_EQUAL(1, score->stroke_count);
    TEST_ASSERT_EQUAL(HIMC_PLAIN, score->strokes[0].ornament);
}

static void test_a_held_pedal_lets_notes_ring(void)
{
    static const int pedals[] = {0, 63, 64, 127}; // from 64 on it is held
    for (int i = 0; i < 4; i++) {
        builder b;
        begin(&b);
        PUT(&b, 0, 0xc2, 47);
        event(&b, 0, 0xb2, 64, pedals[i]);
        event(&b, 0, 0x92, 45, 90);
        event(&b, QUARTER / 2, 0x82, 45, 0);
        event(&b, 4 * QUARTER, 0x92, 45, 90);
        event(&b, QUARTER, 0x82, 45, 0);
        end(&b);
        import(&b, NULL);
        TEST_ASSERT_EQUAL(i > 1 ? 0 : 2, score->change_count);
        tearDown();
    }
}

static void test_a_cut_file_is_refused_with_how_far_it_was_read(void)
{
    builder b;
    timpani(&b, (int[]){45, 45, 45}, 3, QUARTER, 40);
    TEST_ASSERT_FALSE(himc_midi_import(&made, b.bytes, b.size - 5, "x", NULL, &error));
    TEST_ASSERT_EQUAL_STRING_LEN("cut short: 1 of its 1 tracks can be read up to 1", error.text,
                                 48);
}

static void test_32nds_at_8_a_second_are_a_roll(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xff, 0x51, 3, 0x0f, 0x42, 0x40); // 60 a minute
    PUT(&b, 0, 0xc2, 47);
    for (int i = 0; i < 8; i++) {
        event(&b, 0, 0x92, 45, 80);
        event(&b, QUARTER / 8, 0x82, 45, 0);
    }
    end(&b);
    import(&b, NULL);
    reported("8 notes are played as 1 roll");
}

static void test_tracks_channels_and_instruments_can_be_asked_for(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xc0, 0); // a piano
    event(&b, 0, 0x90, 45, 80);
    event(&b, QUARTER, 0x91, 52, 80);
    event(&b, QUARTER, 0x81, 52, 0);
    end(&b);
    TEST_ASSERT_FALSE(himc_midi_import(&made, b.bytes, b.size, "x", NULL, &error));
    import(&b, &(midi_options){.as = MIDI_TIMPANI});
    reported("2 of 2 notes for timpani are played");
    tearDown();
    import(&b, &(midi_options){.as = MIDI_TIMPANI, .channel = 2});
    reported("1 of 1 notes for timpani are played");
    reported("1 note is of another instrument");
    tearDown();
    import(&b, &(midi_options){.as = MIDI_DRUMS, .as_key = 38, .track = 1});
    TEST_ASSERT_EQUAL_STRING("snare", score->strokes[1].drum);
    tearDown();
    TEST_ASSERT_FALSE(himc_midi_import(&made, b.bytes, b.size, "x",
                                       &(midi_options){.as = MIDI_TIMPANI, .track = 2}, &error));
}

static void test_a_track_named_timpani_may_be_on_the_drum_channel(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xff, 3, 7, 'T', 'i', 'm', 'p', 'a', 'n', 'i');
    event(&b, 0, 0x99, 45, 80);
    event(&b, QUARTER, 0x89, 45, 0);
    end(&b);
    import(&b, NULL);
    reported("1 of 1 notes for timpani are played");
}

static void test_bars_are_counted_by_the_meter(void)
{
    builder b;
    begin(&b);
    PUT(&b, 0, 0xff, 0x58, 4, 3, 2, 24, 8); // 3/4
    PUT(&b, 0, 0xc2, 47);
    for (int i = 0; i < 2; i++) {
        event(&b, 0, 0x92, 45, 80);
        event(&b, 3 * QUARTER, 0x82, 45, 0);
    }
    end(&b);
    import(&b, NULL);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, "comment bar 2;\nstroke 5 "), made.text);
    // one within a bar begins another
    midi_file file;
    begin(&b);
    event(&b, 0, 0x99, 38, 80);
    PUT(&b, QUARTER, 0xff, 0x58, 4, 3, 2, 24, 8);
    event(&b, 8 * QUARTER, 0x99, 38, 80);
    end(&b);
    TEST_ASSERT_TRUE_MESSAGE(himc_midi_file_read(&file, b.bytes, b.size, &error), error.text);
    for (int i = 0; i < 3; i++)
        TEST_ASSERT_EQUAL_DOUBLE(i ? 3 * i - 2 : 0, file.bars[i].beat);
    himc_midi_file_free(&file);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_reader_finds_the_notes_that_mido_finds);
    RUN_TEST(test_tracks_of_format_2_follow_each_other);
    RUN_TEST(test_a_last_track_without_a_byte_is_a_track);
    RUN_TEST(test_a_note_ends_at_its_note_off_or_with_the_file);
    RUN_TEST(test_a_file_cut_anywhere_is_read_up_to_there_or_refused_in_a_line);
    RUN_TEST(test_a_bad_file_is_refused_in_one_line);
    RUN_TEST(test_velocities_become_dynamics_by_both_curves);
    RUN_TEST(test_strokes_keep_the_times_of_their_notes_through_a_tempo_map);
    RUN_TEST(test_two_pitches_are_two_drums_and_no_pedal_moves);
    RUN_TEST(test_five_pitches_are_played_on_four_drums_by_a_pedal);
    RUN_TEST(test_a_pedal_glides_between_two_pitches);
    RUN_TEST(test_a_pitch_that_no_pedal_reaches_in_time_is_reported);
    RUN_TEST(test_a_note_that_ends_well_before_the_next_is_damped);
    RUN_TEST(test_pitches_outside_the_timpani_are_moved_by_octaves);
    RUN_TEST(test_one_drum_is_played_hand_by_hand);
    RUN_TEST(test_fast_repeats_of_a_timpano_are_rolls);
    RUN_TEST(test_slower_fewer_or_shared_strokes_and_drum_fills_are_no_rolls);
    RUN_TEST(test_16ths_over_four_drums_are_played_without_crossing);
    RUN_TEST(test_a_roll_goes_on_to_a_stroke_on_another_drum);
    RUN_TEST(test_a_long_note_after_fast_ones_is_their_aim);
    RUN_TEST(test_fast_strokes_of_two_drums_at_the_same_times_are_a_roll_on_both);
    RUN_TEST(test_two_drums_in_the_middle_are_played_by_sides);
    RUN_TEST(test_outer_drums_are_played_by_the_hand_of_their_side);
    RUN_TEST(test_what_two_hands_cannot_play_is_reported);
    RUN_TEST(test_feet_play_their_pedals);
    RUN_TEST(test_every_key_is_played_or_told);
    RUN_TEST(test_drums_are_played_on_a_set_up);
    RUN_TEST(test_keyboards_are_played_on_their_bars);
    RUN_TEST(test_tubular_bells_hang_where_the_set_up_has_them);
    RUN_TEST(test_the_loud_notes_of_a_chord_are_played);
    RUN_TEST(test_the_part_is_chosen);
    RUN_TEST(test_a_program_changes_the_instrument);
    RUN_TEST(test_tracks_of_one_player_are_played_together);
    RUN_TEST(test_a_name_stays_one_comment);
    RUN_TEST(test_a_tempo_that_scores_do_not_have_leaves_the_times);
    RUN_TEST(test_score_file_loads_midi_and_keeps_its_report);
    RUN_TEST(test_a_midi_file_outside_the_folder_is_refused);
    RUN_TEST(test_volume_and_expression_scale_velocities);
    RUN_TEST(test_a_swell_on_a_held_note_is_the_crescendo_of_a_roll);
    RUN_TEST(test_pressure_swells_and_a_fading_note_is_a_stroke);
    RUN_TEST(test_a_held_pedal_lets_notes_ring);
    RUN_TEST(test_a_cut_file_is_refused_with_how_far_it_was_read);
    RUN_TEST(test_32nds_at_8_a_second_are_a_roll);
    RUN_TEST(test_tracks_channels_and_instruments_can_be_asked_for);
    RUN_TEST(test_a_track_named_timpani_may_be_on_the_drum_channel);
    RUN_TEST(test_bars_are_counted_by_the_meter);
    return UNITY_END();
}
