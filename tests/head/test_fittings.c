/// test_fittings.c: what a stick meets beside the head: hoop, shell, another stick; and a hi-hat's
/// plates, which a foot closes.
#include "made_drum.h"
#include "unity.h"

#include "base/head_frame.h"
#include "drum/contact.h"
#include "drum/drum_state.h"
#include "head/two_heads.h"
#include "himc/loader.h"

#include <math.h>
#include <string.h>

#define RATE 48000.0
#define LENGTH 24000 // samples

static himc_drum *drum;
static double sound[LENGTH];

void setUp(void)
{
    drum = NULL;
}

void tearDown(void)
{
    himc_drum_release(drum);
}

static void make(const char *words)
{
    himc_drum_release(drum);
    drum = made_drum(words, RATE);
}

// advances with a stick, or NULL, and hears it from sample `from` on
static void hear(himc_stick *stick, int from, int to)
{
    for (int i = from; i < to; i += 100) {
        uint64_t at = himc_drum_time(drum);
        himc_drum_advance_sticks(drum, 100, &stick, stick ? 1 : 0, NULL, NULL);
        himc_drum_read(drum, at, 100, sound + i, NULL);
    }
}

// A stick as of a hand strikes a new drum at a spot; returns it, largest force and all.
static himc_stick strike(const char *words, himc_spot spot, double speed)
{
    double x, y;
    make(words);
    const himc_head_frame *frame = himc_drum_head_frame(drum);
    himc_stroke stroke = {.hand = HIMC_RIGHT, .spot = spot};
    himc_head_frame_spot(frame, &stroke, &x, &y);
    himc_stick stick = {.head = *himc_drum_mallet(drum, HIMC_RIGHT),
                        .mass = 0.008,
                        .x = x,
                        .y = y,
                        .height = 1e-4,
                        .velocity = -speed};
    himc_drum_meet(drum, spot, &stick);
    hear(&stick, 0, LENGTH);
    return stick;
}

// (dB) of a band of frequencies in samples from .. to
static double band(double low, double high, int from, int to)
{
    double power = 0, step = RATE / (to - from);
    for (double f = ceil(low / step) * step; f < high; f += step) {
        double even = 0, odd = 0;
        for (int i = from; i < to; i++) {
            even += sound[i] * cos(2 * HIMC_PI * f / RATE * i);
            odd += sound[i] * sin(2 * HIMC_PI * f / RATE * i);
        }
        power += even * even + odd * odd;
    }
    return 10 * log10(power + 1e-30);
}

static double loudest(void)
{
    double most = 0;
    for (int i = 0; i < LENGTH; i++)
        most = fmax(most, fabs(sound[i]));
    return most;
}

// (dB) of all from one time to another (s)
static double level(double from, double to)
{
    double sum = 1e-30;
    for (int i = (int)(from * RATE); i < (int)(to * RATE); i++)
        sum += sound[i] * sound[i];
    return 10 * log10(sum / (to - from));
}

static void test_a_rim_shot_is_louder_and_brighter_than_the_same_stroke_in_the_centre(void)
{
    static const char *const drums[] = {"snare", "tom 12", "timbale"};
    for (int i = 0; i < 3; i++) {
        strike(drums[i], HIMC_SPOT_CENTER, 4);
        double bright = band(2000, 8000, 0, 2400), deep = band(100, 500, 0, 2400), loud = loudest();
        strike(drums[i], HIMC_SPOT_RIMSHOT, 4);
        TEST_ASSERT_TRUE_MESSAGE(band(2000, 8000, 0, 2400) > bright + 6, drums[i]);
        TEST_ASSERT_DOUBLE_WITHIN(4, deep, band(100, 500, 0, 2400)); // the tip is on the head
        TEST_ASSERT_TRUE_MESSAGE(loudest() > 1.2 * loud, drums[i]);
    }
}

static void test_a_cross_stick_clicks_and_no_head_rings(void)
{
    strike("snare", HIMC_SPOT_CENTER, 4);
    double rings = band(100, 500, 2400, 12000), loud = loudest();
    himc_stick stick = strike("snare", HIMC_SPOT_CROSSSTICK, 4);
    TEST_ASSERT_TRUE(stick.contacts >= 1);
    TEST_ASSERT_TRUE(band(100, 500, 2400, 12000) < rings - 30);
    double wood = band(1000, 2000, 0, 2400);
    TEST_ASSERT_TRUE(wood > band(100, 1000, 0, 2400) + 6);
    for (double f = 2000; f < 12000; f += 200) // no higher line is as strong
        TEST_ASSERT_TRUE(band(1100, 1300, 0, 2400) > band(f, f + 200, 0, 2400) + 3);
    TEST_ASSERT_TRUE(level(0.06, 0.08) < level(0, 0.02) - 20);
    TEST_ASSERT_TRUE(loudest() > 0.2 * loud && loudest() < 2 * loud);
}

static void test_sticks_and_shell_sound_of_wood_alone(void)
{
    strike("snare", HIMC_SPOT_CLICK, 4);
    double sticks = band(200, 1000, 0, 2400) - band(1000, 4000, 0, 2400);
    TEST_ASSERT_TRUE(band(200, 500, 2400, 12000) < band(1000, 2000, 0, 2400) - 40);
    strike("snare", HIMC_SPOT_SHELL, 4);
    double shell = band(200, 1000, 0, 2400) - band(1000, 4000, 0, 2400);
    TEST_ASSERT_TRUE(shell > sticks + 6); // a shell sounds lower
    TEST_ASSERT_TRUE(level(0.15, 0.2) < level(0, 0.02) - 30);
}

