/// chunk.h: a stretch of one tip's motion while it is planned, in the frame of a drumhead.
#ifndef HIMC_STROKE_PLAN_H
#define HIMC_STROKE_PLAN_H

#include "plan/hand.h"

#define LOW 0.12         // where it waits (m)
#define SWAY 0.008       // (m)
#define SLOWEST_FALL 0.9 // speed of a touch over the mean speed of its fall, at the least

/// Height and its derivatives along a normal.
typedef struct chunk_height {
    double h, v, a;
} chunk_height;

/// The chunk being built: its frame and where its two chains have got to.
typedef struct chunk {
    himc_hand_plan *plan;
    himc_vec3 n;
    double lift_end, ground_end;
    chunk_height at;
    himc_target on;
    double approach; ///< time to come from far (s)
} chunk;

static inline himc_target along(himc_vec3 n, double h, double v, double a)
{
    return (himc_target){himc_vec3_scale(n, h), himc_vec3_scale(n, v), himc_vec3_scale(n, a)};
}

static inline himc_target still(himc_vec3 x)
{
    return (himc_target){x, {0, 0, 0}, {0, 0, 0}};
}

static inline himc_target difference(himc_target a, himc_target b)
{
    return (himc_target){himc_vec3_sub(a.x, b.x), himc_vec3_sub(a.v, b.v), himc_vec3_sub(a.a, b.a)};
}

/// On to a height at t.
HIMC_RT void himc_stroke_plan_lift_to(chunk *c, double t, chunk_height to);

/// Whether the way to a height stays within bounds.
HIMC_RT bool himc_stroke_plan_stays(const chunk *c, double t, chunk_height to, double low,
                                    double high);

/// Comes to a halt from whatever the height is doing, before `limit` (s).
HIMC_RT void himc_stroke_plan_brake(chunk *c, double limit);

/// The rebound as its nuance makes it, with an apex `next` (m) to be reached at `top` (s).
HIMC_RT void himc_stroke_plan_rebound(chunk *c, double top, double next);

/// To the apex of the stroke at time `top` (s); returns when the preparation began.
HIMC_RT double himc_stroke_plan_rise(chunk *c, double top, const himc_gesture *g);

/// Whether the tip may simply fall from where it is to touch at t, and how it then does.
HIMC_RT bool himc_stroke_plan_falls(const chunk *c, double t, himc_gesture *g);

#endif
