/// test_uniformity.c: a head with uneven lugs: how far its pairs split, on which axes, and how they
/// beat; an even head is as it was.
#include "dry_drum.h"
#include "exact_shape.h"
#include "inner_state.h"
#include "one_drum.h"

#include "head/bessel.h"
#include "head/modes.h"
#include "head/uneven.h"

#include <stdio.h>
#include <string.h>

#define SECONDS 24
#define WINDOW 2400 // samples of one value of an envelope: 50 ms

// int sigma_ij d_i phi d_j phi over a disc of radius 1 for phi = J_m(z r) cos(m th + phase) and the
// film in balance under a radial pull cos(k th) at the rim without shear: Airy's function is
// (A r^k + B r^(k+2)) cos(k th). Midpoints in both directions.
static double stiffening(int m, double z, double phase)
{
    int k = 2 * m;
    double b = 1 / (2 * (k + 1.0)), a = -1 / (2 * (k - 1.0)), sum = 0;
    for (int i = 0; i < 200; i++) {
        double r = (i + 0.5) / 200, low = a * pow(r, k - 2), high = b * pow(r, k);
        double j = himc_bessel_j(m, z * r), next = himc_bessel_j(m + 1, z * r);
        double slope = m * j / r - z * next;
        double radial = k * (1 - k) * low + (k + 2 - k * k) * high;
        double round = k * (k - 1) * low + (k + 2) * (k + 1) * high;
        double shear = k * ((k - 1) * low + (k + 1) * high);
        for (int t = 0; t < 64; t++) {
            double th = 2 * HIMC_PI * (t + 0.5) / 64;
            double along = slope * cos(m * th + phase), across = -m * j / r * sin(m * th + phase);
            double stress = radial * along * along + round * across * across;
            sum += r * (cos(k * th) * stress + 2 * shear * sin(k * th) * along * across);
        }
    }
    return sum * 2 * HIMC_PI / 64 / 200;
}

// int |grad phi|^2 over the disc
static double stiffness(int m, double z)
{
    double next = himc_bessel_j(m + 1, z);
    return 0.5 * HIMC_PI * z * z * next * next;
}

static double closed_form(int m)
{
    double k = 2 * m;
    return (2 * k - 1) / (2 * (k * k - 1));
}

static void test_closed_form_of_the_split_is_that_of_a_film_in_balance(void)
{
    for (int m = 1; m <= 4; m++)
        for (int n = 1; n <= 2; n++) {
            double z = himc_bessel_zero(m, n);
            double split = stiffening(m, z, 0) - stiffening(m, z, HIMC_PI / 2);
            // w^2 of both members over that of the even head, per harmonic of 1
            TEST_ASSERT_DOUBLE_WITHIN(2e-3 * closed_form(m), closed_form(m),
                                      0.5 * split / stiffness(m, z));
            // the tighter axis is stiffer
            TEST_ASSERT_TRUE(split > 0);
        }
}

// The errors of eight lugs, the first half a step from the x axis, that have the directions of the
// orders 1, 2 and 4 have those of all others: finer harmonics are aliases.
static void test_lugs_2_percent_off_split_as_their_harmonics_say(void)
{
    static himc_lugs_pair pairs[HIMC_LUGS_ORDERS];
    for (int seed = 0; seed < 40; seed++) {
        double error_of[8];
        himc_lugs_split(0.25, seed, pairs);
        // a stroke on the x axis excites both members of (1,1)
        TEST_ASSERT_DOUBLE_WITHIN(0.25 + 1e-9, 0.5, pow(cos(pairs[1].axis), 2));
        for (int l = 0; l < 8; l++) {
            double th = 2 * HIMC_PI * (l + 0.5) / 8;
            // the sine of an order is on the tighter axis
            error_of[l] = -cos(2 * (th - pairs[1].axis)) - 0.5 * cos(4 * (th - pairs[2].axis)) +
                          -0.5 * cos(16 * pairs[8].axis);
        }
        // the lugs themselves, tight where they pull, half a step from the x axis
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, closed_form(4) * 0.75 * 0.1, pairs[4].split);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, pairs[4].axis);
        for (int m = 1; m <= 9; m += m == 3 ? 2 : 1) {
            double even = 0, odd = 0, k = 2 * m, hoop = m > 2 ? 1 / (1 + pow(k / 4, 4)) : 1;
            for (int l = 0; l < 8; l++) {
                even += error_of[l] * cos(k * 2 * HIMC_PI * (l + 0.5) / 8);
                odd += error_of[l] * sin(k * 2 * HIMC_PI * (l + 0.5) / 8);
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, -1, cos(atan2(odd, even) - k * pairs[m].axis));
            TEST_ASSERT_DOUBLE_WITHIN(1e-15, closed_form(m) * hoop * 2 * (0.75 * 0.02) / sqrt(8),
                                      pairs[m].split);
        }
    }
}

