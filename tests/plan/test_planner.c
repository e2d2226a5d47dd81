/// test_planner.c: trajectories of the tips: on time, smooth, and different for each nuance.
#include "planners.h"
#include "base/head_frame.h"
#include "plan/hand.h"

#include <stdlib.h>

static void test_tips_touch_on_time_with_no_acceleration_at_any_tempo(void)
{
    for (double bpm = 40; bpm <= 200; bpm += 20)
        for (int nuance = 0; nuance < HIMC_NUANCES; nuance++) {
            use(bpm);
            for (int i = 0; i < 12; i++)
                add(planner, 2 + 0.5 * i, HIMC_RIGHT, (himc_nuance)nuance, i % 8 / 7.0);
            himc_planner_play(planner, 0);
            double start = first_touch(HIMC_RIGHT), worst = 0;
            for (int i = 0; i < 12; i++) {
                double t = start + i * 30 / bpm;
                for (double u = t - 0.05; u < t; u += 0.01)
                    himc_planner_advance(planner, u);
                himc_target s = at(planner, HIMC_RIGHT, t - 1e-12);
                TEST_ASSERT_TRUE(s.v.z < -0.15);
                // the touch is where the height crosses 0
                worst = fmax(worst, fabs((s.x.z - PLANE) / s.v.z));
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, s.a.z);
                TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.75 - 0.225, s.x.x);
                TEST_ASSERT_DOUBLE_WITHIN(1e-9, -0.015, s.x.y);
                TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, s.v.x);
            }
            TEST_ASSERT_TRUE_MESSAGE(worst < 1e-9, "a touch is off by a nanosecond");
        }
}

static void test_impact_speeds_are_those_of_the_nuances_when_there_is_time(void)
{
    static const double forte[HIMC_NUANCES] = {4.3, 4.2, 4.5, 7.5, 2.8};
    for (int nuance = 0; nuance < HIMC_NUANCES; nuance++) {
        use(60);
        add(planner, 2, HIMC_LEFT, (himc_nuance)nuance, 5 / 7.0);
        add(planner, 3, HIMC_LEFT, (himc_nuance)nuance, 1);
        add(planner, 4, HIMC_LEFT, (himc_nuance)nuance, 0);
        himc_planner_play(planner, 0);
        himc_planner_advance(planner, 1.9);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -forte[nuance], at(planner, HIMC_LEFT, 2 - 1e-9).v.z);
        himc_planner_advance(planner, 2.9);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -1.39 * forte[nuance],
                                  at(planner, HIMC_LEFT, 3 - 1e-9).v.z);
        himc_planner_advance(planner, 3.9);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -forte[nuance] / 7.2, at(planner, HIMC_LEFT, 4 - 1e-9).v.z);
    }
}

// the arm goes on with a stick that comes back by itself
static void test_sixteenths_of_doubles_are_within_1_dB_of_single_strokes(void)
{
    static const double bpm[] = {100, 120, 150};
    for (int k = 0; k < 3; k++) {
        use(bpm[k]);
        for (int i = 0; i < 12; i++)
            add(planner, 4 + i / 4.0, i % 4 < 2 ? HIMC_RIGHT : HIMC_LEFT, HIMC_LEGATO, 5 / 7.0);
        himc_planner_play(planner, 0);
        for (int i = 0; i < 12; i++) {
            double time = (4 + i / 4.0) * 60 / bpm[k];
            himc_planner_advance(planner, time - 0.02);
            double speed = -at(planner, i % 4 < 2 ? HIMC_RIGHT : HIMC_LEFT, time - 1e-9).v.z;
            TEST_ASSERT_TRUE(20 * log10(speed / 4.3) > -1);
        }
    }
}

/// Height, depth and rising speed of a stroke, from samples around its touch.
typedef struct shape {
    double apex, depth, up;
} shape;

