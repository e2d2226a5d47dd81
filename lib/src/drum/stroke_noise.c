/// stroke_noise.c: noise in four bands, driven by the rate at which the contact's force changes.
///
/// A blow also shakes what is not the head: felt rubs, the shaft bends, shell and stand ring, in
/// more modes than anyone has measured. So each band b, the lowest from 250 Hz where a shaft of
/// wood first bends (400 Hz) and kettles ring, has an energy (docs/model.md),
///     E_b' = -E_b 13.8/T60_b + q_b (min(F, STRONGEST)/F1)^BETA G^2/sqrt(1 + (G/G1)^2),
///     sound = amount sqrt(E_b) x unit noise,
/// with a level that rises in RISE, and G the part of F' above EDGE: most of F' is the slow rise of
/// a contact, the same for all mallets, and what lies above is large where a mallet is hard or
/// comes fast. Above G1 the power grows with G only, as that of rubbing does. So wood is brighter
/// than felt without another table. The noise is taken at 1 m, and is weaker with distance as the
/// head's sound is.
///
/// Unit noise is white, from a counter that is scrambled (random.h), through Butterworth filters of
/// second order at the lower edge of the band and of fourth order at the upper one. Its sequence
/// begins anew with each contact, from a seed that is the place in steps of 2 cm: equal blows
/// are equal to the last bit, and as soon as the place varies no two are. All is counted in
/// samples, so how many are asked for at a time does not matter. It takes no energy from the head
/// and gives it none.
#include "drum/stroke_noise.h"

#include "base/random.h"
#include "himc/membrane.h"

#include <math.h>
#include <string.h>

#define FORCE 12.0     // F1 (N): of a medium blow
#define BETA 1.2       // chosen: hard and loud is twice as bright as soft and low
#define STRONGEST 55.0 // (N) chosen: fff is louder than ff, not noisier
#define SLOPE 1e4      // G1 (N/s): of a loud medium blow; chosen: a wooden stick is not all noise
#define LEAST_SLOPE 1e-30 // (N/s) of G; chosen: beside any blow's it is nothing
#define EDGE 500.0        // (Hz) of G; chosen: what is above differs from mallet to mallet
#define RISE 0.002        // (s) chosen: as the recordings rise
#define TOP 0.45          // of the sample rate; a band above it is silent
#define SILENT 1e-14      // sum of energies; chosen: -140 dB
#define PLACE 50       // seeds a metre; chosen: a mallet covers as much, blows within it are alike
#define COHERENCE 0.65 // of the two rows; chosen: shell and stand are larger than a head
#define CHUNK 32       // samples at a time, so that vectors do not wait for single numbers
#define MEASURED 0.04  // (s) of a filter's response; chosen: the lowest band's is over

// q_b and T60, found by trial on numbers of four recordings, hall included: so long the noise
// stands for early reflections, too. It proves nothing about felt or stands.
static const struct {
    double low, high, t60, drive; // edges (Hz), decay (s)
} bands[HIMC_NOISE_BANDS] = {{250, 1000, 1.05, 2.9e-8},
                             {1000, 2000, 0.60, 4.7e-9},
                             {2000, 4000, 0.36, 1.2e-9},
                             {4000, 8000, 0.18, 9.0e-11}};

// a low or high pass with damping d = 1/Q, by the bilinear transform, for a band of both rows
static void set_edge(himc_noise_edge *e, int band, double k, bool high, double d)
{
    double n = 1 / (1 + k * d + k * k), b = (high ? 1 : k * k) * n;
    for (int i = band; i < HIMC_NOISE_LANES; i += HIMC_NOISE_BANDS) {
        e->b[0][i] = e->b[2][i] = b;
        e->b[1][i] = high ? -2 * b : 2 * b;
        e->a[0][i] = 2 * (k * k - 1) * n;
        e->a[1][i] = (1 - k * d + k * k) * n;
    }
}

// x through all filters; `lanes` is constant where this is inlined, so that vectors do it
static inline void filter(himc_noise_edge edge[3], int lanes, double x[HIMC_NOISE_LANES])
{
    for (int k = 0; k < 3; k++) {
        himc_noise_edge *e = &edge[k];
        for (int i = 0; i < lanes; i++) {
            double y = e->b[0][i] * x[i] + e->past[0][i];
            e->past[0][i] = e->b[1][i] * x[i] - e->a[0][i] * y + e->past[1][i];
            e->past[1][i] = e->b[2][i] * x[i] - e->a[1][i] * y;
            x[i] = y;
        }
    }
}

