/// test_clocks.c: sample counts beyond 2^32 (a day at 48 kHz) and 2^50 (743 years): the same
/// strokes and the same sound as from 0; and the rates of sound and physics.
///
/// Counts are integers of 64 bits everywhere. Time in seconds is a double, 2^50 samples are
/// 2.3e10 s, and there its last bit is 4 microseconds; after a day it is 15 picoseconds. So a drum
/// alone repeats bit by bit, and a performer's strokes move by 0.02 ns after a day and by 0.1 ms
/// after 743 years.
#if __has_include("m_pd.h")
#define HIMC_BUILD_ID "test"
#include "pd-externals/drum-link.h"
#define HAVE_PD 1
#endif

#include "drum/drum_state.h"
#include "performance/performance_state.h"

#include "session.h"

#define RATE 48000
#define LENGTH 48000

// half a second before 2^32 and 2^50, at a whole second of 48 kHz: there a task tick begins
static const uint64_t starts[] = {(1ull << 32) / RATE * RATE, (1ull << 50) / RATE *RATE};
// largest shift of a stroke (s) and of its force (relative): the rounding of a time in seconds
static const double shifts[] = {1e-9, 2e-4}, force_shifts[] = {1e-6, 0.02};

static double sound[2][LENGTH];

// strikes with delays, a change and a realign; returns the last report
static himc_contact_report play_drum(uint64_t from, double *out)
{
    himc_contact_report report = {0};
    himc_contact_onset onset;
    himc_command c;
    himc_drum *drum = himc_drum_new("kettle", 23, RATE, &error);
    TEST_ASSERT_NOT_NULL(drum);
    drum->time += from;
    drum->zero += from > 0 ? 5 * RATE : 0;
    uint64_t start = himc_drum_time(drum);
    for (int i = 0; i < 10; i++) {
        if (i < 6)
            himc_drum_strike_at(drum, 700 * i, 0.1, 0.02 * i, 1 + i, &error);
        himc_drum_advance(drum, LENGTH / 10, NULL, NULL, NULL);
        himc_drum_read(drum, start + (uint64_t)(i * LENGTH / 10), LENGTH / 10,
                       out + i * LENGTH / 10, NULL);
    }
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_DRUM, "tension 5000", &error) &&
                     himc_drum_command(drum, &c, &error));
    himc_drum_realign(drum, 100);
    TEST_ASSERT_EQUAL_UINT64(100, himc_drum_time(drum));
    himc_drum_strike_at(drum, 50, 0, 0, 2.5, &error);
    himc_drum_advance(drum, 2000, NULL, NULL, NULL);
    while (himc_drum_strike_next(drum, &report))
        ;
    while (himc_drum_contact_next(drum, &onset) && onset.velocity != 2.5)
        ;
    TEST_ASSERT_EQUAL_INT(150, (int)onset.at);
    himc_drum_release(drum);
    return report;
}

static void test_a_drum_plays_the_same_bits_across_2_to_the_32_and_50(void)
{
    himc_contact_report first = play_drum(0, sound[0]);
    for (int i = 0; i < 2; i++) {
        himc_contact_report report = play_drum(starts[i], sound[1]);
        TEST_ASSERT_EQUAL_MEMORY(sound[0], sound[1], sizeof sound[0]);
        TEST_ASSERT_EQUAL_MEMORY(&first, &report, sizeof report);
    }
}

// a performer that has been at rest for `from` samples
static himc_performance *performer_at(uint64_t from)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle");
    p->clock.made += (int64_t)from;
    p->clock.played += (int64_t)from;
    p->clock.step += (int64_t)(from / RATE * 10000);
    p->drums.slot[0].drum->time += from;
    himc_performance_process(p, RATE / 10, NULL);
    return p;
}

// a score with a tempo change in a loop, and hits with delays
static heard play_performer(uint64_t from)
{
    heard h = {0};
    himc_performance *p = performer_at(from);
    session_do(p, "tempo 140");
    for (int i = 0; i < 8; i++)
        session_do(p, "stroke %g %s %s %.2f", 0.5 * i, i & 1 ? "left" : "right",
                   himc_nuance_name((himc_nuance)(i % 5)), 0.3 + 0.08 * i);
    session_do(p, "loop 1");
    session_do(p, "play");
    session_play(p, 2.5, &h);
    session_do(p, "tempo 110");
    session_play(p, 2, &h);
    session_do(p, "stop");
    himc_command c;
    TEST_ASSERT_TRUE(himc_command_parse_text(&c, HIMC_PERFORMER, "hit left accent f", &error) &&
                     himc_performance_command(p, &c, 1234, &error));
    session_play(p, 1.5, &h);
    TEST_ASSERT_EQUAL_UINT64(from + RATE / 10 + 6 * RATE, himc_performance_time(p));
    TEST_ASSERT_EQUAL_INT(0, himc_performance_measure(p).missed);
    himc_performance_free(p);
    return h;
}