static shape shape_of(himc_nuance nuance, double dynamic)
{
    shape s = {0, 0, 0};
    use(100);
    for (int i = 0; i < 4; i++)
        add(planner, 2 + i, HIMC_RIGHT, nuance, dynamic);
    himc_planner_play(planner, 0);
    for (double t = 0; t < 3; t += 1e-3) {
        himc_target x = at(planner, HIMC_RIGHT, t);
        if (t > 1.81 && t < 2.4) {
            s.apex = fmax(s.apex, x.x.z - PLANE);
            s.depth = fmax(s.depth, 0.525 - x.x.x);
            if (t < 1.87)
                s.up = fmax(s.up, x.v.z);
        }
    }
    return s;
}

static void test_nuances_keep_their_order_of_height_and_depth_at_every_dynamic(void)
{
    for (int k = 0; k < 8; k++) {
        shape s[HIMC_NUANCES];
        for (int nuance = 0; nuance < HIMC_NUANCES; nuance++)
            s[nuance] = shape_of((himc_nuance)nuance, k / 7.0);
        for (int nuance = 0; nuance < HIMC_NUANCES; nuance++) {
            TEST_ASSERT_TRUE(nuance == HIMC_ACCENT || s[nuance].apex < s[HIMC_ACCENT].apex);
            TEST_ASSERT_TRUE(nuance == HIMC_ACCENT || s[nuance].depth > s[HIMC_ACCENT].depth);
            TEST_ASSERT_TRUE(s[nuance].apex > 0.03 && s[nuance].apex < 0.8);
        }
        TEST_ASSERT_TRUE(s[HIMC_VERTICAL_ACCENT].depth > 1.5 * s[HIMC_LEGATO].depth);
        TEST_ASSERT_TRUE(s[HIMC_STACCATO].depth > 1.2 * s[HIMC_LEGATO].depth);
    }
}

static void test_staccato_is_pulled_off_faster_than_it_strikes(void)
{
    TEST_ASSERT_TRUE(shape_of(HIMC_STACCATO, 5 / 7.0).up > 1.15 * 2.8);
    TEST_ASSERT_TRUE(shape_of(HIMC_TENUTO, 5 / 7.0).up < 0.9 * 4.2);
}

static void test_stroke_before_an_accent_is_lifted_higher(void)
{
    use(100);
    add(planner, 2, HIMC_RIGHT, HIMC_LEGATO, 0.5);
    add(planner, 3, HIMC_RIGHT, HIMC_LEGATO, 0.5);
    add(planner, 4, HIMC_RIGHT, HIMC_ACCENT, 0.5);
    himc_planner_play(planner, 0);
    double legato = 0, accent = 0;
    for (double t = 0; t < 2.4; t += 1e-3) {
        double h = at(planner, HIMC_RIGHT, t).x.z - PLANE;
        if (t > 1.25 && t < 1.8)
            legato = fmax(legato, h);
        if (t > 1.85)
            accent = fmax(accent, h);
    }
    TEST_ASSERT_TRUE(accent > 1.3 * legato);
}

static void test_downstroke_never_rises(void)
{
    for (int nuance = 0; nuance < HIMC_NUANCES; nuance++)
        for (double step = 0.15; step < 2; step *= 1.4) {
            use(60);
            for (int i = 0; i < 6; i++)
                add(planner, 2 + step * i, HIMC_RIGHT, (himc_nuance)nuance, i / 5.0);
            himc_planner_play(planner, 0);
            bool falling = false;
            double before = 0;
            for (double t = 0; t < 2 + 5 * step; t += 5e-4) {
                himc_target s = at(planner, HIMC_RIGHT, t);
                double to_next = fmod(2 - t + 20 * step, step);
                if (t < 2)
                    to_next = 2 - t;
                if (s.v.z < -0.3 && to_next < 0.1)
                    falling = true;
                if (to_next < 1e-3 || to_next > 0.1)
                    falling = false;
                TEST_ASSERT_TRUE(!falling || s.x.z <= before);
                before = s.x.z;
            }
        }
}

