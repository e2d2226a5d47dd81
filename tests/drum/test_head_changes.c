/// Heads that change at beats of a score: pedals and damping, `at BEAT DRUM COMMAND`.
#include "session.h"

#include "allocations.h"
#include "drum/membrane_config.h"
#include "himc/membrane.h"

#include <math.h>

#define SCORE "build/head-changes.txt"
#define DUMP "build/head-changes-dump.txt"
#define DRUM "drum low 26; low tune A2; tempo 120; "
#define STROKES "stroke 1 right legato f; stroke 3 left legato f; stroke 5.5 right legato f; "

static void load(himc_performance *p, const char *text)
{
    session_score(p, SCORE, text);
}

static himc_performance *with_score(const char *text)
{
    himc_performance *p = session_new();
    load(p, text);
    return p;
}

static himc_membrane *head(himc_performance *p, int drum)
{
    return himc_drum_membrane(himc_performance_drum(p, drum));
}

static double pitch(himc_performance *p)
{
    return himc_membrane_principal(head(p, 0), himc_membrane_head(head(p, 0)));
}

static double damping(himc_performance *p)
{
    return himc_membrane_head(head(p, 0))->damp;
}

#define A2 110.0
#define D3 146.832

static void test_a_pedal_and_a_hand_act_on_their_beats(void)
{
    himc_performance *p = with_score(DRUM "at 4 low tune D3; at 2 low damp 1; at 2.5 low damp 0; "
                                          "at 4 low damp 0.5; " STROKES "play;");
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    session_play(p, 0.99, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_play(p, 0.02, NULL); // beat 2 is at 1 s
    TEST_ASSERT_EQUAL_DOUBLE(1, damping(p));
    session_play(p, 0.25, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    session_play(p, 0.75, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, damping(p)); // both lines of the beat
    himc_performance_free(p);
}

static void read_all(himc_performance *p, double *sound, long from, long to)
{
    for (long at = from; at < to; at += 480) {
        himc_performance_process(p, 480, NULL);
        himc_drum_read(himc_performance_drum(p, 0), (uint64_t)at, 480, sound + at, NULL);
    }
}

// the head prepared ahead sounds as one that a command makes at that moment, to the last bit
// of the sound of the stroke at beat 2 (1 s)
static double peak_with(const char *change)
{
    char text[300];
    double sound[4800], most = 0;
    snprintf(text, sizeof text, DRUM "stroke 0 left legato mf; stroke 2 right legato mf; %s play;",
             change);
    himc_performance *p = with_score(text);
    himc_drum *drum = himc_performance_drum(p, 0);
    session_play(p, 0.99, NULL);
    session_play(p, 0.1, NULL);
    himc_drum_read(drum, himc_drum_time(drum) - 4800, 4800, sound, NULL);
    for (int i = 0; i < 4800; i++)
        most = fmax(most, fabs(sound[i]));
    himc_performance_free(p);
    return most;
}

static void test_a_pedal_that_moves_while_the_stick_is_on_the_head_does_not_pluck_it(void)
{
    static const char *const changes[] = {"at 2 low tune G2;", "at 2.004 low tune G2;",
                                          "at 2.01 low tune E2;", "at 2 low tune C3;"};
    double alone = peak_with("");
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0.7, 0, 20 * log10(peak_with(changes[i]) / alone)); // dB
}

static void test_a_score_changes_the_surface_of_a_drum_that_is_there(void)
{
    himc_performance *p = with_score(DRUM STROKES);
    load(p, "drum low 26; low shape rectangle 0.4 0.6; " STROKES);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, himc_drum_head_frame(himc_performance_drum(p, 0))->width);
    himc_performance_free(p);
}

