/// partials.c: onset, sub-bands, ESPRIT in each, and what of it is kept.
///
/// A band of 80 Hz (above 1.2 kHz 300 Hz) is shifted to 0, filtered and decimated; in each of three
/// windows that begin one after the other, ESPRIT (base/linear.h) finds its poles, in all channels
/// of all strokes at once. A pole is kept if it decays, rings for 40 ms or more, is not 55 dB below
/// the strongest, and is found again in a later window; how far it moves there is its error. Two
/// nearer than 1.25 Hz are one (the resolution of Gallardo et al. 2020) unless their decays differ.
///
/// A room adds poles of its own everywhere, a few per hertz. What stands out of the middle of its
/// neighbours' energies by some 10 dB (`clear`) is the instrument's.
#include "partials.h"

#include "base/linear.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LOWEST 30.0        // (Hz)
#define NARROW 80.0        // width of a band (Hz) ...
#define WIDE 300.0         // ... and from WIDE_FROM on (Hz)
#define WIDE_FROM 1230.0   // LOWEST and a whole number of bands
#define TRANSITION 0.75    // from pass to stop, per width
#define TAPS 1.9           // half the filter's length (1/transition): Blackman's window, -60 dB
#define SPAN 500           // decimated samples of a window, at most
#define SPAN_LEAST 40      // ... and at least
#define WINDOWS 3          // compared
#define ORDER 30           // most poles in a band
#define CLEAR 8.0          // eigenvalue over the noise's that counts; chosen
#define T60_LEAST 0.04     // (s)
#define EMPTY 3e-8         // power of a band with nothing in it, per the sound's (-75 dB)
#define LEVEL_LEAST (-55.) // (dB)
#define MERGED 1.25        // (Hz)
#define DECAYS_DIFFER 0.35 // of ln T60
#define LATE 1.0           // (s) chosen: of a timpano's blow its lasting partials are left
#define AROUND 60.0        // (Hz) neighbours on either side, or ...
#define PAIR 10.0          // (Hz) around a pair of a drum's modes ...
#define PAIR_SECONDS 5.0   // ... in a window at most so long ...
#define PAIR_PART 0.8      // ... or so much of T60, at least 1 s ...
#define SINGLE 0.02        // (Hz) nearer ones are one
#define PAIR_LEAST 20      // ... of so many decimated samples or more
#define NOISE_MOST 1e6     // noise is softer than the room at first, at most by this ...
#define NOISE_STEP 10.0    // ... and tried in such steps ...
#define NOISE_DECAYS 8     // ... with each so-manyth decay
#define AROUND_PART 0.12   // ... so much of the frequency

// windows that are compared: `first` (s) after the onset (the contact is over), each `next` later
typedef struct windows {
    double first, next;
    int span;       // decimated samples, at most
    double highest; // (Hz) of the bands
    double t60;     // (s) of partials that are known from these alone
} windows;

static const windows sets[] = {{0.01, 0.04, 300, INFINITY, 0}, {0.6, 0.15, SPAN, WIDE_FROM, 1.2}};
#define SETS (sizeof sets / sizeof *sets)

// (s) from the onset to windows that overlap and share their weight; to the last ones per T60 of
// the room, at most 1 s: its answer biases decays, while tunings need what is left of a pair
#define LIKELY_WINDOWS 2
static const double from_onset[][LIKELY_WINDOWS] = {{0.03, 0.1}, {0.5, 1.0}, {0.6, 1.2}};

// of a pair, per the usual one: each head is uneven in its own way
static const double splits[] = {0, 0.5, 1, 1.5, 2};

typedef struct band {
    const partials_sound *sound;
    double centre, width; // (Hz)
    int step, half;       // decimation, filter
    double *tap;          // (2 half + 1) filter, turning by the centre: real parts ...
    double *turning;      // ... and imaginary ones
    double *z;            // (tracks, samples, 2)
    int samples, tracks;
    double weight[SPAN]; // of samples, in left_by
} band;

typedef struct pole {
    double frequency, decay, level;
} pole;