static void test_tip_stays_between_head_and_one_metre_above_it(void)
{
    srand(5);
    for (int trial = 0; trial < 40; trial++) {
        double bpm = 40 + rand() % 161, beat = 2, touch[64];
        use(bpm);
        for (int i = 0; i < 40; i++) {
            add(planner, beat, HIMC_LEFT, (himc_nuance)(rand() % 5), rand() % 8 / 7.0);
            touch[i] = beat * 60 / bpm;
            beat += fmax(0.25 * (1 + rand() % 8), 0.15 * bpm / 60);
        }
        himc_planner_play(planner, 0);
        double shift = first_touch(HIMC_LEFT) - touch[0];
        int next = 0;
        for (double t = 0; t < touch[39] + shift + 3; t += 1e-3) {
            double h = at(planner, HIMC_LEFT, t).x.z - PLANE;
            if (next < 40 && t > touch[next] + shift + HIMC_CONTACT_TIME + 1e-4)
                next++;
            bool contact = next < 40 && t > touch[next] + shift;
            TEST_ASSERT_TRUE(contact || h > -1e-9);
            TEST_ASSERT_TRUE(h > -0.05 && h < 1);
        }
    }
}

static double normal_of(himc_vec3 a)
{
    return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z)));
}

/// The largest jump of acceleration between two times, found by bisection.
static double jump_between(himc_hand hand, double t0, double t1)
{
    himc_vec3 a0 = himc_planner_target(planner, hand, t0).a;
    himc_vec3 a1 = himc_planner_target(planner, hand, t1).a;
    while (t1 - t0 > 1e-9) {
        double middle = 0.5 * (t0 + t1);
        himc_vec3 a = himc_planner_target(planner, hand, middle).a;
        if (normal_of(himc_vec3_sub(a, a0)) > normal_of(himc_vec3_sub(a1, a)))
            t1 = middle, a1 = a;
        else
            t0 = middle, a0 = a;
    }
    return normal_of(himc_vec3_sub(a1, a0));
}

static void test_acceleration_has_no_jumps_even_when_the_tempo_changes(void)
{
    double range = 0, sampled = 0, jump = 0;
    srand(11);
    add(planner, 1, HIMC_RIGHT, HIMC_LEGATO, 0.7);
    for (int i = 0; i < 30; i++)
        add(planner, 2 + i * 0.75, HIMC_RIGHT, (himc_nuance)(i % 5), rand() % 8 / 7.0);
    himc_planner_play(planner, 0);
    himc_target before = at(planner, HIMC_RIGHT, 0);
    for (int k = 1; k < 100000; k++) {
        double t = k * 1e-4, touch;
        himc_stroke s;
        int drum;
        himc_target now = himc_planner_target(planner, HIMC_RIGHT, t);
        double step = normal_of(himc_vec3_sub(now.a, before.a));
        if (step > 1)
            jump = fmax(jump, jump_between(HIMC_RIGHT, t - 1e-4, t));
        // in a contact the acceleration changes fast by design
        bool any = himc_planner_current(planner, HIMC_RIGHT, t, &s, &drum, &touch);
        if (!any || t < touch || t > touch + HIMC_CONTACT_TIME + 2e-4) {
            range = fmax(range, normal_of(now.a));
            sampled = fmax(sampled, step);
        }
        before = now;
        if (k % 3701 == 0)
            himc_planner_tempo(planner, t, 60 + rand() % 120);
        himc_planner_advance(planner, t);
    }
    TEST_ASSERT_TRUE(range < 600);
    TEST_ASSERT_TRUE_MESSAGE(sampled < 0.02 * range, "acceleration changes by 2 % in 0.1 ms");
    TEST_ASSERT_TRUE_MESSAGE(jump < 1e-4 * range, "acceleration jumps");
}

