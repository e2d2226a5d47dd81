/// test_take_strikes.c: blows of known time, speed and place in synthetic tracks, and the real drum
/// stroke.
#include "take_motions.h"

#include "track/track.h"
#include "capture/units.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static himc_vec3 dead_stroke(double t)
{
    return himc_vec3_make(0.6, 0.1, 0.8 + (t < touch_time ? bounce_height(t) : 0));
}

// the same strike seen through a low-pass filter of about 40 Hz
static himc_vec3 blunt_bounce(double t)
{
    double sum = 0, weight = 0, s = 0.004;
    for (int i = -40; i <= 40; i++) {
        double u = i * s / 10, w = exp(-0.5 * u * u / (s * s));
        sum += w * bounce_height(t + u);
        weight += w;
    }
    return himc_vec3_make(0.6, 0.1, 0.8 + sum / weight);
}

static void test_strike_between_frames_is_found_at_any_rate_and_phase(void)
{
    static const double rates[] = {100, 120, 250, 500, 1000, 2000};
    double worst_time = 0, worst_speed = 0, worst_height = 0;
    for (int i = 0; i < 6; i++)
        for (int phase = 0; phase < 10; phase++) {
            touch_time = 0.5 + phase / (10 * rates[i]);
            himc_take *take = read_motion(bounce, rates[i], (int)rates[i]);
            himc_take_strike s[4];
            TEST_ASSERT_EQUAL_INT(1, strikes_of(take, s, 4));
            worst_time = fmax(worst_time, fabs(s[0].time - touch_time));
            worst_speed = fmax(worst_speed, fabs(s[0].velocity - 4));
            worst_height = fmax(worst_height, fabs(s[0].x.z - 0.8));
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.6 + 0.1 * touch_time, s[0].x.x);
            TEST_ASSERT_DOUBLE_WITHIN(1.01 / rates[i], touch_time, s[0].frame / rates[i]);
            himc_take_free(take);
        }
    printf("sharp strikes: time within %.3g ms, speed %.3g %%, height %.3g mm\n", worst_time * 1000,
           worst_speed * 25, worst_height * 1000);
    TEST_ASSERT_TRUE(worst_time < 2e-4);
    TEST_ASSERT_TRUE(worst_speed < 0.04);
    TEST_ASSERT_TRUE(worst_height < 1e-3);
}

static void test_dead_stroke_is_found(void)
{
    for (int phase = 0; phase < 10; phase++) {
        touch_time = 0.5 + phase / 2500.0;
        himc_take *take = read_motion(dead_stroke, 250, 250);
        himc_take_strike s[4];
        TEST_ASSERT_EQUAL_INT(1, strikes_of(take, s, 4));
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, touch_time, s[0].time);
        TEST_ASSERT_DOUBLE_WITHIN(0.04, 4, s[0].velocity);
        himc_take_free(take);
    }
}

static void test_low_pass_filtered_strike_is_found_within_3_ms_and_10_percent(void)
{
    double worst_time = 0, worst_speed = 0;
    for (int phase = 0; phase < 10; phase++) {
        touch_time = 0.5 + phase / 2500.0;
        himc_take *take = read_motion(blunt_bounce, 250, 250);
        himc_take_strike s[4];
        TEST_ASSERT_EQUAL_INT(1, strikes_of(take, s, 4));
        worst_time = fmax(worst_time, fabs(s[0].time - touch_time));
        worst_speed = fmax(worst_speed, fabs(s[0].velocity - 4));
        himc_take_free(take);
    }
    printf("blunt strikes: time within %.3g ms, speed %.3g %%\n", worst_time * 1000,
           worst_speed * 25);
    TEST_ASSERT_TRUE(worst_time < 3e-3);
    TEST_ASSERT_TRUE(worst_speed < 0.4);
}

static void test_half_a_millimetre_of_noise_neither_hides_nor_adds_strikes(void)
{
    noise = 5e-4;
    touch_time = 0.5;
    for (int i = 0; i < 20; i++) {
        himc_take_strike s[4];
        himc_take *take = read_motion(bounce, 250, 250);
        TEST_ASSERT_EQUAL_INT(1, strikes_of(take, s, 4));
        TEST_ASSERT_DOUBLE_WITHIN(4e-3, touch_time, s[0].time);
        TEST_ASSERT_DOUBLE_WITHIN(0.6, 4, s[0].velocity);
        himc_take_free(take);
        take = read_motion(stroke_in_the_air, 250, 500);
        TEST_ASSERT_EQUAL_INT(0, strikes_of(take, s, 4));
        himc_take_free(take);
    }
    noise = 0;
}

static void test_strokes_in_the_air_are_not_strikes(void)
{
    for (double rate = 60; rate <= 2000; rate *= 2) {
        himc_take *take = read_motion(stroke_in_the_air, rate, (int)(2 * rate));
        TEST_ASSERT_EQUAL_INT(0, strikes_of(take, NULL, 0));
        himc_take_free(take);
    }
}

static int hidden_from, hidden_to; // frames of 4 ms

static himc_vec3 hidden_bounce(double t)
{
    int frame = (int)lround(t * 250);
    return frame >= hidden_from && frame < hidden_to ? himc_vec3_make(NAN, NAN, NAN) : bounce(t);
}

static int strikes_hidden(int from, int to, int frames)
{
    hidden_from = from;
    hidden_to = to;
    himc_take *take = read_motion(hidden_bounce, 250, frames);
    int count = strikes_of(take, NULL, 0);
    himc_take_free(take);
    return count;
}

