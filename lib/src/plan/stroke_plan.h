/// stroke_plan.h: the motion of one tip up to its next touch while it is planned, in the frame of a
/// drumhead: the height along the normal and, apart from it, the tangential path.
#ifndef HIMC_STROKE_PLAN_H
#define HIMC_STROKE_PLAN_H

#include "plan/hand.h"

/// Height of a tip that waits over the head (m). Chosen: high enough not to touch a ringing head,
/// low enough to look at rest.
#define HIMC_WAIT_HEIGHT 0.12
/// Amplitude of a waiting tip's sway (m). Chosen: visible, and small beside the height.
#define HIMC_WAIT_SWAY 0.008
/// Impact speed over the mean speed of the fall, at least. Chosen: with less the tip would have to
/// slow down before the touch, and no player brakes a stroke.
#define HIMC_LEAST_LANDING 0.9
/// A tip slower than this neither rises nor falls (m/s). Chosen: at half this mean speed a halt of
/// 0.12 s takes less than 2 cm.
#define HIMC_TURNING_SPEED 0.3

/// No rebound is planned to go above this height (m). Chosen: a player's raised arm.
#define HIMC_HIGHEST_REBOUND 0.9

/// Height (m) and its derivatives (m/s, m/s^2) along a normal.
typedef struct height_state {
    double h, v, a;
} height_state;

/// The stroke being planned: its frame and the ends of its two splines so far.
typedef struct stroke_plan {
    himc_hand_plan *plan;
    himc_vec3 n;         ///< normal of the head
    double height_end;   ///< the height profile is planned to here (s) ...
    height_state height; ///< ... and has this state there
    double path_end;     ///< the tangential path is planned to here (s) ...
    himc_target path;    ///< ... and has this state there
    double approach;     ///< time to come from far away (s)
    bool straight;       ///< the path does not bow out round the body
    double lift;         ///< the tip is so much higher, over the other hand (m)
} stroke_plan;

/// Appends a quintic to the height `to` at t; nothing if t is not after the profile's end.
HIMC_RT void himc_height_profile_to(stroke_plan *s, double t, height_state to);

/// True if that quintic stays between `low` and `high` (m).
HIMC_RT bool himc_height_profile_stays(const stroke_plan *s, double t, height_state to, double low,
                                       double high);

/// Brings the height to rest, before `limit` (s).
HIMC_RT void himc_height_profile_brake(stroke_plan *s, double limit);

/// The rebound of the last touch as its nuance makes it, before an apex of height `next` (m) at
/// `top` (s).
HIMC_RT void himc_height_profile_rebound(stroke_plan *s, double top, double next);

/// From the profile's end to the apex of the stroke at `top` (s); returns the beginning of the last
/// rise (s).
HIMC_RT double himc_height_profile_rise(stroke_plan *s, double top, const himc_gesture *g);

/// Impact speed of a fall at once from height h in the time T, at least (m/s): no tip is braked
/// harder than an arm can.
HIMC_RT double himc_height_profile_least_landing(double h, double T);

/// True if a fall from height h (m) within T (s) cannot end in a touch of that speed (m/s): the tip
/// would be much faster on its way, or at the touch. A body that lags behind strikes with the speed
/// of the way.
HIMC_RT bool himc_height_profile_plunges(double h, double T, double speed);

/// True if the tip can fall from its present height and touch at t; `g` then has the height and the
/// speed of that fall.
HIMC_RT bool himc_height_profile_falls(const stroke_plan *s, double t, himc_gesture *g);

#endif
