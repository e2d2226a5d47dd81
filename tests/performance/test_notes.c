/// test_notes.c: what a musician sends while it plays: MIDI notes, ramps of tempo and dynamics,
/// beats that repeat, and what is told of all that.
#include "performance/research.h"
#include "session.h"

#include "drum/drum_performer.h"

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
    } notes[] = {{45, "second"}, {40, "low"},  {55, "high"},
                 {50, "third"},  {90, "high"}, {46, "second"}};
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
    } notes[] = {{36, "kick", "legato"},
                 {38, "snare", "accent"},
                 {42, "hats", "legato"},
                 {49, "crash", "legato"}};
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
    TEST_ASSERT_FALSE(session_try(p, "note 58 90"));
    TEST_ASSERT_EQUAL_STRING("note: 58, vibraslap: no drum has that pitch, no instrument that key",
                             error.text);
    TEST_ASSERT_TRUE(session_try(p, "note 58 0"));
    TEST_ASSERT_FALSE(session_try(p, "note 128 90"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "PITCH: 128"));
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_higher_tom_key_never_sounds_a_larger_tom(void)
{
    static const int keys[] = {41, 43, 45, 47, 48, 50};
    himc_performance *p = session_new();
    heard h = {0};
    int alike = 0;
    session_do(p, "setup kit");
    double last = INFINITY;
    for (int i = 0; i < 6; i++) {
        session_do(p, "note %d 90", keys[i]);
        session_play(p, 0.8, &h);
        TEST_ASSERT_TRUE(h.strikes > i);
        double inches = 0;
        for (int d = 0; himc_performance_drum(p, d); d++)
            if (strcmp(himc_drum_name(himc_performance_drum(p, d)), h.strike[h.strikes - 1].drum) ==
                0)
                inches = himc_drum_inches(himc_performance_drum(p, d));
        TEST_ASSERT_TRUE(inches <= last);
        alike += inches == last;
        last = inches;
    }
    TEST_ASSERT_TRUE(alike < 4); // three toms and more
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
        TEST_ASSERT_DOUBLE_WITHIN(0.002, ramp(i) - ramp(i - 1),
                                  h.strike[i].time - h.strike[i - 1].time);
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
                   i % 3 ? "legato" : "accent",
                   i < 4 || i > 11 ? "ff"
                   : i % 2         ? "p"
                                   : "mf");
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
        TEST_ASSERT_TRUE(i == before || h.strike[i].beat <= 4 ||
                         h.strike[i].beat == h.strike[i - 1].beat + 0.5);
    TEST_ASSERT_GREATER_THAN_INT(before + 13, h.strikes);
    TEST_ASSERT_FALSE(session_try(p, "loop 4 2"));
    TEST_ASSERT_EQUAL_STRING("loop: TO: 2 beats, expected 4.1 .. 1e+06 beats", error.text);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_strokes_without_a_dynamic_follow_a_crescendo(void)
{
    for (int file = 0; file < 2; file++) { // in a file it may stand behind them
        himc_performance *p = session_new();
        heard h = {0};
        char text[600] = "drum kettle; tempo 60; ";
        for (int i = 0; i < 7; i++)
            snprintf(text + strlen(text), 60, "stroke %d right legato -; ", i);
        if (file)
            session_score(
                p, "/tmp/himc-cresc.txt",
                strcat(text, "roll 8 2 single -; cresc 1 4 pp ff; cresc 8 2 f pp; play;"));
        else {
            session_do(p, "drum kettle");
            session_do(p, "tempo 60");
            session_do(p, "cresc 8 2 f pp");
            session_do(p, "cresc 1 4 pp ff");
            for (int i = 0; i < 7; i++)
                session_do(p, "stroke %d right legato -", i);
            session_do(p, "roll 8 2 single -");
            session_do(p, "play");
        }
        session_play(p, 11, &h);
        TEST_ASSERT_GREATER_THAN_INT(20, h.strikes);
        for (int i = 2; i < 6; i++)
            TEST_ASSERT_TRUE(h.strike[i].velocity > 1.2 * h.strike[i - 1].velocity);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, h.strike[5].velocity, h.strike[6].velocity); // it stays
        TEST_ASSERT_TRUE(h.strike[0].velocity > 1.5 * h.strike[1].velocity);        // mf before it
        TEST_ASSERT_TRUE(h.strike[8].velocity > 2 * h.strike[h.strikes - 1].velocity);
        TEST_ASSERT_FALSE(session_try(p, "cresc 1 4 pp -"));
        heard_free(&h);
        himc_performance_free(p);
    }
    unlink("/tmp/himc-cresc.txt");
}

