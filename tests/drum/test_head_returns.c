/// test_head_returns.c: heads that come back. A head that is damped and released, or tuned away and
/// back, is one that was used before; nothing of what it did then may sound again.
#include "base/job.h"
#include "drum/drum_performer.h"
#include "drum/membrane_state.h"
#include "himc/membrane.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define RATE 48000
#define ROUNDING 1e-9 // of an energy, relative
#define CHUNK 480

static himc_error error;

void setUp(void)
{
    error.text[0] = '\0';
}

void tearDown(void)
{
}

static void parse(himc_command *c, const char *text)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(c, HIMC_DRUM, text, &error), error.text);
}

static void say(himc_drum *drum, const char *text)
{
    himc_command c;
    parse(&c, text);
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_command(drum, &c, &error), error.text);
}

// the same command, prepared aside
static void say_aside(himc_drum *drum, const char *text)
{
    himc_command c;
    parse(&c, text);
    himc_job *job = himc_drum_job(drum, &c, &error);
    TEST_ASSERT_TRUE_MESSAGE(himc_job_carry_out(job, &error), error.text);
}

static himc_drum *drum_of(bool ears)
{
    himc_drum *drum = himc_drum_new("timp", 26, RATE, &error);
    himc_listener listener = himc_listener_at((himc_vec3){2, 0, 1.4});
    TEST_ASSERT_NOT_NULL_MESSAGE(drum, error.text);
    if (ears) {
        TEST_ASSERT_TRUE(himc_drum_open_ears(drum, &error));
        himc_drum_listen(drum, &listener);
    }
    say(drum, "tune A2");
    return drum;
}

static void strike(himc_drum *drum)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_strike_at(drum, 0, -0.2, 0.01, 4, &error), error.text);
}

static double energy_of(himc_drum *drum)
{
    return himc_membrane_energy(himc_drum_membrane(drum));
}

// the changes at beats 1, 2, ...
static himc_drum_heads *heads_for(himc_drum *drum, const char *const *change, int count)
{
    himc_drum_settings settings = himc_drum_settings_of(drum);
    himc_drum_heads *heads = himc_drum_heads_new(&settings, &error);
    himc_drum_settings_free(&settings);
    for (int i = 0; i < count; i++) {
        himc_command c;
        parse(&c, change[i]);
        TEST_ASSERT_TRUE_MESSAGE(himc_drum_heads_add(heads, i + 1, &c, &error), error.text);
    }
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_heads_prepare(heads, &error), error.text);
    return heads;
}

// plays on, and gives the first channel if there is somewhere to
static void play(himc_drum *drum, int n, double *sound)
{
    for (int done = 0, count; done < n; done += count) {
        count = n - done < CHUNK ? n - done : CHUNK;
        himc_drum_advance(drum, count, NULL, NULL, NULL);
        if (sound)
            himc_drum_read_channel(drum, 0, himc_drum_time(drum) - (uint64_t)count, count,
                                   sound + done);
    }
}

// the same without contact: the energy never grows
static void ring(himc_drum *drum, int n, const char *story)
{
    double before = energy_of(drum);
    for (int done = 0; done < n; done += CHUNK) {
        himc_drum_advance(drum, CHUNK, NULL, NULL, NULL);
        double now = energy_of(drum);
        if (!(now <= before * (1 + ROUNDING))) {
            char text[200];
            snprintf(text, sizeof text, "%s: %.9g J became %.9g J", story, before, now);
            TEST_FAIL_MESSAGE(text);
        }
        before = now;
    }
}

static double level(const double *sound, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += sound[i] * sound[i];
    return sqrt(sum / n);
}

// What a release brings back against a hand that stays, per level of the stroke: no more than the
// head still had, and nothing once that was silent.
static void check_release(const char *damp, double seconds, bool ears)
{
    enum { AFTER = RATE / 5 };
    static double stroke[RATE / 10], released[AFTER], held[AFTER];
    const char *const change[] = {damp, "damp 0"};
    himc_drum *drum[2];
    himc_drum_heads *heads[2];
    double loud = 0, left = 0, rest = 0, most = 0;
    for (int k = 0; k < 2; k++) {
        drum[k] = drum_of(ears);
        heads[k] = heads_for(drum[k], change, 2);
        himc_drum_heads_turn(heads[k], drum[k], 0, &error);
        strike(drum[k]);
        play(drum[k], RATE / 10, stroke);
        loud = level(stroke, RATE / 10);
        most = energy_of(drum[k]);
        play(drum[k], RATE / 2, NULL);
        himc_drum_heads_turn(heads[k], drum[k], 1, &error);
        play(drum[k], (int)(seconds * RATE), NULL);
        left = energy_of(drum[k]);
        himc_drum_heads_turn(heads[k], drum[k], k ? 2 : 1, &error);
        play(drum[k], AFTER, k ? released : held);
        rest = energy_of(drum[k]);
        TEST_ASSERT_TRUE(rest <= left * (1 + ROUNDING));
        himc_drum_heads_free(heads[k]);
        himc_drum_release(drum[k]);
    }
    for (int i = 0; i < AFTER; i++)
        released[i] -= held[i];
    double back = level(released, AFTER) / loud, allowed = fmax(1e-5, 3 * sqrt(left / most));
    char text[200];
    snprintf(text, sizeof text, "%s for %g s, %s: %.1f dB, expected %.1f", damp, seconds,
             ears ? "two ears" : "one channel", 20 * log10(back), 20 * log10(allowed));
    TEST_ASSERT_TRUE_MESSAGE(back <= allowed, text);
}

