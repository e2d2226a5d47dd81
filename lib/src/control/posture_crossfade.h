/// posture_crossfade.h: a change of the source of joint targets without a jump.
#ifndef HIMC_POSTURE_CROSSFADE_H
#define HIMC_POSTURE_CROSSFADE_H

#include "base/quintic.h"
#include "body/posture.h"

/// Plain. The joint targets are those of the new source, rotated by an offset that goes to zero.
typedef struct himc_posture_crossfade {
    double since;                     ///< its beginning (s); -infinity: over
    himc_quintic offset[HIMC_JOINTS]; ///< rotation vectors (rad)
} himc_posture_crossfade;

/// From `before` to the source of which `now` is the state at `t` (s).
HIMC_RT void himc_posture_crossfade_begin(himc_posture_crossfade *crossfade, double t,
                                          const himc_posture_motion *before,
                                          const himc_posture_motion *now);
/// Ends the cross-fade: the new source's targets from now on.
HIMC_RT void himc_posture_crossfade_cancel(himc_posture_crossfade *crossfade);
/// Rotates the new source's targets at `t` (s), not before the beginning, by the offset.
HIMC_RT void himc_posture_crossfade_apply(const himc_posture_crossfade *crossfade, double t,
                                          himc_posture_motion *motion);

#endif
