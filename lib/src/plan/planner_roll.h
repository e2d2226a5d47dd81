/// planner_roll.h: rolls of the score: each is one entry, its strokes are made when they are asked
/// for.
#ifndef HIMC_PLANNER_ROLL_H
#define HIMC_PLANNER_ROLL_H

#include "plan/planner_score.h"

/// A buzz of a press roll lasts so many strokes. Chosen: the hands overlap.
#define PLANNER_PRESS_OVERLAP 1.1
/// Bounces take so much of the time to the hand's next stroke, at most. Chosen: contacts of a
/// double roll are even ...
#define PLANNER_DOUBLE_SHARE 0.25
/// ... and a buzz ends when the other hand has struck.
#define PLANNER_BUZZ_SHARE 0.55

/// To another stroke of the hand, at least (s). Chosen: a grace note takes so long.
#define PLANNER_LEAST_ROOM 0.08

HIMC_RT static inline double himc_planner_bounce_share(int bounces)
{
    return bounces == HIMC_BUZZ ? PLANNER_BUZZ_SHARE : bounces ? PLANNER_DOUBLE_SHARE : 0;
}

/// Adds a roll of so many strokes a second of both hands; `stroke` has its kind, length and
/// dynamics. Returns its index, or -1 with the reason.
int himc_planner_roll_insert(planner_score *score, const himc_stroke *stroke, int drum, double rate,
                             himc_error *error);
/// How many of a roll's strokes are left out, too near to other strokes of their hand.
int himc_planner_roll_left_out(const planner_score *score, int roll);
bool himc_planner_roll_equal(const planner_score *a, const planner_score *b);
/// True if the strokes of the same rolls are at the same times in both.
bool himc_planner_roll_same_places(const planner_score *a, const planner_score *b);
/// The stroke of a hand at `place` or after it, with its place, without its time; false if there is
/// none left.
HIMC_RT bool himc_planner_roll_due(const planner_score *score, himc_hand hand, planner_place *place,
                                   planner_due *due);
/// The hand's next stroke of a roll is the first one that comes later than `t` (s) after the
/// beginning of that round.
HIMC_RT void himc_planner_roll_from(planner_score *score, himc_hand hand, int round, double t);
/// The tempo is about to change: of a roll that has begun the strokes that are not planned yet are
/// counted anew, from the last one that is and comes no later than `t` (s): what was given up ahead
/// of its time may be played at the new tempo. True if there was such a one.
HIMC_RT bool himc_planner_roll_anchor(planner_score *score, double t);
/// Beat of the last stroke of the score, of a roll or a list, -1 without any.
HIMC_RT double himc_planner_roll_last_beat(const planner_score *score);
/// Beat at which a roll ends: where it is written to, or where the next one begins.
HIMC_RT double himc_planner_roll_end(const planner_score *score, int roll);
/// The roll that takes the place of another one from its beginning or within it; NULL if there is
/// none.
const planner_roll *himc_planner_roll_cut_by(const planner_score *score, int roll);
/// The drum on which a hand plays a roll: two rolls together have a hand each.
HIMC_RT int himc_planner_roll_drum(const planner_score *score, int roll, himc_hand hand);
/// Beats of the strokes of a hand (HIMC_HAND_ANY: of both) next to a beat of a round and not on it;
/// -HUGE_VAL and HUGE_VAL if there is none.
HIMC_RT void himc_planner_roll_near(const planner_score *score, himc_hand hand, int round,
                                    double beat, double *before, double *after);
/// Beat of the last stroke of a roll before a beat; of a roll that ends there, which makes room for
/// grace notes, its first one. Below 0: there is none.
HIMC_RT double himc_planner_roll_since(const planner_score *score, double beat);
/// A walk back through the strokes of all rolls of a round: first those at and before `beat` ...
HIMC_RT planner_place himc_planner_roll_walk(const planner_score *score, int round, double beat);
/// ... whose last has this beat and hand; false if none is left. HIMC_RT.
HIMC_RT bool himc_planner_roll_back(const planner_score *score, planner_place *walk, double *beat,
                                    himc_hand *hand);

#endif
