/// fit_levels.c: how loud a sound is.
#include "fit_levels.h"

#include <math.h>
#include <stdlib.h>

const double fit_windows[FIT_WINDOWS][2] = {
    {0, 0.05}, {0.05, 0.15}, {0.15, 0.35}, {0.35, 0.85}, {0.85, 1.65}};
#define END_FROM 0.6 // (s) before the end ...
#define END_TO 0.1   // ... of a recording
#define LONG 2.4     // (s) with less there is no end but ringing
#define HOP 0.05     // (s) between two momentary loudnesses, each of ...
#define HOPS 8       // ... so many: 0.4 s

bool fit_levels(const partials_sound *sound, const double *frequency, int count,
                double (*level)[FIT_WINDOWS + 1])
{
    double *power = malloc(((size_t)count + 1) * sizeof *power), shortest = INFINITY;
    for (int t = 0; t < sound->tracks; t++)
        shortest = fmin(shortest, (double)sound->length[t] / sound->rate);
    bool good = power;
    for (int w = 0; good && w <= FIT_WINDOWS; w++) {
        bool end = w == FIT_END;
        double from = end ? shortest - END_FROM : fit_windows[w][0];
        double to = end ? shortest - END_TO : fit_windows[w][1];
        bool there = end ? shortest > LONG : to <= shortest;
        double whole = 20 * log10(0.5 * (to - from) * sound->rate) + 10 * log10(sound->tracks);
        good = !there || partials_levels(sound, from, to, frequency, count, power);
        for (int i = 0; good && i < count; i++)
            level[i][w] = there ? fmax(power[i] - whole, FIT_SILENT) : NAN;
    }
    free(power);
    return good;
}

// a section of the filter: y = b0 x + b1 x1 + b2 x2 - a1 y1 - a2 y2
typedef struct section {
    double b[3], a[3], x[2][3];
} section;

static double pass(section *s, int channel, double in)
{
    double *z = s->x[channel], out = s->b[0] * in + z[0];
    z[0] = s->b[1] * in - s->a[1] * out + z[1];
    z[1] = s->b[2] * in - s->a[2] * out;
    return out;
}

// the filter of BS.1770 at any rate: its analog sections by the bilinear transform (libebur128)
static void weigh(double rate, section out[2])
{
    double k = tan(HIMC_PI * 1681.974450955533 / rate), q = 0.7071752369554196;
    double high = pow(10, 3.999843853973347 / 20), mid = pow(high, 0.4996667741545416);
    double a = 1 + k / q + k * k;
    out[0] = (section){{(high + mid * k / q + k * k) / a, 2 * (k * k - high) / a,
                        (high - mid * k / q + k * k) / a},
                       {1, 2 * (k * k - 1) / a, (1 - k / q + k * k) / a},
                       {{0}}};
    k = tan(HIMC_PI * 38.13547087602444 / rate), q = 0.5003270373238773;
    a = 1 + k / q + k * k;
    out[1] = (section){{1, -2, 1}, {1, 2 * (k * k - 1) / a, (1 - k / q + k * k) / a}, {{0}}};
}

double fit_loudness(const float *stereo, size_t frames, double rate)
{
    section filter[2];
    size_t hop = (size_t)(HOP * rate);
    double part[HOPS] = {0}, most = 0;
    weigh(rate, filter);
    for (size_t at = 0, n = 0; at + hop <= frames; at += hop, n++) {
        double power = 0, all = 0;
        for (size_t i = 2 * at; i < 2 * (at + hop); i++) {
            double y = pass(&filter[1], i % 2, pass(&filter[0], i % 2, stereo[i]));
            power += y * y / (double)hop;
        }
        part[n % HOPS] = power;
        for (int k = 0; k < HOPS; k++)
            all += part[k] / HOPS;
        most = fmax(most, all);
    }
    return -0.691 + 10 * log10(most + 1e-20);
}
