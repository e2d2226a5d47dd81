/// felt.h: the force of a mallet's head over a step, from the change of its compression.
#ifndef HIMC_FELT_H
#define HIMC_FELT_H

#include "himc/membrane.h"

/// A power law k max(c, 0)^exponent and its value at the beginning of a step.
typedef struct felt_term {
    double k, exponent;
    double c0;        ///< compression of this part (m)
    double force;     ///< k c0^exponent (N)
    double potential; ///< (J)
} felt_term;

/// A felt at the beginning of a step.
typedef struct felt {
    felt_term outer, core;
    double loss, relaxation; ///< mu (s/m), tau (s)
} felt;

/// The felt of `head`, all its forces times `scale`, at compression `c0` (m; negative: a gap).
HIMC_RT felt himc_felt_at(const himc_mallet_head *head, double scale, double c0);

/// Force (N) of a step of length `h` (s) in which the compression changes by `r` (m), and its
/// derivative (N/m).
HIMC_RT double himc_felt_force(const felt *f, double r, double h, double *slope);

/// Potential energy (J).
static inline double himc_felt_potential(const felt *f)
{
    return f->outer.potential + f->core.potential;
}

#endif
