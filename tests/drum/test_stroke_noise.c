/// test_stroke_noise.c: the noise of blows: levels, decays, seeds, blocks; none without a blow.
#include "drum/stroke_noise.h"
#include "one_drum.h"

#define LOWEST 500.0 // edge of the lowest octave (Hz)

// the noise alone: a drum with it less the same drum without
static void noise_of(const char *mallet, double velocity, double x, double *out)
{
    static double with[LENGTH];
    for (int amount = 1; amount >= 0; amount--) {
        tearDown();
        setUp();
        says(mallet);
        says(amount ? "noise 1" : "noise 0");
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, x, 0, velocity, &error));
        advance(LENGTH);
        himc_drum_read(drum, 0, LENGTH, amount ? with : out, NULL);
    }
    for (int i = 0; i < LENGTH; i++)
        out[i] = with[i] - out[i];
}

// power of n samples between two frequencies (Hz), by Butterworth's filters, each twice
static double power(const double *x, int n, double low, double high)
{
    double sum = 0, a[4] = {0}, b[4] = {0}, edge[4] = {low, high, low, high};
    double y = 0;
    for (int i = 0; i < n; i++) {
        y = x[i];
        for (int k = 0; k < 4; k++) {
            double w = tan(HIMC_PI * edge[k] / RATE), norm = 1 / (1 + w * sqrt(2) + w * w);
            double g = (k % 2 == 0 ? 1 : w * w) * norm, in = y;
            y = g * in + a[k];
            a[k] = (k % 2 == 0 ? -2 : 2) * g * in - 2 * (w * w - 1) * norm * y + b[k];
            b[k] = g * in - (1 - w * sqrt(2) + w * w) * norm * y;
        }
        sum += y * y;
    }
    return sum / n;
}

