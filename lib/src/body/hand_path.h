/// hand_path.h: the way of the hand in a stroke, beside that of the tip: how high the grip is, how
/// steep the hand, and how hand and elbow swing aside.
#ifndef HIMC_HAND_PATH_H
#define HIMC_HAND_PATH_H

#include "himc/body.h"
#include "himc/command.h"

typedef enum himc_hand_path_part {
    HIMC_HAND_PATH_GRIP,  ///< height of the grip (m)
    HIMC_HAND_PATH_HAND,  ///< elevation of the hand (rad)
    HIMC_HAND_PATH_LOOP,  ///< hand and stick about the vertical through the tip, outwards (rad)
    HIMC_HAND_PATH_ELBOW, ///< elbow further out about the line from shoulder to wrist (rad)
    HIMC_HAND_PATH_SWING, ///< elbow about that line since `hang` was its direction (rad)
    HIMC_HAND_PATH_PARTS
} himc_hand_path_part;

/// Where the parts are at a time, how they move, and where to until they are aimed anew.
typedef struct himc_hand_path {
    bool moving; ///< else the hand is where it rests with the tip there
    double time; ///< (s)
    double value[HIMC_HAND_PATH_PARTS];
    double rate[HIMC_HAND_PATH_PARTS];         ///< (1/s)
    double acceleration[HIMC_HAND_PATH_PARTS]; ///< (1/s^2)
    double goal[HIMC_HAND_PATH_PARTS];
    himc_vec3 hang; ///< unit vector from the shoulder towards the elbow, of which the part across
                    ///< the line to the wrist counts; 0: none yet, it hangs as it would at rest
} himc_hand_path;

/// How the joints share a stroke.
typedef struct himc_hand_style {
    double grip_lead; ///< of the grip before the tip (s): negative, it comes after and the elbow
                      ///< has more of the stroke
    double hand_lead; ///< of the hand's elevation (s)
    double wrist;     ///< share of the stick's elevation that the hand has, the fingers the rest
    double rise;      ///< of the grip before the tip on the way up, more (s)
    double loop;      ///< of hand and stick aside, over the difference of both ways (rad/rad)
    double elbow;     ///< outwards, over the tip's height (rad/m)
} himc_hand_style;

/// Of a stroke with that dynamic, 0 .. 1.
HIMC_RT himc_hand_style himc_hand_style_of(himc_nuance nuance, double dynamic);
/// Of the strokes of a roll.
HIMC_RT himc_hand_style himc_hand_style_roll(void);

/// Where a hand rests while the tip is `height` above its level at impact (m): `level` is that (m),
/// `stick` the length from grip to tip (m), `french` the share of the French grip.
HIMC_RT void himc_hand_path_rest(double height, double level, double stick, double french,
                                 double value[HIMC_HAND_PATH_PARTS]);

/// The way of the tip that a path is aimed at.
typedef struct himc_hand_ahead {
    double grip, hand; ///< its height over `level` at the foresights of the style's leads (m)
    double now;        ///< its height over `level` now (m)
    double up;         ///< its velocity at HIMC_HAND_PATH_RISES from now (m/s)
    double level;      ///< its height at the next impact (m)
    double french;     ///< share of the French grip
} himc_hand_ahead;

/// How long before its effect the way of the tip must be known for a lead (s).
HIMC_RT double himc_hand_path_foresight(double lead);
#define HIMC_HAND_PATH_RISES 0.015 ///< (s); chosen: the hand starts up in the contact
#define HIMC_HAND_PATH_SWINGS 0.05 ///< (s); chosen: half the delay of the elbow's swing

/// Aims the path at the way of the tip; `stick` is the length from grip to tip (m). A path that
/// does not move yet begins there at rest.
HIMC_RT void himc_hand_path_aim(himc_hand_path *path, const himc_hand_style *style,
                                const himc_hand_ahead *ahead, double stick);

/// The path at `t` (s).
HIMC_RT himc_hand_path himc_hand_path_at(const himc_hand_path *path, double t);

/// Lets the elbow, which hangs along `hang`, swing towards another direction at that angle (rad).
HIMC_RT void himc_hand_path_swing(himc_hand_path *path, himc_vec3 hang, double angle);

/// The stick's elevation with the grip so much lower than the tip (m).
HIMC_RT double himc_hand_path_stick(double lower, double stick);

#endif