static bool band_open(band *b, double centre, double width, const partials_sound *all)
{
    const partials_sound *sound =
        centre + (0.5 + TRANSITION) * width < PARTIALS_LOW ? all->low : all;
    b->sound = sound;
    b->width = width;
    b->centre = centre;
    double transition = TRANSITION * b->width, stop = 0.5 * (b->width + transition), sum = 0;
    b->half = (int)(TAPS * sound->rate / transition);
    b->step = (int)fmax(1, sound->rate / (b->width + 2 * transition));
    b->tap = malloc(sizeof *b->tap * (size_t)(2 * b->half + 1));
    b->turning = malloc(sizeof *b->turning * (size_t)(2 * b->half + 1));
    b->z = malloc(sizeof *b->z * 2 * SPAN * PARTIALS_TRACKS);
    if (!b->tap || !b->turning || !b->z)
        return false;
    for (int i = -b->half; i <= b->half; i++) {
        double t = i / (b->half + 1.0), angle = 2 * HIMC_PI * stop * i / sound->rate;
        double window = 0.42 + 0.5 * cos(HIMC_PI * t) + 0.08 * cos(2 * HIMC_PI * t);
        sum += b->tap[i + b->half] = window * (i ? sin(angle) / angle : 1);
    }
    for (int i = 0; i <= 2 * b->half; i++) {
        double angle = -2 * HIMC_PI * b->centre * (i - b->half) / sound->rate;
        b->turning[i] = b->tap[i] / sum * sin(angle);
        b->tap[i] *= cos(angle) / sum;
    }
    return true;
}

static void band_close(band *b)
{
    free(b->tap);
    free(b->turning);
    free(b->z);
}

// one filtered sample of the band, its centre at 0 Hz
static void band_sample(const band *b, const double *x, double angle, double out[2])
{
    double re = 0, im = 0, c = cos(angle), s = sin(angle);
    for (int i = 0; i <= 2 * b->half; i++) {
        re += b->tap[i] * x[i];
        im += b->turning[i] * x[i];
    }
    out[0] = c * re - s * im;
    out[1] = c * im + s * re;
}

// fills z from a track's sample `from` on; false if the tracks are too short
static bool band_fill(band *b, size_t from, int span, int least)
{
    const partials_sound *sound = b->sound;
    double turn = -2 * HIMC_PI * b->centre / sound->rate;
    size_t shortest = sound->length[0];
    for (int i = 1; i < sound->tracks; i++)
        shortest = sound->length[i] < shortest ? sound->length[i] : shortest;
    long room = ((long)shortest - (long)from - b->half) / b->step;
    b->samples = room < span ? (int)room : span;
    b->tracks = sound->tracks;
    if (b->samples < least)
        return false;
    for (int i = 0; i < sound->tracks; i++)
        for (int n = 0; n < b->samples; n++)
            band_sample(b, sound->track[i] + from - b->half + (size_t)n * (size_t)b->step,
                        turn * (double)(from + (size_t)n * (size_t)b->step),
                        &b->z[2 * ((size_t)i * (size_t)b->samples + (size_t)n)]);
    return true;
}

// whether the band has nothing that would be kept: its mean power beside the sound's
static bool is_empty(const band *b, size_t from)
{
    double power = 0, all = 0;
    size_t length = (size_t)b->samples * (size_t)b->step;
    for (int i = 0; i < 2 * b->samples * b->tracks; i++)
        power += b->z[i] * b->z[i] / b->samples;
    for (int i = 0; i < b->tracks; i++)
        for (size_t n = from; n < from + length; n++)
            all += b->sound->track[i][n] * b->sound->track[i][n] / (double)length;
    return !(power > EMPTY * all);
}

// the poles within the band's width whose sound decays
static int find_poles(band *b, double start, int span, pole *out, himc_linear *outcome)
{
    const partials_sound *sound = b->sound;
    double p[2 * ORDER], c[2 * ORDER * PARTIALS_TRACKS], rate = sound->rate / b->step;
    int found = 0, kept = 0;
    size_t from = (size_t)(start * sound->rate) + (size_t)b->half;
    if (!band_fill(b, from, span, SPAN_LEAST) || is_empty(b, from))
        return 0;
    int most = b->samples / 4 < ORDER ? b->samples / 4 : ORDER;
    *outcome = himc_linear_exponentials(b->samples, b->tracks, b->z, most, CLEAR, p, c, &found);
    for (int k = 0; *outcome == HIMC_LINEAR_SOLVED && k < found; k++) {
        double size = hypot(p[2 * k], p[2 * k + 1]), aside = atan2(p[2 * k + 1], p[2 * k]);
        pole q = {b->centre + aside * rate / (2 * HIMC_PI), -log(size) * rate, 0};
        double power = 0, since = (double)from / sound->rate;
        for (int i = 0; i < b->tracks; i++) {
            const double *a = &c[2 * (i * found + k)];
            power += a[0] * a[0] + a[1] * a[1];
        }
        if (fabs(q.frequency - b->centre) > 0.5 * b->width || !(q.decay > 0) ||
            log(1000) / q.decay < T60_LEAST || !(power > 0))
            continue;
        q.level = 10 * log10(4 * power / sound->tracks) + 20 * q.decay * since / log(10);
        out[kept++] = q;
    }
    return kept;
}

