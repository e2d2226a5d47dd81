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
/// Unit noise is white, from a counter that is scrambled (random.h), through Butterworth filters
/// of second order at the lower edge of the band and of fourth order at the upper one, all in
/// three sections: two with zeros 1 - 1/z^2, and 1 + 2/z + 1/z^2. It is a sum of two sequences
/// that begin anew with each contact: one is the drum's, whose shell and stand are always the same,
/// the seed of the other is the place in steps of 2 cm. So equal blows are equal to the last bit,
/// and others alike. All is counted in samples, so how many are asked for at a time does not
/// matter. It takes no energy from the head and gives it none.
///
/// A band that nobody would hear ends within some RISEs; the upper two, or all four, then rest.
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
#define UNHEARD 2e-6      // of a level; chosen: 20 dB of sound pressure at 1 m, a quiet hall has 25
#define SILENT 1e-8       // of a level that ends; chosen: -160 dB, no click
#define PLACE 50       // seeds a metre; chosen: a mallet covers as much, blows within it are alike
#define COMMON 0.8     // of the power; chosen: strokes with `human 0.5` correlate by about 0.95
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

// the poles of a low or high pass with damping d = 1/Q, by the bilinear transform
static void set_poles(himc_noise_section *e, int band, double k, double d)
{
    double n = 1 / (1 + k * d + k * k);
    for (int row = 0; row < HIMC_NOISE_ROWS; row++) {
        e->a[0][HIMC_NOISE_ROWS * band + row] = 2 * (k * k - 1) * n;
        e->a[1][HIMC_NOISE_ROWS * band + row] = (1 - k * d + k * k) * n;
    }
}

// a number of each row
typedef double both __attribute__((vector_size(HIMC_NOISE_ROWS * sizeof(double)), may_alias));
_Static_assert(HIMC_NOISE_ROWS == 2, "a vector of two doubles, as x86-64 and arm64 have it");

// n samples through the sections of bands `first` and `first` + 1, of which neither waits for the
// other
static void filter(himc_noise_section section[3], int first, int n, both (*x)[HIMC_NOISE_BANDS])
{
    both a[3][2][2], past[3][2][2];
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++) {
            memcpy(a[k][i], &section[k].a[i][HIMC_NOISE_ROWS * first], sizeof a[k][i]);
            memcpy(past[k][i], &section[k].past[i][HIMC_NOISE_ROWS * first], sizeof past[k][i]);
        }
    for (int at = 0; at < n; at++)
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 2; i++) {
                both in = x[at][first + i], out = in + past[k][0][i];
                both later = past[k][1][i] - a[k][0][i] * out, last = a[k][1][i] * out;
                past[k][0][i] = later;
                past[k][1][i] = -in - last;
                if (k == 2) {
                    past[k][0][i] = later + (in + in);
                    past[k][1][i] = in - last;
                }
                x[at][first + i] = out;
            }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++)
            memcpy(&section[k].past[i][HIMC_NOISE_ROWS * first], past[k][i], sizeof past[k][i]);
}

// lets the filters of lanes from `first` on, `step` apart, begin again
static void clear(himc_stroke_noise *noise, int first, int step)
{
    for (int k = 0; k < 3; k++)
        for (int i = first; i < HIMC_NOISE_LANES; i += step)
            noise->section[k].past[0][i] = noise->section[k].past[1][i] = 0;
}

static void set_units(himc_stroke_noise *noise)
{
    himc_stroke_noise tried = *noise;
    double power[HIMC_NOISE_BANDS] = {0};
    clear(&tried, 0, 1);
    for (int k = 0; k < MEASURED * noise->rate; k++) {
        both x[1][HIMC_NOISE_BANDS];
        for (int i = 0; i < HIMC_NOISE_BANDS; i++)
            x[0][i] = (both){k == 0};
        for (int i = 0; i < HIMC_NOISE_BANDS; i++) {
            if (i % 2 == 0)
                filter(tried.section, i, 1, x);
            power[i] += x[0][i][0] * x[0][i][0];
        }
    }
    for (int i = 0; i < HIMC_NOISE_BANDS; i++)
        noise->band[i].unit = bands[i].low < TOP * noise->rate ? 1 / sqrt(power[i]) : 0;
}