// sound of a stroke on a new drum after that command, into `out` (LENGTH)
static void stroke_after(const char *text, double *out)
{
    tearDown();
    setUp();
    says(text);
    says("strike -0.2 0.03 4");
    advance(LENGTH);
    himc_drum_read(drum, 0, LENGTH, out, NULL);
}

static void test_an_even_head_is_the_same_for_every_seed_to_the_bit(void)
{
    stroke_after("uniformity 0.5 77", seen);
    stroke_after("uniformity 1 0", sound);
    TEST_ASSERT_FALSE(memcmp(sound, seen, sizeof sound) == 0);
    stroke_after("uniformity 1 77", seen);
    TEST_ASSERT_EQUAL_MEMORY(sound, seen, sizeof sound);
    himc_membrane *head = himc_drum_membrane(drum);
    for (int i = 1; himc_membrane_mode(head, i).mass > 0; i++) {
        himc_mode a = himc_membrane_mode(head, i - 1), b = himc_membrane_mode(head, i);
        TEST_ASSERT_TRUE(!b.sine || (a.frequency == b.frequency && a.decay == b.decay));
        TEST_ASSERT_EQUAL_DOUBLE(0, b.axis);
    }
}

static void test_both_members_keep_the_mean_frequency_mass_and_air(void)
{
    himc_membrane *head = himc_drum_membrane(drum);
    says("uniformity 1");
    himc_mode even = himc_membrane_mode(head, 1);
    says("uniformity 0.3 5");
    himc_mode low = himc_membrane_mode(head, 1), high = himc_membrane_mode(head, 2);
    static himc_lugs_pair pairs[HIMC_LUGS_ORDERS];
    himc_lugs_split(0.3, 5, pairs);
    double mean = 0.5 * (low.frequency + high.frequency);
    TEST_ASSERT_TRUE(low.m == 1 && !low.sine && high.m == 1 && high.sine);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * pairs[1].split, pairs[1].split,
                              (high.frequency - low.frequency) / mean);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5 * mean, even.frequency, mean); // mixing takes some
    TEST_ASSERT_EQUAL_DOUBLE(even.mass, low.mass);
    TEST_ASSERT_EQUAL_DOUBLE(even.mass, high.mass);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * even.decay, even.decay, high.decay);
}

// amplitude of `hz` in a window that begins at sample `at`
static double envelope(const double *x, int at, double hz)
{
    double even = 0, odd = 0;
    for (int i = 0; i < WINDOW; i++) {
        double phase = 2 * HIMC_PI * hz * (at + i) / RATE,
               hann = 1 - cos(2 * HIMC_PI * (i + 0.5) / WINDOW);
        even += hann * x[at + i] * cos(phase);
        odd += hann * x[at + i] * sin(phase);
    }
    return hypot(even, odd);
}

// Frequency (Hz) at which the envelope of `hz` beats, from its crossings of its mean square, by
// straight lines between windows.
static double beat_of(const double *x, double hz)
{
    enum { COUNT = SECONDS * 20 - 1 };
    double square[COUNT], mean = 0, first = 0, last = 0;
    int crossings = 0;
    for (int i = 0; i < COUNT; i++) {
        square[i] = pow(envelope(x, i * WINDOW, hz), 2);
        mean += square[i] / COUNT;
    }
    for (int i = 1; i < COUNT; i++)
        if (square[i - 1] < mean && square[i] >= mean) {
            last = i - (square[i] - mean) / (square[i] - square[i - 1]);
            first = crossings++ ? first : last;
        }
    TEST_ASSERT_TRUE(crossings > 3);
    return (crossings - 1) / ((last - first) * WINDOW / RATE);
}

