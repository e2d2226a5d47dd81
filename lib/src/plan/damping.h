/// damping.h: a free hand lies down on a head that is damped; the damping itself is the head's.
#ifndef HIMC_DAMPING_H
#define HIMC_DAMPING_H

#include "base/head_frame.h"
#include "body/posture.h"
#include "plan/planner.h"

#define HIMC_DAMPING_FORESIGHT 0.6 ///< damping so far ahead is known (s); chosen: an easy move

typedef struct himc_damping {
    bool damped[HIMC_DRUMS]; ///< at the end of the foresight
    bool wanted[HIMC_DRUMS]; ///< a hand shall come ...
    double due[HIMC_DRUMS];  ///< ... at this time (s)
    int lies_on[HIMC_HANDS]; ///< drum + 1; 0: on none
    double lies[HIMC_HANDS]; ///< from this time on (s)
} himc_damping;

/// A head, and whether it is damped.
typedef struct himc_damped_head {
    const himc_head_frame *frame;
    bool now, soon; ///< and at the end of the foresight
} himc_damped_head;

/// The time in which a hand has nothing to play (s); empty if another source moves it.
typedef struct himc_free_hand {
    double from, until;
} himc_free_hand;

/// At `t` (s): sends the nearer free hand to each head that begins to be damped, so that it lies
/// there in time, and up again when the damping ends. Without a free hand nothing moves. True if a
/// plan has changed.
HIMC_RT bool himc_damping_move(himc_damping *damping, himc_planner *planner,
                               const himc_posture *posture, const himc_damped_head *head, int heads,
                               const himc_free_hand hand[HIMC_HANDS], double t);

#endif
