/// uneven.h: the modes of a round head whose tension is uneven: mixtures of those of an even one.
#ifndef HIMC_UNEVEN_H
#define HIMC_UNEVEN_H

#include "himc/base.h"

#define HIMC_UNEVEN_ORDERS 15 ///< orders 0 .. 14 are mixed, which radiate below 1 kHz; chosen ...
#define HIMC_UNEVEN_RANKS 4   ///< ... each of so many n
#define HIMC_UNEVEN_MODES 60  ///< most modes of a block: 8 orders, 7 with two of each

typedef struct himc_modes himc_modes;

/// Modes that mix: those of all even, or of all odd orders, since a field of even order k couples m
/// to m + k and m - k. Shape i of the uneven head is sum_j part[i][j] times shape j of the even
/// one.
typedef struct himc_uneven_block {
    int count;
    int index[HIMC_UNEVEN_MODES]; ///< in the list of modes
    struct {
        int m;
        double zero, slope;  ///< j_mn and J_m+1 there
        double cosine, sine; ///< of the angle a: cos(m th - a)
    } even[HIMC_UNEVEN_MODES];
    double part[HIMC_UNEVEN_MODES][HIMC_UNEVEN_MODES];
} himc_uneven_block;

/// Two harmonics of the tension couple two entries of the list: k = |m - m'| and k = m + m'.
typedef struct himc_uneven_pair himc_uneven_pair;

/// The integrals over radius of all pairs of entries that an uneven tension couples (`count`): they
/// depend on the list alone. Owned by the caller (free); NULL without memory.
himc_uneven_pair *himc_uneven_pairs(const himc_modes *modes, int *count);

/// Finds the modes of the uneven head: sets the blocks of `modes`, and makes of the stiffnesses
/// (N/m) of the even head's modes, as many as the list has, in air or not, those of the uneven
/// one's. Their masses (kg) stay. `tension` (N/m) is the mean one.
HIMC_RT void himc_uneven_find(himc_modes *modes, double tension, const double *mass,
                              double *stiffness);

/// The block that has mode `index`, and its row there; NULL if it mixes with none.
HIMC_RT const himc_uneven_block *himc_uneven_of(const himc_modes *modes, int index, int *row);

#endif