static void test_a_performers_strokes_are_the_same_across_2_to_the_32_and_50(void)
{
    heard first = play_performer(0);
    TEST_ASSERT_TRUE(first.strikes >= 10);
    for (int i = 0; i < 2; i++) {
        heard h = play_performer(starts[i]);
        double begin = (double)starts[i] / RATE, late = 0, harder = 0;
        TEST_ASSERT_EQUAL_INT(first.strikes, h.strikes);
        TEST_ASSERT_EQUAL_INT(first.beats, h.beats);
        for (int k = 0; k < h.strikes; k++) {
            const himc_strike *a = &first.strike[k], *b = &h.strike[k];
            late = fmax(late, fabs(b->time - begin - a->time));
            late = fmax(late, fabs(b->planned_time - begin - a->planned_time));
            harder = fmax(harder, fabs(b->force / a->force - 1));
        }
        printf("from %.0f s: strokes moved by %.2g s, forces by %.2g\n", begin, late, harder);
        TEST_ASSERT_TRUE(late <= shifts[i]);
        TEST_ASSERT_TRUE(harder <= force_shifts[i]);
        heard_free(&h);
    }
    heard_free(&first);
}

// a step has at least one sample: of 8 kHz sound the physics has 8 kHz, whatever was asked for
static void test_physics_is_never_faster_than_the_sound(void)
{
    himc_performance_config config = himc_performance_default();
    config.sample_rate = 8000;
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    himc_performance_make_drums(p, true);
    session_do(p, "drum kettle 26");
    session_do(p, "rate physics 20000");
    session_do(p, "tempo 60");
    session_do(p, "stroke 1 left accent f");
    session_do(p, "play");
    himc_performance_process(p, 2 * 8000, NULL);
    himc_performance_stats s = himc_performance_measure(p);
    TEST_ASSERT_EQUAL_DOUBLE(8000, s.physics_rate);
    TEST_ASSERT_EQUAL_DOUBLE(2, s.seconds);
    TEST_ASSERT_EQUAL_INT(1, s.played);
    TEST_ASSERT_EQUAL_INT(0, s.recoveries);
    himc_performance_free(p);
}

// samples that are simulated and not yet taken stay so when the rate changes: else what is heard of
// a drum lags behind the performance by a step with each change
static void test_drum_is_never_more_than_a_step_ahead_of_its_performance(void)
{
    himc_performance *p = session_new();
    session_do(p, "drum kettle 26");
    for (int i = 0; i < 20; i++) {
        double rate = i & 1 ? 44100 : 48000;
        TEST_ASSERT_TRUE_MESSAGE(himc_performance_set_rate(p, rate, &error), error.text);
        uint64_t before = himc_performance_time(p);
        himc_performance_process(p, 101, NULL);
        TEST_ASSERT_EQUAL_UINT64(before + 101, himc_performance_time(p));
        uint64_t made = himc_drum_time(himc_performance_drum(p, 0));
        TEST_ASSERT_TRUE(made - himc_performance_time(p) < 5);
    }
    himc_performance_free(p);
}

// time of a stroke (s) after a second at another sample rate
static double struck_at(double other)
{
    himc_performance *p = session_new();
    heard h = {.strikes = 0};
    session_do(p, "drum kettle 26");
    session_do(p, "tempo 60");
    session_do(p, "stroke 3 right legato mf");
    session_do(p, "play");
    session_play(p, 1, &h);
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_set_rate(p, other, &error), error.text);
    session_play(p, 1, &h);
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_set_rate(p, RATE, &error), error.text);
    session_play(p, 3, &h);
    TEST_ASSERT_EQUAL_INT(1, h.strikes);
    double time = h.strike[0].time;
    heard_free(&h);
    himc_performance_free(p);
    return time;
}

static void test_time_goes_on_when_the_sample_rate_changes(void)
{
    double usual = struck_at(RATE);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, usual, struck_at(2 * RATE));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, usual, struck_at(RATE / 3.0));
}

#ifdef HAVE_PD
// Pd's clock, at a logical time in ms
static double pd_time;

double clock_getlogicaltime(void)
{
    return pd_time;
}

double clock_gettimesince(double since)
{
    return pd_time - since;
}

int sys_getblksize(void)
{
    return 64;
}

int pd_getdspstate(void)
{
    return 1;
}

static void test_a_message_to_pd_finds_its_sample_across_2_to_the_32_and_50(void)
{
    for (int i = 0; i < 2; i++) {
        t_signal signal = {.s_n = 64, .s_sr = RATE};
        t_stream s = {0};
        pd_time = 0;
        stream_restart(&s, &signal);
        s.s_count = starts[i] - 32; // crosses the power of two in its first block
        uint64_t engine = s.s_count + 5;
        stream_begin(&s, engine);
        TEST_ASSERT_EQUAL_UINT64(5, s.s_lag);
        for (int k = 0; k < 64; k++) {
            pd_time = k * 1000.0 / RATE;
            TEST_ASSERT_EQUAL_INT(k < 5 ? 0 : k - 5, stream_delay(&s, engine, 64));
            TEST_ASSERT_EQUAL_INT(k, stream_delay(&s, engine + 955, 1024));
        }
        s.s_count += 64;
        stream_end(&s);
        pd_time += 1000; // away for a second: it rejoins the engine with the lag it had
        stream_begin(&s, engine + RATE);
        TEST_ASSERT_EQUAL_UINT64(engine + RATE - 5, s.s_count);
    }
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_drum_plays_the_same_bits_across_2_to_the_32_and_50);
    RUN_TEST(test_a_performers_strokes_are_the_same_across_2_to_the_32_and_50);
    RUN_TEST(test_physics_is_never_faster_than_the_sound);
    RUN_TEST(test_drum_is_never_more_than_a_step_ahead_of_its_performance);
    RUN_TEST(test_time_goes_on_when_the_sample_rate_changes);
#ifdef HAVE_PD
    RUN_TEST(test_a_message_to_pd_finds_its_sample_across_2_to_the_32_and_50);
#endif
    return UNITY_END();
}
