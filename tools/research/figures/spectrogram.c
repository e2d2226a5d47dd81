/// spectrogram.c: a sound file's spectrogram as numbers, for spectrograms.gp: `spectrogram FILE`.
///
/// A line has a time (s), a frequency (Hz) and the level (dB re full scale); the lines of one time
/// are a block. Hann windows of 4096 samples, one every 20 ms, by the Goertzel recurrence, which
/// computes only the frequencies that are drawn.
#define _POSIX_C_SOURCE 200809L // fileno
#include "base/file.h"

#include <math.h>
#include <sndfile.h>
#include <stdio.h>
#include <stdlib.h>

// all chosen for the picture: a window resolves the modes (12 Hz) and the strokes of a roll (85 ms)
#define WINDOW 4096
#define HOP 0.020      // (s)
#define RESOLUTION 8.0 // (Hz)
#define HIGHEST 1400.0 // (Hz)
#define LEAST 1e-12    // power: -120 dB

static void fail(const char *what)
{
    fprintf(stderr, "spectrogram: %s\n", what);
    exit(1);
}

// the first channel
static double *read_sound(const char *path, SF_INFO *info)
{
    himc_error error;
    FILE *stream = himc_file_read(path, &error);
    if (!stream)
        fail(error.text);
    SNDFILE *file = sf_open_fd(fileno(stream), SFM_READ, info, SF_FALSE);
    if (!file)
        fail(sf_strerror(NULL));
    double *all = malloc(sizeof(double) * (size_t)info->frames * (size_t)info->channels);
    if (!all || sf_readf_double(file, all, info->frames) != info->frames)
        fail("cannot read the whole file");
    sf_close(file);
    fclose(stream);
    for (sf_count_t i = 0; i < info->frames; i++)
        all[i] = all[i * info->channels];
    return all;
}

// power of the windowed sound at w (rad/sample), full scale being 1
static double power(const double *windowed, double w)
{
    double turn = 2 * cos(w), before = 0, here = 0;
    for (int i = 0; i < WINDOW; i++) {
        double next = windowed[i] + turn * here - before;
        before = here;
        here = next;
    }
    double sum = here * here + before * before - turn * here * before;
    return 16 * sum / ((double)WINDOW * WINDOW);
}

int main(int count, char **argument)
{
    SF_INFO info = {0};
    if (count != 2)
        fail("usage: spectrogram FILE");
    double *sound = read_sound(argument[1], &info), windowed[WINDOW];
    int hop = (int)(HOP * info.samplerate);
    for (sf_count_t at = 0; at + WINDOW <= info.frames; at += hop) {
        for (int i = 0; i < WINDOW; i++)
            windowed[i] = sound[at + i] * (0.5 - 0.5 * cos(2 * HIMC_PI * (i + 0.5) / WINDOW));
        double time = ((double)at + WINDOW / 2.0) / info.samplerate;
        for (double f = 40; f <= HIGHEST; f += RESOLUTION)
            printf("%.3f %g %.1f\n", time, f,
                   10 * log10(power(windowed, 2 * HIMC_PI * f / info.samplerate) + LEAST));
        puts("");
    }
    free(sound);
    return 0;
}
