/// fit_strike.c: which drum and which mallet have sounded, by the spectrum of the blow.
///
/// The performer strikes each drum that may be it with every mallet, mf, then the nearest two from
/// soft to strong, heard by two ears. The first 60 ms are compared in half octaves, their means
/// made alike, in which what the recording has as noise counts as such in both.
#include "cli.h"
#include "fit_drum.h"

#include "himc/drum.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LENGTH 0.06 // (s) of the blow; chosen: contacts last 2 to 12 ms
#define LOW 56.0    // (Hz) of the first band
#define BANDS 14    // half octaves, to 7 kHz
#define LINES 12    // frequencies in each
#define DYNAMICS 5
#define MIDDLE 2
#define FINALISTS 2 // drums whose blows are tried at all dynamics
#define LIKELY 0.08 // (dB of the spectrum per dB of the partials) chosen
#define HEARD 1.1   // (s) a beat, and as long as a stroke must be
#define BLOCK 1024
#define MALLETS 4

typedef struct spectrum {
    double power[BANDS];
} spectrum;

// of one channel, in a window that falls to 0
static void add_spectrum(const double *x, size_t length, double rate, spectrum *s)
{
    for (int b = 0; b < BANDS; b++)
        for (int l = 0; l < LINES; l++) {
            double f = LOW * pow(2, 0.5 * (b + (l + 0.5) / LINES)), re = 0, im = 0;
            double turn = 2 * HIMC_PI * f / rate, c = cos(turn), sine = sin(turn), u = 1, v = 0;
            for (size_t i = 0; i < length && f < 0.45 * rate; i++) {
                double value = x[i] * (1 + cos(HIMC_PI * (double)i / (double)length)), next;
                re += value * u;
                im += value * v;
                next = u * c - v * sine;
                v = u * sine + v * c;
                u = next;
            }
            s->power[b] += (re * re + im * im) * pow(2, 0.5 * b);
        }
}

bool fit_hear(himc_drum *drum, double x, double speed, double seconds, partials_sound *out,
              himc_error *error)
{
    double rate = himc_drum_rate(drum), row[BLOCK];
    size_t frames = (size_t)(seconds * rate);
    float *heard = calloc(2 * (frames + BLOCK), sizeof *heard);
    bool good = heard ? himc_drum_strike_at(drum, 0, x, 0, speed, error)
                      : himc_error_set(error, "out of memory");
    for (size_t at = 0; good && at < frames; at += BLOCK) {
        himc_drum_advance(drum, BLOCK, NULL, NULL, NULL);
        for (int c = 0; c < 2; c++) {
            himc_drum_read_channel(drum, c, at, BLOCK, row);
            for (size_t i = 0; i < BLOCK; i++)
                heard[2 * (at + i) + (size_t)c] = (float)row[i];
        }
    }
    good = good && partials_add(out, heard, frames, 2, rate, "the drum made", error);
    free(heard);
    return good;
}

// a performance in which the drum is struck once
static himc_performance *perform(const fit_drum *d, int mallet, int dynamic, double rate,
                                 himc_error *error)
{
    char stroke[64];
    snprintf(stroke, sizeof stroke, "stroke 1 right legato %s", fit_dynamics[dynamic]);
    himc_performance_config config = himc_performance_default();
    config.sample_rate = rate;
    config.physics_rate = fmin(config.physics_rate, rate);
    config.heard = true;
    himc_performance *p = himc_performance_new(&config, error);
    himc_drum *drum = p ? fit_drum_make(d, mallet, rate, error) : NULL;
    bool good = drum && himc_performance_add_drum(p, drum, error) &&
                cli_tell(p, "tempo 120", NULL, error) && cli_tell(p, stroke, NULL, error) &&
                cli_tell(p, "play", NULL, error);
    himc_drum_release(drum);
    if (good)
        return p;
    himc_performance_free(p);
    return NULL;
}