static void set_units(himc_stroke_noise *noise)
{
    himc_noise_edge edge[3];
    double power[HIMC_NOISE_BANDS] = {0};
    memcpy(edge, noise->edge, sizeof edge);
    for (int k = 0; k < 3; k++)
        memset(edge[k].past, 0, sizeof edge[k].past);
    for (int k = 0; k < MEASURED * noise->rate; k++) {
        double x[HIMC_NOISE_LANES];
        for (int i = 0; i < HIMC_NOISE_LANES; i++)
            x[i] = k == 0;
        filter(edge, HIMC_NOISE_BANDS, x);
        for (int i = 0; i < HIMC_NOISE_BANDS; i++)
            power[i] += x[i] * x[i];
    }
    for (int i = 0; i < HIMC_NOISE_BANDS; i++)
        noise->band[i].unit = power[i] > 0 ? 1 / sqrt(power[i]) : 0;
}

void himc_stroke_noise_set_rate(himc_stroke_noise *noise, double rate)
{
    noise->rate = rate;
    himc_stroke_noise_damp(noise, noise->damp);
    noise->follow = 1 - exp(-1 / (RISE * rate));
    noise->pole = exp(-2 * HIMC_PI * EDGE / rate);
    for (int k = 0; k < 3; k++)
        memset(noise->edge[k].b, 0, sizeof noise->edge[k].b);
    for (int i = 0; i < HIMC_NOISE_BANDS; i++) {
        double top = fmin(bands[i].high, TOP * rate);
        double low_k = tan(HIMC_PI * bands[i].low / rate), top_k = tan(HIMC_PI * top / rate);
        noise->band[i].keep = exp(-6.9 / (bands[i].t60 * rate));
        if (bands[i].low >= top)
            continue;
        set_edge(&noise->edge[0], i, low_k, true, sqrt(2));
        set_edge(&noise->edge[1], i, top_k, false, 2 * cos(HIMC_PI / 8));
        set_edge(&noise->edge[2], i, top_k, false, 2 * sin(HIMC_PI / 8));
    }
    set_units(noise);
}

void himc_stroke_noise_damp(himc_stroke_noise *noise, double damp)
{
    noise->damp = damp;
    noise->held = exp(-damp * HIMC_DAMP / noise->rate);
}

himc_stroke_noise himc_stroke_noise_at(double rate)
{
    himc_stroke_noise noise = {.amount = 1};
    himc_stroke_noise_set_rate(&noise, rate);
    return noise;
}

void himc_stroke_noise_begin(himc_stroke_noise *noise, double x, double y)
{
    noise->state = (uint64_t)llround(PLACE * x) * 4096 + (uint64_t)llround(PLACE * y);
}

// a sample of the force feeds the bands
static void drive(himc_stroke_noise *noise, double force)
{
    double *known = noise->slope, stronger = force > noise->force ? force : noise->force;
    if (stronger <= 0 && fabs(known[1]) + fabs(known[2]) < LEAST_SLOPE) {
        known[0] = known[1] = known[2] = 0; // a denormal number costs as much as all the rest
        return;
    }
    double slope = (force - noise->force) * noise->rate,
           first = noise->pole * (known[1] + slope - known[0]);
    double g = noise->pole * (known[2] + first - known[1]);
    known[0] = slope;
    known[1] = first;
    known[2] = g;
    noise->force = force;
    if (stronger <= 0)
        return;
    double power =
        pow(fmin(stronger, STRONGEST) / FORCE, BETA) * g * g / sqrt(1 + g * g / (SLOPE * SLOPE));
    power /= noise->rate;
    for (int i = 0; i < HIMC_NOISE_BANDS; i++)
        noise->band[i].root =
            sqrt(noise->band[i].root * noise->band[i].root + bands[i].drive * power);
}

void himc_stroke_noise_rest(himc_stroke_noise *noise)
{
    noise->sounds = false;
    noise->state = 0;
    noise->force = noise->slope[0] = noise->slope[1] = noise->slope[2] = 0;
    for (int i = 0; i < HIMC_NOISE_BANDS; i++)
        noise->band[i].root = noise->band[i].level = 0;
    for (int k = 0; k < 3; k++)
        memset(noise->edge[k].past, 0, sizeof noise->edge[k].past);
}

