/// partials_sound.c: recordings of one stroke each, from the onset on; a bad one is refused.
#define _POSIX_C_SOURCE 200809L // fileno
#include "partials.h"
#include "sound_file.h"

#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CELL 0.005        // (s) of the envelope
#define SILENT 1e-4       // peak, -80 dB of full scale
#define OFFSET 1e-3       // mean per peak: more is no stroke's
#define BEGINS 0.1        // of the peak: there a stroke has begun
#define NEAR_LOUDEST 0.25 // of a cell's level
#define LEAST 0.5         // (s) after the onset
#define LONGEST 20.0      // (s) of it that is used
#define READ_LONGEST 300  // (s) of a file
#define NOISY (-20.0)     // (dB) noise beside the first .5 s
#define STEADY 0.5        // level at the end per that at the onset: nothing was struck
#define FLAT 4            // samples of one value at the peak ...
#define FLATS 3           // ... so often are no chance
#define RISE 4.0          // of the envelope within 50 ms: another stroke ...
#define APART 0.12        // ... if it comes so late (s) ...
#define LOUD 0.1          // ... and is so loud, per peak
// A blow is heard in the second differences. Of 60 instruments single strokes have ratios up to
// 1.2, rolls and double strokes 1.5 to 6.
#define SOON 0.08       // (s) from here on ...
#define MEMORY 12       // ... of so many cells before ...
#define BLOW 1.35       // ... none was so loud, per now, ...
#define BRIGHT 0.5      // ... which is so loud, per the first blow
#define LOW_RATE 4000.0 // (Hz) at least, of `low`
#define LOW_TAPS 2.75   // half its filter's length (1/transition): Blackman's window, -74 dB

typedef struct stroke {
    const float *x;
    size_t frames, onset;
    int channels;
    double rate, peak;
    const char *name;
    double offset[PARTIALS_TRACKS]; // of each channel: what is taken out
} stroke;

static double at(const stroke *s, size_t frame, int channel)
{
    return (double)s->x[frame * (size_t)s->channels + (size_t)channel] - s->offset[channel];
}

// RMS of all channels over so many frames, fewer at the end
static double level(const stroke *s, size_t from, size_t frames)
{
    double sum = 0;
    size_t end = from + frames < s->frames ? from + frames : s->frames;
    for (size_t i = from; i < end; i++)
        for (int c = 0; c < s->channels; c++)
            sum += at(s, i, c) * at(s, i, c);
    return end > from ? sqrt(sum / ((double)(end - from) * s->channels)) : 0;
}

// the offset of the recorder, if it has one
static void find_offset(stroke *s)
{
    for (int c = 0; c < s->channels; c++) {
        double sum = 0, peak = 0;
        for (size_t i = 0; i < s->frames; i++) {
            sum += at(s, i, c) / (double)s->frames;
            peak = fmax(peak, fabs(at(s, i, c)));
        }
        s->offset[c] = fabs(sum) > OFFSET * peak ? sum : 0;
    }
}

// the peak, and where the sound first comes near the loudest cell's level
static void measure(stroke *s)
{
    size_t cell = (size_t)(CELL * s->rate);
    double loudest = 0;
    s->peak = 0;
    for (size_t i = 0; i < s->frames; i++)
        for (int c = 0; c < s->channels; c++)
            s->peak = fmax(s->peak, fabs(at(s, i, c)));
    for (size_t i = 0; i < s->frames; i += cell)
        loudest = fmax(loudest, level(s, i, cell));
    size_t first = 0;
    while (first < s->frames && level(s, first, cell) < NEAR_LOUDEST * loudest)
        first += cell;
    for (s->onset = first > cell ? first - cell : 0; s->onset < s->frames; s->onset++)
        for (int c = 0; c < s->channels; c++)
            if (fabs(at(s, s->onset, c)) >= BEGINS * s->peak)
                return;
}

static bool check_clipped(const stroke *s, himc_error *error)
{
    int flats = 0;
    for (int c = 0; c < s->channels; c++)
        for (size_t i = 0, run = 0; i < s->frames; i++) {
            bool flat = i > 0 && at(s, i, c) == at(s, i - 1, c);
            run = fabs(at(s, i, c)) < 0.98 * s->peak ? 0 : flat ? run + 1 : 1;
            flats += run == FLAT;
        }
    return flats < FLATS ||
           himc_error_set(error, "%s: clipped in %d places, expected a recording with headroom",
                          s->name, flats);
}

