/// test_membrane.c: pitch, decay, energy and pickups of a bare head, and changes while it sounds.
#include "drum/membrane_state.h"
#include "head/air.h"
#include "head/bessel.h"
#include "head/pickup.h"

#include "unity.h"
#include "inner_state.h"
#include "exact_shape.h"
#include "heads.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RATE 48000.0
#define LONG 96000

static himc_membrane *membrane;
static himc_head head;
static himc_error error;
static double sound[LONG], displacement[LONG];

static void remake(double rate)
{
    himc_membrane_free(membrane);
    membrane = himc_membrane_new(&head, rate, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(membrane, error.text);
    himc_membrane_watch(membrane, -0.1, 0.07);
}

void setUp(void)
{
    head = dry_head();
    head.air = false; // a bare head is known in closed form
    head.uniformity = 1;
    head.glide = 0;
    membrane = NULL;
    remake(RATE);
}

void tearDown(void)
{
    himc_membrane_free(membrane);
    membrane = NULL;
}

// n samples into sound[at ..] and displacement[at ..]
static void run_to(int at, int n)
{
    himc_membrane_run(membrane, n, &(double *const){sound + at}, displacement + at);
}

static void run(int n)
{
    run_to(0, n);
}

// Phase (rad) and size of the component at w (rad/sample) in x, by a Hann window over n samples.
static void component(const double *x, int n, double w, double *phase, double *size)
{
    double re = 0, im = 0;
    for (int i = 0; i < n; i++) {
        double window = 1 - cos(2 * HIMC_PI * (i + 0.5) / n);
        re += window * x[i] * cos(w * i);
        im -= window * x[i] * sin(w * i);
    }
    *phase = atan2(im, re);
    *size = hypot(re, im) / n;
}

// frequency (Hz) and decay (1/s) of one mode alone, from the output
static void measure(int index, double rate, double *frequency, double *decay)
{
    himc_membrane_rest(membrane);
    himc_membrane_excite(membrane, index, 1e-3, 0);
    int n = (int)(rate / 4), gap = (int)(rate / 8);
    run(n + gap);
    double w = 2 * HIMC_PI * himc_membrane_mode(membrane, index).frequency / rate, p0, p1, s0, s1;
    component(displacement, n, w, &p0, &s0);
    component(displacement + gap, n, w, &p1, &s1);
    double angle = w * gap + remainder(p1 - p0 - w * gap, 2 * HIMC_PI);
    *frequency = angle / (2 * HIMC_PI) * rate / gap;
    *decay = log(s0 / s1) * rate / gap;
}

static void test_membrane_sounds_at_bessel_zeros_within_a_hundredth_of_a_cent_at_any_rate(void)
{
    static const double rates[] = {8000,  11025, 16000, 22050, 32000,
                                   44100, 48000, 88200, 96000, 192000};
    static const double tensions[] = {1200, 3700, 20000};
    double worst = 0;
    head.decay_constant = 1;
    head.decay_square = 1e-8;
    for (int r = 0; r < 30; r++) {
        double rate = rates[r / 3];
        head.tension = tensions[r % 3];
        remake(rate);
        int step = rate > 50000 ? 41 : 11;
        for (int i = r % 3; i < 200; i += step) {
            double frequency, decay;
            himc_mode mode = himc_membrane_mode(membrane, i);
            if (i >= himc_membrane_audible(membrane))
                break;
            double ideal =
                mode.zero / (2 * HIMC_PI * head.radius) * sqrt(head.tension / head.density);
            measure(i, rate, &frequency, &decay);
            worst = fmax(worst, fabs(1200 * log2(frequency / ideal)));
        }
    }
    printf("largest error of frequency %.2g cent\n", worst);
    TEST_ASSERT_TRUE(worst < 0.01);
}

static void test_membrane_decay_follows_the_two_parameters_within_a_thousandth(void)
{
    for (int k = 0; k < 2; k++) {
        head.decay_constant = k == 0 ? 3 : log(1000) / 1.5;
        head.decay_square = k == 0 ? 2e-7 : 0;
        himc_membrane_set_head(membrane, &head, NULL);
        double worst = 0;
        for (int i = 0; i < 200; i += 9) {
            double frequency, decay, w = 2 * HIMC_PI * himc_membrane_mode(membrane, i).frequency;
            measure(i, RATE, &frequency, &decay);
            double asked = head.decay_constant + head.decay_square * w * w;
            worst = fmax(worst, fabs(decay / asked - 1));
        }
        printf("largest error of decay %.2g\n", worst);
        TEST_ASSERT_TRUE(worst < 1e-3);
    }
}

static void test_membrane_static_displacement_under_a_force_follows_from_stiffness(void)
{
    head.decay_constant = 50;
    remake(RATE);
    himc_membrane_watch(membrane, -0.1, 0.07);
    for (int i = 0; i < LONG; i++) {
        himc_membrane_push(membrane, -0.1, 0.07, 10);
        run(1);
    }
    himc_modes *modes = himc_modes_new(&himc_membrane_config_of(membrane)->shape, head.modes, NULL);
    double sag = 0;
    for (int i = 0; i < head.modes; i++) {
        double phi = exact_shape(modes, &head, i, -0.1, 0.07);
        sag += 10 * phi * phi / himc_modes_get(modes, &head, i).stiffness;
    }
    himc_modes_free(modes);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * sag, -sag, himc_membrane_watched(membrane));
    // in equilibrium nothing radiates: the direct part of the force cancels that of the modes
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0, himc_membrane_sound(membrane, 0));
}

