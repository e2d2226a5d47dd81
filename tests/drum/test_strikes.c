/// test_strikes.c: a drum's own strikes: when they begin, in what order, and what is reported.
#include "one_drum.h"

static himc_contact_report report_of(double velocity)
{
    himc_contact_report report;
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, 0.1, 0, velocity, &error));
    advance(LENGTH);
    TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
    return report;
}

static void test_strikes_on_a_ringing_head_begin_on_their_sample(void)
{
    himc_contact_report report;
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, -0.2, 0, 5, &error));
    advance(1000);
    TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
    for (int i = 0; i < 40; i++) {
        uint64_t begun = himc_drum_time(drum);
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 7, 0.1, 0.1, 3, &error));
        advance(2 + 37 * i);
        for (int wait = 0; !himc_drum_strike_next(drum, &report); wait++) {
            TEST_ASSERT_TRUE(wait < 1000);
            advance(64);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, (double)(begun + 7) / RATE, report.time);
    }
}

static void test_two_strikes_at_one_sample_begin_in_the_order_asked_for(void)
{
    himc_contact_onset onset;
    for (int i = 0; i < 3; i++)
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 50, 0.05 * i, 0, 3, &error));
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 20, 0.15, 0, 3, &error));
    advance(100);
    static const double x[] = {0.15, 0, 0.05, 0.1};
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_TRUE(himc_drum_contact_next(drum, &onset));
        TEST_ASSERT_EQUAL_DOUBLE(x[i], onset.x);
    }
}

// a ball of steel meets the head in a spike shorter than a sample; its mean is 1 % less
static void test_force_of_a_stiff_strike_is_its_peak_within_the_sample(void)
{
    says("glide 0"); // the film acts once a sample
    says("mallet 1e13 1.5 0.02");
    double force = report_of(3).force;
    tearDown();
    drum = himc_drum_new("fine", 23, 192000, &error); // four samples to each of 48000 Hz
    says("glide 0");
    says("mallet 1e13 1.5 0.02");
    double fine = report_of(3).force;
    printf("peak %.2f N, at 192 kHz %.2f N\n", force, fine);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fine, fine, force);
}

static void test_head_raised_into_a_resting_stick_is_no_onset(void)
{
    himc_stick stick = {.head = *himc_drum_mallet(drum, HIMC_RIGHT), .mass = 0.03, .height = 1e-5};
    himc_stick *sticks[] = {&stick};
    double up[480], force[480], *forces[] = {force}, most = 0;
    himc_contact_onset onset;
    for (int i = 0; i < 480; i++)
        up[i] = -20;
    himc_drum_advance_sticks(drum, 480, sticks, 1, forces, &(himc_outside_force){up, NULL, NULL});
    for (int i = 0; i < 480; i++)
        most = fmax(most, force[i]);
    TEST_ASSERT_TRUE(most > 0.1);
    TEST_ASSERT_FALSE(himc_drum_contact_next(drum, &onset));
}

// a strike comes at its time, not after its count of samples
static void test_strike_that_waits_keeps_its_time_when_the_rate_changes(void)
{
    himc_contact_onset onset;
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 4000, 0.1, 0, 3, &error));
    advance(1000);
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_set_rate(drum, 2 * RATE, &error), error.text);
    advance(7000);
    TEST_ASSERT_TRUE(himc_drum_contact_next(drum, &onset));
    TEST_ASSERT_INT_WITHIN(1, 1000 + 2 * 3000, (int)onset.at);
}

static void test_sound_and_place_of_a_strike_are_read_together(void)
{
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 300, 0.1, 0, 3, &error));
    advance(LENGTH);
    himc_drum_read(drum, 0, LENGTH, sound, seen);
    TEST_ASSERT_EQUAL_DOUBLE(0, peak(sound, 300) + peak(seen, 300));
    TEST_ASSERT_TRUE(peak(sound, LENGTH) > 0.01 && peak(seen, LENGTH) > 1e-4);
}

static void test_onsets_count_from_the_realign(void)
{
    himc_contact_onset onset;
    advance(1000);
    himc_drum_realign(drum, 0);
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 100, 0.1, 0, 3, &error));
    advance(200);
    TEST_ASSERT_TRUE(himc_drum_contact_next(drum, &onset));
    TEST_ASSERT_EQUAL_INT(100, (int)onset.at);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 3, onset.velocity);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.1 / himc_drum_head_frame(drum)->radius, onset.distance);
}

static void test_of_more_than_64_reports_and_onsets_the_latest_are_kept(void)
{
    himc_contact_report report;
    himc_contact_onset onset;
    for (int i = 0; i < 70; i++) {
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, 0.001 * i, 0, 3, &error));
        advance(1500);
    }
    advance(LENGTH);
    for (int i = 6; i < 70; i++) {
        TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
        TEST_ASSERT_EQUAL_DOUBLE(0.001 * i, report.x);
        TEST_ASSERT_TRUE(himc_drum_contact_next(drum, &onset));
        TEST_ASSERT_EQUAL_DOUBLE(0.001 * i, onset.x);
    }
    TEST_ASSERT_FALSE(himc_drum_strike_next(drum, &report));
    TEST_ASSERT_FALSE(himc_drum_contact_next(drum, &onset));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_strikes_on_a_ringing_head_begin_on_their_sample);
    RUN_TEST(test_two_strikes_at_one_sample_begin_in_the_order_asked_for);
    RUN_TEST(test_force_of_a_stiff_strike_is_its_peak_within_the_sample);
    RUN_TEST(test_head_raised_into_a_resting_stick_is_no_onset);
    RUN_TEST(test_strike_that_waits_keeps_its_time_when_the_rate_changes);
    RUN_TEST(test_sound_and_place_of_a_strike_are_read_together);
    RUN_TEST(test_onsets_count_from_the_realign);
    RUN_TEST(test_of_more_than_64_reports_and_onsets_the_latest_are_kept);
    return UNITY_END();
}
