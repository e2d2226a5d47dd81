/// rehearsal.h: both plans are walked through ahead of time, moment by moment, and the body is
/// asked for its gaps there; private to the planner.
#ifndef HIMC_REHEARSAL_H
#define HIMC_REHEARSAL_H

#include "plan/planner.h"

struct planner_hand;

/// With a smaller gap other ways are tried (m); chosen: a rebound changes the plan by 6 mm.
#define HIMC_SURE_GAP 0.008

/// A time in which the hands come near.
typedef struct near_time {
    double lack;     ///< what gaps lack, over the time (m s)
    double gap;      ///< least of all (m)
    double from, to; ///< first and last time of a lack (s)
    int order;       ///< of the arms then: 1 the left one is above, -1 below, 0 not crossed
} near_time;

/// A hand is moved by `way` (m) from `from` to `to` (s), not at all before `begin` and after `end`;
/// no lift if `end` is 0.
typedef struct planner_lift {
    himc_hand hand;
    double begin, from, to, end;
    double touch; ///< the next one of the hand (s)
    himc_vec3 way;
} planner_lift;

/// A walk through both plans.
typedef struct planner_rehearsal {
    double t;     ///< the next moment (s) ...
    double after; ///< ... after the last one (s), negative: it is the first
    bool met;     ///< the body has met itself since the first moment: no plan parts it
    near_time near;
    himc_rehearsed state;
} planner_rehearsal;

/// A walk that begins at t (s).
planner_rehearsal himc_rehearsal_begin(double t);

/// One moment of the walk through the plans of both hands and a lift; what is near before `ignored`
/// (s) is not noted. Returns the work.
HIMC_RT int himc_rehearsal_step(const himc_planner_config *config, planner_rehearsal *walk,
                                const planner_lift *lift, const struct planner_hand *hand,
                                double ignored);

/// True if `a` is the better way: its least gap is larger, or both are HIMC_SURE_GAP, and less is
/// lacking.
bool himc_rehearsal_is_better(const near_time *a, const near_time *b);

#endif
