/// hand.h: the motion of one tip, planned stroke by stroke, each from the end of the last.
#ifndef HIMC_HAND_H
#define HIMC_HAND_H

#include "plan/gesture.h"
#include "base/spline.h"

/// Where, when and how a tip shall touch.
typedef struct himc_goal {
    double time;      ///< of the touch (s)
    himc_vec3 spot;   ///< position of the tip at the touch (m)
    himc_vec3 normal; ///< of the head, up
    himc_vec3 back;   ///< unit vector in the head's plane towards the player
    himc_gesture gesture;
    double hold;   ///< after the touch the tip bounces for so long, the hand at its height (s)
    bool straight; ///< the way there bows out round the body no farther than it must
} himc_goal;

/// Speed over the time between two touches of an arm in a hurry (m/s^2): it is helped by the
/// rebound where the tip stays, and not on its way to another place.
static inline double himc_goal_hurry(himc_vec3 from, himc_vec3 to)
{
    const double same = 0.2; // (m) chosen: spots of one head
    return himc_vec3_length(himc_vec3_sub(to, from)) < same ? HIMC_HURRY_AGAIN : HIMC_HURRY;
}

/// The tip's motion is the sum of three splines: along the head's plane, above it, and a lift over
/// the other hand, which is zero at every touch.
typedef struct himc_hand_plan {
    himc_spline tangential_path, height_profile, lift;
    double end;      ///< both splines reach to here (s)
    himc_goal last;  ///< the last touch before `end`, with the gesture as it was played
    bool rebounding; ///< at `end` the tip still rebounds from that touch
    bool at_home;    ///< at `end` the tip is at `home`, not over the last spot
    himc_vec3 home;  ///< where the tip waits when there is nothing to play (m)
    bool swayed;     ///< side of the last sway
} himc_hand_plan;

/// Length of a predicted contact, touch to separation (s). Chosen: contacts of the four timpani
/// with the medium mallet last 3.5 to 8.5 ms, and none should end after its prediction.
#define HIMC_CONTACT_TIME 0.009

/// End of the goal's predicted contact, or of its bounces (s).
static inline double himc_goal_end(const himc_goal *goal)
{
    return goal->time + HIMC_CONTACT_TIME + goal->hold;
}

/// Peak acceleration along the head (m/s^2), at most: a stroke that needs more is refused. Chosen:
/// well beyond captured strokes, so that only the impossible is refused.
#define HIMC_HARDEST_MOVE 250.0

/// Peak acceleration of an arm in a hurry (m/s^2): of a lift at most, of a move without time.
/// Chosen, so that a hit from rest lands within 0.25 s.
#define HIMC_QUICK_MOVE 80.0

/// At rest at `home` from time t on.
HIMC_RT void himc_hand_place(himc_hand_plan *plan, double t, himc_vec3 home);

/// State of the tip at t.
HIMC_RT himc_target himc_hand_at(const himc_hand_plan *plan, double t);

/// Drops all motion after t; the plan ends there.
HIMC_RT void himc_hand_cut(himc_hand_plan *plan, double t);

/// Moves the tip by `way` (m) from `from` to `to` (s), not at all at `begin` and at `end`. False,
/// and nothing changed, if no hand can be so quick, or another lift is under way.
HIMC_RT bool himc_hand_lift(himc_hand_plan *plan, double begin, double from, double to, double end,
                            himc_vec3 way);
/// Goes on from a state measured at t, after a touch. The acceleration that the contact left fades
/// to zero within a small part of the time to the `next` touch (s, may be infinite).
HIMC_RT void himc_hand_restart(himc_hand_plan *plan, double t, const himc_target *state,
                               double next);

/// True if there is room for another stroke or wait.
HIMC_RT bool himc_hand_room(const himc_hand_plan *plan);

/// Time the tip needs from the plan's end to play the goal's gesture without hurry (s) ...
HIMC_RT double himc_hand_time(const himc_hand_plan *plan, const himc_goal *goal);
/// ... and in the greatest hurry (s).
HIMC_RT double himc_hand_least_time(const himc_hand_plan *plan, const himc_goal *goal);

/// No stick is faster (m/s). Chosen: the head of a golf club, swung with both arms; captured
/// strokes have up to 10 m/s.
#define HIMC_FASTEST_TIP 50.0

/// True if a body can follow the plan from `from` (s) on: all of it is finite, and no part is
/// faster than HIMC_FASTEST_TIP.
HIMC_RT bool himc_hand_is_sound(const himc_hand_plan *plan, double from);

/// True if a tip can reach the goal in time without superhuman speed or acceleration, its gesture
/// is not too slow, and the tip is not so high that it would strike much harder.
HIMC_RT bool himc_hand_can_strike(const himc_hand_plan *plan, const himc_goal *goal);

/// Impact speed at the goal of a fall at once from the plan's state at t, at least (m/s).
HIMC_RT double himc_hand_least_speed(const himc_hand_plan *plan, double t, const himc_goal *goal);
/// True if the tip could do so if its plan were cut at t.
HIMC_RT bool himc_hand_can_strike_from(const himc_hand_plan *plan, double t, const himc_goal *goal);

/// Time from a touch to one so far away (m) on another head, in the greatest hurry (s).
HIMC_RT double himc_hand_leap_time(double way);

/// True if the tip can reach the second goal so after it has played the first.
HIMC_RT bool himc_hand_can_follow(const himc_goal *first, const himc_goal *second);

/// Appends the motion up to the end of that stroke's contact. Its gesture may be softer than the
/// one asked of himc_hand_can_strike. False, and nothing appended, if no tip can reach the goal in
/// time.
HIMC_RT bool himc_hand_strike(himc_hand_plan *plan, const himc_goal *goal);

/// Goes from a state measured at t to the touch of a stroke that is planned already, and on to the
/// end of its contact; what was planned after t is dropped.
HIMC_RT void himc_hand_land(himc_hand_plan *plan, double t, const himc_target *measured,
                            const himc_goal *goal);

/// Appends a wait, to `until` (s) at least: over the last spot when `ready`, else at home.
HIMC_RT void himc_hand_wait(himc_hand_plan *plan, double until, bool ready);

/// Appends the move to x, which becomes home: there at `at` (s), or as soon as it can.
HIMC_RT void himc_hand_reach(himc_hand_plan *plan, himc_vec3 x, double at);

#endif
