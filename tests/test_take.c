/// test_take.c: tips, gaps, strikes, axes and units of takes made up of known motions, and the real
/// drum stroke.
#include "take_files.h"
#include "unity.h"

static himc_error error;

void setUp(void)
{
}

void tearDown(void)
{
}

// a marker's place at time t (s), in metres, z up; NaN for a gap
typedef himc_vec3 motion(double t);

static double touch_time = 0.5, noise;
static uint64_t random_state;

// about normal, by summing uniform numbers
static double random_normal(void)
{
    double sum = 0;
    for (int i = 0; i < 12; i++) {
        random_state = random_state * 6364136223846793005u + 1442695040888963407u;
        sum += (double)(random_state >> 40) / 16777216.0;
    }
    return sum - 6;
}

// a TRC (mm, z up by option) of up to two markers; to be freed
static char *write_motion(const char *const names[2], motion *const motions[2], double rate,
                          int frames)
{
    int markers = names[1] ? 2 : 1;
    char *text = malloc(400 + (size_t)frames * 140), *at = text;
    at += sprintf(at, "PathFileType\t4\n");
    at += sprintf(at, "DataRate\tNumFrames\tNumMarkers\tUnits\n%.10g\t%d\t%d\tmm\n", rate, frames,
                  markers);
    at += sprintf(at, "Frame#\tTime\t%s\t\t\t%s\t\t\n\n", names[0], markers > 1 ? names[1] : "");
    for (int f = 0; f < frames; f++) {
        at += sprintf(at, "%d\t%.9f", f + 1, f / rate);
        for (int i = 0; i < markers; i++) {
            himc_vec3 x = himc_vec3_scale(motions[i](f / rate), 1000);
            if (isnan(x.x))
                at += sprintf(at, "\t\t\t");
            else
                at += sprintf(at, "\t%.9f\t%.9f\t%.9f", x.x, x.y, x.z);
        }
        at += sprintf(at, "\n");
    }
    return text;
}

static himc_take_options z_up(void)
{
    himc_take_options options = himc_take_default();
    options.up = HIMC_UP_Z;
    return options;
}

