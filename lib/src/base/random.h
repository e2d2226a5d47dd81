/// random.h: reproducible random numbers: SplitMix64 (Steele, Lea & Flood 2014), a counter that is
/// scrambled. The same state gives the same numbers on every machine: for players
/// that vary, noise of strokes, lugs, planes of strikes.
#ifndef HIMC_RANDOM_H
#define HIMC_RANDOM_H

#include <stdint.h>

/// Advances the state; returns 64 random bits.
static inline uint64_t himc_random_bits(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

#endif
