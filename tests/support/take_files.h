/// take_files.h: small take files made in memory, for the tests of the readers; each test program
/// has its own copy.
#ifndef HIMC_TESTS_TAKE_FILES_H
#define HIMC_TESTS_TAKE_FILES_H

#include "capture/take.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// A file under ../shared/mocap (HIMC_SHARED overrides ../shared), or NULL if it is not there; one
/// static buffer.
static inline const char *shared_capture(const char *name)
{
    static char path[512];
    const char *shared = getenv("HIMC_SHARED");
    snprintf(path, sizeof path, "%s/mocap/%s", shared ? shared : "../shared", name);
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    fclose(file);
    return path;
}

/// All of a file, to be freed.
static inline char *read_all(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size + 1);
    *size = fread(bytes, 1, *size, file);
    bytes[*size] = 0;
    fclose(file);
    return bytes;
}

/// Reads a text as a take; NULL with error.text.
static inline himc_take *read_text(const char *text, const char *name,
                                   const himc_take_options *options, himc_error *error)
{
    error->text[0] = 0;
    return himc_take_read(text, strlen(text), name, options, error);
}

/// Writes a take of 1.8 s, y up, of the right tip alone: a blow of 4 m/s every 0.4 s. False if it
/// cannot be written.
static inline bool write_one_hand(const char *name)
{
    FILE *f = fopen(name, "w");
    if (!f)
        return false;
    fputs("PathFileType\t4\nDataRate\tNumFrames\tNumMarkers\tUnits\n500\t900\t1\tm\n", f);
    fputs("Frame#\tTime\tRTIP\t\t\n\n", f);
    for (int i = 0; i < 900; i++) {
        double u = fmod(i / 500.0, 0.4); // up at 4 m/s, down at 4 m/s
        fprintf(f, "%d\t%.4f\t0.5\t%.6f\t0.1\n", i + 1, i / 500.0, 0.8 + 10 * u * (0.4 - u));
    }
    return fclose(f) == 0;
}

#endif
