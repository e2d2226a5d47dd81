/// test_loudness.c: how loud instruments are beside each other, and the bars of one: the loudest
/// 0.4 s (ITU-R BS.1770) at 1 m, on four sides, against the table of docs/model.md.
#define _DEFAULT_SOURCE
#include "made_drum.h"
#include "himc/loader.h"
#include "say_drum.h"

#define FORTE 4.3      // (m/s) of a stroke f
#define MEZZOFORTE 2.9 // (m/s)
#define WINDOW 19200   // samples of 0.4 s
#define WITHIN 4.0     // (dB)
#define SAMPLES (RATE / 2)

static void make(const char *words)
{
    himc_drum_release(drum);
    drum = made_drum(words, RATE);
}

// in place, by the standard's two filters at 48 kHz
static void weigh(double *x, int n)
{
    static const double filter[2][5] = {{1.53512485958697, -2.69169618940638, 1.19839281085285,
                                         -1.69065929318241, 0.73248077421585},
                                        {1, -2, 1, -1.99004745483398, 0.99007225036621}};
    for (int k = 0; k < 2; k++) {
        const double *f = filter[k];
        double past[2] = {0};
        for (int i = 0; i < n; i++) {
            double y = f[0] * x[i] + past[0];
            past[0] = f[1] * x[i] - f[3] * y + past[1];
            past[1] = f[2] * x[i] - f[4] * y;
            x[i] = y;
        }
    }
}

// mean power of the loudest window of a blow, weighed
static double power_at(double azimuth, double elevation, double x, double speed)
{
    static double sound[SAMPLES];
    double sum = 0, most = 0;
    char text[80];
    snprintf(text, sizeof text, "pickup air %g %g 1", azimuth, elevation);
    done(text);
    himc_drum_rest(drum);
    advance(0.1);
    sound_of(x * himc_drum_head_frame(drum)->radius, 0, speed, sound, SAMPLES);
    weigh(sound, SAMPLES);
    for (int i = 0; i < SAMPLES; i++) {
        sum += sound[i] * sound[i] - (i < WINDOW ? 0 : sound[i - WINDOW] * sound[i - WINDOW]);
        most = fmax(most, sum);
    }
    return most / WINDOW;
}

// LUFS, momentary
static double loudness(double x, double speed)
{
    static const double azimuth[] = {0, 1.1, 2.3, 3.5};
    double power = 0;
    for (int i = 0; i < 4; i++)
        power += power_at(azimuth[i], 0.3, x, speed) / 4;
    return -0.691 + 10 * log10(power);
}

static void test_instruments_at_f_are_as_loud_as_the_table_says(void)
{
    static const struct {
        const char *words, *command;
        double x, lufs; // struck there, per radius
    } of[] = {
        {"timpano 26", "tune D3", -0.75, -33},
        {"bass-drum", "damp 0", -0.3, -32},
        {"snare", "wires 250", -0.3, -36},
        {"tom 10", "damp 0", -0.3, -39},
        {"tom 12", "damp 0", -0.3, -38},
        {"tom 16", "damp 0", -0.3, -38},
        {"concert-tom", "damp 0", -0.3, -37},
        {"timbale", "damp 0", -0.3, -36},
        {"kick", "damp 0", 0, -40},
        {"conga", "damp 0", -0.75, -41},
        {"bongo", "damp 0", -0.75, -44},
        {"hi-hat", "pedal 1", -0.6, -43},
        {"hi-hat", "pedal 0", -0.6, -38},
        {"crash", "damp 0", -0.93, -36},
        {"china", "damp 0", -0.93, -37},
        {"splash", "damp 0", -0.93, -40},
        {"ride", "damp 0", -0.6, -39},
        {"tam-tam", "damp 0", -0.93, -33},
        {"marimba C4", "damp 0", -0.05, -42},
        {"xylophone C5", "damp 0", -0.05, -40},
        {"vibraphone C4", "damp 0", -0.05, -42},
        {"glockenspiel C6", "damp 0", -0.05, -38},
        {"triangle", "damp 0", -0.05, -49},
        {"cowbell", "damp 0", -0.05, -44},
        {"tambourine", "damp 0", -0.3, -44},
    };
    char text[120];
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        make(of[i].words);
        done(of[i].command);
        double lufs = loudness(of[i].x, FORTE);
        snprintf(text, sizeof text, "%s, %s: %.1f LUFS, table %g", of[i].words, of[i].command, lufs,
                 of[i].lufs);
        puts(text);
        TEST_ASSERT_TRUE_MESSAGE(fabs(lufs - of[i].lufs) < WITHIN, text);
    }
}

// from where an audience is, and from above
static void test_neighbouring_bars_are_equally_loud(void)
{
    static const struct {
        const char *kind;
        int low, high; // MIDI keys
    } of[] = {{"marimba", 45, 84},
              {"vibraphone", 53, 89},
              {"xylophone", 65, 96},
              {"glockenspiel", 79, 96}};
    char text[120];
    int step = getenv("HIMC_LONG") ? 1 : 3;
    for (int i = 0; i < 4; i++)
        for (int key = of[i].low; key < of[i].high; key += step) {
            double db[2];
            for (int k = 0; k < 2; k++) {
                snprintf(text, sizeof text, "%s %.3f", of[i].kind,
                         440 * pow(2, (key + k - 69) / 12.0));
                make(text);
                db[k] = 10 * log10(power_at(0, 0.5, -0.05, MEZZOFORTE) +
                                   power_at(0.8, 1.2, -0.05, MEZZOFORTE));
            }
            snprintf(text, sizeof text, "%s, key %d: %.1f dB, next %.1f", of[i].kind, key, db[0],
                     db[1]);
            TEST_ASSERT_TRUE_MESSAGE(fabs(db[1] - db[0]) < WITHIN, text);
        }
}

// so all of them can be heard in one phrase
static void test_a_marimba_is_as_loud_high_as_low(void)
{
    double least = INFINITY, most = -INFINITY;
    char text[60];
    for (int key = 45; key <= 81; key += 4) {
        snprintf(text, sizeof text, "marimba %.3f", 440 * pow(2, (key - 69) / 12.0));
        make(text);
        double lufs = loudness(-0.05, MEZZOFORTE);
        least = fmin(least, lufs);
        most = fmax(most, lufs);
    }
    printf("marimba, A2 to A5: %.1f to %.1f LUFS\n", least, most);
    TEST_ASSERT_TRUE(most - least < 2 * WITHIN);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_instruments_at_f_are_as_loud_as_the_table_says);
    RUN_TEST(test_neighbouring_bars_are_equally_loud);
    RUN_TEST(test_a_marimba_is_as_loud_high_as_low);
    return UNITY_END();
}