// the largest change of slope of the sound in [from, to)
static double roughness(int from, int to)
{
    double most = 0;
    for (int i = from + 2; i < to; i++)
        most = fmax(most, fabs(sound[i] - 2 * sound[i - 1] + sound[i - 2]));
    return most;
}

// the sound of a strike, 0.2 s old
static void ring(void)
{
    for (int i = 0; i < 300; i++) {
        himc_membrane_push(membrane, -0.2, 0, 100 * sin(HIMC_PI * i / 300));
        run(1);
    }
    run(9600);
}

static void no_click(const char *what)
{
    run(2400);
    double before = roughness(0, 2400), last = sound[2399], slope = last - sound[2398];
    TEST_ASSERT_TRUE(before > 0);
    sound[0] = last - slope;
    sound[1] = last;
    himc_membrane_set_head(membrane, &head, NULL);
    run_to(2, 2400);
    TEST_ASSERT_TRUE_MESSAGE(roughness(0, 2402) < 2 * before, what);
}

static void test_membrane_does_not_click_when_its_head_changes_while_ringing(void)
{
    ring();
    head.tension *= pow(2, 2.0 / 12);
    no_click("a tone up");
    head.radius *= 0.97;
    no_click("smaller");
    head.density *= 1.1;
    no_click("heavier");
    head.decay_constant = 5;
    no_click("drier");
    head.modes = 120;
    no_click("fewer modes");
    head.modes = 900;
    no_click("more modes");
}

static void test_membrane_does_not_click_when_pickup_or_rate_changes(void)
{
    ring();
    run(2400);
    double before = roughness(0, 2400), last = sound[2399], slope = last - sound[2398];
    himc_pickup pickup = himc_pickup_default();
    pickup.azimuth = 2;
    pickup.distance = 2;
    TEST_ASSERT_TRUE(himc_membrane_set_pickups(membrane, &pickup, 1, NULL));
    sound[0] = last - slope;
    sound[1] = last;
    run_to(2, 2400);
    TEST_ASSERT_TRUE(roughness(0, 2402) < 2 * before);
    last = sound[2401];
    TEST_ASSERT_TRUE(himc_membrane_set_rate(membrane, 44100, NULL));
    run(2);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, last, sound[0]);
    TEST_ASSERT_TRUE(sound[0] != 0);
}

