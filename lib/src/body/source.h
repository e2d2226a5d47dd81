/// source.h: where the motion of a hand comes from. A source is one file with a table of functions:
/// plan/planner_source.c plays a score, hits and live targets, track/track.c a take.
#ifndef HIMC_SOURCE_H
#define HIMC_SOURCE_H

#include "base/quintic.h"
#include "body/posture.h"
#include "himc/command.h"

/// The present or next contact of a hand.
typedef struct himc_source_contact {
    bool any;    ///< else there is none, and nothing else is valid
    double time; ///< (s)
    int drum;    ///< slot
} himc_source_contact;

/// The stroke of that contact.
typedef struct himc_source_stroke {
    bool any;       ///< as of the contact
    double time;    ///< of contact (s)
    double lead;    ///< its gesture begins so long before (s)
    int drum;       ///< slot
    double x, y;    ///< on the head (m)
    himc_spot spot; ///< of a score
    double yields;  ///< so far from where it was asked for, as the hands would have met (m)
    double beat;    ///< in the score, NaN of a take
    double speed;   ///< captured, NaN of a score (m/s)
    char nuance[HIMC_NAME_SIZE]; ///< or "none"
    int bounces;                 ///< of a stroke that bounces (himc_stroke)
    double bounce_time;          ///< (s)
} himc_source_stroke;

/// Times are of the performance (s), positions in the world (m). All functions are HIMC_RT.
typedef struct himc_source {
    /// Planned state of the tip at t.
    himc_target (*target)(const void *source, himc_hand hand, double t);
    /// The contact that the hand has at t, or comes next: asked for at each step ...
    himc_source_contact (*next)(const void *source, himc_hand hand, double t);
    /// ... and its stroke.
    himc_source_stroke (*stroke)(const void *source, himc_hand hand, double t);
    /// The tip has left a head at t in that state, from which the motion goes on.
    void (*separated)(void *source, himc_hand hand, double t, const himc_target *measured);
    /// The tip is in that state shortly before a stroke: true if the motion is another from here.
    /// NULL: it never is.
    bool (*correct)(void *source, himc_hand hand, double t, const himc_target *measured);

    /// As a piece: begins at t from that state of both tips and of the joints ...
    void (*play)(void *source, double t, const himc_target *tip, const himc_posture_motion *joints);
    /// ... comes to rest from such a state ...
    void (*stop)(void *source, double t, const himc_target *tip);
    /// ... is at that beat, or of a take second, and is over at that time (s).
    double (*beat)(const void *source, double t);
    double (*end)(const void *source);
} himc_source;

#endif
