/// membrane_probe.h: the inner state of a head, set and read by tests; private.
#ifndef HIMC_MEMBRANE_PROBE_H
#define HIMC_MEMBRANE_PROBE_H

#include "himc/membrane.h"

/// Sets displacement q and velocity v of mode `index` (m, m/s); no effect on a silent mode.
HIMC_RT void himc_membrane_excite(himc_membrane *membrane, int index, double q, double v);

/// Rise of the tension as the head bows out (N/m).
HIMC_RT double himc_membrane_rise(const himc_membrane *membrane);

#endif
