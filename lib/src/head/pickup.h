/// pickup.h: the loudness of each mode at a pickup.
#ifndef HIMC_PICKUP_H
#define HIMC_PICKUP_H

#include "head/modes.h"

/// Sound per unit of a mode's state, in the units of himc/membrane.h (HIMC_PICKUP_PRESSURE,
/// HIMC_PICKUP_VELOCITY).
typedef struct pickup_weights {
    double displacement; ///< per metre of q
    double velocity;     ///< per m/s of q'
    double force;        ///< per newton of modal force phi f
    double gain;         ///< of himc_pickup_form; 0 of those that have none
} pickup_weights;

/// The weights of a mode of a round head at any pickup of kind AIR, but for its gain.
HIMC_RT pickup_weights himc_pickup_form(const himc_mode *mode);

/// True if the pickup's fields are in range; else an error with the field, the value and the range.
bool himc_pickup_check(const himc_pickup *pickup, const himc_head *head, himc_error *error);

/// Pressure (Pa) at a pickup of kind AIR per acceleration (m/s^2) of that mode of a round head, but
/// for the factor (-i)^m.
HIMC_RT double himc_pickup_pressure(const himc_pickup *pickup, const himc_head *head,
                                    const himc_modes *modes, int index, const himc_mode *mode);

/// The weights of mode `index` of `modes`, with the frequency, decay and mass of `mode` (in air, if
/// any). `point_shape` is its shape at the pickup's point (not used by HIMC_PICKUP_AIR).
HIMC_RT pickup_weights himc_pickup_weights(const himc_pickup *pickup, const himc_head *head,
                                           const himc_modes *modes, int index,
                                           const himc_mode *mode, double point_shape);

#endif
