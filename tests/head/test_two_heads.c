/// test_two_heads.c: drums with a shell, and the wires of a snare.
#include "made_drum.h"
#include "unity.h"

#include "drum/contact.h"
#include "drum/drum_state.h"
#include "head/two_heads.h"
#include "himc/loader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define RATE 44100.0
#define LONG 88200 // samples

static himc_drum *drum;
static double sound[LONG];

void setUp(void)
{
    drum = NULL;
}

void tearDown(void)
{
    himc_drum_release(drum);
}

static himc_drum *make(const char *words)
{
    himc_drum_release(drum);
    drum = made_drum(words, RATE);
    return drum;
}

static const char *say(const char *words)
{
    static himc_error error;
    himc_command command;
    error.text[0] = '\0';
    bool good = himc_command_parse_text(&command, HIMC_DRUM, words, &error) &&
                himc_drum_command(drum, &command, &error);
    return good ? "" : error.text;
}

// strikes at `place` (per radius) and hears `seconds`; returns the report
static himc_contact_report strike(double place, double speed, double seconds)
{
    himc_contact_report report = {0};
    int n = (int)(seconds * RATE);
    himc_drum_strike_at(drum, 0, -place * himc_drum_head_frame(drum)->radius, 0, speed, NULL);
    for (int i = 0; i < n; i += 100) {
        uint64_t at = himc_drum_time(drum);
        himc_drum_advance(drum, 100, NULL, NULL, NULL);
        himc_drum_read(drum, at, 100, sound + i, NULL);
        himc_drum_strike_next(drum, &report);
    }
    return report;
}

// (dB) of a band in the first 100 ms, per all from 20 Hz to 12 kHz
static double band(double low, double high)
{
    double part = 0, all = 0;
    for (int k = 2; k < 1200; k++) {
        double even = 0, odd = 0;
        for (int i = 0; i < 4410; i++) {
            double a = 2 * HIMC_PI * (k * i % 4410) / 4410;
            even += sound[i] * cos(a);
            odd += sound[i] * sin(a);
        }
        double power = even * even + odd * odd;
        all += power;
        part += 10 * k >= low && 10 * k < high ? power : 0;
    }
    return 10 * log10(part / all);
}

// time (s) after the loudest 5 ms from which all are 20 dB softer
static double faded(double seconds)
{
    enum { WINDOW = 220 };
    double most = 0, power[LONG / WINDOW];
    int count = (int)(seconds * RATE) / WINDOW, from = 0, last = 0;
    for (int k = 0; k < count; k++) {
        power[k] = 0;
        for (int i = 0; i < WINDOW; i++)
            power[k] += sound[k * WINDOW + i] * sound[k * WINDOW + i];
        if (power[k] > most) {
            most = power[k];
            from = k;
        }
    }
    for (int k = from; k < count; k++)
        last = power[k] > 0.01 * most ? k : last;
    return (last - from) * WINDOW / RATE;
}

// frequency of mode (0, 1) number k of a drum that is so deep (m); 0: as usual
static double lowest(const himc_shell *shell, double depth, int k)
{
    himc_shell own = *shell;
    own.depth = depth > 0 ? depth : own.depth;
    himc_shape shape = {.kind = &himc_kind_two_heads, .shell = &own};
    himc_head head = himc_head_default();
    shape.kind->fit(&shape, &head);
    himc_modes *modes = himc_modes_new(&shape, HIMC_MODES_AUTO, NULL);
    himc_oscillator *o = malloc(sizeof *o * (size_t)modes->count);
    shape.kind->sounds(modes, &head, o);
    double hz = o[modes->block[0].index[k]].omega / (2 * HIMC_PI);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, o[modes->block[0].index[0]].omega / (2 * HIMC_PI),
                              himc_head_principal(&head, &shape));
    free(o);
    himc_modes_free(modes);
    return hz;
}

static const himc_shell *row(const char *name)
{
    const himc_shell *r = himc_shell_rows;
    while (strcmp(r->name, name) != 0)
        r++;
    return r;
}

