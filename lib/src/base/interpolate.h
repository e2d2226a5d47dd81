/// interpolate.h: motion of points and joints between two instants with known position, velocity
/// and acceleration; private.
#ifndef HIMC_INTERPOLATE_H
#define HIMC_INTERPOLATE_H

#include "base/quintic.h"

/// Weights of x0 v0 a0 x1 v1 a1 in the value and in its first and second derivative.
typedef struct himc_interpolation {
    double weight[3][6];
} himc_interpolation;

/// Motion of a joint in its parent's frame: rotation, angular velocity (rad/s), angular
/// acceleration (rad/s^2).
typedef struct joint_state {
    himc_quat q;
    himc_vec3 rate, acceleration;
} joint_state;

/// A joint's rotation as a quaternion in four dimensions, and its derivatives.
typedef struct joint_knot {
    himc_quat q, rate, second;
} joint_knot;

/// The weights at `time` (s) after the first of two instants `length` (s, above 0) apart.
himc_interpolation himc_interpolate_make(double time, double length);
/// A point's motion between `from` and `to`.
himc_target himc_interpolate_points(const himc_interpolation *b, const himc_target *from,
                                    const himc_target *to);
/// The knots of a joint's motion between `from` and `to`.
void himc_interpolate_knots(const joint_state *from, const joint_state *to, joint_knot knot[2]);
/// A joint's motion between two knots.
joint_state himc_interpolate_joint(const himc_interpolation *b, const joint_knot knot[2]);
/// A joint's motion between `from` and `to`, once.
joint_state himc_interpolate_joints(const himc_interpolation *b, const joint_state *from,
                                    const joint_state *to);

#endif
