/// random.h: reproducible random numbers: SplitMix64 (Steele, Lea & Flood 2014), a counter that is
/// scrambled. The same state gives the same numbers on every machine: for players
/// that vary, noise of strokes, lugs, planes of strikes.
#ifndef HIMC_RANDOM_H
#define HIMC_RANDOM_H

#include "himc/base.h"

#include <math.h>
#include <stdint.h>

/// Advances the state; returns 64 random bits.
static inline uint64_t himc_random_bits(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// The next of [0, 1).
static inline double himc_random_uniform(uint64_t *state)
{
    return ldexp((double)(himc_random_bits(state) >> 11), -53);
}

/// The next normal deviate (Box & Muller 1958).
static inline double himc_random_normal(uint64_t *state)
{
    double size = sqrt(-2 * log(himc_random_uniform(state) + 0x1p-53));
    return size * cos(2 * HIMC_PI * (himc_random_uniform(state) + 0x1p-53));
}

#endif
