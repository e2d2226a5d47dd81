/// reach_joint.h: a joint in coordinates in which its limits are simple; private to reach.c.
#ifndef HIMC_REACH_JOINT_H
#define HIMC_REACH_JOINT_H

#include "himc/limits.h"

typedef enum himc_reach_bounds { REACH_FREE, REACH_BALL, REACH_BOX } himc_reach_bounds;

typedef struct himc_reach_joint {
    int id;
    himc_reach_bounds bounds;
    himc_quat mean;
    himc_mat3 span;         // columns: what a unit of x turns (rad); of a box its half intervals
    himc_vec3 middle, half; // of a box (rad)
    double willing;         // its part of W
    double x[3];
    bool held[3]; // x is held at its bound: all of a ball's along x, or each of a box's
} himc_reach_joint;

/// Coordinates of the rotation within the limits (NULL for none) that is nearest to `rotation`;
/// `id` and `willing` are set before.
HIMC_RT void himc_reach_joint_begin(himc_reach_joint *joint, const himc_limits *limits,
                                    himc_quat rotation);
/// Puts the coordinates back within the limits.
HIMC_RT void himc_reach_joint_inside(himc_reach_joint *joint);
/// The rotation, and what a unit of each coordinate turns, in the parent's frame (rad).
HIMC_RT himc_quat himc_reach_joint_rotation(const himc_reach_joint *joint, himc_vec3 turn[3]);
/// Holds what is on its bounds and pulled further out by `dx`; true if that is more than before.
HIMC_RT bool himc_reach_joint_hold_more(himc_reach_joint *joint, const double dx[3]);
/// Takes out of `v` what is held.
HIMC_RT void himc_reach_joint_hold(const himc_reach_joint *joint, double v[3]);

#endif