// what is heard of it until a little after the blow
static bool blow(const fit_drum *d, int mallet, int dynamic, double rate, spectrum *out,
                 himc_error *error)
{
    size_t frames = (size_t)(HEARD * rate);
    float *heard = calloc(2 * (frames + BLOCK), sizeof *heard);
    himc_performance *p = heard ? perform(d, mallet, dynamic, rate, error) : NULL;
    partials_sound sound = {.tracks = 0};
    bool good = heard || himc_error_set(error, "out of memory");
    if (p)
        himc_performance_read(p, heard, 2, (int)frames);
    good = good && p && partials_add(&sound, heard, frames, 2, rate, "the drum made", error);
    *out = (spectrum){{0}};
    for (int i = 0; i < sound.tracks; i++)
        add_spectrum(sound.track[i], (size_t)(LENGTH * rate), rate, out);
    partials_sound_free(&sound);
    himc_performance_free(p);
    free(heard);
    return good;
}

// RMS over the bands (dB), the mean set aside
static double apart(const spectrum *found, const spectrum *noise, const spectrum *made)
{
    double difference[BANDS], mean = 0, sum = 0, offset = 0, weight = 0;
    for (int round = 0; round < 4; round++) {
        mean = weight = 0;
        for (int b = 0; b < BANDS; b++) {
            double floor = 4 * noise->power[b] + 1e-12 * found->power[0];
            double level = 10 * log10(found->power[b] + floor);
            difference[b] = level - 10 * log10(made->power[b] * pow(10, 0.1 * offset) + floor);
            double w = found->power[b] / (found->power[b] + floor);
            mean += w * difference[b];
            weight += w;
        }
        offset += mean / weight;
    }
    for (int b = 0; b < BANDS; b++)
        sum += difference[b] * difference[b];
    return sqrt(sum / BANDS);
}

// tries all mallets at some dynamics, and keeps what is nearer
static bool try_blows(const spectrum *found, const spectrum *noise, double rate, int from, int to,
                      fit_drum *d, himc_error *error)
{
    spectrum made;
    for (int i = MALLETS * from; i < MALLETS * to; i++) {
        int mallet = i % MALLETS, dynamic = i / MALLETS;
        if (!blow(d, mallet, dynamic, rate, &made, error))
            return false;
        double here = apart(found, noise, &made);
        if (here < d->distance) {
            if (mallet != d->mallet) {
                d->next = d->distance;
                d->other = d->mallet;
            }
            d->distance = here;
            d->mallet = mallet;
            d->dynamic = dynamic;
        } else if (mallet != d->mallet && here < d->next) {
            d->next = here;
            d->other = mallet;
        }
    }
    return true;
}

static double unlike(const fit_drum *d)
{
    return d->distance - LIKELY * d->score;
}

bool fit_drum_strike(const partials_sound *sound, const fit_drum *choice, int count, fit_drum *out,
                     himc_error *error)
{
    spectrum found = {{0}}, noise = {{0}};
    size_t length = (size_t)(LENGTH * sound->rate);
    for (int i = 0; i < sound->tracks; i++) {
        add_spectrum(sound->track[i], length, sound->rate, &found);
        add_spectrum(sound->track[i] + sound->length[i] - length, length, sound->rate, &noise);
    }
    fit_drum likely[FINALISTS];
    int kept = 0;
    for (int i = 0; i < count; i++) {
        fit_drum d = choice[i];
        d.distance = d.next = INFINITY;
        d.mallet = d.other = -1;
        if (!try_blows(&found, &noise, sound->rate, MIDDLE, MIDDLE + 1, &d, error))
            return false;
        int k = kept < FINALISTS ? kept++ : FINALISTS;
        for (; k > 0 && unlike(&d) < unlike(&likely[k - 1]); k--)
            if (k < FINALISTS)
                likely[k] = likely[k - 1];
        if (k < FINALISTS)
            likely[k] = d;
    }
    for (int i = 0; i < kept; i++) {
        if (!try_blows(&found, &noise, sound->rate, 0, MIDDLE, &likely[i], error) ||
            !try_blows(&found, &noise, sound->rate, MIDDLE + 1, DYNAMICS, &likely[i], error))
            return false;
        if (i == 0 || unlike(&likely[i]) < unlike(out))
            *out = likely[i];
    }
    return kept > 0;
}
