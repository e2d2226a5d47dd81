/// test_levels.c: how loud the four timpani are: the strongest strokes stay below full scale, the
/// softest above -60 dB of it, with one gain for all drums and no limiter.
///
/// Everyday at the loudest and the softest place of each drum, with HIMC_LONG at all places.
#include "session.h"

static const struct timpano {
    const char *inches, *note;
} timpano[] = {{"32", "D2"}, {"29", "A2"}, {"26", "D3"}, {"23", "F3"}};

#define TIMPANI (int)(sizeof timpano / sizeof timpano[0])
#define FULL_SCALE 1.0
#define SOFTEST 0.001 // -60 dB

// shares of the radius; the blow at the loudest one excites all modes of low frequency
#define LOUDEST_PLACE 0.3
#define SOFTEST_PLACE 0.92
static const double places[] = {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.75, 0.85, 0.92};
#define PLACES (int)(sizeof places / sizeof places[0])

/// The largest sample while a timpano plays `strokes` equal strokes of both hands in turn, after a
/// command to the performer.
static double peak_of(const struct timpano *t, const char *how, double place, int strokes,
                      double interval, const char *before)
{
    double peak = 0, sound[480], x = -place * atof(t->inches) * 0.0127;
    himc_performance *p = session_new();
    session_do(p, "drum timpano %s", t->inches);
    char tune[20];
    snprintf(tune, sizeof tune, "tune %s", t->note);
    session_drum(p, 0, tune);
    session_do(p, "%s", before);
    session_do(p, "tempo 60");
    for (int i = 0; i < strokes; i++)
        session_do(p, "stroke %g %s %s %g 0", 1.2 + i * interval, i & 1 ? "left" : "right", how, x);
    session_do(p, "play");
    for (int i = 0; i < lround(100 * (1.5 + strokes * interval)); i++) {
        himc_performance_process(p, 480, NULL);
        for (int ear = 0; ear < 2; ear++) {
            himc_drum_read_channel(himc_performance_drum(p, 0), ear, himc_performance_time(p) - 480,
                                   480, sound);
            for (int k = 0; k < 480; k++)
                peak = fmax(peak, fabs(sound[k]));
        }
    }
    TEST_ASSERT_EQUAL_INT(strokes, himc_performance_measure(p).played);
    himc_performance_free(p);
    return peak;
}

static double decibels(double x)
{
    return 20 * log10(x);
}

// single strokes are the hardest, a roll adds up; by the drum's own pickup, and by two ears
static void check_strongest(const struct timpano *t, double place)
{
    static const char *const by[] = {"listener off", "listener 2.3 0.5 1.3"};
    for (int i = 0; i < 2; i++) {
        double once = peak_of(t, "vertical-accent fff", place, 1, 1, by[i]);
        double roll = peak_of(t, "vertical-accent fff", place, 10, 0.1, by[i]);
        printf("%s inches, %s, %.2f of the radius, %s: fff %.1f dB, in a roll %.1f dB\n", t->inches,
               t->note, place, by[i], decibels(once), decibels(roll));
        TEST_ASSERT_TRUE(once <= FULL_SCALE);
        TEST_ASSERT_TRUE(roll <= FULL_SCALE);
    }
}

static void check_softest(const struct timpano *t, double place)
{
    double peak = peak_of(t, "staccato ppp", place, 1, 1, "listener off");
    printf("%s inches, %s, %.2f of the radius: ppp %.1f dB\n", t->inches, t->note, place,
           decibels(peak));
    TEST_ASSERT_TRUE(peak > SOFTEST);
}

static void check_all(void (*check)(const struct timpano *, double), double usual)
{
    bool all = getenv("HIMC_LONG");
    for (int i = 0; i < TIMPANI; i++)
        for (int k = 0; k < (all ? PLACES : 1); k++)
            check(&timpano[i], all ? places[k] : usual);
}

static void test_the_strongest_strokes_stay_within_full_scale(void)
{
    check_all(check_strongest, LOUDEST_PLACE);
}

static void test_the_softest_strokes_stay_above_minus_60_db(void)
{
    check_all(check_softest, SOFTEST_PLACE);
}

// a fader: the same stroke, so much louder or softer, without a step
static void test_gain_scales_the_sound_and_changes_no_motion(void)
{
    double peak[3], force[3];
    static const char *const gain[] = {"gain 0", "gain -6", "gain 12"};
    for (int i = 0; i < 3; i++) {
        himc_drum *drum = himc_drum_new("timpano", 26, 48000, &error);
        himc_command c;
        double pushed[480], sound[480] = {0}, last = 0, step = 0;
        himc_contact_report report;
        TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, gain[i], &error) &&
                         himc_drum_command(drum, &c, &error));
        TEST_ASSERT_TRUE(himc_drum_strike_at(drum, 4800, -0.24, 0, 2, &error));
        peak[i] = 0;
        for (int block = 0; block < 50; block++) {
            himc_drum_advance(drum, 480, NULL, NULL, NULL);
            himc_drum_read(drum, himc_drum_time(drum) - 480, 480, sound, pushed);
            for (int k = 0; k < 480; k++) {
                peak[i] = fmax(peak[i], fabs(sound[k]));
                step = fmax(step, fabs(sound[k] - last));
                last = sound[k];
            }
        }
        TEST_ASSERT_TRUE(step < 0.2 * peak[i]);
        TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
        force[i] = report.force;
        himc_drum_release(drum);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -6, decibels(peak[1] / peak[0]));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 12, decibels(peak[2] / peak[0]));
    TEST_ASSERT_TRUE(force[0] == force[1] && force[0] == force[2]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_strongest_strokes_stay_within_full_scale);
    RUN_TEST(test_the_softest_strokes_stay_above_minus_60_db);
    RUN_TEST(test_gain_scales_the_sound_and_changes_no_motion);
    return UNITY_END();
}
