/// test_change.c: anything changed at any moment while a drum sounds: no click, nothing lost, and
/// techniques that take turns.
#include "himc/drum.h"

#include "unity.h"
#include "himc/membrane.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define RATE 48000
#define BEFORE (RATE / 2)
#define LENGTH RATE

static himc_drum *drum;
static himc_error error;
static double sound[LENGTH], other[LENGTH];

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

static void remake(void)
{
    himc_drum_release(drum);
    drum = himc_drum_new("timpano", 23, RATE, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(drum, error.text);
    himc_drum_set_external_sound(drum, true);
    says("air 1");
    says("decay 0.5 3e-7");
    says("tune D3");
}

void setUp(void)
{
    error.text[0] = '\0';
    drum = NULL;
    remake();
}

void tearDown(void)
{
    himc_drum_release(drum);
    drum = NULL;
}

static void play(int at, int n)
{
    for (int done = 0, count; done < n; done += count) {
        count = n - done < 4800 ? n - done : 4800;
        himc_drum_advance(drum, count, NULL, NULL, NULL);
        himc_drum_read(drum, himc_drum_time(drum) - (uint64_t)count, count, sound + at + done,
                       NULL);
    }
}

// largest step, and largest change of the step, from one sample to the next in [from, to)
static void steps(int from, int to, double *step, double *bend)
{
    *step = *bend = 0;
    for (int i = from; i < to; i++) {
        *step = fmax(*step, fabs(sound[i] - sound[i - 1]));
        *bend = fmax(*bend, fabs(sound[i] - 2 * sound[i - 1] + sound[i - 2]));
    }
}

static double peak(const double *x, int from, int to)
{
    double most = 0;
    for (int i = from; i < to; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

// Half a second of a strike, and the largest step and bend of the attack's last and the ringing:
// what a listener has in the ear. With `change` the drum was changed before.
static void ring_on(const char *change, double *step, double *bend)
{
    remake();
    if (change)
        says(change);
    says("strike -0.219 0.02 5");
    play(0, BEFORE);
    steps(BEFORE / 4, BEFORE, step, bend);
}

static void test_any_change_while_ringing_makes_no_larger_step_than_the_ringing(void)
{
    static const char *const change[] = {
        "modes 20",         "modes 900",          "modes 1",        "damp 0.3",
        "damp 1",           "mallet wood",        "air 0",          "kettle 0.06",
        "glide 0",          "density 0.4",        "radius 0.35",    "tension 6000",
        "tune A3",          "decay 20 1e-6",      "shape circle",   "shape rectangle 0.5 0.4",
        "pickup air 2 1 1", "pickup air 0 0.2 3", "technique clip", "pickups 3",
        "uniformity 0.3 9"};
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        double own, own_bend, then, then_bend, step, bend;
        ring_on(change[i], &then, &then_bend);
        ring_on(NULL, &own, &own_bend);
        own = fmax(own, then);
        own_bend = fmax(own_bend, then_bend);
        says(change[i]);
        play(BEFORE, RATE / 20);
        steps(BEFORE, BEFORE + RATE / 20, &step, &bend);
        if (!(step <= 1.05 * own && bend <= 2 * own_bend)) {
            char text[120];
            snprintf(text, sizeof text, "%s: step %.3g of %.3g, bend %.3g of %.3g", change[i], step,
                     own, bend, own_bend);
            TEST_FAIL_MESSAGE(text);
        }
    }
}

// the largest step of a strike on that list of modes; with `change` the drum was changed before
static double blow_on(const char *modes, const char *change)
{
    double step, bend;
    remake();
    says(modes);
    if (change)
        says(change);
    says("strike -0.219 0.02 5");
    play(0, 1200);
    steps(2, 1200, &step, &bend);
    return step;
}

static void change_in_contact(const char *modes, const char *change)
{
    double own = fmax(blow_on(modes, NULL), blow_on(modes, change)), step, bend;
    remake();
    says(modes);
    says("strike -0.219 0.02 5");
    play(0, 150); // 3 of about 8 ms
    says(change);
    play(150, 1050);
    // the force goes on from where it was, on a head that yields otherwise
    steps(150, 198, &step, &bend);
    if (!(step <= 1.5 * own && bend <= own)) {
        char text[120];
        snprintf(text, sizeof text, "%s, %s: step %.3g, bend %.3g, own step %.3g", modes, change,
                 step, bend, own);
        TEST_FAIL_MESSAGE(text);
    }
    himc_contact_report report;
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_strike_next(drum, &report), change);
    TEST_ASSERT_TRUE_MESSAGE(report.force > 20 && report.force < 60, change);
}

static void test_any_change_in_contact_makes_no_larger_step_than_a_strike(void)
{
    static const char *const change[] = {"modes 50",    "modes 900", "modes auto",
                                         "damp 0.5",    "air 0",     "mallet wood",
                                         "kettle 0.06", "glide 0",   "tune G3"};
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        change_in_contact("modes 200", change[i]);
        change_in_contact("modes auto", change[i]);
    }
    change_in_contact("modes 200", "tune A3");
}

