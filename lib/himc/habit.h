/// habit.h: how a player's arms go with the sticks: the joints regressed on what the tips do, so
/// that tips alone give back the elbow (learned from takes).
///
/// log(mean^-1 q) of shoulder, elbow, wrist and grip is linear in [1, x, y, z, x', y', z'] of the
/// arm's own tip, lengths in units of the arm's, so that one player's habit serves another.
#ifndef HIMC_HABIT_H
#define HIMC_HABIT_H

#include "himc/posture.h"

#define HIMC_HABIT_TERMS 7

typedef struct himc_habit {
    himc_pose mean;            ///< posture the regression is about: the player's own
    himc_vec3 tip[HIMC_HANDS]; ///< mean place of the tips (m)
    double reach[HIMC_HANDS];  ///< shoulder to tip, the arm stretched (m)
    double weight[HIMC_HANDS][HIMC_ARM_JOINTS][3][HIMC_HABIT_TERMS]; ///< of the terms (rad)
} himc_habit;

/// One player's motion: postures and tips, `frames` of each (borrowed).
typedef struct himc_habit_motion {
    const himc_skeleton *skeleton;
    const himc_pose *pose;
    const himc_target (*tip)[HIMC_HANDS];
    int frames;
} himc_habit_motion;

/// Least squares over `count` motions, each about its own mean; the habit's own mean, tips and
/// reach are those of the first. False with the reason if the motions do not determine it.
bool himc_habit_learn(himc_habit *habit, const himc_habit_motion *motion, int count,
                      himc_error *error);
/// The same weights for another player, whose mean posture and tips these are.
HIMC_RT void himc_habit_adopt(himc_habit *habit, const himc_skeleton *skeleton,
                              const himc_pose *mean, const himc_vec3 tip[HIMC_HANDS]);
/// Posture, its rate and acceleration for tips in motion; joints outside the arms as in the mean.
HIMC_RT void himc_habit_moving(const himc_habit *habit, const himc_target tip[HIMC_HANDS],
                               himc_posture_motion *motion);

#endif