static void test_membrane_keeps_its_energy_when_retuned(void)
{
    ring();
    double energy = himc_membrane_energy(membrane);
    head.tension *= 1.5;
    head.radius = 0.35;
    TEST_ASSERT_TRUE(himc_membrane_set_head(membrane, &head, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * energy, energy, himc_membrane_energy(membrane));
    head.modes = 700;
    TEST_ASSERT_TRUE(himc_membrane_set_head(membrane, &head, NULL));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * energy, energy, himc_membrane_energy(membrane));
}

static void test_membrane_with_two_thousand_modes_sounds_and_decays(void)
{
    head.modes = 2000;
    remake(RATE);
    TEST_ASSERT_EQUAL_INT(2000, himc_membrane_audible(membrane));
    ring();
    double loud = 0;
    run(LONG / 4);
    for (int i = 0; i < LONG / 4; i++) {
        TEST_ASSERT_TRUE(isfinite(sound[i]));
        loud = fmax(loud, fabs(sound[i]));
    }
    TEST_ASSERT_TRUE(loud > 0.01 && loud < 1);
}

static void test_membrane_silences_modes_above_half_the_rate(void)
{
    head.radius = 0.05;
    head.tension = 50000;
    head.modes = 400;
    head.density = 0.2;
    remake(44100);
    int audible = himc_membrane_audible(membrane);
    TEST_ASSERT_TRUE(audible > 0 && audible < 400);
    TEST_ASSERT_TRUE(himc_membrane_mode(membrane, audible - 1).frequency < 0.49 * 44100);
    TEST_ASSERT_TRUE(himc_membrane_mode(membrane, audible).frequency >= 0.49 * 44100);
}

// pressure far away by summing Rayleigh's integral over rings and sectors of the head
static double rayleigh(const himc_mode *mode, const himc_pickup *p, double *quarter)
{
    const int rings = 400, sectors = 192;
    double k = 2 * HIMC_PI * mode->frequency / 344.0, re = 0, im = 0;
    himc_modes *modes = himc_modes_new(&himc_membrane_config_of(membrane)->shape, 60, NULL);
    int index = 0;
    while (himc_modes_get(modes, &head, index).m != mode->m ||
           himc_modes_get(modes, &head, index).n != mode->n ||
           himc_modes_get(modes, &head, index).sine != mode->sine)
        index++;
    for (int i = 0; i < rings; i++) {
        for (int j = 0; j < sectors; j++) {
            double r = (i + 0.5) / rings * head.radius, th = 2 * HIMC_PI * (j + 0.5) / sectors;
            double w = exact_shape(modes, &head, index, r * cos(th), r * sin(th)) * r *
                       (head.radius / rings) * (2 * HIMC_PI / sectors);
            double nearer = r * cos(th - p->azimuth) * cos(p->elevation);
            re += w * cos(k * nearer);
            im += w * sin(k * nearer);
        }
    }
    himc_modes_free(modes);
    *quarter = 1.21 / (2 * HIMC_PI * p->distance) * im;
    return 1.21 / (2 * HIMC_PI * p->distance) * re;
}

// sound from nearer parts arrives earlier: p = re q''(t) + im (q'' a quarter of a period earlier),
// which is -w q' for q'' = -w^2 q
static void test_membrane_air_pickup_agrees_with_rayleighs_integral(void)
{
    head.decay_constant = head.decay_square = 0;
    himc_membrane_set_head(membrane, &head, NULL);
    himc_pickup pickup = {HIMC_PICKUP_AIR, 0, 0, 0.6, 0.5, 100};
    TEST_ASSERT_TRUE(himc_membrane_set_pickups(membrane, &pickup, 1, &error));
    run(480);
    for (int i = 0; i < 20; i += 1) {
        himc_mode mode = himc_membrane_mode(membrane, i);
        double w = 2 * HIMC_PI * mode.frequency, quarter,
               direct = rayleigh(&mode, &pickup, &quarter);
        himc_membrane_rest(membrane);
        run(480);
        himc_membrane_excite(membrane, i, 1e-4, 0.3);
        run(1);
        double q, v;
        himc_membrane_state(membrane, i, &q, &v);
        double unit = 0.2 / HIMC_PICKUP_PRESSURE; // of a head without air
        double expected = (direct * -w * w * q + quarter * -w * v) * unit;
        double size = hypot(direct, quarter) * w * hypot(w * 1e-4, 0.3) * unit;
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * size + 1e-12, expected, sound[0]);
    }
}

