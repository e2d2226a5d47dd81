/// difference.h: angular velocity and acceleration from a smooth map of time to orientations.
#ifndef HIMC_DIFFERENCE_H
#define HIMC_DIFFERENCE_H

#include "base/quintic.h"

#define DIFFERENCE 1e-3 // step of the differences (s)

/// At the middle of three orientations a step apart, in the parent's frame (rad/s, rad/s^2).
static inline void himc_differentiate(himc_quat before, himc_quat now, himc_quat after,
                                      himc_vec3 *rate, himc_vec3 *acceleration)
{
    himc_quat back = himc_quat_conj(now);
    himc_vec3 to = himc_quat_log(himc_quat_mul(after, back)),
              from = himc_quat_log(himc_quat_mul(before, back));
    *rate = himc_vec3_scale(himc_vec3_sub(to, from), 0.5 / DIFFERENCE);
    *acceleration = himc_vec3_scale(himc_vec3_add(to, from), 1 / (DIFFERENCE * DIFFERENCE));
}

/// Where a target is `dt` later, its acceleration kept.
static inline himc_target himc_target_after(const himc_target *t, double dt)
{
    himc_target after = {himc_vec3_madd(himc_vec3_madd(t->x, dt, t->v), 0.5 * dt * dt, t->a),
                         himc_vec3_madd(t->v, dt, t->a), t->a};
    return after;
}

#endif