// white noise of power 1 for a band, from 16 of 64 bits
static double white(uint64_t bits, int band)
{
    double part = (double)((bits >> (16 * band)) & 0xffffu);
    return sqrt(12) * ((part + 0.5) / 65536 - 0.5);
}

// white noise for all bands of one row or two
static inline void draw(himc_stroke_noise *noise, int lanes, double x[HIMC_NOISE_LANES])
{
    uint64_t bits = himc_random_bits(&noise->state), other = himc_random_bits(&noise->state);
    for (int i = 0; i < HIMC_NOISE_BANDS; i++)
        x[i] = white(bits, i);
    for (int i = HIMC_NOISE_BANDS; i < lanes; i++)
        x[i] = COHERENCE * x[i - HIMC_NOISE_BANDS] +
               sqrt(1 - COHERENCE * COHERENCE) * white(other, i - HIMC_NOISE_BANDS);
}

// the levels of the next samples, at most n, until the noise is no longer heard; then it rests
static int find_levels(himc_stroke_noise *noise, int n, double force, bool *rests,
                       double level[CHUNK][HIMC_NOISE_BANDS])
{
    for (int k = 0; k < n; k++) {
        double heard = 0;
        drive(noise, force);
        for (int i = 0; i < HIMC_NOISE_BANDS; i++) {
            himc_noise_band *b = &noise->band[i];
            double goal = noise->amount * b->root;
            b->level += noise->follow * (goal - b->level);
            b->root *= b->keep * noise->held;
            heard += goal * goal + b->level * b->level;
            level[k][i] = b->level * b->unit;
        }
        *rests = !(heard > SILENT) && (force == 0 || noise->amount == 0);
        if (*rests)
            return k + 1;
    }
    return n;
}

// one row of samples or two
static inline void sound(himc_stroke_noise *noise, int lanes, int n, double *const *row,
                         double level[CHUNK][HIMC_NOISE_BANDS])
{
    double x[CHUNK][HIMC_NOISE_LANES];
    for (int k = 0; k < n; k++)
        draw(noise, lanes, x[k]);
    for (int k = 0; k < n; k++)
        filter(noise->edge, lanes, x[k]);
    for (int j = 0; j * HIMC_NOISE_BANDS < lanes; j++)
        for (int k = 0; k < n; k++) {
            const double *y = x[k] + j * HIMC_NOISE_BANDS, *l = level[k];
            row[j][k] = (l[0] * y[0] + l[1] * y[1]) + (l[2] * y[2] + l[3] * y[3]);
        }
}

// up to CHUNK samples; returns how many
static int run_chunk(himc_stroke_noise *noise, int n, double force, int rows, double *const *row)
{
    double level[CHUNK][HIMC_NOISE_BANDS];
    bool rests;
    n = find_levels(noise, n < CHUNK ? n : CHUNK, force, &rests, level);
    // the filters of the other row begin at rest again: where it ended depends on the host's blocks
    for (int k = 0; k < 3 && rows == 1; k++)
        for (int i = HIMC_NOISE_BANDS; i < HIMC_NOISE_LANES; i++)
            noise->edge[k].past[0][i] = noise->edge[k].past[1][i] = 0;
    if (rows > 1)
        sound(noise, HIMC_NOISE_LANES, n, row, level);
    else
        sound(noise, HIMC_NOISE_BANDS, n, row, level);
    if (rests)
        himc_stroke_noise_rest(noise);
    return n;
}

void himc_stroke_noise_run(himc_stroke_noise *noise, int n, double force, int rows,
                           double *const row[HIMC_NOISE_ROWS])
{
    double *at[HIMC_NOISE_ROWS] = {row[0], row[1]};
    for (int more; n > 0; n -= more) {
        noise->sounds = noise->sounds || (force > 0 && noise->amount > 0);
        bool silent = !noise->sounds;
        more = silent ? n : run_chunk(noise, n, force, rows, at);
        for (int k = 0; k < rows; k++) {
            if (silent)
                memset(at[k], 0, (size_t)more * sizeof *at[k]);
            at[k] += more;
        }
    }
}