// loudest sample of 20 ms, so long after a blow (s), with `command` 50 ms after it
static double later(const char *command, double after)
{
    static double x[960];
    double most = 0;
    tearDown();
    setUp();
    says("mallet hard");
    TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, -0.2, 0, 4, &error));
    advance((int)(0.05 * RATE));
    says(command);
    advance((int)((after - 0.05) * RATE));
    himc_drum_read(drum, himc_drum_time(drum) - 960, 960, x, NULL);
    for (int i = 0; i < 960; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

static void test_a_hand_on_the_head_ends_its_noise_too(void)
{
    double free = later("damp 0", 0.35), held = later("damp 1", 0.35);
    TEST_ASSERT_TRUE(free > 1e-3);
    TEST_ASSERT_TRUE(held < 1e-3 * free);
}

static void test_noise_0_leaves_the_head_alone(void)
{
    says("noise 0");
    says("strike -0.2 0 3");
    for (int i = 0; i < LENGTH; i++) {
        double heard;
        advance(1);
        himc_drum_read(drum, (uint64_t)i, 1, &heard, NULL);
        TEST_ASSERT_EQUAL_DOUBLE(himc_membrane_sound(himc_drum_membrane(drum), 0), heard);
    }
}

// the lowest octave has the longest T60, so at last it is all that is left in the others
static void test_noise_decays_in_the_lowest_octave_as_it_should_and_faster_above(void)
{
    static double x[LENGTH];
    noise_of("mallet medium", 3, -0.2, x);
    int at = (int)(0.02 * RATE), n = (int)(1.05 / 16 * RATE);
    double fall[2];
    for (int high = 0; high < 2; high++) {
        double low = high ? 4000 : LOWEST;
        fall[high] =
            10 * log10(power(x + at, n, low, 2 * low) / power(x + at + n, n, low, 2 * low));
        printf("octave from %.0f Hz: %.1f dB in 66 ms\n", low, fall[high]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(2, 3.75, fall[0]);
    TEST_ASSERT_TRUE(fall[1] > fall[0] + 2);
}

static void test_hard_mallets_and_fast_blows_have_more_noise_for_their_force(void)
{
    static double x[LENGTH];
    double share[4][2];
    static const char *const mallets[] = {"mallet soft", "mallet medium", "mallet hard",
                                          "mallet wood"};
    for (int k = 0; k < 4; k++)
        for (int fast = 0; fast < 2; fast++) {
            noise_of(mallets[k], fast ? 4 : 1, -0.2, x);
            himc_contact_report report;
            TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
            share[k][fast] = power(x, LENGTH, LOWEST, 8000) / (report.impulse * report.impulse);
            TEST_ASSERT_TRUE(k == 0 || share[k][fast] > share[k - 1][fast]);
        }
    for (int k = 0; k < 4; k++)
        TEST_ASSERT_TRUE(share[k][1] > 1.5 * share[k][0]);
}

static void test_equal_blows_are_equal_and_others_alike(void)
{
    static double first[LENGTH], again[LENGTH], beside[LENGTH];
    double same = 0, other = 0, own = 0;
    noise_of("mallet medium", 3, -0.2, first);
    noise_of("mallet medium", 3, -0.2, again);
    noise_of("mallet medium", 3, -0.215, beside);
    for (int i = 0; i < LENGTH; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(first[i], again[i]);
        same += first[i] * first[i];
        own += beside[i] * beside[i];
        other += first[i] * beside[i];
    }
    TEST_ASSERT_TRUE(same > 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.5 * same, same, own);
    double alike = other / sqrt(same * own);
    TEST_ASSERT_TRUE(alike > 0.6 && alike < 0.95);
}

// but for the fifth that is the place's
static void test_another_seed_is_another_drum_as_loud(void)
{
    static double usual[LENGTH], zero[LENGTH], other[LENGTH];
    noise_of("mallet medium", 3, -0.2, usual);
    noise_of("noise 0.5 0", 3, -0.2, zero); // `noise 1` follows, and the seed stays
    noise_of("noise 0.5 7", 3, -0.2, other);
    double own = 0, theirs = 0, both = 0;
    for (int i = 0; i < LENGTH; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(usual[i], zero[i]);
        own += usual[i] * usual[i];
        theirs += other[i] * other[i];
        both += usual[i] * other[i];
    }
    printf("correlation %.2f, power %.2f\n", both / sqrt(own * theirs), theirs / own);
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 0.2, both / sqrt(own * theirs));
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 1, theirs / own);
}

static void test_noise_is_the_same_in_all_blocks(void)
{
    static double one[LENGTH], many[LENGTH], place[LENGTH], force[LENGTH];
    scene(1, one, place, force);
    scene(477, many, place, force);
    for (int i = 0; i < LENGTH; i++)
        TEST_ASSERT_EQUAL_DOUBLE(one[i], many[i]);
}

static void test_pickups_on_the_head_hear_none_and_distance_weakens_it(void)
{
    static double near[LENGTH], far[LENGTH], x[LENGTH];
    noise_of("pickup 0 0", 3, -0.2, x);
    for (int i = 0; i < LENGTH; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0, x[i]);
    noise_of("pickup air 0 0.2 1", 3, -0.2, near);
    noise_of("pickup air 0 0.2 4", 3, -0.2, far);
    for (int i = 0; i < LENGTH; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, near[i], 4 * far[i]);
}

// two rows of the noise of a force of 25 N that lasts so long (s)
static void blow(double amount, double lasts, double *left, double *right)
{
    himc_stroke_noise noise = himc_stroke_noise_at(RATE);
    noise.amount = amount;
    himc_stroke_noise_begin(&noise, -0.2, 0);
    for (int i = 0; i < LENGTH; i++) {
        double t = i / (lasts * RATE), force = t < 1 ? 25 * sin(HIMC_PI * t) : 0;
        himc_stroke_noise_run(&noise, 1, force, 2, (double *[]){&left[i], &right[i]});
    }
}

static double product(const double *x, const double *y)
{
    double sum = 0;
    for (int i = 0; i < LENGTH; i++)
        sum += x[i] * y[i];
    return sum;
}

static void test_noise_is_alike_at_two_places_and_goes_with_its_amount(void)
{
    static double left[LENGTH], right[LENGTH], half[2][LENGTH];
    blow(1, 0.005, left, right);
    blow(0.5, 0.005, half[0], half[1]);
    double power = product(left, left);
    double alike = product(left, right) / sqrt(power * product(right, right));
    printf("coherence %.2f\n", alike);
    TEST_ASSERT_TRUE(power > 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.65, alike); // docs/model.md
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.25, product(half[0], half[0]) / power);
}

// bands fade from 20 dB of sound pressure at 1 m (2e-6 of 100 Pa) on, and then rest
static void test_noise_rests_as_soon_as_nobody_hears_it_and_without_a_step(void)
{
    himc_stroke_noise noise = himc_stroke_noise_at(RATE);
    double left = 0, right = 0, power = 0;
    int at = 0, known = 0, rests = 0;
    himc_stroke_noise_begin(&noise, -0.2, 0);
    for (; at < 5 * RATE && (at < 200 || noise.sounds); at++) {
        himc_stroke_noise_run(&noise, 1, at < 200 ? 25 * sin(HIMC_PI * at / 200) : 0, 2,
                              (double *[]){&left, &right});
        power += (left * left - power) / (0.02 * RATE);
        rests += noise.sounds < known;
        known = noise.sounds;
        TEST_ASSERT_TRUE(at < 2000 || noise.band[0].root == 0 || power > 1e-12);
    }
    printf("rests after %.2f s, last sample %.1g\n", at / RATE, left);
    TEST_ASSERT_EQUAL_INT(2, rests);
    TEST_ASSERT_TRUE(at > 1.2 * RATE && at < 1.6 * RATE);      // a band of 1.05 s falls by 80 dB
    TEST_ASSERT_TRUE(fabs(left) < 1e-7 && fabs(right) < 1e-7); // -140 dB of 100 Pa
}

