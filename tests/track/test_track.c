/// test_track.c: the tips of a take as targets: impacts are sharp, all else is smooth, and after an
/// impact the take is rejoined from the measured state.
#include "allocations.h"
#include "tracks.h"

#define RATE 250
#define RADIUS 0.0175

static int left_out; // frames at the beginning

// the right tip alone, in millimetres with y up as in TRC; the third strike is `raised` (m)
static void make_take_with(double speed, double noise, double raised)
{
    static char text[60000];
    int frames = 1000, used;
    srand(12);
    used = snprintf(
        text, sizeof text,
        "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\t"
        "Units\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n%d\t%d\t%d\t1\tmm\t%d\t1\t"
        "%d\nFrame#\tTime\tRTIP\t\t\n\t\tX1\tY1\tZ1\n\n",
        RATE, RATE, frames, RATE, frames);
    for (int i = 0; i < frames; i++) {
        double t = (double)(i + left_out) / RATE, z = beaten_height(t, speed).x.z;
        z += fabs(t - 1.4) < 0.25 ? raised * 0.5 * (1 + cos(4 * HIMC_PI * (t - 1.4))) : 0;
        z += noise * (2.0 * rand() / RAND_MAX - 1);
        used += snprintf(text + used, sizeof text - (size_t)used, "%d\t%.6f\t%.5f\t%.5f\t%.5f\n",
                         i + 1, t, 600 + 20 * sin(4 * t), 1000 + 1000 * z, 50.0);
    }
    take = read_text(text, "a.trc", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    himc_take_options options = himc_take_default();
    track = himc_track_new(take, &options, &place, NULL, RADIUS, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
}

static void make_take(double speed, double noise)
{
    make_take_with(speed, noise, 0);
}

// the take bounces in no time; a contact of 7 ms between the same fall and rebound begins so much
// earlier (s)
#define EARLIER 0.0033

static himc_target at(double t)
{
    return himc_track_target(track, HIMC_RIGHT, t);
}

static double distance(himc_vec3 a, himc_vec3 b)
{
    return himc_vec3_length(himc_vec3_sub(a, b));
}

static void test_every_strike_of_a_bouncing_take_is_found_near_its_time(void)
{
    make_take(4, 0);
    TEST_ASSERT_FALSE(himc_track_present(track, HIMC_LEFT));
    TEST_ASSERT_TRUE(himc_track_present(track, HIMC_RIGHT));
    TEST_ASSERT_EQUAL_INT(0, himc_track_strikes(track, HIMC_LEFT));
    TEST_ASSERT_EQUAL_INT(8, himc_track_strikes(track, HIMC_RIGHT));
    for (int k = 1; k <= 8; k++) {
        double time, x, y;
        TEST_ASSERT_TRUE(himc_track_current(track, HIMC_RIGHT, 0.5 * k - 0.3, &time, &x, &y));
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.5 * k - 0.1 - EARLIER, time);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, -0.225, x); // three quarters of the radius to the player
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 0, y);
    }
    double time, x, y;
    TEST_ASSERT_FALSE(himc_track_current(track, HIMC_RIGHT, 3.99, &time, &x, &y));
    TEST_ASSERT_FALSE(himc_track_current(track, HIMC_LEFT, 0.1, &time, &x, &y));
}

// largest relative error of the impact speed of all strikes
static double worst_speed(double speed, double noise)
{
    double worst = 0;
    make_take(speed, noise);
    TEST_ASSERT_EQUAL_INT(8, himc_track_strikes(track, HIMC_RIGHT));
    for (int k = 1; k <= 8; k++) {
        double time, x, y;
        himc_track_current(track, HIMC_RIGHT, 0.5 * k - 0.3, &time, &x, &y);
        worst = fmax(worst, fabs(at(time - 1e-9).v.z / -speed - 1));
        TEST_ASSERT_DOUBLE_WITHIN(0.003, 0.85 + RADIUS, at(time).x.z);
    }
    tearDown();
    setUp();
    return worst;
}

static void test_impact_speed_is_recovered_within_two_percent(void)
{
    TEST_ASSERT_TRUE(worst_speed(2, 0) < 0.02);
    TEST_ASSERT_TRUE(worst_speed(4, 0) < 0.02);
    TEST_ASSERT_TRUE(worst_speed(5.5, 0) < 0.02);
}

static void test_impact_speed_survives_noise_of_a_fifth_of_a_millimetre(void)
{
    TEST_ASSERT_TRUE(worst_speed(4, 0.0002) < 0.05);
}

