/// test_rehearsal.c: what the planner asks about the body ahead of time, and what it makes of the
/// answers.
#include "planners.h"
#include "plan/planner_state.h"

#include <string.h>

static double seen[20000]; // moments of the walk (s)
static int seen_count;

/// Strokes of both hands in turn, each `over` its own side of one drum (m), or on the other's if
/// that is negative.
static void add_strokes(int strokes, double interval, double over)
{
    himc_planner_config config = with_body();
    himc_planner_free(planner);
    planner = make_with(&config, 120);
    for (int i = 0; i < strokes; i++) {
        himc_stroke s = {.beat = 2 + interval * i,
                         .hand = (himc_hand)(i % 2),
                         .nuance = HIMC_LEGATO,
                         .dynamic = 0.5,
                         .spot = HIMC_SPOT_XY,
                         .x = -0.1,
                         .y = i % 2 ? -over : over};
        TEST_ASSERT_TRUE_MESSAGE(himc_planner_add(planner, &s, 0, &error), error.text);
    }
    himc_planner_play(planner, 0);
}

static planner_hand before[HIMC_HANDS];

/// One call of himc_planner_think for a single moment; true if it tried another way of a stroke.
static bool think_once(void)
{
    const planner_clear *c = &planner->clear;
    bool searching = c->searching;
    int notes = planner->notes.count, next = planner->score.part[HIMC_LEFT].listed.number;
    memcpy(before, planner->hand, sizeof before);
    himc_planner_think(planner, 1);
    if (searching && c->searching) {
        TEST_ASSERT_EQUAL_MEMORY(before, planner->hand, sizeof before);
        TEST_ASSERT_EQUAL_INT(notes, planner->notes.count);
        TEST_ASSERT_EQUAL_INT(next, planner->score.part[HIMC_LEFT].listed.number);
    }
    return c->trying && c->way.touch > -HUGE_VAL;
}

static void test_what_is_tried_changes_nothing_until_it_is_chosen(void)
{
    int tried = 0;
    add_strokes(40, 0.35, -0.1);
    for (int i = 0; i < 40; i++) // and at one place at once
        add(planner, 16 + i, (himc_hand)(i % 2), HIMC_LEGATO, 0.5);
    for (int i = 0; i < 40; i++) {
        himc_stroke s = {.beat = 16 + i,
                         .hand = (himc_hand)((i + 1) % 2),
                         .nuance = HIMC_LEGATO,
                         .dynamic = 0.5,
                         .spot = HIMC_SPOT_NORMAL};
        himc_planner_add(planner, &s, 0, &error);
    }
    for (double t = 0; t < 20; t += 4e-3) {
        himc_planner_advance(planner, t);
        for (int i = 0; i < 40; i++)
            tried += think_once();
    }
    TEST_ASSERT_TRUE(tried > 100);
    TEST_ASSERT_TRUE(himc_planner_work(planner) > 10000);
}

static void test_each_touch_is_looked_at(void)
{
    add_strokes(10, 0.35, 0.1);
    for (double t = 0; t < 5; t += 4e-3) {
        himc_planner_advance(planner, t);
        for (int i = 0; i < 8 && seen_count < 20000; i++) {
            think_once();
            seen[seen_count++] = planner->clear.walk.t;
        }
    }
    for (int i = 0; i < 10; i++) {
        int k = 0;
        while (k < seen_count && fabs(seen[k] - (1 + 0.175 * i)) > 1e-9)
            k++;
        TEST_ASSERT_TRUE(k < seen_count);
    }
}

/// Real gaps are less than rehearsed ones, most of all those of an arm that is 1 cm out of reach.
static void test_an_arm_out_of_reach_needs_more_room(void)
{
    himc_clearance far = {.sticks = 1, .body = 0.05, .beyond = 0.01, .folded = {1, 1}};
    himc_clearance near = far, reached = far;
    near.body = 0.01;
    reached.body = 0.01;
    reached.beyond = 0;
    TEST_ASSERT_TRUE(himc_planner_least_gap(&far, 0) > 0);
    TEST_ASSERT_TRUE(himc_planner_least_gap(&near, 0) < 0);
    TEST_ASSERT_TRUE(himc_planner_least_gap(&reached, 0) > 0);
}

static void test_a_lift_is_kept_when_the_tip_leaves_the_head_late(void)
{
    planner_hand *h = &planner->hand[HIMC_LEFT];
    for (int i = 0; i < 4; i++)
        add(planner, 2 + 0.35 * i, (himc_hand)(i % 2), HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    for (double t = 0; t < 1.005; t += 4e-3)
        himc_planner_advance(planner, t);
    h->lift = (planner_lift){.hand = HIMC_LEFT,
                             .begin = 1 + HIMC_CONTACT_TIME,
                             .from = 1.12,
                             .to = 1.14,
                             .end = 1.25,
                             .touch = himc_planner_touch_after(h, 1.005),
                             .way = {0, 0, 0.08}};
    TEST_ASSERT_TRUE(himc_planner_lift_from(h, &h->lift, 1));
    double height = himc_planner_target(planner, HIMC_LEFT, 1.13).x.z;
    himc_target left = himc_planner_target(planner, HIMC_LEFT, 1 + HIMC_CONTACT_TIME);
    himc_planner_separated(planner, HIMC_LEFT, 1.02, &left);
    TEST_ASSERT_TRUE(h->plan.lift.count > 0);
    TEST_ASSERT_TRUE(fabs(himc_planner_target(planner, HIMC_LEFT, 1.13).x.z - height) < 0.02);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_what_is_tried_changes_nothing_until_it_is_chosen);
    RUN_TEST(test_each_touch_is_looked_at);
    RUN_TEST(test_an_arm_out_of_reach_needs_more_room);
    RUN_TEST(test_a_lift_is_kept_when_the_tip_leaves_the_head_late);
    return UNITY_END();
}
