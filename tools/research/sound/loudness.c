/// loudness.c: how loud sound files are: `loudness FILE...`, one line each, four numbers:
/// integrated loudness (LUFS), loudness range (LU), true peak of the loudest channel (dBTP) and
/// loudness of the loudest 0.4 s (LUFS), by libebur128 (ITU-R BS.1770-4, EBU Tech 3341, 3342).
///
/// One channel counts once and two count both: the same signal in two channels is 3 LU louder.
#define _POSIX_C_SOURCE 200809L // fileno
#include "base/file.h"

#include <ebur128.h>
#include <math.h>
#include <sndfile.h>
#include <stdio.h>
#include <stdlib.h>

#define FRAMES 4800 // read at a time, and between two looks at the last 0.4 s

static void fail(const char *path, const char *why)
{
    fprintf(stderr, "loudness: %s: %s\n", path, why);
    exit(1);
}

static ebur128_state *read_all(const char *path, SNDFILE *file, const SF_INFO *info,
                               double *loudest)
{
    double here = 0;
    ebur128_state *state = ebur128_init((unsigned)info->channels, (unsigned long)info->samplerate,
                                        EBUR128_MODE_I | EBUR128_MODE_LRA | EBUR128_MODE_TRUE_PEAK);
    float *sound = malloc(sizeof *sound * FRAMES * (size_t)info->channels);
    if (!state || !sound)
        fail(path, "out of memory");
    for (sf_count_t n; (n = sf_readf_float(file, sound, FRAMES)) > 0;) {
        if (ebur128_add_frames_float(state, sound, (size_t)n) != EBUR128_SUCCESS ||
            ebur128_loudness_momentary(state, &here) != EBUR128_SUCCESS)
            fail(path, "libebur128 refuses it");
        *loudest = fmax(*loudest, here);
    }
    free(sound);
    return state;
}

static double loudest_peak(ebur128_state *state)
{
    double peak = 0;
    for (unsigned c = 0; c < state->channels; c++) {
        double here = 0;
        ebur128_true_peak(state, c, &here);
        peak = fmax(peak, here);
    }
    return peak;
}

static void measure(const char *path)
{
    himc_error error;
    SF_INFO info = {0};
    double lufs = 0, range = 0, loudest = -HUGE_VAL;
    FILE *stream = himc_file_read(path, &error);
    if (!stream)
        fail(path, error.text);
    SNDFILE *file = sf_open_fd(fileno(stream), SFM_READ, &info, SF_FALSE);
    if (!file)
        fail(path, sf_strerror(NULL));
    ebur128_state *state = read_all(path, file, &info, &loudest);
    ebur128_loudness_global(state, &lufs);
    ebur128_loudness_range(state, &range);
    printf("%.2f %.2f %.2f %.2f\n", lufs, range, 20 * log10(loudest_peak(state)), loudest);
    ebur128_destroy(&state);
    sf_close(file);
    fclose(stream);
}

int main(int count, char **argument)
{
    if (count < 2) {
        fprintf(stderr, "usage: loudness FILE...\n");
        return 2;
    }
    for (int i = 1; i < count; i++)
        measure(argument[i]);
    return 0;
}
