/// interpolate.h: motion between two instants at which position, velocity and acceleration are
/// known, of points and of joints; private.
#ifndef HIMC_INTERPOLATE_H
#define HIMC_INTERPOLATE_H

#include "base/quintic.h"

/// Weights of x0 v0 a0 x1 v1 a1 in the position, its rate and its second derivative.
typedef struct himc_interpolation {
    double weight[3][6];
} himc_interpolation;

/// A joint: its rotation in the parent's frame, angular velocity (rad/s) and acceleration (rad/s^2)
/// there.
typedef struct joint_state {
    himc_quat q;
    himc_vec3 rate, acceleration;
} joint_state;

/// At `time` (s) of `length` (s) between the two instants.
himc_interpolation himc_interpolate_make(double time, double length);
himc_target himc_interpolate_points(const himc_interpolation *b, const himc_target *from,
                                    const himc_target *to);
joint_state himc_interpolate_joints(const himc_interpolation *b, const joint_state *from,
                                    const joint_state *to);

#endif