// the touch is in frame 125
static void test_strike_with_one_lost_frame_is_found_and_none_across_or_beside_a_longer_gap(void)
{
    touch_time = 0.5;
    for (int frame = 121; frame < 130; frame++)
        TEST_ASSERT_EQUAL_INT(1, strikes_hidden(frame, frame + 1, 250));
    TEST_ASSERT_EQUAL_INT(1, strikes_hidden(124, 127, 250)); // 12 ms
    for (int length = 4; length <= 40; length += 6)
        for (int from = 126 - length; from <= 126; from++)
            TEST_ASSERT_EQUAL_INT(0, strikes_hidden(from, from + length, 250));
}

// a position that is held at an end looks like a fall that ends abruptly
static void test_no_strike_at_an_end_where_the_position_is_held(void)
{
    touch_time = 0.5;
    for (int begin = 110; begin <= 126; begin++)
        for (int lost = 1; lost < 40; lost++)
            TEST_ASSERT_EQUAL_INT(0, strikes_hidden(begin, begin + lost, begin + lost));
}

static void test_strikes_of_both_hands_come_in_order_and_place_the_drum(void)
{
    himc_take *take = read_roll(600);
    himc_take_strike s[32];
    int count = strikes_of(take, s, 32);
    TEST_ASSERT_EQUAL_INT(15, count);
    for (int i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_INT(i % 2 ? HIMC_LEFT : HIMC_RIGHT, s[i].hand);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.2 + 0.3 * (i / 2) + 0.11 * (i % 2), s[i].time);
    }
    himc_strike_survey survey;
    himc_take_tip tips[HIMC_HANDS];
    TEST_ASSERT_TRUE(himc_take_tips(take, NULL, tips, &error));
    TEST_ASSERT_TRUE(himc_take_strikes(take, tips, &survey));
    TEST_ASSERT_EQUAL_INT(1, survey.heads);
    TEST_ASSERT_EQUAL_INT(0, survey.left_out);
    himc_vec3 place = survey.head[0];
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.65, place.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.05, place.y);
    // falls of 4 m/s and rebounds of 2.5 m/s intersect at 0.8 m: a contact of 7 ms joins them
    // higher
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.8 + 0.007 * 4 * 2.5 / 6.5, place.z);
    free(survey.strikes);
    himc_take_free(take);
}

// ten minutes of a roll: no strike is lost on the way to the track or to the units
static void test_each_of_4200_strikes_is_found_tracked_and_cut(void)
{
    himc_take *take = read_roll(630 * 250 + 50);
    himc_take_tip tips[HIMC_HANDS];
    TEST_ASSERT_TRUE_MESSAGE(himc_take_tips(take, NULL, tips, &error), error.text);
    int count;
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &count);
    TEST_ASSERT_EQUAL_INT(4200, count);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 630 - 0.1, strikes[2 * 2099].time);
    free(strikes);

    himc_head_frame place = {.center = himc_vec3_make(0.6, 0, 0.8), .radius = 0.3};
    himc_track *track = himc_track_new(take, NULL, &place, NULL, 0.02, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(track, error.text);
    TEST_ASSERT_EQUAL_INT(4200, himc_track_strikes(track, HIMC_LEFT) +
                                    himc_track_strikes(track, HIMC_RIGHT));
    himc_track_free(track);

    himc_unit units[3] = {{.height = 0}, {.height = 0}, {.height = -1}};
    TEST_ASSERT_INT_WITHIN(4, 4200, himc_units_cut(take, NULL, units, 2, &error));
    TEST_ASSERT_TRUE(units[0].height > 0 && units[1].height > 0 && units[2].height == -1);
    himc_take_free(take);
}

static void test_real_stroke_strikes_once_at_the_place_and_speed_of_its_source(void)
{
    const char *path = shared_capture("drumstroke_pearl_240hz/stroke.trc");
    if (!path)
        TEST_IGNORE_MESSAGE("../shared/mocap is absent");
    himc_take *take = himc_take_load(path, NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    himc_take_strike s[4];
    TEST_ASSERT_EQUAL_INT(1, strikes_of(take, s, 4));
    printf("real stroke: %.4f s, %.2f m/s, %.3f %.3f %.3f m\n", s[0].time, s[0].velocity, s[0].x.x,
           s[0].x.y, s[0].x.z);
    TEST_ASSERT_EQUAL_INT(HIMC_RIGHT, s[0].hand);
    TEST_ASSERT_EQUAL_INT(149, s[0].frame);
    TEST_ASSERT_DOUBLE_WITHIN(0.008, 149 / 240.0, s[0].time);
    // the fastest sampled fall is 9.3 m/s in a filtered track; the head's height is given as -0.471
    // m
    TEST_ASSERT_TRUE(s[0].velocity > 9.2 && s[0].velocity < 10.5);
    TEST_ASSERT_DOUBLE_WITHIN(0.002, -0.47108, s[0].x.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.003, 0.543, s[0].x.x);
    himc_take_free(take);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_strike_between_frames_is_found_at_any_rate_and_phase);
    RUN_TEST(test_dead_stroke_is_found);
    RUN_TEST(test_low_pass_filtered_strike_is_found_within_3_ms_and_10_percent);
    RUN_TEST(test_half_a_millimetre_of_noise_neither_hides_nor_adds_strikes);
    RUN_TEST(test_strokes_in_the_air_are_not_strikes);
    RUN_TEST(test_strike_with_one_lost_frame_is_found_and_none_across_or_beside_a_longer_gap);
    RUN_TEST(test_no_strike_at_an_end_where_the_position_is_held);
    RUN_TEST(test_strikes_of_both_hands_come_in_order_and_place_the_drum);
    RUN_TEST(test_each_of_4200_strikes_is_found_tracked_and_cut);
    RUN_TEST(test_real_stroke_strikes_once_at_the_place_and_speed_of_its_source);
    return UNITY_END();
}