static bool check_one(const stroke *s, himc_error *error)
{
    size_t cell = (size_t)(CELL * s->rate), wide = 10 * cell;
    double loudest = level(s, s->onset, wide);
    for (size_t i = s->onset + (size_t)(APART * s->rate); i + wide < s->frames; i += cell) {
        double now = level(s, i, wide), before = level(s, i - wide, wide);
        if (now > RISE * before && now > LOUD * loudest)
            return himc_error_set(error, "%s: a second stroke %.2f s after the first, expected one",
                                  s->name, (double)(i + wide - s->onset) / s->rate);
    }
    return true;
}

// RMS of the second differences, in which ringing is weak and a blow is not
static double bright(const stroke *s, size_t from, size_t frames)
{
    double sum = 0;
    for (size_t i = from + 2; i < from + frames && i < s->frames; i++)
        for (int c = 0; c < s->channels; c++) {
            double d = at(s, i, c) - 2 * at(s, i - 1, c) + at(s, i - 2, c);
            sum += d * d;
        }
    return sqrt(sum / (double)frames);
}

// a second blow that the ringing of the first hides
static bool check_soon(const stroke *s, himc_error *error)
{
    size_t cell = (size_t)(2 * CELL * s->rate), cells = (s->frames - s->onset) / cell;
    double past[MEMORY] = {0}, first = 0;
    for (size_t k = 0; k < cells; k++) {
        double now = bright(s, s->onset + k * cell, cell), most = 0;
        for (int i = 0; i < MEMORY / 2; i++)
            most = fmax(most, past[(k + MEMORY - 2 - (size_t)i) % MEMORY]);
        if ((double)k * 2 * CELL < SOON)
            first = fmax(first, now);
        else if (now > BLOW * most && now > BRIGHT * first)
            return himc_error_set(error, "%s: a second stroke %.2f s after the first, expected one",
                                  s->name, (double)(k * cell) / s->rate);
        past[k % MEMORY] = now;
    }
    return true;
}

// what sounds before the onset (dB re the first .5 s); without a time before it nothing is known
static double noise_of(const stroke *s)
{
    size_t before = (size_t)(0.02 * s->rate);
    double sound = level(s, s->onset, (size_t)(LEAST * s->rate));
    double floor = s->onset > 4 * before ? level(s, 0, s->onset - before) : 0;
    return 20 * log10(fmax(floor, 1e-9 * sound) / sound);
}

static bool check(const stroke *s, double *noise, himc_error *error)
{
    double length = (double)(s->frames - s->onset) / s->rate;
    if (s->peak < SILENT)
        return himc_error_set(error, "%s: silence, expected a stroke", s->name);
    if (length < LEAST)
        return himc_error_set(error, "%s: %.2f s from the stroke on, expected %.1f or more",
                              s->name, length, LEAST);
    if (!check_clipped(s, error) || !check_one(s, error))
        return false;
    double here = noise_of(s);
    if (here > NOISY)
        return himc_error_set(error, "%s: noise at %.0f dB of the stroke, expected below %.0f dB",
                              s->name, here, NOISY);
    size_t part = s->frames / 20;
    double left = level(s, s->frames - part, part) / level(s, s->onset, part);
    if (left > STEADY && length > 2 * LEAST) // else it may still ring
        return himc_error_set(
            error, "%s: as loud at its end as at its beginning, expected a stroke", s->name);
    *noise = fmax(*noise, here);
    return true;
}