static void test_a_change_sounds_as_the_command_given_then(void)
{
    enum { LENGTH = 3 * 48000, AT = 48000 }; // beat 2 at 120 per minute
    static double written[LENGTH], given[LENGTH];
    himc_performance *p = with_score(DRUM "at 2 low tune C3; " STROKES "play;");
    read_all(p, written, 0, LENGTH);
    himc_performance_free(p);
    p = with_score(DRUM STROKES "play;");
    read_all(p, given, 0, AT);
    session_drum(p, 0, "tune C3");
    read_all(p, given, AT, LENGTH);
    himc_performance_free(p);
    TEST_ASSERT_EQUAL_MEMORY(given, written, sizeof given);
    double most = 0;
    for (int i = AT + 1000; i < AT + 2000; i++)
        most = fmax(most, fabs(given[i]));
    TEST_ASSERT_TRUE(most > 1e-3); // it rang
}

static void test_changes_need_no_memory_and_follow_the_transport(void)
{
    himc_performance *p =
        with_score(DRUM "at 1.5 low tune D3; at 2 low damp 1; " STROKES "loop 1; play;");
    session_play(p, 0.5, NULL);
    watch_allocations();
    session_play(p, 1.0, NULL);
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(1, damping(p));
    session_play(p, 2.0, NULL); // a round is 6 beats, 3 s
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_do(p, "seek 1.75");
    session_play(p, 0.1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_do(p, "stop");
    session_play(p, 2.0, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p)); // beat 2 was not played
    himc_performance_free(p);
}

