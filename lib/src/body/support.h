/// support.h: what carries a body whose pelvis is free: the stool's seat and the floor, which only
/// press, with friction.
#ifndef HIMC_SUPPORT_H
#define HIMC_SUPPORT_H

#include "body/tree.h"

#define HIMC_SEAT_POINTS 6     ///< two sit bones, two points under each thigh
#define HIMC_SOLE_POINTS 4     ///< of each sole, after the seat's
#define HIMC_SOLE_BEHIND 0.055 ///< the ankle, of a sole (m)
#define HIMC_SUPPORTS (HIMC_SEAT_POINTS + 2 * HIMC_SOLE_POINTS)

/// A point of the body above a plane.
typedef struct himc_support_point {
    int segment;
    himc_vec3 at;    ///< in the segment's frame (m)
    double plane;    ///< height of the plane (m)
    himc_vec3 home;  ///< where it rests, and the plane is lowest (m)
    himc_vec3 lever; ///< from the pelvis' origin, world frame (m)
    himc_vec3 force; ///< on the body (N)
    bool slides;     ///< nothing holds it along its plane
    bool touching;
    himc_vec3 anchor; ///< where friction would have it, while it touches (m)
} himc_support_point;

typedef struct himc_support {
    himc_support_point point[HIMC_SUPPORTS];
    bool standing;      ///< the soles carry all
    double soles_ahead; ///< their middle, of the hips at rest (m)
} himc_support;

/// Seat and floor where this body rests in that state: a quarter of its weight on the feet, unless
/// they hang; of one who is `standing` the floor alone.
HIMC_RT void himc_support_init(himc_support *support, const himc_skeleton *skeleton,
                               const himc_body_state *rest, bool standing);

/// Forgets where the points touch: for a body that has been put elsewhere.
HIMC_RT void himc_support_lift(himc_support *support);

/// Whether the thigh of each side slides over the seat, as its foot goes elsewhere.
HIMC_RT void himc_support_slide(himc_support *support, const bool moves[HIMC_HANDS]);

/// Finds places and forces of the points in this state, and where they slip to.
HIMC_RT void himc_support_press(himc_support *support, const himc_skeleton *skeleton,
                                const himc_body_state *state);

#endif
