/// limits.h: joint limits, the parts that learning from takes uses; private.
#ifndef HIMC_LIMITS_H
#define HIMC_LIMITS_H

#include "himc/body.h"

/// The mean pose: for each joint the rotation nearest to all of its captured ones (Markley et al.
/// 2007). `pose` (frames, at least 1) with unit quaternions.
HIMC_RT himc_pose himc_limits_mean(const himc_pose *pose, int frames);

/// Widens all bounds narrower than `least` (rad, 0 .. 0.5) on either side of the mean to `least`: a
/// controlled body never reproduces a captured pose exactly.
HIMC_RT void himc_limits_loosen(himc_limits *limits, double least);

/// himc_limit_measure and himc_limit_closest in one.
HIMC_RT double himc_limit_nearest(const himc_limits *limits, int joint, himc_quat rotation,
                                  himc_quat *near);

/// A rotation by less than this (rad) keeps a joint of that measure within its bounds; 0 where this
/// is not known.
HIMC_RT double himc_limit_room(const himc_limits *limits, int joint, double measure);

/// Nearest point of the ellipsoid with these semi-axes (any order, at least 1e-3) to a point
/// outside it (Eberly 2013).
HIMC_RT himc_vec3 himc_limit_closest_on_ellipsoid(himc_vec3 radius, himc_vec3 point);

#endif
