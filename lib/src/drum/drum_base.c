/// drum_base.c: a drum's own head, without the changes that a score makes on it.
#include "drum/drum_state.h"

void himc_drum_keep_edits(himc_head *head, const himc_head *was, const himc_head *now)
{
#define KEEP(field) head->field = now->field != was->field ? now->field : head->field
    KEEP(radius);
    KEEP(tension);
    KEEP(density);
    KEEP(decay_constant);
    KEEP(decay_square);
    KEEP(modes);
    KEEP(air);
    KEEP(kettle);
    KEEP(glide);
    KEEP(damp);
    KEEP(uniformity);
    KEEP(uniformity_seed);
#undef KEEP
}

himc_head himc_drum_base_head(const himc_drum *drum)
{
    const himc_head *now = himc_membrane_head(drum->membrane);
    if (!drum->told)
        return *now;
    himc_head base = drum->told->base;
    himc_drum_keep_edits(&base, &drum->told->known, now);
    return base;
}
