/// drum_performer.h: what a performer (performance/) needs of a drum beyond himc/drum.h: its sticks
/// in contact with the head, and the drum's place and mallet.
#ifndef HIMC_DRUM_PERFORMER_H
#define HIMC_DRUM_PERFORMER_H

#include "himc/drum.h"
#include "himc/membrane.h"

/// Forces from outside, one of each for a sample.
typedef struct himc_outside_force {
    const double *force; ///< (N, down positive), or NULL
    const double *x, *y; ///< where it acts (m), or NULL: the point stays
} himc_outside_force;

/// himc_drum_advance with sticks (0 .. HIMC_STICKS) in contact with the head.
/// @param sticks   evolve (membrane.h); may be NULL when count is 0
/// @param forces   forces[s][i] receives the force of stick s in sample i (N); NULL if unwanted
/// @param outside  or NULL
HIMC_RT void himc_drum_advance_sticks(himc_drum *drum, int n, himc_stick *const *sticks, int count,
                                      double *const *forces, const himc_outside_force *outside);

/// True once the command `place` has set its place.
HIMC_RT bool himc_drum_is_placed(const himc_drum *drum);
/// Whether a drum may stand there: within 10 m of the origin on each axis.
bool himc_drum_check_place(himc_vec3 center, himc_error *error);
/// Brings the head to rest, without a click, and drops the drum's own mallets and waiting strikes.
HIMC_RT void himc_drum_rest(himc_drum *drum);
/// Moves the head's centre (m), until the command `place` does.
HIMC_RT void himc_drum_stand(himc_drum *drum, himc_vec3 center);
/// The mallet that strikes it, set by the command `mallet`. Borrowed.
HIMC_RT const himc_mallet_head *himc_drum_mallet(const himc_drum *drum);
/// Grows by one with every change of place, radius or mallet, so that a performer notices.
HIMC_RT unsigned himc_drum_revision(const himc_drum *drum);
/// What himc_drum_set_external_sound has set.
HIMC_RT bool himc_drum_has_external_sound(const himc_drum *drum);

#endif
