/// grip.h: what the hand does along the head's normal while its stick touches or bounces: an
/// acceleration for the controller, bounded as fingers are.
#ifndef HIMC_GRIP_H
#define HIMC_GRIP_H

#include "base/quintic.h"

/// Depth below a head at which a pressed tip is wanted at most (m): the force of a press over the
/// stiffness of the servo, 8 N / (0.0274 kg (2 pi 20 Hz)^2).
#define HIMC_GRIP_DEPTH 0.0185

/// The wanted height of a tip over a head (m), its speed and acceleration, none of them deeper than
/// a press: h below 0 becomes D tanh(h/D), which is C2.
HIMC_RT void himc_grip_limit_depth(double depth, double *height, double *velocity,
                                   double *acceleration);

/// A press: the tip is led to `target` by a critically damped servo at 20 Hz, downwards with no
/// more than 8 N. `tip` is the tip's state, `normal` the head's, `mass` the stick's effective mass
/// there (kg). Returns the acceleration along the normal (m/s^2).
HIMC_RT double himc_grip_press(const himc_target *target, const himc_target *tip, himc_vec3 normal,
                               double mass);

#endif
