/// shared.h: the modes of a head that radiate enough to move the heads beside it.
#ifndef HIMC_SHARED_H
#define HIMC_SHARED_H

#include "head/air.h"
#include "head/modes.h"

#define HIMC_SHARED 5       ///< (0,1), both of (1,1) and of (2,1)
#define HIMC_SHARED_RINGS 6 ///< elevations at which sound leaves

/// Such a mode.
typedef struct himc_shared_mode {
    int index;    ///< in the head's list
    int order;    ///< m
    double omega; ///< (rad/s)
    double mass;  ///< (kg)
    double decay; ///< by what it radiates (1/s): the air between the heads takes it, not the mode
    /// amplitude of its sound far away over its velocity, sqrt(kg/s) and less by (-i)^m, as
    /// along cos(m azimuth) + across sin(m azimuth) at sines of the elevation; its square summed
    /// over all directions is 2 mass decay
    double along[HIMC_SHARED_RINGS], across[HIMC_SHARED_RINGS];
} himc_shared_mode;

/// Sines of the elevations, and their parts of the upper half of all directions (sum 1).
extern const double himc_shared_sine[HIMC_SHARED_RINGS], himc_shared_part[HIMC_SHARED_RINGS];

/// Decay (1/s) of a round head's mode by what it sends in orders that are not its own, mixed in by
/// an uneven tension; in a baffle.
HIMC_RT double himc_shared_by_other_orders(const himc_head *head, const himc_modes *modes,
                                           int index, const himc_mode *mode);

/// The shared modes of a round head in air, below `highest` (Hz). `mode` gives each as it sounds
/// without neighbours. Returns their number, at most HIMC_SHARED.
HIMC_RT int himc_shared_find(const himc_head *head, const himc_modes *modes, const himc_air *air,
                             double highest, himc_shared_mode *shared);

#endif
