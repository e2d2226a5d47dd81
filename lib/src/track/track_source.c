/// track_source.c: a take as a source of motion (source.h).
#include "track/track_state.h"

#include <math.h>

static himc_target target(const void *source, himc_hand hand, double t)
{
    const himc_track *track = source;
    return himc_track_target(track, hand, t - track->start);
}

static himc_source_stroke stroke(const void *source, himc_hand hand, double t)
{
    const himc_track *track = source;
    himc_source_stroke next = {.beat = NAN, .nuance = "none"};
    t -= track->start;
    next.any = himc_track_current(track, hand, t, &next.time, &next.x, &next.y);
    next.time += track->start;
    next.speed = himc_track_captured_speed(track, hand, t);
    return next;
}

static himc_source_contact next(const void *source, himc_hand hand, double t)
{
    const himc_track *track = source;
    himc_source_contact next = {.any = false};
    double x, y;
    next.any = himc_track_current(track, hand, t - track->start, &next.time, &x, &y);
    next.time += track->start;
    return next;
}

static void separated(void *source, himc_hand hand, double t, const himc_target *measured)
{
    himc_track *track = source;
    himc_track_separated(track, hand, t - track->start, measured);
}

static void play(void *source, double t, const himc_target *tip, const himc_posture_motion *joints)
{
    himc_track *track = source;
    himc_track_rewind(track, t + HIMC_APPROACH);
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (himc_track_present(track, (himc_hand)hand))
            himc_track_approach(track, (himc_hand)hand, &tip[hand], HIMC_APPROACH);
    himc_track_approach_posture(track, joints);
}

static void stop(void *source, double t, const himc_target *tip)
{
    himc_track *track = source;
    himc_track_stop(track, t - track->start, tip);
}

static double beat(const void *source, double t)
{
    const himc_track *track = source;
    return t - track->start;
}

static double end(const void *source)
{
    const himc_track *track = source;
    return track->start + himc_track_length(track);
}

const himc_source himc_track_source = {target, next, stroke, separated, NULL,
                                       play,   stop, beat,   end};