// a mode's shape along its axis, mixed by a kettle
static double along_axis(const himc_mode *mode, const himc_mixture *mix, double r)
{
    double sum = 0;
    if (mode->m > 0)
        return himc_bessel_j(mode->m, mode->zero * r);
    for (int k = 0; k < HIMC_MIXED; k++)
        sum += mix->part[mode->n - 1][k] * himc_bessel_j(0, himc_bessel_zero(0, k + 1) * r);
    return sum;
}

// Rayleigh's integral near the head, per acceleration (kg/m)
static double near_rayleigh(const himc_mode *mode, const himc_mixture *mix, double radius,
                            const himc_pickup *p)
{
    double k = 2 * HIMC_PI * mode->frequency / 344, re = 0, im = 0;
    double across = p->distance * cos(p->elevation), up = p->distance * sin(p->elevation);
    for (double r = 0.005; r < 1; r += 0.01) {
        double shape = along_axis(mode, mix, r) * r;
        for (double th = 0; th < 2 * HIMC_PI; th += HIMC_PI / 48) {
            double far = hypot(hypot(across - r * radius * cos(th), r * radius * sin(th)), up);
            re += shape * cos(mode->m * th) / far * cos(k * far);
            im += shape * cos(mode->m * th) / far * sin(k * far);
        }
    }
    return 1.21 / (2 * HIMC_PI) * radius * radius * 0.01 * (HIMC_PI / 48) * hypot(re, im);
}

// a slack 32 inch head at C2: (4, 1) is 9 dB louder at 1 m than its far field would be, and (0, 1)
// moves less air than its bare shape
static void test_membrane_sounds_at_a_metre_as_rayleighs_integral_within_a_decibel(void)
{
    himc_head slack = himc_head_default();
    slack.radius = 0.4064;
    slack.tension = 1200;
    slack.uniformity = 1;
    himc_membrane *m = himc_membrane_new(&slack, RATE, NULL);
    himc_modes *modes = himc_modes_new(&himc_membrane_config_of(m)->shape, 60, NULL);
    himc_air air = himc_air_around(&slack, himc_air_kettle(slack.radius));
    himc_mixture mix = himc_air_mixture(&air);
    himc_modes_mix_as(modes, &mix);
    for (double distance = 1; distance < 3; distance *= 2)
        for (int i = 0, seen = 0; seen < 7; i++) {
            himc_mode mode = himc_membrane_mode(m, i);
            himc_pickup p = {HIMC_PICKUP_AIR, 0, 0, 0, 0.17, distance};
            if (mode.n > (mode.m > 0 ? 1 : 2) || mode.sine)
                continue;
            pickup_weights w = himc_pickup_weights(&p, &slack, modes, i, &mode, 0);
            double omega = 2 * HIMC_PI * mode.frequency,
                   here = fmax(fabs(w.displacement) / omega, fabs(w.velocity)) / omega *
                          HIMC_PICKUP_PRESSURE,
                   exact = near_rayleigh(&mode, &mix, slack.radius, &p);
            TEST_ASSERT_DOUBLE_WITHIN(1, 0, 20 * log10(here / exact));
            seen++;
        }
    himc_modes_free(modes);
    himc_membrane_free(m);
}

