/// timbre.c: spectra of single strokes on a 23 inch timpano at D3, for timbre.gp: the same stroke
/// at three places, with four mallets, at three velocities.
///
/// Prints one block for each panel: frequency (Hz), then the spectrum of each sound (dB re 1 s of
/// full scale) over the first second. The window is the falling half of a Hann window, so that the
/// attack is included.
#include "himc/himc.h"
#include "himc/membrane.h"

#include <math.h>
#include <stdio.h>

#define RATE 48000
#define LENGTH RATE
#define RESOLUTION 2.0 // (Hz); chosen: the windows of one second resolve no more
#define HIGHEST 1600.0 // (Hz); chosen: the modes that are heard apart

typedef struct stroke {
    const char *mallet;
    double place, velocity; // distance from the centre per radius; (m/s)
} stroke;

static const stroke panels[3][4] = {
    {{"medium", 0.0, 3}, {"medium", 0.75, 3}, {"medium", 0.92, 3}, {NULL, 0, 0}},
    {{"soft", 0.75, 3}, {"medium", 0.75, 3}, {"hard", 0.75, 3}, {"wood", 0.75, 3}},
    {{"medium", 0.75, 0.5}, {"medium", 0.75, 2}, {"medium", 0.75, 8}, {NULL, 0, 0}},
};

static bool say(himc_drum *drum, const char *text, himc_error *error)
{
    himc_command command;
    return himc_command_parse_text(&command, HIMC_DRUM, text, error) &&
           himc_drum_command(drum, &command, error);
}

static bool sound_of(const stroke *b, double *sound, himc_error *error)
{
    char text[64];
    himc_drum *drum = himc_drum_new("figure", 23, RATE, error);
    if (!drum)
        return false;
    double radius = himc_membrane_head(himc_drum_membrane(drum))->radius;
    snprintf(text, sizeof text, "mallet %s", b->mallet);
    bool good = say(drum, text, error) && say(drum, "tune D3", error) &&
                himc_drum_strike_at(drum, 0, -b->place * radius, 0, b->velocity, error);
    for (int at = 0; good && at < LENGTH; at += 480) {
        himc_drum_advance(drum, 480, NULL, NULL, NULL);
        himc_drum_read(drum, (uint64_t)at, 480, sound + at, NULL);
    }
    for (int i = 0; i < LENGTH; i++)
        sound[i] *= 0.5 + 0.5 * cos(HIMC_PI * i / LENGTH);
    himc_drum_release(drum);
    return good;
}

// level of a windowed sound; the phasor (c, s) turns by w a sample
static double level(const double *windowed, double frequency)
{
    double w = 2 * HIMC_PI * frequency / RATE, re = 0, im = 0, c = 1, s = 0;
    double cos_w = cos(w), sin_w = sin(w);
    for (int i = 0; i < LENGTH; i++) {
        re += windowed[i] * c;
        im += windowed[i] * s;
        double next = c * cos_w - s * sin_w;
        s = s * cos_w + c * sin_w;
        c = next;
    }
    return 20 * log10(hypot(re, im) / RATE + 1e-12);
}

int main(void)
{
    static double sound[4][LENGTH];
    himc_error error;
    for (int p = 0; p < 3; p++) {
        int count = 0;
        for (; count < 4 && panels[p][count].mallet; count++)
            if (!sound_of(&panels[p][count], sound[count], &error)) {
                fprintf(stderr, "timbre: %s\n", error.text);
                return 1;
            }
        for (double f = 40; f <= HIGHEST; f += RESOLUTION) {
            printf("%g", f);
            for (int i = 0; i < count; i++)
                printf(" %.2f", level(sound[i], f));
            puts("");
        }
        puts("\n");
    }
    return 0;
}
