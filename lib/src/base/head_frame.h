/// head_frame.h: the axes of a drumhead in the world, and points from one frame to the other.
#ifndef HIMC_HEAD_FRAME_H
#define HIMC_HEAD_FRAME_H

#include "himc/vec.h"

/// Unit vector in the head's plane away from the performer, who sits at the world's origin.
HIMC_RT himc_vec3 himc_head_frame_away(const himc_head_frame *place);
/// Unit normal of the head, up.
HIMC_RT himc_vec3 himc_head_frame_normal(const himc_head_frame *place);
/// Point (x, y) of the head (m, x away from the performer) in the world.
HIMC_RT himc_vec3 himc_head_frame_to_world(const himc_head_frame *place, double x, double y);
/// The inverse: (x, y) on the head and the height above it.
HIMC_RT himc_vec3 himc_head_frame_from_world(const himc_head_frame *place, himc_vec3 point);

#endif
