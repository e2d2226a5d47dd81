/// capsules.h: the room that a body takes: a capsule around each segment, and the gaps between
/// them.
#ifndef HIMC_CAPSULES_H
#define HIMC_CAPSULES_H

#include "base/head_frame.h"
#include "himc/body.h"

/// Of a stick's rod (m). Chosen: twice a slim rod's, so there is room for an error.
#define HIMC_ROD_RADIUS 0.008

/// All points nearer than `radius` to the segment from `a` to `b`.
typedef struct himc_capsule {
    himc_vec3 a, b;
    double radius; ///< (m)
} himc_capsule;

/// Where a capsule comes nearest to something.
typedef struct himc_capsule_near {
    double gap;  ///< of the surfaces (m), negative if they overlap
    double s, t; ///< of the nearest points, from a to b of the one and of the other (0 .. 1)
    himc_vec3 n; ///< unit vector from the other to the one
} himc_capsule_near;

/// Of two capsules: closest points of two segments after Ericson 2005, section 5.1.9.
HIMC_RT himc_capsule_near himc_capsule_nearest(const himc_capsule *p, const himc_capsule *q);

/// The smallest ball that a capsule fits into.
typedef struct himc_ball {
    himc_vec3 middle;
    double radius; ///< (m)
} himc_ball;

HIMC_RT himc_ball himc_capsule_ball(const himc_capsule *p);

/// Whether the gap between two balls is larger (m); that of what they contain is, then, too.
static inline bool himc_balls_are_far(const himc_ball *p, const himc_ball *q, double gap)
{
    himc_vec3 r = himc_vec3_sub(p->middle, q->middle);
    double reach = p->radius + q->radius + gap;
    return himc_vec3_dot(r, r) > reach * reach;
}

/// A capsule and a drum's shell, the cylinder under its head; exact at eight points along the
/// capsule.
HIMC_RT himc_capsule_near himc_capsule_shell(const himc_capsule *p, const himc_head_frame *head);

/// Two segments that must not meet.
typedef struct himc_capsule_pair {
    unsigned char part, other;
} himc_capsule_pair;

/// Pairs of an arm's part with the other arm's, and with trunk, head and thighs. Segments that a
/// joint connects are no pair.
#define HIMC_CAPSULE_PAIRS 46
#define HIMC_CAPSULE_ARM_PAIRS 16 ///< the first ones: of the two arms
extern const himc_capsule_pair himc_capsule_pairs[HIMC_CAPSULE_PAIRS];

/// Least gaps of a posture (m); far parts are not counted.
typedef struct himc_clearance {
    double sticks;             ///< between a stick and the other arm or its stick
    himc_vec3 across;          ///< unit vector along that gap
    double body;               ///< of all other pairs
    double beyond;             ///< distance of a tip out of reach
    double folded[HIMC_HANDS]; ///< horizontal distance of each tip from its shoulder
    int order;                 ///< of crossed arms: 1 the left one is above, -1 below, 0 none
    int work;                  ///< postures that were looked at
} himc_clearance;

#endif