// 2, 4 and 8 m/s: louder each time, by more the higher the band, as contacts are shorter
static void test_a_harder_blow_is_louder_and_brighter(void)
{
    for (himc_spot spot = HIMC_SPOT_CROSSSTICK; spot < HIMC_SPOT_XY; spot++) {
        double before = 0, bright = 0;
        for (double speed = 2; speed < 9; speed *= 2) {
            strike("snare", spot, speed);
            double now = band(100, 12000, 0, 2400), high = band(6000, 12000, 0, 2400);
            if (speed > 2) {
                TEST_ASSERT_TRUE_MESSAGE(now > before + 4 && now < before + 10,
                                         himc_spot_name(spot));
                TEST_ASSERT_TRUE_MESSAGE(high - bright > now - before, himc_spot_name(spot));
            }
            before = now;
            bright = high;
        }
    }
}

static void test_no_blow_gives_more_than_it_has(void)
{
    for (himc_spot spot = HIMC_SPOT_CROSSSTICK; spot < HIMC_SPOT_XY; spot++)
        for (double speed = 0.5; speed < 9; speed *= 2) {
            strike("snare", spot, speed);
            make("snare");
            himc_stick stick = {.head = *himc_drum_mallet(drum, HIMC_RIGHT),
                                .mass = 0.008,
                                .x = -0.16,
                                .height = 1e-4,
                                .velocity = -speed};
            himc_drum_meet(drum, spot, &stick);
            // of a rim shot the shaft's, which is launched with half the speed
            double shaft = spot == HIMC_SPOT_RIMSHOT ? 0.5 * 0.05 * speed * speed / 4 : 0;
            double given = himc_contact_energy(&stick) + shaft, last = given;
            himc_stick *sticks = &stick;
            for (int i = 0; i < 4800; i += 48) {
                himc_drum_advance_sticks(drum, 48, &sticks, 1, NULL, NULL);
                double now = himc_membrane_energy(himc_drum_membrane(drum));
                TEST_ASSERT_TRUE_MESSAGE(now + himc_contact_energy(&stick) <= given * (1 + 1e-12),
                                         himc_spot_name(spot));
                TEST_ASSERT_TRUE(i < 480 || now <= last);
                last = now;
            }
        }
}

static void test_drums_that_hands_or_beaters_play_have_no_such_spots(void)
{
    strike("bongo", HIMC_SPOT_CENTER, 4);
    double same = band(100, 8000, 0, 2400);
    himc_stick stick = {.x = -0.1};
    himc_drum_meet(drum, HIMC_SPOT_CROSSSTICK, &stick);
    TEST_ASSERT_EQUAL_DOUBLE(-0.1, stick.x);
    TEST_ASSERT_TRUE(same > -100);
}

// closes the hats with a foot's speed `ahead` samples from now
static void chick(double speed, int ahead)
{
    himc_error error = {0};
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_kick(drum, ahead, 0, 0, speed, 1, &error), error.text);
}

static void test_hats_that_a_foot_closes_say_chick(void)
{
    double before = -INFINITY, ago;
    himc_contact_report report = {0};
    for (double speed = 1.5; speed < 7; speed *= 2) {
        make("hi-hat");
        chick(speed, 0);
        hear(NULL, 0, LENGTH);
        TEST_ASSERT_TRUE(level(0.1, 0.14) < level(0, 0.02) - 20); // it dies soon
        double now = level(0, 0.1);
        TEST_ASSERT_TRUE(now > before + 3);
        before = now;
        TEST_ASSERT_EQUAL_INT(1, himc_drum_kicked(drum, &report, &ago)); // one stroke
        TEST_ASSERT_EQUAL_INT(0, himc_drum_kicked(drum, &report, &ago));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.2 * speed, report.velocity);
    }
}

static void test_a_foot_chokes_open_hats(void)
{
    double rings[2];
    for (int k = 0; k < 2; k++) {
        himc_command open;
        make("hi-hat");
        TEST_ASSERT_TRUE(himc_command_parse_text(&open, HIMC_DRUM, "pedal 0", NULL));
        TEST_ASSERT_TRUE(himc_drum_command(drum, &open, NULL));
        himc_drum_strike_at(drum, 0, -0.15, 0, 4, NULL);
        if (k)
            chick(4, 4800);
        hear(NULL, 0, LENGTH);
        rings[k] = level(0.3, 0.4);
    }
    TEST_ASSERT_TRUE(rings[1] < rings[0] - 20);
}

static void test_smaller_hoops_and_shells_sound_higher_sticks_alike(void)
{
    const struct {
        int index; // hoop, stick, shell
        double higher;
    } of[] = {{0, 4}, {7, 1}, {10, 2}};
    for (int i = 0; i < 3; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, of[i].higher,
                                  himc_fittings_oscillator(of[i].index, .089).omega /
                                      himc_fittings_oscillator(of[i].index, .178).omega);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_rim_shot_is_louder_and_brighter_than_the_same_stroke_in_the_centre);
    RUN_TEST(test_a_cross_stick_clicks_and_no_head_rings);
    RUN_TEST(test_sticks_and_shell_sound_of_wood_alone);
    RUN_TEST(test_a_harder_blow_is_louder_and_brighter);
    RUN_TEST(test_no_blow_gives_more_than_it_has);
    RUN_TEST(test_drums_that_hands_or_beaters_play_have_no_such_spots);
    RUN_TEST(test_hats_that_a_foot_closes_say_chick);
    RUN_TEST(test_a_foot_chokes_open_hats);
    RUN_TEST(test_smaller_hoops_and_shells_sound_higher_sticks_alike);
    return UNITY_END();
}
