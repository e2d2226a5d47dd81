/// test_bank.c: the exact step of oscillators, readouts, responses, and equal bits in any blocks.
#include "bank/bank.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RATE 48000.0
#define COUNT 7

static himc_bank *bank;
static himc_oscillator o[COUNT];
static _Alignas(64) double memory[6][8];
static double velocities[4096], displacements[4096];
static himc_readout velocity = {.p = memory[0], .s = memory[1]};
static himc_readout displacement = {.p = memory[2], .s = memory[3]};
static double *shape = memory[4], *zeros = memory[5];

static void set_readouts(void)
{
    for (int i = 0; i < COUNT; i++)
        shape[i] = 0.3 + 0.1 * i;
    himc_bank_readout(bank, zeros, shape, NULL, &velocity);
    himc_bank_readout(bank, shape, NULL, NULL, &displacement);
}

void setUp(void)
{
    for (int i = 0; i < COUNT; i++)
        o[i] = (himc_oscillator){2 * HIMC_PI * (100 + 310 * i), 3 + i, 0.01 / (1 + i)};
    bank = himc_bank_new(COUNT, NULL);
    himc_bank_set(bank, o, COUNT, RATE);
    set_readouts();
}

void tearDown(void)
{
    himc_bank_free(bank);
}

static void run(int n, int at)
{
    himc_readout *const readouts[] = {&velocity, &displacement};
    double *const out[] = {velocities + at, displacements + at};
    himc_bank_run(bank, n, readouts, 2, out);
}

// q and v of an oscillator that starts at (q0, v0) under the constant force f, by the textbook
static void textbook(const himc_oscillator *p, double f, double t, double *q, double *v)
{
    double w = sqrt(p->omega * p->omega - p->decay * p->decay),
           rest = f / (p->mass * p->omega * p->omega);
    double a = *q - rest, b = (*v + p->decay * a) / w, e = exp(-p->decay * t);
    *q = rest + e * (a * cos(w * t) + b * sin(w * t));
    *v = e * ((b * w - p->decay * a) * cos(w * t) - (a * w + p->decay * b) * sin(w * t));
}

static void test_bank_step_is_the_exact_solution_free_and_forced(void)
{
    for (int k = 0; k < 2; k++) {
        double force = k * 5.0, q[COUNT], v[COUNT];
        for (int i = 0; i < COUNT; i++) {
            himc_bank_excite(bank, i, 1e-3 * (i + 1), 0.2 * i - 0.5);
            himc_bank_state(bank, i, &q[i], &v[i]);
            textbook(&o[i], force * shape[i], 1 / RATE, &q[i], &v[i]);
        }
        run(1, 0);
        himc_bank_push(bank, shape, force);
        for (int i = 0; i < COUNT; i++) {
            double got_q, got_v;
            himc_bank_state(bank, i, &got_q, &got_v);
            TEST_ASSERT_DOUBLE_WITHIN(1e-15, q[i], got_q);
            TEST_ASSERT_DOUBLE_WITHIN(1e-13, v[i], got_v);
        }
    }
}

static void test_bank_readouts_are_the_weighted_states(void)
{
    double expected_v = 0, expected_q = 0;
    for (int i = 0; i < COUNT; i++) {
        himc_bank_excite(bank, i, 1e-3 * i, 1.0 - i);
        expected_q += shape[i] * 1e-3 * i;
        expected_v += shape[i] * (1.0 - i);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, expected_q, himc_bank_read(bank, &displacement));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, expected_q, himc_bank_read(bank, &displacement));
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, expected_v, himc_bank_read(bank, &velocity));
    double next = himc_bank_peek(bank, &velocity);
    run(1, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-13, next, velocities[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, himc_bank_read(bank, &displacement), displacements[0]);
}

