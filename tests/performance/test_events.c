/// test_events.c: the host's mailbox and the figures of a performance.
#include "performance/performance_events.h"
#include "performance/performance_statistics.h"

#include "unity.h"

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

static void test_latency_is_of_the_last_hit_and_the_longest_of_all(void)
{
    performance_statistics s;
    himc_performance_stats out = {0};
    himc_statistics_clear(&s);
    himc_statistics_hit(&s, 0.1);
    himc_statistics_hit(&s, 0.3);
    himc_statistics_hit(&s, 0.2);
    himc_statistics_read(&s, &out);
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
    himc_statistics_read(&s, &out);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25, out.stroke_height);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.005, out.tip_rms);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2, out.tip_rms_percent);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_of_more_than_1024_events_the_latest_are_kept_and_the_others_counted);
    RUN_TEST(test_latency_is_of_the_last_hit_and_the_longest_of_all);
    RUN_TEST(test_height_of_strokes_is_the_mean_apex_between_touches);
    return UNITY_END();
}
