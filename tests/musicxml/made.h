/// made.h: a MusicXML text, the score that is made of it, and what a test expects there.
#ifndef HIMC_TESTS_MUSICXML_MADE_H
#define HIMC_TESTS_MUSICXML_MADE_H

#include "unity.h"

#include "himc/performance.h"
#include "musicxml/import.h"
#include "performance/research.h"
#include "plan/score.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static himc_error error;
static midi_score made;
static himc_score *score;

void setUp(void)
{
    error.text[0] = '\0';
}

static inline void forget(void)
{
    himc_midi_score_free(&made);
    himc_score_free(score);
    score = NULL;
}

void tearDown(void)
{
    forget();
}

// a score of one part, whose divisions are 4 to a quarter note, at 120 beats a minute

#define HEAD                                                                 \
    "<?xml version='1.0' encoding='UTF-8'?><!DOCTYPE score-partwise PUBLIC " \
    "'-//Recordare//DTD MusicXML 4.0 Partwise//EN' "                         \
    "'http://www.musicxml.org/dtds/partwise.dtd'><score-partwise version='4.0'>"
#define PART(name)                                                                \
    "<part-list><score-part id='P1'><part-name>" name "</part-name></score-part>" \
    "</part-list><part id='P1'>"
#define TAIL "</part></score-partwise>"
#define BAR(number, body) "<measure number='" #number "'>" body "</measure>"
#define FOUR "<attributes><divisions>4</divisions></attributes>"
#define NOTE(step, octave, duration, more)                                                        \
    "<note><pitch><step>" #step "</step><octave>" #octave "</octave></pitch><duration>" #duration \
    "</duration><voice>1</voice>" more "</note>"
#define C3(duration, more) NOTE(C, 3, duration, more)
#define REST(duration) "<note><rest/><duration>" #duration "</duration></note>"
#define GRACE(step)                                                         \
    "<note><grace/><pitch><step>" #step "</step><octave>3</octave></pitch>" \
    "<voice>1</voice></note>"
#define MARKS(n)                                                                \
    "<notations><ornaments><tremolo type='single'>" #n "</tremolo></ornaments>" \
    "</notations>"
#define ARTICULATION(a) "<notations><articulations><" a "/></articulations></notations>"
#define DIRECTION(type) "<direction><direction-type>" type "</direction-type></direction>"
#define WORDS(text) DIRECTION("<words>" text "</words>")
#define DYNAMICS(d) DIRECTION("<dynamics><" d "/></dynamics>")
#define WEDGE(type) DIRECTION("<wedge type='" type "'/>")
#define TEMPO(bpm) "<sound tempo='" #bpm "'/>"

/// What import writes can be played: no line of it is refused.
static inline void expect_loaded(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_performance_load_text(p, made.text, "made", &error), error.text);
    himc_performance_free(p);
}

static inline bool import(const char *text)
{
    forget();
    if (!himc_music_import(&made, text, strlen(text), "test.musicxml", NULL, &error))
        return false;
    score = himc_score_parse(made.text, "made.txt", NULL, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(score, error.text);
    expect_loaded();
    return true;
}

static inline void load(const char *text)
{
    TEST_ASSERT_TRUE_MESSAGE(import(text), error.text);
}

#define PLAY(body) load(HEAD PART("Timpani") body TAIL)

/// Beats before the first of the file.
static inline double lead(void)
{
    double beats = -1;
    TEST_ASSERT_EQUAL(1, sscanf(strstr(made.text, "beat 0 of the file"),
                                "beat 0 of the file is beat %lf", &beats));
    return beats;
}

static inline const himc_stroke *stroke(int index)
{
    TEST_ASSERT_TRUE_MESSAGE(index < score->stroke_count, made.text);
    return &score->strokes[index];
}

static inline void expect_beats(int count, ...)
{
    va_list list;
    va_start(list, count);
    TEST_ASSERT_EQUAL_MESSAGE(count, score->stroke_count, made.text);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_FLOAT_WITHIN(1e-4, va_arg(list, double) + lead(), stroke(i)->beat);
    va_end(list);
}

/// In steps of 7: 4 is mf.
static inline void expect_dynamics(int count, ...)
{
    va_list list;
    va_start(list, count);
    TEST_ASSERT_EQUAL_MESSAGE(count, score->stroke_count, made.text);
    for (int i = 0; i < count; i++)
        TEST_ASSERT_FLOAT_WITHIN(0.05, va_arg(list, double), 7 * stroke(i)->dynamic);
    va_end(list);
}

static inline void expect_roll(int index, double beat, double length, double from, double to)
{
    const himc_stroke *s = stroke(index);
    TEST_ASSERT_EQUAL_MESSAGE(HIMC_ROLL_SINGLE, s->ornament, made.text);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, beat + lead(), s->beat);
    TEST_ASSERT_FLOAT_WITHIN(1e-3, length, s->length);
    TEST_ASSERT_FLOAT_WITHIN(0.06, from, 7 * s->dynamic);
    TEST_ASSERT_FLOAT_WITHIN(0.06, to, 7 * s->last_dynamic);
}

static inline void expect_text(const char *text)
{
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(made.text, text), made.text);
}

static inline double bpm_at(double beat)
{
    double bpm = 0;
    for (int i = 0; i < score->tempo_count; i++)
        if (score->tempi[i].beat <= beat + lead() + 1e-6)
            bpm = score->tempi[i].bpm;
    return bpm;
}

/// Seconds between two beats of the file.
static inline double time_between(double from, double to)
{
    return himc_score_seconds(score->tempi, score->tempo_count, to + lead()) -
           himc_score_seconds(score->tempi, score->tempo_count, from + lead());
}

#endif
