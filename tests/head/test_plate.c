/// test_plate.c: cymbals and gongs: their energy, how they bloom, what stops them.
#define _DEFAULT_SOURCE // strsep
#include "say_drum.h"

#include "bank/bank.h"

#define WINDOW 2048 // samples of a spectrum: 43 ms
#define BANK_MODES 1000

static double sound[3 * RATE];

// power spectrum of 43 ms from a time on (s), by a plain transform
static void spectrum(double time, double power[WINDOW])
{
    const int n = WINDOW;
    const double *x = sound + (int)(time * RATE);
    for (int k = 1; k < n / 2; k++) {
        double even = 0, odd = 0, c = 1, s = 0;
        double dc = cos(2 * HIMC_PI * k / n), ds = sin(2 * HIMC_PI * k / n);
        for (int i = 0; i < n; i++) {
            double w = x[i] * (1 - cos(2 * HIMC_PI * i / n)), next = c * dc - s * ds;
            even += w * c;
            odd += w * s;
            s = s * dc + c * ds;
            c = next;
        }
        power[k] = even * even + odd * odd;
    }
}

// from 40 Hz to 14 kHz, of 43 ms
static double centroid(double time)
{
    enum { N = WINDOW };
    static double power[N];
    double sum = 0, all = 0;
    spectrum(time, power);
    for (int k = 2; k < 14000 * N / RATE; k++) {
        sum += power[k] * k * RATE / N;
        all += power[k];
    }
    return sum / all;
}

static const char *const plates[] = {"crash", "ride", "china", "splash", "hi-hat", "tam-tam"};

static void plate(const char *words)
{
    char text[60];
    snprintf(text, sizeof text, "shape plate %s", words);
    done(text);
}

// so many seconds after a blow, heard from one of six sides
static void blow(double speed, int side, double seconds)
{
    char text[80];
    snprintf(text, sizeof text, "pickup air %g 0.3 1", side - 2.5);
    done(text);
    himc_drum_rest(drum);
    advance(0.1);
    strike(-0.93 * himc_drum_head_frame(drum)->radius, 0, speed);
    for (int at = 0; at < seconds * RATE; at += 4800) {
        himc_drum_advance(drum, 4800, NULL, NULL, NULL);
        himc_drum_read(drum, himc_drum_time(drum) - 4800, 4800, sound + at, NULL);
    }
}

// a bank without losses, whose low modes move
static himc_bank *lossless(const himc_cascade *cascade)
{
    static himc_oscillator o[BANK_MODES];
    himc_bank *bank = himc_bank_new(BANK_MODES, &error);
    for (int i = 0; i < BANK_MODES; i++)
        o[i] = (himc_oscillator){2 * HIMC_PI * (60 + 15.0 * i + 7 * (i % 5)), 0, 1.5};
    himc_bank_set(bank, o, BANK_MODES, RATE);
    himc_bank_set_pass(bank, 32);
    if (cascade)
        himc_bank_set_cascade(bank, cascade);
    for (int i = 0; i < BANK_MODES; i++)
        himc_bank_excite(bank, i, 0, i < 200 ? 0.1 * cos(i) : 1e-5);
    return bank;
}

static void test_without_losses_the_energy_is_constant_whatever_the_rate(void)
{
    static const double rates[] = {0, 8, 600, 1e5};
    for (int k = 0; k < 4; k++) {
        himc_bank *bank = lossless(&(himc_cascade){rates[k], 240, 0.01});
        double before = himc_bank_energy(bank), q, v, high = 0;
        for (int t = 0; t < 3 * RATE; t += 96) {
            himc_bank_run(bank, 96, NULL, 0, NULL);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * before, before, himc_bank_energy(bank));
        }
        for (int i = 500; i < BANK_MODES; i++) {
            double omega = 2 * HIMC_PI * (60 + 15.0 * i + 7 * (i % 5));
            himc_bank_state(bank, i, &q, &v);
            high += 0.75 * (v * v + omega * omega * q * q);
        }
        TEST_ASSERT_TRUE(rates[k] > 0 ? high > 0.02 * before : high < 1e-6 * before);
        himc_bank_free(bank);
    }
}