static void test_the_air_between_parts_the_lowest_modes_of_a_bass_drum(void)
{
    const himc_shell *bass = row("bass-drum");
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 50, lowest(bass, 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1.08, 108, lowest(bass, 0, 1));
    TEST_ASSERT_DOUBLE_WITHIN(0.48, 48.1, lowest(bass, 1e9, 0));
    TEST_ASSERT_DOUBLE_WITHIN(0.52, 52.2, lowest(bass, 1e9, 1));
    TEST_ASSERT_DOUBLE_WITHIN(2, 192, lowest(row("snare"), 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(4, 376, lowest(row("snare"), 0, 1));
}

static void test_blows_last_as_long_as_on_such_drums(void)
{
    static const struct {
        const char *words;
        double low, high;
    } of[] = {{"snare", 3.5, 6.3},   {"tom 12", 6, 10.8}, {"tom 16", 7.5, 14.5},
              {"bass-drum", 20, 29}, {"kick", 20, 41},    {"conga", 4.5, 6.5}};
    for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
        make(of[i].words);
        double ms = 1e3 * strike(0.3, 4, 0.1).duration;
        TEST_ASSERT_TRUE_MESSAGE(ms > of[i].low && ms < of[i].high, of[i].words);
    }
}

// energy of the head and of two sticks (J)
static double total(const himc_stick *sticks)
{
    return himc_membrane_energy(himc_drum_membrane(drum)) + himc_contact_energy(&sticks[0]) +
           himc_contact_energy(&sticks[1]);
}

static void never_gains(const char *words)
{
    himc_membrane *head = himc_drum_membrane(make("snare"));
    double blow = 1;
    TEST_ASSERT_EQUAL_STRING("", say(words));
    srand(3);
    for (int k = 0; k < 5; k++) {
        himc_stick two[2] = {{.head = *himc_drum_mallet(drum, HIMC_LEFT), .mass = 0.008}};
        two[0].velocity = -0.3 - 8.0 * rand() / RAND_MAX;
        two[0].height = 0.001;
        two[0].x = 0.2 * rand() / RAND_MAX - 0.1;
        two[0].y = 0.2 * rand() / RAND_MAX - 0.1;
        two[1] = two[0];
        two[1].x += 0.05;
        two[1].height = 0.003;
        himc_stick *sticks[2] = {&two[0], &two[1]};
        blow = himc_contact_energy(&two[0]);
        double last = total(two);
        for (int i = 0; i < (k < 4 ? 4000 : LONG); i++) {
            himc_contact_step(head, sticks, 2);
            double now = total(two);
            TEST_ASSERT_TRUE_MESSAGE(now - last <= 1e-14 * blow, words);
            last = now;
        }
    }
    TEST_ASSERT_TRUE(himc_membrane_energy(head) < 1e-4 * blow);
    TEST_ASSERT_FALSE(himc_membrane_energy(head) < 0);
}

static void test_sticks_head_and_wires_never_gain_energy(void)
{
    never_gains("wires 250");
    never_gains("wires 20");
    never_gains("wires 2000");
}

// points alone, thrown off a head that does not move
static void test_wires_on_a_rigid_head_lose_energy_at_each_landing(void)
{
    const double rigid[HIMC_WIRES] = {0}, pull = 250, h = 1.0 / RATE;
    himc_wires_matrix none = {{0}};
    himc_wires w;
    double b[HIMC_WIRES];
    himc_wires_rest(&w, rigid);
    for (int i = 0; i < HIMC_WIRES; i++)
        w.velocity[i] = -0.1 * (i + 1);
    double first = himc_wires_energy(&w, pull), last = first;
    for (int i = 0; i < RATE / 5 && w.awake; i++) {
        himc_wires_begin(&w, rigid, pull, h, b);
        himc_wires_solve(&w, pull, h, none, b);
        himc_wires_end(&w, pull, h, none, b);
        double now = himc_wires_energy(&w, pull);
        TEST_ASSERT_TRUE(now <= last + 1e-14 * first);
        last = now;
    }
    TEST_ASSERT_TRUE(last >= 0 && last < 1e-2 * first);
}

static void test_wires_fade_sooner_the_tighter_they_are(void)
{
    double loose, usual, off;
    make("snare");
    strike(0.3, 2.5, 0.5);
    usual = faded(0.5);
    make("snare");
    TEST_ASSERT_EQUAL_STRING("", say("wires 50"));
    strike(0.3, 2.5, 0.5);
    loose = faded(0.5);
    TEST_ASSERT_TRUE(usual > 0.04 && usual < 0.06);
    TEST_ASSERT_TRUE(loose > 1.5 * usual);
    make("snare");
    strike(0.3, 3, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(4, -22, band(20, 125));
    TEST_ASSERT_DOUBLE_WITHIN(4, -1, band(125, 500));
    TEST_ASSERT_DOUBLE_WITHIN(4, -9, band(500, 2000));
    TEST_ASSERT_DOUBLE_WITHIN(4, -21, band(2000, 5000));
    TEST_ASSERT_DOUBLE_WITHIN(4, -26, band(5000, 12000));
    usual = band(5000, 12000);
    make("snare");
    TEST_ASSERT_EQUAL_STRING("", say("wires 0"));
    strike(0.3, 3, 0.5);
    off = band(5000, 12000);
    TEST_ASSERT_TRUE(usual > off + 6);
}

// (dB) of a snare's sound, wires at 250
static double bright(double speed)
{
    make("snare");
    strike(0.3, speed, 0.5);
    return band(2000, 12000);
}

static void test_a_louder_snare_is_brighter_and_no_longer(void)
{
    double soft = bright(0.6), pianissimo = bright(0.9);
    for (int v = 2; v <= 4; v++) {
        TEST_ASSERT_TRUE(bright(v) > pianissimo + 1 && bright(v) > soft + 6);
        double seconds = faded(0.5);
        TEST_ASSERT_TRUE(seconds > 0.035 && seconds < 0.065);
    }
    // each at least as bright as those before it, mp to fff
    const double speed[] = {1.31, 1.95, 2.9, 4.3, 5.98};
    double last = -INFINITY;
    for (int i = 0; i < 5; i++) {
        double now = bright(speed[i]);
        TEST_ASSERT_TRUE(now > last - 1 && (i > 2 || now > last));
        last = fmax(last, now);
    }
}

// without them it is a tom
static void test_wires_are_most_of_what_a_snare_has_above_2_khz(void)
{
    for (int v = 2; v <= 8; v *= 2) {
        double with = bright(v);
        make("snare");
        TEST_ASSERT_EQUAL_STRING("", say("wires 0"));
        strike(0.3, v, 0.5);
        TEST_ASSERT_TRUE(with > band(2000, 12000) + 6);
    }
}

// the click of a beater, and a tom's attack, per all (recorded -21 and -13)
static void test_kicks_and_toms_have_an_attack(void)
{
    make("kick");
    strike(0, 4, 0.2);
    TEST_ASSERT_TRUE(band(2000, 12000) > -30);
    make("tom 12");
    strike(0.3, 4, 0.2);
    TEST_ASSERT_TRUE(band(2000, 12000) > -24);
}

// bit for bit, as long as none are on
static void test_wires_that_are_off_are_none(void)
{
    static double without[22000];
    make("snare");
    say("wires 0");
    strike(0.3, 4, 0.49);
    memcpy(without, sound, sizeof without);
    make("snare");
    say("wires 1");
    say("wires 0");
    strike(0.3, 4, 0.49);
    TEST_ASSERT_EQUAL_MEMORY(without, sound, sizeof(double) * 21000);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_wires_energy(&drum->membrane->wires, 0));
    make("timpano");
    TEST_ASSERT_EQUAL_STRING("wires: expected a drum with two heads", say("wires 1"));
    make("conga");
    TEST_ASSERT_EQUAL_STRING("wires: expected a drum with two heads", say("wires 1"));
}

static void test_wires_may_change_while_they_rattle(void)
{
    make("snare");
    strike(0.3, 4, 0.02);
    double before = himc_membrane_energy(himc_drum_membrane(drum));
    say("wires 60");
    TEST_ASSERT_TRUE(himc_membrane_energy(himc_drum_membrane(drum)) <= before);
    say("tune 220");
    TEST_ASSERT_TRUE(himc_membrane_energy(himc_drum_membrane(drum)) <= before);
    say("shape circle");
    TEST_ASSERT_FALSE(drum->membrane->wires.awake);
    strike(0.3, 4, 0.02);
    TEST_ASSERT_EQUAL_STRING("", say("shape shell snare"));
    strike(0.3, 4, 1);
    TEST_ASSERT_TRUE(fabs(sound[40000]) < 1);
}

static void test_rest_is_rest(void)
{
    make("snare");
    strike(0.3, 4, 1.9);
    TEST_ASSERT_FALSE(drum->membrane->wires.awake);
    himc_drum_rest(drum);
    TEST_ASSERT_EQUAL_DOUBLE(0, himc_membrane_energy(himc_drum_membrane(drum)));
}

// power of what was heard
static double loudness(void)
{
    double sum = 0;
    for (int i = 0; i < 8000; i++)
        sum += sound[i] * sound[i];
    return sum;
}

// (dB), without wires, or with them, whose own rattle is louder, too
static void test_a_louder_stroke_is_brighter_and_the_rim_thinner(void)
{
    double bright[2], loud[2], edge[2], rattle[2];
    for (int k = 0; k < 2; k++) {
        make("snare");
        say("wires 0");
        strike(0.3, k ? 5 : 1, 0.2);
        bright[k] = band(1500, 12000);
        loud[k] = loudness();
        make("snare");
        say("wires 0");
        strike(k ? 0.8 : 0, 3, 0.2);
        edge[k] = band(500, 12000);
        make("snare");
        strike(0.3, k ? 5 : 1, 0.2);
        rattle[k] = band(2000, 12000) + 10 * log10(loudness());
    }
    TEST_ASSERT_TRUE(bright[1] > bright[0] + 0.3);
    TEST_ASSERT_TRUE(loud[1] > 16 * loud[0]);
    TEST_ASSERT_TRUE(edge[1] > edge[0] + 6);
    TEST_ASSERT_TRUE(rattle[1] > rattle[0] + 6);
}

static void test_a_kick_is_short_and_a_large_tom_low(void)
{
    make("kick");
    strike(0.3, 4, 1);
    TEST_ASSERT_TRUE(faded(1) < 0.13);
    double high = himc_drum_pitch(make("tom 12")), low = himc_drum_pitch(make("tom 16"));
    TEST_ASSERT_DOUBLE_WITHIN(4, 127, high);
    TEST_ASSERT_DOUBLE_WITHIN(4, 76, low);
    TEST_ASSERT_EQUAL_STRING("", say("tune 90"));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 90, himc_drum_pitch(drum));
    make("tom C3");
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 130.81, himc_drum_pitch(drum));
    TEST_ASSERT_NOT_NULL(strstr(say("skin calf"), "without a shell"));
}

