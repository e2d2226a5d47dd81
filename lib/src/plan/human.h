/// human.h: how a player's strokes differ from what is written: in time, force, place and angle.
#ifndef HIMC_HUMAN_H
#define HIMC_HUMAN_H

#include "plan/planner_score.h"

#include <stdint.h>

/// How much a player varies, and who plays.
typedef struct himc_human {
    double amount; ///< 0 not at all .. 1
    uint32_t seed; ///< names the player: another seed varies otherwise
} himc_human;

/// The difference of one stroke from what is written.
typedef struct himc_variation {
    double late;            ///< (s), negative: early
    double log_speed;       ///< log of the factor of the impact speed
    double outwards, aside; ///< along and across the radius of the head (m)
    double hand_x, hand_y;  ///< of this hand everywhere, in the head's frame (m)
    double turn;            ///< of the swing's plane, about the head's normal (rad)
    bool together;          ///< the other hand strikes at nearly the same time
} himc_variation;

/// Of a stroke of the score on that beat of a round. A pure function: whoever asks, however often
/// and from wherever play began, gets the same.
HIMC_RT himc_variation himc_human_stroke(const himc_human *human, const planner_score *score,
                                         himc_hand hand, int round, double beat);

/// Of the hit number `count` (0, 1, ..). It is never early, since a hit comes as soon as it can,
/// and `together`, since what the other hand will be told is not known.
HIMC_RT himc_variation himc_human_hit(const himc_human *human, himc_hand hand, int count);

/// Moves a place on a head (m) to where a hand with that variation strikes. Hands that strike
/// together do not come nearer to each other, if the left one plays on its side.
HIMC_RT void himc_variation_place(const himc_variation *variation, himc_hand hand, double *x,
                                  double *y);

#endif
