/// posture_regression.h: a player's arm joints as a linear function of the drumstick tips, learned
/// from takes; private. It replaces the natural posture (body/posture.h) where a player is known,
/// so that the tips alone give back the elbows.
///
/// The rotations of shoulder, elbow, wrist and grip from their means, in the trunk's frame, are
/// linear in the position of the arm's own tip now and in 30 and 60 ms, since in a stroke the upper
/// joints move before the lower ones. Tip positions are relative to their mean, in the trunk's
/// frame, in units of the arm's reach. So weights learned from one player serve another, and they
/// stay valid when the body turns to another drum.
#ifndef HIMC_POSTURE_REGRESSION_H
#define HIMC_POSTURE_REGRESSION_H

#include "body/posture.h"

#define HIMC_REGRESSION_OFFSETS 3         ///< times at which a tip is sampled: now and ahead ...
#define HIMC_REGRESSION_OFFSET_STEP 0.030 ///< ... in these steps (s); chosen: a stroke lasts 0.1 s
#define HIMC_REGRESSION_TERMS (1 + 3 * HIMC_REGRESSION_OFFSETS)
#define HIMC_REGRESSION_TRUNK_TERMS (1 + 2 * 3 * HIMC_REGRESSION_OFFSETS)
#define HIMC_REGRESSION_ANGLES (3 * HIMC_ARM_JOINTS) ///< of an arm, shoulder's x to grip's z

/// The player that a regression refers to: means and measures.
typedef struct himc_posture_regression_player {
    himc_pose mean;            ///< mean pose
    himc_vec3 tip[HIMC_HANDS]; ///< mean tip position from the waist, in the trunk's frame (m)
    double reach[HIMC_HANDS];  ///< shoulder to tip of the straight arm (m)
    himc_vec3 waist;           ///< in the world (m)
    himc_vec3 joint[HIMC_HANDS][HIMC_ARM_JOINTS]; ///< of the arms, in the parent's frame (m)
    himc_vec3 stick;                              ///< its tip, in its frame (m)
    himc_quat natural_trunk; ///< the natural posture's trunk (himc_posture_trunk) for the strokes
    bool arm[HIMC_HANDS];    ///< captured; the regression leaves other arms unchanged
    bool trunk;              ///< captured, and both arms too; else the trunk is unchanged
} himc_posture_regression_player;

/// A player and the weights.
typedef struct himc_posture_regression {
    himc_posture_regression_player player;
    double weight[HIMC_HANDS][HIMC_ARM_JOINTS][3][HIMC_REGRESSION_TERMS]; ///< of the terms (rad)
    double trunk[3][HIMC_REGRESSION_TRUNK_TERMS]; ///< weights of the trunk's rotation (rad)
    /// Covariance of the residuals, shoulder's x to grip's z (rad^2).
    double residual_covariance[HIMC_HANDS][HIMC_REGRESSION_ANGLES][HIMC_REGRESSION_ANGLES];
} himc_posture_regression;

/// A take of a player's whole body (borrowed).
typedef struct himc_posture_regression_take {
    const himc_skeleton *skeleton; ///< the same pointer for all takes of a player
    const himc_pose *pose;         ///< (frames)
    int frames;
    double rate;                 ///< frames per second, 20 .. 10000 (Hz)
    bool unseen_arm[HIMC_HANDS]; ///< arms that the capture does not contain: not learned from
    bool unseen_trunk;           ///< likewise
} himc_posture_regression_take;

/// Fits a player, the means and measures, to `count` takes. False with the reason.
bool himc_posture_regression_fit(himc_posture_regression_player *player,
                                 const himc_posture_regression_take *take, int count,
                                 himc_error *error);

