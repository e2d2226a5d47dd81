/// fit_strike.c: which drum and which mallet have sounded, by the spectrum of the blow.
///
/// The performer strikes each drum that may be it with every mallet, mf, in our room and in none,
/// then the nearest two from soft to strong, heard by two ears. The blow and its ring are compared
/// in half octaves, their means made alike, in which what the recording has as noise counts as such
/// in both. No two drums have the same noise of a stroke, so what is compared with is the mean over
/// several.
#include "cli.h"
#include "fit_drum.h"

#include "himc/drum.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SPANS 2
#define RINGS 0.06  // (s) to here is the blow; chosen: contacts last 2 to 12 ms
#define LATEST 0.28 // (s) from there to here its ring; chosen
#define SEVERAL 2   // noises of a stroke by which drums are chosen ...
#define MANY 8      // ... and mallets; chosen: of 30 mallets 6 are missed with 2, 1 with 6
#define LOW 56.0    // (Hz) of the first band
#define BANDS 14    // half octaves, to 7 kHz
#define LINES 24    // frequencies in each
#define DYNAMICS 5
#define MIDDLE 2
#define FINALISTS 2    // drums whose blows are tried at all dynamics
#define LIKELY 0.08    // (dB of the spectrum per dB of the partials) chosen
#define HEARD 1.1      // (s) a beat, and as long as a stroke must be, ...
#define PLAYED 0.85    // (s) ... silent from here on
#define PHYSICS 2000.0 // (Hz) chosen: distances as with 10 kHz, in two thirds of the time
#define BLOCK 1024
#define MALLETS 4

typedef struct spectrum {
    double power[SPANS * BANDS]; // of the blow, of its ring
} spectrum;

// a phasor that turns on by some angle a sample
typedef struct phasor {
    double c, s, u, v;
} phasor;

static phasor turning(double angle)
{
    return (phasor){cos(angle), sin(angle), 1, 0};
}

static void turn(phasor *p)
{
    double next = p->u * p->c - p->v * p->s;
    p->v = p->u * p->s + p->v * p->c;
    p->u = next;
}

// of x, in a window that falls to 0, or also rises from it
static void add_span(const double *x, size_t length, bool rises, double rate, double power[BANDS])
{
    for (int b = 0; b < BANDS; b++) {
        double re[LINES] = {0}, im[LINES] = {0};
        phasor line[LINES], window = turning((rises ? 2 : 1) * HIMC_PI / (double)length);
        for (int l = 0; l < LINES; l++) {
            double angle = 2 * HIMC_PI * LOW * pow(2, 0.5 * (b + (l + 0.5) / LINES)) / rate;
            line[l] = turning(angle);
            line[l].u = angle < 0.9 * HIMC_PI;
        }
        for (size_t i = 0; i < length; i++) {
            double value = x[i] * (rises ? 1 - window.u : 1 + window.u);
            turn(&window);
            for (int l = 0; l < LINES; l++) {
                re[l] += value * line[l].u;
                im[l] += value * line[l].v;
                turn(&line[l]);
            }
        }
        for (int l = 0; l < LINES; l++)
            power[b] += (re[l] * re[l] + im[l] * im[l]) * pow(2, 0.5 * b);
    }
}

