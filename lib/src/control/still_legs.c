/// still_legs.c: compares the bits of all that enters; what comes out is kept while they are the
/// same. Legs at rest (character.c) have the same state to the bit, so most steps find it so.
#include "control/still_legs.h"

#include "body/dynamics.h"

#include <string.h>

#define FIRST (HIMC_LEGS - 1) // joint of the legs

// true if `kept` is `now` already; else it is from now on
static bool keep(void *kept, const void *now, size_t bytes)
{
    if (memcmp(kept, now, bytes) == 0)
        return true;
    memcpy(kept, now, bytes);
    return false;
}

static bool keep_state(himc_still_legs *k, const himc_body_state *s)
{
    bool same = keep(&k->pelvis, &s->origin[0], sizeof k->pelvis);
    same = keep(k->origin, &s->origin[HIMC_LEGS], sizeof k->origin) && same;
    same = keep(k->spin, &s->spin[HIMC_LEGS], sizeof k->spin) && same;
    same = keep(k->orientation, &s->orientation[HIMC_LEGS], sizeof k->orientation) && same;
    same = keep(k->rotation, &s->rotation[HIMC_LEGS], sizeof k->rotation) && same;
    return same && k->known;
}

static bool keep_target(himc_still_legs *k, const himc_posture_motion *target)
{
    bool same = keep(k->joint, &target->joint[FIRST], sizeof k->joint);
    same = keep(k->rate, &target->rate[FIRST], sizeof k->rate) && same;
    return keep(k->acceleration, &target->acceleration[FIRST], sizeof k->acceleration) && same;
}

void himc_still_legs_errors(himc_still_legs *legs, const himc_skeleton *skeleton,
                            const himc_body_state *state, const himc_posture_motion *target,
                            tracking_error *e)
{
    himc_vec3 *error[3] = {&e->angle[FIRST], &e->rate[FIRST], &e->acceleration[FIRST]};
    bool rest = keep_state(legs, state);
    bool same = keep_target(legs, target) && rest;
    legs->torque_known = legs->torque_known && rest;
    legs->known = true;
    if (!same)
        himc_tracking_error_joints(skeleton, state, target, FIRST, HIMC_JOINTS, e);
    for (int k = 0; k < 3; k++)
        memcpy(same ? error[k] : legs->error[k], same ? legs->error[k] : error[k],
               sizeof legs->error[k]);
}

void himc_still_legs_torques(himc_still_legs *legs, const himc_skeleton *skeleton,
                             const himc_body_state *state, const himc_vec3 *wanted,
                             himc_vec3 torque[HIMC_JOINTS])
{
    bool same = keep(legs->wanted, &wanted[FIRST], sizeof legs->wanted) && legs->torque_known;
    if (!same)
        himc_inverse_dynamics_of(skeleton, state, NULL, wanted, HIMC_LEGS, HIMC_SEGMENTS, torque);
    memcpy(same ? &torque[FIRST] : legs->torque, same ? legs->torque : &torque[FIRST],
           sizeof legs->torque);
    legs->torque_known = true;
}