static void test_a_slow_press_makes_hardly_any_noise(void)
{
    static double fast[LENGTH], slow[LENGTH], unused[LENGTH];
    blow(1, 0.005, fast, unused);
    blow(1, 0.05, slow, unused);
    double ratio = product(slow, slow) / product(fast, fast);
    printf("a slow press has %.2g of the noise\n", ratio);
    TEST_ASSERT_TRUE(ratio < 0.01);
}

// a filter that falls for ever ends among numbers that processors are slow with
static void test_noise_drive_ends_at_0_while_the_noise_still_sounds(void)
{
    himc_stroke_noise noise = himc_stroke_noise_at(RATE);
    double x;
    himc_stroke_noise_begin(&noise, -0.2, 0);
    for (int i = 0; i < (int)(0.3 * RATE); i++)
        himc_stroke_noise_run(&noise, 1, i < 200 ? sin(HIMC_PI * i / 200) * 40 : 0, 1,
                              (double *[HIMC_NOISE_ROWS]){&x, &x});
    TEST_ASSERT_TRUE(noise.sounds);
    for (int k = 0; k < 3; k++)
        TEST_ASSERT_EQUAL_DOUBLE(0, noise.slope[k]);
}

// a listener leaves within a block, and the rest of the block depends on the host
static void test_a_second_row_is_the_same_wherever_it_paused(void)
{
    static const int pause[] = {640, 700};
    double one[2][1000], two[2][1000];
    for (int i = 0; i < 2; i++) {
        himc_stroke_noise noise = himc_stroke_noise_at(RATE);
        double *row[] = {one[i], two[i]};
        himc_stroke_noise_begin(&noise, 0.1, 0.2);
        himc_stroke_noise_run(&noise, 100, 0, 2, row);
        for (int k = 0; k < 100; k++)
            himc_stroke_noise_run(&noise, 1, 0.4 * k, 2, row);
        himc_stroke_noise_run(&noise, pause[i], 0, 2, row);
        himc_stroke_noise_run(&noise, 800 - pause[i], 0, 1, row);
        himc_stroke_noise_run(&noise, 1000, 0, 2, row);
    }
    TEST_ASSERT_TRUE(two[0][10] != 0);
    TEST_ASSERT_EQUAL_MEMORY(one[0], one[1], sizeof one[0]);
    TEST_ASSERT_EQUAL_MEMORY(two[0], two[1], sizeof two[0]);
}

// largest second difference of samples `from` .. `to` - 1 of the sound
static double kink(int from, int to)
{
    static double x[LENGTH];
    double most = 0;
    himc_drum_read(drum, 0, LENGTH, x, NULL);
    for (int i = from; i < to; i++)
        most = fmax(most, fabs(x[i + 1] - 2 * x[i] + x[i - 1]));
    return most;
}

// the noise moves with the pickup, not at once
static void test_a_pickup_that_moves_while_noise_sounds_makes_no_click(void)
{
    static const char *const move[] = {"pickup air 0 0 0.3", "pickup 0.1 0.1"};
    const int at = LENGTH / 4;
    for (int k = 0; k < 2; k++) {
        tearDown();
        setUp();
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 0, 0.2, 0.05, 4, &error));
        advance(at);
        says(move[k]);
        advance(LENGTH - at);
        // the sound there is up to 4 times as loud, and has more of the high modes
        TEST_ASSERT_TRUE(kink(at - 10, at + 10) < 4 * kink(at - 400, at - 10));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_pickup_that_moves_while_noise_sounds_makes_no_click);
    RUN_TEST(test_a_hand_on_the_head_ends_its_noise_too);
    RUN_TEST(test_noise_0_leaves_the_head_alone);
    RUN_TEST(test_noise_decays_in_the_lowest_octave_as_it_should_and_faster_above);
    RUN_TEST(test_hard_mallets_and_fast_blows_have_more_noise_for_their_force);
    RUN_TEST(test_equal_blows_are_equal_and_others_alike);
    RUN_TEST(test_another_seed_is_another_drum_as_loud);
    RUN_TEST(test_noise_is_the_same_in_all_blocks);
    RUN_TEST(test_noise_is_alike_at_two_places_and_goes_with_its_amount);
    RUN_TEST(test_noise_rests_as_soon_as_nobody_hears_it_and_without_a_step);
    RUN_TEST(test_a_slow_press_makes_hardly_any_noise);
    RUN_TEST(test_pickups_on_the_head_hear_none_and_distance_weakens_it);
    RUN_TEST(test_noise_drive_ends_at_0_while_the_noise_still_sounds);
    RUN_TEST(test_a_second_row_is_the_same_wherever_it_paused);
    return UNITY_END();
}
