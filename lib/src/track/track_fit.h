/// track_fit.h: smooth derivatives of samples, one-sided beside a strike: of
/// tips (track.c) and joints (track_posture.c).
#ifndef HIMC_TRACK_FIT_H
#define HIMC_TRACK_FIT_H

#include "base/quintic.h"

/// The frames first .. last of one fit, for frame `k`; its coefficients, at most (1 .. 4), and the
/// distance from k at which weights are zero (frames; 0: all weights are equal).
typedef struct fit_window {
    int first, k, last, order, reach;
} fit_window;

/// A series to be fitted: `frames` at `rate` (Hz), `edge` the frames of one-sided fits beside a
/// strike.
typedef struct fit_series {
    int frames, edge;
    double rate;
} fit_series;

/// `edge` for points with the standard deviation `noise` (m).
int himc_fit_edge(double noise, double rate);
/// The window of frame `k` of the stretch lo .. hi.
fit_window himc_fit_window(int k, int lo, int hi, const fit_series *series);
/// Least squares polynomial through x[first] .. x[last] about frame k: position, velocity,
/// acceleration there, `dt` (s) the frames' distance.
himc_target himc_fit(const himc_vec3 *x, fit_window window, double dt);

#endif
