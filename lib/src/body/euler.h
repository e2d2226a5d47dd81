/// euler.h: rotations as Euler angles Rz Ry Rx, used by the joint limits; private.
#ifndef HIMC_EULER_H
#define HIMC_EULER_H

#include "himc/vec.h"

/// Angles about x, y, z (rad) of a unit quaternion, y within +-pi/2. Where y is within 1.4e-6 of
/// +-pi/2 (gimbal lock), x gets the whole rotation and z is 0.
static inline himc_vec3 himc_euler_from_quat(himc_quat q)
{
    himc_mat3 r = himc_mat3_from_quat(q);
    double sine = fmin(fmax(-r.m[2][0], -1), 1);
    if (fabs(sine) > 1 - 1e-12)
        return himc_vec3_make(atan2(-r.m[1][2], r.m[1][1]), asin(sine), 0);
    return himc_vec3_make(atan2(r.m[2][1], r.m[2][2]), asin(sine), atan2(r.m[1][0], r.m[0][0]));
}

/// The unit quaternion of the angles about x, y, z (rad).
static inline himc_quat himc_euler_to_quat(himc_vec3 angle)
{
    himc_quat x = himc_quat_exp(himc_vec3_make(angle.x, 0, 0));
    himc_quat y = himc_quat_exp(himc_vec3_make(0, angle.y, 0));
    himc_quat z = himc_quat_exp(himc_vec3_make(0, 0, angle.z));
    return himc_quat_mul(z, himc_quat_mul(y, x));
}

#endif