static void test_a_rendered_stroke_beats_at_the_computed_split(void)
{
    static double ringing[(int)RATE * SECONDS];
    make_dry(drum);
    says("modes 20");
    says("glide 0");
    says("decay 0 0");
    says("pickup 0.1 0.06");
    says("uniformity 0 2");
    himc_mode low = himc_membrane_mode(himc_drum_membrane(drum), 1),
              high = himc_membrane_mode(himc_drum_membrane(drum), 2);
    // between the axes of the pair (1,1), so that both members sound
    char text[80];
    double r = 0.2, th = low.axis + HIMC_PI / 4;
    snprintf(text, sizeof text, "strike %.6f %.6f 3", r * cos(th), r * sin(th));
    says(text);
    for (int at = 0; at < RATE * SECONDS; at += 4800) {
        advance(4800);
        himc_drum_read(drum, (uint64_t)at, 4800, ringing + at, NULL);
    }
    double split = high.frequency - low.frequency,
           beat = beat_of(ringing, 0.5 * (high.frequency + low.frequency));
    printf("(1,1) at %.2f Hz: split %.4f Hz, beat %.4f Hz\n", low.frequency, split, beat);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * split, split, beat);
}

// part of the sine in the energy of (1,1) after a blow in that direction from the pair's axis
static double share_of_sine(double angle)
{
    char text[80];
    tearDown();
    setUp();
    says("uniformity 0.5 11");
    himc_membrane *head = himc_drum_membrane(drum);
    double th = himc_membrane_mode(head, 1).axis + angle, energy[2];
    snprintf(text, sizeof text, "strike %.9f %.9f 3", 0.2 * cos(th), 0.2 * sin(th));
    says(text);
    advance(1440);
    for (int i = 1; i <= 2; i++) {
        double q, v;
        himc_mode mode = himc_membrane_mode(head, i);
        himc_membrane_state(head, i, &q, &v);
        energy[i - 1] = mode.stiffness * q * q + mode.mass * v * v;
    }
    return energy[1] / (energy[0] + energy[1]);
}

static void test_strokes_at_other_angles_excite_other_mixtures(void)
{
    for (int k = 0; k <= 4; k++) {
        double angle = k * HIMC_PI / 8;
        TEST_ASSERT_DOUBLE_WITHIN(0.01, pow(sin(angle), 2), share_of_sine(angle));
    }
}

// displacements at eight places
static void look(double *w)
{
    for (int i = 0; i < 8; i++)
        w[i] = himc_membrane_displacement(himc_drum_membrane(drum), 0.2 * cos(i), 0.2 * sin(i));
}

static void test_turned_axes_keep_the_shape_and_never_add_energy(void)
{
    static const char *const change[] = {"uniformity 0.5 1", "uniformity 0.5 2",
                                         "uniformity 0 3",   "uniformity 1",
                                         "uniformity 0.2 4", "uniformity 0.2 9"};
    himc_membrane *head = himc_drum_membrane(drum);
    double before[8], after[8];
    says("modes 120");
    says("decay 0 0");
    says("uniformity 1");
    says("strike -0.17 0.08 6");
    advance(2400);
    for (int i = 0; i < 6; i++) {
        advance(777);
        look(before);
        double energy = himc_membrane_energy(head), largest = peak(before, 8);
        says(change[i]);
        look(after);
        for (int k = 0; k < 8; k++)
            TEST_ASSERT_DOUBLE_WITHIN(0.02 * largest, before[k], after[k]);
        TEST_ASSERT_TRUE(himc_membrane_energy(head) <= energy * (1 + 1e-12));
        TEST_ASSERT_TRUE(himc_membrane_energy(head) >= energy * (1 - 1e-3));
    }
}

