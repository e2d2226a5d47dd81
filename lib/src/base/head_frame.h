/// head_frame.h: the frame of a drumhead in the world: its axes, and points in either frame;
/// private.
#ifndef HIMC_HEAD_FRAME_H
#define HIMC_HEAD_FRAME_H

#include "himc/vec.h"

/// True if both are in the same place, of one size.
HIMC_RT bool himc_head_frame_equal(const himc_head_frame *a, const himc_head_frame *b);
/// True if (x, y) (m) is on the surface that a performer strikes: the disc of the head's radius,
/// whatever its outline; beside the outline the modes do not move.
static inline bool himc_head_frame_contains(const himc_head_frame *frame, double x, double y)
{
    return x * x + y * y < frame->radius * frame->radius;
}
/// The axes of a head's frame.
typedef struct himc_head_axes {
    himc_vec3 x, y, normal;
} himc_head_axes;

HIMC_RT himc_head_axes himc_head_axes_of(const himc_head_frame *frame);

/// The head's x axis: unit vector in its plane, away from the performer at the world's origin.
HIMC_RT himc_vec3 himc_head_frame_away(const himc_head_frame *frame);
/// The head's unit normal, upwards.
HIMC_RT himc_vec3 himc_head_frame_normal(const himc_head_frame *frame);
/// The world point of (x, y) on the head (m).
HIMC_RT himc_vec3 himc_head_frame_to_world(const himc_head_frame *frame, double x, double y);
/// The inverse: (x, y) on the head and the height above it (m) of a world point.
HIMC_RT himc_vec3 himc_head_frame_from_world(const himc_head_frame *frame, himc_vec3 point);

#endif
