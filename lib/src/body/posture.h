/// posture.h: the natural posture of a percussionist whose drumstick tips are at given places:
/// what the null space of the tip task is for, and the joint targets of `id` and `ik` when only
/// tips are known.
#ifndef HIMC_POSTURE_H
#define HIMC_POSTURE_H

#include "base/quintic.h"
#include "himc/body.h"

/// A posture and how it moves, joint by joint, in the parent's frame.
typedef struct himc_posture_motion {
    himc_quat joint[HIMC_JOINTS];
    himc_vec3 rate[HIMC_JOINTS];         ///< angular velocity (rad/s)
    himc_vec3 acceleration[HIMC_JOINTS]; ///< its derivative (rad/s^2)
} himc_posture_motion;

/// How the sticks are held: palms down and the wrist bends, or thumbs up and the fingers do.
typedef enum himc_grip { HIMC_GRIP_GERMAN, HIMC_GRIP_FRENCH } himc_grip;

/// How the body bears itself, apart from the arms; it changes slowly.
typedef enum himc_trunk_posture_part {
    HIMC_TRUNK_POSTURE_TURN,        ///< of the trunk to the left (rad)
    HIMC_TRUNK_POSTURE_LEAN,        ///< and forward (rad)
    HIMC_TRUNK_POSTURE_FRENCH_GRIP, ///< of the grip: 0 german .. 1 french
    HIMC_TRUNK_POSTURE_PARTS
} himc_trunk_posture_part;

/// A bearing and how it moves.
typedef struct himc_trunk_posture {
    double value[HIMC_TRUNK_POSTURE_PARTS];
    double rate[HIMC_TRUNK_POSTURE_PARTS];         ///< (1/s)
    double acceleration[HIMC_TRUNK_POSTURE_PARTS]; ///< (1/s^2)
} himc_trunk_posture;

/// What postures are made from.
typedef struct himc_posture {
    himc_skeleton skeleton;
    himc_pose rest;                   ///< neck, head and legs as they are held
    himc_trunk_posture trunk_posture; ///< of trunk and grip: set it as often as it moves
    double level; ///< height of the tips at impact, where the sticks lie level (m)
} himc_posture;

/// A performer on a stool, as timpanists sit: a little forward, looking at the head.
HIMC_RT void himc_posture_init(himc_posture *posture, const himc_skeleton *skeleton, double level);

/// How to bear oneself to strike at these places (m), one for each hand: turned towards their
/// middle, leaning forward as far as the farther one asks for. At rest.
HIMC_RT himc_trunk_posture himc_posture_trunk(const himc_vec3 place[HIMC_HANDS], himc_grip grip);

/// Goes on from `now` for `dt` seconds (up to 0.02), towards where `goal` is: a critically damped
/// motion of third order, so the acceleration has no jumps. Half a second from one drum to
/// another.
HIMC_RT himc_trunk_posture himc_trunk_posture_approach(const himc_trunk_posture *now,
                                                       const himc_trunk_posture *goal, double dt);

/// The whole body's posture with both tips at `tip` (m). A smooth function of the tips. A tip out
/// of reach is met by the arm stretched towards it; returns the largest distance left over (m), 0
/// when both are reached.
HIMC_RT double himc_posture_at(const himc_posture *posture, const himc_vec3 tip[HIMC_HANDS],
                               himc_pose *pose);

/// The same with velocity and acceleration of the joints for tips and bearing in motion (central
/// differences of the map).
HIMC_RT void himc_posture_moving(const himc_posture *posture, const himc_target tip[HIMC_HANDS],
                                 himc_posture_motion *motion);

/// Nearest place to `tip` that the arm of `hand` reaches with a little to spare, the trunk turned
/// towards it (m).
HIMC_RT himc_vec3 himc_posture_reachable(const himc_posture *posture, himc_hand hand,
                                         himc_vec3 tip);

#endif
