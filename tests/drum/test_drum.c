/// test_drum.c: strikes exact to the sample, the same bits in blocks of any size, time, rates, and
/// no allocation.
#include "allocations.h"
#include "one_drum.h"

#include <stdio.h>
#include <stdlib.h>

static void test_drum_struck_sounds_and_reports_the_contact(void)
{
    says("strike -0.2 0.05 4");
    advance(LENGTH);
    himc_drum_read(drum, 0, LENGTH, sound, seen);
    double loud = peak(sound, LENGTH);
    TEST_ASSERT_TRUE(loud > 0.1 && loud < 1);
    himc_contact_report report;
    TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
    TEST_ASSERT_FALSE(himc_drum_strike_next(drum, &report));
    TEST_ASSERT_EQUAL_DOUBLE(0, report.time);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 4, report.velocity);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, -0.2, report.x);
    printf("%.1f N, %.2f ms, %.3f of m v\n", report.force, 1e3 * report.duration,
           report.impulse / (himc_drum_mallet(drum, HIMC_RIGHT)->mass * 4));
    TEST_ASSERT_DOUBLE_WITHIN(5, 28, report.force);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 4.5e-3, report.duration);
    // m v (1 + restitution)
    TEST_ASSERT_DOUBLE_WITHIN(0.01, himc_drum_mallet(drum, HIMC_RIGHT)->mass * 4 * 1.92,
                              report.impulse);
}

static void test_drum_strike_begins_on_the_sample_asked_for(void)
{
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 777, 0.1, 0, 2, &error));
    advance(1500);
    himc_drum_read(drum, 0, 1500, sound, seen);
    TEST_ASSERT_EQUAL_DOUBLE(0, peak(seen, 777));
    TEST_ASSERT_TRUE(seen[777] != 0);
    himc_contact_report report;
    TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 777 / RATE, report.time);
}

static void test_drum_sounds_louder_the_harder_it_is_struck_and_a_fortissimo_does_not_clip(void)
{
    double before = 0;
    for (double v = 0.5; v <= 8; v *= 2) {
        tearDown();
        setUp();
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, -0.219, 0, v, &error));
        advance(LENGTH);
        himc_drum_read(drum, 0, LENGTH, sound, NULL);
        double loud = peak(sound, LENGTH);
        printf("%3.1f m/s: peak %.3f\n", v, loud);
        TEST_ASSERT_TRUE(loud > 1.5 * before && loud < 1);
        before = loud;
    }
    TEST_ASSERT_TRUE(before > 0.3);
}

static void test_drum_gives_the_same_bits_in_blocks_of_any_size(void)
{
    static double reference[3][LENGTH], force[LENGTH];
    scene(1, reference[0], reference[1], reference[2]);
    TEST_ASSERT_TRUE(peak(reference[2], LENGTH) > 5);
    static const int blocks[] = {64, 1024, 5, 4800};
    for (int i = 0; i < 4; i++) {
        scene(blocks[i], sound, seen, force);
        TEST_ASSERT_EQUAL_MEMORY(reference[0], sound, sizeof sound);
        TEST_ASSERT_EQUAL_MEMORY(reference[1], seen, sizeof seen);
        TEST_ASSERT_EQUAL_MEMORY(reference[2], force, sizeof force);
    }
}

static void test_drum_sound_stays_finite_with_absurd_outside_forces(void)
{
    static double force[4096], x[4096], y[4096];
    for (int i = 0; i < 4096; i++) {
        static const double odd[] = {NAN, 1e300, -INFINITY, -1e300, 0, 1, 1e-320};
        force[i] = odd[i % 7];
        x[i] = i % 11 == 0 ? NAN : i % 13 == 0 ? 1e300 : 0.1;
        y[i] = i % 17 == 0 ? INFINITY : 0;
    }
    himc_drum_advance(drum, 4096, force, x, y);
    advance(4096);
    himc_drum_read(drum, 0, 8192, sound, seen);
    TEST_ASSERT_TRUE(peak(sound, 8192) < 1e6);
    TEST_ASSERT_TRUE(peak(seen, 8192) < 100);
}

// on another drum of the same name
static void push_new_drum(double force_of_all, double *heard_of_it)
{
    static double force[512];
    himc_drum *d = himc_drum_new("kettle", 23, 48000, &error);
    for (int i = 0; i < 512; i++)
        force[i] = force_of_all;
    himc_drum_advance(d, 512, force, NULL, NULL);
    himc_drum_read(d, 0, 512, heard_of_it, NULL);
    himc_drum_release(d);
}

static void test_an_outside_force_beyond_the_largest_acts_as_that(void)
{
    static double most[512], beyond[512], within[512];
    push_new_drum(-HIMC_FORCE_MAX, most);
    push_new_drum(-1e300, beyond);
    push_new_drum(-0.9 * HIMC_FORCE_MAX, within);
    TEST_ASSERT_EQUAL_MEMORY(most, beyond, sizeof most);
    TEST_ASSERT_TRUE(peak(within, 512) < peak(most, 512));
}

static void test_a_drum_without_a_name_is_refused(void)
{
    TEST_ASSERT_NULL(himc_drum_new(NULL, 23, 48000, &error));
    TEST_ASSERT_EQUAL_STRING("drum: a name is missing", error.text);
}

