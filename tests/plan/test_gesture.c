/// test_gesture.c: the numbers of a stroke: its dynamic, its shape from a motion unit, its haste.
#include "plan/gesture.h"

#include "unity.h"

#include <math.h>

#define FORTE (5.0 / 7)

void setUp(void)
{
}

void tearDown(void)
{
}

static void test_fff_is_ten_times_as_fast_as_ppp(void)
{
    for (int n = 0; n < HIMC_NUANCES; n++) {
        double soft = himc_gesture_of((himc_nuance)n, 0).speed;
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 10.008, himc_gesture_of((himc_nuance)n, 1).speed / soft);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 7.2, himc_gesture_of((himc_nuance)n, FORTE).speed / soft);
    }
}

static void test_no_stroke_falls_longer_than_0_3_s_or_from_more_than_0_75_m(void)
{
    for (int n = 0; n < HIMC_NUANCES; n++)
        for (double dynamic = 0; dynamic <= 1; dynamic += 0.05) {
            himc_gesture g = himc_gesture_of((himc_nuance)n, dynamic);
            TEST_ASSERT_TRUE(g.down <= 0.3 + 1e-12 && g.height <= 0.75 && g.height >= 0.03);
        }
}

static void test_backswing_is_in_proportion_to_the_height(void)
{
    for (int n = 0; n < HIMC_NUANCES; n++) {
        himc_gesture loud = himc_gesture_of((himc_nuance)n, FORTE),
                     soft = himc_gesture_of((himc_nuance)n, 0.3);
        TEST_ASSERT_TRUE(soft.height < 0.9 * loud.height);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, loud.depth / loud.height, soft.depth / soft.height);
    }
}

// a unit with `share` of the speed of a legato at f
static himc_unit unit_of(double share)
{
    return (himc_unit){.height = 0.3,
                       .speed = share * himc_gesture_of(HIMC_LEGATO, FORTE).speed,
                       .down = 0.2,
                       .lift = 0.25,
                       .depth = 0.1,
                       .rebound = 0.6,
                       .pull = 1.5};
}

static void test_unit_at_twice_its_speed_falls_shorter_and_from_higher(void)
{
    himc_unit unit = unit_of(0.5);
    himc_gesture g = himc_gesture_from(&unit, HIMC_LEGATO, FORTE);
    TEST_ASSERT_EQUAL_DOUBLE(2 * unit.speed, g.speed);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.2 / sqrt(2), g.down);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.3 * sqrt(2), g.height);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.12, g.depth); // at most 1.2 times the unit's
}

static void test_unit_at_half_its_speed_falls_as_long_from_half_its_height(void)
{
    himc_unit unit = unit_of(2);
    himc_gesture g = himc_gesture_from(&unit, HIMC_LEGATO, FORTE);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.2, g.down);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.15, g.height);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.05, g.depth);
}

static void test_unit_gives_its_rise_its_rebound_and_its_arc(void)
{
    static const double start[] = {-1.5, 1, -9}, arc[] = {1.5, 0, 4};
    himc_unit unit = unit_of(1);
    for (int i = 0; i < 3; i++) {
        unit.start = start[i];
        himc_gesture g = himc_gesture_from(&unit, HIMC_LEGATO, FORTE);
        TEST_ASSERT_EQUAL_DOUBLE(arc[i], g.arc);
        TEST_ASSERT_EQUAL_DOUBLE(0.25, g.rise);
        TEST_ASSERT_EQUAL_DOUBLE(0.6, g.rebound);
        TEST_ASSERT_EQUAL_DOUBLE(1.5, g.rebound_time);
        TEST_ASSERT_EQUAL_PTR(&unit, g.unit);
    }
}

// 0.4 s from the head
static const himc_gesture strong = {
    .height = 0.5, .speed = 5.5, .down = 0.2, .rise = 0.2, .depth = 0.1};

static double bent(double speed, double most)
{
    himc_gesture g = strong;
    g.speed = speed;
    return himc_gesture_bend(g, most).speed;
}

static void test_in_haste_louder_is_louder_and_slower_is_not_softer(void)
{
    for (double most = 1; most < 30; most *= 1.1)
        for (double speed = 0.4; speed < 11; speed *= 1.1) {
            double v = bent(speed, most);
            TEST_ASSERT_TRUE(v <= speed && v < bent(1.1 * speed, most) &&
                             v <= bent(speed, 1.1 * most));
            // half a decibel for each step of dynamics, 1.3 times as fast, however short the time
            TEST_ASSERT_TRUE(bent(1.3 * speed, most) > 1.06 * v);
        }
}

static void test_haste_is_not_felt_by_strokes_far_below_its_limit(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(3, bent(3, 8));
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 3, bent(3, 4)); // 0.1 dB
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3 * pow(2, -0.75 / 8), bent(3, 3));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 2 * pow(10, 0.25), bent(20, 2)); // far above: the fourth root
}

static void test_haste_keeps_the_time_and_the_steepness(void)
{
    himc_gesture g = himc_gesture_bend(strong, 4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, strong.down, g.down);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, strong.speed / strong.height, g.speed / g.height);
}

static void test_stroke_in_half_its_time_is_half_as_high_and_as_strong(void)
{
    himc_gesture g = himc_gesture_squeeze(strong, 0.2, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1, g.down);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1, g.rise);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.025, g.depth);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 5.5, g.speed);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25, g.height);
}

static void test_tip_that_is_high_already_stays_high_in_haste(void)
{
    himc_gesture tall = strong;
    tall.speed = 4;                                           // a steepness of 1.6 and less
    himc_gesture g = himc_gesture_squeeze(strong, 0.13, 0.5); // of 0.2 + 0.3 * 0.2
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.25, g.height);
    g = himc_gesture_squeeze(tall, 0.13, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 4 * 0.1 / 1.6, g.height);
}

static void test_stroke_with_time_enough_is_not_changed(void)
{
    himc_gesture g = himc_gesture_squeeze(strong, 0.4, 0);
    TEST_ASSERT_EQUAL_MEMORY(&strong, &g, sizeof g);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.4, himc_gesture_time(&strong, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.3, himc_gesture_time(&strong, 0.25));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.26, himc_gesture_time(&strong, 0.5));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fff_is_ten_times_as_fast_as_ppp);
    RUN_TEST(test_no_stroke_falls_longer_than_0_3_s_or_from_more_than_0_75_m);
    RUN_TEST(test_backswing_is_in_proportion_to_the_height);
    RUN_TEST(test_unit_at_twice_its_speed_falls_shorter_and_from_higher);
    RUN_TEST(test_unit_at_half_its_speed_falls_as_long_from_half_its_height);
    RUN_TEST(test_unit_gives_its_rise_its_rebound_and_its_arc);
    RUN_TEST(test_in_haste_louder_is_louder_and_slower_is_not_softer);
    RUN_TEST(test_haste_is_not_felt_by_strokes_far_below_its_limit);
    RUN_TEST(test_haste_keeps_the_time_and_the_steepness);
    RUN_TEST(test_stroke_in_half_its_time_is_half_as_high_and_as_strong);
    RUN_TEST(test_tip_that_is_high_already_stays_high_in_haste);
    RUN_TEST(test_stroke_with_time_enough_is_not_changed);
    return UNITY_END();
}