// x = k R is 1e-4 and smaller there, and h_m(x) leaves all numbers at m = 60
static void test_membrane_hears_finite_sound_near_the_slackest_and_heaviest_head(void)
{
    head.tension = HIMC_TENSION_MIN;
    head.density = HIMC_DENSITY_MAX;
    head.modes = 2000;
    remake(RATE);
    himc_pickup near = himc_pickup_default();
    near.distance = HIMC_PICKUP_DISTANCE_MIN;
    TEST_ASSERT_TRUE(himc_membrane_set_pickups(membrane, &near, 1, &error));
    himc_membrane_push(membrane, 0.1, 0.05, 100);
    run(1000);
    for (int i = 0; i < 1000; i++)
        TEST_ASSERT_TRUE(fabs(sound[i]) < 1);
}

// displacement at one point after 5 ms, for an impulse at another; `lowest`: the velocity of (0,1)
// beside that of (1,1)
static double after_a_push(const himc_head *of, double pushed, double watch, double *lowest)
{
    double sound_now[240], here[240];
    himc_membrane *m = himc_membrane_new(of, RATE, NULL);
    himc_membrane_watch(m, watch, 0.01);
    himc_membrane_push(m, pushed, 0.01, 100);
    himc_membrane_run(m, 240, &(double *const){sound_now}, here);
    double q[2], v[2];
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL_INT(i, himc_membrane_mode(m, i).m);
        himc_membrane_state(m, i, &q[i], &v[i]);
    }
    *lowest = fabs(v[0] / v[1]);
    himc_membrane_free(m);
    return here[239];
}

// a kettle's shapes act in forces and displacements alike, and the lowest has a node near the place
// of strokes
static void test_membrane_over_a_kettle_answers_alike_when_push_and_point_are_exchanged(void)
{
    himc_head slack = himc_head_default();
    slack.radius = 0.4064;
    slack.tension = 1200;
    slack.glide = 0;
    double normal, middle, there = after_a_push(&slack, -0.3, 0.05, &normal),
                           back = after_a_push(&slack, 0.05, -0.3, &middle);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * fabs(there), there, back);
    TEST_ASSERT_TRUE(normal < 0.05 * middle);
}

static void test_membrane_point_pickup_beyond_a_smaller_rim_moves_to_it(void)
{
    himc_head small = dry_head();
    himc_membrane *m = himc_membrane_new(&small, 48000, NULL);
    himc_pickup at = {.kind = HIMC_PICKUP_POINT, .x = 0.16, .y = -0.12};
    int count;
    TEST_ASSERT_TRUE(himc_membrane_set_pickups(m, &at, 1, NULL));
    small.radius = 0.1;
    TEST_ASSERT_TRUE(himc_membrane_set_head(m, &small, NULL));
    const himc_pickup *now = himc_membrane_pickups(m, &count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.08, now->x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.06, now->y);
    himc_membrane_free(m);
}

static void test_membrane_point_pickup_reads_the_velocity_there(void)
{
    himc_pickup pickup = {.kind = HIMC_PICKUP_POINT, .x = 0.1, .y = 0.05};
    TEST_ASSERT_TRUE(himc_membrane_set_pickups(membrane, &pickup, 1, &error));
    run(480);
    himc_membrane_watch(membrane, 0.1, 0.05);
    himc_membrane_push(membrane, -0.2, 0.03, 20);
    run(200);
    double slope =
        (8 * (displacement[151] - displacement[149]) - (displacement[152] - displacement[148])) *
        RATE / 12;
    TEST_ASSERT_DOUBLE_WITHIN(2e-3 * fabs(slope) + 1e-5, slope, sound[150] * HIMC_PICKUP_VELOCITY);
}

