/// stroke_noise.h: what felt, shaft, shell and stand answer to a blow.
#ifndef HIMC_STROKE_NOISE_H
#define HIMC_STROKE_NOISE_H

#include "himc/base.h"

enum { HIMC_NOISE_BANDS = 4, HIMC_NOISE_ROWS = 2 };
enum { HIMC_NOISE_LANES = HIMC_NOISE_BANDS * HIMC_NOISE_ROWS };

/// A filter of second order for each row of each band, with the rows of a band side by side.
typedef struct himc_noise_section {
    double a[2][HIMC_NOISE_LANES]; ///< poles
    double past[2][HIMC_NOISE_LANES];
} himc_noise_section;

/// One band of the noise.
typedef struct himc_noise_band {
    double unit;  ///< makes the power of filtered white noise 1
    double keep;  ///< of its amplitude, a sample
    double root;  ///< sqrt(E), its amplitude (1.0 is a sound of 1.0 at 1 m)
    double level; ///< of the sound; follows `amount` sqrt(E)
} himc_noise_band;

/// The noise of a drum. It takes a copy of the contact's force and gives nothing back.
typedef struct himc_stroke_noise {
    himc_noise_section section[3]; ///< the bands' lower edge, their upper one twice
    himc_noise_band band[HIMC_NOISE_BANDS];
    double amount;          ///< 0 none .. 1; may change at any time
    double rate;            ///< (Hz)
    double damp;            ///< by what lies on the head, 0 .. 1 as `damp` of himc/membrane.h ...
    double held;            ///< ... of an amplitude, a sample
    double follow;          ///< of a level towards its goal, a sample
    int seed;               ///< of the drum's own sequence, 0 .. HIMC_SEED_MAX
    uint64_t state, common; ///< of the two sequences, the place's and the drum's
    double force;           ///< of the last sample (N)
    double slope[3];        ///< F' then, and what two filters leave of it (N/s)
    double pole;            ///< of these filters
    int sounds; ///< bands that are heard, the lowest first; 0: nothing need be run without a force
} himc_stroke_noise;

/// At rest, at that sample rate (Hz), with amount 1.
himc_stroke_noise himc_stroke_noise_at(double rate);
/// Sets another sample rate; the sound goes on.
HIMC_RT void himc_stroke_noise_set_rate(himc_stroke_noise *noise, double rate);
/// What lies on the head ends its noise as it ends its modes: a hand of that `damp` (0 .. 1,
/// himc/membrane.h), or a cloth as heavy.
HIMC_RT void himc_stroke_noise_damp(himc_stroke_noise *noise, double damp);
/// A contact begins at that place (m): its noise begins, the same for every blow within two
/// centimetres, and alike for all.
HIMC_RT void himc_stroke_noise_begin(himc_stroke_noise *noise, double x, double y);
/// The next n samples at 1 m, for `rows` (1, 2) places far apart, while `force` (N) acts in each.
HIMC_RT void himc_stroke_noise_run(himc_stroke_noise *noise, int n, double force, int rows,
                                   double *const row[HIMC_NOISE_ROWS]);
HIMC_RT void himc_stroke_noise_rest(himc_stroke_noise *noise);

#endif
