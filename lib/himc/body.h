/// body.h: a performer's measures from a take: lengths of arms and legs where the take shows
/// their joints.
#ifndef HIMC_BODY_H
#define HIMC_BODY_H

#include "himc/skeleton.h"
#include "himc/take.h"

/// Puts the lengths (m) that the take shows into `config`: upper arms, forearms, hands (wrist to
/// grip), sticks (grip to tip), thighs and lower legs. From a skeleton's offsets, else from the
/// median distance of markers named after joints ("LeftElbow", "R_WRIST"; a name without a side
/// stands for both). Lengths outside 0.5 .. 1.6 of the usual are left as they are. Returns how
/// many were found, 0 .. 12.
int himc_body_measure(const himc_take *take, himc_skeleton_config *config);

#endif
