/// test_hand_path.c: the hand's own path in a stroke: over the hoop at any tempo, first on the way
/// up, and the same however it is cut into steps.
#include "body/hand_path.h"

#include "unity.h"

#include <math.h>
#include <string.h>

#define LEVEL 0.87
#define STICK 0.2425
#define TICK 0.004

void setUp(void)
{
}
void tearDown(void)
{
}

// strokes of a height (m), at a rate (1/s); 0 at t = 0
static double tip(double height, double rate, double t)
{
    double s = sin(3.14159265358979 * rate * t);
    return height * s * s;
}

static void aim(himc_hand_path *p, const himc_hand_style *style, double height, double rate,
                double t)
{
    double middle = t + 0.5 * TICK, rises = middle + HIMC_HAND_PATH_RISES, d = 1e-4;
    himc_hand_ahead ahead = {
        .grip = tip(height, rate, middle + himc_hand_path_foresight(style->grip_lead)),
        .hand = tip(height, rate, middle + himc_hand_path_foresight(style->hand_lead)),
        .now = tip(height, rate, t),
        .up = (tip(height, rate, rises + d) - tip(height, rate, rises)) / d,
        .level = LEVEL};
    *p = himc_hand_path_at(p, t);
    himc_hand_path_aim(p, style, &ahead, STICK);
}

static void test_no_hand_drops_below_its_height_at_impact(void)
{
    double rest[HIMC_HAND_PATH_PARTS];
    himc_hand_path_rest(0, LEVEL, STICK, 0, rest);
    TEST_ASSERT_TRUE(rest[HIMC_HAND_PATH_GRIP] >= LEVEL + 0.01);
    for (int nuance = 0; nuance < HIMC_NUANCES; nuance++)
        for (double dynamic = 0; dynamic <= 1; dynamic += 0.25)
            for (double rate = 0.5; rate < 15; rate *= 1.7) {
                himc_hand_style style = himc_hand_style_of((himc_nuance)nuance, dynamic);
                himc_hand_path p = {.moving = false};
                for (double t = 0; t < 4; t += TICK) {
                    aim(&p, &style, 0.6 * dynamic, rate, t);
                    TEST_ASSERT_TRUE(p.value[HIMC_HAND_PATH_GRIP] >=
                                     rest[HIMC_HAND_PATH_GRIP] - 1e-12);
                }
            }
}

static void test_a_path_is_the_same_in_one_step_and_in_many(void)
{
    himc_hand_style style = himc_hand_style_of(HIMC_ACCENT, 0.8);
    himc_hand_path p = {.moving = false};
    for (double t = 0; t < 0.3; t += TICK)
        aim(&p, &style, 0.4, 2, t);
    himc_hand_path once = himc_hand_path_at(&p, p.time + 0.05), many = p;
    for (int i = 1; i <= 50; i++)
        many = himc_hand_path_at(&many, p.time + 0.001 * i);
    for (int i = 0; i < HIMC_HAND_PATH_PARTS; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, once.value[i], many.value[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, once.rate[i], many.rate[i]);
    }
}

// 30 minutes: no drift
static void test_over_a_resting_tip_a_hand_stays(void)
{
    himc_hand_style style = himc_hand_style_of(HIMC_LEGATO, 0.5);
    himc_hand_path p = {.moving = false}, begin;
    for (int i = 0; i < 450000; i++) {
        aim(&p, &style, 0, 1, TICK * i);
        if (i == 500)
            begin = p;
    }
    for (int i = 0; i < HIMC_HAND_PATH_PARTS; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, begin.value[i], p.value[i]);
}

static void test_fast_strokes_are_left_to_wrist_and_fingers(void)
{
    double last = INFINITY;
    himc_hand_style style = himc_hand_style_roll();
    for (double rate = 1; rate < 12; rate *= 2) {
        himc_hand_path p = {.moving = false};
        double low = INFINITY, high = -INFINITY;
        for (double t = 0; t < 4; t += TICK) {
            aim(&p, &style, 0.2, rate, t);
            low = t > 2 ? fmin(low, p.value[HIMC_HAND_PATH_GRIP]) : low;
            high = t > 2 ? fmax(high, p.value[HIMC_HAND_PATH_GRIP]) : high;
        }
        TEST_ASSERT_TRUE(high - low < last);
        last = high - low;
    }
}

// an elbow that would have to flip turns on, no faster than it may
static void test_an_elbow_swings_at_a_bounded_rate(void)
{
    himc_hand_path p = {.moving = true};
    double angle = 3, fastest = 0;
    for (double t = 0; t < 1; t += TICK) {
        double before = p.value[HIMC_HAND_PATH_SWING];
        himc_hand_path then = himc_hand_path_at(&p, t + TICK);
        angle -= then.value[HIMC_HAND_PATH_SWING] - before;
        fastest = fmax(fastest, fabs(then.rate[HIMC_HAND_PATH_SWING]));
        himc_hand_path_swing(&then, (himc_vec3){0, 0, -1}, angle);
        p = then;
    }
    TEST_ASSERT_TRUE(fabs(angle) < 1e-3);
    TEST_ASSERT_TRUE(fastest > 5 && fastest < 16);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_hand_drops_below_its_height_at_impact);
    RUN_TEST(test_a_path_is_the_same_in_one_step_and_in_many);
    RUN_TEST(test_over_a_resting_tip_a_hand_stays);
    RUN_TEST(test_fast_strokes_are_left_to_wrist_and_fingers);
    RUN_TEST(test_an_elbow_swings_at_a_bounded_rate);
    return UNITY_END();
}