static void test_a_released_head_stays_as_silent_as_it_was(void)
{
    static const char *const damp[] = {"damp 1", "damp 0.99", "damp 0.5"};
    static const double seconds[] = {0.1, 0.2, 0.3, 0.5, 1, 5};
    for (int ears = 0; ears < 2; ears++)
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 6; k++)
                check_release(damp[i], seconds[k], ears);
}

// a head made ahead sounds as one that is changed by hand, however often it was in use
static void test_a_pedal_that_returns_sounds_as_one_moved_by_hand(void)
{
    enum { LENGTH = RATE / 2 };
    static double made[LENGTH], changed[LENGTH];
    static const char *const change[] = {"tune D3", "tune A2", "tune D3", "tune A2"};
    static const double seconds[] = {0.5, 1, 2, 4.5, 10};
    for (int k = 0; k < 5; k++) {
        himc_drum *drum = drum_of(false), *hand = drum_of(false);
        himc_drum_heads *heads = heads_for(drum, change, 4);
        strike(drum);
        strike(hand);
        for (int i = 0; i < 4; i++) {
            himc_drum_heads_turn(heads, drum, i + 1, &error);
            say(hand, change[i]);
            if (i == 0) // the stroke
                play(drum, CHUNK * 10, NULL), play(hand, CHUNK * 10, NULL);
            ring(drum, (int)(seconds[k] * RATE), "pedal");
            ring(hand, (int)(seconds[k] * RATE), "pedal by hand");
        }
        play(drum, LENGTH, made);
        play(hand, LENGTH, changed);
        TEST_ASSERT_EQUAL_MEMORY(changed, made, sizeof made);
        himc_drum_heads_free(heads);
        himc_drum_release(drum);
        himc_drum_release(hand);
    }
}

static unsigned next(unsigned *seed, unsigned count)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) % count;
}

// what a score may have at a beat; few values, so that earlier heads return
static const char *const at_beats[] = {"tune A2",        "tune D3", "tune C3",   "damp 1",
                                       "damp 0",         "damp 0",  "damp 0.25", "decay 12",
                                       "decay 0.5 3e-7", "glide 0", "glide 1",   "tension 2500"};
#define AT_BEATS ((int)(sizeof at_beats / sizeof *at_beats))

// silence, or a moment, between two changes
static int pause_of(unsigned *seed)
{
    static const int chunks[] = {1, 3, 10, 30, 100, 300};
    return CHUNK * chunks[next(seed, 6)];
}

static void test_heads_return_in_any_order_and_bring_nothing(void)
{
    enum { CHANGES = 40, LENGTH = CHUNK * 300 };
    static double made[LENGTH], given[LENGTH];
    for (unsigned seed = 1; seed <= 6; seed++) {
        const char *change[CHANGES];
        unsigned random = seed;
        for (int i = 0; i < CHANGES; i++)
            change[i] = at_beats[next(&random, AT_BEATS)];
        himc_drum *drum = drum_of(seed % 2), *hand = drum_of(seed % 2);
        himc_drum_heads *heads = heads_for(drum, change, CHANGES);
        for (int i = 0; i < CHANGES; i++) {
            if (next(&random, 8) == 0) {
                strike(drum), strike(hand);
                play(drum, CHUNK * 10, NULL), play(hand, CHUNK * 10, NULL);
            }
            int n = pause_of(&random);
            double before = energy_of(drum);
            unsigned revision = himc_drum_membrane(drum)->revision;
            himc_drum_heads_turn(heads, drum, i + 1, &error);
            TEST_ASSERT_TRUE_MESSAGE(energy_of(drum) <= before * (1 + ROUNDING), change[i]);
            if (himc_drum_membrane(drum)->revision != revision)
                say(hand, change[i]); // else it is so already
            play(drum, n, made);
            play(hand, n, given);
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(given, made, sizeof *made * (size_t)n, change[i]);
        }
        himc_drum_heads_free(heads);
        himc_drum_release(drum);
        himc_drum_release(hand);
    }
}

