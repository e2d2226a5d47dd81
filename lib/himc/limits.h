/// limits.h: how far a percussionist's joints turn: bounds learned from captured motion, and the
/// nearest rotation within them (2012 paper, section 3.1, algorithm 1 and table 1).
#ifndef HIMC_LIMITS_H
#define HIMC_LIMITS_H

#include "himc/pose.h"

typedef enum himc_limits_kind {
    HIMC_LIMITS_OFF,
    HIMC_LIMITS_ELLIPSOID, ///< around the mean, in its tangent space (algorithm 1)
    HIMC_LIMITS_EULER      ///< lower and upper angles about x, y, z
} himc_limits_kind;

/// Bounds of one joint, child in the parent's frame.
typedef struct himc_limit {
    bool bound;       ///< false: turns freely
    himc_quat mean;   ///< of the captured rotations (Markley et al. 2007)
    himc_mat3 axes;   ///< columns: the ellipsoid's axes in the tangent space of the mean
    himc_vec3 radius; ///< its semi-axes, as rotation vectors (rad); less than 1e-3 counts as that
    himc_vec3 lower;  ///< Euler angles, child = mean Rz Ry Rx (rad)
    himc_vec3 upper;  ///< (rad); an interval narrower than 2e-3 counts as that
} himc_limit;

typedef struct himc_limits {
    himc_limits_kind kind;
    himc_limit joint[HIMC_JOINTS];
} himc_limits;

/// Table 1 of the 2012 paper (neck, shoulders, elbows, wrists) around a mean posture; the joints
/// the table does not name turn freely. Its eigen values are read as degrees of half the angle, its
/// frames as the captures': y up, z forward, arms sideways at zero, the left one's.
HIMC_RT himc_limits himc_limits_table_1(const himc_pose *mean);

/// Algorithm 1 and the Euler statistics of each joint's rotations in `pose` (frames). Ellipsoid and
/// box contain all of them, widened by `margin` (0 .. 1, of their size). A joint that nowhere turns
/// more than 1e-3 rad from its mean was not captured: it turns freely. False with the reason.
bool himc_limits_learn(himc_limits *limits, const himc_pose *pose, int frames, double margin,
                       himc_error *error);

/// Widens all bounds that are narrower than `least` (rad, 0 .. 0.5) on either side of the mean to
/// that: a body that is controlled is never quite in a captured posture.
HIMC_RT void himc_limits_loosen(himc_limits *limits, double least);

/// The mean posture: of each joint the rotation nearest to all of its own (Markley et al. 2007).
/// `frames` at least 1; rotations of unit length.
HIMC_RT himc_pose himc_limits_mean(const himc_pose *pose, int frames);

/// How far a joint is within its bounds: at most 1 inside, 1 on them, 0 at the centre; 0 too when
/// it turns freely.
HIMC_RT double himc_limit_measure(const himc_limits *limits, int joint, himc_quat rotation);
/// The nearest rotation within the bounds, in the tangent space of the mean (of the box, angle by
/// angle); the rotation itself when it is within.
HIMC_RT himc_quat himc_limit_closest(const himc_limits *limits, int joint, himc_quat rotation);

/// Nearest point of the ellipsoid with these semi-axes (any order, at least 1e-3) to a point that
/// is not within (Eberly 2013).
HIMC_RT himc_vec3 himc_limit_closest_on_ellipsoid(himc_vec3 radius, himc_vec3 point);

#endif
