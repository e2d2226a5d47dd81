/// heads.h: the head of the papers, for tests of theory: their figures are for it, or for one
/// like it.
#ifndef HIMC_TESTS_HEADS_H
#define HIMC_TESTS_HEADS_H

#include "himc/membrane.h"

/// An ideal membrane of 23 inches, as `himc evaluate` strikes it.
static inline himc_head dry_head(void)
{
    return (himc_head){.radius = 0.2921,
                       .tension = 3700,
                       .density = 0.2653,
                       .decay_constant = 2.2,
                       .decay_square = 3e-7,
                       .modes = 200,
                       .glide = 1,
                       .uniformity = 1};
}

#endif
