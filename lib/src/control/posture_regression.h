/// habit.h: how a player's arms go with the sticks: the joints regressed on what the tips do, so
/// that tips alone give back the elbow (learned from takes).
///
/// How shoulder, elbow, wrist and grip are turned from their means, seen from the trunk, is linear
/// in where the arm's own tip is and where it will be in 30 and 60 ms, for in a stroke the upper
/// joints go before the lower ones. Places are about their mean, seen from the trunk, in units of
/// the arm's reach: so one player's habit serves another, and goes with a body that turns to
/// another drum.
#ifndef HIMC_POSTURE_REGRESSION_H
#define HIMC_POSTURE_REGRESSION_H

#include "body/posture.h"

#define HIMC_REGRESSION_TAPS 3     ///< times at which a tip is looked at: now and ahead ...
#define HIMC_REGRESSION_STEP 0.030 ///< ... in such steps (s)
#define HIMC_REGRESSION_TERMS (1 + 3 * HIMC_REGRESSION_TAPS)
#define HIMC_REGRESSION_TRUNK_TERMS (1 + 2 * 3 * HIMC_REGRESSION_TAPS)

/// What a habit is about: the player's own.
typedef struct himc_posture_regression_player {
    himc_pose mean;            ///< posture, the mean over what was seen
    himc_vec3 tip[HIMC_HANDS]; ///< mean place of the tips, in the trunk's frame from the waist (m)
    double reach[HIMC_HANDS];  ///< shoulder to tip, the arm stretched (m)
    himc_vec3 waist;           ///< where the trunk turns (m)
    himc_vec3 joint[HIMC_HANDS][HIMC_ARM_JOINTS]; ///< of the arms, in the parent's frame (m)
    himc_vec3 stick;                              ///< its tip, in its frame (m)
    himc_quat usual;      ///< the trunk's bearing (himc_posture_trunk) for where they strike
    bool arm[HIMC_HANDS]; ///< seen: what was not, a habit leaves as it is given
    bool trunk;           ///< seen, and both arms: so it sways with them
} himc_posture_regression_player;

typedef struct himc_posture_regression {
    himc_posture_regression_player player;
    double weight[HIMC_HANDS][HIMC_ARM_JOINTS][3][HIMC_REGRESSION_TERMS]; ///< of the terms (rad)
    double trunk[3][HIMC_REGRESSION_TRUNK_TERMS]; ///< of its sway with both tips (rad)
    /// Covariance of what the weights leave unsaid, shoulder's x to grip's z (rad^2).
    double spread[HIMC_HANDS][3 * HIMC_ARM_JOINTS][3 * HIMC_ARM_JOINTS];
} himc_posture_regression;

/// A take of a player's body: postures and the tips they have (borrowed).
typedef struct himc_posture_regression_take {
    const himc_skeleton *skeleton; ///< the same for all takes of a player
    const himc_pose *pose;         ///< (frames)
    int frames;
    double rate;            ///< frames per second (Hz), 20 or more
    bool hides[HIMC_HANDS]; ///< arms that the capture does not show: nothing is learned from them
    bool hides_trunk;       ///< likewise
} himc_posture_regression_take;

/// What `count` takes of a player say of the player; false with the reason.
bool himc_posture_regression_fit(himc_posture_regression_player *player,
                                 const himc_posture_regression_take *take, int count,
                                 himc_error *error);
/// Least squares over `count` takes, those of a player after one another, each player about his own
/// means; the habit is then the first player's, until another is put into its `player`.
/// Directions in which no tip moves get no weight; an arm whose tip does not move is taken to do
/// as the other in a mirror. False with the reason if the takes do not determine it.
bool himc_posture_regression_learn(himc_posture_regression *regression,
                                   const himc_posture_regression_take *take, int count,
                                   himc_error *error);

/// Makes a habit (the usual one, say) the take's player's own: of all that explain what the take
/// shows the nearest, by ridge regression; so one stroke corrects what it moves and leaves the rest
/// as it was. False, and nothing changed, with the reason.
bool himc_posture_regression_correct(himc_posture_regression *regression,
                                     const himc_posture_regression_take *take, himc_error *error);

/// The habit learned from the whole motion database (make regression-table); its player, nobody, is to
/// be filled in.
HIMC_RT void himc_posture_regression_usual(himc_posture_regression *regression);

/// The arms' posture for tips at each tap; the rest of the pose, and an arm of which nothing was
/// seen, is taken as given, but that its trunk sways with the tips. The tips are at their places,
/// if those are not far from what was seen: of all such postures the likeliest.
HIMC_RT void himc_posture_regression_at(const himc_posture_regression *regression,
                                        const himc_vec3 tip[HIMC_REGRESSION_TAPS][HIMC_HANDS],
                                        himc_pose *pose);
/// Puts the habit into a natural posture in motion (himc_posture_moving): the arms are the habit's,
/// the trunk bears itself as there but from the player's own mean. Rates and accelerations are
/// central differences of the map.
HIMC_RT void himc_posture_regression_moving(const himc_posture_regression *regression,
                                            const himc_target tip[HIMC_REGRESSION_TAPS][HIMC_HANDS],
                                            himc_posture_motion *motion);

#endif
