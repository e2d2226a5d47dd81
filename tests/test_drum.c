#include "himc/drum.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RATE 48000.0
#define LENGTH 9600

// Counts what the C library hands out. Not under a sanitizer, which has its own malloc.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define COUNTS_ALLOCATIONS 1
static long allocations;

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *old, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *old);

void *malloc(size_t size)
{
    allocations++;
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    allocations++;
    return __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    allocations++;
    return __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    allocations++;
    return __libc_memalign(alignment, size);
}

void free(void *old)
{
    if (old)
        allocations++;
    __libc_free(old);
}
#endif

static himc_drum *drum;
static himc_error error;
static double sound[LENGTH], seen[LENGTH];

void setUp(void)
{
    error.text[0] = '\0';
    drum = himc_drum_new("kettle", 23, RATE, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(drum, error.text);
}

void tearDown(void)
{
    himc_drum_release(drum);
    drum = NULL;
}

static bool say(const char *text)
{
    himc_command command;
    return himc_command_parse_text(&command, HIMC_DRUM, text, &error) &&
           himc_drum_command(drum, &command, &error);
}

static void says(const char *text)
{
    TEST_ASSERT_TRUE_MESSAGE(say(text), error.text);
}

// a command past the parser, as another carrier might make it
static bool raw(himc_command_id id, double a, double b, double c, int count)
{
    himc_command command = {.id = id, .count = count};
    command.atom[0] = (himc_atom){HIMC_ATOM_NUMBER, a, NULL};
    command.atom[1] = (himc_atom){HIMC_ATOM_NUMBER, b, NULL};
    command.atom[2] = (himc_atom){HIMC_ATOM_NUMBER, c, NULL};
    return himc_drum_command(drum, &command, &error);
}

static void advance(int n)
{
    himc_drum_advance(drum, n, NULL, 0, NULL, NULL, NULL, NULL);
}

static double principal(void)
{
    return himc_membrane_mode(himc_drum_membrane(drum), 1).frequency;
}

static double peak(const double *x, int n)
{
    double most = 0;
    for (int i = 0; i < n; i++) {
        TEST_ASSERT_TRUE(isfinite(x[i]));
        most = fmax(most, fabs(x[i]));
    }
    return most;
}

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
    TEST_ASSERT_DOUBLE_WITHIN(10, 55, report.force);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 7.3e-3, report.duration);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.23, report.impulse);
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
    TEST_ASSERT_TRUE(before > 0.4);
}

