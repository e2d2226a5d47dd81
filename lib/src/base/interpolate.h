/// interpolate.h: motion of joints between two instants with known rotation, angular velocity and
/// angular acceleration: setpoints (control) and takes (track).
#ifndef HIMC_INTERPOLATE_H
#define HIMC_INTERPOLATE_H

#include "base/quintic.h"

/// Weights of the coefficients of a polynomial of fifth degree in its value and in its first and
/// second derivative.
typedef struct himc_powers {
    double weight[3][6];
} himc_powers;

/// Motion of a joint in its parent's frame: rotation, angular velocity (rad/s), angular
/// acceleration (rad/s^2).
typedef struct joint_state {
    himc_quat q;
    himc_vec3 rate, acceleration;
} joint_state;

#define HIMC_JOINT_LANES 12 ///< joints at once: those that targets move, and an even number

/// Rotations of joints as quaternions in four dimensions that move on quintics: of each power of
/// the time and each component the coefficients of all joints, side by side.
typedef struct joint_courses {
    double c[6][4][HIMC_JOINT_LANES];
} joint_courses;

/// States of joints, side by side: w x y z, x y z, x y z.
typedef struct joint_states {
    double q[4][HIMC_JOINT_LANES], rate[3][HIMC_JOINT_LANES], acceleration[3][HIMC_JOINT_LANES];
} joint_states;

/// The weights at `time` (s) after the start.
himc_powers himc_powers_at(double time);
/// Sets the motion of joint `lane` from one state to another, `length` (s, above 0) later.
void himc_joint_course(const joint_state *from, const joint_state *to, double length,
                       joint_courses *courses, int lane);
/// The states of all joints; all courses must have been set.
void himc_joint_courses_at(const joint_courses *courses, const himc_powers *powers,
                           joint_states *states);
/// The state at `time` of the motion between two states, once.
joint_state himc_interpolate_joints(double time, double length, const joint_state *from,
                                    const joint_state *to);

#endif
