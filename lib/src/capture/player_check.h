/// player_check.h: whether joint centres belong to a human body; private.
#ifndef HIMC_PLAYER_CHECK_H
#define HIMC_PLAYER_CHECK_H

#include "capture/player_points.h"

/// A segment as two centres a length apart.
typedef struct player_measure {
    int segment; ///< of the left side
    player_point from, to;
    double usual;    ///< (m), of a man of 1.741 m (de Leva 1996)
    bool tells_size; ///< of the body: sticks and hands do not
} player_measure;

#define PLAYER_LIMBS 6
#define PLAYER_SPINE 3
extern const player_measure himc_player_limbs[PLAYER_LIMBS], himc_player_spine[PLAYER_SPINE];

/// The length if it may be one of those, else 0.
double himc_player_plausible(double length, double usual);
/// Drops centres that do not keep their distance, with a note. False if the body is of no human
/// size or left and right are exchanged.
bool himc_player_check(player_points *points, himc_player *player, himc_error *error);

#endif
