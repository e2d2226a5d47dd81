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
#define HEARD 1.1   // (s) a beat, and as long as a stroke must be, ...
#define PLAYED 0.65 // (s) ... silent from here on: the blow is over
#define BLOCK 1024
#define MALLETS 4

typedef struct spectrum {
    double power[BANDS];
} spectrum;

// of one channel, in a window that falls to 0
static void add_spectrum(const double *x, size_t length, double rate, spectrum *s)
{
    for (int b = 0; b < BANDS; b++) {
        double re[LINES] = {0}, im[LINES] = {0}, c[LINES], s1[LINES], u[LINES], v[LINES];
        for (int l = 0; l < LINES; l++) {
            double turn = 2 * HIMC_PI * LOW * pow(2, 0.5 * (b + (l + 0.5) / LINES)) / rate;
            c[l] = cos(turn), s1[l] = sin(turn), u[l] = turn < 0.9 * HIMC_PI, v[l] = 0;
        }
        for (size_t i = 0; i < length; i++) {
            double value = x[i] * (1 + cos(HIMC_PI * (double)i / (double)length));
            for (int l = 0; l < LINES; l++) {
                double next = u[l] * c[l] - v[l] * s1[l];
                re[l] += value * u[l];
                im[l] += value * v[l];
                v[l] = u[l] * s1[l] + v[l] * c[l];
                u[l] = next;
            }
        }
        for (int l = 0; l < LINES; l++)
            s->power[b] += (re[l] * re[l] + im[l] * im[l]) * pow(2, 0.5 * b);
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
    good = good && partials_add(out, heard, frames, 2, rate, "the drum made", false, error);
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
        himc_performance_read(p, heard, 2, (int)(PLAYED * rate));
    good = good && p && partials_add(&sound, heard, frames, 2, rate, "the drum made", false, error);
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

// strikes with a mallet and keeps what is nearer; how near it is, or a negative number
static double try_blow(const spectrum *found, const spectrum *noise, double rate, int mallet,
                       int dynamic, fit_drum *d, himc_error *error)
{
    spectrum made;
    if (!blow(d, mallet, dynamic, rate, &made, error))
        return -1;
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
    return here;
}

// from mf on softer, else louder, as long as that comes nearer
static bool try_dynamics(const spectrum *found, const spectrum *noise, double rate, int mallet,
                         double middle, fit_drum *d, himc_error *error)
{
    for (int way = -1; way <= 1; way += 2) {
        double last = middle;
        for (int i = MIDDLE + way; i >= 0 && i < DYNAMICS; i += way) {
            double here = try_blow(found, noise, rate, mallet, i, d, error);
            if (here < 0)
                return false;
            if (here > last)
                break;
            last = here;
        }
        if (last < middle)
            break;
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
    double middle[FINALISTS][MALLETS];
    int kept = 0;
    for (int i = 0; i < count; i++) {
        fit_drum d = choice[i];
        double here[MALLETS];
        d.distance = d.next = INFINITY;
        d.mallet = d.other = -1;
        for (int m = 0; m < MALLETS; m++)
            if ((here[m] = try_blow(&found, &noise, sound->rate, m, MIDDLE, &d, error)) < 0)
                return false;
        int k = kept < FINALISTS ? kept++ : FINALISTS;
        for (; k > 0 && unlike(&d) < unlike(&likely[k - 1]); k--)
            if (k < FINALISTS) {
                likely[k] = likely[k - 1];
                memcpy(middle[k], middle[k - 1], sizeof here);
            }
        if (k < FINALISTS) {
            likely[k] = d;
            memcpy(middle[k], here, sizeof here);
        }
    }
    for (int i = 0; i < kept; i++) {
        for (int m = 0; m < MALLETS; m++)
            if (!try_dynamics(&found, &noise, sound->rate, m, middle[i][m], &likely[i], error))
                return false;
        if (i == 0 || unlike(&likely[i]) < unlike(out))
            *out = likely[i];
    }
    return kept > 0;
}
