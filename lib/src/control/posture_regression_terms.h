/// habit_terms.h: what a habit's regression is made of, for learning it and for using it.
#ifndef HIMC_POSTURE_REGRESSION_TERMS_H
#define HIMC_POSTURE_REGRESSION_TERMS_H

#include "control/posture_regression.h"

#define TAPS HIMC_REGRESSION_TAPS
#define TERMS HIMC_REGRESSION_TERMS
#define TRUNK_TERMS HIMC_REGRESSION_TRUNK_TERMS
#define ANGLES (3 * HIMC_ARM_JOINTS)
#define TRUNK (HIMC_TRUNK - 1) // the joint

/// A habit's numbers as they lie in a table.
typedef struct himc_posture_regression_numbers {
    double weight[HIMC_HANDS * ANGLES * TERMS], trunk[3 * TRUNK_TERMS];
    double spread[HIMC_HANDS * ANGLES * ANGLES];
} himc_posture_regression_numbers;

extern const himc_posture_regression_numbers himc_posture_regression_table;

/// A place as the trunk sees it, from where it turns (m).
HIMC_RT himc_vec3 himc_posture_regression_seen(himc_vec3 waist, himc_quat trunk, himc_vec3 x);
/// The terms of a hand's tip, the trunk being as given.
HIMC_RT void himc_posture_regression_terms(const himc_posture_regression_player *player,
                                           himc_hand hand, himc_quat trunk,
                                           const himc_vec3 tip[TAPS][HIMC_HANDS],
                                           double term[TERMS]);
/// Those of the trunk: of both tips, as the trunk's mean sees them.
HIMC_RT void himc_posture_regression_trunk_terms(const himc_posture_regression_player *player,
                                                 himc_quat mean,
                                                 const himc_vec3 tip[TAPS][HIMC_HANDS],
                                                 double term[TRUNK_TERMS]);
/// The mean rotation of an arm's segments in the trunk.
HIMC_RT void himc_posture_regression_frames(const himc_posture_regression_player *player,
                                            himc_hand hand, himc_quat frame[HIMC_ARM_JOINTS]);

/// A posture's tip (m).
HIMC_RT himc_vec3 himc_posture_regression_tip(const himc_skeleton *skeleton, const himc_pose *pose,
                                              himc_hand hand);
/// Frames of a take whose future is known.
int himc_posture_regression_known_frames(const himc_posture_regression_take *take);
/// That there is enough of it, and that its rotations are some; false with the reason.
bool himc_posture_regression_check(const himc_posture_regression_take *take, himc_error *error);

#endif
