/// contact.h: the private part of contact.c: what others need beside himc_contact_step.
#ifndef HIMC_CONTACT_H
#define HIMC_CONTACT_H

#include "himc/membrane.h"

/// The number of samples, at most `n`, in which certainly no stick touches the head, nor comes so
/// near that himc_contact_step would give another result than himc_stick_fly.
HIMC_RT int himc_contact_clear(himc_membrane *membrane, himc_stick *const *sticks, int count,
                               int n);

/// Moves a stick by one sample (h in s) without contact, as himc_contact_step does to a stick out
/// of reach.
HIMC_RT void himc_stick_fly(himc_stick *stick, double h);

/// Puts a stick that touches nothing onto the head as it is now: the height of the surface under
/// its patch.
HIMC_RT void himc_stick_put(himc_membrane *membrane, himc_stick *stick);

/// Energy in a stick and its contact after its last sample (J): m v^2/2, the felt's V(c) and that
/// of the residual oscillator; gravity not counted.
HIMC_RT double himc_contact_energy(const himc_stick *stick);

#endif
