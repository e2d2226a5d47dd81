/// test_air_between.c: drums hear each other: how loud, never with energy from nowhere, and not at
/// all when they are far apart.
#include "drum/air_between.h"
#include "drum/membrane_state.h"
#include "himc/himc.h"

#include "unity.h"
#include "inner_state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RATE 48000.0
#define D3 146.83

static himc_error error;
static himc_drum *drum[3];
static himc_air_between air;
static int count;

void setUp(void)
{
    memset(&air, 0, sizeof air);
    count = 0;
}

void tearDown(void)
{
    for (int i = 0; i < count; i++) {
        himc_air_between_leave(&air, drum[i]);
        himc_drum_release(drum[i]);
    }
    count = 0;
}

static void says(himc_drum *d, const char *text)
{
    himc_command c;
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&c, HIMC_DRUM, text, &error) &&
                                 himc_drum_command(d, &c, &error),
                             error.text);
}

static void add(double inches, double x, double y, double hz, const char *modes)
{
    char text[80];
    static const char *const names[] = {"first", "second", "third"};
    himc_drum *d = drum[count] = himc_drum_new(names[count], inches, RATE, &error);
    count++;
    TEST_ASSERT_NOT_NULL_MESSAGE(d, error.text);
    snprintf(text, sizeof text, "place %g %g 0.85", x, y);
    says(d, text);
    says(d, modes);
    says(d, "air 1");
    says(d, "decay 0.5 3e-7");
    says(d, "glide 0");
    says(d, "uniformity 1");
    snprintf(text, sizeof text, "tune %.9g", hz);
    says(d, text);
    himc_drum_watch(d, false);
}

static himc_membrane *head(int i)
{
    return himc_drum_membrane(drum[i]);
}

static int find(int i, int m, int n)
{
    int k = 0;
    himc_mode mode;
    do
        mode = himc_membrane_mode(head(i), k++);
    while (mode.m != m || mode.n != n);
    return k - 1;
}

static double mode_energy(int i, int index)
{
    double q, v;
    himc_mode mode = himc_membrane_mode(head(i), index);
    himc_membrane_state(head(i), index, &q, &v);
    return 0.5 * (mode.mass * v * v + mode.stiffness * q * q);
}

// advances all to sample `to`
static void run(int64_t now, int64_t to)
{
    for (int n; now < to; now += n) {
        if (himc_air_between_due(&air, now))
            himc_air_between_exchange(&air);
        n = himc_air_between_until(&air, now, (int)(to - now));
        for (int i = 0; i < count; i++)
            himc_drum_advance(drum[i], n, NULL, NULL, NULL);
    }
}

static double total(void)
{
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += himc_membrane_energy(head(i));
    return sum;
}

// Peak of a silent neighbour's (1,1) over that of a drum in unison but for `apart` (Hz), in dB,
// with these other losses of both.
static double answer(double apart, const char *decay)
{
    char tune[80];
    setUp();
    add(26, 4, 0.4, D3, "modes 30");
    add(26, 4, -0.4, 80, "modes 30");
    says(drum[0], decay);
    says(drum[1], decay);
    himc_air_between_join(&air, drum, count);
    run(0, 64);
    snprintf(tune, sizeof tune, "tune %.9g", D3 + apart);
    says(drum[1], tune); // the air notices
    int one = find(0, 1, 1);
    himc_membrane_excite(head(0), one, 0, 1);
    double start = mode_energy(0, one), most = 0;
    for (int64_t i = 64; i < 48000; i += 96) {
        run(i, i + 96);
        most = fmax(most, mode_energy(1, find(1, 1, 1)));
    }
    tearDown();
    return 10 * log10(most / start);
}

// two modes that radiate 4.4 1/s, 0.6 of it together, and lose 0.8 1/s otherwise: the kettle's part
// is 0.57, friction's 0.25
#define DRY "decay 0 0"

static void test_neighbour_in_unison_answers_at_minus_13_decibels(void)
{
    double dry = answer(0, DRY);
    TEST_ASSERT_DOUBLE_WITHIN(2, -13, dry);
    // exp(-t d1)/2 - exp(-t d2)/2 at its highest: the more the heads lose besides, the less
    double usual = answer(0, "decay 0.3 5e-8"), lossy = answer(0, "decay 2 3e-7");
    printf("neighbour %.1f, as made %.1f, lossy %.1f dB\n", dry, usual, lossy);
    TEST_ASSERT_TRUE(usual < dry + 0.5 && lossy < usual - 2);
}

