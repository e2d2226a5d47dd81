/// difference.h: angular velocity and acceleration from a smooth map of time to orientations, by
/// central differences of rotation vectors.
#ifndef HIMC_DIFFERENCE_H
#define HIMC_DIFFERENCE_H

#include "himc/vec.h"

/// Usual step (s). Chosen: the error of second order (0.3 % for motion at 20 Hz) and that of
/// rounding are both far below a joint's noise.
#define HIMC_DIFFERENCE_STEP 1e-3

/// Rate (rad/s) and acceleration (rad/s^2), in the parent's frame, at the middle of three
/// orientations that are `step` (s) apart.
static inline void himc_differentiate(himc_quat before, himc_quat now, himc_quat after, double step,
                                      himc_vec3 *rate, himc_vec3 *acceleration)
{
    himc_quat back = himc_quat_conj(now);
    himc_vec3 to = himc_quat_log(himc_quat_mul(after, back)),
              from = himc_quat_log(himc_quat_mul(before, back));
    *rate = himc_vec3_scale(himc_vec3_sub(to, from), 0.5 / step);
    *acceleration = himc_vec3_scale(himc_vec3_add(to, from), 1 / (step * step));
}

#endif