static void test_bank_response_is_the_change_by_one_newton(void)
{
    himc_bank_push(bank, shape, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-18, himc_bank_read(bank, &displacement),
                              himc_bank_response(bank, shape, &displacement));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, himc_bank_read(bank, &velocity),
                              himc_bank_response(bank, shape, &velocity));
}

static void test_bank_work_of_a_force_is_the_energy_gained(void)
{
    for (int i = 0; i < COUNT; i++)
        o[i].decay = 0;
    himc_bank_set(bank, o, COUNT, RATE);
    set_readouts();
    double work = 0, before = 0;
    for (int n = 0; n < 2000; n++) {
        double force = 10 * sin(0.01 * n);
        run(1, 0);
        himc_bank_push(bank, shape, force);
        double after = himc_bank_read(bank, &displacement);
        work += force * (after - before);
        before = after;
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * himc_bank_energy(bank), work, himc_bank_energy(bank));
}

static void test_bank_runs_give_the_same_bits_in_any_blocks(void)
{
    double *reference = malloc(sizeof velocities);
    for (int k = 0; k < 4; k++) {
        static const int sizes[] = {4096, 1, 5, 777};
        tearDown();
        setUp();
        o[6].decay = 800; // comes to rest on the way
        himc_bank_set(bank, o, COUNT, RATE);
        set_readouts();
        himc_bank_push(bank, shape, 100);
        for (int done = 0; done < 4096; done += sizes[k]) {
            int n = 4096 - done < sizes[k] ? 4096 - done : sizes[k];
            run(n, done);
        }
        if (k == 0)
            memcpy(reference, velocities, sizeof velocities);
        TEST_ASSERT_EQUAL_MEMORY(reference, velocities, sizeof velocities);
    }
    free(reference);
}

// what is more about a bank than its oscillators
enum { FILM = 1, KICKS = 2, CASCADE = 4, KINDS = 8 };

// a bank of 200 oscillators that is pushed now and then, run in blocks of these sizes in turn; with
// kicks, one is kicked every 32 samples
static void play(const himc_bank_kernel *kernel, int kind, const int *sizes, int kinds, double *out)
{
    enum { MANY = 200, LENGTH = 3000, INTERVAL = 32 };
    bool film = kind & FILM, kicks = kind & KICKS;
    static _Alignas(64) double weight[4][MANY];
    double stretch[MANY];
    himc_oscillator many[MANY];
    himc_bank *large = himc_bank_new(MANY, NULL);
    himc_readout heard = {.p = weight[0], .s = weight[1], .film = weight[3]};
    himc_readout *const readouts[] = {&heard};
    for (int i = 0; i < MANY; i++) {
        many[i] = (himc_oscillator){500.0 + 417 * i, 3 + 0.1 * i, 0.01};
        weight[2][i] = sin(1.0 + i);
        stretch[i] = 5e3;
    }
    himc_bank_use(large, kernel);
    himc_bank_set(large, many, MANY, RATE);
    himc_bank_set_film(large, film ? stretch : NULL, 0);
    himc_bank_readout(large, weight[2], weight[2], film ? weight[2] : NULL, &heard);
    if (kind & CASCADE)
        himc_bank_set_cascade(large, &(himc_cascade){50, 60, 1});
    if (kicks)
        himc_bank_set_pass(large, INTERVAL);
    for (int at = 0, n, k = 0; at < LENGTH; at += n, k++) {
        static const int pushed[] = {0, 1, 2, 66, 131, 140, 1000, LENGTH};
        int next = 0;
        while (pushed[next] < at)
            next++;
        if (pushed[next] == at)
            himc_bank_push(large, weight[2], 1.0 + at);
        next += pushed[next] == at;
        if (kicks && at % INTERVAL == 0)
            himc_bank_kick(large, 2, 100);
        n = sizes[k % kinds] < pushed[next] - at ? sizes[k % kinds] : pushed[next] - at;
        n = kicks && n > INTERVAL - at % INTERVAL ? INTERVAL - at % INTERVAL : n;
        himc_bank_run(large, n, readouts, 1, (double *[]){out + at});
    }
    out[LENGTH] = himc_bank_energy(large) + himc_bank_film(large);
    himc_bank_free(large);
}