// the listener came after the score: the heads made ahead do not fit, and are computed then
static void test_changes_act_on_a_drum_that_has_changed_meanwhile(void)
{
    himc_performance *p = with_score(DRUM "at 2 low tune D3; " STROKES);
    session_do(p, "listener 2 0 1.4");
    session_drum(p, 0, "pickups 2");
    session_do(p, "play");
    session_play(p, 1.1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    int pickups;
    himc_membrane_pickups(head(p, 0), &pickups);
    TEST_ASSERT_EQUAL_INT(2, pickups);
    himc_performance_free(p);
}

static void test_a_queued_score_changes_heads_from_its_own_beats_on(void)
{
    himc_performance *p =
        with_score(DRUM "at 1 low tune D3; at 3 low tune C3; stroke 1 right legato f; "
                        "stroke 3.5 left legato f; play;"); // 4 beats: 2 s
    session_play(p, 0.6, NULL);
    load(p, "at 1 low tune E3; stroke 1 right legato f; stroke 3 left legato f;");
    session_play(p, 0.2, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    session_play(p, 1.0, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.813, pitch(p));
    session_play(p, 1.5, NULL); // past beat 1 of the second at its tempo of 100
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 164.814, pitch(p));
    session_do(p, "seek 3.2"); // back into the first, where it was when it ended
    session_play(p, 0.1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.813, pitch(p));
    himc_performance_free(p);
}

static void test_clear_and_another_score_end_the_changes(void)
{
    for (int other = 0; other < 2; other++) {
        himc_performance *p = with_score(DRUM "at 1 low tune D3; stroke 1 right legato f;");
        if (other)
            load(p, "stroke 2 right legato f;");
        else
            session_do(p, "clear");
        session_do(p, "stroke 3 left legato f");
        session_do(p, "play");
        session_play(p, 1.5, NULL);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
        himc_performance_free(p);
    }
}

static void refused(const char *text, const char *expected)
{
    himc_performance *p = session_new();
    FILE *file = fopen(SCORE, "w");
    fputs(text, file);
    fclose(file);
    TEST_ASSERT_FALSE(session_try(p, "score " SCORE));
    TEST_ASSERT_EQUAL_STRING(expected, error.text);
    TEST_ASSERT_NULL(himc_performance_drum(p, 0)); // and nothing was done
    himc_performance_free(p);
}

static void test_a_wrong_change_is_refused_with_its_line(void)
{
    refused(
        "drum low;\nat 2 low mallet hard;", SCORE
        ":2: at: mallet, expected a command that changes a drumhead: tune, gliss, tension, damp, muffle, decay, glide");
    refused("drum low;\n\nat 2 low tune;",
            SCORE ":3: low: tune: HZ missing, expected tune HZ | NOTE");
    refused("drum low;\nat -1 low tune A2;", SCORE ":2: at: BEAT: -1, expected 0 .. 1e+06");
    refused("drum low;\nat low tune A2;", SCORE ":2: at: BEAT: low, expected 0 .. 1e+06");
    refused("drum low;\nat 2 low;",
            SCORE ":2: at: COMMAND missing, expected at BEAT DRUM COMMAND [...] | BEAT push "
                  "SEGMENT [...]");
    refused("drum low 60;\nat 7 low damp 1; at 8 low tune 2000;",
            SCORE ":2: low: tune: 2000 Hz, expected 2.58125 .. 215.288 Hz");
}

// a final damping, a final glissando
static void test_changes_after_the_last_stroke_act_and_end_the_piece(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = with_score(DRUM "stroke 1 right legato f; at 4.5 low damp 1; "
                                          "at 6 low tune D3; play;");
    session_play(p, 2.9, &h); // beat 6 is at 3 s
    TEST_ASSERT_EQUAL_DOUBLE(1, damping(p));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    TEST_ASSERT_EQUAL_INT(0, h.dones);
    session_play(p, 0.2, &h);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    session_do(p, "play"); // from the beginning
    session_play(p, 0.1, &h);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    heard_free(&h);
    himc_performance_free(p);
}

// in any order, while it plays or before, it is the same as in a file
static void test_at_as_a_message_makes_the_score_that_a_file_makes(void)
{
    enum { LENGTH = 4 * 48000 };
    static double written[LENGTH], said[LENGTH];
    for (int playing = 0; playing < 2; playing++) {
        himc_performance *p = with_score(DRUM STROKES "at 2 low tune D3; at 3 low damp 0.5; "
                                                      "at 3.5 low tune C3; at 7 low damp 1; play;");
        read_all(p, written, 0, LENGTH);
        himc_performance_free(p);
        p = with_score(DRUM STROKES);
        if (playing)
            session_do(p, "play");
        session_do(p, "at 7 low damp 1");
        session_do(p, "at 3 low damp 0.5");
        session_do(p, "at 2 low tune D3");
        if (!playing)
            session_do(p, "play");
        read_all(p, said, 0, 24000);
        session_do(p, "at 3.5 low tune C3");
        read_all(p, said, 24000, LENGTH);
        TEST_ASSERT_EQUAL_MEMORY(written, said, sizeof said);
        himc_performance_free(p);
    }
}

static void test_at_is_given_up_when_its_beat_is_past(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = with_score(DRUM STROKES "play;");
    session_play(p, 1.5, &h);
    session_do(p, "at 2 low tune D3");
    session_play(p, 0.1, &h);
    TEST_ASSERT_EQUAL_STRING("at 2 low tune: given up, that beat is past", h.note);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    session_do(p, "stop");
    session_do(p, "loop 1"); // where it comes again
    session_do(p, "play");
    session_play(p, 0.5, &h);
    session_do(p, "seek 4");
    session_play(p, 0.5, &h);
    session_do(p, "at 2 low tune D3");
    session_play(p, 0.1, &h);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    session_do(p, "seek 2.5");
    session_play(p, 0.1, &h);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    heard_free(&h);
    himc_performance_free(p);
}

static void test_at_as_a_message_is_refused_as_in_a_file(void)
{
    himc_performance *p = with_score(DRUM STROKES);
    TEST_ASSERT_FALSE(session_try(p, "at 2 high tune D3"));
    TEST_ASSERT_EQUAL_STRING("high: no drum (low)", error.text);
    TEST_ASSERT_FALSE(session_try(p, "at 2 low mallet hard"));
    TEST_ASSERT_EQUAL_STRING(
        "at: mallet, expected a command that changes a drumhead: tune, gliss, tension, damp, muffle, decay, glide",
        error.text);
    TEST_ASSERT_FALSE(session_try(p, "at 2 low tune"));
    TEST_ASSERT_EQUAL_STRING("low: tune: HZ missing, expected tune HZ | NOTE", error.text);
    TEST_ASSERT_FALSE(session_try(p, "at 2 low tune 1900"));
    TEST_ASSERT_EQUAL_STRING("low: tune: 1900 Hz, expected 7.75676 .. 581.205 Hz", error.text);
    session_do(p, "at 2 low tune D3"); // the refused ones have left nothing
    session_do(p, "play");
    session_play(p, 1.2, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    himc_performance_free(p);
}

// also of a drum whose name is a command of drums
static void test_a_drums_command_finds_it_by_its_name(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum low 26");
    session_do(p, "drum kettle 23");
    session_do(p, "low tune A2");
    session_do(p, "kettle tune D3");
    session_do(p, "low damp 0.5");
    TEST_ASSERT_DOUBLE_WITHIN(0.01, A2, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, damping(p));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3,
                              himc_membrane_principal(head(p, 1), himc_membrane_head(head(p, 1))));
    TEST_ASSERT_FALSE(session_try(p, "high tune A2"));
    TEST_ASSERT_EQUAL_STRING("high: no drum (low kettle)", error.text);
    TEST_ASSERT_FALSE(session_try(p, "low tune 1"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "low: tune: "));
    TEST_ASSERT_FALSE(session_try(p, "drum stop"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "drum: NAME: stop"));
    TEST_ASSERT_FALSE(session_try(p, "stop tune A2")); // the transport's
    himc_performance_free(p);
}

// all that a person may set beside damping
static const char *const by_hand[] = {
    "modes 50", "radius 0.25", "tune A2", "tension 2500", "decay 0.5",
    "glide 0",  "density 0.3", "air 0",   "kettle 0.1",   "uniformity 0.5 7"};
#define BY_HAND ((int)(sizeof by_hand / sizeof *by_hand))
#define SLOW "drum low 26; tempo 60; stroke 1 right legato f; stroke 4 left legato f; "

// the same with a line that damps nothing and without it, whenever the drum was changed
static void test_a_change_touches_only_what_it_names(void)
{
    enum { LENGTH = 5 * 48000, EDIT = 48000 };
    static double sound[2][LENGTH];
    for (int i = 0; i < 2 * BY_HAND; i++) {
        himc_head after[2];
        bool before_play = i >= BY_HAND;
        if (!getenv("HIMC_LONG") && before_play == i % 2) // everyday each at one of the two times
            continue;
        const char *text = by_hand[i % BY_HAND];
        for (int k = 0; k < 2; k++) {
            himc_performance *p = with_score(k ? SLOW : SLOW "at 2 low damp 0;");
            himc_head was = *himc_membrane_head(head(p, 0));
            if (before_play)
                session_drum(p, 0, text);
            session_do(p, "play");
            read_all(p, sound[k], 0, EDIT);
            if (!before_play)
                session_drum(p, 0, text);
            read_all(p, sound[k], EDIT, LENGTH);
            after[k] = *himc_membrane_head(head(p, 0));
            TEST_ASSERT_FALSE_MESSAGE(himc_head_equal(&was, &after[k]), text);
            himc_performance_free(p);
        }
        TEST_ASSERT_TRUE_MESSAGE(himc_head_equal(&after[0], &after[1]), text);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(sound[1], sound[0], sizeof sound[0], text);
    }
}

// what is set by hand and what is written may come in any order, before the piece begins
static void test_a_change_and_a_command_may_come_in_any_order(void)
{
    enum { LENGTH = 5 * 48000 };
    static double sound[3][LENGTH];
    static const char *const at[] = {"at 2 low tune C3", "at 2 low damp 0.5", "at 2 low glide 0"};
    for (int i = 0; i < BY_HAND; i++) {
        // everyday at one of the two later places
        for (int k = 0; k < 3; k += getenv("HIMC_LONG") ? 1 : k > 0 ? 3 : 1 + i % 2) {
            himc_performance *p = with_score(SLOW);
            for (int line = 0; line < 4; line++)
                if (line == k)
                    session_drum(p, 0, by_hand[i]);
                else
                    session_do(p, "%s", at[line - (line > k)]);
            session_do(p, "play");
            read_all(p, sound[k], 0, LENGTH);
            himc_performance_free(p);
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(sound[0], sound[k], sizeof sound[k], by_hand[i]);
        }
    }
}

// a note at a beat is that note on the head that the drum has then; without memory
static void test_a_change_is_tuned_on_the_head_as_it_was_changed(void)
{
    himc_performance *p = with_score(SLOW "at 1.5 low damp 0.5; at 2 low tune D3; play;");
    session_play(p, 1, NULL);
    session_drum(p, 0, "radius 0.28");
    watch_allocations();
    session_play(p, 1.2, NULL);
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, damping(p));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.28, himc_membrane_head(head(p, 0))->radius);
    himc_performance_free(p);
}