static himc_take *read_motion(motion *one, double rate, int frames)
{
    const char *const names[2] = {"RTIP", NULL};
    motion *const motions[2] = {one, NULL};
    himc_take_options options = z_up();
    char *text = write_motion(names, motions, rate, frames);
    himc_take *take = read_text(text, "motion.trc", &options, &error);
    free(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static int strikes_of(himc_take *take, himc_take_strike *strikes, int capacity)
{
    himc_take_tip tips[HIMC_HANDS];
    TEST_ASSERT_TRUE_MESSAGE(himc_take_tips(take, NULL, tips, &error), error.text);
    return himc_take_strikes(take, tips, strikes, capacity);
}

// falls with 30 m/s^2 to 4 m/s at touch_time, leaves at 2.5 m/s; turned round in time it begins at
// rest
static double bounce_height(double t)
{
    double u = t - touch_time;
    if (u > 0)
        return u < 0.25 ? 2.5 * u - 5 * u * u : 0.3125;
    return u > -4.0 / 30 ? -4 * u - 15 * u * u : 0.8 / 3;
}

static himc_vec3 bounce(double t)
{
    return himc_vec3_make(0.6 + 0.1 * t, 0.1, 0.8 + bounce_height(t) + noise * random_normal());
}

static himc_vec3 dead_stroke(double t)
{
    return himc_vec3_make(0.6, 0.1, 0.8 + (t < touch_time ? bounce_height(t) : 0));
}

// the same blow seen through a low-pass filter of about 40 Hz
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

static himc_vec3 stroke_in_the_air(double t)
{
    return himc_vec3_make(0.6, 0.1, 1 + 0.15 * cos(2 * HIMC_PI * 4 * t) + noise * random_normal());
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

static void test_strokes_in_the_air_are_no_strikes(void)
{
    for (double rate = 60; rate <= 2000; rate *= 2) {
        himc_take *take = read_motion(stroke_in_the_air, rate, (int)(2 * rate));
        TEST_ASSERT_EQUAL_INT(0, strikes_of(take, NULL, 0));
        himc_take_free(take);
    }
}

// every 0.3 s, and 0.11 s later for the other hand
static himc_vec3 right_roll(double t)
{
    touch_time = 0.2 + 0.3 * floor(fmax(0, t) / 0.3);
    himc_vec3 x = bounce(t);
    return himc_vec3_make(0.6, -0.2, x.z);
}

static himc_vec3 left_roll(double t)
{
    himc_vec3 x = right_roll(t - 0.11);
    return himc_vec3_make(0.7, 0.3, x.z);
}

static himc_take *read_roll(void)
{
    const char *const names[2] = {"Anna:R_Stick_Tip", "Anna:L_Stick_Tip"};
    motion *const motions[2] = {right_roll, left_roll};
    himc_take_options options = z_up();
    char *text = write_motion(names, motions, 250, 600);
    himc_take *take = read_text(text, "roll.trc", &options, &error);
    free(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    return take;
}

static void test_strikes_of_both_hands_come_in_order_and_place_the_drum(void)
{
    himc_take *take = read_roll();
    himc_take_strike s[32];
    int count = strikes_of(take, s, 32);
    TEST_ASSERT_EQUAL_INT(15, count);
    for (int i = 0; i < count; i++) {
        TEST_ASSERT_EQUAL_INT(i % 2 ? HIMC_LEFT : HIMC_RIGHT, s[i].hand);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.2 + 0.3 * (i / 2) + 0.11 * (i % 2), s[i].time);
    }
    himc_vec3 place;
    TEST_ASSERT_TRUE(himc_take_strike_place(s, count, &place));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.65, place.x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.05, place.y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.8, place.z);
    TEST_ASSERT_FALSE(himc_take_strike_place(s, 0, &place));
    // fewer places than strikes: the first ones, and how many there are
    TEST_ASSERT_EQUAL_INT(15, strikes_of(take, s, 3));
    himc_take_free(take);
}

static void test_real_stroke_strikes_once_where_and_as_its_source_says(void)
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

static double gap_begin, gap_end;

// a ballistic arc with a hole
static himc_vec3 arc(double t)
{
    if (t > gap_begin && t < gap_end)
        return himc_vec3_make(NAN, NAN, NAN);
    return himc_vec3_make(0.3 + 0.8 * t, 0.2 * t - 0.1 * t * t, 1 + 2 * t - 4.905 * t * t);
}

static himc_take *read_gap(double begin, double end)
{
    gap_begin = begin;
    gap_end = end;
    return read_motion(arc, 200, 100);
}

static void test_gap_in_a_ballistic_arc_is_filled_exactly(void)
{
    himc_take *take = read_gap(0.1, 0.29);
    himc_take_tip tips[HIMC_HANDS];
    TEST_ASSERT_TRUE(himc_take_tips(take, NULL, tips, &error));
    TEST_ASSERT_FALSE(tips[HIMC_LEFT].present);
    TEST_ASSERT_TRUE(tips[HIMC_RIGHT].present);
    TEST_ASSERT_EQUAL_STRING("RTIP", tips[HIMC_RIGHT].name);
    TEST_ASSERT_EQUAL_INT(37, tips[HIMC_RIGHT].filled);
    gap_end = 0;
    for (int i = 0; i < 100; i++)
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-9, 0, himc_vec3_length(himc_vec3_sub(tips[HIMC_RIGHT].x[i], arc(i / 200.0))));
    // the take itself still shows the gap
    TEST_ASSERT_EQUAL_INT(37, himc_take_missing(take, 0));
    himc_take_free(take);
}

static void test_gaps_at_the_ends_are_held(void)
{
    himc_take *take = read_gap(-1, 0.1);
    himc_take_tip tips[HIMC_HANDS];
    TEST_ASSERT_TRUE(himc_take_tips(take, NULL, tips, &error));
    TEST_ASSERT_EQUAL_MEMORY(&tips[HIMC_RIGHT].x[20], &tips[HIMC_RIGHT].x[0], sizeof(himc_vec3));
    himc_take_free(take);
    take = read_gap(0.4, 1);
    TEST_ASSERT_TRUE(himc_take_tips(take, NULL, tips, &error));
    TEST_ASSERT_EQUAL_MEMORY(&tips[HIMC_RIGHT].x[80], &tips[HIMC_RIGHT].x[99], sizeof(himc_vec3));
    himc_take_free(take);
}

static void test_longer_gap_is_refused_with_marker_frames_and_length(void)
{
    himc_take *take = read_gap(0.1, 0.35);
    himc_take_tip tips[HIMC_HANDS];
    himc_take_options options = himc_take_default();
    TEST_ASSERT_FALSE(himc_take_tips(take, &options, tips, &error));
    TEST_ASSERT_EQUAL_STRING("motion.trc: right tip RTIP is missing in frames 22 .. 70 (0.245 s), "
                             "allowed are gaps of 0.2 s",
                             error.text);
    options.longest_gap = 0.25;
    TEST_ASSERT_TRUE(himc_take_tips(take, &options, tips, &error));
    himc_take_free(take);
}

static void check_tip_name(const char *name, himc_hand hand)
{
    const char *const names[2] = {name, NULL};
    motion *const motions[2] = {stroke_in_the_air, NULL};
    himc_take_options options = z_up();
    char *text = write_motion(names, motions, 100, 20);
    himc_take *take = read_text(text, "names.trc", &options, &error);
    free(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    himc_take_tip tips[HIMC_HANDS];
    bool found = himc_take_tips(take, NULL, tips, &error);
    TEST_ASSERT_EQUAL_MESSAGE(hand == HIMC_LEFT, found && tips[HIMC_LEFT].present, name);
    TEST_ASSERT_EQUAL_MESSAGE(hand == HIMC_RIGHT, found && tips[HIMC_RIGHT].present, name);
    himc_take_free(take);
}

static void test_tips_are_found_by_the_names_laboratories_use(void)
{
    static const char *const right[] = {"RTIP",          "R_TIP",          "STICK_R",
                                        "RightStick",    "RightStick_end", "bead",
                                        "Drum Bead",     "Daphnee:rtip",   "StickTipRight",
                                        "r_mallet_head", "tip.R",          "R-drumstick"};
    static const char *const left[] = {"LTIP",         "L_TIP",     "stickl",  "LeftStick",
                                       "LeftStickTip", "left bead", "MALLET_L"};
    static const char *const none[] = {"RFingertip",  "Head", "RHand", "LeftToe_end", "Head_end",
                                       "RFINGER_TIP", "drum", "ltipx", "L",           "R"};
    for (size_t i = 0; i < sizeof right / sizeof right[0]; i++)
        check_tip_name(right[i], HIMC_RIGHT);
    for (size_t i = 0; i < sizeof left / sizeof left[0]; i++)
        check_tip_name(left[i], HIMC_LEFT);
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++)
        check_tip_name(none[i], HIMC_HANDS);
}

static void test_tips_can_be_named_and_a_wrong_name_is_refused(void)
{
    himc_take *take = read_roll();
    himc_take_tip tips[HIMC_HANDS];
    himc_take_options options = himc_take_default();
    options.left_tip = "r stick tip";
    TEST_ASSERT_TRUE(himc_take_tips(take, &options, tips, &error));
    TEST_ASSERT_EQUAL_STRING("Anna:R_Stick_Tip", tips[HIMC_LEFT].name);
    options.left_tip = "BATON";
    TEST_ASSERT_FALSE(himc_take_tips(take, &options, tips, &error));
    TEST_ASSERT_EQUAL_STRING("roll.trc: left tip: no point \"BATON\", allowed: Anna:R_Stick_Tip, "
                             "Anna:L_Stick_Tip",
                             error.text);
    himc_take_free(take);
}

static himc_vec3 right_seen_from_behind(double t)
{
    himc_vec3 x = right_roll(t);
    return himc_vec3_make(-x.x, -x.y, x.z);
}

static himc_vec3 left_seen_from_behind(double t)
{
    himc_vec3 x = left_roll(t);
    return himc_vec3_make(-x.x, -x.y, x.z);
}

static void test_a_player_who_faced_the_other_way_is_turned_round(void)
{
    const char *const names[2] = {"RTIP", "LTIP"};
    motion *const motions[2] = {right_seen_from_behind, left_seen_from_behind};
    himc_take_options options = z_up();
    char *text = write_motion(names, motions, 250, 100);
    himc_take *take = read_text(text, "behind.trc", &options, &error);
    free(text);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.6, himc_take_point(take, 3, 0).x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -0.2, himc_take_point(take, 3, 0).y);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.7, himc_take_point(take, 3, 1).x);
    himc_take_free(take);
}

