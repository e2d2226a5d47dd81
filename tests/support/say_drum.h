/// say_drum.h: shared by tests of a drum alone that is given commands: a drum of 23 inches for each
/// test, its energy, and the sound of blows on it.
#ifndef HIMC_TESTS_SAY_DRUM_H
#define HIMC_TESTS_SAY_DRUM_H

#include "drum/drum_state.h"
#include "inner_state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unity.h>

#define RATE 48000

static himc_error error;
static himc_drum *drum;

void setUp(void);
void tearDown(void);

void setUp(void)
{
    error.text[0] = '\0';
    drum = himc_drum_new("thing", 23, RATE, &error);
}

void tearDown(void)
{
    himc_drum_release(drum);
}

static inline bool say(const char *text)
{
    himc_command command;
    return himc_command_parse_text(&command, HIMC_DRUM, text, &error) &&
           himc_drum_command(drum, &command, &error);
}

static inline void done(const char *text)
{
    TEST_ASSERT_TRUE_MESSAGE(say(text), error.text);
}

static inline himc_mode mode(int index)
{
    return himc_membrane_mode(himc_drum_membrane(drum), index);
}

static inline double energy(void)
{
    return himc_membrane_energy(himc_drum_membrane(drum));
}

static inline void advance(double seconds)
{
    himc_drum_advance(drum, (int)(seconds * RATE), NULL, NULL, NULL);
}

static inline void strike(double x, double y, double velocity)
{
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_strike_at(drum, 0, x, y, velocity, &error), error.text);
}

/// n samples of the sound from a blow on, and its report.
static inline himc_contact_report sound_of(double x, double y, double velocity, double *sound,
                                           int n)
{
    himc_contact_report report = {0};
    strike(x, y, velocity);
    himc_drum_advance(drum, n, NULL, NULL, NULL);
    himc_drum_read(drum, himc_drum_time(drum) - (uint64_t)n, n, sound, NULL);
    TEST_ASSERT_TRUE(himc_drum_strike_next(drum, &report));
    return report;
}

/// Blows at random, none of which gives more energy than its mallet had; between them it falls.
static inline void check_energy(const char *name)
{
    const himc_head_frame *frame = himc_drum_head_frame(drum);
    unsigned seed = 1;
    for (int blow = 0; blow < 6; blow++) {
        double at[2], speed = 0.2 + 2 * blow, before = energy();
        for (int i = 0; i < 2; i++) {
            seed = seed * 1664525u + 1013904223u;
            at[i] = 0.98 * ((seed >> 8) / 16777216.0 - 0.5);
        }
        double given = 0.5 * himc_drum_mallet(drum, HIMC_RIGHT)->mass * speed * speed;
        strike(at[0] * frame->length, at[1] * frame->width, speed);
        advance(0.02);
        TEST_ASSERT_TRUE_MESSAGE(energy() <= before + given, name);
        for (double last = energy(), now; last > 1e-9 && blow % 2; last = now) {
            advance(0.3);
            now = energy();
            TEST_ASSERT_TRUE_MESSAGE(now <= last, name);
        }
    }
}

/// Equal blows there sound equal, a stronger one louder, none too loud; the contact of the first.
static inline himc_contact_report check_blows(const char *name, double x, double y)
{
    static double sound[3][RATE / 2];
    static const double speed[] = {2, 2, 5};
    himc_contact_report first = {0};
    double loud[3] = {0};
    for (int k = 0; k < 3; k++) {
        himc_contact_report report = sound_of(x, y, speed[k], sound[k], RATE / 2);
        first = k == 0 ? report : first;
        for (int i = 0; i < RATE / 2; i++)
            loud[k] = fmax(loud[k], fabs(sound[k][i]));
        himc_drum_rest(drum);
        advance(0.1);
    }
    TEST_ASSERT_EQUAL_DOUBLE_ARRAY_MESSAGE(sound[0], sound[1], RATE / 2, name);
    TEST_ASSERT_TRUE_MESSAGE(loud[0] > 1e-4 && loud[2] > 1.8 * loud[0] && loud[2] < 1, name);
    return first;
}

static inline void keep_line(void *user, const char *line)
{
    char *lines = user;
    snprintf(lines + strlen(lines), 4000 - strlen(lines), "%s\n", line);
}

/// What the drum tells of its state makes its mode `index` again, on another drum.
static inline void check_dump(const char *name, int index)
{
    char lines[4000] = "", *rest = lines;
    himc_mode was = mode(index);
    himc_drum_describe(drum, HIMC_DESCRIBE_STATE, keep_line, lines);
    tearDown();
    setUp();
    for (char *line; (line = strsep(&rest, "\n")) && *line;)
        done(line);
    TEST_ASSERT_TRUE_MESSAGE(was.frequency > 0, name);
    TEST_ASSERT_EQUAL_DOUBLE(was.frequency, mode(index).frequency);
    TEST_ASSERT_EQUAL_DOUBLE(was.decay, mode(index).decay);
    TEST_ASSERT_EQUAL_DOUBLE(was.mass, mode(index).mass);
}

#endif