// largest errors of extrapolation over steps of 10 us, of position, velocity and acceleration:
// jumps, and a little of the jerk
static void largest_jumps(double from, double to, double jump[3])
{
    double h = 1e-5, time = -1, x, y;
    jump[0] = jump[1] = jump[2] = 0;
    for (long n = lround(from / h); n < lround(to / h); n++) {
        double t = n * h;
        himc_target a = at(t), b = at(t + h);
        // the strike whose contact falls into this step, if any
        if (himc_track_current(track, HIMC_RIGHT, t, &time, &x, &y) && t < time && t + h >= time)
            continue;
        himc_vec3 v = himc_vec3_madd(a.v, h, a.a);
        jump[0] = fmax(jump[0], distance(himc_vec3_madd(a.x, 0.5 * h, himc_vec3_add(a.v, v)), b.x));
        jump[1] = fmax(jump[1], distance(v, b.v));
        jump[2] = fmax(jump[2], distance(a.a, b.a));
    }
}

static void test_target_is_smooth_except_at_the_contact(void)
{
    double jump[3];
    make_take(4, 0.0002);
    largest_jumps(0.05, 3.9, jump);
    TEST_ASSERT_TRUE(jump[0] < 1e-8);
    TEST_ASSERT_TRUE(jump[1] < 1e-4);
    TEST_ASSERT_TRUE(jump[2] < 10); // the jerk of 7e5 m/s^3 after a blow
}

static void test_after_separation_the_target_continues_from_the_measured_state_and_rejoins(void)
{
    make_take(4, 0);
    double time, x, y;
    himc_track_current(track, HIMC_RIGHT, 0.2, &time, &x, &y);
    double left = time + 0.0065, again;
    himc_target measured = at(time);
    measured.x.z += 0.002;
    measured.v = himc_vec3_make(0.1, -0.05, 3.2);
    measured.a = himc_vec3_make(1, 2, -30);
    himc_track_source.separated(track, HIMC_RIGHT, left, &measured);
    himc_target now = at(left);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(measured.x, now.x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(measured.v, now.v));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(measured.a, now.a));
    himc_target before = at(left + 0.020 - 1e-7), after = at(left + 0.020 + 1e-7);
    TEST_ASSERT_DOUBLE_WITHIN(2e-6, 0, distance(before.x, after.x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, distance(before.v, after.v));
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0, distance(before.a, after.a));
    // it is struck: the next one is ahead
    TEST_ASSERT_TRUE(himc_track_current(track, HIMC_RIGHT, left + 0.001, &again, &x, &y));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.9 - EARLIER, again);
}

static void test_20_ms_after_separation_the_take_is_followed_at_any_speed_of_the_stick(void)
{
    himc_vec3 rejoined[2];
    for (int i = 0; i < 2; i++) {
        double time, x, y;
        make_take(4, 0);
        himc_track_current(track, HIMC_RIGHT, 0.2, &time, &x, &y);
        himc_target measured = at(time);
        measured.v = himc_vec3_make(0, 0, i ? 3.6 : 1.8);
        himc_track_source.separated(track, HIMC_RIGHT, time + 0.0065, &measured);
        rejoined[i] = at(time + 0.0065 + 0.0201).x;
        tearDown();
        setUp();
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, distance(rejoined[0], rejoined[1]));
}

static void test_after_rewind_the_track_is_the_same_bit_by_bit(void)
{
    make_take(4, 0.0002);
    enum { N = 4500 };
    static himc_target first[N];
    for (int i = 0; i < N; i++)
        first[i] = at(i * 1e-3);
    himc_target measured = at(0.4);
    himc_track_source.separated(track, HIMC_RIGHT, 0.407, &measured);
    himc_target now[HIMC_HANDS] = {measured, measured};
    himc_track_source.stop(track, 1.3, now);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.7, himc_track_length(track));
    himc_track_rewind(track, 0);
    for (int i = 0; i < N; i++) {
        himc_target again = at(i * 1e-3);
        TEST_ASSERT_EQUAL_MEMORY(&first[i], &again, sizeof again);
    }
}

static void test_approach_and_stop_lead_in_and_out_smoothly(void)
{
    make_take(4, 0);
    himc_target rest = {.x = {0.3, -0.2, 1.1}}, now[HIMC_HANDS];
    himc_track_approach(track, HIMC_RIGHT, &rest, 0.8);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(rest.x, at(-0.8).x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(rest.x, at(-2).x));
    himc_target before = at(-1e-9), after = at(0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0, distance(before.x, after.x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, distance(before.v, after.v));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, distance(before.a, after.a));
    now[0] = now[1] = at(1.2);
    himc_track_source.stop(track, 1.2, now);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(now[1].x, at(1.2).x));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(now[1].v, at(1.2).v));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, himc_vec3_length(at(himc_track_length(track)).v));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(at(5).x, at(9).x));
}