static void test_a_note_that_a_changed_head_cannot_have_is_left_out_and_told(void)
{
    heard h = {.strikes = 0};
    himc_performance *p = with_score(SLOW "at 2 low tune 500; at 2 low damp 0.5; play;");
    session_play(p, 1, &h);
    session_drum(p, 0, "radius 0.6");
    double before = pitch(p);
    session_play(p, 1.2, &h);
    TEST_ASSERT_EQUAL_DOUBLE(before, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, damping(p));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(h.note, "at: low tune: 500 Hz, expected "), h.note);
    heard_free(&h);
    himc_performance_free(p);
}

// in a loop, too: what is set by hand stays up to the line that sets the same
static void test_a_loop_keeps_what_was_set_by_hand(void)
{
    himc_performance *p =
        with_score(DRUM "at 2 low tune D3; at 3 low damp 0.5; " STROKES "loop 1; play;");
    session_play(p, 1.2, NULL); // beat 2 is at 1 s
    session_drum(p, 0, "tune C3");
    session_drum(p, 0, "decay 0.5");
    himc_head set = *himc_membrane_head(head(p, 0));
    session_play(p, 0.5, NULL); // past beat 3
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.813, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, damping(p));
    session_play(p, 1.8, NULL); // a round is 3 s
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.813, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
    session_play(p, 0.6, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, D3, pitch(p));
    TEST_ASSERT_EQUAL_DOUBLE(set.decay_constant, himc_membrane_head(head(p, 0))->decay_constant);
    himc_performance_free(p);
}

