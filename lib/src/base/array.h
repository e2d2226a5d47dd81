/// array.h: an array on the heap that grows.
#ifndef HIMC_ARRAY_H
#define HIMC_ARRAY_H

#include "himc/base.h"

#include <stdlib.h>

/// Makes room for one more of `count` elements of `size` bytes; `array` points to the pointer to
/// the first one. Without room it doubles. False without memory, and nothing changed.
static inline bool himc_array_grow(void *array, int count, int *room, size_t size,
                                   himc_error *error)
{
    if (count < *room)
        return true;
    int wanted = *room ? 2 * *room : 64;
    void **slot = array, *bigger = realloc(*slot, (size_t)wanted * size);
    if (!bigger)
        return himc_error_set(error, "out of memory for %d lines", wanted);
    *slot = bigger;
    *room = wanted;
    return true;
}

#endif
