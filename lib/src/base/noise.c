/// noise.c: noise of a point's track from its fourth differences.
///
/// White noise of variance sigma^2 has fourth differences of variance 70 sigma^2. Smooth motion
/// nearly cancels: only its fourth derivative times dt^4 remains. The median of the differences'
/// lengths is insensitive to the few frames of an impact; for three normal coordinates it is 1.5382
/// standard deviations of one coordinate (the median of the chi distribution, 3 degrees of
/// freedom).
#include "base/noise.h"

#include <stdlib.h>

#define FOURTH_DIFFERENCE_VARIANCE 70.0 // 1 + 16 + 36 + 16 + 1
#define CHI_3_MEDIAN 1.5382             // of the length of three standard normal numbers

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static himc_vec3 fourth_difference(const himc_vec3 x[5])
{
    himc_vec3 outer = himc_vec3_add(x[0], x[4]), inner = himc_vec3_add(x[1], x[3]);
    return himc_vec3_madd(himc_vec3_madd(outer, -4, inner), 6, x[2]);
}

bool himc_noise(const himc_vec3 *x, int frames, double *noise)
{
    int count = frames - 4;
    double *size = count > 0 ? malloc((size_t)count * sizeof *size) : NULL;
    *noise = 0;
    if (!size)
        return count <= 0;
    for (int i = 0; i < count; i++)
        size[i] = himc_vec3_length(fourth_difference(&x[i]));
    qsort(size, (size_t)count, sizeof *size, by_size);
    double middle = 0.5 * (size[(count - 1) / 2] + size[count / 2]);
    free(size);
    *noise = middle / (CHI_3_MEDIAN * sqrt(FOURTH_DIFFERENCE_VARIANCE));
    return true;
}
