/// noise.h: how much a captured point shakes; private.
#ifndef HIMC_NOISE_H
#define HIMC_NOISE_H

#include "himc/vec.h"

/// Standard deviation of white noise on each coordinate of a point's track (frames), smooth motion
/// left out (m); 0 for fewer than 5 frames or without memory to tell.
double himc_noise(const himc_vec3 *x, int frames);

#endif
