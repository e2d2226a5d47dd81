/// test_missed.c: what is asked for is played or told of as missed, each stroke once.
#include "session.h"

#include <math.h>
#include <stdlib.h>

#define MISSES 256

typedef struct told {
    heard h;
    himc_strike missed[MISSES];
    char why[512]; // of the last one
    int misses, hit_lines;
} told;

static void listen_to(himc_performance *p, double seconds, told *to)
{
    himc_event event;
    for (long i = 0; i < lround(seconds * 48000); i += 480) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event)) {
            heard_event(&to->h, &event);
            to->hit_lines += event.kind == HIMC_EVENT_NOTE && !event.minor &&
                             strncmp(event.text, "hit:", 4) == 0;
            if (event.kind != HIMC_EVENT_MISSED || to->misses == MISSES)
                continue;
            to->missed[to->misses++] = event.strike;
            snprintf(to->why, sizeof to->why, "%s", event.text);
        }
    }
}

static himc_performance *with_far_drum(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    session_do(p, "drum far");
    session_drum(p, 1, "place 4 0 0.85");
    session_do(p, "tempo 60");
    return p;
}

static void test_each_stroke_is_played_or_missed_with_its_beat_hand_drum_and_time(void)
{
    himc_performance *p = with_far_drum();
    told t = {.misses = 0};
    for (int i = 1; i <= 6; i++)
        session_do(p, "stroke %d.5 %s tenuto mf %s", i, i % 2 ? "left" : "right",
                   i == 2 || i == 5 ? "far" : "kettle");
    session_do(p, "play");
    listen_to(p, 8, &t);
    TEST_ASSERT_EQUAL_INT(4, t.h.strikes);
    TEST_ASSERT_EQUAL_INT(2, t.misses);
    TEST_ASSERT_EQUAL_INT(2, himc_performance_measure(p).missed);
    TEST_ASSERT_EQUAL_STRING_LEN("out of reach by 2.", t.why, 18);
    for (int i = 0; i < 2; i++) {
        const himc_strike *m = &t.missed[i];
        TEST_ASSERT_EQUAL_DOUBLE(i ? 5.5 : 2.5, m->beat);
        TEST_ASSERT_EQUAL_INT(i ? HIMC_LEFT : HIMC_RIGHT, m->hand);
        TEST_ASSERT_EQUAL_STRING("far", m->drum);
        TEST_ASSERT_EQUAL_STRING("tenuto", m->nuance);
        TEST_ASSERT_EQUAL_DOUBLE(0, m->velocity + m->force + m->impulse + m->duration);
        // on the beat, as those that are played
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, m->beat - t.h.strike[0].beat,
                                  m->planned_time - t.h.strike[0].planned_time);
    }
    heard_free(&t.h);
    himc_performance_free(p);
}

static void test_of_200_hits_at_once_each_is_played_or_missed_and_lines_are_few(void)
{
    himc_performance *p = with_far_drum();
    told t = {.misses = 0};
    listen_to(p, 0.5, &t);
    for (int i = 0; i < 200; i++)
        session_do(p, "hit any legato mf");
    listen_to(p, 3, &t);
    TEST_ASSERT_TRUE(t.h.strikes > 0);
    TEST_ASSERT_EQUAL_INT(200, t.h.strikes + t.misses);
    for (int i = 0; i < t.misses; i++)
        TEST_ASSERT_TRUE(isnan(t.missed[i].beat));
    TEST_ASSERT_EQUAL_INT(1, t.hit_lines);
    heard_free(&t.h);
    himc_performance_free(p);
}

static void test_hits_without_latency_that_find_no_room_are_missed(void)
{
    himc_performance *p = with_far_drum();
    told t = {.misses = 0};
    session_do(p, "latency 0");
    for (int i = 0; i < 20; i++)
        session_do(p, "hit left legato mf");
    session_do(p, "hit left legato mf far");
    listen_to(p, 4, &t);
    TEST_ASSERT_EQUAL_INT(21, t.h.strikes + t.misses);
    heard_free(&t.h);
    himc_performance_free(p);
}

// a line tells while the hits go on, not only when they are over
static void test_hits_that_come_late_all_the_time_are_told_of_meanwhile(void)
{
    himc_performance *p = with_far_drum();
    told t = {.misses = 0};
    session_drum(p, 1, "place 0.25 -0.84 0.85");
    session_do(p, "latency 100");
    for (int i = 0; i < 12; i++) {
        session_do(p, "hit right legato mf %s", i % 2 ? "far" : "kettle");
        listen_to(p, 0.8, &t);
    }
    TEST_ASSERT_EQUAL_INT(12, t.h.strikes + t.misses);
    TEST_ASSERT_TRUE(t.hit_lines >= 1);
    TEST_ASSERT_TRUE(t.hit_lines <= 3);
    heard_free(&t.h);
    himc_performance_free(p);
}

static void test_a_roll_that_is_past_is_given_up_in_one_line(void)
{
    heard h = {0};
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    for (int beat = 0; beat < 8; beat++)
        session_do(p, "stroke %d %s legato mf", beat, beat % 2 ? "left" : "right");
    session_do(p, "play");
    session_play(p, 2.5, &h);
    TEST_ASSERT_EQUAL_INT(0, h.notes);
    session_do(p, "roll 1 0.5 single mf");
    session_play(p, 0.3, &h);
    TEST_ASSERT_EQUAL_STRING("roll at beat 1: given up, that beat is past", h.note);
    TEST_ASSERT_EQUAL_INT(1, h.notes);
    heard_free(&h);
    himc_performance_free(p);
}

// limits throw the arms about: a stick may lie on the head when its stroke is due
static void test_each_stroke_counts_where_sticks_come_to_lie_on_the_head(void)
{
    if (!getenv("HIMC_LONG"))
        TEST_IGNORE_MESSAGE("takes 15 s: HIMC_LONG=1");
    int strokes[2];
    for (int limits = 0; limits < 2; limits++) {
        himc_performance *p = session_new();
        himc_performance_make_drums(p, true);
        session_do(p, "score patches/improvisation.txt");
        session_do(p, limits ? "limits ellipsoid" : "limits off");
        session_do(p, "play");
        himc_performance_process(p, 23 * 48000, NULL);
        strokes[limits] = himc_performance_measure(p).strokes;
        himc_performance_free(p);
    }
    TEST_ASSERT_EQUAL_INT(strokes[0], strokes[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_stroke_is_played_or_missed_with_its_beat_hand_drum_and_time);
    RUN_TEST(test_of_200_hits_at_once_each_is_played_or_missed_and_lines_are_few);
    RUN_TEST(test_hits_without_latency_that_find_no_room_are_missed);
    RUN_TEST(test_hits_that_come_late_all_the_time_are_told_of_meanwhile);
    RUN_TEST(test_a_roll_that_is_past_is_given_up_in_one_line);
    RUN_TEST(test_each_stroke_counts_where_sticks_come_to_lie_on_the_head);
    return UNITY_END();
}
