/// reach.h: a posture for drumstick tips anywhere in reach, both arms and the trunk, within the
/// joint limits: inverse kinematics at the level of positions, where ik.h's is one step of it.
#ifndef HIMC_REACH_H
#define HIMC_REACH_H

#include "himc/limits.h"

/// What is to be reached. Plain; begin with himc_reach_default.
typedef struct himc_reach_goal {
    himc_vec3 tip[HIMC_HANDS]; ///< where (m)
    bool free[HIMC_HANDS];     ///< that hand may be anywhere; default false
    double tolerance;          ///< distance that counts as reached (m), default 1e-6
    double trunk; ///< how willingly the waist turns beside the arms' joints 0 .. 1, default 0.1
    int steps;    ///< most of one try, default 60
    int tries;    ///< most, the first from the posture given, default 40
} himc_reach_goal;

himc_reach_goal himc_reach_default(void);

/// What came of it.
typedef struct himc_reach_result {
    double missing; ///< largest distance of a tip from its place (m)
    int steps;      ///< made in all tries
    int tries;
} himc_reach_result;

/// Turns waist, shoulders, elbows, wrists and grips of `pose` so that the tips are at their places
/// and all of these joints within `limits` (NULL for none); the others are left alone. The
/// nearest found, within the limits too, when that fails. The same input gives the same posture.
/// True if every tip is within the tolerance.
HIMC_RT bool himc_reach(const himc_skeleton *skeleton, const himc_limits *limits,
                        const himc_reach_goal *goal, himc_pose *pose, himc_reach_result *result);

#endif
