/// parts.h: the parts of the generator; private to mocap/.
#ifndef HIMC_MOCAP_PARTS_H
#define HIMC_MOCAP_PARTS_H

#include "mocap.h"

/// A player. Angles in rad, lengths in m.
typedef struct mocap_player {
    const char *name;
    double height, mass;          ///< (m, kg)
    double upper_arm, forearm;    ///< lengths, as shares of those that the height gives
    double stick;                 ///< length (m)
    double edge;                  ///< distance of the set-up's near edge from the hips (m)
    double lean, sway;            ///< of the trunk: mean, and with the strokes (rad)
    double french;                ///< grip: 0 palms down .. 1 thumbs up
    double out;                   ///< angle of the elbow out of the vertical plane
    double palm;                  ///< elevation of the hand at impact
    double seat;                  ///< height of the hip joints (m)
    double shoulder;              ///< flexion of the shoulder, as a share of the elbow's
    double fingers;               ///< share of the wrist's flexion that the fingers take over
    double lead[HIMC_ARM_JOINTS]; ///< time by which a joint leaves the apex earlier (s)
    double apart;                 ///< distance of one hand's strikes from the middle (m)
    double pace, size;            ///< factors on the times and heights of the nuance
    double looseness;             ///< factor on the variation from stroke to stroke
} mocap_player;

#define MOCAP_POINT 0.15 ///< of the stick that is measured, behind the mallet's centre (m)

/// The motion of a nuance. The point is MOCAP_POINT behind the mallet's centre.
typedef struct mocap_gesture {
    double height;      ///< of the point at the apex (m)
    double shoulder;    ///< factor on the player's share of the shoulder
    double wrist, grip; ///< their flexion at the apex (rad)
    double loop; ///< extra angle of the elbow, and minus it of the shoulder, on the way up (rad)
    double down, impact; ///< speeds of the point and of the mallet before the impact (m/s)
    double up, rebound;  ///< the same after the impact (m/s)
    double fall, lift;   ///< durations of the ways down and up (s)
    double interval;     ///< of one hand's strokes (s)
    double spread[3];    ///< standard deviations of height, down, up (shares)
} mocap_gesture;

extern const mocap_player himc_mocap_player[HIMC_MOCAP_PLAYERS];
extern const mocap_gesture himc_mocap_gesture[HIMC_NUANCES];

/// Distance of the strike place from the set-up's near edge (m).
double himc_mocap_spot(himc_spot spot);
himc_skeleton_config himc_mocap_body(int player);

/// An arm's posture, given by the quantities that a player controls.
typedef struct mocap_key {
    himc_vec3 tip;      ///< mallet's centre in the world (m)
    double stick, hand; ///< elevations (rad)
    double out;         ///< angle of the elbow out of the vertical plane (rad)
    double french;      ///< grip, 0 palms down .. 1 thumbs up
} mocap_key;

/// Shoulder, elbow, wrist and grip for a key; false if it is out of reach.
bool himc_mocap_arm(const himc_skeleton *skeleton, himc_quat trunk, himc_hand hand,
                    const mocap_key *key, himc_quat joint[HIMC_ARM_JOINTS]);
/// The sideways axis of an arm's flexion in the frame of each of its segments.
void himc_mocap_flexion(himc_quat trunk, const himc_quat joint[HIMC_ARM_JOINTS],
                        himc_vec3 axis[HIMC_ARM_JOINTS]);
/// Position of the point of the stick `back` metres behind the tip (m).
HIMC_RT himc_vec3 himc_mocap_stick_point(const himc_skeleton *skeleton, himc_quat trunk,
                                         himc_hand hand, const himc_quat joint[HIMC_ARM_JOINTS],
                                         double back);

/// A knot: time (s), value, and its first two derivatives.
typedef struct mocap_knot {
    double t, x, v, a;
} mocap_knot;

/// A number over time: quintics between knots, in the order of time.
typedef struct mocap_curve {
    mocap_knot *knot; ///< owned
    int count, room;
} mocap_curve;

bool himc_mocap_curve_init(mocap_curve *curve, int room);
void himc_mocap_curve_free(mocap_curve *curve);
/// Appends a knot; a knot before the last one is moved to the time of the last one.
void himc_mocap_curve_add(mocap_curve *curve, mocap_knot knot);
HIMC_RT double himc_mocap_curve_at(const mocap_curve *curve, double t);

/// The share of one joint in one stroke: 0 in the posture of the impact, 1 in that of the apex.
typedef struct mocap_share {
    double touch;           ///< time of the impact (s)
    double arrive, rebound; ///< rates there, before (downward) and after (upward) (1/s)
    double reversal[2];     ///< times before and after the impact, between the two rates (s)
    double fall, lift;      ///< times from and to the apex (s)
    double top;             ///< share at the end of the lift, 1 except after the last stroke
} mocap_share;

/// Appends a stroke: from the apex, to the impact, to the next apex.
void himc_mocap_curve_stroke(mocap_curve *curve, const mocap_share *share);

/// Limits the time of a fall so that it is not too steep; returns its acceleration on arrival with
/// `rate` (1/s).
double himc_mocap_soften(double rate, double *time);
/// Rate of a share at `t` seconds from the impact, within the reversal (1/s).
double himc_mocap_reversal_rate(const mocap_share *share, double t);

/// Reproducible random numbers: the same for the same seed.
typedef struct mocap_random {
    uint64_t state;
} mocap_random;

mocap_random himc_mocap_random(uint64_t seed, const int *which, int count);
double himc_mocap_uniform(mocap_random *random); ///< 0 .. 1
double himc_mocap_normal(mocap_random *random);  ///< mean 0, deviation 1, within +-2

/// A slow drift: a sum of sines, mean 0, deviation about 1.
#define MOCAP_SINES 5 ///< chosen: enough that the drift does not repeat within a sequence
typedef struct mocap_wander {
    double rate[MOCAP_SINES], phase[MOCAP_SINES];
} mocap_wander;

mocap_wander himc_mocap_wander(mocap_random *random);
HIMC_RT double himc_mocap_wander_at(const mocap_wander *wander, double t);

#endif