static void test_bank_gives_the_same_bits_on_every_vector_unit_and_in_any_blocks(void)
{
    static const int long_blocks[] = {3000}, short_blocks[] = {1, 5, 4, 13, 64, 100};
    static double expected[KINDS][3001], got[3001];
    int count = 0;
    for (int kind = 0; kind < KINDS; kind++)
        play(himc_bank_kernel_version(0), kind, long_blocks, 1, expected[kind]);
    TEST_ASSERT_TRUE(expected[0][3000] > 0);
    TEST_ASSERT_TRUE(fabs(expected[FILM][2999] / expected[0][2999] - 1) > 0.01);
    TEST_ASSERT_TRUE(fabs(expected[KICKS][2999] / expected[0][2999] - 1) > 0.01);
    TEST_ASSERT_TRUE(fabs(expected[CASCADE][2999] / expected[0][2999] - 1) > 0.01);
    for (; himc_bank_kernel_version(count); count++)
        for (int kind = 0; kind < KINDS; kind++) {
            play(himc_bank_kernel_version(count), kind, short_blocks, 6, got);
            TEST_ASSERT_EQUAL_MEMORY(expected[kind], got, sizeof got);
        }
    printf("%d versions, the fastest %s\n", count, himc_bank_kernel_fastest()->name);
    TEST_ASSERT_EQUAL_PTR(himc_bank_kernel_version(count - 1), himc_bank_kernel_fastest());
}

