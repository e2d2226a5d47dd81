/// limb_frame.h: directions in space, and the frame of a limb along one: for
/// postures (body) and captured poses.
#ifndef HIMC_LIMB_FRAME_H
#define HIMC_LIMB_FRAME_H

#include "himc/vec.h"

/// The unit vector at these angles (rad): azimuth from x towards y, elevation from the xy plane
/// towards z.
static inline himc_vec3 himc_vec3_elevated(double azimuth, double elevation)
{
    return himc_vec3_make(cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth),
                          sin(elevation));
}

/// The frame of a limb with the direction `along` (unit vector): z opposite to it, y the axis of
/// its `flexion` made perpendicular to z. Where the flexion axis is parallel to the limb, y is
/// horizontal.
static inline himc_quat himc_quat_from_limb(himc_vec3 along, himc_vec3 flexion)
{
    himc_vec3 z = himc_vec3_scale(along, -1);
    himc_vec3 y = himc_vec3_madd(flexion, -himc_vec3_dot(flexion, z), z);
    if (himc_vec3_length(y) < 1e-6) {
        himc_vec3 level = {-z.y, z.x, 0};
        y = himc_vec3_length(level) > 1e-6 ? level : himc_vec3_make(0, 1, 0);
    }
    y = himc_vec3_unit(y);
    return himc_quat_from_mat3(himc_mat3_from_axes(himc_vec3_cross(y, z), y, z));
}

#endif