static void test_plan_continues_from_the_measured_state_at_separation(void)
{
    for (int i = 0; i < 10; i++)
        add(planner, 2 + i, HIMC_RIGHT, (himc_nuance)(i % 5), 0.7);
    himc_planner_play(planner, 0);
    for (int i = 0; i < 9; i++) {
        double t = 1 + 0.5 * i + 0.004 + 0.001 * i;
        himc_target s = at(planner, HIMC_RIGHT, t);
        s.x = himc_vec3_make(0.523, -0.012, 0.872);
        s.v = himc_vec3_make(0.1, -0.05, 2 + 0.2 * i);
        s.a = himc_vec3_make(5, 3, 100 - 50 * i);
        himc_planner_separated(planner, HIMC_RIGHT, t, &s);
        same_state(s, himc_planner_target(planner, HIMC_RIGHT, t));
        // and the next touch is on time
        himc_target next = {0};
        for (double u = t; u < 1.5 + 0.5 * i; u += 1e-3) {
            himc_target x = at(planner, HIMC_RIGHT, u);
            TEST_ASSERT_TRUE(x.x.z > PLANE - 1e-9);
            TEST_ASSERT_TRUE(normal_of(x.a) < 500);
        }
        next = at(planner, HIMC_RIGHT, 1.5 + 0.5 * i);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, PLANE, next.x.z);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.525, next.x.x);
    }
}

/// The tips pass each other as rehearsed only if a leap begins when it was planned to.
static void test_a_rebound_as_predicted_changes_the_plan_by_less_than_a_millimetre(void)
{
    static const himc_head_frame far = {.center = {0.35, -0.8, 0.8}, .radius = 0.33};
    himc_stroke s = {.beat = 2.3, .hand = HIMC_RIGHT, .dynamic = 0.5};
    use(60);
    TEST_ASSERT_TRUE(himc_planner_set_drum(planner, 1, &far));
    add(planner, 2, HIMC_RIGHT, HIMC_LEGATO, 0.5);
    TEST_ASSERT_TRUE(himc_planner_add(planner, &s, 1, &error));
    himc_planner_play(planner, 0);
    double t = 2 + HIMC_CONTACT_TIME;
    himc_target left = at(planner, HIMC_RIGHT, t), before[20];
    for (int i = 0; i < 20; i++)
        before[i] = himc_planner_target(planner, HIMC_RIGHT, t + 0.01 * i);
    himc_planner_separated(planner, HIMC_RIGHT, t, &left);
    for (int i = 0; i < 20; i++) {
        himc_target now = himc_planner_target(planner, HIMC_RIGHT, t + 0.01 * i);
        TEST_ASSERT_TRUE(himc_vec3_length(himc_vec3_sub(now.x, before[i].x)) < 1e-3);
    }
}

static void test_tip_lands_on_the_other_drum_along_its_normal(void)
{
    himc_head_frame place = {.center = {0.7, 0.65, 0.8}, .tilt = 0.15, .radius = 0.33};
    himc_stroke s = {.beat = 3, .hand = HIMC_LEFT, .dynamic = 0.7, .spot = HIMC_SPOT_XY, .x = -0.1};
    add(planner, 2, HIMC_LEFT, HIMC_LEGATO, 0.7);
    TEST_ASSERT_TRUE(himc_planner_add(planner, &s, 1, &error));
    himc_planner_play(planner, 0);
    himc_planner_advance(planner, 1.4);
    himc_target x = at(planner, HIMC_LEFT, 1.5 - 1e-10);
    himc_vec3 p = himc_head_frame_from_world(&place, x.x), n = himc_head_frame_normal(&place);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, -0.1, p.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0, p.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.02, p.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, himc_vec3_length(x.v), -himc_vec3_dot(x.v, n));
}