// all that changes a head, beside the above
static const char *const anything[] = {
    "radius 0.3302", "radius 0.28",      "modes 100",
    "modes 300",     "modes auto",       "air 0",
    "air 1",         "density 0.3",      "density 0.2653",
    "uniformity 1",  "uniformity 0.5 7", "shape rectangle 0.6 0.5",
    "shape circle",  "kettle usual",     "kettle 0.1",
    "pickup 0.1 0",  "pickups 2"};
#define ANYTHING ((int)(sizeof anything / sizeof *anything))

// by command, aside, or as a head made ahead; a follower, which rings by itself, goes along
static void change_somehow(himc_drum *drum, himc_drum *follower, unsigned *random)
{
    bool any = next(random, 2);
    const char *text = any ? anything[next(random, ANYTHING)] : at_beats[next(random, AT_BEATS)];
    himc_command c;
    parse(&c, text);
    himc_drum_settings trial = himc_drum_settings_of(drum);
    bool good = himc_drum_settings_command(&trial, &c, NULL); // `air 1` is not for a rectangle
    himc_drum_settings_free(&trial);
    if (!good)
        return;
    double before = energy_of(drum), beside = energy_of(follower);
    if (next(random, 2))
        say(drum, text);
    else
        say_aside(drum, text);
    const himc_shape *shape = &himc_membrane_config_of(himc_drum_membrane(drum))->shape;
    TEST_ASSERT_EQUAL_MESSAGE(shape->length > 0, himc_drum_head_frame(drum)->length > 0, text);
    TEST_ASSERT_TRUE_MESSAGE(energy_of(drum) <= before * (1 + ROUNDING), text);
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_follow(follower, drum, &error), error.text);
    TEST_ASSERT_TRUE(himc_drum_follows(follower, drum));
    const himc_head_frame *led = himc_drum_head_frame(drum), *at = himc_drum_head_frame(follower);
    TEST_ASSERT_TRUE_MESSAGE(at->radius == led->radius && at->length == led->length, text);
    TEST_ASSERT_TRUE_MESSAGE(energy_of(follower) <= beside * (1 + ROUNDING), text);
}

static void test_no_change_of_a_ringing_or_silent_head_brings_energy(void)
{
    for (unsigned seed = 1; seed <= 4; seed++) {
        himc_drum *drum = drum_of(seed % 2), *other = drum_of(false);
        unsigned random = seed;
        for (int i = 0; i < 60; i++) {
            if (next(&random, 6) == 0) {
                strike(drum), strike(other);
                play(drum, CHUNK * 10, NULL), play(other, CHUNK * 10, NULL);
            }
            change_somehow(drum, other, &random);
            int n = pause_of(&random);
            ring(drum, n, "drum");
            ring(other, n, "follower");
        }
        himc_drum_release(drum);
        himc_drum_release(other);
    }
}

static void test_drums_of_any_rate_follow_one(void)
{
    himc_drum *drum = drum_of(false), *beside[2];
    for (int i = 0; i < 2; i++)
        beside[i] = himc_drum_new("beside", 23, i ? 44100 : himc_drum_rate(drum), &error);
    for (int change = 0; change < 3; change++) {
        say(drum, change == 0   ? "modes 400"
                  : change == 1 ? "shape rectangle 0.5 0.4"
                                : "pickups 3");
        for (int i = 0; i < 2; i++) {
            TEST_ASSERT_FALSE(himc_drum_follows(beside[i], drum));
            TEST_ASSERT_TRUE_MESSAGE(himc_drum_follow(beside[i], drum, &error), error.text);
            TEST_ASSERT_TRUE(himc_drum_follows(beside[i], drum));
        }
    }
    TEST_ASSERT_EQUAL_DOUBLE(44100, himc_drum_rate(beside[1]));
    TEST_ASSERT_EQUAL_DOUBLE(44100, himc_membrane_rate(himc_drum_membrane(beside[1])));
    himc_drum_release(drum);
    himc_drum_release(beside[0]);
    himc_drum_release(beside[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_released_head_stays_as_silent_as_it_was);
    RUN_TEST(test_drums_of_any_rate_follow_one);
    RUN_TEST(test_a_pedal_that_returns_sounds_as_one_moved_by_hand);
    RUN_TEST(test_heads_return_in_any_order_and_bring_nothing);
    RUN_TEST(test_no_change_of_a_ringing_or_silent_head_brings_energy);
    return UNITY_END();
}
