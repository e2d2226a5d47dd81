/// aligned.h: memory that begins at a multiple of 64 bytes, for vectors. Windows has no
/// aligned_alloc, and frees such memory by a function of its own.
#ifndef HIMC_SYSTEM_ALIGNED_H
#define HIMC_SYSTEM_ALIGNED_H

#include <stdlib.h>
#ifdef _WIN32
#include <malloc.h>
#endif

#define HIMC_ALIGNMENT 64 ///< (bytes), a cache line and the widest vector

/// NULL without memory; owned, freed with himc_aligned_free.
static inline void *himc_aligned_new(size_t bytes)
{
    bytes = (bytes + HIMC_ALIGNMENT - 1) / HIMC_ALIGNMENT * HIMC_ALIGNMENT;
#ifdef _WIN32
    return _aligned_malloc(bytes, HIMC_ALIGNMENT);
#else
    return aligned_alloc(HIMC_ALIGNMENT, bytes);
#endif
}

static inline void himc_aligned_free(void *memory)
{
#ifdef _WIN32
    _aligned_free(memory);
#else
    free(memory);
#endif
}

#endif
