/// outline.h: shapes of heads that are not round; a private part of modes.c.
#ifndef HIMC_OUTLINE_H
#define HIMC_OUTLINE_H

#include "drum/modes.h"

/// A mode of such a head: z is radius times wavenumber, norm the integral of phi^2 per pi a^2.
typedef struct outline_mode {
    int m, n;
    double z, norm;
} outline_mode;

/// The lowest `count` modes, in order of frequency. False without memory.
bool himc_outline_modes(const himc_shape *shape, int count, outline_mode *modes);

/// One shape at (x, y), all of them (`count`), in units of the radius; 0 outside.
HIMC_RT double himc_outline_shape(const himc_shape *shape, const outline_mode *mode, int index,
                                  double x, double y);
HIMC_RT void himc_outline_shapes(const himc_shape *shape, const outline_mode *modes, int count,
                                 double x, double y, double *shapes);

/// The integral of phi cos(k . r) and phi sin(k . r), k in units of 1/radius, per radius^2.
HIMC_RT void himc_outline_beam(const himc_shape *shape, const outline_mode *mode, int index,
                               double kx, double ky, double *even, double *odd);

/// Area per radius^2.
double himc_outline_area(const himc_shape *shape);

#endif
