/// test_plate.c: cymbals and gongs: their energy, how they bloom, what they cost.
#define _DEFAULT_SOURCE
#include "say_drum.h"

#include "bank/bank.h"
#include "drum/membrane_state.h"
#include "head/idiophone.h"
#include "head/modes.h"

#include <complex.h>

#define SECOND 2048 // samples of a spectrum, a power of 2: 43 ms
#define BANK_MODES 1000

static double sound[2 * RATE];

// power spectrum of n samples from a time on (s), n a power of 2 (Cooley & Tukey 1965)
static void spectrum(double time, int n, double *power)
{
    static double complex a[8192], b[8192];
    const double *x = sound + (int)(time * RATE);
    double complex *from = a, *to = b;
    for (int i = 0; i < n; i++)
        from[i] = x[i] * (1 - cos(2 * HIMC_PI * i / n));
    for (int half = n / 2, stride = 1; half > 0; half /= 2, stride *= 2) {
        for (int k = 0; k < half; k++) {
            double complex turn = cexp(-HIMC_PI * k / half * I);
            for (int i = 0; i < stride; i++) {
                double complex even = from[i + stride * k], odd = from[i + stride * (k + half)];
                to[i + stride * 2 * k] = even + odd;
                to[i + stride * (2 * k + 1)] = (even - odd) * turn;
            }
        }
        double complex *other = from;
        from = to;
        to = other;
    }
    for (int k = 0; k < n / 2; k++)
        power[k] = creal(from[k] * conj(from[k]));
}

static double centroid(double time, int n)
{
    static double power[SECOND];
    double sum = 0, all = 0;
    spectrum(time, n, power);
    for (int k = 1; k < n / 2; k++) {
        sum += power[k] * k * RATE / n;
        all += power[k];
    }
    return sum / all;
}

// geometric over arithmetic mean of the power from 2 to 8 kHz, .17 s long (dB)
static double flatness(double time)
{
    enum { N = 8192 };
    static double power[N];
    double log_sum = 0, sum = 0;
    int count = 0;
    spectrum(time, N, power);
    for (int k = 1; k < N / 2; k++)
        if (k * (double)RATE / N > 2000 && k * (double)RATE / N < 8000) {
            log_sum += log(power[k]);
            sum += power[k];
            count++;
        }
    return 10 / log(10) * (log_sum / count - log(sum / count));
}

// so long a blow (s), heard from six sides in turns
static void blow(double where, double speed, int side, double seconds)
{
    char text[80];
    snprintf(text, sizeof text, "pickup air %g 0.3 1", side - 2.5);
    done(text);
    himc_drum_rest(drum);
    advance(0.1);
    strike(-where * himc_drum_head_frame(drum)->radius, 0, speed);
    for (int at = 0; at < seconds * RATE; at += 4800) {
        himc_drum_advance(drum, 4800, NULL, NULL, NULL);
        himc_drum_read(drum, himc_drum_time(drum) - 4800, 4800, sound + at, NULL);
    }
}

static void test_without_losses_the_energy_is_constant_whatever_the_rate(void)
{
    static himc_oscillator o[BANK_MODES];
    const double rates[] = {0, 8, 600, 1e5};
    for (int i = 0; i < BANK_MODES; i++)
        o[i] = (himc_oscillator){2 * HIMC_PI * (60 + 15.0 * i + 7 * (i % 5)), 0, 1.5};
    for (int k = 0; k < 4; k++) {
        himc_bank *bank = himc_bank_new(BANK_MODES, &error);
        himc_bank_set(bank, o, BANK_MODES, RATE);
        himc_bank_set_pass(bank, 32);
        himc_bank_set_cascade(bank, &(himc_cascade){rates[k], 240, 0.01});
        for (int i = 0; i < BANK_MODES; i++)
            himc_bank_excite(bank, i, 0, i < 200 ? 0.1 * cos(i) : 1e-5);
        double before = himc_bank_energy(bank), q, v, high = 0;
        for (int t = 0; t < 3 * RATE; t += 96) {
            himc_bank_run(bank, 96, NULL, 0, NULL);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12 * before, before, himc_bank_energy(bank));
        }
        for (int i = 500; i < BANK_MODES; i++) {
            himc_bank_state(bank, i, &q, &v);
            high += 0.75 * (v * v + o[i].omega * o[i].omega * q * q);
        }
        TEST_ASSERT_TRUE(rates[k] > 0 ? high > 0.02 * before : high < 1e-6 * before);
        himc_bank_free(bank);
    }
}