/// Learns weights by least squares from `count` takes, the takes of a player one after another,
/// each player relative to his own means. `player` becomes the first one; another may be fitted
/// into it afterwards. Directions in which no tip moves get no weight; an arm with a tip at rest
/// gets the other arm's weights, mirrored. False with the reason, for example if no tip moves.
bool himc_posture_regression_learn(himc_posture_regression *regression,
                                   const himc_posture_regression_take *take, int count,
                                   himc_error *error);

/// Fits the take's player and corrects the weights by his take: ridge regression, the smallest
/// change that explains the take. One stroke corrects the parts that it moves and leaves the rest.
/// False, and nothing changed, with the reason. `memory` (NULL if unwanted) tells whether there was
/// enough of it.
bool himc_posture_regression_correct(himc_posture_regression *regression,
                                     const himc_posture_regression_take *take, bool *memory,
                                     himc_error *error);

/// The regression learned from the whole motion database (`make regression-table`). Its player is
/// empty and must be fitted.
HIMC_RT void himc_posture_regression_default(himc_posture_regression *regression);

/// Sets the arms of `pose` for tips at each time offset (m); the likeliest posture with the tips
/// exactly at their positions, if these are not far from the captured ones. The trunk is rotated
/// with the tips; arms that were not captured, and the rest of the pose, stay as given.
HIMC_RT void himc_posture_regression_at(const himc_posture_regression *regression,
                                        const himc_vec3 tip[HIMC_REGRESSION_OFFSETS][HIMC_HANDS],
                                        himc_pose *pose);

/// Replaces the arms of a natural posture in motion (himc_posture_moving) by the regression's. The
/// trunk keeps its motion there, but about the player's own mean. Rates and accelerations are
/// central differences.
HIMC_RT void
himc_posture_regression_moving(const himc_posture_regression *regression,
                               const himc_target tip[HIMC_REGRESSION_OFFSETS][HIMC_HANDS],
                               himc_posture_motion *motion);

// Shared by posture_regression.c (use), _learn.c and _table.c

/// The numbers of a regression as one table.
typedef struct himc_posture_regression_numbers {
    double weight[HIMC_HANDS * HIMC_REGRESSION_ANGLES * HIMC_REGRESSION_TERMS];
    double trunk[3 * HIMC_REGRESSION_TRUNK_TERMS];
    double residual_covariance[HIMC_HANDS * HIMC_REGRESSION_ANGLES * HIMC_REGRESSION_ANGLES];
} himc_posture_regression_numbers;

extern const himc_posture_regression_numbers himc_posture_regression_table;

/// A world point relative to the waist, in the frame of a trunk with this orientation (m).
HIMC_RT himc_vec3 himc_posture_regression_in_trunk(himc_vec3 waist, himc_quat trunk, himc_vec3 x);

/// The terms of one arm for this trunk orientation.
HIMC_RT void himc_posture_regression_terms(const himc_posture_regression_player *player,
                                           himc_hand hand, himc_quat trunk,
                                           const himc_vec3 tip[HIMC_REGRESSION_OFFSETS][HIMC_HANDS],
                                           double term[HIMC_REGRESSION_TERMS]);

/// The terms of the trunk: both tips in the frame of the mean trunk.
HIMC_RT void
himc_posture_regression_trunk_terms(const himc_posture_regression_player *player, himc_quat mean,
                                    const himc_vec3 tip[HIMC_REGRESSION_OFFSETS][HIMC_HANDS],
                                    double term[HIMC_REGRESSION_TRUNK_TERMS]);

/// The mean orientations of an arm's segments in the trunk's frame.
HIMC_RT void himc_posture_regression_frames(const himc_posture_regression_player *player,
                                            himc_hand hand, himc_quat frame[HIMC_ARM_JOINTS]);

/// The tip of a pose (m).
HIMC_RT himc_vec3 himc_posture_regression_tip(const himc_skeleton *skeleton, const himc_pose *pose,
                                              himc_hand hand);

/// Frames of a take for which all time offsets lie in the take.
int himc_posture_regression_known_frames(const himc_posture_regression_take *take);

#endif
