/// place.c: where drumheads stand and where on them strokes fall.
///
/// A head's frame has x along its plane away from the performer, y to the left, and the normal up.
/// The tilt turns it about y so that the far side rises: x = (cos t, 0, sin t), normal = (-sin t,
/// 0, cos t). The spots are fractions of the radius towards the performer; measured strike places
/// lay 0.53, 0.40 and 0.30 m from the player's edge for centre, normal and rim, where players and
/// textbooks put them at 0, about 3/4 and about 9/10 of the radius.
#include "himc/planner.h"

#define NORMAL_SPOT 0.75
#define RIM_SPOT 0.92
#define HAND_SIDE 0.015

static himc_vec3 head_x(const himc_place *place)
{
    return himc_vec3_make(cos(place->tilt), 0, sin(place->tilt));
}

himc_vec3 himc_place_normal(const himc_place *place)
{
    return himc_vec3_make(-sin(place->tilt), 0, cos(place->tilt));
}

himc_vec3 himc_place_to_world(const himc_place *place, double x, double y)
{
    himc_vec3 p = himc_vec3_madd(place->center, x, head_x(place));
    p.y += y;
    return p;
}

himc_vec3 himc_place_from_world(const himc_place *place, himc_vec3 point)
{
    himc_vec3 d = himc_vec3_sub(point, place->center);
    return himc_vec3_make(himc_vec3_dot(d, head_x(place)), d.y,
                          himc_vec3_dot(d, himc_place_normal(place)));
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
