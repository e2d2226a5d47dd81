/// pickup.h: the loudness of each mode at a pickup.
#ifndef HIMC_PICKUP_H
#define HIMC_PICKUP_H

#include "head/modes.h"
#include "head/uneven.h"

/// Weights of a mode whose pressure per acceleration is `gain`, but for (-i)^m.
HIMC_RT pickup_weights himc_pickup_of_gain(const himc_mode *mode, double gain);
/// `form` and `far` of a round head (kind.h).
HIMC_RT pickup_weights himc_pickup_form(const himc_mode *mode);
HIMC_RT pickup_weights himc_pickup_of_round(const himc_pickup *pickup, const himc_head *head,
                                            const himc_modes *modes, int index,
                                            const himc_mode *mode);
/// `far` of any other outline: its transform, in phase and a quarter of a period apart.
HIMC_RT pickup_weights himc_pickup_of_outline(const himc_pickup *pickup, const himc_head *head,
                                              const himc_modes *modes, int index,
                                              const himc_mode *mode);

/// True if the pickup's fields are in range; else an error with the field, the value and the range.
bool himc_pickup_check(const himc_pickup *pickup, const himc_head *head, himc_error *error);

/// Pressure (Pa) at a pickup of kind AIR per acceleration (m/s^2) of that mode of a round head, but
/// for the factor (-i)^m.
HIMC_RT double himc_pickup_pressure(const himc_pickup *pickup, const himc_head *head,
                                    const himc_modes *modes, int index, const himc_mode *mode);

/// What a mode of a round head, mixed by an uneven tension or not, sends by order and sign: its
/// pressure (as of himc_pickup_pressure, with the factor (-i)^(m - own order)) is the sum over m of
/// cosine[m] cos(m azimuth) + sine[m] sin(m azimuth).
typedef struct himc_pickup_orders {
    double cosine[HIMC_UNEVEN_ORDERS], sine[HIMC_UNEVEN_ORDERS];
} himc_pickup_orders;

/// False, and nothing, of a mode that mixes with no other.
HIMC_RT bool himc_pickup_find_orders(const himc_pickup *pickup, const himc_head *head,
                                     const himc_modes *modes, int index, const himc_mode *mode,
                                     himc_pickup_orders *orders);

/// The weights of mode `index` of `modes`, with the frequency, decay and mass of `mode` (in air, if
/// any). `point_shape` is its shape at the pickup's point (not used by HIMC_PICKUP_AIR).
HIMC_RT pickup_weights himc_pickup_weights(const himc_pickup *pickup, const himc_head *head,
                                           const himc_modes *modes, int index,
                                           const himc_mode *mode, double point_shape);

#endif