/// The greatest acceleration along the head from t0 to t1 (m/s^2).
static double hardest(const himc_hand_plan *plan, double t0, double t1)
{
    double most = 0;
    for (double t = t0; t < t1; t += 1e-3)
        most = fmax(most, himc_vec3_length(himc_spline_at(&plan->tangential_path, t).a));
    return most;
}

// between places a little behind the player, on both sides
static void test_a_way_past_the_body_leads_before_it(void)
{
    himc_hand_plan plan;
    himc_gesture gesture = himc_gesture_of(HIMC_LEGATO, 0.5);
    himc_goal first = {1, {-0.05, 0.5, PLANE}, {0, 0, 1}, {0, -1, 0}, gesture, 0, false},
              second = {2, {-0.05, -0.5, PLANE}, {0, 0, 1}, {0, 1, 0}, gesture, 0, false};
    himc_hand_place(&plan, 0, himc_vec3_make(-0.05, 0.5, 1));
    TEST_ASSERT_TRUE(himc_hand_strike(&plan, &first) && himc_hand_strike(&plan, &second));
    for (double t = 1; t < 2; t += 0.01) {
        himc_vec3 x = himc_hand_at(&plan, t).x;
        TEST_ASSERT_TRUE(hypot(x.x, x.y) > 0.3);
        TEST_ASSERT_TRUE(x.x > -0.08);
    }
}

/// A leap of 0.66 m in so much time; after this share of it, if not 0, to a spot 5 cm aside.
static void leap(double time, double share)
{
    himc_hand_plan plan;
    himc_gesture gesture = himc_gesture_of(HIMC_LEGATO, 0.5);
    himc_goal first = {1, {0.4, 0.2, PLANE}, {0, 0, 1}, {-1, 0, 0}, gesture, 0, false},
              second = first;
    second.time += time;
    second.spot = himc_vec3_make(0.5, -0.45, PLANE);
    himc_hand_place(&plan, 0, himc_vec3_make(0.4, 0.2, 1));
    TEST_ASSERT_TRUE(himc_hand_strike(&plan, &first) && himc_hand_strike(&plan, &second));
    if (share > 0) {
        himc_hand_cut(&plan, first.time + share * time);
        second.spot.y -= 0.05;
        TEST_ASSERT_TRUE(himc_hand_strike(&plan, &second));
    }
    double most = hardest(&plan, first.time, second.time);
    TEST_ASSERT_TRUE(most < 2 * HIMC_MOVE_PEAK * 0.66 / (time * time));
}

static void test_a_leap_in_a_hurry_takes_all_its_time_and_is_not_halted_on_the_way(void)
{
    for (double time = 0.26; time < 0.3; time += 0.01)
        for (double share = 0; share < 0.6; share += 0.1)
            leap(time, share);
}

/// Least distance of a leap's way from the body's axis, and its greatest from a straight one (m).
static double nearest(himc_vec3 from, himc_vec3 to, double time, bool straight, double *off)
{
    himc_hand_plan plan;
    himc_gesture gesture = himc_gesture_of(HIMC_LEGATO, 0.5);
    himc_goal goal = {1, from, {0, 0, 1}, {-1, 0, 0}, gesture, 0, straight};
    double least = INFINITY;
    himc_hand_place(&plan, 0, himc_vec3_make(from.x, from.y, 1));
    TEST_ASSERT_TRUE(himc_hand_strike(&plan, &goal));
    goal.time += time;
    goal.spot = to;
    TEST_ASSERT_TRUE(himc_hand_strike(&plan, &goal));
    himc_vec3 way = himc_vec3_unit(himc_vec3_sub(to, from));
    *off = 0;
    for (double t = 1; t < goal.time; t += 1e-3) {
        himc_vec3 x = himc_hand_at(&plan, t).x;
        least = fmin(least, hypot(x.x, x.y));
        *off = fmax(*off, fabs((x.x - from.x) * way.y - (x.y - from.y) * way.x));
    }
    return least;
}

