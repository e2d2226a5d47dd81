/// test_notes_changed.c: what is changed, stopped or moved while it plays: beats, gestures, ramps
/// and a clock stay whole, and notes end.
#include "session.h"

#include "drum/drum_performer.h"

#include <math.h>

static himc_performance *beats(int n, const char *before)
{
    himc_performance *p = session_new();
    session_do(p, "setup timpani");
    session_do(p, "tempo 60");
    for (int i = 0; i < n; i++)
        session_do(p, "stroke %d %s legato mf second", i, i % 2 ? "left" : "right");
    if (before)
        session_do(p, "%s", before);
    session_do(p, "play");
    return p;
}

// the beats that are told within these seconds, at most `most`
static int tell_beats(himc_performance *p, double seconds, double *beat, int most)
{
    himc_event event;
    int count = 0;
    for (int i = 0; i < 100 * seconds; i++) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event))
            if (event.kind == HIMC_EVENT_BEAT && count < most)
                beat[count++] = event.beat;
    }
    return count;
}

static void test_no_beat_is_told_twice_when_its_parts_change(void)
{
    for (int finer = 0; finer < 2; finer++) {
        double beat[64];
        himc_performance *p = beats(8, finer ? "subdivide 1" : "subdivide 4");
        int first = tell_beats(p, 3, beat, 64);
        session_do(p, finer ? "subdivide 4" : "subdivide 1");
        int all = first + tell_beats(p, 2.5, beat + first, 64 - first);
        TEST_ASSERT_TRUE(all > first + 1);
        for (int i = 1; i < all; i++) {
            double step = (i < first) == finer ? 1 : 0.25;
            TEST_ASSERT_TRUE(beat[i] > beat[i - 1] && beat[i] - beat[i - 1] <= 1);
            if (i != first)
                TEST_ASSERT_EQUAL_DOUBLE(step, beat[i] - beat[i - 1]);
        }
        himc_performance_free(p);
    }
}

// each strike of the next seconds has been told by its gesture
static void expect_told(himc_performance *p, double told[2], double seconds, int *strikes)
{
    himc_event event;
    for (int i = 0; i < 100 * seconds; i++) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event)) {
            if (event.kind == HIMC_EVENT_PREPARE)
                told[event.strike.hand] = event.strike.time;
            if (event.kind != HIMC_EVENT_STRIKE)
                continue;
            ++*strikes;
            TEST_ASSERT_DOUBLE_WITHIN(0.005, told[event.strike.hand], event.strike.time);
        }
    }
}

static void test_a_gesture_is_told_again_when_its_stroke_moves(void)
{
    double told[2] = {-1, -1};
    int strikes = 0;
    himc_performance *p = beats(12, NULL);
    expect_told(p, told, 3.2, &strikes);
    session_do(p, "tempo 200");
    expect_told(p, told, 1.2, &strikes);
    session_do(p, "stop");
    int before = strikes;
    expect_told(p, told, 0.02, &strikes);
    session_do(p, "hit right legato mf second");
    expect_told(p, told, 1, &strikes);
    TEST_ASSERT_GREATER_THAN_INT(before, strikes);
    TEST_ASSERT_GREATER_THAN_INT(5, strikes);
    himc_performance_free(p);
}

static void test_a_ramp_in_a_loop_goes_on_after_seek(void)
{
    double last = 0;
    himc_performance *p = beats(4, "loop 1");
    session_play(p, 2, NULL);
    session_do(p, "tempo 60 180 8");
    session_play(p, 4, NULL);
    session_do(p, "seek 0");
    for (int i = 0; i < 6; i++) { // a second has two beats, a ramp's eighth is one
        double now = himc_performance_measure(p).bpm;
        TEST_ASSERT_TRUE(now > last || now == 180);
        last = now;
        session_play(p, 1, NULL);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 180, himc_performance_measure(p).bpm);
    himc_performance_free(p);
}

// ticks of a MIDI clock of 120 beats a minute while it plays for that many beats
static void tick(himc_performance *p, double beat_count, heard *h)
{
    for (int i = 0; i < 24 * beat_count; i++) {
        session_do(p, "clock");
        himc_performance_process(p, 1000, NULL);
        himc_event event;
        while (himc_performance_event(p, &event))
            heard_event(h, &event);
    }
}

static void test_ticks_while_a_clock_is_stopped_do_not_count(void)
{
    heard h = {0};
    himc_performance *p = session_new();
    session_do(p, "setup timpani");
    session_do(p, "sync midi");
    for (int i = 0; i < 40; i++)
        session_do(p, "stroke %d %s legato mf second", i, i % 2 ? "left" : "right");
    session_do(p, "clock start");
    tick(p, 8, &h);
    session_do(p, "clock stop");
    tick(p, 2.5, &h);
    int before = h.strikes;
    tick(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(before, h.strikes); // stopped
    session_do(p, "clock continue");
    double began = himc_performance_measure(p).seconds; // beat 8 of the clock
    tick(p, 10, &h);
    TEST_ASSERT_GREATER_THAN_INT(before + 7, h.strikes);
    for (int i = h.strikes - 4; i < h.strikes; i++) {
        double beat = 2 * (h.strike[i].time - began);
        TEST_ASSERT_DOUBLE_WITHIN(0.03, round(beat), beat);
    }
    heard_free(&h);
    himc_performance_free(p);
}

static void test_of_two_keys_of_a_drum_the_last_that_ends_damps(void)
{
    static double sound[4800];
    double sum[3] = {0, 0, 0};
    himc_performance *p = session_new();
    session_do(p, "setup timpani");
    session_do(p, "noteoff damp");
    session_do(p, "note 45 90");
    session_play(p, 0.5, NULL);
    session_do(p, "note 46 90"); // the same drum is the nearest
    for (int i = 0; i < 3; i++) {
        session_play(p, 0.7, NULL);
        himc_drum *drum = himc_performance_drum(p, 1);
        himc_drum_read(drum, himc_drum_time(drum) - 4800, 4800, sound, NULL);
        for (int k = 0; k < 4800; k++)
            sum[i] += sound[k] * sound[k];
        session_do(p, "note %d 0", i == 0 ? 45 : 46);
    }
    TEST_ASSERT_TRUE(sum[1] > 0.01 * sum[0]);
    TEST_ASSERT_TRUE(sum[2] < 1e-6 * sum[0]);
    himc_performance_free(p);
}

static void test_a_note_for_a_kettledrum_asks_for_no_bar_of_another(void)
{
    heard h = {0};
    himc_performance *p = session_new();
    session_do(p, "instrument bells glockenspiel");
    session_do(p, "drum kettle 26");
    session_do(p, "kettle tune A2");
    session_do(p, "note 48 90");
    session_play(p, 1, &h);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    TEST_ASSERT_EQUAL_STRING("kettle", h.strike[0].drum);
    heard_free(&h);
    himc_performance_free(p);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_beat_is_told_twice_when_its_parts_change);
    RUN_TEST(test_a_gesture_is_told_again_when_its_stroke_moves);
    RUN_TEST(test_a_ramp_in_a_loop_goes_on_after_seek);
    RUN_TEST(test_ticks_while_a_clock_is_stopped_do_not_count);
    RUN_TEST(test_of_two_keys_of_a_drum_the_last_that_ends_damps);
    RUN_TEST(test_a_note_for_a_kettledrum_asks_for_no_bar_of_another);
    return UNITY_END();
}
