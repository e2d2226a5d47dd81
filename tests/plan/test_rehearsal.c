/// test_rehearsal.c: what the planner asks about the body ahead of time, and what it makes of the
/// answers: bodies of a few lines answer.
#include "planners.h"
#include "plan/hand.h"
#include "plan/planner_state.h"

typedef himc_clearance rehearse(const void *motion, const himc_moment *m, himc_rehearsed *r);

static double seen[20000]; // times that were asked for (s)
static int seen_count;

/// Plays strokes of both hands in turn on one drum, with that body; afterwards it is `planner`.
static void play_with(rehearse *body, int strokes, double until)
{
    himc_planner_config config = himc_planner_default();
    config.rehearse = body;
    himc_planner_free(planner);
    planner = make_with(&config, 120);
    seen_count = 0;
    for (int i = 0; i < strokes; i++)
        add(planner, 2 + 0.35 * i, (himc_hand)(i % 2), HIMC_LEGATO, 0.5);
    himc_planner_play(planner, 0);
    for (double t = 0; t < until; t += 4e-3) {
        himc_planner_advance(planner, t);
        himc_planner_think(planner, 200);
    }
}

static int walks; // rehearsals that have begun

/// A body that meets itself all the time but at first, and more with each way that is tried.
static himc_clearance meet_always(const void *motion, const himc_moment *m, himc_rehearsed *r)
{
    (void)motion;
    if (m->after < 0)
        r->state[0] = ++walks;
    return (himc_clearance){
        .sticks = 1, .body = m->after < 0 ? 1 : -0.01 * r->state[0], .folded = {1, 1}, .work = 1};
}

static void test_what_is_tried_in_vain_changes_nothing(void)
{
    himc_planner_config config = himc_planner_default();
    config.rehearse = meet_always;
    himc_planner *trying = make_with(&config, 120);
    for (int i = 0; i < 40; i++) {
        add(planner, 2 + 0.35 * i, (himc_hand)(i % 2), HIMC_LEGATO, 0.5);
        add(trying, 2 + 0.35 * i, (himc_hand)(i % 2), HIMC_LEGATO, 0.5);
    }
    himc_planner_play(planner, 0);
    himc_planner_play(trying, 0);
    for (double t = 0; t < 9; t += 4e-3) {
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            same_state(at(planner, (himc_hand)hand, t), at(trying, (himc_hand)hand, t));
        himc_planner_think(trying, 200);
    }
    TEST_ASSERT_TRUE(himc_planner_work(trying) > 10000);
    himc_planner_free(trying);
}

static himc_clearance free_body(const void *motion, const himc_moment *m, himc_rehearsed *r)
{
    (void)motion, (void)r;
    seen[seen_count++] = m->time;
    return (himc_clearance){.sticks = 1, .body = 1, .folded = {1, 1}, .work = 1};
}

static void test_each_touch_is_looked_at(void)
{
    play_with(free_body, 10, 5);
    for (int i = 0; i < 10; i++) {
        int k = 0;
        while (k < seen_count && fabs(seen[k] - (1 + 0.175 * i)) > 1e-9)
            k++;
        TEST_ASSERT_TRUE(k < seen_count);
    }
}

/// An arm is 1 cm out of reach at the touches.
static himc_clearance stretched(const himc_moment *m, double body)
{
    bool touches = m->after >= 0 && (m->tip[0].z < PLANE + 1e-3 || m->tip[1].z < PLANE + 1e-3);
    return (himc_clearance){.sticks = 1,
                            .body = touches ? body : 1,
                            .beyond = touches ? 0.01 : 0,
                            .folded = {1, 1},
                            .work = 1};
}

static himc_clearance stretched_near(const void *motion, const himc_moment *m, himc_rehearsed *r)
{
    (void)motion, (void)r;
    return stretched(m, 0.01);
}

static himc_clearance stretched_far(const void *motion, const himc_moment *m, himc_rehearsed *r)
{
    (void)motion, (void)r;
    return stretched(m, 0.05);
}

static void test_an_arm_out_of_reach_needs_more_room(void)
{
    himc_planner_note note;
    play_with(stretched_far, 6, 4);
    TEST_ASSERT_FALSE(himc_planner_note_next(planner, &note));
    play_with(stretched_near, 6, 4);
    TEST_ASSERT_TRUE(himc_planner_note_next(planner, &note));
}

/// The left tip has to be high just after its first touch, at 1 s.
static himc_clearance needs_lift(const void *motion, const himc_moment *m, himc_rehearsed *r)
{
    (void)motion, (void)r;
    bool low = m->time > 1.08 && m->time < 1.12 && m->tip[HIMC_LEFT].z < seen[0];
    return (himc_clearance){
        .sticks = low ? -0.01 : 1, .body = 1, .folded = {1, 1}, .order = 1, .work = 1};
}

static void test_a_lift_is_kept_when_the_tip_leaves_the_head_late(void)
{
    play_with(free_body, 4, 0.9);
    seen[0] = himc_planner_target(planner, HIMC_LEFT, 1.1).x.z + 0.05;
    double height = seen[0];
    play_with(needs_lift, 4, 1.005);
    TEST_ASSERT_TRUE(planner->hand[HIMC_LEFT].plan.lift.count > 0);
    TEST_ASSERT_TRUE(himc_planner_target(planner, HIMC_LEFT, 1.1).x.z > height);
    himc_target left = himc_planner_target(planner, HIMC_LEFT, 1 + HIMC_CONTACT_TIME);
    himc_planner_separated(planner, HIMC_LEFT, 1.02, &left);
    TEST_ASSERT_TRUE(planner->hand[HIMC_LEFT].plan.lift.count > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_what_is_tried_in_vain_changes_nothing);
    RUN_TEST(test_each_touch_is_looked_at);
    RUN_TEST(test_an_arm_out_of_reach_needs_more_room);
    RUN_TEST(test_a_lift_is_kept_when_the_tip_leaves_the_head_late);
    return UNITY_END();
}
