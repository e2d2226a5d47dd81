/// hand.h: the motion of one tip, planned chunk by chunk from where it is.
#ifndef HIMC_HAND_H
#define HIMC_HAND_H

#include "plan/gesture.h"
#include "base/spline.h"

/// Where, when and how a tip shall touch.
typedef struct himc_goal {
    double time;      ///< of the touch (s)
    himc_vec3 spot;   ///< of the tip at the touch (m)
    himc_vec3 normal; ///< of the head, up
    himc_vec3 back;   ///< unit vector in the head's plane towards the player
    himc_gesture gesture;
} himc_goal;

/// The tip's motion is the sum of two chains: over the head's plane, and above it.
typedef struct himc_hand_plan {
    himc_spline ground, lift;
    double end;     ///< both chains reach to here (s)
    himc_goal last; ///< the touch before that, with the gesture as it was played
    bool struck;    ///< the plan ends where that touch did, nothing after it is planned
    bool away;      ///< the tip is where it was sent, not over the last spot
    himc_vec3 home; ///< where it waits when there is nothing to play (m)
    bool swayed;    ///< which way it swayed last
} himc_hand_plan;

/// Length of a predicted contact, touch to separation (s).
#define HIMC_CONTACT_TIME 0.007

/// At `home` at time t, still.
HIMC_RT void himc_hand_place(himc_hand_plan *plan, double t, himc_vec3 home);

HIMC_RT himc_target himc_hand_at(const himc_hand_plan *plan, double t);

/// Forgets what comes after t; the plan ends there.
HIMC_RT void himc_hand_cut(himc_hand_plan *plan, double t);

/// Goes on from a state measured at t, after a touch; what acceleration the contact left dies out
/// within a small part of the time to the `next` touch (s, may be infinite).
HIMC_RT void himc_hand_restart(himc_hand_plan *plan, double t, const himc_target *state,
                               double next);

/// Whether another chunk has room.
HIMC_RT bool himc_hand_room(const himc_hand_plan *plan);

/// Time the tip needs from the plan's end to play the goal's gesture unhurried (s), and at the
/// least.
HIMC_RT double himc_hand_time(const himc_hand_plan *plan, const himc_goal *goal);
HIMC_RT double himc_hand_least_time(const himc_hand_plan *plan, const himc_goal *goal);

/// Whether anyone could be there in time.
HIMC_RT bool himc_hand_can_strike(const himc_hand_plan *plan, const himc_goal *goal);

/// Appends all up to the end of that stroke's contact. False, and nothing appended, if it cannot be
/// played.
HIMC_RT bool himc_hand_strike(himc_hand_plan *plan, const himc_goal *goal);

/// Appends some waiting, to `until` (s) at the least: over the last spot when `ready`, else at
/// home.
HIMC_RT void himc_hand_wait(himc_hand_plan *plan, double until, bool ready);

/// Appends the way to x, which becomes home.
HIMC_RT void himc_hand_reach(himc_hand_plan *plan, himc_vec3 x);

/// Forgets what is planned from t on and follows: within `blend` seconds the tip is at `aim` and
/// moves as it says, goes on so for `hold` seconds and, if nothing else comes, comes to rest.
HIMC_RT void himc_hand_follow(himc_hand_plan *plan, double t, const himc_target *aim, double blend,
                              double hold);

#endif
