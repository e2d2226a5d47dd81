/// test_beats.c: beats and the end are told in the step in which they come, whatever the host does.
#include "session.h"

#include "himc/body.h"

#define CHUNK 6000 // samples between two places where the host gives commands
#define CHUNKS 32
#define MOST 64

typedef struct told {
    himc_event_kind kind;
    double beat, time;
    int chunk; // in which it came
} told;

// a command in the midst of a chunk
static void later(himc_performance *p, const char *text, int delay)
{
    himc_command c;
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_PERFORMER, text, &error));
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_command(p, &c, delay, &error), error.text);
}

static void change(himc_performance *p, int chunk)
{
    if (chunk == 7)
        later(p, "tempo 260", 2345);
    if (chunk == 11)
        later(p, "seek 1", 3001);
    if (chunk == 15)
        session_do(p, "loop 0");
}

// A host that asks for one sample at a time has each step looked at, as something may have changed.
static int listen(int block, told events[MOST])
{
    himc_performance *p = session_new();
    himc_event event;
    int count = 0;
    session_do(p, "drum kettle 26");
    session_do(p, "tempo 190");
    for (int i = 0; i < 4; i++)
        session_do(p, "stroke %g %s legato mf normal", 0.5 + 0.75 * i, i % 2 ? "left" : "right");
    session_do(p, "loop 1");
    session_do(p, "play");
    for (int chunk = 0; chunk < CHUNKS; chunk++) {
        change(p, chunk);
        for (int left = CHUNK, n; left > 0; left -= n) {
            n = left < block ? left : block;
            himc_performance_process(p, n, NULL);
            while (himc_performance_event(p, &event))
                if ((event.kind == HIMC_EVENT_BEAT || event.kind == HIMC_EVENT_DONE) &&
                    count < MOST)
                    events[count++] = (told){event.kind, event.beat, event.time, chunk};
        }
    }
    himc_performance_free(p);
    return count;
}

static void test_beats_and_the_end_come_in_the_same_steps_at_any_block_size(void)
{
    static told expected[MOST], got[MOST];
    int count = listen(1, expected), dones = 0;
    for (int i = 0; i < count; i++)
        dones += expected[i].kind == HIMC_EVENT_DONE;
    TEST_ASSERT_EQUAL_INT(1, dones);
    TEST_ASSERT_GREATER_THAN_INT(6, count);
    for (int block = 64; block <= CHUNK; block *= 9) {
        memset(got, 0, sizeof got);
        TEST_ASSERT_EQUAL_INT(count, listen(block, got));
        for (int i = 0; i < count; i++) {
            TEST_ASSERT_EQUAL_INT(expected[i].kind, got[i].kind);
            TEST_ASSERT_EQUAL_DOUBLE(expected[i].beat, got[i].beat);
            TEST_ASSERT_EQUAL_DOUBLE(expected[i].time, got[i].time);
            TEST_ASSERT_EQUAL_INT(expected[i].chunk, got[i].chunk);
        }
    }
}

/// A round of a loop with a tempo on beat 0 and another on beat 2, after `tempo 200` on a beat.
typedef struct round_length {
    double first, second; ///< of beats 0 and 1, of beats 2 and 3 (s)
} round_length;

static round_length round_after_tempo_on(double beat)
{
    himc_performance *p = session_new();
    himc_event event;
    double begun[4][8], due = INFINITY; // (s)
    int rounds = 0, sent = 0;
    session_do(p, "drum kettle 26");
    for (int i = 0; i < 4; i++)
        session_do(p, "stroke %d %s legato mf", i, i % 2 ? "left" : "right");
    session_do(p, "loop 1");
    session_do(p, "tempo 120");
    session_do(p, "tempo 60 2");
    session_do(p, "play");
    for (int i = 0; i < 2000 && rounds < 6; i++) {
        himc_performance_process(p, 480, NULL);
        if (himc_performance_measure(p).seconds >= due) {
            session_do(p, "tempo 200");
            due = INFINITY;
            sent = 1;
        }
        while (himc_performance_event(p, &event))
            if (event.kind == HIMC_EVENT_BEAT) {
                rounds += event.beat == 0;
                if (!sent && event.beat == floor(beat))
                    due = event.time + (beat - floor(beat)) * (beat < 2 ? 0.5 : 1);
                begun[(int)event.beat][rounds] = event.time;
            }
    }
    himc_performance_free(p);
    TEST_ASSERT_EQUAL_INT(6, rounds);
    return (round_length){begun[2][4] - begun[0][4], begun[0][5] - begun[2][4]};
}

