/// habit.h: how a player's arms go with the sticks: the joints regressed on what the tips do, so
/// that tips alone give back the elbow (learned from takes).
///
/// log(mean^-1 q) of shoulder, elbow, wrist and grip is linear in [1, x, y, z, x', y', z'] of the
/// arm's own tip, seen from the trunk, about its mean place and in units of the arm's reach, so
/// that one player's habit serves another and goes with a body that turns to another drum.
#ifndef HIMC_HABIT_H
#define HIMC_HABIT_H

#include "himc/posture.h"

#define HIMC_HABIT_TERMS 7

/// What a habit is about: the player's own.
typedef struct himc_habit_player {
    himc_pose mean;            ///< posture, the mean over what was seen
    himc_vec3 tip[HIMC_HANDS]; ///< mean place of the tips, in the trunk's frame from the waist (m)
    double reach[HIMC_HANDS];  ///< shoulder to tip, the arm stretched (m)
    himc_vec3 waist;           ///< where the trunk turns (m)
    himc_quat usual;           ///< the trunk's bearing (himc_posture_bearing) for those tips
} himc_habit_player;

typedef struct himc_habit {
    himc_habit_player player;
    double weight[HIMC_HANDS][HIMC_ARM_JOINTS][3][HIMC_HABIT_TERMS]; ///< of the terms (rad)
} himc_habit;

/// One player's motion, all that is known of it: postures and tips, `frames` of each (borrowed).
/// Of the tips position and velocity are used.
typedef struct himc_habit_motion {
    const himc_skeleton *skeleton;
    const himc_pose *pose;
    const himc_target (*tip)[HIMC_HANDS];
    int frames;
} himc_habit_motion;

/// What a player's motion says of the player; false with the reason when there is none.
bool himc_habit_meet(himc_habit_player *player, const himc_habit_motion *motion, himc_error *error);
/// Least squares over `count` players, each about its own means; the habit is then the first's,
/// until another is put into its `player`. Directions in which no tip moves get no weight. False
/// with the reason if the motions do not determine it.
bool himc_habit_learn(himc_habit *habit, const himc_habit_motion *motion, int count,
                      himc_error *error);

/// The arms' posture for tips in motion, the rest of the pose as given (its trunk is where the arms
/// hang).
HIMC_RT void himc_habit_at(const himc_habit *habit, const himc_target tip[HIMC_HANDS],
                           himc_pose *pose);
/// Puts the habit into a natural posture in motion (himc_posture_moving): the arms are the habit's,
/// the trunk bears itself as there but from the player's own mean. Rates and accelerations are
/// central differences of the map, the tips' jerk taken as none.
HIMC_RT void himc_habit_moving(const himc_habit *habit, const himc_target tip[HIMC_HANDS],
                               himc_posture_motion *motion);

#endif
