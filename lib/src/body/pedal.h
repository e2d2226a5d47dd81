/// pedal.h: the foot of one who sits, on the pedal of a drum.
#ifndef HIMC_PEDAL_H
#define HIMC_PEDAL_H

#include "body/posture.h"
#include "himc/command.h"

/// The pedal of a drum for one of his feet.
typedef struct himc_pedal {
    himc_hand foot;
    himc_vec3 heel; ///< where the pedal is hinged, on the floor (m)
    double heading; ///< of the foot, to the left (rad)
} himc_pedal;

/// From rest to rest, and at rest before and after.
typedef struct himc_pedal_course {
    double begun, takes; ///< (s)
    himc_quintic x;      ///< from there
} himc_pedal_course;

/// The foot that moves, or moved last; the other one stays where it rests. All 0: both rest.
typedef struct himc_pedal_foot {
    himc_hand foot;
    bool away;               ///< on a pedal or on its way to it, else at rest or on its way back
    himc_pedal_course heel;  ///< (m)
    himc_pedal_course turn;  ///< heading (rad), share of the way to the pedal
    himc_pedal_course angle; ///< of the pedal, its end up (rad)
    double back, aside;      ///< of the trunk meanwhile, aside to the right (rad)
    himc_target sway, tilt; ///< of the pelvis from its place (m, rad), as the leg makes up for them
    himc_vec3 sway_jerk, tilt_jerk; ///< until the next tick
    double felt;                    ///< the time of these (s)
} himc_pedal_foot;

#define HIMC_PEDAL_WAY .4 ///< of a foot to a pedal or back (s); chosen

#define HIMC_PEDAL_LEAN 0.25 ///< of the trunk before, away from that leg (s); chosen

/// The pedal of the drum with that head: on the player's side, for the nearer foot. False if no
/// foot of this posture reaches it.
HIMC_RT bool himc_pedal_of(const himc_posture *posture, const himc_head_frame *head,
                           himc_pedal *pedal);
/// Its angle (rad) with the head `octaves` over its usual pitch.
HIMC_RT double himc_pedal_angle(double octaves);
/// Feels at a tick how the pelvis sways from its place `home` (m): a foot on its way is aimed at
/// the floor, one that stands goes with the pelvis.
HIMC_RT void himc_pedal_feel(himc_pedal_foot *foot, const himc_body_state *state, himc_vec3 home,
                             double t);
/// True if that leg is not as it rests at `t` (s).
HIMC_RT bool himc_pedal_moves(const himc_pedal_foot *foot, himc_hand side, double t);
/// Sends a foot to a pedal, NULL: back; from where it is at `t` (s). Another foot must be at rest.
HIMC_RT void himc_pedal_go(himc_pedal_foot *foot, const himc_posture *posture,
                           const himc_pedal *pedal, double t);
/// Turns the pedal to an angle (rad) in `seconds`.
HIMC_RT void himc_pedal_press(himc_pedal_foot *foot, double angle, double t, double seconds);
/// The joints of that leg at `t` (s), not more than a difference's step before it was sent; the
/// other joints are left alone.
HIMC_RT void himc_pedal_leg(const himc_pedal_foot *foot, const himc_posture *posture, double t,
                            himc_posture_motion *motion);

#endif
