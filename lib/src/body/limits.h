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

/// A rotation in the coordinates of a joint's bounds.
typedef struct himc_limit_place {
    himc_vec3 at;       ///< along the ellipsoid's axes in the tangent space, or Euler angles (rad)
    double measure;     ///< himc_limit_measure
    double room;        ///< a rotation by less does not leave the bounds; 0: not known (rad)
    double most_beyond; ///< at least the angle to the nearest rotation within (rad)
} himc_limit_place;
HIMC_RT himc_limit_place himc_limit_locate(const himc_limits *limits, int joint,
                                           himc_quat rotation);
/// The rotation vector (rad, parent's frame) from a rotation to the nearest within the bounds, and
/// the room of its place. May be 0 where that is nearer than `farther` (rad).
HIMC_RT himc_vec3 himc_limit_back(const himc_limits *limits, int joint, himc_quat rotation,
                                  double farther, double *room);

/// Nearest point of the ellipsoid with these semi-axes (any order, at least 1e-3) to a point
/// outside it (Eberly 2013).
HIMC_RT himc_vec3 himc_limit_closest_on_ellipsoid(himc_vec3 radius, himc_vec3 point);

#endif
