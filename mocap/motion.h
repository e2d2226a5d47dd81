/// motion.h: the data of a sequence: strokes of each hand and the joints' shares in them; private.
#ifndef HIMC_MOCAP_MOTION_H
#define HIMC_MOCAP_MOTION_H

#include "parts.h"

#define MOCAP_GRIP_KNOTS 6 ///< knots of the grip's share per stroke

/// A stroke's two postures as rotation vectors about the hand's mean (rad).
typedef struct mocap_stroke {
    mocap_gesture gesture; ///< of this stroke
    himc_vec3 aim;         ///< intended position of the tip at impact (m)
    double touch;          ///< intended time of the impact (s)
    mocap_key low;         ///< posture at impact
    himc_vec3 impact[HIMC_ARM_JOINTS], apex[HIMC_ARM_JOINTS];
    himc_vec3 loop[HIMC_ARM_JOINTS]; ///< distance of the way up from the way down, at its middle
} mocap_stroke;

typedef struct mocap_arm {
    int count;
    mocap_stroke *stroke;            ///< owned (count)
    himc_quat mean[HIMC_ARM_JOINTS]; ///< reference posture of the rotation vectors
    mocap_curve share[HIMC_ARM_JOINTS];
    mocap_curve loop, effort;
    mocap_wander wander[HIMC_ARM_JOINTS][3];
} mocap_arm;

struct himc_mocap {
    himc_mocap_config config;
    const mocap_player *player;
    himc_skeleton skeleton;
    himc_pose rest;
    double length; ///< at pace 1, like all times in here (s)
    mocap_arm arm[HIMC_HANDS];
    mocap_wander turn, lean, nod;
};

/// The trunk's orientation without sway and drift, and at `t`.
himc_quat himc_mocap_trunk_mean(const himc_mocap *mocap);
HIMC_RT himc_quat himc_mocap_trunk(const himc_mocap *mocap, double t);
/// An arm's joints at `t`.
HIMC_RT void himc_mocap_arm_at(const himc_mocap *mocap, himc_hand hand, double t,
                               himc_quat joint[HIMC_ARM_JOINTS]);
/// Makes the curves of both arms from their strokes.
void himc_mocap_coordinate(himc_mocap *mocap);

#endif
