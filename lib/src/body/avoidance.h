/// avoidance.h: keeps arms clear of each other and of the body, in the null space of the tips.
#ifndef HIMC_AVOIDANCE_H
#define HIMC_AVOIDANCE_H

#include "body/posture.h"

/// Elbow out, wrist up and wrist aside of each hand, and what of the wrist up is eased at a touch:
/// the parts of the posture that make room.
#define HIMC_AVOIDANCE_PARTS ((HIMC_ARM_ANGLES + 1) * HIMC_HANDS)

typedef struct himc_avoidance {
    double goal[HIMC_AVOIDANCE_PARTS]; ///< beyond the usual posture (rad); all 0: nothing is near
    int order;    ///< of crossed arms: 1 the left one is above, -1 below, 0 none
    bool crossed; ///< arms are, or wrists are still raised from it
} himc_avoidance;

/// Both tips at one time, with the posture of the trunk then.
typedef struct himc_foreseen {
    himc_vec3 tip[HIMC_HANDS]; ///< (m)
    himc_trunk_posture trunk;
} himc_foreseen;

#define HIMC_FORESEEN 2 ///< postures looked at; chosen: so few that a rehearsal can do the same
/// Their times from now on (s). Chosen: elbows and wrists lag by 0.07 s.
extern const double himc_avoidance_times[HIMC_FORESEEN];
#define HIMC_AVOIDANCE_PERIOD 0.0119 ///< of updates; chosen: every third tick at 250 Hz (s)

/// The drums.
typedef struct himc_shells {
    himc_head_frame head[HIMC_DRUMS];
    int count;
} himc_shells;

/// Moves the goal during `dt` (s) so that the foreseen postures come clear, or back to 0 when they
/// are; they are in the order of time. Returns how many postures were looked at.
HIMC_RT int himc_avoidance_update(himc_avoidance *avoidance, const himc_posture *posture,
                                  const himc_shells *shells,
                                  const himc_foreseen foreseen[HIMC_FORESEEN], double dt);

/// The same for the tips at these times, and a trunk on its way from `now` to `goal`.
HIMC_RT int himc_avoidance_look_ahead(himc_avoidance *avoidance, const himc_posture *posture,
                                      const himc_shells *shells, const himc_trunk_posture *now,
                                      const himc_trunk_posture *goal,
                                      himc_vec3 tip[HIMC_FORESEEN][HIMC_HANDS], double dt);

/// The gaps of a posture; no work is counted.
HIMC_RT himc_clearance himc_avoidance_gaps(const himc_avoidance *avoidance,
                                           const himc_posture *posture, const himc_shells *shells,
                                           const himc_vec3 tip[HIMC_HANDS]);

/// Puts the goal into a trunk posture's values.
HIMC_RT void himc_avoidance_apply(const himc_avoidance *avoidance, himc_trunk_posture *goal);

#endif
