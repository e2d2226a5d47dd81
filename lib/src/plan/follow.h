/// follow.h: a stream of live targets for one tip, and the motion of the tip that follows it.
#ifndef HIMC_FOLLOW_H
#define HIMC_FOLLOW_H

#include "plan/hand.h"

/// Live targets as they come in.
typedef struct himc_stream {
    double time;          ///< of the last one (s)
    double period;        ///< between them (s), 0 before the second: `v` is not known
    himc_vec3 x, v;       ///< the last target and its velocity (m, m/s)
    himc_vec3 before[2];  ///< targets before x, the latest first (m)
    int heard;            ///< count of targets in `before`, so far
    double noise;         ///< standard deviation of each coordinate (m)
    double memory;        ///< of the filter (s)
    himc_target filtered; ///< the last target without its noise
} himc_stream;

HIMC_RT void himc_stream_init(himc_stream *stream);

/// Takes in a target x at t; true from the second target of a stream on.
HIMC_RT bool himc_stream_add(himc_stream *stream, double t, himc_vec3 x);

/// The plan follows the stream's last target from t on.
HIMC_RT void himc_stream_follow(const himc_stream *stream, himc_hand_plan *plan, double t);

#endif
