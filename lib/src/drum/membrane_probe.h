/// membrane_probe.h: the inner state of a head, for tests and for those who draw it; private.
#ifndef HIMC_MEMBRANE_PROBE_H
#define HIMC_MEMBRANE_PROBE_H

#include "himc/membrane.h"

/// Sets displacement q and velocity v of mode `index` (m, m/s); no effect on a silent mode.
HIMC_RT void himc_membrane_excite(himc_membrane *membrane, int index, double q, double v);

/// Displacement (m) of the first `count` shapes of a bare head with its axes along x and y, of
/// which the modes are made: of what the modes have now, or of `modal` (count) (m) if it is not
/// NULL.
HIMC_RT void himc_membrane_upright(const himc_membrane *membrane, int count, const double *modal,
                                   double *displacement);

/// Displacement at (x, y) (m, up positive).
HIMC_RT double himc_membrane_displacement(const himc_membrane *membrane, double x, double y);

/// Rise of the tension as the head bows out (N/m).
HIMC_RT double himc_membrane_rise(const himc_membrane *membrane);

#endif