// Two sticks and a force from outside that moves, two strikes under way, in blocks of `block`.
static void scene(int block, double *out, double *place, double *force0)
{
    tearDown();
    setUp();
    static double outside[LENGTH], x[LENGTH], y[LENGTH], force1[LENGTH];
    himc_stick a = {.head = *himc_drum_mallet(drum),
                    .mass = 0.03,
                    .acceleration = -9.81,
                    .x = -0.2,
                    .y = 0.03,
                    .height = 0.1,
                    .velocity = -3};
    himc_stick b = a, *sticks[] = {&a, &b};
    b.y = -0.03;
    b.height = 0.15;
    himc_drum_strike_at(drum, 100, 0.1, 0.1, 3, &error);
    himc_drum_strike_at(drum, 3111, 0, 0, 1, &error);
    for (int i = 0; i < LENGTH; i++) {
        outside[i] = i >= 5000 && i < 5040 ? 30 : 0;
        x[i] = i < 5020 ? 0.1 : 0.15;
        y[i] = i < 7000 ? 0 : 0.05;
    }
    for (int done = 0; done < LENGTH; done += block) {
        int n = LENGTH - done < block ? LENGTH - done : block;
        double *forces[] = {force0 + done, force1 + done};
        himc_drum_advance(drum, n, sticks, 2, forces, outside + done, x + done, y + done);
    }
    himc_drum_read(drum, 0, LENGTH, out, place);
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

static void test_drum_tunes_its_principal_mode(void)
{
    static const struct {
        const char *text;
        double hz;
    } cases[] = {{"tune 110", 110},      {"tune A2", 110},       {"tune a3", 220},
                 {"tune f#3", 184.9972}, {"tune Bb2", 116.5409}, {"tune D3", 146.8324}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        says(cases[i].text);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, cases[i].hz, principal());
    }
    TEST_ASSERT_FALSE(say("tune H2"));
    TEST_ASSERT_FALSE(say("tune 100000"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 146.8324, principal());
}

static void test_drum_commands_set_what_they_say(void)
{
    himc_membrane *membrane = himc_drum_membrane(drum);
    unsigned revision = himc_drum_revision(drum);
    says("radius 0.33");
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.33, himc_drum_place(drum)->radius);
    TEST_ASSERT_EQUAL_UINT(revision + 1, himc_drum_revision(drum));
    says("tension 4000");
    says("density 0.3");
    says("modes 2000");
    says("air 0");
    says("decay 1.5");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, log(1000) / 1.5, himc_membrane_mode(membrane, 1999).decay);
    says("decay 3 1e-7");
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-7, himc_membrane_head(membrane)->decay_square);
    TEST_ASSERT_EQUAL_INT(2000, himc_membrane_head(membrane)->modes);
    says("place 0.8 0.1 0.9 0.2");
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.2, himc_drum_place(drum)->tilt);
    says("place 0.7 0 0.8");
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.8, himc_drum_place(drum)->center.z);
    says("mallet wood");
    TEST_ASSERT_EQUAL_DOUBLE(1e10, himc_drum_mallet(drum)->stiffness);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, himc_drum_mallet(drum)->exponent);
    says("mallet 1e8 2.5 0.025");
    TEST_ASSERT_DOUBLE_WITHIN(10, 1e8, himc_drum_mallet(drum)->stiffness);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, himc_drum_mallet(drum)->exponent);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_drum_mallet(drum)->loss);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.025, himc_drum_mallet(drum)->mass);
    TEST_ASSERT_EQUAL_UINT(revision + 5, himc_drum_revision(drum));
    says("pickup 0.1 0.1");
    TEST_ASSERT_EQUAL_INT(HIMC_PICKUP_POINT, himc_membrane_pickup(membrane)->kind);
    says("pickup air 0.5 1.0472 2");
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, HIMC_PI / 3, himc_membrane_pickup(membrane)->elevation);
    char text[256];
    himc_drum_describe(drum, text, sizeof text);
    TEST_ASSERT_NOT_NULL(strstr(text, "2000 modes"));
}

static void test_drum_refuses_what_no_drum_is_and_plays_on_as_if_nothing_had_been_said(void)
{
    static const char *const bad[] = {"radius 0",
                                      "radius nan",
                                      "radius 1e30",
                                      "tension -1",
                                      "tension 0",
                                      "density 0",
                                      "modes 0",
                                      "modes 2.5",
                                      "modes 1e9",
                                      "modes nan",
                                      "decay -1",
                                      "decay 0",
                                      "decay 1 2 3",
                                      "decay 1e9 1",
                                      "tune 0",
                                      "tune nan",
                                      "tune",
                                      "mallet felt",
                                      "mallet 0 2 0.03",
                                      "mallet 1e8 2.5",
                                      "mallet nan 2 0.03",
                                      "place 1 2",
                                      "place 1e9 0 0",
                                      "pickup air 0 2 1",
                                      "pickup air 0 0 0",
                                      "pickup air 0 0",
                                      "pickup 3 3",
                                      "pickup nan 0",
                                      "pickup water 1 1 1",
                                      "strike 1 0 1",
                                      "strike 0 0 0",
                                      "strike 0 0 -1",
                                      "strike 0 0 nan",
                                      "strike 0 0 1e9",
                                      "bang",
                                      "radius x"};
    static double reference[LENGTH];
    scene(64, reference, seen, sound);
    scene(64, reference, seen, sound); // the same again: the reference is the second
    tearDown();
    setUp();
    says("strike -0.2 0 3");
    advance(LENGTH);
    himc_drum_read(drum, 0, LENGTH, reference, NULL);
    tearDown();
    setUp();
    says("strike -0.2 0 3");
    for (int done = 0, i = 0; done < LENGTH; done += 100, i++) {
        const char *text = bad[i % (int)(sizeof bad / sizeof bad[0])];
        error.text[0] = '\0';
        TEST_ASSERT_FALSE_MESSAGE(say(text), text);
        TEST_ASSERT_TRUE_MESSAGE(strlen(error.text) > 5 && !strchr(error.text, '\n'), text);
        advance(100);
    }
    himc_drum_read(drum, 0, LENGTH, sound, NULL);
    TEST_ASSERT_EQUAL_MEMORY(reference, sound, sizeof sound);
}

