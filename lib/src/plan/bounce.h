/// bounce.h: a stick that bounces: what the fingers do along the head's normal between the contacts
/// of one stroke of the arm.
#ifndef HIMC_BOUNCE_H
#define HIMC_BOUNCE_H

#include "himc/command.h"

/// The state of one stroke's bounces. Heights are the tip's over the head (m), up positive.
typedef struct himc_bounce {
    bool on;          ///< from the first contact until the hand takes the stick up again
    int bounces;      ///< wanted: 1, HIMC_BUZZ or HIMC_DEAD
    double time;      ///< from the first contact to the second, or to the last (s)
    double begin;     ///< of the first contact (s)
    int contacts;     ///< ended so far
    double rest;      ///< height at which the grip is at rest (m)
    double stiffness; ///< of the grip, omega^2 (1/s^2)
    double damping;   ///< 2 zeta omega (1/s)
    double press;     ///< of gravity and fingers (m/s^2)
} himc_bounce;

/// Fastest impact (m/s) from which fingers can turn the stick round for that many bounces in that
/// time; infinite without bounces.
HIMC_RT double himc_bounce_fastest(int bounces, double time);

/// Longest time from a touch at that speed (m/s) to the bounce after it (s): fingers press a stick
/// down, they do not hold it up.
HIMC_RT double himc_bounce_longest(double speed);

/// Time that fingers need for all contacts of a stroke of that speed (m/s), also of a full buzz.
HIMC_RT double himc_bounce_full_time(int bounces, double speed);

/// The first contact, at `t`.
HIMC_RT himc_bounce himc_bounce_begin(int bounces, double time, double t);

/// The fingers' acceleration of the tip along the normal (m/s^2).
HIMC_RT double himc_bounce_acceleration(const himc_bounce *bounce, double height, double velocity);

/// Their acceleration at `t` in a dead stroke (m/s^2): a press that ends with its time.
HIMC_RT double himc_bounce_dead(const himc_bounce *bounce, double t, double velocity);

/// A contact has ended at `t`, `since` after the last force, the tip in this state: the fingers are
/// set for the flight.
HIMC_RT void himc_bounce_separated(himc_bounce *bounce, double t, double since, double height,
                                   double velocity);

/// True when the hand takes the stick up: it has all its contacts or its time is over, and it rises
/// or rests.
HIMC_RT bool himc_bounce_is_over(const himc_bounce *bounce, double t, double velocity);

#endif
