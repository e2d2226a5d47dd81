/// test_take_spikes.c: spikes, which are positions that a marker cannot have had, and the notes
/// about names and rates.
#include "take_motions.h"

#include "capture/take.h"

#define RATE 250
#define FRAMES 400

static bool wild[FRAMES];
static int lasting; // from this frame on the marker stays elsewhere

void setUp(void)
{
    memset(wild, 0, sizeof wild);
    lasting = FRAMES;
}

void tearDown(void)
{
}

static himc_vec3 calm(double t)
{
    return himc_vec3_make(0.6, 0.1, 1 + 0.15 * cos(2 * HIMC_PI * 2 * t));
}

static himc_vec3 restless(double t)
{
    int frame = (int)lround(t * RATE);
    himc_vec3 x = calm(t);
    x.y += wild[frame] ? 1.5 : 0;
    x.x += frame >= lasting ? 1 : 0;
    return x;
}

// all frames are unchanged, except that the listed ones are gaps
static void check(himc_take *take, bool gaps)
{
    for (int i = 0; i < FRAMES; i++) {
        himc_vec3 x = himc_take_point(take, i, 0), truth = restless((double)i / RATE);
        bool gap = isnan(x.x) && isnan(x.y) && isnan(x.z);
        TEST_ASSERT_EQUAL(gaps && wild[i], gap);
        if (!gap) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, himc_vec3_length(himc_vec3_sub(truth, x)));
        }
    }
}

static void test_one_spike_becomes_a_gap_and_the_note_has_marker_and_frame(void)
{
    wild[100] = true; // the file counts from 1
    himc_take *take = read_motion(restless, RATE, FRAMES);
    check(take, true);
    TEST_ASSERT_EQUAL_INT(1, take->note_count);
    TEST_ASSERT_EQUAL_STRING("gaps: 1 positions of 1 points, reached by jumps faster than 30 m/s, "
                             "are read as gaps, the first of RTIP in frame 101",
                             take->notes[0]);
    himc_take_free(take);
}

static void test_spikes_of_up_to_a_tenth_of_a_second_and_at_both_ends_become_gaps(void)
{
    wild[0] = wild[FRAMES - 1] = true;
    for (int i = 200; i < 218; i++) // with the two above 5 %
        wild[i] = true;
    himc_take *take = read_motion(restless, RATE, FRAMES);
    check(take, true);
    TEST_ASSERT_EQUAL_INT(1, take->note_count);
    TEST_ASSERT_EQUAL_STRING("gaps: 20 positions of 1 points, reached by jumps faster than 30 m/s, "
                             "are read as gaps, the first of RTIP in frame 1",
                             take->notes[0]);
    himc_take_free(take);
}

static void test_a_point_with_more_than_5_percent_of_spikes_is_left_as_it_is(void)
{
    for (int i = 0; i < 7; i++) // of three frames each
        wild[30 + 50 * i] = wild[31 + 50 * i] = wild[32 + 50 * i] = true;
    himc_take *take = read_motion(restless, RATE, FRAMES);
    check(take, false);
    TEST_ASSERT_EQUAL_INT(0, take->note_count);
    himc_take_free(take);
}

static void test_a_jump_without_return_is_left_as_it_is(void)
{
    lasting = 200;
    himc_take *take = read_motion(restless, RATE, FRAMES);
    check(take, false);
    TEST_ASSERT_EQUAL_INT(0, take->note_count);
    himc_take_free(take);
}

static himc_take *read_two(const char *first, const char *second)
{
    const char *const names[2] = {first, second};
    motion *const motions[2] = {calm, restless};
    return read_motions("two.trc", names, motions, RATE, FRAMES);
}

static void test_a_name_of_two_points_is_noted_and_the_first_is_read(void)
{
    himc_take *take = read_two("RTIP", "RTIP");
    TEST_ASSERT_EQUAL_INT(1, take->note_count);
    TEST_ASSERT_EQUAL_STRING("names: more than one point is called RTIP, the first is read",
                             take->notes[0]);
    TEST_ASSERT_EQUAL_INT(0, himc_take_find(take, "RTIP"));
    himc_take_free(take);
    take = read_two("RTIP", "LTIP");
    TEST_ASSERT_EQUAL_INT(0, take->note_count);
    himc_take_free(take);
}

static void test_a_rate_below_40_hz_is_noted(void)
{
    himc_take *take = read_motion(calm, 39, 100);
    TEST_ASSERT_EQUAL_INT(1, take->note_count);
    TEST_ASSERT_EQUAL_STRING("rate: at 39 Hz strikes are blurred, some may be missed or misplaced",
                             take->notes[0]);
    himc_take_free(take);
    take = read_motion(calm, 40, 100);
    TEST_ASSERT_EQUAL_INT(0, take->note_count);
    himc_take_free(take);
}

// by its name it is the right tip
static void test_a_right_tip_named_as_the_left_leaves_the_right_hand_without_a_tip(void)
{
    himc_take_options options = z_up();
    himc_take_tip tips[HIMC_HANDS];
    options.left_tip = "RTIP";
    himc_take *take = read_two("RTIP", "HEAD");
    TEST_ASSERT_TRUE_MESSAGE(himc_take_tips(take, &options, tips, &error), error.text);
    TEST_ASSERT_TRUE(tips[HIMC_LEFT].present);
    TEST_ASSERT_EQUAL_STRING("RTIP", tips[HIMC_LEFT].name);
    TEST_ASSERT_FALSE(tips[HIMC_RIGHT].present);
    himc_take_free(take);
}

static void test_one_point_named_as_both_tips_is_refused(void)
{
    himc_take_options options = z_up();
    himc_take_tip tips[HIMC_HANDS];
    options.left_tip = "RTIP";
    options.right_tip = "rtip";
    himc_take *take = read_two("RTIP", "LTIP");
    TEST_ASSERT_FALSE(himc_take_tips(take, &options, tips, &error));
    TEST_ASSERT_EQUAL_STRING("two.trc: RTIP is named as both tips, expected one point for each tip",
                             error.text);
    himc_take_free(take);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_one_spike_becomes_a_gap_and_the_note_has_marker_and_frame);
    RUN_TEST(test_spikes_of_up_to_a_tenth_of_a_second_and_at_both_ends_become_gaps);
    RUN_TEST(test_a_point_with_more_than_5_percent_of_spikes_is_left_as_it_is);
    RUN_TEST(test_a_jump_without_return_is_left_as_it_is);
    RUN_TEST(test_a_name_of_two_points_is_noted_and_the_first_is_read);
    RUN_TEST(test_a_rate_below_40_hz_is_noted);
    RUN_TEST(test_a_right_tip_named_as_the_left_leaves_the_right_hand_without_a_tip);
    RUN_TEST(test_one_point_named_as_both_tips_is_refused);
    return UNITY_END();
}