static void test_membrane_refuses_bad_values_and_does_not_change(void)
{
    himc_membrane *twin = himc_membrane_new(&head, RATE, NULL);
    himc_membrane_watch(twin, -0.1, 0.07);
    himc_membrane_push(membrane, 0.1, 0, 50);
    himc_membrane_push(twin, 0.1, 0, 50);
    himc_head bad = head;
    bad.tension = INFINITY;
    TEST_ASSERT_FALSE(himc_membrane_set_head(membrane, &bad, &error));
    bad = head;
    bad.modes = 1000000;
    TEST_ASSERT_FALSE(himc_membrane_set_head(membrane, &bad, &error));
    himc_pickup too_near = himc_pickup_default();
    too_near.distance = 0;
    TEST_ASSERT_FALSE(himc_membrane_set_pickups(membrane, &too_near, 1, &error));
    TEST_ASSERT_EQUAL_STRING("pickup: DISTANCE: 0 m, expected 0.3 .. 100 m", error.text);
    TEST_ASSERT_FALSE(himc_membrane_set_rate(membrane, NAN, &error));
    run(1000);
    static double same[1000], same_displacement[1000];
    himc_membrane_run(twin, 1000, &(double *const){same}, same_displacement);
    TEST_ASSERT_EQUAL_MEMORY(same, sound, sizeof same);
    TEST_ASSERT_EQUAL_MEMORY(same_displacement, displacement, sizeof same_displacement);
    himc_membrane_free(twin);
    bad.radius = 0;
    TEST_ASSERT_NULL(himc_membrane_new(&bad, RATE, &error));
}

// the sound of a head that was struck, tuned while its pickups were muted or not, and by another
// membrane's head or not
static void sound_after_tuning(bool mute, bool exchange, double *out, int n)
{
    remake(RATE);
    himc_membrane_push(membrane, 0.1, 0.05, 20);
    run(500);
    himc_membrane_mute_pickups(membrane, mute);
    himc_head higher = head;
    higher.tension *= 1.3;
    TEST_ASSERT_TRUE(himc_membrane_set_head(membrane, &higher, &error));
    if (exchange) {
        himc_membrane *other = himc_membrane_new(&head, RATE, &error);
        membrane->model = himc_membrane_exchange(other, membrane->model);
        himc_membrane_free(membrane);
        membrane = other;
    }
    himc_membrane_mute_pickups(membrane, false);
    run(4000); // the declicks end
    himc_membrane_push(membrane, -0.1, 0.02, 10);
    run(n);
    memcpy(out, sound, sizeof *out * (size_t)n);
}

static void test_muted_pickups_come_back_for_the_modes_of_now(void)
{
    static double expected[1000], got[1000];
    for (int exchange = 0; exchange < 2; exchange++) {
        sound_after_tuning(false, exchange, expected, 1000);
        sound_after_tuning(true, exchange, got, 1000);
        TEST_ASSERT_TRUE(expected[999] != 0);
        TEST_ASSERT_EQUAL_MEMORY(expected, got, sizeof got);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_membrane_sounds_at_bessel_zeros_within_a_hundredth_of_a_cent_at_any_rate);
    RUN_TEST(test_membrane_decay_follows_the_two_parameters_within_a_thousandth);
    RUN_TEST(test_membrane_static_displacement_under_a_force_follows_from_stiffness);
    RUN_TEST(test_membrane_does_not_click_when_its_head_changes_while_ringing);
    RUN_TEST(test_membrane_does_not_click_when_pickup_or_rate_changes);
    RUN_TEST(test_membrane_keeps_its_energy_when_retuned);
    RUN_TEST(test_membrane_with_two_thousand_modes_sounds_and_decays);
    RUN_TEST(test_membrane_silences_modes_above_half_the_rate);
    RUN_TEST(test_membrane_air_pickup_agrees_with_rayleighs_integral);
    RUN_TEST(test_membrane_sounds_at_a_metre_as_rayleighs_integral_within_a_decibel);
    RUN_TEST(test_membrane_hears_finite_sound_near_the_slackest_and_heaviest_head);
    RUN_TEST(test_membrane_over_a_kettle_answers_alike_when_push_and_point_are_exchanged);
    RUN_TEST(test_membrane_point_pickup_beyond_a_smaller_rim_moves_to_it);
    RUN_TEST(test_membrane_point_pickup_reads_the_velocity_there);
    RUN_TEST(test_membrane_refuses_bad_values_and_does_not_change);
    RUN_TEST(test_muted_pickups_come_back_for_the_modes_of_now);
    return UNITY_END();
}