static void test_at_rate_0_no_bit_is_another(void)
{
    double q[2], v[2];
    himc_oscillator o[9];
    himc_bank *bank[2];
    for (int i = 0; i < 9; i++)
        o[i] = (himc_oscillator){1000 + 800.0 * i, 3, 1.5};
    for (int k = 0; k < 2; k++) {
        bank[k] = himc_bank_new(9, &error);
        himc_bank_set(bank[k], o, 9, RATE);
        himc_bank_set_cascade(bank[k], k ? &(himc_cascade){0, 6, 0.01} : NULL);
        for (int i = 0; i < 9; i++)
            himc_bank_excite(bank[k], i, 0, 1 + i);
        himc_bank_run(bank[k], 5000, NULL, 0, NULL);
    }
    for (int i = 0; i < 9; i++) {
        for (int k = 0; k < 2; k++)
            himc_bank_state(bank[k], i, &q[k], &v[k]);
        TEST_ASSERT_TRUE(q[0] == q[1] && v[0] == v[1]);
    }
    himc_bank_free(bank[0]);
    himc_bank_free(bank[1]);
}

static void test_with_losses_the_energy_never_grows(void)
{
    static const char *const names[] = {"crash", "china", "hi-hat", "tam-tam"};
    for (int k = 0; k < 4; k++) {
        char text[40];
        snprintf(text, sizeof text, "shape plate %s", names[k]);
        done(text);
        double most = 0.5 * himc_drum_mallet(drum, HIMC_LEFT)->mass * 36, last;
        strike(-0.9 * himc_drum_head_frame(drum)->radius, 0.01, 6);
        advance(0.03);
        last = energy();
        TEST_ASSERT_TRUE_MESSAGE(last > 0.05 * most && last <= most, names[k]);
        for (int i = 0; i < 100; i++, last = energy()) {
            advance(0.01);
            TEST_ASSERT_TRUE_MESSAGE(energy() <= last, names[k]);
        }
    }
}

static void test_glide_0_is_linear_and_block_size_makes_no_difference(void)
{
    static double other[RATE];
    done("shape plate crash");
    for (int nonlinear = 0; nonlinear < 2; nonlinear++) {
        const int n = RATE / 2;
        himc_drum_rest(drum);
        done(nonlinear ? "glide 1" : "glide 0");
        advance(0.1);
        strike(-0.2, 0, 4);
        for (int at = 0; at < n; at += 480) {
            himc_drum_advance(drum, 480, NULL, NULL, NULL);
            himc_drum_read(drum, himc_drum_time(drum) - 480, 480, sound + at, NULL);
        }
        himc_drum_rest(drum);
        advance(0.1);
        strike(-0.2, 0, nonlinear ? 4 : 2);
        for (int at = 0, run; at < n; at += run) {
            run = at % 7 + 1 < n - at ? at % 7 + 1 : n - at;
            himc_drum_advance(drum, run, NULL, NULL, NULL);
            himc_drum_read(drum, himc_drum_time(drum) - (uint64_t)run, run, other + at, NULL);
        }
        if (nonlinear) {
            TEST_ASSERT_EQUAL_DOUBLE_ARRAY(sound, other, n);
            continue;
        }
        // once the sticks have left, but for the contact, which is not linear
        double ratio = centroid(0.2, SECOND);
        memcpy(sound, other, sizeof *other * (size_t)n);
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * ratio, ratio, centroid(0.2, SECOND));
    }
}

