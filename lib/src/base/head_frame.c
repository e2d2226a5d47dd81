/// head_frame.c: the axes of a drumhead in the world, and the points on it that strokes fall on.
///
/// A head's frame has x along its plane away from the performer, y to the left, and the normal
/// up: with e the horizontal unit vector from the world's origin, where the performer sits, to
/// the head's centre, the tilt t makes x = cos t e + sin t z, normal = cos t z - sin t e. The
/// spots are fractions of the radius towards the performer; measured strike places lay 0.53, 0.40
/// and 0.30 m from the player's edge for centre, normal and rim, where players and textbooks put
/// them at 0, about 3/4 and about 9/10 of the radius.
#include "base/head_frame.h"

#include "himc/command.h"

#define NORMAL_SPOT 0.75
#define RIM_SPOT 0.92
#define HAND_SIDE 0.015

// from the performer towards the head, level
static himc_vec3 outwards(const himc_head_frame *place)
{
    double distance = hypot(place->center.x, place->center.y);
    if (distance < 1e-9)
        return himc_vec3_make(1, 0, 0);
    return himc_vec3_make(place->center.x / distance, place->center.y / distance, 0);
}

static himc_vec3 head_y(const himc_head_frame *place)
{
    himc_vec3 e = outwards(place);
    return himc_vec3_make(-e.y, e.x, 0);
}

himc_vec3 himc_head_frame_away(const himc_head_frame *place)
{
    himc_vec3 e = outwards(place);
    return himc_vec3_make(cos(place->tilt) * e.x, cos(place->tilt) * e.y, sin(place->tilt));
}

himc_vec3 himc_head_frame_normal(const himc_head_frame *place)
{
    himc_vec3 e = outwards(place);
    return himc_vec3_make(-sin(place->tilt) * e.x, -sin(place->tilt) * e.y, cos(place->tilt));
}

himc_vec3 himc_head_frame_to_world(const himc_head_frame *place, double x, double y)
{
    return himc_vec3_madd(himc_vec3_madd(place->center, x, himc_head_frame_away(place)), y,
                          head_y(place));
}

himc_vec3 himc_head_frame_from_world(const himc_head_frame *place, himc_vec3 point)
{
    himc_vec3 d = himc_vec3_sub(point, place->center);
    return himc_vec3_make(himc_vec3_dot(d, himc_head_frame_away(place)),
                          himc_vec3_dot(d, head_y(place)),
                          himc_vec3_dot(d, himc_head_frame_normal(place)));
}

void himc_stroke_spot(const himc_stroke *stroke, double radius, double *x, double *y)
{
    static const double fraction[] = {
        [HIMC_SPOT_CENTER] = 0, [HIMC_SPOT_NORMAL] = NORMAL_SPOT, [HIMC_SPOT_RIM] = RIM_SPOT};
    if (stroke->spot == HIMC_SPOT_XY) {
        *x = stroke->x;
        *y = stroke->y;
        return;
    }
    *x = -fraction[stroke->spot] * radius;
    *y = stroke->hand == HIMC_LEFT ? HAND_SIDE : -HAND_SIDE;
}
