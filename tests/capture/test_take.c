/// test_take.c: tips, gaps, axes and units of takes made from known motions.
#include "take_motions.h"

#include "musicxml/score_file.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static double gap_begin, gap_end;

// a ballistic arc with a gap
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
                             "expected gaps up to 0.2 s",
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
    himc_take *take = read_roll(600);
    himc_take_tip tips[HIMC_HANDS];
    himc_take_options options = himc_take_default();
    options.left_tip = "r stick tip";
    TEST_ASSERT_TRUE(himc_take_tips(take, &options, tips, &error));
    TEST_ASSERT_EQUAL_STRING("Anna:R_Stick_Tip", tips[HIMC_LEFT].name);
    options.left_tip = "BATON";
    TEST_ASSERT_FALSE(himc_take_tips(take, &options, tips, &error));
    TEST_ASSERT_EQUAL_STRING("roll.trc: left tip: no point \"BATON\", expected Anna:R_Stick_Tip, "
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

static void test_a_player_who_faced_the_other_way_is_rotated(void)
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

static void test_metres_stated_as_millimetres_are_read_as_metres_with_a_note(void)
{
    const char *text = "PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t2\t2\tmm\n"
                       "Frame#\tTime\tHead\t\t\tHips\t\t\n\n"
                       "1\t0\t0\t1.6\t0\t0.1\t0.9\t0\n2\t0.01\t0\t1.61\t0\t0.1\t0.91\t0\n";
    himc_take *take = read_text(text, "small.trc", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(take, error.text);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.6, himc_take_point(take, 0, 0).z);
    himc_take_free(take);
}

static void test_points_17_m_apart_are_refused(void)
{
    const char *text = "PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n100\t1\t2\tm\n"
                       "Frame#\tTime\tHead\t\t\tHips\t\t\n\n"
                       "1\t0\t0\t17\t0\t0\t0\t0\n";
    TEST_ASSERT_NULL(read_text(text, "tall.trc", NULL, &error));
    TEST_ASSERT_EQUAL_STRING(
        "tall.trc: the points are 17 m apart if the unit is m, no metric unit makes "
        "that a player's size, expected 0.2 .. 4 m",
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

static void test_files_of_other_formats_are_refused(void)
{
    himc_take_options options = himc_take_default();
    TEST_ASSERT_NULL(himc_take_load("score.txt", &options, &error));
    TEST_ASSERT_EQUAL_STRING(
        "score.txt: not a take by its suffix, expected .bvh .c3d .trc .csv .tsv", error.text);
    TEST_ASSERT_NULL(himc_take_load("does/not/exist.bvh", &options, &error));
    TEST_ASSERT_EQUAL_STRING("does/not/exist.bvh: cannot be read: No such file or directory",
                             error.text);
    options.longest_gap = NAN;
    TEST_ASSERT_NULL(himc_take_read("x", 1, "x.trc", &options, &error));
    TEST_ASSERT_EQUAL_STRING("longest gap: nan s, expected 0 .. 10 s", error.text);
}

// A format is its reader and its row: names, first bytes and errors follow from the row.
static void test_the_row_of_a_format_tells_its_files(void)
{
    static const struct {
        const char *suffix, *begins;
    } rows[] = {
#define ROW(suffix, begins) {"." #suffix, begins},
        HIMC_TAKE_FORMATS(ROW, ROW)};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char ways[80], name[16];
        snprintf(name, sizeof name, "take%s", rows[i].suffix);
        TEST_ASSERT_TRUE_MESSAGE(himc_take_is_capture(name), name);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(HIMC_TAKE_SUFFIXES, rows[i].suffix), name);
        snprintf(ways, sizeof ways, "%s", rows[i].begins);
        for (char *way = strtok(ways, "|"); way; way = strtok(NULL, "|")) {
            way[0] = way[0] == '\a' ? 2 : way[0];
            TEST_ASSERT_EQUAL_STRING(rows[i].suffix, himc_take_suffix_of(way, strlen(way)));
            TEST_ASSERT_NULL(himc_take_suffix_of(way, strlen(way) - 1));
            TEST_ASSERT_FALSE(himc_score_is_text(way, strlen(way), "piece", &error));
            TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, rows[i].suffix), error.text);
        }
    }
    TEST_ASSERT_EQUAL_STRING(".c3d",
                             himc_take_suffix_of("\7P", 2)); // its first block of two to seven
    TEST_ASSERT_NULL(himc_take_suffix_of("\10P", 2));
    TEST_ASSERT_NULL(himc_take_suffix_of("tempo 100;", 10));
}