static void test_a_stop_after_the_end_changes_nothing(void)
{
    make_take(4, 0);
    himc_target far = {.x = {0.1, -0.4, 1.4}}, now[HIMC_HANDS] = {far, far};
    double length = himc_track_length(track);
    himc_vec3 before = at(length + 1).x;
    himc_track_source.stop(track, length + 0.1, now);
    TEST_ASSERT_EQUAL_DOUBLE(length, himc_track_length(track));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, distance(before, at(length + 1).x));
}

static void test_the_take_may_be_freed_and_the_strikes_are_on_the_usual_spot(void)
{
    make_take(4, 0);
    himc_vec3 spot = {0.5 - 0.225, -0.015, 0.85 + RADIUS}, mean = {0, 0, 0};
    himc_take_free(take);
    take = NULL;
    for (int k = 1; k <= 8; k++) {
        double time, x, y;
        himc_track_current(track, HIMC_RIGHT, 0.5 * k - 0.3, &time, &x, &y);
        mean = himc_vec3_madd(mean, 1 / 8.0, at(time).x);
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0, distance(spot, mean));
}

static void test_one_strike_in_another_place_does_not_move_the_head(void)
{
    make_take_with(4, 0, 0.15);
    for (int k = 1; k <= 8; k++) {
        double time, x, y;
        if (k == 3)
            continue;
        TEST_ASSERT_TRUE(himc_track_current(track, HIMC_RIGHT, 0.5 * k - 0.3, &time, &x, &y));
        TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.5 * k - 0.1 - EARLIER, time);
    }
}

static void test_playing_allocates_nothing(void)
{
    make_take(4, 0);
    double time, x, y;
    watch_allocations();
    himc_target s = at(0.2), both[HIMC_HANDS] = {s, s};
    himc_track_approach(track, HIMC_RIGHT, &s, 0.5);
    for (double t = -0.5; t < 4; t += 1e-3)
        s = at(t);
    himc_track_current(track, HIMC_RIGHT, 0.2, &time, &x, &y);
    himc_track_source.separated(track, HIMC_RIGHT, time + 0.007, &s);
    himc_track_source.stop(track, 2, both);
    himc_track_rewind(track, 0);
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
}

static void test_a_nudge_is_smooth_and_leaves_strikes_their_height_and_speed(void)
{
    make_take(4, 0.0002);
    double jump[3], time, x, y, after_x, after_y;
    himc_track_current(track, HIMC_RIGHT, 1.7, &time, &x, &y);
    himc_target far = at(0.9), before = at(time - 1e-9), middle = at(1.7);
    himc_nudge one = {HIMC_RIGHT, 1.7, 0.6, {0.03, -0.02, 0.05}, 0, 0},
               at_strike = {HIMC_RIGHT, 1.9, 0.4, {-0.04, 0.01, 0.3}, 0, 0};
    TEST_ASSERT_TRUE(himc_track_nudge(track, &one, &error));
    himc_target moved = at(1.7);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, middle.x.x + 0.03, moved.x.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, middle.x.z + 0.05, moved.x.z);
    TEST_ASSERT_TRUE(himc_track_nudge(track, &at_strike, &error));
    himc_target still = at(0.9), touch = at(time - 1e-9);
    TEST_ASSERT_EQUAL_MEMORY(&far, &still, sizeof far);
    TEST_ASSERT_EQUAL_DOUBLE(before.x.z, touch.x.z);
    TEST_ASSERT_EQUAL_DOUBLE(before.v.z, touch.v.z);
    himc_track_current(track, HIMC_RIGHT, 1.7, &time, &after_x, &after_y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, touch.x.x - before.x.x, after_x - x);
    largest_jumps(0.05, 3.9, jump);
    TEST_ASSERT_TRUE(jump[0] < 1e-8);
    TEST_ASSERT_TRUE(jump[1] < 1e-4);
    TEST_ASSERT_TRUE(jump[2] < 10);
}

