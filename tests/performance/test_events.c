/// test_events.c: the host's mailbox and the figures of a performance.
#include "performance/performance_events.h"
#include "performance/performance_statistics.h"
#include "plan/planner.h"

#include "unity.h"

#include <string.h>

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_of_more_than_1024_events_the_latest_are_kept_and_the_others_counted(void)
{
    static performance_events e;
    himc_event event = {.kind = HIMC_EVENT_BEAT};
    for (int i = 0; i < EVENTS_WAITING + 6; i++) {
        event.beat = i;
        himc_events_add(&e, &event);
    }
    TEST_ASSERT_EQUAL_INT(6, (int)e.lost);
    for (int i = 6; i < EVENTS_WAITING + 6; i++) {
        TEST_ASSERT_TRUE(himc_events_take(&e, &event));
        TEST_ASSERT_EQUAL_DOUBLE(i, event.beat);
    }
    TEST_ASSERT_FALSE(himc_events_take(&e, &event));
}

// a text of so many characters, other ones for another event
static void write_text(char *text, int length, int event)
{
    for (int i = 0; i < length; i++)
        text[i] = (char)('a' + (i + event) % 26);
    text[length] = '\0';
}

static void test_texts_of_any_length_come_out_as_they_went_in_among_strokes(void)
{
    static performance_events e;
    himc_event event, expected = {0};
    const int longest = (int)sizeof event.text - 1;
    int taken = 0;
    for (int i = 0; i < 9000; i++) {
        event = (himc_event){.kind = i % 5 == 0 ? HIMC_EVENT_MISSED : HIMC_EVENT_NOTE};
        event.minor = i % 3 == 0;
        event.strike.x = event.kind == HIMC_EVENT_MISSED ? i : 0;
        write_text(event.text, i * 37 % (longest + 1), i);
        himc_events_add(&e, &event);
        if (i % 3 == 0)
            continue;
        taken += (int)e.lost;
        e.lost = 0;
        TEST_ASSERT_TRUE(himc_events_take(&e, &event));
        write_text(expected.text, taken * 37 % (longest + 1), taken);
        TEST_ASSERT_EQUAL_STRING(expected.text, event.text);
        TEST_ASSERT_EQUAL_INT(taken % 5 == 0 ? HIMC_EVENT_MISSED : HIMC_EVENT_NOTE, event.kind);
        TEST_ASSERT_EQUAL_INT(taken % 3 == 0, event.minor);
        TEST_ASSERT_EQUAL_DOUBLE(taken % 5 == 0 ? taken : 0, event.strike.x);
        taken++;
    }
}

// how many of these events are lost if 1024 come and none is taken
static int lost_of(himc_event_kind kind, int length)
{
    static performance_events e;
    himc_event event = {.kind = kind};
    int left = 0;
    memset(&e, 0, sizeof e);
    for (int i = 0; i < EVENTS_WAITING; i++) {
        write_text(event.text, length, i);
        himc_events_add(&e, &event);
    }
    while (himc_events_take(&e, &event))
        left++;
    TEST_ASSERT_EQUAL_INT(EVENTS_WAITING, left + (int)e.lost);
    return (int)e.lost;
}

static void test_1024_strokes_misses_or_notes_of_200_characters_wait(void)
{
    TEST_ASSERT_EQUAL_INT(0, lost_of(HIMC_EVENT_STRIKE, 0));
    TEST_ASSERT_EQUAL_INT(0,
                          lost_of(HIMC_EVENT_MISSED, (int)sizeof((himc_planner_miss *)0)->why - 1));
    TEST_ASSERT_EQUAL_INT(0, lost_of(HIMC_EVENT_NOTE, 200));
    TEST_ASSERT_GREATER_THAN(0, lost_of(HIMC_EVENT_NOTE, 260));
}

static void test_latency_is_of_the_last_hit_and_the_longest_of_all(void)
{
    performance_statistics s;
    himc_performance_stats out = {0};
    himc_statistics_clear(&s);
    himc_statistics_hit(&s, 0.1);
    himc_statistics_hit(&s, 0.3);
    himc_statistics_hit(&s, 0.2);
    out = himc_statistics_told(&s);
    TEST_ASSERT_EQUAL_INT(3, out.hits);
    TEST_ASSERT_EQUAL_DOUBLE(0.2, out.hit_latency);
    TEST_ASSERT_EQUAL_DOUBLE(0.3, out.longest_latency);
}

static void test_height_of_strokes_is_the_mean_apex_between_touches(void)
{
    performance_statistics s;
    himc_performance_stats out = {0};
    static const double height[] = {0.1, 0.3, 0.2, 0, 0, 0.1, 0.2, 0, 0.4};
    himc_statistics_clear(&s);
    for (int i = 0; i < 9; i++)
        himc_statistics_height(&s, HIMC_LEFT, height[i], height[i] == 0);
    himc_statistics_tip(&s, (himc_vec3){0.003, 0, 0.004});
    out = himc_statistics_told(&s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25, out.stroke_height);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.005, out.tip_rms);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2, out.tip_rms_percent);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_of_more_than_1024_events_the_latest_are_kept_and_the_others_counted);
    RUN_TEST(test_texts_of_any_length_come_out_as_they_went_in_among_strokes);
    RUN_TEST(test_1024_strokes_misses_or_notes_of_200_characters_wait);
    RUN_TEST(test_latency_is_of_the_last_hit_and_the_longest_of_all);
    RUN_TEST(test_height_of_strokes_is_the_mean_apex_between_touches);
    return UNITY_END();
}