// what would be mute, or not followed, is told in one line
static void test_a_command_that_comes_too_late_or_behind_the_end_says_so(void)
{
    himc_performance *p = four_timpani();
    heard h = {0};
    session_do(p, "stroke 1 right legato - low");
    session_do(p, "stroke 2 left legato - low");
    session_do(p, "cresc 3 2 p f"); // behind both
    session_play(p, 0.1, &h);
    TEST_ASSERT_EQUAL_INT(0, h.notes);
    session_do(p, "cresc 1 2 p f");
    session_play(p, 0.1, &h);
    TEST_ASSERT_EQUAL_STRING(
        "cresc: strokes up to beat 2 have their dynamics, expected cresc before them", h.note);
    session_do(p, "loop 20 24");
    session_do(p, "play");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_STRING(
        "loop: FROM: 20, nothing to play: expected 0 .. 2, the last stroke's beat", h.note);
    TEST_ASSERT_FALSE(himc_performance_load_text(p, "drum low; gliss low A2 4;", "s.txt", &error));
    TEST_ASSERT_EQUAL_STRING("s.txt:1: gliss: not allowed in a score, expected at BEAT DRUM gliss "
                             "PITCH SECONDS",
                             error.text);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_clear_while_it_plays_is_its_end(void)
{
    himc_performance *p = four_timpani();
    heard h = {0};
    session_do(p, "stroke 1 right legato f low");
    session_do(p, "stroke 9 left legato f low");
    session_do(p, "play");
    session_play(p, 3, &h);
    session_do(p, "clear");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    session_do(p, "clear");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(1, h.dones);
    heard_free(&h);
    himc_performance_free(p);
}

static void test_a_clock_that_falls_silent_leaves_its_tempo(void)
{
    himc_performance *p = four_timpani();
    double most = 0; // faster or slower: it catches up
    session_do(p, "tempo 60");
    session_do(p, "stroke 40 right legato f low");
    session_do(p, "play");
    session_play(p, 0.7, NULL);
    for (int tick = 0; tick < 10; tick++) {
        session_do(p, "clock");
        session_play(p, 0.02, NULL);
        most = fmax(most, fabs(himc_performance_measure(p).bpm - 125));
    }
    TEST_ASSERT_FALSE(session_try(p, "tempo 90"));
    TEST_ASSERT_EQUAL_STRING("tempo: a clock sets it, expected sync off before", error.text);
    TEST_ASSERT_GREATER_THAN_INT(6, (int)most);
    session_play(p, 1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 125, himc_performance_measure(p).bpm);
    session_do(p, "tempo 90");
    TEST_ASSERT_EQUAL_DOUBLE(90, himc_performance_measure(p).bpm);
    himc_performance_free(p);
}

static void test_a_gliss_takes_its_beats(void)
{
    himc_performance *p = four_timpani();
    himc_drum *low = himc_performance_drum(p, 0);
    session_do(p, "tempo 120");
    session_do(p, "gliss low A2 4"); // from E2 in 2 s
    double before = 0;
    for (int i = 0; i < 10; i++) {
        session_play(p, 0.2, NULL);
        double now = himc_drum_pitch(low);
        TEST_ASSERT_TRUE(now > before);
        before = now;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 110, before);
    session_play(p, 1, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 110, himc_drum_pitch(low));
    TEST_ASSERT_FALSE(session_try(p, "gliss middle A2 4"));
    TEST_ASSERT_FALSE(session_try(p, "gliss low A2 200"));
    himc_performance_free(p);
}

static void keep_line(void *user, const char *line)
{
    snprintf(user, 256, "%s", line);
}

static const char *get(himc_performance *p, const char *what)
{
    static char line[256];
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_get(p, what, keep_line, line, &error), error.text);
    return line;
}