static void test_tempo_in_a_loop_keeps_the_tempi_of_other_parts_in_later_rounds(void)
{
    static const double beat[] = {0.1, 0.6, 1.9, 2.1, 3.9};
    for (int i = 0; i < 5; i++) {
        round_length r = round_after_tempo_on(beat[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, beat[i] < 2 ? 0.6 : 1, r.first);  // 200 or 120
        TEST_ASSERT_DOUBLE_WITHIN(0.01, beat[i] < 2 ? 2 : 0.6, r.second); // 60 or 200
    }
}

static void test_a_loop_of_one_beat_reports_it_in_each_round(void)
{
    himc_performance *p = session_new();
    heard h = {0};
    session_do(p, "drum kettle 26");
    session_do(p, "stroke 0 right legato mf");
    session_do(p, "loop 1");
    session_do(p, "play");
    session_play(p, 5, &h);
    TEST_ASSERT_GREATER_THAN_INT(4, h.strikes);
    TEST_ASSERT_EQUAL_INT(h.strikes, h.beats);
    heard_free(&h);
    himc_performance_free(p);
}

// a counter or a sequencer on the outlet gets each beat once
static void test_stop_and_play_within_a_beat_do_not_begin_it_again(void)
{
    himc_performance *p = session_new();
    himc_event event;
    double last = -1;
    session_do(p, "drum kettle 26");
    session_do(p, "stroke 0 right legato mf");
    session_do(p, "stroke 7 left legato mf");
    session_do(p, "play");
    for (int i = 0; i < 80; i++) {
        if (i == 19)
            session_do(p, "stop");
        if (i == 24)
            session_do(p, "play");
        himc_performance_process(p, 4800, NULL);
        while (himc_performance_event(p, &event))
            if (event.kind == HIMC_EVENT_BEAT) {
                TEST_ASSERT_EQUAL_DOUBLE(last + 1, event.beat);
                last = event.beat;
            }
    }
    TEST_ASSERT_EQUAL_DOUBLE(7, last);
    himc_performance_free(p);
}

typedef struct pushes {
    bool pushed;
    int count;
    double time[MOST];
} pushes;

static void count_pushes(void *user, const himc_motion_row *row)
{
    pushes *p = user;
    bool pushed = row->push[HIMC_HEAD].x > 0;
    if (pushed && !p->pushed && p->count < MOST)
        p->time[p->count++] = row->time;
    p->pushed = pushed;
}

// on beat 4, where a loop of four beats begins again, as on any other
static void test_a_push_acts_once_in_each_round_of_a_loop_on_its_last_beat_too(void)
{
    static const double beats[] = {0, 1.5, 4};
    for (int i = 0; i < 3; i++) {
        himc_performance *p = session_new();
        pushes all = {.count = 0};
        session_do(p, "drum kettle 26");
        session_do(p, "tempo 120");
        session_do(p, "stroke 1 right legato mf");
        session_do(p, "stroke 3.5 left legato mf");
        session_do(p, "at %g push head 5 0 0 0.1", beats[i]);
        session_do(p, "loop 1");
        himc_performance_on_motion(p, count_pushes, &all);
        session_do(p, "play");
        session_play(p, 8.5, NULL); // four rounds of 2 s, and a beat
        TEST_ASSERT_EQUAL_INT(beats[i] == 0 ? 5 : 4, all.count);
        for (int k = 1; k < all.count; k++)
            TEST_ASSERT_DOUBLE_WITHIN(0.009, 2, all.time[k] - all.time[k - 1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.009, 0.5 * beats[i], all.time[0]);
        himc_performance_free(p);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_beats_and_the_end_come_in_the_same_steps_at_any_block_size);
    RUN_TEST(test_tempo_in_a_loop_keeps_the_tempi_of_other_parts_in_later_rounds);
    RUN_TEST(test_a_loop_of_one_beat_reports_it_in_each_round);
    RUN_TEST(test_stop_and_play_within_a_beat_do_not_begin_it_again);
    RUN_TEST(test_a_push_acts_once_in_each_round_of_a_loop_on_its_last_beat_too);
    return UNITY_END();
}