// velocities given in an interval are those of an oscillator that starts with them
static void test_bank_kick_adds_velocity(void)
{
    himc_oscillator alone = {900, 5, 0.01};
    double q[2], v[2];
    for (int kicked = 0; kicked < 2; kicked++) {
        himc_bank *one = himc_bank_new(1, NULL);
        himc_bank_set(one, &alone, 1, RATE);
        himc_bank_set_pass(one, 32);
        himc_bank_excite(one, 0, 1e-3, kicked ? 0.2 : 0.5);
        if (kicked)
            himc_bank_kick(one, 0, 0.3);
        himc_bank_run(one, 1000, NULL, 0, NULL);
        himc_bank_state(one, 0, &q[kicked], &v[kicked]);
        himc_bank_free(one);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, q[0], q[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, v[0], v[1]);
}

static void test_bank_oscillators_set_to_rest_are_missed_by_140_dB_at_most(void)
{
    enum { MANY = 200, SECONDS = 3 };
    static _Alignas(64) double p[MANY], s[MANY], ones[MANY];
    himc_oscillator many[MANY];
    himc_bank *large = himc_bank_new(MANY, NULL);
    for (int i = 0; i < MANY; i++) {
        many[i] = (himc_oscillator){500.0 + 417 * i, 3 + 0.2 * i, 0.01};
        ones[i] = 1;
    }
    himc_bank_set(large, many, MANY, RATE);
    himc_readout heard = {.p = p, .s = s};
    himc_bank_readout(large, NULL, ones, NULL, &heard);
    for (int i = 0; i < MANY; i++)
        himc_bank_excite(large, i, 0, 1);
    for (int n = 977; n <= SECONDS * RATE; n += 977) {
        double expected = 0;
        himc_bank_run(large, 977, (himc_readout *[]){&heard}, 1, (double *[]){velocities});
        for (int i = 0; i < MANY; i++) {
            double q = 0, v = 1;
            textbook(&many[i], 0, n / RATE, &q, &v);
            expected += v;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-7 * MANY, expected, velocities[976]);
    }
    double q, v;
    himc_bank_state(large, MANY - 1, &q, &v);
    TEST_ASSERT_EQUAL_DOUBLE(0, v);
    himc_bank_free(large);
}

// three readouts of different gains that share a form, and one of the second's weights alone, by
// one version of the loops and in blocks of `size`
static void hear_alike(const himc_bank_kernel *kernel, bool film, int size, double out[4][1000])
{
    enum { MANY = 200, LENGTH = 1000, PUSHED = 125 };
    static _Alignas(64) double p[5][MANY], s[5][MANY], gain[3][MANY], more[5][MANY], weight[MANY];
    double stretch[MANY];
    himc_oscillator many[MANY];
    himc_bank *large = himc_bank_new(MANY, NULL);
    himc_readout heard[4];
    himc_alike alike = {.form = {.p = p[4], .s = s[4], .film = more[4]}};
    for (int i = 0; i < MANY; i++) {
        many[i] = (himc_oscillator){500.0 + 417 * i, 3 + 0.1 * i, 0.01};
        stretch[i] = 5e3;
        gain[0][i] = 1;
        gain[1][i] = cos(i);
        gain[2][i] = 1.0 / (i + 1);
    }
    himc_bank_use(large, kernel);
    himc_bank_set(large, many, MANY, RATE);
    himc_bank_set_film(large, film ? stretch : NULL, 0);
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < MANY; i++)
            weight[i] = sin(1.0 + i) * gain[k < 3 ? k : 1][i];
        heard[k] = (himc_readout){.p = p[k], .s = s[k], .film = more[k]};
        himc_bank_readout(large, weight, weight, weight, &heard[k]);
        heard[k].alike = k < 3 ? &alike : NULL;
    }
    for (int i = 0; i < MANY; i++)
        weight[i] = sin(1.0 + i);
    himc_bank_readout(large, weight, weight, weight, &alike.form);
    for (int k = 0; k < 3; k++) {
        alike.gain[k] = gain[k];
        alike.readout[k] = &heard[k];
    }
    himc_readout *const readouts[] = {&heard[0], &heard[1], &heard[2], &heard[3]};
    for (int at = 0, n; at < LENGTH; at += n) {
        n = at < PUSHED ? 1 : size;
        if (at < PUSHED)
            himc_bank_push(large, weight, 100);
        himc_bank_run(large, n, readouts, 4,
                      (double *[]){out[0] + at, out[1] + at, out[2] + at, out[3] + at});
    }
    himc_bank_free(large);
}

static void test_bank_readouts_that_are_alike_are_as_alone_in_any_blocks_on_every_unit(void)
{
    static double expected[4][1000], got[4][1000];
    for (int film = 0; film < 2; film++) {
        double most = 0;
        hear_alike(himc_bank_kernel_version(0), film, 875, expected);
        for (int i = 0; i < 1000; i++)
            most = fmax(most, fabs(expected[3][i]));
        for (int i = 0; i < 1000; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * most, expected[3][i], expected[1][i]);
        for (int version = 0; himc_bank_kernel_version(version); version++)
            for (int size = 1; size <= 125; size *= 5) {
                hear_alike(himc_bank_kernel_version(version), film, size, got);
                TEST_ASSERT_EQUAL_MEMORY(expected, got, sizeof got);
            }
    }
}

static int passes;

static void counted_ahead(const himc_bank_waves *waves, int length, int n, double *out)
{
    passes++;
    himc_bank_kernel_fastest()->ahead(waves, length, n, out);
}

static void test_bank_computes_64_samples_at_a_time_of_what_is_read_alone(void)
{
    himc_bank_kernel counting = *himc_bank_kernel_fastest();
    himc_readout *const readouts[] = {&velocity, &displacement, &velocity};
    double *const none[] = {NULL, NULL, NULL};
    counting.ahead = counted_ahead;
    himc_bank_use(bank, &counting);
    himc_bank_push(bank, shape, 100);
    himc_bank_run(bank, 1, readouts, 3, none);
    for (int i = 0; i < 64; i += 4)
        run(4, i);
    TEST_ASSERT_EQUAL_INT(2, passes);
    himc_bank_run(bank, 640, readouts, 3, none);
    TEST_ASSERT_EQUAL_INT(2, passes);
    himc_bank_run(bank, 64, readouts, 3, (double *[]){NULL, NULL, velocities});
    TEST_ASSERT_EQUAL_INT(3, passes);
}