static void test_every_setting_can_be_asked_for_and_answers_what_was_set(void)
{
    static const char *const set[] = {
        "latency 200",
        "tempo 87.5",
        "noteoff damp",
        "sync off",
        "subdivide 3",
        "human 0.5 7",
        "grip french servo",
        "coupling one-way",
        "mode id",
        "damping 0.25",
        "alive 1",
        "weights 1 2 3 4",
        "law feedforward",
        "room 1.5 900",
        "mute 1",
        "loop 2 6",
        "listener 1 2 0.5 0.25",
        "limits euler",
        "player 1.75 80",
        "stance seated",
    };
    himc_performance *p = four_timpani();
    for (size_t i = 0; i < sizeof set / sizeof *set; i++) {
        char word[32];
        snprintf(word, sizeof word, "%.*s", (int)strcspn(set[i], " "), set[i]);
        session_do(p, "%s", set[i]);
        TEST_ASSERT_EQUAL_STRING(set[i], get(p, word));
    }
    TEST_ASSERT_EQUAL_STRING("drums low second third high", get(p, "drums"));
    TEST_ASSERT_EQUAL_STRING("state stopped", get(p, "state"));
    // each row that sets something of the performer
#define HIMC_SETTING_ROW(ID, word, when, atoms, kind, field, usual, after, does) \
    TEST_ASSERT_NOT_EQUAL_MESSAGE(0, get(p, #word)[0], #word);
#include "himc/command_rows.h"
    himc_performance_free(p);
}

static void test_a_gesture_is_told_before_its_strike(void)
{
    himc_performance *p = four_timpani();
    himc_event event;
    double told = -1, at = 0;
    int strikes = 0;
    session_do(p, "stroke 0 right legato mf high");
    session_do(p, "stroke 2 left legato p low");
    session_do(p, "stroke 4 right accent f third");
    session_do(p, "play");
    for (int i = 0; i < 500; i++) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event)) {
            double now = himc_performance_measure(p).seconds;
            if (event.kind == HIMC_EVENT_PREPARE) {
                TEST_ASSERT_TRUE(told < 0); // once
                told = event.strike.time;
                at = now;
                TEST_ASSERT_TRUE(told - at > 0.1 && told - at < 0.8);
            }
            if (event.kind == HIMC_EVENT_STRIKE) {
                strikes++;
                TEST_ASSERT_DOUBLE_WITHIN(0.005, told, event.strike.time);
                told = -1;
            }
        }
    }
    TEST_ASSERT_EQUAL_INT(3, strikes);
    himc_performance_free(p);
}

static void test_parts_of_a_beat_are_told(void)
{
    himc_performance *p = four_timpani();
    himc_event event;
    int parts = 0;
    session_do(p, "subdivide 4");
    session_do(p, "stroke 0 right legato mf");
    session_do(p, "stroke 3 right legato mf");
    session_do(p, "play");
    for (int i = 0; i < 400; i++) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event))
            if (event.kind == HIMC_EVENT_BEAT) {
                TEST_ASSERT_EQUAL_DOUBLE(0.25 * parts, event.beat);
                parts++;
            }
    }
    TEST_ASSERT_EQUAL_INT(13, parts);
    TEST_ASSERT_FALSE(session_try(p, "subdivide 2.5"));
    himc_performance_free(p);
}