// on that beat the next round begins: it acts there, up to a line that sets the same
static void test_a_change_where_a_loop_begins_again_acts_in_each_later_round(void)
{
    for (int again = 0; again < 2; again++) { // also on beat 0, which comes after it
        himc_performance *p =
            with_score(again ? DRUM "at 0 low tune A2; at 2 low damp 1; at 3 low damp 0; "
                                    "at 4 low tune C3; at 6 low tune D3; " STROKES "loop 1; play;"
                             : DRUM "at 2 low damp 1; at 3 low damp 0; at 4 low tune C3; "
                                    "at 6 low tune D3; " STROKES "loop 1; play;");
        for (int play = 0; play < 2; play++) {
            for (int round = 0; round < 3; round++) {
                double first = round == 0 || again ? A2 : D3;
                session_play(p, 0.25, NULL); // beat 0.5
                TEST_ASSERT_DOUBLE_WITHIN(0.01, first, pitch(p));
                TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
                session_play(p, 1, NULL); // 2.5
                TEST_ASSERT_DOUBLE_WITHIN(0.01, first, pitch(p));
                TEST_ASSERT_EQUAL_DOUBLE(1, damping(p));
                session_play(p, 1, NULL); // 4.5
                TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.813, pitch(p));
                TEST_ASSERT_EQUAL_DOUBLE(0, damping(p));
                watch_allocations();
                session_play(p, 0.75, NULL);
                TEST_ASSERT_EQUAL_INT(0, allocations_seen());
            }
            session_do(p, "stop");
            session_do(p, "seek 0");
            session_play(p, 1, NULL);
            session_do(p, "play");
        }
        himc_performance_free(p);
    }
}