// the same pole in a later window, or NULL
static const pole *again(const pole *p, const pole *later, int count)
{
    const pole *best = NULL;
    double apart = MERGED;
    for (int i = 0; i < count; i++) {
        double d = fabs(later[i].frequency - p->frequency) +
                   fabs(log(later[i].decay / p->decay)); // an octave of decay as 0.7 Hz
        if (d < apart) {
            apart = d;
            best = &later[i];
        }
    }
    return best;
}

// the partial that a pole and those of later windows are; false if it is found once only
static bool make_partial(const pole *p, pole later[WINDOWS][ORDER], const int *count, partial *out)
{
    double f = p->frequency, d = log(p->decay), ff = f * f, dd = d * d;
    int n = 1;
    for (int w = 1; w < WINDOWS; w++) {
        const pole *q = again(p, later[w], count[w]);
        if (!q)
            continue;
        f += q->frequency;
        ff += q->frequency * q->frequency;
        d += log(q->decay);
        dd += log(q->decay) * log(q->decay);
        n++;
    }
    if (n == 1)
        return false;
    f /= n;
    d /= n;
    *out = (partial){.frequency = f,
                     .t60 = log(1000) / exp(d),
                     .frequency_error = sqrt(fmax(0, ff / n - f * f) * n / (n - 1.0)),
                     .level = p->level};
    out->t60_error = out->t60 * sqrt(fmax(0, dd / n - d * d) * n / (n - 1.0));
    out->energy = out->level + 10 * log10(out->t60);
    return true;
}

static bool find_in_band(const partials_sound *sound, double low, const windows *set,
                         partials_list *out, double *width, himc_error *error)
{
    band b = {0};
    pole found[WINDOWS][ORDER];
    int count[WINDOWS] = {0};
    *width = low < WIDE_FROM ? NARROW : WIDE;
    himc_linear outcome = band_open(&b, low + 0.5 * *width, *width, sound) ? HIMC_LINEAR_SOLVED
                                                                           : HIMC_LINEAR_NO_MEMORY;
    for (int w = 0; w < WINDOWS && outcome != HIMC_LINEAR_NO_MEMORY; w++)
        count[w] = find_poles(&b, set->first + w * set->next, set->span, found[w], &outcome);
    band_close(&b);
    if (outcome == HIMC_LINEAR_NO_MEMORY)
        return himc_error_set(error, "out of memory");
    for (int i = 0; i < count[0] && out->count < PARTIALS_MOST; i++) {
        partial *p = &out->row[out->count];
        out->count += make_partial(&found[0][i], found, count, p) && p->t60 > set->t60;
    }
    return true;
}

// what a later set knows better
static void forget(partials_list *p, double from, double to, double t60)
{
    int kept = 0;
    for (int i = 0; i < p->count; i++)
        if (p->row[i].t60 < t60 || p->row[i].frequency < from || p->row[i].frequency > to)
            p->row[kept++] = p->row[i];
    p->count = kept;
}

static int by_frequency(const void *a, const void *b)
{
    const partial *p = a, *q = b;
    return (p->frequency > q->frequency) - (p->frequency < q->frequency);
}

static int by_value(const void *a, const void *b)
{
    const double *p = a, *q = b;
    return (*p > *q) - (*p < *q);
}