static void test_metres_that_call_themselves_millimetres_are_read_as_metres_and_it_is_said(void)
{
    const char *text = "PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t2\t2\tmm\n"
                       "Frame#\tTime\tHead\t\t\tHips\t\t\n\n"
                       "1\t0\t0\t1.6\t0\t0.1\t0.9\t0\n2\t0.01\t0\t1.61\t0\t0.1\t0.91\t0\n";
    himc_take *take = read_text(text, "small.trc", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.6, himc_take_point(take, 0, 0).z);
    himc_take_free(take);
}

static void test_a_player_of_no_size_is_refused(void)
{
    const char *text = "PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t1\t2\tm\n"
                       "Frame#\tTime\tHead\t\t\tHips\t\t\n\n"
                       "1\t0\t0\t17\t0\t0\t0\t0\n";
    TEST_ASSERT_NULL(read_text(text, "tall.trc", NULL, &error));
    TEST_ASSERT_EQUAL_STRING("tall.trc: points lie 17 m apart in m and no metric unit makes that "
                             "0.2 .. 4 m: is this a player?",
                             error.text);
}

static himc_vec3 nearly_still(double t)
{
    return himc_vec3_make(0.6, 0.1, 1 + 0.002 * sin(40 * t));
}

static void test_a_marker_that_hardly_moves_keeps_its_unit(void)
{
    himc_take *take = read_motion(nearly_still, 100, 50);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.6, himc_take_point(take, 7, 0).x);
    himc_take_free(take);
}

