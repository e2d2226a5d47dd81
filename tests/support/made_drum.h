/// made_drum.h: shared by tests of instruments: what the command `instrument` makes.
#ifndef HIMC_TESTS_MADE_DRUM_H
#define HIMC_TESTS_MADE_DRUM_H

#include "himc/loader.h"

#include "unity.h"

#include <stdio.h>

/// What `instrument` makes of these words; free with himc_drum_release.
static inline himc_drum *made_drum(const char *words, double rate)
{
    himc_error error = {.text = ""};
    himc_command command;
    char line[80];
    snprintf(line, sizeof line, "instrument d %s", words);
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&command, HIMC_PERFORMER, line, &error),
                             error.text);
    himc_drum *drum = himc_drum_made(&command, rate, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(drum, error.text);
    return drum;
}

#endif