static void test_a_loud_crash_brightens_as_recorded_and_its_lines_stand_out(void)
{
    const double speed[] = {0.5, 1.3, 4.5, 8};
    double at_0[4] = {0}, at_20[4] = {0}, at_400[4] = {0}, flat[4] = {0};
    done("shape plate crash");
    for (int side = 0; side < 6; side++)
        for (int k = 0; k < 4; k++) {
            blow(0.93, speed[k], side, 0.5);
            at_0[k] += log(centroid(0, SECOND / 2)) / 6;
            at_20[k] += log(centroid(0.02, SECOND / 2)) / 6;
            at_400[k] += log(centroid(0.4, SECOND)) / 6;
            flat[k] += flatness(0.2) / 6;
        }
    double ratio = exp(at_400[3] - at_400[0]);
    TEST_ASSERT_TRUE(ratio > 4 && ratio < 8);
    TEST_ASSERT_TRUE(exp(at_20[3] - at_20[0]) < 1.5);
    TEST_ASSERT_TRUE(exp(at_0[0]) < 1800); // recorded 940 Hz; wood that does not dent: 2700
    TEST_ASSERT_DOUBLE_WITHIN(3, -14, flat[1]);
    TEST_ASSERT_DOUBLE_WITHIN(3, -10, flat[2]);
}

// at 0, .1, .4, .8 s, of a loud and a soft recorded stroke on another crash
static void test_a_crash_is_as_bright_as_a_recorded_one(void)
{
    static const double at[] = {0, 0.1, 0.4, 0.8}, speed[] = {4.5, 1.3},
                        recorded[2][4] = {{845, 3189, 3643, 2698}, {940, 1198, 1112, 1007}};
    done("shape plate crash");
    for (int k = 0; k < 2; k++) {
        double bright[4] = {0};
        for (int side = 0; side < 6; side++) {
            blow(0.93, speed[k], side, 1);
            for (int i = 0; i < 4; i++)
                bright[i] += log(centroid(at[i], i < 2 ? SECOND / 2 : SECOND)) / 6;
        }
        for (int i = 0; i < 4; i++)
            TEST_ASSERT_DOUBLE_WITHIN(log(1.5), log(recorded[k][i]), bright[i]);
    }
}

static double loudest(const char *mallet)
{
    double most = 0;
    done(mallet);
    blow(0.93, 1, 0, 0.3);
    for (int i = 0; i < RATE / 4; i++)
        most = fmax(most, fabs(sound[i]));
    return most;
}

// the noise of a timpano's shell and stand is no cymbal's
static void test_felt_makes_a_crash_softer_and_darker_than_wood(void)
{
    double power[2], bright[2];
    done("shape plate crash");
    for (int k = 0; k < 2; k++) {
        power[k] = loudest(k ? "mallet soft" : "mallet wood");
        bright[k] = centroid(0, SECOND / 2);
    }
    TEST_ASSERT_TRUE(power[1] < power[0] && power[1] > 0.05 * power[0]);
    TEST_ASSERT_TRUE(bright[1] < 0.5 * bright[0]);
    double usual = loudest("mallet usual"), own = loudest("mallet 8e5 1 0.016");
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * usual, usual, own);
}

// when the power from `low` to `high` (Hz) is largest (s)
static double peak_time(double low, double high)
{
    static double power[SECOND];
    double most = 0, at = 0;
    for (double t = 0; t < 1.5; t += 0.02) {
        double sum = 0;
        spectrum(t, SECOND, power);
        for (int k = (int)(low * SECOND / RATE) + 1; k < high * SECOND / RATE; k++)
            sum += power[k];
        at = sum > most ? t : at;
        most = fmax(sum, most);
    }
    return at + 0.5 * SECOND / RATE;
}

static void test_a_tam_tam_blooms_soft_or_loud(void)
{
    done("shape plate tam-tam");
    for (double speed = 1.5; speed < 5; speed += 2.5) {
        double low = 0, high = 0;
        for (int side = 0; side < 4; side++) {
            blow(0.93, speed, side, 1.6);
            low += peak_time(100, 250) / 4;
            high += peak_time(4000, 8000) / 4;
        }
        TEST_ASSERT_TRUE(low < 0.15);
        TEST_ASSERT_TRUE(high > 0.25 && high < 0.6);
    }
}