void himc_stroke_noise_set_rate(himc_stroke_noise *noise, double rate)
{
    noise->rate = rate;
    himc_stroke_noise_damp(noise, noise->damp);
    noise->follow = 1 - exp(-1 / (RISE * rate));
    noise->pole = exp(-2 * HIMC_PI * EDGE / rate);
    for (int i = 0; i < HIMC_NOISE_BANDS; i++) {
        double low_k = tan(HIMC_PI * fmin(bands[i].low, TOP * rate) / rate);
        double top_k = tan(HIMC_PI * fmin(bands[i].high, TOP * rate) / rate);
        noise->band[i].keep = exp(-6.9 / (bands[i].t60 * rate));
        set_poles(&noise->section[0], i, low_k, sqrt(2));
        set_poles(&noise->section[1], i, top_k, 2 * cos(HIMC_PI / 8));
        set_poles(&noise->section[2], i, top_k, 2 * sin(HIMC_PI / 8));
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
    noise->common = (UINT64_C(1) + (uint64_t)noise->seed) << 36; // apart from all places
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
    noise->sounds = 0;
    noise->state = noise->common = 0;
    noise->force = noise->slope[0] = noise->slope[1] = noise->slope[2] = 0;
    for (int i = 0; i < HIMC_NOISE_BANDS; i++)
        noise->band[i].root = noise->band[i].level = 0;
    clear(noise, 0, 1);
}

// white noise of power 1 for a band, from 16 of 64 bits
static double white(uint64_t bits, int band)
{
    return sqrt(12) / 65536 * ((int16_t)(bits >> (16 * band) ^ 0x8000) + 0.5);
}

// the levels of the next samples, at most n, until bands end: then fewer are `left`
static int find_levels(himc_stroke_noise *noise, int n, double force, int *left,
                       double level[CHUNK][HIMC_NOISE_BANDS])
{
    bool pressed = force > 0 && noise->amount > 0;
    *left = noise->sounds;
    for (int k = 0; k < n; k++) {
        int heard = 0;
        drive(noise, force);
        for (int i = 0; i < HIMC_NOISE_BANDS; i++) {
            himc_noise_band *b = &noise->band[i];
            double goal = noise->amount * b->root;
            b->level += noise->follow * (goal - b->level);
            b->root *= pressed || goal > UNHEARD ? b->keep * noise->held : 0;
            level[k][i] = b->level * b->unit;
            if (b->level > SILENT || b->root > 0)
                heard = i < HIMC_NOISE_BANDS / 2 ? HIMC_NOISE_BANDS / 2 : HIMC_NOISE_BANDS;
        }
        if (!pressed && heard < noise->sounds) {
            *left = heard;
            return k + 1;
        }
    }
    return n;
}

// up to CHUNK samples; returns how many
static int run_chunk(himc_stroke_noise *noise, int n, double force, int rows, double *const *row)
{
    double level[CHUNK][HIMC_NOISE_BANDS];
    both x[CHUNK][HIMC_NOISE_BANDS];
    int left, count = noise->sounds;
    n = find_levels(noise, n < CHUNK ? n : CHUNK, force, &left, level);
    for (int k = 0; k < n; k++) {
        uint64_t bits = himc_random_bits(&noise->state), same = himc_random_bits(&noise->common),
                 other = himc_random_bits(&noise->common);
        for (int i = 0; i < count; i++) {
            double own = sqrt(COMMON) * white(same, i) + sqrt(1 - COMMON) * white(bits, i);
            x[k][i] =
                (both){own, COHERENCE * own + sqrt(1 - COHERENCE * COHERENCE) * white(other, i)};
        }
    }
    for (int i = 0; i < count; i += 2)
        filter(noise->section, i, n, x);
    // the other row begins at rest again: where it ended depends on the host's blocks
    if (rows == 1)
        clear(noise, 1, HIMC_NOISE_ROWS);
    for (int k = 0; k < n; k++) {
        both sum = {0};
        for (int i = 0; i < count; i++)
            sum += level[k][i] * x[k][i];
        for (int j = 0; j < rows; j++)
            row[j][k] = sum[j];
    }
    if (left == 0)
        himc_stroke_noise_rest(noise);
    else if (left < count)
        clear(noise, HIMC_NOISE_ROWS * left, 1);
    noise->sounds = left;
    return n;
}

void himc_stroke_noise_run(himc_stroke_noise *noise, int n, double force, int rows,
                           double *const row[HIMC_NOISE_ROWS])
{
    double *at[HIMC_NOISE_ROWS] = {row[0], row[1]};
    for (int more; n > 0; n -= more) {
        if (force > 0 && noise->amount > 0)
            noise->sounds = HIMC_NOISE_BANDS;
        bool silent = noise->sounds == 0;
        more = silent ? n : run_chunk(noise, n, force, rows, at);
        for (int k = 0; k < rows; k++) {
            if (silent)
                memset(at[k], 0, (size_t)more * sizeof *at[k]);
            at[k] += more;
        }
    }
}
