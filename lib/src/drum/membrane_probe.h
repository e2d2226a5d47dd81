/// membrane_probe.h: the shape of a head, for those who draw it; private.
#ifndef HIMC_MEMBRANE_PROBE_H
#define HIMC_MEMBRANE_PROBE_H

#include "himc/membrane.h"

/// Displacement (m) of the first `count` shapes of a bare head with its axes along x and y, of
/// which the modes are made: of what the modes have now, or of `modal` (count) (m) if it is not
/// NULL.
HIMC_RT void himc_membrane_upright(const himc_membrane *membrane, int count, const double *modal,
                                   double *displacement);

#endif