static void test_upright_amplitudes_are_those_of_the_x_axis(void)
{
    double q[500], w[8], own, v;
    says("modes 61"); // whole pairs
    says("uniformity 0.4 3");
    says("strike -0.17 0.08 6");
    advance(2400);
    himc_membrane *head = himc_drum_membrane(drum);
    himc_shape circle = {.kind = &himc_kind_round};
    himc_modes *even = himc_modes_new(&circle, 61, &error);
    himc_membrane_upright(head, 61, NULL, q);
    double modal[61], same[61];
    char text[20];
    for (int i = 0; i < 61; i++)
        himc_membrane_state(head, i, &modal[i], &v);
    himc_membrane_upright(head, 61, modal, same);
    TEST_ASSERT_EQUAL_MEMORY(q, same, sizeof same);
    look(w);
    for (int i = 0; i < 8; i++) {
        double sum = 0;
        for (int k = 0; k < 61; k++)
            sum +=
                q[k] * exact_shape(even, himc_membrane_head(head), k, 0.2 * cos(i), 0.2 * sin(i));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * peak(w, 8), w[i], sum);
    }
    himc_modes_free(even);
    int count = 100; // the last pair has no sine, and mixes with no other order
    for (himc_mode last = {.sine = true}; last.sine || last.m < HIMC_UNEVEN_ORDERS;) {
        TEST_ASSERT_TRUE(++count < 500);
        snprintf(text, sizeof text, "modes %d", count);
        says(text);
        last = himc_membrane_mode(head, count - 1);
    }
    says("strike -0.17 0.08 6");
    advance(2400);
    himc_mode last = himc_membrane_mode(head, count - 1);
    himc_membrane_upright(head, count, NULL, q);
    himc_membrane_state(head, count - 1, &own, &v);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, own * cos(last.m * last.axis), q[count - 1]);
    TEST_ASSERT_TRUE(fabs(own) > 1e-9);
}

static void test_a_head_that_is_not_round_refuses_uneven_lugs(void)
{
    says("uniformity 0.5 3");
    says("shape rectangle 0.6 0.4");
    TEST_ASSERT_FALSE(say("uniformity 0.5"));
    TEST_ASSERT_EQUAL_STRING("uniformity: 0.5, expected 1 on a head that is not round", error.text);
    says("uniformity 1");
    himc_head head = *himc_membrane_head(himc_drum_membrane(drum));
    head.uniformity = -0.1;
    TEST_ASSERT_FALSE(himc_head_check(&head, &error));
    TEST_ASSERT_EQUAL_STRING("uniformity: -0.1, expected 0 .. 1", error.text);
}

static void test_drums_of_other_names_have_other_lugs(void)
{
    himc_drum *other = himc_drum_new("low", 23, RATE, &error),
              *same = himc_drum_new("kettle", 29, RATE, &error);
    const himc_head *first = himc_membrane_head(himc_drum_membrane(drum));
    TEST_ASSERT_TRUE(first->uniformity < 1);
    TEST_ASSERT_TRUE(first->uniformity_seed !=
                     himc_membrane_head(himc_drum_membrane(other))->uniformity_seed);
    TEST_ASSERT_EQUAL_INT(first->uniformity_seed,
                          himc_membrane_head(himc_drum_membrane(same))->uniformity_seed);
    himc_drum_release(other);
    himc_drum_release(same);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_closed_form_of_the_split_is_that_of_a_film_in_balance);
    RUN_TEST(test_lugs_2_percent_off_split_as_their_harmonics_say);
    RUN_TEST(test_an_even_head_is_the_same_for_every_seed_to_the_bit);
    RUN_TEST(test_both_members_keep_the_mean_frequency_mass_and_air);
    RUN_TEST(test_a_rendered_stroke_beats_at_the_computed_split);
    RUN_TEST(test_strokes_at_other_angles_excite_other_mixtures);
    RUN_TEST(test_turned_axes_keep_the_shape_and_never_add_energy);
    RUN_TEST(test_upright_amplitudes_are_those_of_the_x_axis);
    RUN_TEST(test_a_head_that_is_not_round_refuses_uneven_lugs);
    RUN_TEST(test_drums_of_other_names_have_other_lugs);
    return UNITY_END();
}