// two seconds at once, with the same bits as sample by sample by the narrowest vectors
static void test_a_head_without_sticks_runs_with_its_wires(void)
{
    static double once[LONG], single[LONG];
    for (int k = 0; k < 2; k++) {
        himc_membrane *head = himc_drum_membrane(make("snare"));
        double *row = k ? single : once;
        if (k == 1)
            himc_bank_use(head->model->bank, himc_bank_kernel_version(0));
        himc_membrane_push(head, 0.03, 0.02, 50);
        for (int i = 0, step = k ? 1 : LONG; i < LONG; i += step, row += step)
            himc_membrane_run(head, step, &row, NULL);
        TEST_ASSERT_FALSE(head->wires.awake);
    }
    TEST_ASSERT_EQUAL_MEMORY(once, single, sizeof once);
    TEST_ASSERT_TRUE(fabs(once[300]) > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_air_between_parts_the_lowest_modes_of_a_bass_drum);
    RUN_TEST(test_blows_last_as_long_as_on_such_drums);
    RUN_TEST(test_sticks_head_and_wires_never_gain_energy);
    RUN_TEST(test_wires_on_a_rigid_head_lose_energy_at_each_landing);
    RUN_TEST(test_wires_fade_sooner_the_tighter_they_are);
    RUN_TEST(test_a_louder_snare_is_brighter_and_no_longer);
    RUN_TEST(test_wires_are_most_of_what_a_snare_has_above_2_khz);
    RUN_TEST(test_kicks_and_toms_have_an_attack);
    RUN_TEST(test_wires_that_are_off_are_none);
    RUN_TEST(test_wires_may_change_while_they_rattle);
    RUN_TEST(test_rest_is_rest);
    RUN_TEST(test_a_head_without_sticks_runs_with_its_wires);
    RUN_TEST(test_a_louder_stroke_is_brighter_and_the_rim_thinner);
    RUN_TEST(test_a_kick_is_short_and_a_large_tom_low);
    return UNITY_END();
}
