/// one_drum.h: a drum for tests, made anew for each, with helpers for commands and sound.
#ifndef HIMC_TESTS_ONE_DRUM_H
#define HIMC_TESTS_ONE_DRUM_H

#include "drum/drum_performer.h"

#include "unity.h"

#include <math.h>

#define RATE 48000.0
#define LENGTH 9600

static himc_drum *drum;
static himc_error error;
double sound[LENGTH], seen[LENGTH];

void setUp(void)
{
    error.text[0] = '\0';
    drum = himc_drum_new("kettle", 23, RATE, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(drum, error.text);
}

void tearDown(void)
{
    himc_drum_release(drum);
    drum = NULL;
}

static inline bool say(const char *text)
{
    himc_command command;
    return himc_command_parse_text(&command, HIMC_DRUM, text, &error) &&
           himc_drum_command(drum, &command, &error);
}

static inline void says(const char *text)
{
    TEST_ASSERT_TRUE_MESSAGE(say(text), error.text);
}

static inline void advance(int n)
{
    himc_drum_advance(drum, n, NULL, NULL, NULL);
}

static inline double peak(const double *x, int n)
{
    double most = 0;
    for (int i = 0; i < n; i++) {
        TEST_ASSERT_TRUE(isfinite(x[i]));
        most = fmax(most, fabs(x[i]));
    }
    return most;
}

// Two sticks, two strikes and an outside force at a moving point, in blocks of `block` samples.
static inline void scene(int block, double *out, double *place, double *force0)
{
    tearDown();
    setUp();
    static double outside[LENGTH], x[LENGTH], y[LENGTH], force1[LENGTH];
    himc_stick a = {.head = *himc_drum_mallet(drum, HIMC_RIGHT),
                    .mass = 0.03,
                    .acceleration = -9.81,
                    .x = -0.2,
                    .y = 0.03,
                    .height = 0.1,
                    .velocity = -3};
    himc_stick b = a, *sticks[] = {&a, &b};
    b.y = -0.03;
    b.height = 0.15;
    himc_drum_strike_at(drum, 100, 0.1, 0.1, 3, &error);
    himc_drum_strike_at(drum, 3111, 0, 0, 1, &error);
    for (int i = 0; i < LENGTH; i++) {
        outside[i] = i >= 5000 && i < 5040 ? 30 : 0;
        x[i] = i < 5020 ? 0.1 : 0.15;
        y[i] = i < 7000 ? 0 : 0.05;
    }
    for (int done = 0; done < LENGTH; done += block) {
        int n = LENGTH - done < block ? LENGTH - done : block;
        double *forces[] = {force0 + done, force1 + done};
        himc_outside_force from = {outside + done, x + done, y + done};
        himc_drum_advance_sticks(drum, n, sticks, 2, forces, &from);
    }
    himc_drum_read(drum, 0, LENGTH, out, place);
}

#endif