// of two that are one the stronger stays; what is too soft goes
static void merge(partials_list *p)
{
    double strongest = -INFINITY;
    int kept = 0;
    qsort(p->row, (size_t)p->count, sizeof *p->row, by_frequency);
    for (int i = 0; i < p->count; i++)
        strongest = fmax(strongest, p->row[i].energy);
    for (int i = 0; i < p->count; i++) {
        partial *last = &p->row[kept ? kept - 1 : 0], *now = &p->row[i];
        if (now->energy < strongest + LEVEL_LEAST)
            continue;
        bool one = kept > 0 && now->frequency - last->frequency < MERGED &&
                   fabs(log(now->t60 / last->t60)) < DECAYS_DIFFER;
        if (!one)
            p->row[kept++] = *now;
        else if (now->energy > last->energy)
            *last = *now;
    }
    p->count = kept;
}

// level after so long (dB)
static double later(const partial *p, double seconds)
{
    return p->level - 60 * seconds / p->t60;
}

// what a value stands out by of the middle one of `count`, which are sorted
static double out_of(double value, double *others, int count)
{
    qsort(others, (size_t)count, sizeof *others, by_value);
    return count < 4 ? -LEVEL_LEAST : value - others[count / 2];
}

static void compare_neighbours(partials_list *p)
{
    double energy[PARTIALS_MOST], late[PARTIALS_MOST];
    int n = 0;
    for (int i = 0; i < p->count; i++) {
        partial *own = &p->row[i];
        double around = fmax(AROUND, AROUND_PART * own->frequency);
        n = 0;
        for (int k = 0; k < p->count; k++) {
            const partial *other = &p->row[k];
            if (k == i || fabs(other->frequency - own->frequency) > around)
                continue;
            energy[n] = other->energy;
            late[n++] = later(other, LATE);
        }
        own->clear = fmax(out_of(own->energy, energy, n), out_of(later(own, LATE), late, n));
    }
    n = 0;
    for (int i = 0; i < p->count; i++)
        if (p->row[i].clear < 0)
            late[n++] = p->row[i].t60;
    qsort(late, (size_t)n, sizeof *late, by_value);
    p->room = n < 10 ? 0 : late[n / 2];
}

bool partials_find(const partials_sound *sound, double highest, partials_list *out,
                   himc_error *error)
{
    double width;
    out->count = 0;
    highest = fmin(highest, 0.45 * sound->rate - WIDE);
    for (size_t i = 0; i < SETS; i++)
        for (double low = LOWEST; low < fmin(highest, sets[i].highest); low += width) {
            partials_list later = {.count = 0};
            if (!find_in_band(sound, low, &sets[i], &later, &width, error))
                return false;
            if (later.count > 0)
                forget(out, low, low + width, sets[i].t60 > 0 ? sets[i].t60 : INFINITY);
            for (int k = 0; k < later.count && out->count < PARTIALS_MOST; k++)
                out->row[out->count++] = later.row[k];
        }
    merge(out);
    compare_neighbours(out);
    return true;
}

/// Two damped sinusoids of one decay in a narrow band, by least squares in all channels: with the
/// amplitudes solved for, `at` is the middle, half the difference (Hz) and ln of the decay (1/s).
/// Returns the share of the energy that they leave.
static double left_by(const band *b, double rate, const double at[3])
{
    double turn[2][2], gram = 0, cross[2] = {0}, power[2] = {1, 0}, left = 0, all = 0;
    double product[PARTIALS_TRACKS][2][2] = {{{0}}}, of[2][2] = {{1, 0}, {1, 0}};
    for (int k = 0; k < 2; k++) {
        double angle = 2 * HIMC_PI * (at[0] + (k ? -at[1] : at[1])) / rate;
        turn[k][0] = exp(-exp(at[2]) / rate) * cos(angle);
        turn[k][1] = exp(-exp(at[2]) / rate) * sin(angle);
    }
    for (int n = 0; n < b->samples; n++) {
        double w = b->weight[n];
        gram += w * (of[0][0] * of[0][0] + of[0][1] * of[0][1]);
        cross[0] += w * (of[0][0] * of[1][0] + of[0][1] * of[1][1]);
        cross[1] += w * (of[0][0] * of[1][1] - of[0][1] * of[1][0]);
        for (int c = 0; c < b->tracks; c++) {
            const double *z = &b->z[2 * (c * b->samples + n)];
            all += w * (z[0] * z[0] + z[1] * z[1]);
            for (int k = 0; k < 2; k++) {
                product[c][k][0] += w * (of[k][0] * z[0] + of[k][1] * z[1]);
                product[c][k][1] += w * (of[k][0] * z[1] - of[k][1] * z[0]);
            }
        }
        for (int k = 0; k < 2; k++) {
            power[0] = of[k][0] * turn[k][0] - of[k][1] * turn[k][1];
            of[k][1] = of[k][0] * turn[k][1] + of[k][1] * turn[k][0];
            of[k][0] = power[0];
        }
    }
    double det = gram * gram - cross[0] * cross[0] - cross[1] * cross[1];
    left = all;
    for (int c = 0; c < b->tracks; c++) {
        const double *p = product[c][0], *q = product[c][1];
        double pp = p[0] * p[0] + p[1] * p[1], qq = q[0] * q[0] + q[1] * q[1];
        // Re(conj(p) cross q)
        double pq = (p[0] * q[0] + p[1] * q[1]) * cross[0] - (p[0] * q[1] - p[1] * q[0]) * cross[1];
        left -= at[1] == 0 ? pp / gram : (gram * (pp + qq) - 2 * pq) / det;
    }
    return fmax(left, 0) / (all + 1e-30);
}

