/// player_sit.h: how a take that shows nothing but tips comes before a drum; private.
#ifndef HIMC_PLAYER_SIT_H
#define HIMC_PLAYER_SIT_H

#include "plan/planner.h"
#include "himc/mocap.h"

/// What moves the middle of the take's strikes, or without any its lowest place and a little more,
/// onto the usual spot of the drum (m).
himc_vec3 himc_strike_offset(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                             const himc_head_frame *drum, double mallet_radius);

#endif
