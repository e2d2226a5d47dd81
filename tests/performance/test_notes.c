/// test_notes.c: what a musician sends while it plays: MIDI notes, ramps of tempo and dynamics,
/// beats that repeat, and what is told of all that.
#include "session.h"

#include <math.h>

static himc_performance *four_timpani(void)
{
    himc_performance *p = session_new();
    session_do(p, "setup timpani");
    return p;
}

static void test_a_note_plays_the_drum_that_sounds_it(void)
{
    static const struct {
        int key;
        const char *drum;
    } notes[] = {{45, "second"}, {40, "low"}, {55, "high"}, {50, "third"}, {90, "high"}, {46, "second"}};
    himc_performance *p = four_timpani();
    heard h = {0};
    for (int i = 0; i < 6; i++) {
        session_do(p, "note %d 96", notes[i].key);
        session_play(p, 0.7, &h);
        session_do(p, "note %d 0", notes[i].key);
        TEST_ASSERT_EQUAL_INT(i + 1, h.strikes);
        TEST_ASSERT_EQUAL_STRING(notes[i].drum, h.strike[i].drum);
        TEST_ASSERT_DOUBLE_WITHIN(0.06, 0.7 * i + 0.15, h.strike[i].time); // a leap takes longer
    }
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_louder_velocity_is_a_harder_stroke(void)
{
    double last = 0;
    for (int velocity = 30; velocity <= 120; velocity += 30) {
        himc_performance *p = four_timpani();
        heard h = {0};
        session_do(p, "latency auto");
        session_do(p, "note 45 %d", velocity);
        session_play(p, 1, &h);
        TEST_ASSERT_EQUAL_INT(1, h.strikes);
        TEST_ASSERT_TRUE(h.strike[0].velocity > 1.2 * last);
        last = h.strike[0].velocity;
        heard_free(&h);
        himc_performance_free(p);
    }
}

static void test_keys_of_a_kit_are_those_of_general_midi(void)
{
    static const struct {
        int key;
        const char *drum, *nuance;
    } notes[] = {{36, "kick", "legato"}, {38, "snare", "accent"}, {42, "hats", "legato"}, {49, "crash", "legato"}};
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "setup kit");
    for (int i = 0; i < 4; i++) {
        session_do(p, "note %d 90 %s", notes[i].key, notes[i].nuance);
        session_play(p, 0.8, &h);
        TEST_ASSERT_TRUE(h.strikes > i);
        TEST_ASSERT_EQUAL_STRING(notes[i].drum, h.strike[h.strikes - 1].drum);
        TEST_ASSERT_EQUAL_STRING(notes[i].nuance, h.strike[h.strikes - 1].nuance);
    }
    TEST_ASSERT_FALSE(session_try(p, "note 54 90"));
    TEST_ASSERT_EQUAL_STRING("note: 54, tambourine: no drum has that pitch, no instrument that key",
                             error.text);
    TEST_ASSERT_TRUE(session_try(p, "note 54 0"));
    TEST_ASSERT_FALSE(session_try(p, "note 128 90"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "PITCH: 128"));
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_note_on_a_marimba_lands_on_its_bar(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "setup marimba");
    for (int key = 60; key < 63; key++) { // C4 C#4 D4, from left to right
        session_do(p, "note %d 90", key);
        session_play(p, 0.8, &h);
    }
    TEST_ASSERT_EQUAL_INT(3, h.strikes);
    TEST_ASSERT_TRUE(h.strike[0].y > h.strike[1].y && h.strike[1].y > h.strike[2].y);
    TEST_ASSERT_TRUE(h.strike[1].x > h.strike[0].x + 0.05); // the raised row is behind
    heard_free(&h);
    himc_performance_free(p);
}

// energy of the second drum's sound in a tenth of a second (squares)
static double sound_of(himc_performance *p)
{
    static double sound[4800];
    double sum = 0;
    himc_drum *drum = himc_performance_drum(p, 1);
    himc_drum_read(drum, himc_drum_time(drum) - 4800, 4800, sound, NULL);
    for (int i = 0; i < 4800; i++)
        sum += sound[i] * sound[i];
    return sum;
}

static void test_the_end_of_a_note_damps_its_drum_where_that_is_asked_for(void)
{
    double rung[2], damped[2], again[2];
    for (int damps = 0; damps < 2; damps++) {
        himc_performance *p = four_timpani();
        session_do(p, "noteoff %s", damps ? "damp" : "ring");
        session_do(p, "note 45 90");
        session_play(p, 0.5, NULL);
        rung[damps] = sound_of(p);
        session_do(p, "note 45 0"); // 150 ms later, as the stroke
        session_play(p, 0.1, NULL);
        TEST_ASSERT_TRUE(sound_of(p) > 0.3 * rung[damps]);
        session_play(p, 0.3, NULL);
        damped[damps] = sound_of(p);
        session_do(p, "note 45 90");
        session_play(p, 0.5, NULL);
        again[damps] = sound_of(p);
        himc_performance_free(p);
    }
    TEST_ASSERT_TRUE(damped[0] > 0.01 * rung[0]);
    TEST_ASSERT_TRUE(damped[1] < 1e-6 * rung[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 1, again[1] / rung[1]);
}

// times of n strokes, a beat apart, with these commands before and after `play`
static void play_beats(int n, const char *before, const char *after, double seconds, heard *h)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "tempo 60");
    for (int i = 0; i < n; i++)
        session_do(p, "stroke %d right legato mf", i);
    if (before)
        session_do(p, "%s", before);
    session_do(p, "play");
    session_play(p, 1.5, h);
    if (after)
        session_do(p, "%s", after);
    session_play(p, seconds - 1.5, h);
    himc_performance_free(p);
}

