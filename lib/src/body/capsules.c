/// capsules.c: gaps between the parts of a body, and between a body and drums.
///
/// With r = p1 - p2, d1 and d2 the two segments' vectors, a = d1.d1, e = d2.d2, b = d1.d2, c = d1.r
/// and f = d2.r, the closest points of two lines are at s = (b f - c e) / (a e - b b) and t = (b s
/// + f) / e. Both are clamped to the segments, one after the other (Ericson 2005, section 5.1.9).
#include "body/capsules.h"

#include <math.h>

#define PARALLEL 1e-12 // of a e: the lines are parallel below
#define SHELL_POINTS 8 // along a capsule; chosen: 4 cm apart on a forearm

static double clamp01(double x)
{
    return fmin(fmax(x, 0), 1);
}

himc_capsule_near himc_capsule_nearest(const himc_capsule *p, const himc_capsule *q)
{
    himc_vec3 d1 = himc_vec3_sub(p->b, p->a), d2 = himc_vec3_sub(q->b, q->a);
    himc_vec3 r = himc_vec3_sub(p->a, q->a);
    double a = himc_vec3_dot(d1, d1), e = himc_vec3_dot(d2, d2), b = himc_vec3_dot(d1, d2);
    double c = himc_vec3_dot(d1, r), f = himc_vec3_dot(d2, r), cross = a * e - b * b;
    double s = cross > PARALLEL * a * e ? clamp01((b * f - c * e) / cross) : 0;
    double t = (b * s + f) / e;
    if (t < 0)
        s = clamp01(-c / a);
    else if (t > 1)
        s = clamp01((b - c) / a);
    t = clamp01(t);
    himc_vec3 apart = himc_vec3_madd(himc_vec3_madd(r, s, d1), -t, d2);
    double distance = himc_vec3_length(apart);
    return (himc_capsule_near){distance - p->radius - q->radius, s, t,
                               himc_vec3_scale(apart, distance > 0 ? 1 / distance : 0)};
}

double himc_capsule_gap(const himc_capsule *p, const himc_capsule *q)
{
    return himc_capsule_nearest(p, q).gap;
}

himc_ball himc_capsule_ball(const himc_capsule *p)
{
    himc_vec3 half = himc_vec3_scale(himc_vec3_sub(p->b, p->a), 0.5);
    return (himc_ball){himc_vec3_add(p->a, half), himc_vec3_length(half) + p->radius};
}

himc_capsule_near himc_capsule_shell(const himc_capsule *p, const himc_head_frame *head)
{
    himc_capsule_near least = {.gap = INFINITY};
    himc_vec3 up = himc_head_frame_normal(head);
    for (int i = 0; i < SHELL_POINTS; i++) {
        double share = (double)i / (SHELL_POINTS - 1);
        himc_vec3 at = himc_vec3_madd(p->a, share, himc_vec3_sub(p->b, p->a));
        himc_vec3 from = himc_vec3_sub(at, head->center);
        double over = himc_vec3_dot(from, up);
        himc_vec3 away;
        double beside = himc_head_frame_beside(head, himc_vec3_madd(from, -over, up), &away);
        bool corner = beside > 0 && over > 0;
        double gap = corner ? hypot(beside, over) : fmax(beside, over);
        if (gap >= least.gap)
            continue;
        least.gap = gap;
        least.s = share;
        least.n = himc_vec3_add(himc_vec3_scale(up, corner ? over / gap : over >= beside),
                                himc_vec3_scale(away, corner ? beside / gap : beside > over));
    }
    least.gap -= p->radius;
    return least;
}

void himc_capsules_of(const himc_skeleton *skeleton, const himc_body_state *s,
                      himc_capsule capsule[HIMC_SEGMENTS])
{
    for (int i = 0; i < HIMC_SEGMENTS; i++) {
        const himc_segment *segment = &skeleton->segment[i];
        himc_vec3 along = himc_vec3_scale(segment->axis, segment->length);
        bool stick = i == HIMC_LEFT_STICK || i == HIMC_RIGHT_STICK;
        capsule[i].a = s->origin[i];
        capsule[i].b = himc_vec3_add(s->origin[i], himc_mat3_apply(&s->rotation[i], along));
        if (stick)
            capsule[i].b = s->tip[i - HIMC_LEFT_STICK];
        capsule[i].radius = stick ? HIMC_ROD_RADIUS : segment->radius;
    }
}

#define ARMS(k, i)                                                    \
    {                                                                 \
        HIMC_LEFT_UPPER_ARM + 2 * (k), HIMC_RIGHT_UPPER_ARM + 2 * (i) \
    }
#define ARM_TO_ARM(k) ARMS(k, 0), ARMS(k, 1), ARMS(k, 2), ARMS(k, 3)
#define TO_HEAD_AND_THIGHS(part)                    \
    {part, HIMC_HEAD}, {part, HIMC_LEFT_UPPER_LEG}, \
    {                                               \
        part, HIMC_RIGHT_UPPER_LEG                  \
    }
#define TO_BODY(part)         \
    TO_HEAD_AND_THIGHS(part), \
    {                         \
        part, HIMC_TRUNK      \
    }
#define ARM_TO_BODY(side)                                                        \
    TO_HEAD_AND_THIGHS(HIMC_##side##_UPPER_ARM), TO_BODY(HIMC_##side##_FOREARM), \
        TO_BODY(HIMC_##side##_HAND), TO_BODY(HIMC_##side##_STICK)

const himc_capsule_pair himc_capsule_pairs[HIMC_CAPSULE_PAIRS] = {
    ARM_TO_ARM(0), ARM_TO_ARM(1),     ARM_TO_ARM(2),
    ARM_TO_ARM(3), ARM_TO_BODY(LEFT), ARM_TO_BODY(RIGHT)};

double himc_capsules_least(const himc_capsule capsule[HIMC_SEGMENTS],
                           const himc_capsule_pair **pair)
{
    double least = INFINITY;
    for (int i = 0; i < HIMC_CAPSULE_PAIRS; i++) {
        const himc_capsule_pair *p = &himc_capsule_pairs[i];
        double gap = himc_capsule_gap(&capsule[p->part], &capsule[p->other]);
        if (gap < least) {
            least = gap;
            *pair = p;
        }
    }
    return least;
}
