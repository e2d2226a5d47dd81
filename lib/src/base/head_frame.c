/// head_frame.c: the struck surface of an instrument, and the strike points of strokes on it.
///
/// A head's frame has x in its plane away from the performer, y to the left, and the normal
/// upwards. With e the horizontal unit vector from the performer (the world's origin) to the
/// head's centre, a tilt t gives x = cos t e + sin t z, normal = cos t z - sin t e.
///
/// The named strike points are fractions of the radius from the centre towards the performer.
/// Measured ones lay 0.53, 0.40 and 0.30 m from the player's edge for centre, normal and rim.
#include "base/head_frame.h"

himc_head_axes himc_head_axes_of(const himc_head_frame *frame)
{
    double distance = hypot(frame->center.x, frame->center.y);
    himc_vec3 e = {1, 0, 0}; // for a head at the origin, forward
    if (distance >= 1e-9)
        e = himc_vec3_make(frame->center.x / distance, frame->center.y / distance, 0);
    bool level = frame->tilt == 0; // most are
    double c = level ? 1 : cos(frame->tilt), s = level ? 0 : sin(frame->tilt);
    return (himc_head_axes){{c * e.x, c * e.y, s}, {-e.y, e.x, 0}, {-s * e.x, -s * e.y, c}};
}

himc_vec3 himc_head_frame_away(const himc_head_frame *frame)
{
    return himc_head_axes_of(frame).x;
}

himc_vec3 himc_head_frame_normal(const himc_head_frame *frame)
{
    return himc_head_axes_of(frame).normal;
}

himc_vec3 himc_head_frame_to_world(const himc_head_frame *frame, double x, double y)
{
    himc_head_axes axes = himc_head_axes_of(frame);
    return himc_vec3_madd(himc_vec3_madd(frame->center, x, axes.x), y, axes.y);
}

himc_vec3 himc_head_frame_from_world(const himc_head_frame *frame, himc_vec3 point)
{
    himc_head_axes axes = himc_head_axes_of(frame);
    himc_vec3 d = himc_vec3_sub(point, frame->center);
    return himc_vec3_make(himc_vec3_dot(d, axes.x), himc_vec3_dot(d, axes.y),
                          himc_vec3_dot(d, axes.normal));
}

double himc_head_frame_out(const himc_head_frame *frame, double x, double y)
{
    return frame->length > 0 ? 2 * fmax(fabs(x) / frame->length, fabs(y) / frame->width)
                             : hypot(x, y) / frame->radius;
}

double himc_head_frame_struck(const himc_head_frame *frame)
{
    // chosen: on a disc a mallet that does not touch the rim of a usual head; on bars nearly up to
    // the edge (m), as the last one of a keyboard is narrow
    double edge = 0.003;
    return frame->length > 0 ? 1 - 2 * edge / fmax(frame->length, frame->width) : 0.97;
}

bool himc_head_frame_keep_inside(const himc_head_frame *frame, double share, double *x, double *y)
{
    double out = himc_head_frame_out(frame, *x, *y);
    if (out <= share)
        return false;
    *x *= share / out;
    *y *= share / out;
    return true;
}

double himc_head_frame_half_width(const himc_head_frame *frame, double share, double x)
{
    double r = share * frame->radius;
    return frame->length > 0 ? 0.5 * share * frame->width : sqrt(fmax(r * r - x * x, 0));
}

double himc_head_frame_beside(const himc_head_frame *frame, himc_vec3 from, himc_vec3 *away)
{
    if (frame->length == 0) {
        double far = himc_vec3_length(from);
        *away = himc_vec3_scale(from, 1 / fmax(far, 1e-9));
        return far - frame->radius;
    }
    himc_head_axes axes = himc_head_axes_of(frame);
    double x = himc_vec3_dot(from, axes.x), y = himc_vec3_dot(from, axes.y);
    double a = fabs(x) - 0.5 * frame->length, b = fabs(y) - 0.5 * frame->width;
    bool corner = a > 0 && b > 0;
    double far = corner ? hypot(a, b) : fmax(a, b);
    *away = himc_vec3_madd(himc_vec3_scale(axes.x, copysign(corner ? a / far : a >= b, x)),
                           copysign(corner ? b / far : a < b, y), axes.y);
    return far;
}

void himc_head_frame_spot(const himc_head_frame *frame, const himc_stroke *stroke, double *x,
                          double *y)
{
    // of the radius, by players and textbooks: normal about 3/4, rim about 9/10
    // sticks that meet the hoop or what is beyond it land where the tip can (drum_strike.c)
    static const double drumhead[] = {
        [HIMC_SPOT_CENTER] = 0,        [HIMC_SPOT_NORMAL] = 0.75, [HIMC_SPOT_RIM] = 0.92,
        [HIMC_SPOT_CROSSSTICK] = 0.95, [HIMC_SPOT_RIMSHOT] = 0.2, [HIMC_SPOT_CLICK] = 0.95,
        [HIMC_SPOT_SHELL] = 0.95};
    bool placed = stroke->spot == HIMC_SPOT_XY;
    *x = stroke->x;
    *y = placed ? stroke->y : 0;
    if (placed && !stroke->part[0])
        return;
    if (stroke->hand == HIMC_FOOT) { // a pedal's beater meets the centre
        *x = placed ? *x : 0;
        return;
    }
    if (!placed)
        *x = -(frame->spots && stroke->spot <= HIMC_SPOT_RIM ? frame->spots
                                                             : drumhead)[stroke->spot] *
             frame->radius;
    // half a mallet's width (m), so the two mallets do not collide, if there is room; chosen
    double aside = frame->length > 0 ? fmin(0.015, 0.48 * frame->width) : 0.015;
    *y += stroke->hand == HIMC_LEFT ? aside : -aside;
}

void himc_stroke_spot(const himc_stroke *stroke, double radius, double *x, double *y)
{
    himc_head_frame_spot(&(himc_head_frame){.radius = radius}, stroke, x, y);
}

himc_head_frame himc_head_frame_at(const himc_head_frame *place, const himc_head_frame *outline)
{
    himc_head_frame frame = *outline;
    frame.center = place->center;
    frame.tilt = place->tilt;
    return frame;
}

bool himc_head_frame_equal(const himc_head_frame *a, const himc_head_frame *b)
{
    return a->center.x == b->center.x && a->center.y == b->center.y && a->center.z == b->center.z &&
           a->tilt == b->tilt && a->radius == b->radius && a->length == b->length &&
           a->width == b->width && a->spots == b->spots;
}