// s from the beginning of a ramp over 8 beats from 60 to 120 beats a minute
static double ramp(double beat)
{
    return beat < 8 ? 8 * log(1 + beat / 8) : 8 * log(2) + 0.5 * (beat - 8);
}

static void test_a_ramp_of_tempo_is_even_and_strokes_land_on_its_beats(void)
{
    heard h = {0};
    play_beats(13, "tempo 60 120 8", NULL, 9, &h);
    TEST_ASSERT_EQUAL_INT(13, h.strikes);
    for (int i = 1; i < 13; i++)
        TEST_ASSERT_DOUBLE_WITHIN(0.002, ramp(i) - ramp(i - 1), h.strike[i].time - h.strike[i - 1].time);
    heard_free(&h);
    play_beats(13, "tempo 60 120 8 2", NULL, 11, &h);
    TEST_ASSERT_EQUAL_INT(13, h.strikes);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 2 + ramp(10), h.strike[12].time - h.strike[0].time);
    heard_free(&h);
}

static void test_a_ramp_while_it_plays_ends_at_its_tempo_also_in_a_loop(void)
{
    for (int loops = 0; loops < 2; loops++) {
        heard h = {0};
        play_beats(loops ? 2 : 30, loops ? "loop 1" : NULL, "tempo 60 120 4", 9, &h);
        int last = h.strikes - 1;
        TEST_ASSERT_TRUE(last > 10);
        for (int i = last - 4; i <= last; i++)
            TEST_ASSERT_DOUBLE_WITHIN(0.003, 0.5, h.strike[i].time - h.strike[i - 1].time);
        for (int i = 2; i <= last; i++) // it never goes back
            TEST_ASSERT_TRUE(h.strike[i].time - h.strike[i - 1].time <
                             h.strike[i - 1].time - h.strike[i - 2].time + 0.003);
        heard_free(&h);
    }
}

static void test_beats_that_repeat_are_equal_strokes(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "drum kettle");
    session_do(p, "tempo 120");
    for (int i = 0; i < 16; i++)
        session_do(p, "stroke %g %s %s %s", 0.5 * i, i % 2 ? "left" : "right",
                   i % 3 ? "legato" : "accent", i < 4 || i > 11 ? "ff" : i % 2 ? "p" : "mf");
    session_do(p, "roll 12 1 single p");
    session_do(p, "loop 2 4");
    session_do(p, "play");
    session_play(p, 8, &h);
    TEST_ASSERT_GREATER_OR_EQUAL_INT(24, h.strikes);
    for (int i = 8; i < h.strikes; i++) { // the first four strokes are before the loop
        TEST_ASSERT_TRUE(h.strike[i].beat >= 2 && h.strike[i].beat < 4);
        TEST_ASSERT_EQUAL_DOUBLE(h.strike[i - 4].beat, h.strike[i].beat);
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 1, h.strike[i].time - h.strike[i - 4].time);
        TEST_ASSERT_DOUBLE_WITHIN(0.06 * h.strike[i].velocity, h.strike[i - 4].velocity,
                                  h.strike[i].velocity);
    }
    session_do(p, "loop 0"); // the rest of the score
    int before = h.strikes;
    session_play(p, 8, &h);
    TEST_ASSERT_TRUE(h.strike[h.strikes - 1].beat > 12);
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    for (int i = before; i < h.strikes && h.strike[i].beat < 8; i++)
        TEST_ASSERT_TRUE(i == before || h.strike[i].beat <= 4 || h.strike[i].beat == h.strike[i - 1].beat + 0.5);
    TEST_ASSERT_GREATER_THAN_INT(before + 13, h.strikes);
    TEST_ASSERT_FALSE(session_try(p, "loop 4 2"));
    TEST_ASSERT_EQUAL_STRING("loop: TO: 2 beats, expected 4.1 .. 1e+06 beats", error.text);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_note_plays_the_drum_that_sounds_it);
    RUN_TEST(test_a_louder_velocity_is_a_harder_stroke);
    RUN_TEST(test_keys_of_a_kit_are_those_of_general_midi);
    RUN_TEST(test_a_note_on_a_marimba_lands_on_its_bar);
    RUN_TEST(test_the_end_of_a_note_damps_its_drum_where_that_is_asked_for);
    RUN_TEST(test_a_ramp_of_tempo_is_even_and_strokes_land_on_its_beats);
    RUN_TEST(test_a_ramp_while_it_plays_ends_at_its_tempo_also_in_a_loop);
    RUN_TEST(test_beats_that_repeat_are_equal_strokes);
    return UNITY_END();
}
