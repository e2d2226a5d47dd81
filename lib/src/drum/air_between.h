/// air_between.h: drums hear each other: what one radiates moves the heads beside it.
#ifndef HIMC_AIR_BETWEEN_H
#define HIMC_AIR_BETWEEN_H

#include "drum/drum_performer.h"

#define HIMC_NEIGHBOURS 8 ///< most drums that hear each other; chosen: two sets of timpani

#define HIMC_AIR_AZIMUTHS 32 ///< of the directions; chosen: exact to 1e-4 for k d up to 15
#define HIMC_AIR_BANDS 10    ///< of frequency, from 30 to 680 Hz, above all shared modes
#define HIMC_AIR_DIRECTIONS (HIMC_SHARED_RINGS * HIMC_AIR_AZIMUTHS)

/// A drum as seen from a direction.
typedef struct himc_air_view {
    double cosine[3], sine[3];                     ///< of m times its azimuth
    double re[HIMC_AIR_BANDS], im[HIMC_AIR_BANDS]; ///< exp(-i k q.r)
} himc_air_view;

/// The air between some drums. 0: there is none. It costs nothing while no two are near.
typedef struct himc_air_between {
    int count;                          ///< of drums that hear each other
    himc_drum *drum[HIMC_NEIGHBOURS];   ///< borrowed
    unsigned revision[HIMC_NEIGHBOURS]; ///< of the heads that `change` is for
    int first[HIMC_NEIGHBOURS + 1];     ///< where a drum's shared modes begin in `change`
    himc_air_view view[HIMC_NEIGHBOURS][HIMC_AIR_DIRECTIONS]; ///< of the drums where they stand
    /// of all velocities in an exchange, per velocity
    double change[HIMC_NEIGHBOURS * HIMC_SHARED][HIMC_NEIGHBOURS * HIMC_SHARED];
} himc_air_between;

/// Finds the drums among these (at most HIMC_DRUMS, one rate) that hear each other. To be called
/// after any change of a place or of the set of drums; changes of heads are noticed. Drums that no
/// longer belong to it must be let go before.
HIMC_RT void himc_air_between_join(himc_air_between *air, himc_drum *const *drums, int count);
/// From now on this drum, if it belongs to it, is alone; `join` follows, or the end.
HIMC_RT void himc_air_between_leave(himc_air_between *air, himc_drum *drum);

/// Samples from `now` to the next exchange, at most n; all drums are then to be advanced so far.
HIMC_RT int himc_air_between_until(const himc_air_between *air, int64_t now, int n);
HIMC_RT bool himc_air_between_due(const himc_air_between *air, int64_t now);
HIMC_RT void himc_air_between_exchange(himc_air_between *air);

#endif