static void test_bank_readouts_are_equal_alone_and_together(void)
{
    static double read[5][500], alone[2][500];
    himc_readout *const readouts[] = {&displacement, &velocity, &displacement, &velocity,
                                      &velocity};
    double *const out[] = {read[0], read[1], read[2], read[3], read[4]};
    himc_bank_push(bank, shape, 100);
    himc_bank_run(bank, 500, readouts, 5, out);
    tearDown();
    setUp();
    himc_bank_push(bank, shape, 100);
    for (int i = 0; i < 500; i++) {
        double *const one[] = {&alone[0][i], &alone[1][i]};
        himc_bank_run(bank, 1, readouts, 2, one);
    }
    for (int k = 0; k < 5; k++)
        TEST_ASSERT_EQUAL_MEMORY(alone[readouts[k] == &velocity], read[k], sizeof read[k]);
}

// energy of oscillators without losses and of a film that pulls hard, over passes that forces end
static void test_bank_film_gives_and_takes_no_energy(void)
{
    static double a[COUNT];
    double film = 0, most = 0;
    for (int i = 0; i < COUNT; i++) {
        o[i].decay = 0;
        a[i] = 30 * o[i].mass * o[i].omega * o[i].omega;
    }
    himc_bank_set(bank, o, COUNT, RATE);
    himc_bank_set_film(bank, a, 0);
    set_readouts();
    for (int k = 0; k < 40; k++) {
        himc_bank_ready(bank);
        double before = himc_bank_read(bank, &displacement), force = k % 3 ? 0 : 200;
        double energy = himc_bank_energy(bank) + 0.5 * film * film, sum = 0;
        run(1, 0);
        himc_bank_push(bank, shape, force);
        sum = energy + force * (himc_bank_read(bank, &displacement) - before);
        for (int n = 0; n < 7 * k; n++) {
            run(1, 0);
            film = himc_bank_film(bank);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * sum, sum, himc_bank_energy(bank) + 0.5 * film * film);
            most = fmax(most, 0.5 * film * film / sum);
        }
        film = himc_bank_film(bank);
    }
    TEST_ASSERT_TRUE(most > 0.01);
}

// runs with a film for n samples, takes it off, once it is found anew if `found`; q and v of all
static void film_taken_off(int n, bool found, double state[COUNT][2])
{
    double a[COUNT];
    for (int i = 0; i < COUNT; i++)
        a[i] = 30 * o[i].mass * o[i].omega * o[i].omega;
    himc_bank_rest(bank);
    himc_bank_set_film(bank, a, 0);
    run(1, 0);
    himc_bank_push(bank, shape, 200);
    run(n, 0);
    if (found)
        himc_bank_find_film(bank);
    himc_bank_set_film(bank, NULL, 0);
    for (int i = 0; i < COUNT; i++)
        himc_bank_state(bank, i, &state[i][0], &state[i][1]);
}

// whatever sample of its pass it falls on
static void test_bank_keeps_what_a_film_has_pulled_until_it_is_taken_off(void)
{
    double state[COUNT][2], expected[COUNT][2];
    for (int n = 1; n < 130; n++) {
        film_taken_off(n, false, state);
        film_taken_off(n, true, expected);
        TEST_ASSERT_EQUAL_MEMORY(expected, state, sizeof state);
    }
}