static void test_drum_counts_time_from_0_when_realigned_and_goes_on_sounding(void)
{
    static double reference[4096];
    says("strike -0.2 0 3");
    advance(4096);
    himc_drum_read(drum, 0, 4096, reference, NULL);
    tearDown();
    setUp();
    says("strike -0.2 0 3");
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 5000, 0, 0, 1, &error));
    advance(1000);
    himc_drum_realign(drum, 100);
    TEST_ASSERT_TRUE(himc_drum_time(drum) == 100);
    advance(1900);
    TEST_ASSERT_TRUE(himc_drum_time(drum) == 2000);
    himc_drum_read(drum, 0, 2100, sound, NULL);
    TEST_ASSERT_EQUAL_MEMORY(reference + 900, sound, 2000 * sizeof *sound);
    TEST_ASSERT_EQUAL_DOUBLE(0, peak(sound + 2000, 100));
    himc_contact_report report;
    TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -900 / RATE, report.time);
    advance(6000);
    TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4100 / RATE, report.time);
}

static void test_drum_ring_keeps_the_latest_samples_only(void)
{
    says("strike -0.2 0 3");
    advance(HIMC_DRUM_RING + 10);
    himc_drum_read(drum, 0, 20, sound, seen);
    TEST_ASSERT_EQUAL_DOUBLE(0, peak(sound, 10));
    TEST_ASSERT_TRUE(sound[10] != 0);
}

static void test_drum_sounds_on_at_another_sample_rate(void)
{
    says("strike -0.2 0 3");
    advance(4800);
    himc_drum_read(drum, 4800 - 480, 480, sound, NULL);
    double before = peak(sound, 480);
    TEST_ASSERT_TRUE(himc_drum_set_rate(drum, 96000, &error));
    advance(960);
    himc_drum_read(drum, 4800, 960, sound, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(0.3 * before, before, peak(sound, 960));
    TEST_ASSERT_EQUAL_DOUBLE(96000, himc_drum_rate(drum));
}

static void test_drum_plays_more_strikes_at_once_than_it_has_mallets(void)
{
    for (int i = 0; i < 20; i++)
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, -0.2 + 0.02 * i, 0, 2, &error));
    advance(LENGTH);
    himc_contact_report report;
    int played = 0;
    while (himc_drum_strike_next(drum, &report))
        played++;
    TEST_ASSERT_EQUAL_INT(20, played);
}

static void test_drum_is_driven_by_one_performer_at_a_time(void)
{
    int a, b;
    TEST_ASSERT_TRUE(himc_drum_set_driver(drum, (himc_drum_driver){NULL, &a}));
    TEST_ASSERT_FALSE(himc_drum_set_driver(drum, (himc_drum_driver){NULL, &b}));
    TEST_ASSERT_TRUE(himc_drum_get_driver(drum).performer == &a);
    TEST_ASSERT_TRUE(himc_drum_set_driver(drum, (himc_drum_driver){NULL, NULL}));
    TEST_ASSERT_TRUE(himc_drum_set_driver(drum, (himc_drum_driver){NULL, &b}));
}

static void test_drum_allocates_nothing_while_it_plays(void)
{
    static double force[512], x[512], y[512];
    himc_stick a = {.head = *himc_drum_mallet(drum, HIMC_RIGHT),
                    .mass = 0.03,
                    .x = -0.2,
                    .height = 0.01,
                    .velocity = -3};
    himc_stick b = a, *sticks[] = {&a, &b};
    watch_allocations();
    for (int i = 0; i < 20; i++) {
        himc_contact_report report;
        himc_drum_strike_at(drum, 40 * i, 0.01 * i, 0, 2, NULL);
        force[i] = 3;
        x[i] = 0.001 * i;
        b.y = 0.001 * i;
        himc_outside_force outside = {force, x, y};
        himc_drum_advance_sticks(drum, 512, sticks, 2, NULL, &outside);
        himc_drum_read(drum, 0, 512, sound, seen);
        himc_drum_strike_next(drum, &report);
    }
    TEST_ASSERT_EQUAL_INT(0, allocations_seen());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_drum_struck_sounds_and_reports_the_contact);
    RUN_TEST(test_drum_strike_begins_on_the_sample_asked_for);
    RUN_TEST(test_drum_sounds_louder_the_harder_it_is_struck_and_a_fortissimo_does_not_clip);
    RUN_TEST(test_drum_gives_the_same_bits_in_blocks_of_any_size);
    RUN_TEST(test_drum_sound_stays_finite_with_absurd_outside_forces);
    RUN_TEST(test_an_outside_force_beyond_the_largest_acts_as_that);
    RUN_TEST(test_a_drum_without_a_name_is_refused);
    RUN_TEST(test_drum_counts_time_from_0_when_realigned_and_goes_on_sounding);
    RUN_TEST(test_drum_ring_keeps_the_latest_samples_only);
    RUN_TEST(test_drum_sounds_on_at_another_sample_rate);
    RUN_TEST(test_drum_plays_more_strikes_at_once_than_it_has_mallets);
    RUN_TEST(test_drum_is_driven_by_one_performer_at_a_time);
    RUN_TEST(test_drum_allocates_nothing_while_it_plays);
    return UNITY_END();
}