// of one channel, from a place after which as much follows as the spans last
static void add_spectrum(const double *x, double rate, spectrum *s)
{
    size_t rings = (size_t)(RINGS * rate), latest = (size_t)(LATEST * rate);
    add_span(x, rings, false, rate, s->power);
    add_span(x + rings, latest - rings, true, rate, s->power + BANDS);
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

// a performance in which the drum is struck once, with that noise
static himc_performance *perform(const fit_drum *d, int mallet, int dynamic, int seed, double rate,
                                 himc_error *error)
{
    char stroke[64], noise[64];
    snprintf(noise, sizeof noise, "fit noise 1 %d", (int)HIMC_SEED_MAX - seed);
    snprintf(stroke, sizeof stroke, "stroke 1 right legato %s", fit_dynamics[dynamic]);
    himc_performance_config config = himc_performance_default();
    config.sample_rate = rate;
    config.physics_rate = PHYSICS;
    config.heard = true;
    himc_performance *p = himc_performance_new(&config, error);
    himc_drum *drum = p ? fit_drum_make(d, mallet, rate, error) : NULL;
    bool good =
        drum && himc_performance_add_drum(p, drum, error) && cli_tell(p, noise, NULL, error) &&
        (!d->dry || cli_tell(p, "room 0", NULL, error)) && cli_tell(p, "tempo 120", NULL, error) &&
        cli_tell(p, stroke, NULL, error) && cli_tell(p, "play", NULL, error);
    himc_drum_release(drum);
    if (good)
        return p;
    himc_performance_free(p);
    return NULL;
}

// what is heard of it, the mean over some noises
static bool blow(const fit_drum *d, int mallet, int dynamic, int noises, double rate, spectrum *out,
                 himc_error *error)
{
    size_t frames = (size_t)(HEARD * rate);
    float *heard = calloc(2 * (frames + BLOCK), sizeof *heard);
    bool good = heard || himc_error_set(error, "out of memory");
    *out = (spectrum){{0}};
    for (int seed = 1; good && seed <= noises; seed++) {
        himc_performance *p = perform(d, mallet, dynamic, seed, rate, error);
        partials_sound sound = {.tracks = 0};
        if (p)
            himc_performance_read(p, heard, 2, (int)(PLAYED * rate));
        good = p && partials_add(&sound, heard, frames, 2, rate, "the drum made", false, error);
        for (int i = 0; i < sound.tracks; i++)
            add_spectrum(sound.track[i], rate, out);
        partials_sound_free(&sound);
        himc_performance_free(p);
    }
    for (int b = 0; b < SPANS * BANDS; b++)
        out->power[b] /= noises;
    free(heard);
    return good;
}

// RMS over the bands (dB), the mean set aside
static double apart(const spectrum *found, const spectrum *noise, const spectrum *made)
{
    double difference[SPANS * BANDS], mean = 0, sum = 0, offset = 0, weight = 0;
    for (int round = 0; round < 4; round++) {
        mean = weight = 0;
        for (int b = 0; b < SPANS * BANDS; b++) {
            double power = found->power[b];
            double floor = 4 * noise->power[b] + 1e-12 * found->power[b - b % BANDS];
            double level = 10 * log10(power + floor);
            difference[b] = level - 10 * log10(made->power[b] * pow(10, 0.1 * offset) + floor);
            double w = power / (power + floor);
            mean += w * difference[b];
            weight += w;
        }
        offset += mean / weight;
    }
    for (int b = 0; b < SPANS * BANDS; b++)
        sum += difference[b] * difference[b];
    return sqrt(sum / (SPANS * BANDS));
}

// a recorded blow, what is heard before or after it, and by how many noises blows are made
typedef struct target {
    spectrum found, noise;
    double rate;
    int noises;
} target;

// strikes with a mallet and keeps what is nearer; how near it is, or a negative number
static double try_blow(const target *t, int mallet, int dynamic, fit_drum *d, himc_error *error)
{
    spectrum made;
    if (!blow(d, mallet, dynamic, t->noises, t->rate, &made, error))
        return -1;
    double here = apart(&t->found, &t->noise, &made);
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

// with every mallet, mf
static bool try_mallets(const target *t, fit_drum *d, double here[MALLETS], himc_error *error)
{
    d->distance = d->next = INFINITY;
    d->mallet = d->other = -1;
    for (int m = 0; m < MALLETS; m++)
        if ((here[m] = try_blow(t, m, MIDDLE, d, error)) < 0)
            return false;
    return true;
}

// from mf on softer, else louder, as long as that comes nearer
static bool try_dynamics(const target *t, int mallet, double middle, fit_drum *d, himc_error *error)
{
    for (int way = -1; way <= 1; way += 2) {
        double last = middle;
        for (int i = MIDDLE + way; i >= 0 && i < DYNAMICS; i += way) {
            double here = try_blow(t, mallet, i, d, error);
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
    target t = {.rate = sound->rate, .noises = SEVERAL};
    size_t length = (size_t)(LATEST * sound->rate);
    for (int i = 0; i < sound->tracks; i++) {
        add_spectrum(sound->track[i], sound->rate, &t.found);
        add_spectrum(sound->track[i] + sound->length[i] - length, sound->rate, &t.noise);
    }
    fit_drum likely[FINALISTS];
    double here[MALLETS];
    int kept = 0;
    for (int i = 0; i < count; i++) {
        fit_drum d = choice[i], dry = d;
        dry.dry = true;
        if (!try_mallets(&t, &d, here, error) || !try_mallets(&t, &dry, here, error))
            return false;
        if (dry.distance < d.distance)
            d = dry;
        int k = kept < FINALISTS ? kept++ : FINALISTS;
        for (; k > 0 && unlike(&d) < unlike(&likely[k - 1]); k--)
            if (k < FINALISTS)
                likely[k] = likely[k - 1];
        if (k < FINALISTS)
            likely[k] = d;
    }
    t.noises = MANY;
    for (int i = 0; i < kept; i++) {
        fit_drum *d = &likely[i];
        if (!try_mallets(&t, d, here, error))
            return false;
        for (int m = 0; m < MALLETS; m++)
            if (!try_dynamics(&t, m, here[m], d, error))
                return false;
        if (i == 0 || unlike(d) < unlike(out))
            *out = *d;
    }
    return kept > 0;
}