// a track at a lower rate: what is above PARTIALS_LOW is filtered out as far as it would come below
static double *thin(const double *x, size_t length, double rate, int step, size_t *left)
{
    double transition = rate / step - 2 * PARTIALS_LOW,
           turn = HIMC_PI / step; // stop: half the rate
    long half = (long)(LOW_TAPS * rate / transition), end = (long)length;
    *left = (length + (size_t)step - 1) / (size_t)step;
    double *out = malloc(sizeof *out * *left), *tap = malloc(sizeof *tap * (size_t)(2 * half + 1));
    double sum = 0;
    for (long i = -half; tap && i <= half; i++) {
        double t = HIMC_PI * (double)i / ((double)half + 1), angle = turn * (double)i;
        tap[i + half] = (0.42 + 0.5 * cos(t) + 0.08 * cos(2 * t)) * (i ? sin(angle) / angle : 1);
        sum += tap[i + half];
    }
    for (long at = 0, n = 0; out && tap && at < end; at += step, n++) {
        double value = 0;
        for (long i = at < half ? -at : -half; i <= half && at + i < end; i++)
            value += tap[i + half] * x[at + i];
        out[n] = value / sum;
    }
    bool good = out && tap;
    free(tap);
    if (good)
        return out;
    free(out);
    return NULL;
}

bool partials_add(partials_sound *sound, const float *samples, size_t frames, int channels,
                  double rate, const char *name, bool recorded, himc_error *error)
{
    stroke s = {.x = samples, .frames = frames, .channels = channels, .rate = rate, .name = name};
    if (sound->tracks == 0)
        sound->noise = -INFINITY;
    else if (sound->rate != rate)
        return himc_error_set(error, "%s: %.0f Hz, expected %.0f Hz as the others", name, rate,
                              sound->rate);
    if (sound->tracks + channels > PARTIALS_TRACKS)
        return himc_error_set(error, "%s: more than %d channels in all", name, PARTIALS_TRACKS);
    for (size_t i = 0; i < frames * (size_t)channels; i++)
        if (!isfinite(samples[i]))
            return himc_error_set(error, "%s: frame %zu is not a finite number", name,
                                  i / (size_t)channels);
    find_offset(&s);
    measure(&s);
    if (!check(&s, &sound->noise, error) || (recorded && !check_soon(&s, error)))
        return false;
    sound->rate = rate;
    sound->low = sound->low ? sound->low : calloc(1, sizeof *sound->low);
    size_t length = (size_t)fmin((double)(frames - s.onset), LONGEST * rate);
    int step = (int)(rate / LOW_RATE);
    for (int c = 0; c < channels; c++) {
        double *track = malloc(sizeof *track * length), *low = NULL;
        for (size_t i = 0; track && i < length; i++)
            track[i] = at(&s, s.onset + i, c) / s.peak;
        if (track && sound->low)
            low = thin(track, length, rate, step, &sound->low->length[sound->tracks]);
        if (!low) {
            free(track);
            return himc_error_set(error, "%s: out of memory", name);
        }
        sound->low->rate = rate / step;
        sound->low->track[sound->tracks] = low;
        sound->length[sound->tracks] = length;
        sound->track[sound->tracks] = track;
        sound->low->tracks = ++sound->tracks;
    }
    return true;
}

bool partials_read(partials_sound *sound, const char *path, himc_error *error)
{
    FILE *stream = himc_file_read(path, error);
    if (!stream)
        return false;
    SF_INFO info = {0};
    SNDFILE *file = sf_open_fd(fileno(stream), SFM_READ, &info, SF_FALSE);
    float *samples = NULL;
    bool good = file || himc_error_set(error, "%s: no sound file that libsndfile reads: %s", path,
                                       sf_strerror(NULL));
    if (good && (info.samplerate < 8000 || (double)info.frames > READ_LONGEST * info.samplerate))
        good = himc_error_set(error, "%s: %.1f s at %d Hz, expected up to %d s, at 8000 Hz or more",
                              path, (double)info.frames / info.samplerate, info.samplerate,
                              READ_LONGEST);
    if (good) {
        samples = malloc(sizeof *samples * ((size_t)info.frames + 1) * (size_t)info.channels);
        good = samples || himc_error_set(error, "%s: out of memory", path);
    }
    if (good) {
        sf_count_t read = sf_readf_float(file, samples, info.frames);
        good = partials_add(sound, samples, (size_t)(read < 0 ? 0 : read), info.channels,
                            info.samplerate, path, true, error);
    }
    free(samples);
    if (file)
        sf_close(file);
    fclose(stream);
    return good;
}

void partials_sound_free(partials_sound *sound)
{
    for (int i = 0; i < sound->tracks; i++)
        free(sound->track[i]);
    if (sound->low)
        partials_sound_free(sound->low);
    free(sound->low);
    *sound = (partials_sound){.tracks = 0};
}
