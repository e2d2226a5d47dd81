/// gesture.h: what the tip does in a stroke of each nuance, in numbers.
#ifndef HIMC_GESTURE_H
#define HIMC_GESTURE_H

#include "capture/units.h"

typedef struct himc_gesture {
    double height;  ///< of the tip above the place of contact when it begins to fall (m)
    double speed;   ///< of impact (m/s)
    double down;    ///< time of the downstroke (s)
    double dwell;   ///< time held at the top (s)
    double lift;    ///< time the lift takes when there is no hurry (s)
    double depth;   ///< how far the tip swings back towards the player (m)
    double arc;     ///< acceleration at the top, in -height/down^2: 0 halts there, 2 flows over
    double rebound; ///< height the rebound goes to by itself, in heights
    const himc_unit *unit; ///< whose fall it has, or NULL for the built-in one
    double pull; ///< its time, in rebound heights over rebound speed: below 1 is pulled, 2 is free
} himc_gesture;

/// The stroke when there is time enough. `dynamic` 0 .. 1.
HIMC_RT himc_gesture himc_gesture_of(himc_nuance nuance, double dynamic);

/// The same with the shape of a unit; how fast a dynamic is stays what it is.
HIMC_RT himc_gesture himc_gesture_from(const himc_unit *unit, himc_nuance nuance, double dynamic);

/// Time it takes from a tip at rest `height` above the place of contact (s).
HIMC_RT double himc_gesture_time(const himc_gesture *gesture, double height);

/// The stroke a player makes of it in a shorter time: smaller, quicker, as strong as that allows.
HIMC_RT himc_gesture himc_gesture_squeeze(himc_gesture gesture, double time, double height);

#endif