static void test_a_dump_with_changes_and_a_changed_drum_plays_the_same(void)
{
    enum { LENGTH = 5 * 48000 };
    static double first[LENGTH], again[LENGTH];
    himc_performance *p = with_score(SLOW "at 2 low tune C3; at 3 low damp 0.5;");
    session_drum(p, 0, "modes 300");
    session_drum(p, 0, "decay 0.5");
    session_do(p, "dump " DUMP);
    session_do(p, "play");
    read_all(p, first, 0, LENGTH);
    himc_performance_free(p);
    p = session_new();
    session_do(p, "score " DUMP);
    session_do(p, "play");
    read_all(p, again, 0, LENGTH);
    himc_performance_free(p);
    TEST_ASSERT_EQUAL_MEMORY(first, again, sizeof first);
    TEST_ASSERT_TRUE(fabs(first[48000 + 5000]) > 1e-6); // it rang
}

static void dump_of(himc_performance *p, char *text, size_t size)
{
    session_do(p, "dump " DUMP);
    FILE *file = fopen(DUMP, "r");
    TEST_ASSERT_NOT_NULL(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

// the changes are in the score: the head they gave is not told once more as the drum's own
static void test_a_piece_is_the_same_in_a_dump_after_it_was_played(void)
{
    static char before[8192], after[8192];
    himc_performance *p = with_score(DRUM "at 0 low damp 1; at 1 low tune D3; at 3 low damp 0.5; "
                                          "at 4 low tune C3; " STROKES);
    for (int edits = 0; edits < 2; edits++) { // what is set by hand meanwhile is told
        if (edits)
            session_drum(p, 0, "decay 0.5");
        dump_of(p, before, sizeof before);
        session_do(p, "play");
        for (int k = 0; k < 5; k++) {
            session_play(p, 1.1, NULL);
            dump_of(p, after, sizeof after);
            TEST_ASSERT_EQUAL_STRING(before, after);
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.813, pitch(p)); // it was moved
    }
    session_drum(p, 0, "glide 0.2");
    dump_of(p, after, sizeof after);
    TEST_ASSERT_NOT_NULL(strstr(after, "low glide 0.2;"));
    session_do(p, "clear"); // without its score the drum stays as it is
    dump_of(p, after, sizeof after);
    TEST_ASSERT_NOT_NULL(strstr(after, "low damp 0.5;"));
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_changes_after_the_last_stroke_act_and_end_the_piece);
    RUN_TEST(test_a_piece_is_the_same_in_a_dump_after_it_was_played);
    RUN_TEST(test_at_as_a_message_makes_the_score_that_a_file_makes);
    RUN_TEST(test_at_is_given_up_when_its_beat_is_past);
    RUN_TEST(test_at_as_a_message_is_refused_as_in_a_file);
    RUN_TEST(test_a_drums_command_finds_it_by_its_name);
    RUN_TEST(test_a_pedal_and_a_hand_act_on_their_beats);
    RUN_TEST(test_a_pedal_that_moves_while_the_stick_is_on_the_head_does_not_pluck_it);
    RUN_TEST(test_a_score_changes_the_surface_of_a_drum_that_is_there);
    RUN_TEST(test_a_change_sounds_as_the_command_given_then);
    RUN_TEST(test_changes_need_no_memory_and_follow_the_transport);
    RUN_TEST(test_changes_act_on_a_drum_that_has_changed_meanwhile);
    RUN_TEST(test_a_queued_score_changes_heads_from_its_own_beats_on);
    RUN_TEST(test_clear_and_another_score_end_the_changes);
    RUN_TEST(test_a_wrong_change_is_refused_with_its_line);
    RUN_TEST(test_a_change_touches_only_what_it_names);
    RUN_TEST(test_a_change_and_a_command_may_come_in_any_order);
    RUN_TEST(test_a_change_is_tuned_on_the_head_as_it_was_changed);
    RUN_TEST(test_a_note_that_a_changed_head_cannot_have_is_left_out_and_told);
    RUN_TEST(test_a_loop_keeps_what_was_set_by_hand);
    RUN_TEST(test_a_change_where_a_loop_begins_again_acts_in_each_later_round);
    RUN_TEST(test_a_dump_with_changes_and_a_changed_drum_plays_the_same);
    return UNITY_END();
}
