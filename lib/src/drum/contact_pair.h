/// meeting.h: the implicit equations of compressions that share a head; a private part of
/// contact.c.
#ifndef HIMC_CONTACT_PAIR_H
#define HIMC_CONTACT_PAIR_H

#include "himc/membrane.h"

#define MEETINGS (2 * HIMC_STICKS)

/// One compression during one sample.
typedef struct meeting {
    double k, alpha, mu; ///< F = k c^alpha (1 + mu c')
    double c0;           ///< compression before (m, negative: a gap)
    double b;            ///< change without force (m)
    double guess;        ///< of the force (N)
    double force;        ///< result (N)
    double potential0;   ///< V(c0) (J), set by the solver
} meeting;

/// V(c) = k c^(alpha+1)/(alpha+1) for c > 0 (J).
double himc_contact_pair_potential(double k, double alpha, double c);

/// Solves r_i = b_i - sum_j G_ij F_j(r_j); G (count x count, row stride MEETINGS) in m/N, symmetric
/// positive.
void himc_contact_pairs_solve(meeting *meetings, int count, double (*g)[MEETINGS], double h);

#endif