static void test_files_that_are_no_takes_are_refused(void)
{
    himc_take_options options = himc_take_default();
    TEST_ASSERT_NULL(himc_take_load("score.txt", &options, &error));
    TEST_ASSERT_EQUAL_STRING("score.txt: not a take by its name, allowed .bvh .c3d .trc",
                             error.text);
    TEST_ASSERT_NULL(himc_take_load("does/not/exist.bvh", &options, &error));
    TEST_ASSERT_EQUAL_STRING("does/not/exist.bvh: cannot be read: No such file or directory",
                             error.text);
    options.longest_gap = NAN;
    TEST_ASSERT_NULL(himc_take_read("x", 1, "x.trc", &options, &error));
    TEST_ASSERT_EQUAL_STRING("longest gap: nan s, allowed 0 .. 10 s", error.text);
}

static char told[8000];

static void hear(void *user, const char *line)
{
    (void)user;
    TEST_ASSERT_TRUE(strlen(line) < 256);
    strcat(told, line);
    strcat(told, "\n");
}

static void test_describe_tells_what_was_found_and_how_it_was_read(void)
{
    himc_take *take = read_roll();
    told[0] = 0;
    himc_take_describe(take, NULL, hear, NULL);
    static const char *const lines[] = {
        "format: TRC\n",
        "length: 600 frames at 250 Hz",
        "points 2: Anna:R_Stick_Tip Anna:L_Stick_Tip\n",
        "units: mm, as the file says\n",
        "axes: z up, as asked for; turned so that the left tip is left of "
        "the right one\n",
        "gaps: 0 frames in 0 points\n",
        "tip: right is Anna:R_Stick_Tip, 0 frames filled\n",
        "strikes: 15\n",
        "drum: the head belongs under 0.650 0.050 m, at the height of 0.800 m\n"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told, lines[i]), lines[i]);
    himc_take_free(take);
}

static void test_two_readings_of_a_file_are_equal_bit_by_bit(void)
{
    himc_take *a = read_roll(), *b = read_roll();
    for (int i = 0; i < 600; i++)
        for (int k = 0; k < 2; k++) {
            himc_vec3 p = himc_take_point(a, i, k), q = himc_take_point(b, i, k);
            TEST_ASSERT_EQUAL_MEMORY(&p, &q, sizeof p);
        }
    himc_take_free(a);
    himc_take_free(b);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_strike_between_frames_is_found_at_any_rate_and_phase);
    RUN_TEST(test_dead_stroke_is_found);
    RUN_TEST(test_low_pass_filtered_strike_is_found_within_3_ms_and_10_percent);
    RUN_TEST(test_half_a_millimetre_of_noise_neither_hides_nor_adds_strikes);
    RUN_TEST(test_strokes_in_the_air_are_no_strikes);
    RUN_TEST(test_strikes_of_both_hands_come_in_order_and_place_the_drum);
    RUN_TEST(test_real_stroke_strikes_once_where_and_as_its_source_says);
    RUN_TEST(test_gap_in_a_ballistic_arc_is_filled_exactly);
    RUN_TEST(test_gaps_at_the_ends_are_held);
    RUN_TEST(test_longer_gap_is_refused_with_marker_frames_and_length);
    RUN_TEST(test_tips_are_found_by_the_names_laboratories_use);
    RUN_TEST(test_tips_can_be_named_and_a_wrong_name_is_refused);
    RUN_TEST(test_a_player_who_faced_the_other_way_is_turned_round);
    RUN_TEST(test_metres_that_call_themselves_millimetres_are_read_as_metres_and_it_is_said);
    RUN_TEST(test_a_player_of_no_size_is_refused);
    RUN_TEST(test_a_marker_that_hardly_moves_keeps_its_unit);
    RUN_TEST(test_files_that_are_no_takes_are_refused);
    RUN_TEST(test_describe_tells_what_was_found_and_how_it_was_read);
    RUN_TEST(test_two_readings_of_a_file_are_equal_bit_by_bit);
    return UNITY_END();
}
