/// spot.h: places where sticks meet a membrane; what contact.c needs of membrane.c.
///
/// A sample with contact is: find the spots, read their displacement, himc_membrane_free_step, read
/// again (what the head would do alone), solve, himc_spot_apply for each force.
#ifndef HIMC_SPOT_H
#define HIMC_SPOT_H

#include "himc/bank.h"
#include "himc/membrane.h"

/// A place and what it has to do with each mode. A pure function of place and head, so caching does
/// not alter results.
typedef struct spot {
    bool used;
    double x, y;       ///< (m)
    unsigned long age; ///< the larger, the more recently used
    double *shape;     ///< phi_i there, owned by the membrane
    himc_tap tap;      ///< reads the displacement there
    double compliance; ///< displacement there per newton there during a sample (m/N)
    double heard;      ///< sound per newton there
    double seen;       ///< displacement of the watched place per newton there (m/N)
} spot;

#define SPOTS 24 ///< all sticks and mallets of a drum, and the forces pushed from outside

/// The spot at (x, y); valid until SPOTS others have been asked for or the head changes.
HIMC_RT spot *himc_membrane_spot(himc_membrane *membrane, double x, double y);
/// Displacement now (m, up positive).
HIMC_RT double himc_spot_displacement(const himc_membrane *membrane, const spot *s);
/// Displacement at `a` per newton at `b` during a sample (m/N).
HIMC_RT double himc_spot_compliance(const himc_membrane *membrane, const spot *a, const spot *b);
/// One sample with the pushed forces only.
HIMC_RT void himc_membrane_free_step(himc_membrane *membrane);
/// What `force` (N, up positive) at the spot during that sample adds to it.
HIMC_RT void himc_spot_apply(himc_membrane *membrane, const spot *s, double force);

#endif