static void test_neighbour_out_of_tune_answers_less(void)
{
    TEST_ASSERT_DOUBLE_WITHIN(2, -14, answer(1, DRY));
    TEST_ASSERT_DOUBLE_WITHIN(2, -18.5, answer(5, DRY));
    TEST_ASSERT_DOUBLE_WITHIN(2, -28, answer(20, DRY));
}

static void test_energy_of_drums_that_hear_each_other_never_rises(void)
{
    unsigned seed = 1;
    add(32, 0.251, 0.843, 73.4, "modes 60");
    add(29, 0.832, 0.287, 110, "modes 60");
    add(26, 0.763, -0.439, D3, "modes 60");
    for (int i = 0; i < count; i++)
        says(drum[i], "decay 0 0"); // the air alone takes energy
    himc_air_between_join(&air, drum, count);
    TEST_ASSERT_EQUAL_INT(3, air.count);
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 60; k++) {
            double v[2];
            for (int j = 0; j < 2; j++) {
                seed = seed * 1664525u + 1013904223u;
                v[j] = (seed >> 8) / 16777216.0 - 0.5;
            }
            himc_membrane_excite(head(i), k, v[0] * 1e-3, v[1]);
        }
    double before = total(), first = before;
    for (int64_t i = 0; i < 9600; i++) {
        if (i == 4000)
            says(drum[1], "tune 120");
        run(i, i + 1);
        double now = total();
        TEST_ASSERT_TRUE_MESSAGE(i == 4000 || now <= before * (1 + 1e-13), "energy has risen");
        before = now;
    }
    TEST_ASSERT_TRUE(before < 0.5 * first);
}

// the exchange takes from a mode what the mode has not lost itself
static void test_a_mode_decays_as_without_neighbours_if_none_is_in_tune(void)
{
    static const int modes[][2] = {{0, 1}, {1, 1}, {2, 1}};
    for (int k = 0; k < 3; k++) {
        setUp();
        add(26, 4, 0.9, D3, "modes 30");
        add(23, 4, -0.9, 233, "modes 30");
        himc_air_between_join(&air, drum, count);
        says(drum[1], "air 0"); // it is there, and hears nothing
        int i = find(0, modes[k][0], modes[k][1]);
        himc_mode mode = himc_membrane_mode(head(0), i);
        himc_membrane_excite(head(0), i, 0, 1);
        run(0, 1600);
        double start = mode_energy(0, i);
        int64_t later = 1600 + (int64_t)(8 * RATE / mode.decay) / 32 * 32;
        run(1600, later);
        double decay = 0.5 * log(start / mode_energy(0, i)) * RATE / (double)(later - 1600);
        char text[80];
        snprintf(text, sizeof text, "(%d,%d): %g 1/s", modes[k][0], modes[k][1], decay);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.01 * mode.decay, mode.decay, decay, text);
        tearDown();
    }
}

// Alone, each mode loses what its sound takes wherever its drum stands; together, what a gives to b
// is what b gives to a.
static void test_exchange_is_mutual_and_takes_the_modes_own_losses(void)
{
    double mass[2 * HIMC_SHARED];
    int n = 0;
    add(32, 0.7, 0.9, 73.4, "modes 30");
    add(26, 0.3, -0.8, 116.5, "modes 30");
    himc_air_between_join(&air, drum, count);
    double t = himc_membrane_interval(RATE) / RATE;
    for (int i = 0; i < count; i++) {
        const himc_shared_mode *mode = head(i)->model->shared;
        int shared = head(i)->model->shared_count;
        TEST_ASSERT_EQUAL_INT(5, shared); // (0,1), and both of (1,1) and of (2,1)
        for (int k = 0; k < shared; k++, n++) {
            TEST_ASSERT_EQUAL_INT(1, himc_membrane_mode(head(i), mode[k].index).n);
            double lost = 2 * t * mode[k].decay; // by the trapezoidal rule:
            mass[n] = mode[k].mass;
            TEST_ASSERT_DOUBLE_WITHIN(0.02 * lost, -lost / (1 + lost / 2), air.change[n][n]);
        }
    }
    TEST_ASSERT_TRUE(n >= 8 && mass[0] > 1.2 * mass[n - 1]);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, air.change[i][j] * mass[i],
                                      air.change[j][i] * mass[j]);
}

// in a performance

static void tell(himc_performance *p, const char *text)
{
    himc_command c;
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) &&
                                 himc_performance_command(p, &c, 0, &error),
                             error.text);
}

#define HEARD 24000

