/// written.h: a score, its notes, and the page that is written of them.
#ifndef HIMC_TESTS_MUSICXML_WRITTEN_H
#define HIMC_TESTS_MUSICXML_WRITTEN_H

#include "unity.h"

#include "musicxml/export.h"
#include "musicxml/import.h"
#include "plan/score.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static himc_error error;
static himc_score *score;
static midi_file notes;
static himc_text_lines text;
static midi_score made; // of the page, read back

void setUp(void)
{
    error.text[0] = '\0';
}

void tearDown(void)
{
    himc_score_free(score);
    himc_midi_file_free(&notes);
    himc_midi_score_free(&made);
    free(text.bytes);
    score = NULL;
    text = (himc_text_lines){0};
}

static inline bool import_as(himc_score_maker *make, const midi_options *options)
{
    himc_midi_score_free(&made);
    return make(&made, text.bytes, text.size, "back", options, &error);
}

static inline void import_back(void)
{
    TEST_ASSERT_TRUE_MESSAGE(import_as(himc_music_import, NULL), error.text);
}

#endif
