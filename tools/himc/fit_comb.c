/// fit_comb.c: at which tuning a timpano's modes stand out of a recording's spectrum.
///
/// A room blurs lines and adds poles of its own, but what it answers is what the drum has sent: the
/// spectrum of the first .7 s is highest near the drum's modes. For each tuning the levels near
/// nine modes are summed, as they stand out of the median within a tenth of the frequency. The
/// ratios of the modes depend on size and tuning by the air; they are made at a few tunings and
/// interpolated.
#include "fit_drum.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AROUND 66       // lines on either side, a tenth of the frequency
#define MOST 15.0       // (dB) more counts no more
#define BLUR 2          // lines on either side within which a mode may be
#define KNOTS 4         // tunings at which modes are made
#define DIFFERENT 0.015 // per frequency: another tuning

static const struct {
    double from, to; // (s)
} spans[] = {{0.02, 0.3}, {0.1, 0.7}};
static const struct {
    int m, n;
    double weight;
} teeth[] = {{1, 1, 1},  {2, 1, 1},  {3, 1, 1},  {4, 1, 1}, {5, 1, .8},
             {6, 1, .6}, {1, 2, .7}, {2, 2, .7}, {3, 2, .5}};
#define TEETH (int)(sizeof teeth / sizeof *teeth)

bool fit_spectrum_of(const partials_sound *sound, fit_spectrum *out, himc_error *error)
{
    static double raw[FIT_LINES], frequency[FIT_LINES], near[2 * AROUND + 1];
    memset(out, 0, sizeof *out);
    for (int k = 0; k < FIT_LINES; k++)
        frequency[k] = FIT_LOWEST * exp(FIT_FINE * k);
    for (size_t s = 0; s < sizeof spans / sizeof *spans; s++) {
        if (!partials_levels(sound->low, spans[s].from, spans[s].to, frequency, FIT_LINES, raw))
            return himc_error_set(error, "out of memory");
        for (int k = 0; k < FIT_LINES; k++) {
            int low = k < AROUND ? 0 : k - AROUND, n = 0;
            for (int i = low; i <= k + AROUND && i < FIT_LINES; i++)
                near[n++] = raw[i];
            qsort(near, (size_t)n, sizeof *near, himc_order_doubles);
            out->level[k] += fmin(fmax(raw[k] - near[n / 2], 0), MOST);
        }
    }
    memcpy(raw, out->level, sizeof raw);
    for (int k = 0; k < FIT_LINES; k++) {
        for (int i = k < BLUR ? 0 : k - BLUR; i <= k + BLUR && i < FIT_LINES; i++)
            out->level[k] = fmax(out->level[k], raw[i]);
        out->mean += out->level[k] / FIT_LINES;
    }
    return true;
}

// ratios of the teeth to the tuning, at KNOTS tunings
static bool make_knots(double inches, double low, double high, double ratio[KNOTS][TEETH],
                       himc_error *error)
{
    for (int k = 0; k < KNOTS; k++) {
        fit_mode modes[FIT_MODES];
        fit_drum d = fit_drum_usual(inches, low * pow(high / low, k / (KNOTS - 1.0)));
        int count = fit_drum_modes(&d, modes, error);
        if (count == 0)
            return false;
        for (int t = 0; t < TEETH; t++) {
            ratio[k][t] = 0;
            for (int i = 0; i < count && ratio[k][t] == 0; i++)
                if (modes[i].m == teeth[t].m && modes[i].n == teeth[t].n)
                    ratio[k][t] = modes[i].frequency / d.tune;
        }
    }
    return true;
}

// how far the modes stand out, at a place in the span of tunings
static double comb_at(const fit_spectrum *spectrum, double ratio[KNOTS][TEETH], double place,
                      double tune)
{
    int k = (int)fmin(place * (KNOTS - 1), KNOTS - 2);
    double part = place * (KNOTS - 1) - k, sum = 0;
    for (int t = 0; t < TEETH; t++) {
        double r = ratio[k][t] + part * (ratio[k + 1][t] - ratio[k][t]);
        int line = (int)lround(log(fmax(r, 0.1) * tune / FIT_LOWEST) / FIT_FINE);
        if (line >= 0 && line < FIT_LINES)
            sum += teeth[t].weight * (spectrum->level[line] - spectrum->mean);
    }
    return sum;
}

bool fit_comb(const fit_spectrum *spectrum, double inches, double low, double high,
              fit_drum best[FIT_TUNINGS], himc_error *error)
{
    double ratio[KNOTS][TEETH], span = log(high / low);
    if (!make_knots(inches, low, high, ratio, error))
        return false;
    for (int i = 0; i < FIT_TUNINGS; i++) {
        best[i] = (fit_drum){.comb = -INFINITY};
        for (double at = 0; at < span; at += FIT_FINE) {
            fit_drum d = fit_drum_usual(inches, low * exp(at));
            d.comb = comb_at(spectrum, ratio, at / span, d.tune);
            bool known = false;
            for (int k = 0; k < i; k++)
                known = known || fabs(d.tune / best[k].tune - 1) < DIFFERENT;
            if (!known && d.comb > best[i].comb)
                best[i] = d;
        }
    }
    return true;
}
