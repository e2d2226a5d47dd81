/// contact.h: what drum.c needs of contact.c beside himc_contact_step.
#ifndef HIMC_CONTACT_H
#define HIMC_CONTACT_H

#include "himc/membrane.h"

/// The number of samples, at most `n`, in which certainly no stick comes within HIMC_CONTACT_REACH
/// of the head.
HIMC_RT int himc_contact_clear(const himc_membrane *membrane, himc_stick *const *sticks, int count,
                               int n);

/// Moves a stick by one sample (h in s) without contact, as himc_contact_step does to a stick out
/// of reach.
HIMC_RT void himc_stick_fly(himc_stick *stick, double h);

#endif
