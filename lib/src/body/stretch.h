/// stretch.h: the nearest reachable point for a tip target out of the arm's reach; private.
#ifndef HIMC_STRETCH_H
#define HIMC_STRETCH_H

#include "base/quintic.h"
#include "himc/body.h"

/// Share of the straight arm that counts as reach. Chosen: the Jacobian is still regular there.
#define HIMC_STRETCH_SHARE 0.998

/// The shoulder with the trunk in this orientation (m).
static inline himc_vec3 himc_shoulder(const himc_skeleton *skeleton, himc_quat trunk,
                                      himc_hand hand)
{
    himc_vec3 up = skeleton->segment[HIMC_LEFT_UPPER_ARM + hand].origin;
    return himc_vec3_add(himc_skeleton_waist(skeleton), himc_quat_rotate(trunk, up));
}

/// The arm's reach: the largest distance from shoulder to tip (m).
static inline double himc_stretch(const himc_skeleton *skeleton, himc_hand hand)
{
    double length = himc_vec3_length(skeleton->tip);
    for (int k = 1; k < HIMC_ARM_JOINTS; k++)
        length += himc_vec3_length(skeleton->segment[himc_arm_joint(hand, k) + 1].origin);
    return HIMC_STRETCH_SHARE * length;
}

/// The point of the sphere of radius `stretch` (m) about the shoulder (m) nearest to `target`, with
/// its velocity and acceleration as `target` moves; `target` itself if it is inside. With r = x -
/// s, u = r / |r|, R the radius and s at rest:
///     x' = s + R u,  v' = (v - u u.v) R / |r|,
///     a' = (a - u u.a) R / |r| - 2 v' u.v / |r| - u |v'|^2 / R.
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
