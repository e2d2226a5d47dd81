/// partials_lines.c: partials that are told with certainty: lines of the spectrum that fall evenly.
///
/// In a hall ESPRIT finds poles of the hall between the instrument's, whose sum is a line that no
/// pole is like. A line is a peak of the spectrum of .12 to 1.2 s, all channels together; its T60
/// is the slope of its envelope from .15 s to 2.2 s or 35 dB down, its level what shows so high
/// there. If the envelope departs from the slope by less than 2.5 dB, the line takes the place of
/// the poles about it. Else it is a pair that beats, or the hall's noise (4 to 6 dB), and its poles
/// stay.
#include "partials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LOWEST 45.0    // (Hz)
#define STEP 0.5       // (Hz) of the spectrum
#define BINS 2311      // up to PARTIALS_LINES
#define FROM 0.12      // (s) of the spectrum
#define TO 1.2         // (s)
#define LEAST_LONG 0.4 // (s) of it
#define SOFTEST 45.0   // (dB) below the strongest line
#define PROMINENT 10.0 // (dB) above both valleys beside it
#define VALLEY 60.0    // (Hz) in which they lie
#define NARROWEST 6.0  // (Hz) of the envelope's band ...
#define WIDEST 20.0    // ... and so much of the way to the next line
#define GAP_PART 0.45
#define BEGIN 0.15 // (s) of the slope
#define TICK 0.005 // (s) of the envelope
#define TICKS 410  // up to 2.2 s
#define LANES 8
#define LEAST_TICKS 48  // of a slope
#define DOWN 35.0       // (dB)
#define STRAIGHT 2.5    // (dB)
#define ERROR_MOST 0.12 // of T60
#define ABOUT 6.0       // (Hz) poles so near are the line
#define HALL 0.35       // (s) poles that ring longer and are near no line are the hall's

static size_t shortest(const partials_sound *sound)
{
    size_t least = sound->length[0];
    for (int i = 1; i < sound->tracks; i++)
        least = sound->length[i] < least ? sound->length[i] : least;
    return least;
}

bool partials_levels(const partials_sound *sound, double from, double to, const double *frequency,
                     int count, double *level)
{
    size_t start = (size_t)(from * sound->rate), n = (size_t)(fmax(to - from, 0) * sound->rate);
    double *x = malloc((n + 1) * sizeof *x);
    memset(level, 0, (size_t)count * sizeof *level);
    for (int t = 0; x && t < sound->tracks; t++) {
        for (size_t i = 0; i < n; i++)
            x[i] = start + i < sound->length[t]
                       ? sound->track[t][start + i] *
                             (start > 0 ? 1 - cos(2 * HIMC_PI * (double)i / (double)n)
                                        : 1 + cos(HIMC_PI * (double)i / (double)n))
                       : 0;
        for (int first = 0; first < count; first += LANES) { // Goertzel 1958, together for speed
            double turn[LANES] = {0}, one[LANES] = {0}, two[LANES] = {0};
            for (int k = 0; k < LANES && first + k < count; k++)
                turn[k] = 2 * cos(2 * HIMC_PI * frequency[first + k] / sound->rate);
            for (size_t i = 0; i < n; i++)
                for (int k = 0; k < LANES; k++) {
                    double now = x[i] + turn[k] * one[k] - two[k];
                    two[k] = one[k];
                    one[k] = now;
                }
            for (int k = 0; k < LANES && first + k < count; k++)
                level[first + k] += one[k] * one[k] + two[k] * two[k] - turn[k] * one[k] * two[k];
        }
    }
    for (int k = 0; k < count; k++)
        level[k] = 10 * log10(level[k] + 1e-20);
    free(x);
    return x;
}

// (s), of the spectrum
static double end_of(const partials_sound *sound)
{
    return fmin(TO, (double)shortest(sound) / sound->rate);
}

static bool find_spectrum(const partials_sound *sound, double level[BINS])
{
    double end = end_of(sound), frequency[BINS];
    for (int k = 0; k < BINS; k++)
        frequency[k] = LOWEST + STEP * k;
    return end - FROM > LEAST_LONG &&
           partials_levels(sound->low, FROM, end, frequency, BINS, level);
}

// level (dB) in that spectrum of a partial whose level at the onset is 0
static double shown(const partials_sound *sound, double t60)
{
    double rate = sound->low->rate, length = floor((end_of(sound) - FROM) * rate), sum = 0;
    for (int i = 0; i < length; i++)
        sum += 0.5 * (1 - cos(2 * HIMC_PI * i / length)) * pow(1000, -(FROM + i / rate) / t60);
    return 20 * log10(sum) + 10 * log10(sound->tracks);
}

// how far a peak stands above the deeper valley's counterpart: the shallower one counts
static double prominence(const double level[BINS], int k)
{
    double valley[2] = {level[k], level[k]};
    for (int side = 0; side < 2; side++)
        for (int i = k, way = side ? 1 : -1;
             i >= 0 && i < BINS && abs(i - k) * STEP < VALLEY && level[i] <= level[k]; i += way)
            valley[side] = fmin(valley[side], level[i]);
    return level[k] - fmax(valley[0], valley[1]);
}

