/// spline.h: a queue of quintic segments that join with equal position, velocity and acceleration
/// (C2).
#ifndef HIMC_SPLINE_H
#define HIMC_SPLINE_H

#include "base/quintic.h"

typedef struct himc_spline_segment {
    double t0, t1; ///< (s)
    himc_quintic q;
} himc_spline_segment;

/// The segment from one state at t0 to another at t1 > t0.
static inline himc_spline_segment himc_spline_segment_make(double t0, const himc_target *from,
                                                           double t1, const himc_target *to)
{
    return (himc_spline_segment){t0, t1, himc_quintic_make(from, to, t1 - t0)};
}

/// State at t; outside [t0, t1] that of the nearer end.
static inline himc_target himc_spline_segment_at(const himc_spline_segment *segment, double t)
{
    return himc_quintic_at(&segment->q, fmin(fmax(t, segment->t0), segment->t1) - segment->t0);
}

/// Chosen: four strokes or waits of at most 16 segments each (plan/hand.c).
#define HIMC_SPLINE_SEGMENTS 64

/// Segments in the order of time, without gaps.
typedef struct himc_spline {
    himc_spline_segment segment[HIMC_SPLINE_SEGMENTS];
    int count;
} himc_spline;

/// State at t; a spline without segments rests at the origin.
static inline himc_target himc_spline_at(const himc_spline *spline, double t)
{
    if (spline->count == 0)
        return (himc_target){0};
    int i = spline->count - 1;
    while (i > 0 && spline->segment[i].t0 > t)
        i--;
    return himc_spline_segment_at(&spline->segment[i], t);
}

/// Appends a segment from `from` at t0 to `to` at t1; the caller has checked that there is room.
static inline void himc_spline_add(himc_spline *spline, double t0, const himc_target *from,
                                   double t1, const himc_target *to)
{
    if (spline->count < HIMC_SPLINE_SEGMENTS)
        spline->segment[spline->count++] = himc_spline_segment_make(t0, from, t1, to);
}

/// Drops all that comes after t and keeps the state at t. If a segment begins at t in another state
/// than the one before ends in, only its first point is kept.
static inline void himc_spline_cut(himc_spline *spline, double t)
{
    const himc_spline_segment *segment = spline->segment;
    while (spline->count > 1 && segment[spline->count - 1].t0 >= t &&
           (segment[spline->count - 1].t0 > t || segment[spline->count - 2].t0 >= t))
        spline->count--;
    if (spline->count > 0)
        spline->segment[spline->count - 1].t1 = fmin(spline->segment[spline->count - 1].t1, t);
}

/// Drops the segments that ended before t.
static inline void himc_spline_drop(himc_spline *spline, double t)
{
    int past = 0;
    while (past + 1 < spline->count && spline->segment[past].t1 < t)
        past++;
    for (int i = past; past > 0 && i < spline->count; i++)
        spline->segment[i - past] = spline->segment[i];
    spline->count -= past;
}

#endif