static void test_rate_0_changes_no_bit(void)
{
    himc_bank *bank[] = {lossless(NULL), lossless(&(himc_cascade){0, 240, 0.01})};
    double q[2], v[2];
    for (int k = 0; k < 2; k++)
        himc_bank_run(bank[k], RATE, NULL, 0, NULL);
    for (int i = 0; i < BANK_MODES; i++) {
        for (int k = 0; k < 2; k++)
            himc_bank_state(bank[k], i, &q[k], &v[k]);
        TEST_ASSERT_EQUAL_MEMORY(&q[0], &q[1], sizeof *q);
        TEST_ASSERT_EQUAL_MEMORY(&v[0], &v[1], sizeof *v);
    }
    himc_bank_free(bank[0]);
    himc_bank_free(bank[1]);
}

static void test_after_blows_at_random_the_energy_never_grows(void)
{
    srand(7);
    for (int k = 0; k < 6; k++) {
        plate(plates[k]);
        double mass = himc_drum_mallet(drum, HIMC_LEFT)->mass;
        for (int i = 0; i < 8; i++) {
            double speed = 0.3 + 8.0 * rand() / RAND_MAX, before = energy(), last;
            double r = himc_drum_head_frame(drum)->radius * 0.95 * rand() / RAND_MAX;
            double turn = 2 * HIMC_PI * rand() / RAND_MAX;
            strike(r * cos(turn), r * sin(turn), speed);
            advance(0.05);
            last = energy();
            TEST_ASSERT_TRUE_MESSAGE(last <= before + 0.5 * mass * speed * speed, plates[k]);
            for (int n = 0; n < 30; n++, last = energy()) {
                advance(0.01);
                TEST_ASSERT_TRUE_MESSAGE(energy() <= last, plates[k]);
            }
        }
    }
}

static void test_any_blocks_give_the_same_bits(void)
{
    enum { LENGTH = RATE };
    static const int blocks[] = {1, 64, 777};
    static double expected[LENGTH];
    plate("crash");
    for (int k = 0; k < 3; k++) {
        himc_drum_rest(drum);
        advance(0.1);
        strike(-0.2, 0, 4);
        for (int at = 0, n; at < LENGTH; at += n) {
            n = blocks[k] < LENGTH - at ? blocks[k] : LENGTH - at;
            himc_drum_advance(drum, n, NULL, NULL, NULL);
            himc_drum_read(drum, himc_drum_time(drum) - (uint64_t)n, n, sound + at, NULL);
        }
        if (k == 0)
            memcpy(expected, sound, sizeof expected);
        TEST_ASSERT_EQUAL_MEMORY(expected, sound, sizeof expected);
    }
}

// geometric means over six sides, 20 and 400 ms after a blow
static void centroids(double speed, double out[2])
{
    out[0] = out[1] = 1;
    for (int side = 0; side < 6; side++) {
        blow(speed, side, 0.5);
        out[0] *= pow(centroid(0.02), 1.0 / 6);
        out[1] *= pow(centroid(0.4), 1.0 / 6);
    }
}

static void test_a_loud_crash_brightens_a_soft_one_does_not(void)
{
    double soft[2], medium[2], loud[2];
    plate("crash");
    centroids(0.5, soft);
    centroids(4.5, medium);
    centroids(8, loud);
    printf("crash at 20 and 400 ms: %.0f %.0f, %.0f %.0f, %.0f %.0f Hz\n", soft[0], soft[1],
           medium[0], medium[1], loud[0], loud[1]);
    TEST_ASSERT_TRUE(soft[1] < soft[0] && medium[1] > medium[0] && loud[1] > loud[0]);
    TEST_ASSERT_TRUE(loud[1] / soft[1] > 4 && loud[1] / soft[1] < 8);
    TEST_ASSERT_TRUE(loud[0] / soft[0] < 1.5);
    TEST_ASSERT_DOUBLE_WITHIN(log(1.4), log(3643), log(medium[1])); // as recorded
}