static void test_change_of_technique_silences_the_head_in_10_ms_and_it_still_vibrates(void)
{
    says("strike -0.219 0.02 5");
    play(0, LENGTH);
    memcpy(other, sound, sizeof other);
    remake();
    says("strike -0.219 0.02 5");
    play(0, 10000);
    says("technique signal");
    TEST_ASSERT_EQUAL_INT(HIMC_TECHNIQUE_SIGNAL, himc_drum_technique(drum));
    play(10000, 10000);
    TEST_ASSERT_EQUAL_DOUBLE(0, peak(sound, 10480, 20000));
    says("technique modal");
    play(20000, LENGTH - 20000);
    // to the last bit what it would have been
    TEST_ASSERT_EQUAL_MEMORY(other, sound, 10000 * sizeof *sound);
    TEST_ASSERT_EQUAL_MEMORY(other + 20480, sound + 20480, (LENGTH - 20480) * sizeof *sound);
    TEST_ASSERT_TRUE(peak(sound, 20480, LENGTH) > 0.001);
}

static void test_technique_is_refused_without_an_external_sound(void)
{
    himc_drum_set_external_sound(drum, false);
    TEST_ASSERT_FALSE(say("technique clip"));
    TEST_ASSERT_EQUAL_STRING("technique: clip, expected modal here: signal and clip are patches, "
                             "[technique~ NAME] in Pure Data",
                             error.text);
    TEST_ASSERT_FALSE(say("technique fm"));
    TEST_ASSERT_NOT_NULL(strstr(error.text, "modal signal clip"));
    TEST_ASSERT_EQUAL_INT(HIMC_TECHNIQUE_MODAL, himc_drum_technique(drum));
    says("technique modal");
}

static void test_contact_onsets_of_strikes_have_place_velocity_and_pitch(void)
{
    himc_contact_onset touch;
    himc_drum_strike_at(drum, 100, -0.1, 0.1, 3, &error);
    himc_drum_strike_at(drum, 3000, 0, 0, 1, &error);
    play(0, 5000);
    TEST_ASSERT_TRUE(himc_drum_contact_next(drum, &touch));
    TEST_ASSERT_EQUAL_INT(100, (int)touch.at);
    TEST_ASSERT_EQUAL_DOUBLE(3, touch.velocity);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(0.02) / 0.2921, touch.distance);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 146.83, touch.pitch);
    TEST_ASSERT_TRUE(himc_drum_contact_next(drum, &touch));
    TEST_ASSERT_EQUAL_INT(3000, (int)touch.at);
    TEST_ASSERT_FALSE(himc_drum_contact_next(drum, &touch));
}

static void test_of_contact_onsets_not_taken_the_latest_64_are_kept(void)
{
    himc_contact_onset touch;
    int count = 0;
    for (int i = 0; i < 70; i++) {
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, 0, 0, 1 + i % 20, &error));
        himc_drum_advance(drum, 4000, NULL, NULL, NULL);
    }
    while (himc_drum_contact_next(drum, &touch))
        count++;
    TEST_ASSERT_EQUAL_INT(64, count);
    TEST_ASSERT_EQUAL_INT(69 * 4000, (int)touch.at);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_any_change_while_ringing_makes_no_larger_step_than_the_ringing);
    RUN_TEST(test_any_change_in_contact_makes_no_larger_step_than_a_strike);
    RUN_TEST(test_change_of_technique_silences_the_head_in_10_ms_and_it_still_vibrates);
    RUN_TEST(test_technique_is_refused_without_an_external_sound);
    RUN_TEST(test_contact_onsets_of_strikes_have_place_velocity_and_pitch);
    RUN_TEST(test_of_contact_onsets_not_taken_the_latest_64_are_kept);
    return UNITY_END();
}
