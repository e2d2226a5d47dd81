/// difference.h: angular velocity and acceleration by central differences of orientations; private.
#ifndef HIMC_DIFFERENCE_H
#define HIMC_DIFFERENCE_H

#include "base/quintic.h"

/// Step of the differences (s). Chosen: rounding of 1e-16 rad then gives 1e-10 rad/s^2, and a
/// motion of 10 Hz loses 3e-4 of its acceleration.
#define HIMC_DIFFERENCE_STEP 1e-3

/// Angular velocity and acceleration in the parent's frame (rad/s, rad/s^2) at the middle of three
/// orientations HIMC_DIFFERENCE_STEP apart.
static inline void himc_differentiate(himc_quat before, himc_quat now, himc_quat after,
                                      himc_vec3 *rate, himc_vec3 *acceleration)
{
    himc_quat back = himc_quat_conj(now);
    himc_vec3 to = himc_quat_log(himc_quat_mul(after, back)),
              from = himc_quat_log(himc_quat_mul(before, back));
    const double h = HIMC_DIFFERENCE_STEP;
    *rate = himc_vec3_scale(himc_vec3_sub(to, from), 0.5 / h);
    *acceleration = himc_vec3_scale(himc_vec3_add(to, from), 1 / (h * h));
}

/// The target `dt` seconds later at constant acceleration.
static inline himc_target himc_target_after(const himc_target *t, double dt)
{
    himc_target after = {himc_vec3_madd(himc_vec3_madd(t->x, dt, t->v), 0.5 * dt * dt, t->a),
                         himc_vec3_madd(t->v, dt, t->a), t->a};
    return after;
}

#endif