static void test_drum_checks_commands_that_no_parser_has_seen(void)
{
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_RADIUS, 0, 0, 0, 1));
    TEST_ASSERT_EQUAL_STRING("radius: 0 m, allowed 0.05 .. 1 m", error.text);
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_RADIUS, NAN, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_TENSION, INFINITY, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_MODES, NAN, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_MODES, 1e300, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_DECAY, NAN, NAN, 0, 2));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_TUNE, NAN, 0, 0, 1));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_MALLET, 1e8, NAN, 0.03, 3));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_PLACE, NAN, 0, 0, 3));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_PICKUP, NAN, 0, 0, 2));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_STRIKE, 0, NAN, 1, 3));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_STRIKE, 0, 0, 1, 0));
    TEST_ASSERT_FALSE(raw(HIMC_COMMAND_TEMPO, 100, 0, 0, 1));
    TEST_ASSERT_NULL(himc_drum_new("x", 11, RATE, &error));
    TEST_ASSERT_EQUAL_STRING("inches: 11 in, allowed 12 .. 60 in", error.text);
    TEST_ASSERT_NULL(himc_drum_new("x", NAN, RATE, &error));
    TEST_ASSERT_NULL(himc_drum_new("x", 23, 0, &error));
    TEST_ASSERT_NULL(himc_drum_new("a name that is much longer than it may be", 23, RATE, &error));
    TEST_ASSERT_FALSE(himc_drum_set_rate(drum, 7999, &error));
    TEST_ASSERT_FALSE(himc_drum_strike_at(drum, -1, 0, 0, 1, &error));
    for (int i = 0; i < 64; i++)
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 8000, 0, 0, 1, &error));
    TEST_ASSERT_FALSE(himc_drum_strike_at(drum, 8000, 0, 0, 1, &error));
}

static void test_drum_forces_from_outside_that_are_absurd_leave_the_sound_finite(void)
{
    static double force[4096], x[4096], y[4096];
    for (int i = 0; i < 4096; i++) {
        static const double odd[] = {NAN, 1e300, -INFINITY, -1e300, 0, 1, 1e-320};
        force[i] = odd[i % 7];
        x[i] = i % 11 == 0 ? NAN : i % 13 == 0 ? 1e300 : 0.1;
        y[i] = i % 17 == 0 ? INFINITY : 0;
    }
    himc_drum_advance(drum, 4096, NULL, 0, NULL, force, x, y);
    advance(4096);
    himc_drum_read(drum, 0, 8192, sound, seen);
    TEST_ASSERT_TRUE(peak(sound, 8192) < 1e6);
    TEST_ASSERT_TRUE(peak(seen, 8192) < 100);
}

