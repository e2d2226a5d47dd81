/// noise.h: measurement noise of a captured point, for strikes (capture) and fits (track).
#ifndef HIMC_NOISE_H
#define HIMC_NOISE_H

#include "himc/vec.h"

/// Standard deviation (m) of the white noise on each coordinate of a point's track `x` (frames);
/// smooth motion does not count. 0 for fewer than 5 frames. False without memory.
bool himc_noise(const himc_vec3 *x, int frames, double *noise);

/// The median of `count` (> 0) numbers; it sorts them.
double himc_median(double *x, int count);

#endif