static int find_peaks(const double level[BINS], partial *out, int most)
{
    double top = -INFINITY;
    int count = 0;
    for (int k = 0; k < BINS; k++)
        top = fmax(top, level[k]);
    for (int k = 1; k < BINS - 1 && count < most; k++) {
        double a = level[k - 1], b = level[k], c = level[k + 1];
        if (b < a || b <= c || b < top - SOFTEST || prominence(level, k) < PROMINENT)
            continue;
        double aside = 0.5 * (a - c) / (a - 2 * b + c);
        out[count++] = (partial){.frequency = LOWEST + STEP * (k + aside),
                                 .level = b - 0.25 * (a - c) * aside,
                                 .clear = prominence(level, k)};
    }
    return count;
}

// RMS level (dB) of the channels in a band about a line, at each tick; how many
static int find_envelope(const partials_sound *all, double frequency, double width, double *out)
{
    const partials_sound *sound = all->low;
    int half = (int)(sound->rate / width), n = 2 * half + 1;
    size_t length = shortest(sound);
    double *c = malloc(2 * sizeof *c * (size_t)n), sum = 0;
    int count = 0;
    for (int i = 0; c && i < n; i++) {
        double w = 1 + cos(HIMC_PI * (i - half) / (half + 1.0));
        double angle = 2 * HIMC_PI * frequency * (i - half) / sound->rate;
        sum += w;
        c[2 * i] = w * cos(angle);
        c[2 * i + 1] = w * sin(angle);
    }
    while (c && count < TICKS) {
        size_t at = (size_t)lround((BEGIN + TICK * count) * sound->rate);
        double power = 0;
        if (at + (size_t)half >= length)
            break;
        for (int t = 0; t < sound->tracks; t++) {
            double re = 0, im = 0;
            int first = at < (size_t)half ? half - (int)at : 0;
            const double *x = sound->track[t] + at;
            for (int i = first; i < n; i++) {
                re += x[i - half] * c[2 * i];
                im += x[i - half] * c[2 * i + 1];
            }
            power += 4 * (re * re + im * im) / (sum * sum) / sound->tracks;
        }
        out[count++] = 10 * log10(power + 1e-20);
    }
    free(c);
    return count;
}

// T60 by a straight line through the envelope; false if it is not straight
static bool find_slope(const double *e, int count, double width, partial *out)
{
    double st = 0, se = 0, stt = 0, ste = 0, top = -INFINITY, left = 0;
    int n = 0;
    for (int i = 0; i < 10 && i < count; i++)
        top = fmax(top, e[i]);
    for (; n < count && (e[n] > top - DOWN || n < LEAST_TICKS); n++) {
        double t = BEGIN + TICK * n;
        st += t, se += e[n], stt += t * t, ste += t * e[n];
    }
    if (n < LEAST_TICKS)
        return false;
    double spread = stt / n - st * st / n / n, slope = (ste / n - st * se / n / n) / spread;
    double onset = se / n - slope * st / n;
    for (int i = 0; i < n; i++)
        left += pow(e[i] - onset - slope * (BEGIN + TICK * i), 2) / n;
    out->t60 = slope < -1 ? -60 / slope : 0;
    out->t60_error = 60 * sqrt(left / fmax(3, TICK * n * width) / spread) / (slope * slope);
    return out->t60 > 0 && sqrt(left) < STRAIGHT && out->t60_error < ERROR_MOST * out->t60;
}

static int by_frequency(const void *a, const void *b)
{
    const partial *p = a, *q = b;
    return (p->frequency > q->frequency) - (p->frequency < q->frequency);
}

// whether a pole stays beside the lines
static bool stays(const partial *p, const partial *line, int lines, bool hall)
{
    for (int k = 0; k < lines; k++)
        if (fabs(p->frequency - line[k].frequency) < ABOUT && (line[k].line || hall))
            return false;
    return !hall || p->t60 < HALL || p->frequency > PARTIALS_LINES;
}

void partials_lines(const partials_sound *sound, partials_list *list)
{
    static double level[BINS], envelope[TICKS];
    partial line[PARTIALS_MOST];
    int count = find_spectrum(sound, level) ? find_peaks(level, line, PARTIALS_MOST) : 0, kept = 0;
    for (int k = 0; k < count; k++) {
        partial *p = &line[k];
        double gap = fmin(k > 0 ? p->frequency - line[k - 1].frequency : VALLEY,
                          k + 1 < count ? line[k + 1].frequency - p->frequency : VALLEY);
        double width = fmin(fmax(GAP_PART * gap, NARROWEST), WIDEST);
        p->frequency_error = 0.1 / (TO - FROM);
        p->line =
            find_slope(envelope, find_envelope(sound, p->frequency, width, envelope), width, p);
        p->level -= p->t60 > 0 ? shown(sound, p->t60) : 0;
        p->energy = p->level + 10 * log10(p->t60);
    }
    for (int i = 0; count > 0 && i < list->count; i++)
        if (stays(&list->row[i], line, count, list->room > 0))
            list->row[kept++] = list->row[i];
    list->count = count > 0 ? kept : list->count;
    for (int k = 0; k < count && list->count < PARTIALS_MOST; k++)
        if (line[k].line || (list->room > 0 && line[k].t60 > 0))
            list->row[list->count++] = line[k];
    qsort(list->row, (size_t)list->count, sizeof *list->row, by_frequency);
}
