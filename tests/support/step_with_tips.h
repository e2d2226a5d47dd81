/// step_with_tips.h: a step of a body with forces on its drumstick tips alone.
#ifndef HIMC_TESTS_STEP_WITH_TIPS_H
#define HIMC_TESTS_STEP_WITH_TIPS_H

#include "body/character.h"

static inline bool step_with_tips(himc_character *c, const himc_skeleton *body,
                                  const himc_vec3 *torque, const himc_vec3 force[HIMC_HANDS],
                                  double h)
{
    world_contact tip[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        tip[hand] = himc_tip_contact(body, (himc_hand)hand, force[hand], NULL);
    return himc_character_step(c, torque, tip, HIMC_HANDS, h);
}

#endif