// What a pair leaves is the room's sound, which decays, and noise, which at the window's beginning
// is softer by `most`: each sample counts by them. Returns ln of the energy beside that weight's.
static double weigh(band *b, double rate, double room, double most)
{
    double energy = 0, logs = 0;
    for (int n = 0; n < b->samples; n++) {
        b->weight[n] = room > 0 ? 1 / (pow(1e-6, n / rate / room) + 1 / most) : 1;
        logs += log(b->weight[n]) / b->samples;
        for (int c = 0; c < b->tracks; c++) {
            const double *z = &b->z[2 * (c * b->samples + n)];
            energy += b->weight[n] * (z[0] * z[0] + z[1] * z[1]);
        }
    }
    return log(energy + 1e-30) - logs;
}

// at the noise that is likeliest, by some of the decays
static void weigh_likely(band *b, double rate, double room, double apart, const double *decay,
                         int decays)
{
    double likeliest = INFINITY, chosen = 1;
    for (double most = 1; room > 0 && most <= NOISE_MOST; most *= NOISE_STEP) {
        double energy = weigh(b, rate, room, most), least = 1;
        for (int i = 0; i < decays; i += NOISE_DECAYS)
            for (int k = 0; k < 2; k++) {
                double at[3] = {0, k * 0.5 * apart < SINGLE ? 0 : k * 0.5 * apart, log(decay[i])};
                least = fmin(least, left_by(b, rate, at));
            }
        if (energy + log(least + 1e-6) < likeliest) {
            likeliest = energy + log(least + 1e-6);
            chosen = most;
        }
    }
    weigh(b, rate, room, chosen);
}

bool partials_likely(const partials_sound *sound, partials_part part, double room, double frequency,
                     double apart, const double *shift, int shifts, const double *decay, int decays,
                     double *out, himc_error *error)
{
    band b = {0};
    if (!band_open(&b, frequency, fmax(PAIR, 2 * apart), sound)) {
        band_close(&b);
        return himc_error_set(error, "out of memory");
    }
    double rate = b.sound->rate / b.step;
    double span = fmin(PAIR_SECONDS, fmax(1, PAIR_PART * log(1000) / decay[decays / 2]));
    memset(out, 0, sizeof *out * (size_t)(shifts * decays));
    for (int w = 0; w < LIKELY_WINDOWS; w++) {
        double start = from_onset[part][w] * (part == PARTIALS_LAST ? fmin(room, 1) : 1);
        size_t from = (size_t)(start * b.sound->rate) + (size_t)b.half;
        if (!band_fill(&b, from, (int)fmin(SPAN, span * rate), PAIR_LEAST))
            break;
        weigh_likely(&b, rate, room, apart, decay, decays);
        // the filter passes half of the band
        double free = 0.5 / LIKELY_WINDOWS * b.samples * b.tracks;
        for (int i = 0; i < shifts * decays; i++) {
            double least = 1;
            for (size_t k = 0; k < sizeof splits / sizeof *splits; k++) {
                double split = splits[k] * apart < SINGLE ? 0 : 0.5 * splits[k] * apart;
                double at[3] = {shift[i / decays], split, log(decay[i % decays])};
                least = fmin(least, left_by(&b, rate, at));
            }
            out[i] -= free * log(least + 1e-6);
        }
    }
    band_close(&b);
    return true;
}
