/// strike_heads.h: the drumheads under the abrupt ends of falls, and which of these lie on one;
/// for take_strikes.c.
#ifndef HIMC_STRIKE_HEADS_H
#define HIMC_STRIKE_HEADS_H

#include "himc/mocap.h"
#include "himc/vec.h"

#include <stdbool.h>

#define HIMC_STRIKE_HEADS 4 ///< chosen: more drums than that are struck in no take we know

/// The end of a fall: a strike, or a motion in the air.
typedef struct himc_fall {
    himc_vec3 x;    ///< position of the tip there (m)
    double speed;   ///< downward before it (m/s)
    double within;  ///< distance in height at which it is still on a head (m)
    double depth;   ///< of x below the head at rest; 0: unknown (m)
    himc_hand hand; ///< that holds the stick
    bool sharp;     ///< as abrupt as a blow; else not much less
    int head;       ///< out: index of the head that it is on, -1 if none
} himc_fall;

/// A plane, not steep: z = height + slope_x (x - x0) + slope_y (y - y0).
typedef struct himc_strike_head {
    double x0, y0, height, slope_x, slope_y;
    bool at_rest; ///< the plane is the head at rest; else it goes through the ends of the falls
    int strikes;  ///< falls on it
} himc_strike_head;

/// Finds the heads and sets each fall's. Returns the number of heads, the most struck first; -1
/// without memory. The same falls give the same heads.
int himc_strike_heads(himc_fall *falls, int count, himc_strike_head heads[HIMC_STRIKE_HEADS]);

/// Height of the plane at a place (m).
static inline double himc_strike_head_at(const himc_strike_head *head, double x, double y)
{
    return head->height + head->slope_x * (x - head->x0) + head->slope_y * (y - head->y0);
}

#endif
