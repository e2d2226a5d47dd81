/// head_frame.h: the struck surface of an instrument: its axes, points in the world's frame and in
/// its own, its outline and spots. What strikes (drum, performance), plans (plan, track) or avoids
/// (body) asks these functions and knows no outline. (x, y) is on the surface, from its centre (m).
#ifndef HIMC_HEAD_FRAME_H
#define HIMC_HEAD_FRAME_H

#include "himc/command.h"
#include "himc/vec.h"

/// True if both are in the same place, of one outline.
HIMC_RT bool himc_head_frame_equal(const himc_head_frame *a, const himc_head_frame *b);
/// `place` with the outline and the spots of `outline`.
HIMC_RT himc_head_frame himc_head_frame_at(const himc_head_frame *place,
                                           const himc_head_frame *outline);
/// True if (x, y) is on the surface.
static inline bool himc_head_frame_contains(const himc_head_frame *frame, double x, double y)
{
    return frame->length > 0 ? 2 * fabs(x) < frame->length && 2 * fabs(y) < frame->width
                             : x * x + y * y < frame->radius * frame->radius;
}
/// How far out (x, y) is: 0 in the centre, 1 on the edge.
HIMC_RT double himc_head_frame_out(const himc_head_frame *frame, double x, double y);
/// Share of the surface out to which it is struck.
HIMC_RT double himc_head_frame_struck(const himc_head_frame *frame);
/// Moves (x, y) towards the centre into the surface's inner part, out to that share; true if it was
/// beyond.
HIMC_RT bool himc_head_frame_keep_inside(const himc_head_frame *frame, double share, double *x,
                                         double *y);
/// Largest y of the surface's inner part, out to that share, at x; 0 where there is none (m).
HIMC_RT double himc_head_frame_half_width(const himc_head_frame *frame, double share, double x);
/// Distance (m) to the edge of a point in the surface's plane, negative inside; `from` is the point
/// from the centre in the world, `away` gets the unit vector along which the distance grows.
HIMC_RT double himc_head_frame_beside(const himc_head_frame *frame, himc_vec3 from,
                                      himc_vec3 *away);
/// Whether a stick meets there what is beyond the head.
static inline bool himc_spot_is_beyond(himc_spot spot)
{
    return spot >= HIMC_SPOT_CROSSSTICK && spot < HIMC_SPOT_XY;
}
/// Where a stroke with that spot lands.
HIMC_RT void himc_head_frame_spot(const himc_head_frame *frame, const himc_stroke *stroke,
                                  double *x, double *y);

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
