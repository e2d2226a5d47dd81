/// stroke_noise.c: noise in four octaves, driven by the rate at which the contact's force changes.
///
/// A blow also shakes what is not the head: felt rubs, the shaft bends, shell and stand ring, in
/// more modes than anyone has measured. So each octave b has an energy (docs/model.md),
///     E_b' = -E_b 13.8/T60_b + q_b (min(F, STRONGEST)/F1)^BETA G^2/sqrt(1 + (G/G1)^2),
///     sound = amount sqrt(E_b) x unit noise,
/// with a level that rises in RISE, and G the part of F' above EDGE: most of F' is the slow rise of
/// a contact, the same for all mallets, and what lies above is large where a mallet is hard or
/// comes fast. Above G1 the power grows with G only, as that of rubbing does. So wood is brighter
/// than felt without another table. The noise is taken at 1 m, and is weaker with distance as the
/// head's sound is.
///
/// Unit noise is white, from a counter that is scrambled (random.h), through Butterworth filters of
/// second order at the lower edge of the octave and of fourth order at the upper one. Its sequence
/// begins anew with each contact, from a seed that is the place in whole centimetres: equal blows
/// are equal to the last bit, and as soon as the place varies no two are. All is counted in
/// samples, so how many are asked for at a time does not matter. It takes no energy from the head
/// and gives it none.
#include "drum/stroke_noise.h"

#include "base/random.h"

#include <math.h>
#include <string.h>

#define FORCE 25.0     // F1 (N): of a medium blow
#define BETA 0.8       // chosen: 1 is a felt core, 0 its friction; brightness with force
#define STRONGEST 55.0 // (N) chosen: fff is louder than ff, not noisier
#define SLOPE 1e4      // G1 (N/s): of a loud medium blow; chosen: a wooden stick is not all noise
#define EDGE 500.0     // (Hz) of G; chosen: where the lowest octave begins
#define RISE 0.002     // (s) chosen: as the recordings rise
#define TOP 0.45       // of the sample rate; an octave above it is silent
#define SILENT 1e-14   // sum of energies; chosen: -140 dB
#define PLACE 100      // seeds a metre; chosen: how well a player finds a place again
#define COHERENCE 0.5  // of the two rows; chosen: shell and stand are larger than a head
#define MEASURED 0.1   // (s) of a filter's response; chosen: the lowest octave's is over

// q_b, fitted once on numbers of two recordings, hall included: with the head's own sound an accent
// f of the medium mallet, at C2 on 32 inches and at G2 on 29, has about -13 -18 -25 -38 dB in its
// first 100 ms. It shows that the form reaches them, and proves nothing about felt or stands.
static const struct {
    double low, t60, drive; // edge (Hz), decay (s)
} octave[HIMC_NOISE_BANDS] = {
    {500, 0.35, 1.25e-7}, {1000, 0.20, 6.2e-8}, {2000, 0.12, 2e-8}, {4000, 0.06, 1.6e-9}};

// a low or high pass with damping d = 1/Q, by the bilinear transform
static himc_biquad edge(double hz, double rate, bool high, double d)
{
    double k = tan(HIMC_PI * hz / rate), n = 1 / (1 + k * d + k * k), b = (high ? 1 : k * k) * n;
    return (himc_biquad){{b, high ? -2 * b : 2 * b, b},
                         {2 * (k * k - 1) * n, (1 - k * d + k * k) * n}};
}

static double filter(const himc_biquad *f, double past[2], double x)
{
    double y = f->b[0] * x + past[0];
    past[0] = f->b[1] * x - f->a[0] * y + past[1];
    past[1] = f->b[2] * x - f->a[1] * y;
    return y;
}

static double filter_all(const himc_noise_band *b, double past[3][2], double x)
{
    for (int i = 0; i < 3; i++)
        x = filter(&b->edge[i], past[i], x);
    return x;
}

void himc_stroke_noise_set_rate(himc_stroke_noise *noise, double rate)
{
    noise->rate = rate;
    noise->follow = 1 - exp(-1 / (RISE * rate));
    noise->pole = exp(-2 * HIMC_PI * EDGE / rate);
    for (int i = 0; i < HIMC_NOISE_BANDS; i++) {
        himc_noise_band *b = &noise->band[i];
        double past[3][2] = {{0}}, power = 0, top = fmin(2 * octave[i].low, TOP * rate);
        b->keep = exp(-13.8 / (octave[i].t60 * rate));
        b->unit = 0;
        if (octave[i].low >= top)
            continue;
        b->edge[0] = edge(octave[i].low, rate, true, sqrt(2));
        b->edge[1] = edge(top, rate, false, 2 * cos(HIMC_PI / 8));
        b->edge[2] = edge(top, rate, false, 2 * sin(HIMC_PI / 8));
        for (int k = 0; k < MEASURED * rate; k++) {
            double y = filter_all(b, past, k == 0);
            power += y * y;
        }
        b->unit = 1 / sqrt(power);
    }
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

// a sample of the force feeds the octaves
static void drive(himc_stroke_noise *noise, double force)
{
    double slope = (force - noise->force) * noise->rate, stronger = fmax(force, noise->force);
    double *known = noise->slope, first = noise->pole * (known[1] + slope - known[0]);
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
        noise->band[i].energy += octave[i].drive * power;
}

void himc_stroke_noise_rest(himc_stroke_noise *noise)
{
    noise->sounds = false;
    noise->state = 0;
    noise->force = noise->slope[0] = noise->slope[1] = noise->slope[2] = 0;
    for (int i = 0; i < HIMC_NOISE_BANDS; i++) {
        himc_noise_band *b = &noise->band[i];
        b->energy = b->level = 0;
        memset(b->past, 0, sizeof b->past);
    }
}

// white noise of power 1 for an octave, from 16 of 64 bits
static double white(uint64_t bits, int octave_index)
{
    double part = (double)((bits >> (16 * octave_index)) & 0xffffu);
    return sqrt(12) * ((part + 0.5) / 65536 - 0.5);
}

// one sample of both rows
static void step(himc_stroke_noise *noise, double sample[HIMC_NOISE_ROWS])
{
    uint64_t bits[HIMC_NOISE_ROWS];
    double x[HIMC_NOISE_ROWS], heard = 0;
    for (int k = 0; k < HIMC_NOISE_ROWS; k++)
        bits[k] = himc_random_bits(&noise->state);
    sample[0] = sample[1] = 0;
    for (int i = 0; i < HIMC_NOISE_BANDS; i++) {
        himc_noise_band *b = &noise->band[i];
        b->level += noise->follow * (noise->amount * sqrt(b->energy) - b->level);
        b->energy *= b->keep;
        heard += b->energy + b->level * b->level;
        x[0] = white(bits[0], i);
        x[1] = COHERENCE * x[0] + sqrt(1 - COHERENCE * COHERENCE) * white(bits[1], i);
        for (int k = 0; k < HIMC_NOISE_ROWS; k++)
            sample[k] += b->level * b->unit * filter_all(b, b->past[k], x[k]);
    }
    if (!(heard > SILENT) && noise->force == 0)
        himc_stroke_noise_rest(noise);
}

void himc_stroke_noise_run(himc_stroke_noise *noise, int n, double force,
                           double *const row[HIMC_NOISE_ROWS])
{
    for (int i = 0; i < n; i++) {
        double sample[HIMC_NOISE_ROWS] = {0};
        noise->sounds = noise->sounds || force > 0;
        if (noise->sounds) {
            drive(noise, force);
            step(noise, sample);
        }
        for (int k = 0; k < HIMC_NOISE_ROWS; k++)
            row[k][i] = sample[k];
    }
}
