/// exact_shape.h: the shape of a listed mode of a round head by Bessel's function, without a table.
#ifndef EXACT_SHAPE_H
#define EXACT_SHAPE_H

#include "head/bessel.h"
#include "head/modes.h"

#include <math.h>

static inline double exact_shape(const himc_modes *modes, const himc_head *head, int index,
                                 double x, double y)
{
    himc_mode mode = himc_modes_get(modes, head, index);
    double r = hypot(x, y) / head->radius, angle = mode.m * (atan2(y, x) - mode.axis);
    return r < 1 ? himc_bessel_j(mode.m, mode.zero * r) * (mode.sine ? sin(angle) : cos(angle)) : 0;
}

#endif