static char told[8000];

static void hear(void *user, const char *line)
{
    (void)user;
    TEST_ASSERT_TRUE(strlen(line) < 256);
    strcat(told, line);
    strcat(told, "\n");
}

static void test_describe_lists_contents_units_and_axes(void)
{
    himc_take *take = read_roll(600);
    told[0] = 0;
    himc_take_describe(take, NULL, hear, NULL);
    static const char *const lines[] = {
        "format: TRC\n",
        "length: 600 frames at 250 Hz",
        "points 2: Anna:R_Stick_Tip Anna:L_Stick_Tip\n",
        "units: mm, stated by the file\n",
        ("axes: z up, set by the user; rotated so that the left tip is left of "
         "the right one\n"),
        "gaps: 0 frames in 0 points\n",
        "tip: right is Anna:R_Stick_Tip, 0 frames in gaps are filled\n",
        "strikes: 15\n",
        "struck: around 0.650 0.050 m on the head, which tips touch at a height of 0.811 m\n"};
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++)
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told, lines[i]), lines[i]);
    himc_take_free(take);
}

static himc_vec3 far_to_the_left(double t)
{
    himc_vec3 x = left_roll(t);
    return himc_vec3_make(x.x, 1.4, x.z);
}

static void test_describe_tells_of_strikes_too_far_apart_for_one_drum(void)
{
    const char *const names[2] = {"R_Stick_Tip", "L_Stick_Tip"};
    motion *const motions[2] = {right_roll, far_to_the_left};
    himc_take *take = read_motions("two.trc", names, motions, 250, 600);
    told[0] = 0;
    himc_take_describe(take, NULL, hear, NULL);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told, "drum: 15 strikes are more than 0.45 m from there, "
                                              "but a take is played on one drum\n"),
                                 told);
    himc_take_free(take);
}

// at 1000 Hz the last frame before the touch falls as fast as the stick; at 60 Hz it was slower
static void test_describe_tells_which_speeds_are_extrapolated(void)
{
    for (int slow = 0; slow < 2; slow++) {
        himc_take *take = read_motion(right_roll, slow ? 60 : 1000, slow ? 120 : 2000);
        told[0] = 0;
        himc_take_describe(take, NULL, hear, NULL);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told, " m/s down"), told);
        TEST_ASSERT_TRUE_MESSAGE(!!strstr(told, "m/s down, extrapolated from 3.") == slow, told);
        himc_take_free(take);
    }
}

static himc_vec3 wave(double t)
{
    return himc_vec3_make(0.6, -0.2, 1 + 0.1 * sin(6 * t));
}

static void test_describe_asks_for_the_axis_where_nothing_is_struck(void)
{
    himc_take *take = read_motion(wave, 250, 1000);
    told[0] = 0;
    himc_take_describe(take, NULL, hear, NULL);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(told, "strikes: 0, no tip falls onto a head; --up"), told);
    himc_take_free(take);
}

static void test_two_readings_of_a_file_are_equal_bit_by_bit(void)
{
    himc_take *a = read_roll(600), *b = read_roll(600);
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
    RUN_TEST(test_gap_in_a_ballistic_arc_is_filled_exactly);
    RUN_TEST(test_gaps_at_the_ends_are_held);
    RUN_TEST(test_longer_gap_is_refused_with_marker_frames_and_length);
    RUN_TEST(test_tips_are_found_by_the_names_laboratories_use);
    RUN_TEST(test_tips_can_be_named_and_a_wrong_name_is_refused);
    RUN_TEST(test_a_player_who_faced_the_other_way_is_rotated);
    RUN_TEST(test_metres_stated_as_millimetres_are_read_as_metres_with_a_note);
    RUN_TEST(test_points_17_m_apart_are_refused);
    RUN_TEST(test_a_marker_that_hardly_moves_keeps_its_unit);
    RUN_TEST(test_files_of_other_formats_are_refused);
    RUN_TEST(test_the_row_of_a_format_tells_its_files);
    RUN_TEST(test_describe_lists_contents_units_and_axes);
    RUN_TEST(test_describe_tells_of_strikes_too_far_apart_for_one_drum);
    RUN_TEST(test_describe_tells_which_speeds_are_extrapolated);
    RUN_TEST(test_describe_asks_for_the_axis_where_nothing_is_struck);
    RUN_TEST(test_two_readings_of_a_file_are_equal_bit_by_bit);
    return UNITY_END();
}
