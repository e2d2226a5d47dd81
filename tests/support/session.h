/// session.h: shared by tests of whole sessions: a performer with its drums, commands, pieces from
/// a seed, and the strikes.
#ifndef HIMC_TESTS_SESSION_H
#define HIMC_TESTS_SESSION_H

#define _GNU_SOURCE
#include "himc/himc.h"

#include "unity.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static himc_error error;

void setUp(void)
{
    error.text[0] = 0;
}

void tearDown(void)
{
}

/// Numbers from a seed, the same everywhere (0 .. 1).
static inline double chance(unsigned *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.0;
}

static inline int choose(unsigned *seed, int count)
{
    return (int)(chance(seed) * count);
}

static inline himc_performance *session_new(void)
{
    himc_performance_config config = himc_performance_default();
    himc_performance *p = himc_performance_new(&config, &error);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, error.text);
    himc_performance_make_drums(p, true);
    return p;
}

static inline bool session_try(himc_performance *p, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static inline void session_do(himc_performance *p, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static inline bool session_say(himc_performance *p, const char *format, va_list args)
{
    char text[512];
    himc_command c;
    vsnprintf(text, sizeof text, format, args);
    return himc_command_parse_text(&c, HIMC_PERFORMER, text, &error) &&
           himc_performance_command(p, &c, 0, &error);
}

static inline bool session_try(himc_performance *p, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    bool ok = session_say(p, format, args);
    va_end(args);
    return ok;
}

static inline void session_do(himc_performance *p, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    bool ok = session_say(p, format, args);
    va_end(args);
    TEST_ASSERT_TRUE_MESSAGE(ok, error.text);
}

/// Writes that score to a file, and loads it.
static inline void session_score(himc_performance *p, const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
    session_do(p, "score %s", path);
}

/// Adds strokes at beats 1, 1.5, 2 ..., right and left, in four nuances.
static inline void session_strokes(himc_performance *p, int count, const char *dynamic)
{
    static const char *const nuances[] = {"legato", "accent", "staccato", "tenuto"};
    for (int i = 0; i < count; i++)
        session_do(p, "stroke %g %s %s %s", 1 + 0.5 * i, i % 2 ? "left" : "right", nuances[i % 4],
                   dynamic);
}

static inline void session_drum(himc_performance *p, int drum, const char *text)
{
    himc_command c;
    bool ok = himc_command_parse_text(&c, HIMC_DRUM, text, &error) &&
              himc_drum_command(himc_performance_drum(p, drum), &c, &error);
    TEST_ASSERT_TRUE_MESSAGE(ok, error.text);
}

/// What was heard of a session.
typedef struct heard {
    himc_strike *strike; ///< owned
    int strikes, room;
    int beats, dones, notes;
    int softer;     ///< notes of strokes for which there is too little time
    char note[192]; ///< the last one
    char all[2048]; ///< all of them, one a line, as far as they have room
} heard;

static inline void heard_event(heard *h, const himc_event *event)
{
    h->beats += event->kind == HIMC_EVENT_BEAT;
    h->dones += event->kind == HIMC_EVENT_DONE;
    if (event->kind == HIMC_EVENT_NOTE) {
        h->notes++;
        h->softer += strstr(event->text, "too little time") != NULL;
        memcpy(h->note, event->text, sizeof h->note);
        size_t used = strlen(h->all);
        snprintf(h->all + used, sizeof h->all - used, "%s\n", event->text);
    }
    if (event->kind != HIMC_EVENT_STRIKE)
        return;
    if (h->strikes == h->room) {
        h->room = h->room ? 2 * h->room : 256;
        h->strike = realloc(h->strike, (size_t)h->room * sizeof *h->strike);
    }
    h->strike[h->strikes++] = event->strike;
}

/// Plays on for that long (s).
static inline void session_play(himc_performance *p, double seconds, heard *h)
{
    himc_event event;
    for (long i = 0; i < lround(seconds * 48000); i += 480) {
        himc_performance_process(p, 480, NULL);
        while (himc_performance_event(p, &event))
            if (h)
                heard_event(h, &event);
    }
}

static inline void heard_free(heard *h)
{
    free(h->strike);
    *h = (heard){0};
}

/// Strikes that a stroke asked for.
static inline int heard_asked(const heard *h)
{
    int n = 0;
    for (int i = 0; i < h->strikes; i++)
        n += isfinite(h->strike[i].planned_time);
    return n;
}

static inline int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static inline void drum_do(himc_drum *drum, const char *text)
{
    himc_command c;
    TEST_ASSERT_TRUE_MESSAGE(himc_command_parse_text(&c, HIMC_DRUM, text, &error), error.text);
    TEST_ASSERT_TRUE_MESSAGE(himc_drum_command(drum, &c, &error), error.text);
}

#endif
