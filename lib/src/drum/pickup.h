/// pickup.h: how loud each mode is to the ear.
#ifndef HIMC_SRC_PICKUP_H
#define HIMC_SRC_PICKUP_H

#include "himc/membrane.h"
#include "drum/modes.h"

/// Sound per unit of a mode's state; 1.0 as the pickup says.
typedef struct hearing {
    double displacement; ///< per metre of q
    double velocity;     ///< per m/s of q'
    double force;        ///< per newton of modal force phi f (N)
} hearing;

bool himc_pickup_check(const himc_pickup *pickup, const himc_head *head, himc_error *error);

/// Mode `index` of `modes`, loaded as `mode` says. `point_shape` is its shape at the pickup's point
/// (not used by HIMC_PICKUP_AIR).
hearing himc_pickup_hears(const himc_pickup *pickup, const himc_head *head, const himc_modes *modes,
                          int index, const himc_mode *mode, double point_shape);

#endif
