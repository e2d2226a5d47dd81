/// stroke_noise.h: what felt, shaft, shell and stand answer to a blow.
#ifndef HIMC_STROKE_NOISE_H
#define HIMC_STROKE_NOISE_H

#include "himc/base.h"

#include <stdint.h>

enum { HIMC_NOISE_BANDS = 4, HIMC_NOISE_ROWS = 2 };

/// A filter of second order: two zeros, two poles.
typedef struct himc_biquad {
    double b[3], a[2];
} himc_biquad;

/// One octave of the noise.
typedef struct himc_noise_band {
    himc_biquad edge[3];                ///< its lower edge, its upper one twice
    double unit;                        ///< makes the power of filtered white noise 1
    double keep;                        ///< of its energy, a sample
    double energy;                      ///< E (1.0 is a sound of 1.0 at 1 m, squared)
    double level;                       ///< of the sound; follows `amount` sqrt(E)
    double past[HIMC_NOISE_ROWS][3][2]; ///< of these filters
} himc_noise_band;

/// The noise of a drum. It takes a copy of the contact's force and gives nothing back.
typedef struct himc_stroke_noise {
    himc_noise_band band[HIMC_NOISE_BANDS];
    double amount; ///< 0 none .. 1; may change at any time
    double rate;   ///< (Hz)
    double follow; ///< of a level towards its goal, a sample
    uint64_t state;
    double force;    ///< of the last sample (N)
    double slope[3]; ///< F' then, and what two filters leave of it (N/s)
    double pole;     ///< of these filters
    bool sounds;     ///< false: nothing is heard, and nothing need be run without a force
} himc_stroke_noise;

/// At rest, at that sample rate (Hz), with amount 1.
himc_stroke_noise himc_stroke_noise_at(double rate);
/// Sets another sample rate; the sound goes on.
HIMC_RT void himc_stroke_noise_set_rate(himc_stroke_noise *noise, double rate);
/// A contact begins at that place (m): its noise begins, the same for every blow within a
/// centimetre.
HIMC_RT void himc_stroke_noise_begin(himc_stroke_noise *noise, double x, double y);
/// The next n samples at 1 m, for two places far apart, while `force` (N) acts in each.
HIMC_RT void himc_stroke_noise_run(himc_stroke_noise *noise, int n, double force,
                                   double *const row[HIMC_NOISE_ROWS]);
/// Ends it at once.
HIMC_RT void himc_stroke_noise_rest(himc_stroke_noise *noise);

#endif
