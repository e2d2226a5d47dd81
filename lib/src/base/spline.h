/// chain.h: a queue of quintics: motion that is C2 from piece to piece.
#ifndef HIMC_SPLINE_H
#define HIMC_SPLINE_H

#include "base/quintic.h"

typedef struct himc_spline_segment {
    double t0, t1; ///< (s)
    himc_quintic q;
} himc_spline_segment;

/// The piece that leads from one state at t0 to another at t1 > t0.
static inline himc_spline_segment himc_spline_segment_make(double t0, const himc_target *from,
                                                           double t1, const himc_target *to)
{
    return (himc_spline_segment){t0, t1, himc_quintic_make(from, to, t1 - t0)};
}

/// Its state at t; outside [t0, t1] that of the nearer end.
static inline himc_target himc_spline_segment_at(const himc_spline_segment *piece, double t)
{
    return himc_quintic_at(&piece->q, fmin(fmax(t, piece->t0), piece->t1) - piece->t0);
}

#define HIMC_SPLINE_SEGMENTS 64

/// Pieces in the order of time, without gaps.
typedef struct himc_spline {
    himc_spline_segment piece[HIMC_SPLINE_SEGMENTS];
    int count;
} himc_spline;

/// The state at t; a chain without pieces is at the origin and still.
static inline himc_target himc_spline_at(const himc_spline *chain, double t)
{
    if (chain->count == 0)
        return (himc_target){0};
    int i = chain->count - 1;
    while (i > 0 && chain->piece[i].t0 > t)
        i--;
    return himc_spline_segment_at(&chain->piece[i], t);
}

/// Goes on from `from` at t0 to `to` at t1. There must be room.
static inline void himc_spline_add(himc_spline *chain, double t0, const himc_target *from,
                                   double t1, const himc_target *to)
{
    if (chain->count < HIMC_SPLINE_SEGMENTS)
        chain->piece[chain->count++] = himc_spline_segment_make(t0, from, t1, to);
}

/// Forgets what comes after t. The state at t stays, also where a piece that does not go on from
/// the one before begins there: of such a piece nothing but its beginning is left.
static inline void himc_spline_cut(himc_spline *chain, double t)
{
    const himc_spline_segment *piece = chain->piece;
    while (chain->count > 1 && piece[chain->count - 1].t0 >= t &&
           (piece[chain->count - 1].t0 > t || piece[chain->count - 2].t0 >= t))
        chain->count--;
    if (chain->count > 0)
        chain->piece[chain->count - 1].t1 = fmin(chain->piece[chain->count - 1].t1, t);
}

/// Forgets what ended before t.
static inline void himc_spline_drop(himc_spline *chain, double t)
{
    int past = 0;
    while (past + 1 < chain->count && chain->piece[past].t1 < t)
        past++;
    for (int i = past; past > 0 && i < chain->count; i++)
        chain->piece[i - past] = chain->piece[i];
    chain->count -= past;
}

#endif