static void test_a_tam_tam_blooms(void)
{
    enum { TIMES = 40 };
    static const int low[] = {100, 4000}, high[] = {250, 8000};
    double band[2][TIMES] = {{0}}, power[WINDOW];
    int most[2] = {0};
    plate("tam-tam");
    for (int side = 0; side < 6; side++) {
        blow(4, side, 1);
        for (int i = 0; i < TIMES; i++) {
            spectrum(0.02 * i, power);
            for (int b = 0; b < 2; b++)
                for (int k = low[b] * WINDOW / RATE + 1; k <= high[b] * WINDOW / RATE; k++)
                    band[b][i] += power[k];
        }
    }
    for (int b = 0; b < 2; b++)
        for (int i = 0; i < TIMES; i++)
            most[b] = band[b][i] > band[b][most[b]] ? i : most[b];
    double middle = 0.5 * WINDOW / RATE, at[] = {0.02 * most[0] + middle, 0.02 * most[1] + middle};
    printf("tam-tam: 100 Hz .. at %.2f s, 4 kHz .. at %.2f s\n", at[0], at[1]);
    TEST_ASSERT_TRUE(at[0] < 0.15);
    TEST_ASSERT_TRUE(at[1] > 0.25 && at[1] < 0.6);
    TEST_ASSERT_TRUE(band[1][most[1]] > 10 * band[1][0]);
}

static void test_a_hand_chokes_and_a_pedal_closes(void)
{
    plate("crash");
    TEST_ASSERT_FALSE(say("pedal 1"));
    TEST_ASSERT_EQUAL_STRING("pedal: expected a hi-hat or a vibraphone", error.text);
    blow(4, 0, 0.1);
    double before = energy();
    done("damp 1");
    advance(0.1);
    TEST_ASSERT_TRUE(energy() < 2e-6 * before);
    plate("hi-hat");
    double closed = mode(40).decay;
    done("pedal 0");
    double open = mode(40).decay;
    TEST_ASSERT_DOUBLE_WITHIN(1, log(1000) / 0.42, closed - open); // T60 as recorded
    done("pedal 0.5");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * (closed - open), mode(40).decay - open);
    check_dump("hi-hat", 40);
    done("shape circle");
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_membrane_head(himc_drum_membrane(drum))->dampers);
}

// modes per Hz times 18 kHz, and the mass of bronze of that size
static void test_a_plate_has_the_modes_of_its_size_and_mass(void)
{
    plate("crash 18 1.2");
    TEST_ASSERT_INT_WITHIN(60, 1092, himc_membrane_audible(himc_drum_membrane(drum)));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 8700 * 1.2e-3 * HIMC_PI * 0.2286 * 0.2286, mode(0).mass);
    plate("crash 18 2.4");
    TEST_ASSERT_INT_WITHIN(40, 546, himc_membrane_audible(himc_drum_membrane(drum)));
    check_dump("crash", 100);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.2286, himc_drum_head_frame(drum)->radius);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2.4e-3, himc_drum_head_frame(drum)->width); // drawn as a disc
    plate("hi-hat");
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_drum_head_frame(drum)->length);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.03, himc_drum_head_frame(drum)->width); // as two
    TEST_ASSERT_FALSE(say("shape plate crash 4000"));
    TEST_ASSERT_NULL(strchr(error.text, '\n'));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "4000, expected"), error.text);
    TEST_ASSERT_FALSE(say("shape plate gong"));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(error.text, "gong, expected crash ride"), error.text);
    TEST_ASSERT_NULL(strchr(error.text, '\n'));
}

static void test_info_tells_size_and_parts(void)
{
    char lines[4000] = "";
    plate("splash 10 0.8");
    himc_drum_describe(drum, HIMC_DESCRIBE_INFO, keep_line, lines);
    TEST_ASSERT_EQUAL_STRING("thing: splash, 10 inches, 0.8 mm, parts bell .. edge, 521 modes (521 "
                             "audible), mallet usual, at 0.7 0 0.85 m\n",
                             lines);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_losses_the_energy_is_constant_whatever_the_rate);
    RUN_TEST(test_rate_0_changes_no_bit);
    RUN_TEST(test_after_blows_at_random_the_energy_never_grows);
    RUN_TEST(test_any_blocks_give_the_same_bits);
    RUN_TEST(test_a_loud_crash_brightens_a_soft_one_does_not);
    RUN_TEST(test_a_tam_tam_blooms);
    RUN_TEST(test_a_hand_chokes_and_a_pedal_closes);
    RUN_TEST(test_a_plate_has_the_modes_of_its_size_and_mass);
    RUN_TEST(test_info_tells_size_and_parts);
    return UNITY_END();
}
