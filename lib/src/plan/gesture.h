/// gesture.h: the motion of the tip in a stroke of each nuance, in numbers.
#ifndef HIMC_GESTURE_H
#define HIMC_GESTURE_H

#include "capture/units.h"

/// A quintic between rest at the height h and the speed v at height 0, in the time T, is monotone
/// while v T/h <= 2.5. Chosen: 4 % less.
#define HIMC_STEEPEST_QUINTIC 2.4

/// Dynamic of f, the fifth step from ppp = 0 to fff = 1.
#define HIMC_FORTE (5.0 / 7)

/// A gesture that would have to be slower has this speed (m/s), and no hand plays it. Chosen: a
/// tenth of ppp.
#define HIMC_SLOWEST_GESTURE 0.04

typedef struct himc_gesture {
    double height;  ///< of the tip above the point of contact when it begins to fall (m)
    double speed;   ///< of impact (m/s)
    double down;    ///< time of the downstroke (s)
    double dwell;   ///< time held at the apex (s)
    double rise;    ///< time of an unhurried rise (s)
    double depth;   ///< largest distance of the backswing towards the player (m)
    double arc;     ///< acceleration at the apex, in -height/down^2: 0 halts there, 2 flows over
    double rebound; ///< height of a free rebound (heights)
    double rebound_time;   ///< its time (rebound heights over rebound speed): < 1 pulled, 2 free
    const himc_unit *unit; ///< motion unit that shapes the fall; NULL: the built-in shape
} himc_gesture;

/// The dynamic (0 .. 1) of strokes `louder` times as fast as those at f.
HIMC_RT double himc_gesture_dynamic(double louder);

/// The stroke with time enough. `dynamic` 0 .. 1.
HIMC_RT himc_gesture himc_gesture_of(himc_nuance nuance, double dynamic);

/// The same with the shape of a unit; the dynamic still sets the speed.
HIMC_RT himc_gesture himc_gesture_from(const himc_unit *unit, himc_nuance nuance, double dynamic);

/// The same stroke with `factor` times its impact speed and height, in the same time, within the
/// limits of all strokes, HIMC_SLOWEST_GESTURE among them.
HIMC_RT himc_gesture himc_gesture_scale(himc_gesture gesture, double factor);

/// The dynamic with which a stroke of that nuance has that speed (m/s, > 0), 1 at most; below 0 for
/// one that is softer than ppp, as a grace note may be.
HIMC_RT double himc_gesture_dynamic_at(himc_nuance nuance, double speed);

/// Time of the stroke from a tip at rest `height` above the point of contact (s).
HIMC_RT double himc_gesture_time(const himc_gesture *gesture, double height);

/// Speed that an arm in a hurry reaches from rest, over its time (m/s^2). Computed for a lumped tip
/// with strokes from 50 mm in 60 .. 150 ms; a peak acceleration of about 4 times that.
#define HIMC_HURRY 26.0
/// The same after a touch of the same spot, from which the tip comes back by itself with .85 of its
/// speed: with that peak acceleration and .71 of it in the mean, v = .71 104 T/1.85.
#define HIMC_HURRY_AGAIN 40.0

/// The stroke with a smaller impact speed, if it is near to or above the speed `most` (m/s, > 0).
HIMC_RT himc_gesture himc_gesture_bend(himc_gesture gesture, double most);

/// The stroke in a shorter time with the same impact speed: lower and quicker. `height` is the
/// tip's present one (m).
HIMC_RT himc_gesture himc_gesture_squeeze(himc_gesture gesture, double time, double height);

#endif
