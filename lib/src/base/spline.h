/// spline.h: a queue of quintics in the order of time; motion is C2 where segments join. The
/// plan of a hand is one (plan/hand.h).
#ifndef HIMC_SPLINE_H
#define HIMC_SPLINE_H

#include "base/quintic.h"

/// One quintic and its time interval.
typedef struct himc_spline_segment {
    double t0, t1; ///< begin and end (s)
    himc_quintic q;
} himc_spline_segment;

/// The segment from one state at t0 to another at t1 > t0 (s).
static inline himc_spline_segment himc_spline_segment_make(double t0, const himc_target *from,
                                                           double t1, const himc_target *to)
{
    return (himc_spline_segment){t0, t1, himc_quintic_make(from, to, t1 - t0)};
}

/// The state of a segment at t (s); outside [t0, t1] the state at the nearer end.
static inline himc_target himc_spline_segment_at(const himc_spline_segment *segment, double t)
{
    return himc_quintic_at(&segment->q, fmin(fmax(t, segment->t0), segment->t1) - segment->t0);
}

/// Most segments of a spline. Chosen: room for four strokes of at most 16 segments.
#define HIMC_SPLINE_SEGMENTS 64

/// Segments in the order of time, without gaps.
typedef struct himc_spline {
    himc_spline_segment segment[HIMC_SPLINE_SEGMENTS];
    int count;
} himc_spline;

/// The state at t (s); the origin at rest if the spline is empty.
static inline himc_target himc_spline_at(const himc_spline *spline, double t)
{
    if (spline->count == 0)
        return (himc_target){0};
    int i = spline->count - 1;
    while (i > 0 && spline->segment[i].t0 > t)
        i--;
    return himc_spline_segment_at(&spline->segment[i], t);
}

/// Appends the segment from `from` at t0 to `to` at t1 (s). A full spline stays unchanged.
static inline void himc_spline_add(himc_spline *spline, double t0, const himc_target *from,
                                   double t1, const himc_target *to)
{
    if (spline->count < HIMC_SPLINE_SEGMENTS)
        spline->segment[spline->count++] = himc_spline_segment_make(t0, from, t1, to);
}

/// Removes the motion after t (s) and keeps the state at t. If a segment that does not continue the
/// one before begins exactly at t, its first state is kept.
static inline void himc_spline_cut(himc_spline *spline, double t)
{
    const himc_spline_segment *segment = spline->segment;
    while (spline->count > 1 && segment[spline->count - 1].t0 >= t &&
           (segment[spline->count - 1].t0 > t || segment[spline->count - 2].t0 >= t))
        spline->count--;
    if (spline->count > 0)
        spline->segment[spline->count - 1].t1 = fmin(spline->segment[spline->count - 1].t1, t);
}

/// Removes the segments that ended before t (s); at least one stays.
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
