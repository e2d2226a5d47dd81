/// noise.c: noise of a point's track from its fourth differences.
///
/// White noise of variance sigma^2 has fourth differences of variance 70 sigma^2, 70 = 1 + 16 + 36
/// + 16 + 1. Smooth motion nearly cancels: only its fourth derivative times dt^4 remains. The
/// median of the differences' lengths is insensitive to the few frames of an impact; for three
/// normal coordinates it is 1.5382 standard deviations of one coordinate (the median of the chi
/// distribution, 3 degrees of freedom).
#include "base/noise.h"

#include "base/order.h"

#include <stdlib.h>

double himc_median(double *x, int count)
{
    qsort(x, (size_t)count, sizeof *x, himc_order_doubles);
    return 0.5 * (x[(count - 1) / 2] + x[count / 2]);
}

bool himc_noise(const himc_vec3 *x, int frames, double *noise)
{
    int count = frames - 4;
    double *size = count > 0 ? malloc((size_t)count * sizeof *size) : NULL;
    *noise = 0;
    if (!size)
        return count <= 0;
    for (int i = 0; i < count; i++) {
        himc_vec3 outer = himc_vec3_add(x[i], x[i + 4]), inner = himc_vec3_add(x[i + 1], x[i + 3]);
        himc_vec3 fourth = himc_vec3_madd(himc_vec3_madd(outer, -4, inner), 6, x[i + 2]);
        size[i] = himc_vec3_length(fourth);
    }
    *noise = himc_median(size, count) / (1.5382 * sqrt(70));
    free(size);
    return true;
}
