/// dry_drum.h: a drum with the head of the papers (heads.h).
#ifndef HIMC_TESTS_DRY_DRUM_H
#define HIMC_TESTS_DRY_DRUM_H

#include "drum/membrane_state.h"
#include "heads.h"
#include "inner_state.h"
#include "himc/drum.h"

#include <assert.h>

/// Gives a drum of any size that head.
static inline void make_dry(himc_drum *drum)
{
    himc_head head = dry_head();
    head.radius = himc_drum_head_frame(drum)->radius;
    bool good = himc_membrane_set_head(himc_drum_membrane(drum), &head, NULL);
    assert(good);
    (void)good;
}

#endif