static void test_bank_silences_oscillators_that_would_alias(void)
{
    o[5].omega = 2 * HIMC_PI * 0.4899 * RATE;
    o[6].omega = 2 * HIMC_PI * 0.4901 * RATE;
    himc_bank_set(bank, o, COUNT, RATE);
    TEST_ASSERT_EQUAL_INT(6, himc_bank_count(bank));
    double q, v;
    himc_bank_excite(bank, 6, 1, 1);
    himc_bank_state(bank, 6, &q, &v);
    TEST_ASSERT_EQUAL_DOUBLE(0, q);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_bank_energy(bank));
}

static void test_bank_keeps_energy_and_phase_of_each_when_retuned(void)
{
    double energy = 0;
    for (int i = 0; i < COUNT; i++)
        himc_bank_excite(bank, i, 1e-3, 0.7);
    energy = himc_bank_energy(bank);
    for (int i = 0; i < COUNT; i++)
        o[i] = (himc_oscillator){o[i].omega * 1.3, 2 * o[i].decay, o[i].mass * 0.6};
    himc_bank_set(bank, o, COUNT, 44100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12 * energy, energy, himc_bank_energy(bank));
    for (int i = 0; i < COUNT; i++) {
        double q, v;
        himc_bank_state(bank, i, &q, &v);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1e-3 / 0.7 * o[i].omega / 1.3, q / v * o[i].omega);
    }
}

static void test_bank_comes_to_exact_rest(void)
{
    himc_bank_push(bank, shape, 100);
    for (int i = 0; i < COUNT; i++)
        o[i].decay = 60;
    himc_bank_set(bank, o, COUNT, RATE);
    set_readouts();
    for (int k = 0; k < 12; k++)
        run(4096, 0);
    TEST_ASSERT_EQUAL_DOUBLE(0, velocities[4095]);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_bank_energy(bank));
    himc_bank_push(bank, shape, 1);
    run(1, 0);
    TEST_ASSERT_TRUE(velocities[0] != 0);
}

// a head at rest is run or not, as a host's blocks end
static void test_bank_moves_alike_however_long_it_was_run_at_rest(void)
{
    double after[2];
    for (int k = 0; k < 2; k++) {
        himc_bank_rest(bank);
        run(k == 0 ? 3 : 1000, 0);
        himc_bank_kick(bank, 0, 5e-9); // so little that it is set to rest some time later
        run(96, 0);
        after[k] = himc_bank_energy(bank);
    }
    TEST_ASSERT_TRUE(after[0] > 0);
    TEST_ASSERT_EQUAL_DOUBLE(after[0], after[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bank_step_is_the_exact_solution_free_and_forced);
    RUN_TEST(test_bank_readouts_are_the_weighted_states);
    RUN_TEST(test_bank_response_is_the_change_by_one_newton);
    RUN_TEST(test_bank_work_of_a_force_is_the_energy_gained);
    RUN_TEST(test_bank_runs_give_the_same_bits_in_any_blocks);
    RUN_TEST(test_bank_kick_adds_velocity);
    RUN_TEST(test_bank_gives_the_same_bits_on_every_vector_unit_and_in_any_blocks);
    RUN_TEST(test_bank_computes_64_samples_at_a_time_of_what_is_read_alone);
    RUN_TEST(test_bank_readouts_are_equal_alone_and_together);
    RUN_TEST(test_bank_readouts_that_are_alike_are_as_alone_in_any_blocks_on_every_unit);
    RUN_TEST(test_bank_film_gives_and_takes_no_energy);
    RUN_TEST(test_bank_keeps_what_a_film_has_pulled_until_it_is_taken_off);
    RUN_TEST(test_bank_silences_oscillators_that_would_alias);
    RUN_TEST(test_bank_keeps_energy_and_phase_of_each_when_retuned);
    RUN_TEST(test_bank_comes_to_exact_rest);
    RUN_TEST(test_bank_moves_alike_however_long_it_was_run_at_rest);
    RUN_TEST(test_bank_oscillators_set_to_rest_are_missed_by_140_dB_at_most);
    return UNITY_END();
}
