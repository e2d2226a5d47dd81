/// order.h: the order of numbers, for qsort: medians of captures.
#ifndef HIMC_ORDER_H
#define HIMC_ORDER_H

/// Compares two doubles.
static inline int himc_order_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#endif
