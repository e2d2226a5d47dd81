/// sticking.h: what a stroke costs a hand, so that strokes are shared by both hands as a player
/// shares them.
///
///     40 max(0, need - gap)/need + (.3 need/gap)^2 + 1.5 D + 2 max(0, .22 s/gap - 1)
///     + .6 if the hands cross, 3 more if the other one has just struck
///     + .2 if it strikes the same spot again, after less than 2 s, and was the last to strike
///
/// with `gap` the time since the hand's last stroke, D the way from there, and need = .10 + .1
/// log2(2 D/.1 + 1) s (Fitts 1954, MacKay's form; .09 s on the spot). A hand that has waited until
/// a live hit was asked for had no time before for its way: the first two terms are left out, and
/// whoever asks counts how late it comes. The weights are chosen: one drum is played hand by hand,
/// two drums in the middle by sides, outer drums by the hand of their side.
#ifndef HIMC_STICKING_H
#define HIMC_STICKING_H

#include "himc/base.h"

#include <math.h>

// chosen: five strokes on a drum between both hands are worth the other hand's way there, two are
// not: two drums in turn are played by sides
#define HIMC_STICKING_AGAIN 0.2
#define HIMC_STICKING_ANEW 2.0 ///< (s) chosen: after a longer rest the hands begin anew

#define HIMC_STICKING_CROSS 0.05 ///< hands cross if one is so far past the other (m)

static inline himc_hand himc_other_hand(himc_hand hand)
{
    return hand == HIMC_LEFT ? HIMC_RIGHT : HIMC_LEFT;
}

/// A hand on its way to a stroke.
typedef struct himc_sticking {
    double gap;       ///< time since its last stroke, above 0 (s)
    bool waits;       ///< and has begun its way only now
    double way;       ///< from where it comes (m)
    bool same_spot;   ///< its last stroke was there, too
    double inwards;   ///< of the stroke, past the other hand (m)
    double other_gap; ///< time since the other hand's last stroke (s)
} himc_sticking;

static inline double himc_sticking_cost(const himc_sticking *s)
{
    double need = s->way > 0 ? 0.10 + 0.1 * log2(2 * s->way / 0.1 + 1) : 0.09;
    double cost = 1.5 * s->way + 2 * fmax(0, 0.22 / s->gap - 1);
    if (!s->waits)
        cost += 40 * fmax(0, need - s->gap) / need + pow(0.3 * need / s->gap, 2);
    if (s->inwards > HIMC_STICKING_CROSS)
        cost += s->other_gap < 0.15 ? 3.6 : 0.6;
    bool again = s->same_spot && s->gap < s->other_gap && s->gap < HIMC_STICKING_ANEW;
    return cost + (again ? HIMC_STICKING_AGAIN : 0);
}

#endif
