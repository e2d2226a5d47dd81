/// noise.c: noise from fourth differences: of white noise they have the variance 70 sigma^2, while
/// smooth motion nearly cancels in them, being as small as its fourth derivative times dt^4. Of
/// their lengths the median is taken, which the few frames of an impact cannot move; for three
/// normal coordinates it is 1.5382 standard deviations of one.
#include "base/noise.h"

#include <stdlib.h>

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

double himc_noise(const himc_vec3 *x, int frames)
{
    int count = frames - 4;
    double *size = count > 0 ? malloc((size_t)count * sizeof *size) : NULL;
    if (!size)
        return 0;
    for (int i = 0; i < count; i++)
        size[i] = himc_vec3_length(fourth_difference(&x[i]));
    qsort(size, (size_t)count, sizeof *size, by_size);
    double middle = 0.5 * (size[(count - 1) / 2] + size[count / 2]);
    free(size);
    return middle / (1.5382 * sqrt(70));
}
