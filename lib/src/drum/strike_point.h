/// spot.h: places where sticks meet a membrane; what contact.c needs of membrane.c.
///
/// A sample with contact is: find the spots, read their displacement, himc_membrane_free_step, read
/// again (what the head would do alone), solve, himc_strike_point_apply for each force, and
/// himc_membrane_settle. A stiff contact does so for each part of a sample (himc_membrane_part).
#ifndef HIMC_STRIKE_POINT_H
#define HIMC_STRIKE_POINT_H

#include "drum/bank.h"
#include "himc/membrane.h"

/// What a newton during a step, a sample or a part of one, does at its end.
typedef struct effect {
    double compliance;          ///< displacement at the place itself (m/N)
    double heard[HIMC_PICKUPS]; ///< sound (1/N)
    double seen;                ///< displacement of the watched place (m/N)
} effect;

/// A place and what it has to do with each mode. A pure function of place and head, so caching does
/// not alter results.
typedef struct spot {
    bool used;
    double x, y;       ///< (m)
    unsigned long age; ///< the larger, the more recently used
    double *shape;     ///< phi_i there, owned by the membrane
    himc_readout tap;  ///< reads the displacement there
    effect effect[HIMC_BANK_SUBSTEPS];
} spot;

#define SPOTS 24 ///< all sticks and mallets of a drum, and the forces pushed from outside

/// The spot at (x, y); valid until SPOTS others have been asked for or the head changes.
HIMC_RT spot *himc_membrane_strike_point(himc_membrane *membrane, double x, double y);
/// Displacement now (m, up positive).
HIMC_RT double himc_strike_point_displacement(const himc_membrane *membrane, const spot *s);
/// Into how many parts a sample is divided for a stiff contact: steps of 5 microseconds or less.
HIMC_RT int himc_membrane_parts(const himc_membrane *membrane);
/// What comes is part `index` of a sample, 0 .. parts - 1; before and after, steps are whole
/// samples, and `index` is 0 of 1.
HIMC_RT void himc_membrane_part(himc_membrane *membrane, int index, int parts);
/// What a newton at the spot does in a step now.
HIMC_RT const effect *himc_strike_point_effect(const himc_membrane *membrane, const spot *s);
/// Displacement at `a` per newton at `b` during a sample (m/N).
HIMC_RT double himc_strike_point_compliance(const himc_membrane *membrane, const spot *a,
                                            const spot *b);
/// One sample with the pushed forces only, the film's pull still to come. Returns P . F of these
/// forces, down positive.
HIMC_RT double himc_membrane_free_step(himc_membrane *membrane);
/// P: what the film's pull moves at a spot in this sample (m/J^1/2).
HIMC_RT double himc_strike_point_pull(const himc_membrane *membrane, const spot *s);
/// The film's pull in this sample (J^1/2): the value returned less `half` times P . F.
HIMC_RT double himc_membrane_tension(const himc_membrane *membrane, double *half);
/// What `force` (N, up positive) at the spot during that sample adds to it.
HIMC_RT void himc_strike_point_apply(himc_membrane *membrane, const spot *s, double force);
/// Lets the film pull, `taken` being P . F of all forces (down positive). Ends the sample.
HIMC_RT void himc_membrane_settle(himc_membrane *membrane, double taken);

#endif
