/// parts.h: what the generator is made of; private to mocap/.
#ifndef HIMC_MOCAP_PARTS_H
#define HIMC_MOCAP_PARTS_H

#include "mocap.h"

/// Who plays. Angles in rad, lengths in m.
typedef struct mocap_player {
    const char *name;
    double height, mass;          ///< (m, kg)
    double upper_arm, forearm;    ///< lengths, shares of what the height gives
    double stick;                 ///< length (m)
    double edge;                  ///< player's edge of the set-up in front of the hips (m)
    double lean, sway;            ///< of the trunk: mean, and with the strokes (rad)
    double french;                ///< grip: 0 palms down .. 1 thumbs up
    double out;                   ///< elbow, out of the vertical plane
    double palm;                  ///< the hand's elevation at impact
    double seat;                  ///< height of the hip joints (m)
    double shoulder;              ///< its flexion, a share of the elbow's
    double fingers;               ///< part of the wrist's flexion that the fingers make instead
    double lead[HIMC_ARM_JOINTS]; ///< of the joints at the apex (s)
    double apart;                 ///< strikes of one hand from the middle (m)
    double pace, size;            ///< of the strokes, 1 the nuance's own
    double looseness;             ///< of the variation from stroke to stroke, 1 usual
} mocap_player;

/// How a nuance is played. The point is 0.15 m behind the mallet's centre.
typedef struct mocap_gesture {
    double height;       ///< of the point at the apex (m)
    double shoulder;     ///< factor of the shoulder's share
    double wrist, grip;  ///< their flexion at the apex (rad)
    double loop;         ///< of the elbow, and against it the shoulder, on the way up (rad)
    double down, impact; ///< speed of the point and of the mallet at impact (m/s)
    double up, rebound;  ///< the same after it (m/s)
    double fall, lift;   ///< times of the ways down and up (s)
    double interval;     ///< of one hand's strokes (s)
    double spread[3];    ///< standard deviations of height, down, up (shares)
} mocap_gesture;

extern const mocap_player himc_mocap_player[HIMC_MOCAP_PLAYERS];
extern const mocap_gesture himc_mocap_gesture[HIMC_NUANCES];

/// In front of the player's edge (m).
double himc_mocap_spot(himc_spot spot);
himc_skeleton_config himc_mocap_body(int player);

/// An arm's posture said by what a player attends to.
typedef struct mocap_key {
    himc_vec3 tip;      ///< mallet's centre in the world (m)
    double stick, hand; ///< elevations (rad)
    double out;         ///< of the elbow (rad)
    double french;      ///< grip
} mocap_key;

/// Shoulder, elbow, wrist and grip for a key; false if it is out of reach.
bool himc_mocap_arm(const himc_skeleton *skeleton, himc_quat trunk, himc_hand hand,
                    const mocap_key *key, himc_quat joint[HIMC_ARM_JOINTS]);
/// The axis of an arm's flexion, sideways, as each of its segments sees it in that posture.
void himc_mocap_flexion(himc_quat trunk, const himc_quat joint[HIMC_ARM_JOINTS],
                        himc_vec3 axis[HIMC_ARM_JOINTS]);
/// Place of the point `back` metres behind the tip (m).
HIMC_RT himc_vec3 himc_mocap_stick_point(const himc_skeleton *skeleton, himc_quat trunk,
                                         himc_hand hand, const himc_quat joint[HIMC_ARM_JOINTS],
                                         double back);

/// A number over time: quintics between knots, which stand in the order of time.
typedef struct mocap_knot {
    double t, x, v, a;
} mocap_knot;

typedef struct mocap_curve {
    mocap_knot *knot; ///< owned
    int count, room;
} mocap_curve;

bool himc_mocap_curve_init(mocap_curve *curve, int room);
void himc_mocap_curve_free(mocap_curve *curve);
/// Appends a knot; one that would stand before the last is put at the last one's time.
void himc_mocap_curve_add(mocap_curve *curve, mocap_knot knot);
HIMC_RT double himc_mocap_curve_at(const mocap_curve *curve, double t);

/// How one joint takes part in one stroke: 0 in the posture of the impact, 1 in that of the apex.
typedef struct mocap_share {
    double touch;           ///< time of the impact (s)
    double arrive, rebound; ///< rates there, before (downward) and after (upward) (1/s)
    double turn[2];    ///< times before and after the impact in which one becomes the other (s)
    double fall, lift; ///< times from and to the apex (s)
    double top;        ///< where the lift ends, 1 unless it is the last
} mocap_share;

/// Appends a stroke: from the apex, to the impact, to the next apex.
void himc_mocap_curve_stroke(mocap_curve *curve, const mocap_share *share);

/// Shortens the time of a fall so that it is no steeper than falls may be; its acceleration on
/// arrival with `rate` (1/s).
double himc_mocap_soften(double rate, double *time);
/// Its rate at `t` seconds from the impact, within the turn (1/s).
double himc_mocap_turn_rate(const mocap_share *share, double t);

/// Numbers that look random and are the same for the same seed.
typedef struct mocap_dice {
    uint64_t state;
} mocap_dice;

mocap_dice himc_mocap_dice(uint64_t seed, const int *which, int count);
double himc_mocap_uniform(mocap_dice *dice); ///< 0 .. 1
double himc_mocap_normal(mocap_dice *dice);  ///< mean 0, deviation 1, within +-2

/// A slow wandering: a sum of sines, mean 0, deviation about 1.
#define MOCAP_SINES 5
typedef struct mocap_wander {
    double rate[MOCAP_SINES], phase[MOCAP_SINES];
} mocap_wander;

mocap_wander himc_mocap_wander(mocap_dice *dice);
HIMC_RT double himc_mocap_wander_at(const mocap_wander *wander, double t);

#endif