static void test_a_hand_chokes_a_cymbal_and_a_pedal_closes_a_hi_hat(void)
{
    done("shape plate crash");
    TEST_ASSERT_FALSE(say("pedal 1"));
    blow(0.93, 4, 0, 0.1);
    double before = energy();
    done("damp 1");
    advance(0.1);
    TEST_ASSERT_TRUE(energy() < 2e-6 * before);
    done("shape plate hi-hat");
    double closed = mode(40).decay;
    done("pedal 0");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 16.4, closed - mode(40).decay);
    done("pedal 0.5");
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.5 * 16.4, closed - mode(40).decay);
    check_dump("hi-hat", 40);
}

static void test_a_plate_has_the_modes_of_its_size_and_mass(void)
{
    done("shape plate crash 18 1.2");
    TEST_ASSERT_INT_WITHIN(60, 1092, himc_membrane_audible(himc_drum_membrane(drum)));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 8700 * 1.2e-3 * HIMC_PI * 0.2286 * 0.2286, mode(0).mass);
    done("shape plate crash 18 2.4");
    TEST_ASSERT_INT_WITHIN(40, 546, himc_membrane_audible(himc_drum_membrane(drum)));
    check_dump("crash", 100);
    TEST_ASSERT_FALSE(say("shape plate crash 3"));
    TEST_ASSERT_FALSE(say("shape plate gong"));
}

static double mean_square(const himc_modes *modes, double radius, double x)
{
    static double shape[HIMC_MODES_MAX];
    double sum = 0;
    himc_modes_shapes(modes, radius, x, 0, shape);
    for (int i = 0; i < modes->count; i++)
        sum += shape[i] * shape[i] / modes->count;
    return sum;
}

static void test_the_free_edge_moves_more_than_the_bow(void)
{
    done("shape plate crash");
    const himc_shape *shape = &himc_membrane_config_of(himc_drum_membrane(drum))->shape;
    double radius = himc_drum_head_frame(drum)->radius;
    himc_modes *modes = himc_modes_new(shape, shape->body->modes, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(modes, error.text);
    double bow = mean_square(modes, radius, 0.6 * radius);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 1, bow);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 3, mean_square(modes, radius, 0.95 * radius) / bow);
    himc_modes_free(modes);
}

// drawn as a disc or as two; nothing stays of a pedal
static void test_a_plate_tells_its_depth_and_size(void)
{
    char lines[4000] = "";
    done("shape plate hi-hat");
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_drum_head_frame(drum)->length);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.03, himc_drum_head_frame(drum)->width);
    done("shape circle");
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_membrane_head(himc_drum_membrane(drum))->dampers);
    done("shape plate splash 10 0.8");
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.8e-3, himc_drum_head_frame(drum)->width);
    himc_drum_describe(drum, HIMC_DESCRIBE_INFO, keep_line, lines);
    TEST_ASSERT_EQUAL_STRING("thing: splash, 10 inches, 0.8 mm, parts bell .. edge, 521 modes (521 "
                             "audible), mallet usual, at 0.7 0 0.85 m\n",
                             lines);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_without_losses_the_energy_is_constant_whatever_the_rate);
    RUN_TEST(test_at_rate_0_no_bit_is_another);
    RUN_TEST(test_with_losses_the_energy_never_grows);
    RUN_TEST(test_glide_0_is_linear_and_block_size_makes_no_difference);
    RUN_TEST(test_a_loud_crash_brightens_as_recorded_and_its_lines_stand_out);
    RUN_TEST(test_a_crash_is_as_bright_as_a_recorded_one);
    RUN_TEST(test_felt_makes_a_crash_softer_and_darker_than_wood);
    RUN_TEST(test_a_tam_tam_blooms_soft_or_loud);
    RUN_TEST(test_a_hand_chokes_a_cymbal_and_a_pedal_closes_a_hi_hat);
    RUN_TEST(test_a_plate_has_the_modes_of_its_size_and_mass);
    RUN_TEST(test_a_plate_tells_its_depth_and_size);
    RUN_TEST(test_the_free_edge_moves_more_than_the_bow);
    return UNITY_END();
}
