/// posture.h: the natural posture of a percussionist whose drumstick tips are at given places:
/// what the null space of the tip task is for, and the joint targets of `id` and `ik` when only
/// tips are known.
#ifndef HIMC_POSTURE_H
#define HIMC_POSTURE_H

#include "himc/planner.h"
#include "himc/pose.h"

/// A posture and how it moves, joint by joint, in the parent's frame.
typedef struct himc_posture_motion {
    himc_quat joint[HIMC_JOINTS];
    himc_vec3 rate[HIMC_JOINTS];         ///< angular velocity (rad/s)
    himc_vec3 acceleration[HIMC_JOINTS]; ///< its derivative (rad/s^2)
} himc_posture_motion;

/// What postures are made from; plain constants.
typedef struct himc_posture {
    himc_skeleton skeleton;
    himc_pose rest;                 ///< trunk, neck, head and legs as they are held
    himc_vec3 shoulder[HIMC_HANDS]; ///< in that rest posture (m)
    himc_quat trunk;                ///< orientation of the trunk in the world
    double level; ///< height of the tips at impact, where the sticks lie level (m)
} himc_posture;

/// A performer on a stool, as timpanists sit: a little forward, looking at the head.
HIMC_RT void himc_posture_init(himc_posture *posture, const himc_skeleton *skeleton, double level);

/// The whole body's posture with both tips at `tip` (m). A smooth function of the tips. A tip out
/// of reach is met by the arm stretched towards it; returns the largest distance left over (m), 0
/// when both are reached.
HIMC_RT double himc_posture_at(const himc_posture *posture, const himc_vec3 tip[HIMC_HANDS],
                               himc_pose *pose);

/// The same with velocity and acceleration of the joints for tips in motion (central differences
/// of the map).
HIMC_RT void himc_posture_moving(const himc_posture *posture, const himc_target tip[HIMC_HANDS],
                                 himc_posture_motion *motion);

/// Nearest place to `tip` that the arm of `hand` reaches with a little to spare (m).
HIMC_RT himc_vec3 himc_posture_reachable(const himc_posture *posture, himc_hand hand,
                                         himc_vec3 tip);

#endif
