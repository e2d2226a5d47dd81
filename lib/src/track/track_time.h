/// track_time.h: the time of a take while it is played: it starts from a stand and comes to one,
/// since a take begins and ends in motion; for tips and joints.
#ifndef HIMC_TRACK_TIME_H
#define HIMC_TRACK_TIME_H

#include "base/quintic.h"

/// Time within which the take's time starts or stops, around each of its ends (s). Chosen: a stick
/// at 5 m/s then starts with less than 10 g, and few frames are slowed down.
#define HIMC_TRACK_RAMP 0.1

/// `at` is the time of a take of `length` (s) when it is `t`, with its rate and second derivative.
HIMC_RT void himc_track_warp(double length, double t, double at[3]);

/// The inverse: when the take's time is `taken`.
HIMC_RT double himc_track_unwarp(double length, double taken);

#endif
