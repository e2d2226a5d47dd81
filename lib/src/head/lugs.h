/// lugs.h: a head whose lugs pull unevenly: its pairs of modes split, along fixed axes.
#ifndef HIMC_LUGS_H
#define HIMC_LUGS_H

#include "himc/base.h"

#define HIMC_LUGS_ORDERS 160 ///< more than 4000 modes have (about 125)

/// The pairs (m, n) of all n. Their members are cosine and sine of m times the azimuth from `axis`,
/// on which the cosine has an antinode.
typedef struct himc_lugs_pair {
    double split;        ///< frequency of the sine less that of the cosine, per their mean; >= 0
    double axis;         ///< (rad)
    double cosine, sine; ///< of m times `axis`
} himc_lugs_pair;

#define HIMC_LUGS_FIELD 8 ///< highest harmonic of the tension that mixes orders (uneven.h)

/// A harmonic of the tension over its mean, amount cos(k azimuth - phase).
typedef struct himc_lugs_harmonic {
    double amount, phase;
} himc_lugs_harmonic;

/// Harmonics 0, 2 .. HIMC_LUGS_FIELD, by k/2; that of 0 is none.
HIMC_RT void himc_lugs_fields(double uniformity, int seed,
                              himc_lugs_harmonic field[HIMC_LUGS_FIELD / 2 + 1]);

/// Pairs of order 0 .. HIMC_LUGS_ORDERS - 1 of a head of that `uniformity` (0 .. 1); with 1 no pair
/// is split and all axes are 0.
HIMC_RT void himc_lugs_split(double uniformity, int seed, himc_lugs_pair *pairs);

#endif
