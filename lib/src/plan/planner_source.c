/// planner_source.c: the planner as a source of motion (source.h).
#include "plan/planner_state.h"

#include <string.h>

// after the predicted end of the last contact, by when the real one has begun; chosen: strokes land
// within 10 ms of their time, bounces within 30 ms
#define LATE_CONTACT 0.05 // (s)

static himc_target target(const void *source, himc_hand hand, double t)
{
    return himc_planner_target(source, hand, t);
}

static himc_source_contact next(const void *source, himc_hand hand, double t)
{
    himc_source_contact next = {.any = false};
    next.any = himc_planner_current(source, hand, t, NULL, &next.drum, &next.time);
    return next;
}

static himc_source_stroke stroke(const void *source, himc_hand hand, double t)
{
    const himc_planner *planner = source;
    himc_stroke current;
    himc_source_stroke next = {.speed = NAN};
    if (!himc_planner_current(planner, hand, t, &current, &next.drum, &next.time))
        return next;
    next.any = true;
    himc_head_frame_spot(&planner->drum[next.drum], &current, &next.x, &next.y);
    // as written, also if it lands beside that
    const timed_stroke *planned = himc_planner_current_planned(&planner->hand[hand], t);
    if (planned)
        next.lead =
            planned->goal.gesture.rise + planned->goal.gesture.dwell + planned->goal.gesture.down;
    next.spot = planned ? planned->stroke.spot : HIMC_SPOT_NORMAL;
    strcpy(next.nuance, himc_nuance_name(current.nuance));
    next.yields = himc_planner_yields(planner, hand, t);
    next.beat = current.beat;
    next.bounces = current.bounces;
    next.bounce_time = current.bounce_time;
    return next;
}

static void separated(void *source, himc_hand hand, double t, const himc_target *measured)
{
    himc_planner_separated(source, hand, t, measured);
}

static bool correct(void *source, himc_hand hand, double t, const himc_target *measured)
{
    return himc_planner_correct(source, hand, t, measured);
}

static void play(void *source, double t, const himc_target *tip, const himc_posture_motion *joints)
{
    (void)tip;
    (void)joints;
    himc_planner_play(source, t);
}

static void stop(void *source, double t, const himc_target *tip)
{
    (void)tip;
    himc_planner_stop(source, t);
}

static double beat(const void *source, double t)
{
    return himc_planner_beat(source, t);
}

static double end(const void *source)
{
    return himc_planner_end(source) + LATE_CONTACT;
}

const himc_source himc_planner_source = {target, next, stroke, separated, correct,
                                         play,   stop, beat,   end};
