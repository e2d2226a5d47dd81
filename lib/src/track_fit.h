/// track_fit.h: smooth derivatives of what was sampled, one-sided beside a strike; private.
#ifndef HIMC_TRACK_FIT_H
#define HIMC_TRACK_FIT_H

#include "himc/quintic.h"

/// Frames that one fit uses, `k` the one it is for, and the coefficients it may have (1 .. 4).
typedef struct fit_window {
    int first, k, last, order;
} fit_window;

/// The window of frame `k` of the stretch lo .. hi, of `frames` in all at `rate` (Hz).
fit_window himc_fit_window(int k, int lo, int hi, int frames, double rate);
/// Least squares polynomial through x[first] .. x[last] about frame k: position, velocity,
/// acceleration there, `dt` (s) the frames' distance.
himc_target himc_fit(const himc_vec3 *x, fit_window window, double dt);

#endif