static void test_a_long_way_goes_round_the_body_and_a_short_one_straight(void)
{
    himc_vec3 low = {0.25, 0.84, PLANE}, high = {0.25, -0.84, PLANE}, near = {0.5, 0.1, PLANE};
    double off, short_off;
    for (double time = 0.6; time < 1.5; time += 0.1) {
        TEST_ASSERT_TRUE(nearest(low, high, time, false, &off) > 0.55);
        TEST_ASSERT_TRUE(nearest(low, high, time, true, &off) > 0.4);
        nearest(near, himc_vec3_make(0.5, -0.1, PLANE), time, false, &off);
        nearest(near, himc_vec3_make(0.5, -0.1, PLANE), time, true, &short_off);
        TEST_ASSERT_EQUAL_DOUBLE(short_off, off);
    }
}

static void test_a_tip_that_has_time_does_not_dart_on_its_way_behind_the_spot(void)
{
    himc_gesture gesture = himc_gesture_of(HIMC_VERTICAL_ACCENT, 0.8);
    for (double time = 0.8; time < 3; time += 0.01) {
        himc_hand_plan plan;
        himc_goal goal = {1, {0.5, 0, PLANE}, {0, 0, 1}, {-1, 0, 0}, gesture, 0, false};
        himc_hand_place(&plan, 0, himc_vec3_make(0.5, 0, 1));
        TEST_ASSERT_TRUE(himc_hand_strike(&plan, &goal));
        goal.time += time;
        TEST_ASSERT_TRUE(himc_hand_strike(&plan, &goal));
        TEST_ASSERT_TRUE(hardest(&plan, 1, goal.time - 0.35) < 10); // then it swings forward
    }
}

static void test_lift_without_a_dwell_is_finite_and_ends_where_it_began(void)
{
    himc_hand_plan plan;
    himc_vec3 home = {0.5, 0, 1}, way = {0, 0, 0.08};
    himc_hand_place(&plan, 0, home);
    TEST_ASSERT_TRUE(himc_hand_lift(&plan, 0.1, 0.2, 0.2, 0.3, way));
    TEST_ASSERT_TRUE(himc_hand_is_sound(&plan, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, home.z + way.z, himc_hand_at(&plan, 0.2).x.z);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, home.z, himc_hand_at(&plan, 0.3).x.z);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_tips_touch_on_time_with_no_acceleration_at_any_tempo);
    RUN_TEST(test_impact_speeds_are_those_of_the_nuances_when_there_is_time);
    RUN_TEST(test_sixteenths_of_doubles_are_within_1_dB_of_single_strokes);
    RUN_TEST(test_nuances_keep_their_order_of_height_and_depth_at_every_dynamic);
    RUN_TEST(test_staccato_is_pulled_off_faster_than_it_strikes);
    RUN_TEST(test_stroke_before_an_accent_is_lifted_higher);
    RUN_TEST(test_downstroke_never_rises);
    RUN_TEST(test_tip_stays_between_head_and_one_metre_above_it);
    RUN_TEST(test_acceleration_has_no_jumps_even_when_the_tempo_changes);
    RUN_TEST(test_plan_continues_from_the_measured_state_at_separation);
    RUN_TEST(test_a_rebound_as_predicted_changes_the_plan_by_less_than_a_millimetre);
    RUN_TEST(test_tip_lands_on_the_other_drum_along_its_normal);
    RUN_TEST(test_a_long_way_goes_round_the_body_and_a_short_one_straight);
    RUN_TEST(test_a_tip_that_has_time_does_not_dart_on_its_way_behind_the_spot);
    RUN_TEST(test_a_way_past_the_body_leads_before_it);
    RUN_TEST(test_a_leap_in_a_hurry_takes_all_its_time_and_is_not_halted_on_the_way);
    RUN_TEST(test_lift_without_a_dwell_is_finite_and_ends_where_it_began);
    return UNITY_END();
}