// a clock of that tempo, which begins at 0.5 s, by ticks or by the phase of a phasor, and a
// performer who plays from `play_at` (ms) on; returns the strikes and the tempo of the performer
static double follow(double bpm, bool phase, int play_at, heard *h)
{
    himc_performance *p = four_timpani();
    double tick = 60 / bpm / 24;
    himc_event event;
    int ticks = 0;
    session_do(p, phase ? "sync phase" : "sync midi");
    for (int i = 0; i < 40; i++)
        session_do(p, "stroke %d %s legato mf second", i, i % 2 ? "left" : "right");
    for (int i = 0; i < 48000 * 12 / 48; i++) { // ms by ms
        double t = i * 0.001 - 0.5;
        if (i == play_at)
            session_do(p, phase || play_at > 499 ? "play" : "clock start");
        if (t >= 0 && phase && i % 3 == 0)
            session_do(p, "clock %.7f", t * bpm / 60 - floor(t * bpm / 60));
        for (; t >= 0 && !phase && ticks * tick <= t; ticks++)
            session_do(p, "clock");
        himc_performance_process(p, 48, NULL);
        while (himc_performance_event(p, &event))
            heard_event(h, &event);
    }
    double now = himc_performance_measure(p).bpm;
    himc_performance_free(p);
    return now;
}

static void test_tempo_and_beats_follow_a_clock(void)
{
    for (int k = 0; k < 4; k++) {
        double bpm = k < 2 ? 90 : 144;
        bool phase = k % 2;
        heard h = {0};
        TEST_ASSERT_DOUBLE_WITHIN(0.5, bpm, follow(bpm, phase, 499, &h));
        TEST_ASSERT_GREATER_THAN_INT(12, h.strikes);
        for (int i = h.strikes - 8; i < h.strikes; i++) { // on the clock's beats
            double beat = (h.strike[i].time - 0.5) * bpm / 60;
            TEST_ASSERT_DOUBLE_WITHIN(0.02, phase ? round(beat) : h.strike[i].beat, beat);
        }
        heard_free(&h);
    }
}

static void test_a_performer_may_begin_while_a_clock_runs(void)
{
    heard h = {0};
    TEST_ASSERT_DOUBLE_WITHIN(1, 120, follow(120, false, 5200, &h));
    for (int i = h.strikes - 4; i < h.strikes; i++) { // on the clock's beats
        double beat = (h.strike[i].time - 0.5) * 2;
        TEST_ASSERT_DOUBLE_WITHIN(0.03, round(beat), beat);
    }
    heard_free(&h);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_note_plays_the_drum_that_sounds_it);
    RUN_TEST(test_a_louder_velocity_is_a_harder_stroke);
    RUN_TEST(test_keys_of_a_kit_are_those_of_general_midi);
    RUN_TEST(test_a_higher_tom_key_never_sounds_a_larger_tom);
    RUN_TEST(test_a_note_on_a_marimba_lands_on_its_bar);
    RUN_TEST(test_the_end_of_a_note_damps_its_drum_where_that_is_asked_for);
    RUN_TEST(test_a_ramp_of_tempo_is_even_and_strokes_land_on_its_beats);
    RUN_TEST(test_a_ramp_while_it_plays_ends_at_its_tempo_also_in_a_loop);
    RUN_TEST(test_beats_that_repeat_are_equal_strokes);
    RUN_TEST(test_strokes_without_a_dynamic_follow_a_crescendo);
    RUN_TEST(test_a_command_that_comes_too_late_or_behind_the_end_says_so);
    RUN_TEST(test_clear_while_it_plays_is_its_end);
    RUN_TEST(test_a_clock_that_falls_silent_leaves_its_tempo);
    RUN_TEST(test_a_gliss_takes_its_beats);
    RUN_TEST(test_every_setting_can_be_asked_for_and_answers_what_was_set);
    RUN_TEST(test_a_gesture_is_told_before_its_strike);
    RUN_TEST(test_parts_of_a_beat_are_told);
    RUN_TEST(test_tempo_and_beats_follow_a_clock);
    RUN_TEST(test_a_performer_may_begin_while_a_clock_runs);
    return UNITY_END();
}