static void test_drum_survives_any_change_in_the_middle_of_a_contact(void)
{
    static const char *const lines[] = {
        "radius 0.1", "tension 50",  "modes 1",         "modes 2000",   "tune 500",
        "radius 1",   "density 10",  "decay 1000 1e-3", "density 0.01", "tension 50000",
        "modes 200",  "mallet wood", "decay 3 3e-7",    "radius 0.29",  "pickup 0 0"};
    for (int i = 0; i < 60; i++) {
        says("strike 0.05 0.05 8");
        advance(100);
        says(lines[i % 15]);
        advance(50);
    }
    himc_drum_read(drum, 0, 9000, sound, seen);
    TEST_ASSERT_TRUE(peak(sound, 9000) > 0.1);
    advance(48000);
    himc_drum_read(drum, 50000, 5000, sound, seen);
    TEST_ASSERT_TRUE(peak(sound, 5000) < 1);
}

static void test_drum_counts_time_anew_when_realigned_and_keeps_sounding(void)
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

static void test_drum_keeps_the_last_of_its_sound_and_nothing_older(void)
{
    says("strike -0.2 0 3");
    advance(HIMC_DRUM_RING + 10);
    himc_drum_read(drum, 0, 20, sound, seen);
    TEST_ASSERT_EQUAL_DOUBLE(0, peak(sound, 10));
    TEST_ASSERT_TRUE(sound[10] != 0);
}

static void test_drum_goes_on_sounding_at_another_rate(void)
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

static void test_drum_takes_more_strikes_at_once_than_it_has_mallets_and_plays_all(void)
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

static void test_drum_belongs_to_one_performer_at_a_time(void)
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
#ifdef COUNTS_ALLOCATIONS
    static double force[512], x[512], y[512];
    himc_stick a = {
        .head = *himc_drum_mallet(drum), .mass = 0.03, .x = -0.2, .height = 0.01, .velocity = -3};
    himc_stick b = a, *sticks[] = {&a, &b};
    long before = allocations;
    for (int i = 0; i < 20; i++) {
        himc_contact_report report;
        himc_drum_strike_at(drum, 40 * i, 0.01 * i, 0, 2, NULL);
        force[i] = 3;
        x[i] = 0.001 * i;
        b.y = 0.001 * i;
        himc_drum_advance(drum, 512, sticks, 2, NULL, force, x, y);
        himc_drum_read(drum, 0, 512, sound, seen);
        himc_drum_strike_next(drum, &report);
    }
    TEST_ASSERT_EQUAL_INT(0, (int)(allocations - before));
    // the counter does count
    himc_drum_release(himc_drum_new("other", 23, RATE, NULL));
    TEST_ASSERT_TRUE(allocations > before);
#else
    TEST_IGNORE_MESSAGE("malloc is not ours to count here");
#endif
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_drum_struck_sounds_and_reports_the_contact);
    RUN_TEST(test_drum_strike_begins_on_the_sample_asked_for);
    RUN_TEST(test_drum_sounds_louder_the_harder_it_is_struck_and_a_fortissimo_does_not_clip);
    RUN_TEST(test_drum_gives_the_same_bits_in_blocks_of_any_size);
    RUN_TEST(test_drum_tunes_its_principal_mode);
    RUN_TEST(test_drum_commands_set_what_they_say);
    RUN_TEST(test_drum_refuses_what_no_drum_is_and_plays_on_as_if_nothing_had_been_said);
    RUN_TEST(test_drum_checks_commands_that_no_parser_has_seen);
    RUN_TEST(test_drum_forces_from_outside_that_are_absurd_leave_the_sound_finite);
    RUN_TEST(test_drum_survives_any_change_in_the_middle_of_a_contact);
    RUN_TEST(test_drum_counts_time_anew_when_realigned_and_keeps_sounding);
    RUN_TEST(test_drum_keeps_the_last_of_its_sound_and_nothing_older);
    RUN_TEST(test_drum_goes_on_sounding_at_another_rate);
    RUN_TEST(test_drum_takes_more_strikes_at_once_than_it_has_mallets_and_plays_all);
    RUN_TEST(test_drum_belongs_to_one_performer_at_a_time);
    RUN_TEST(test_drum_allocates_nothing_while_it_plays);
    return UNITY_END();
}