// half a second of a performance on the drums, of which the first is struck, in blocks: its sound,
// and the largest energy of the last
static double play(int block, double *sound)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    double most = 0;
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_TRUE_MESSAGE(himc_performance_add_drum(p, drum[i], &error), error.text);
    tell(p, "hit right accent f normal first");
    for (int done = 0, n; done < HEARD; done += n) {
        n = HEARD - done < block ? HEARD - done : block;
        himc_performance_process(p, n, NULL);
        himc_drum_read(drum[0], (uint64_t)done, n, sound + done, NULL);
        most = fmax(most, himc_membrane_energy(head(count - 1)));
    }
    himc_performance_free(p);
    return most;
}

static double loudest(const double *sound)
{
    double most = 0;
    for (int i = 0; i < HEARD; i++)
        most = fmax(most, fabs(sound[i]));
    return most;
}

// a pair of drums, the second so far to the right
static double pair(double y, int block, double *sound, const char *second)
{
    tearDown();
    setUp();
    add(26, 0.7, 0.1, D3, "modes 60");
    if (second)
        add(26, 0.7, y, D3, second);
    return play(block, sound);
}

static void test_a_struck_drum_moves_its_neighbour_in_blocks_of_any_size(void)
{
    static double sound[HEARD], again[HEARD];
    static const int blocks[] = {1, 7, 500};
    double energy = pair(-0.7, 64, sound, "modes 60");
    TEST_ASSERT_TRUE(loudest(sound) > 0.01);
    TEST_ASSERT_TRUE(energy > 0);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.3 * energy, energy, pair(-0.7, blocks[i], again, "modes 60"));
        TEST_ASSERT_EQUAL_MEMORY(sound, again, sizeof sound);
    }
}

static void test_drums_far_apart_or_without_air_sound_as_if_alone(void)
{
    static double alone[HEARD], sound[HEARD];
    pair(0, 64, alone, NULL);
    TEST_ASSERT_TRUE(loudest(alone) > 0.01);
    TEST_ASSERT_EQUAL_DOUBLE(0, pair(-1.95, 64, sound, "modes 60"));
    TEST_ASSERT_EQUAL_MEMORY(alone, sound, sizeof sound);
    tearDown();
    setUp();
    add(26, 0.7, 0.1, D3, "modes 60");
    add(26, 0.7, -0.7, D3, "modes 60");
    says(drum[1], "air 0");
    TEST_ASSERT_EQUAL_DOUBLE(0, play(64, sound));
    TEST_ASSERT_EQUAL_MEMORY(alone, sound, sizeof sound);
}

static void test_a_drum_given_back_is_alone(void)
{
    static double sound[HEARD];
    pair(-0.7, 64, sound, "modes 60");
    TEST_ASSERT_EQUAL_INT(0, head(0)->model->shared_count);
}

// from a timpanist's hour: a score made the head of a drum apart, and put it in alone
static void test_a_drum_that_the_score_tunes_hears_its_neighbour(void)
{
    static const char *const lines[] = {"", "harp tune D3;", "harp decay 0.5 3e-7;"};
    for (int i = 0; i < 3; i++) {
        himc_command c;
        FILE *file = fopen("build/hears.txt", "w");
        TEST_ASSERT_TRUE(file && fprintf(file,
                                         "drum oboe 26;\ndrum harp 26;\n%s\n"
                                         "stroke 1 left legato f oboe;\n",
                                         lines[i]) > 0);
        fclose(file);
        himc_performance_config config = himc_performance_default();
        himc_performance *p = himc_performance_new(&config, &error);
        TEST_ASSERT_NOT_NULL(p);
        himc_performance_make_drums(p, true);
        TEST_ASSERT_TRUE_MESSAGE(
            himc_command_parse_text(&c, HIMC_PERFORMER, "score build/hears.txt", &error) &&
                himc_performance_command(p, &c, 0, &error),
            error.text);
        himc_performance_process(p, 480, NULL);
        himc_membrane *second = himc_drum_membrane(himc_performance_drum(p, 1));
        TEST_ASSERT_TRUE(second->model->shared_count > 0);
        himc_performance_free(p);
    }
    remove("build/hears.txt");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_neighbour_in_unison_answers_at_minus_13_decibels);
    RUN_TEST(test_neighbour_out_of_tune_answers_less);
    RUN_TEST(test_energy_of_drums_that_hear_each_other_never_rises);
    RUN_TEST(test_a_mode_decays_as_without_neighbours_if_none_is_in_tune);
    RUN_TEST(test_exchange_is_mutual_and_takes_the_modes_own_losses);
    RUN_TEST(test_a_struck_drum_moves_its_neighbour_in_blocks_of_any_size);
    RUN_TEST(test_drums_far_apart_or_without_air_sound_as_if_alone);
    RUN_TEST(test_a_drum_given_back_is_alone);
    RUN_TEST(test_a_drum_that_the_score_tunes_hears_its_neighbour);
    return UNITY_END();
}
