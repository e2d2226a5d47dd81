/// stretch.h: a place that an arm cannot reach, met by the arm stretched towards it.
#ifndef HIMC_STRETCH_H
#define HIMC_STRETCH_H

#include "base/quintic.h"
#include "himc/body.h"

#define STRETCHED 0.998 // of the straight arm, where its Jacobian still is one

/// Shoulder to tip, as far as the arm goes (m).
static inline double himc_stretch(const himc_skeleton *skeleton, himc_hand hand)
{
    double length = himc_vec3_length(skeleton->tip);
    for (int k = 1; k < HIMC_ARM_JOINTS; k++)
        length += himc_vec3_length(skeleton->segment[himc_arm_joint(hand, k) + 1].origin);
    return STRETCHED * length;
}

/// The nearest to `target` on the sphere about the shoulder (m) that the arm's stretch reaches,
/// with the velocity and acceleration it has there; `target` itself if it is inside. With r = x -
/// s, u = r / |r| and R the stretch: s + R u, v' = (v - u u.v) R / |r|, a' = (a - u u.a) R / |r| -
/// 2 v' u.v / |r| - u |v'|^2 / R, v and a about a shoulder at rest.
static inline himc_target himc_stretch_towards(const himc_target *target, himc_vec3 shoulder,
                                               double stretch)
{
    himc_vec3 r = himc_vec3_sub(target->x, shoulder);
    double away = himc_vec3_length(r);
    if (away <= stretch)
        return *target;
    himc_vec3 u = himc_vec3_scale(r, 1 / away);
    double out = himc_vec3_dot(u, target->v), less = stretch / away;
    himc_vec3 v = himc_vec3_scale(himc_vec3_madd(target->v, -out, u), less);
    himc_vec3 a = himc_vec3_madd(target->a, -himc_vec3_dot(u, target->a), u);
    a = himc_vec3_scale(a, less);
    a = himc_vec3_madd(a, -2 * out / away, v);
    a = himc_vec3_madd(a, -himc_vec3_dot(v, v) / stretch, u);
    return (himc_target){himc_vec3_madd(shoulder, stretch, u), v, a};
}

#endif