static void test_nudges_outside_the_take_are_refused(void)
{
    make_take(4, 0);
    himc_nudge early = {HIMC_RIGHT, 0.2, 0.3, {0, 0, 0.1}, 0, 0}, left = early, good = early;
    left.hand = HIMC_LEFT;
    good.time = left.time = 1;
    TEST_ASSERT_FALSE(himc_track_nudge(track, &early, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "TIME"));
    TEST_ASSERT_FALSE(himc_track_nudge(track, &left, &error));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "left"));
    // while it plays: not if it has begun
    himc_track *unnudged = track, *nudged;
    himc_take *first = take;
    make_take(4, 0);
    nudged = track;
    TEST_ASSERT_TRUE(himc_track_nudge(nudged, &good, &error));
    TEST_ASSERT_FALSE(himc_track_exchange(unnudged, nudged, 0.8));
    TEST_ASSERT_TRUE(himc_track_exchange(unnudged, nudged, 0.5));
    himc_track_free(nudged);
    himc_take_free(take);
    make_take(4, 0);
    TEST_ASSERT_FALSE(himc_track_exchange(unnudged, track, 0.8));
    TEST_ASSERT_TRUE(himc_track_exchange(unnudged, track, 0.5));
    himc_track_free(unnudged);
    himc_take_free(first);
}

static void test_a_hand_without_a_tip_rests(void)
{
    make_take(4, 0);
    himc_target s = himc_track_target(track, HIMC_LEFT, 1);
    TEST_ASSERT_TRUE(himc_vec3_finite(s.x));
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_vec3_length(s.v));
}

// a real stroke: 240 Hz, downwards at 9.3 m/s, with its bounce
static void test_real_stroke_arrives_at_nine_metres_per_second_and_is_smooth(void)
{
    const char *path = shared_capture("drumstroke_pearl_240hz/stroke.trc");
    if (!path)
        TEST_IGNORE_MESSAGE("no ../shared/mocap");
    himc_take_options options = himc_take_default();
    double time, x, y, jump[3];
    take = himc_take_load(path, &options, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    track = himc_track_new(take, &options, &place, NULL, RADIUS, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
    TEST_ASSERT_EQUAL_INT(1, himc_track_strikes(track, HIMC_RIGHT));
    TEST_ASSERT_TRUE(himc_track_current(track, HIMC_RIGHT, 0, &time, &x, &y));
    double v = at(time - 1e-9).v.z;
    // the fastest two frames give 9.43 m/s; the capture's filter has taken some, a spline loses
    // 13 % of a blow
    TEST_ASSERT_DOUBLE_WITHIN(0.07 * 10.1, -10.1, v);
    largest_jumps(0.01, himc_track_length(track) - 0.01, jump);
    TEST_ASSERT_TRUE(jump[0] < 1e-8);
    TEST_ASSERT_TRUE(jump[1] < 1e-4);
    TEST_ASSERT_TRUE(jump[2] < 15);
}

// its frames are cut out 12.5 ms, four frames, to either side; two are the least before them
static void test_a_strike_needs_two_frames_before_what_is_cut_out(void)
{
    for (left_out = 92; left_out < 98; left_out++) {
        make_take(4, 0);
        TEST_ASSERT_EQUAL_INT(100 - left_out - 4 < 2 ? 7 : 8,
                              himc_track_strikes(track, HIMC_RIGHT));
        tearDown();
        setUp();
    }
    left_out = 0;
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_strike_of_a_bouncing_take_is_found_near_its_time);
    RUN_TEST(test_impact_speed_is_recovered_within_two_percent);
    RUN_TEST(test_impact_speed_survives_noise_of_a_fifth_of_a_millimetre);
    RUN_TEST(test_target_is_smooth_except_at_the_contact);
    RUN_TEST(test_after_separation_the_target_continues_from_the_measured_state_and_rejoins);
    RUN_TEST(test_20_ms_after_separation_the_take_is_followed_at_any_speed_of_the_stick);
    RUN_TEST(test_after_rewind_the_track_is_the_same_bit_by_bit);
    RUN_TEST(test_approach_and_stop_lead_in_and_out_smoothly);
    RUN_TEST(test_a_stop_after_the_end_changes_nothing);
    RUN_TEST(test_the_take_may_be_freed_and_the_strikes_are_on_the_usual_spot);
    RUN_TEST(test_one_strike_in_another_place_does_not_move_the_head);
    RUN_TEST(test_playing_allocates_nothing);
    RUN_TEST(test_real_stroke_arrives_at_nine_metres_per_second_and_is_smooth);
    RUN_TEST(test_a_hand_without_a_tip_rests);
    RUN_TEST(test_a_strike_needs_two_frames_before_what_is_cut_out);
    RUN_TEST(test_a_nudge_is_smooth_and_leaves_strikes_their_height_and_speed);
    RUN_TEST(test_nudges_outside_the_take_are_refused);
    return UNITY_END();
}
