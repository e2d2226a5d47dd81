/// array.h: memory on the heap: an object, an array that grows.
#ifndef HIMC_ARRAY_H
#define HIMC_ARRAY_H

#include "himc/base.h"

#include <stdlib.h>

/// `size` bytes of zeros, owned; NULL with the reason, which begins with `what`.
static inline void *himc_new(size_t size, const char *what, himc_error *why)
{
    void *made = calloc(1, size);
    if (!made)
        himc_error_set(why, "%s: out of memory", what);
    return made;
}

/// Makes room for one more of `count` elements of `size` bytes; `array` points to the pointer to
/// the first one. Without room it doubles. False without memory, and nothing changed.
static inline bool himc_array_grow(void *array, int count, int *room, size_t size, himc_error *why)
{
    if (count < *room)
        return true;
    int wanted = *room ? 2 * *room : 64;
    void **slot = array, *bigger = realloc(*slot, (size_t)wanted * size);
    if (!bigger)
        return himc_error_set(why, "out of memory for %d lines", wanted);
    *slot = bigger;
    *room = wanted;
    return true;
}

#endif
