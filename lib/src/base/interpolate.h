/// between.h: motion between two instants, for which position, velocity and acceleration are known
/// at both: points and joints alike; private.
#ifndef HIMC_INTERPOLATE_H
#define HIMC_INTERPOLATE_H

#include "base/quintic.h"

/// Weights of x0 v0 a0 x1 v1 a1 in the position, its rate and its second derivative.
typedef struct between {
    double weight[3][6];
} between;

/// A joint: its rotation in the parent's frame, angular velocity (rad/s) and acceleration (rad/s^2)
/// there.
typedef struct joint_state {
    himc_quat q;
    himc_vec3 rate, acceleration;
} joint_state;

/// At `time` (s) of `length` (s) between the two instants.
between himc_interpolate_make(double time, double length);
himc_target himc_interpolate_points(const between *b, const himc_target *from,
                                    const himc_target *to);
joint_state himc_interpolate_joints(const between *b, const joint_state *from,
                                    const joint_state *to);

#endif
