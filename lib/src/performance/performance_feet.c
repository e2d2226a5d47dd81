/// performance_feet.c: a foot plays with a beater on a pedal: a mallet that is launched onto the
/// head (drum_strike.c), as fast as a hand's, on its sample. The leg's own motion is not simulated.
/// The left foot plays the hi-hat, the right one all the rest. A stroke too soon after the foot's
/// last one is not played, as a hand's.
#include "performance/performance_feet.h"

#include "base/argument.h"
#include "base/array.h"
#include "base/format.h"
#include "base/head_frame.h"
#include "plan/gesture.h"
#include "plan/score.h"

#include <math.h>
#include <stdlib.h>

#define SAME_COURSE 1e-6 // (beats) chosen: what rounding makes of a beat
// between two strokes of a foot (s); chosen: few play 10 a second with one beater, and the way to
// another pedal takes as long as a step
#define SAME_PEDAL 0.08
#define OTHER_PEDAL 0.25
#define ROUNDING 1e-6 // (s) of a stroke's time

void himc_feet_free(performance_feet *feet)
{
    free(feet->stroke);
    *feet = (performance_feet){.stroke = NULL};
}

void himc_feet_clear(performance_feet *feet)
{
    feet->count = 0;
    feet->played_to = -1;
}

static bool same(const foot_stroke *a, const foot_stroke *b)
{
    return a->beat == b->beat && a->x == b->x && a->y == b->y && a->velocity == b->velocity &&
           a->drum == b->drum && a->nuance == b->nuance;
}

bool himc_feet_may_exchange(const performance_feet *feet, const performance_feet *other)
{
    int i = 0, most = feet->count > other->count ? feet->count : other->count;
    while (i < feet->count && i < other->count && same(&feet->stroke[i], &other->stroke[i]))
        i++;
    double own = i < feet->count ? feet->stroke[i].beat : HUGE_VAL,
           its = i < other->count ? other->stroke[i].beat : HUGE_VAL;
    return i == most || fmin(own, its) >= feet->played_to;
}

void himc_feet_exchange(performance_feet *a, performance_feet *b)
{
    performance_feet own = *a;
    a->stroke = b->stroke, a->count = b->count, a->room = b->room;
    b->stroke = own.stroke, b->count = own.count, b->room = own.room;
}

bool himc_feet_plays(const performance_feet *feet, int drum)
{
    for (int i = 0; i < feet->count; i++)
        if (feet->stroke[i].drum == drum)
            return true;
    return false;
}

static foot_stroke read_stroke(const himc_stroke *stroke, int drum, const himc_head_frame *surface)
{
    foot_stroke own = {.beat = stroke->beat,
                       .velocity = himc_gesture_of(stroke->nuance, stroke->dynamic).speed,
                       .drum = drum,
                       .nuance = stroke->nuance};
    himc_head_frame_spot(surface, stroke, &own.x, &own.y);
    return own;
}

bool himc_feet_add(performance_feet *feet, const himc_stroke *stroke, performance_drums *drums,
                   int drum, himc_error *error)
{
    foot_stroke own = read_stroke(stroke, drum, himc_drums_frame(drums, drum));
    int at = feet->count;
    if (stroke->ornament != HIMC_PLAIN || stroke->bounces != 0)
        return himc_error_set(error, "foot: expected plain strokes only");
    if (stroke->spot != HIMC_SPOT_NORMAL && stroke->spot != HIMC_SPOT_XY)
        return himc_error_set(error, "foot: %s: the beater meets one place, expected no SPOT",
                              himc_spot_name(stroke->spot));
    if (!himc_drum_strike_at(drums->slot[drum].drum, HIMC_STRIKE_NEVER, own.x, own.y, own.velocity,
                             error))
        return himc_error_prefix(error, "foot");
    if (!himc_array_grow(&feet->stroke, feet->count, &feet->room, sizeof *feet->stroke, error))
        return false;
    for (; at > 0 && feet->stroke[at - 1].beat > stroke->beat; at--)
        feet->stroke[at] = feet->stroke[at - 1];
    feet->stroke[at] = own;
    feet->count++;
    return true;
}

double himc_feet_last(const performance_feet *feet)
{
    return feet->count > 0 ? feet->stroke[feet->count - 1].beat : -1;
}

// Plays a stroke `delay` (s) after `t`; false if it is not played, which is told.
static bool launch(performance_feet *feet, const foot_stroke *s, performance_drums *drums, double t,
                   double delay, performance_events *events)
{
    himc_drum *drum = drums->slot[s->drum].drum;
    foot_last *last = &feet->last[himc_drum_hats(drum) ? HIMC_LEFT : HIMC_RIGHT];
    double at = t + delay, since = at - last->time;
    bool same = last->drum == s->drum + 1;
    int kick = feet->launched % HIMC_FEET_TOLD;
    himc_error error;
    if (last->drum > 0 && since >= 0 && since < (same ? SAME_PEDAL : OTHER_PEDAL) - ROUNDING) {
        himc_format(error.text, sizeof error.text,
                    "%.3g s after the foot's last stroke%s, expected %g s or more", since,
                    same ? "" : " on another pedal", same ? SAME_PEDAL : OTHER_PEDAL);
    } else if (himc_drum_kick(drum, (int)lround(delay * himc_drum_rate(drum)), s->x, s->y,
                              s->velocity, 1 + kick, &error)) {
        feet->told[kick] = *s;
        feet->launched++;
        *last = (foot_last){at, s->drum + 1};
        himc_events_prepare(events, at, HIMC_FOOT, himc_drum_name(drum));
        return true;
    }
    himc_strike missed = {
        .time = at, .hand = HIMC_FOOT, .x = s->x, .y = s->y, .planned_time = at, .beat = s->beat};
    himc_format(missed.nuance, sizeof missed.nuance, "%s", himc_nuance_name(s->nuance));
    himc_events_missed(events, &missed, himc_drum_name(drum), error.text);
    if (isnan(s->beat))
        himc_events_note(events, "foot: %s", error.text);
    else
        himc_events_note(events, "foot at beat %g: %s", s->beat, error.text);
    return false;
}

bool himc_feet_hit(performance_feet *feet, const himc_stroke *stroke, performance_drums *drums,
                   int drum, double t, double delay, performance_events *events)
{
    foot_stroke own = read_stroke(stroke, drum, himc_drums_frame(drums, drum));
    own.beat = NAN;
    return launch(feet, &own, drums, t, delay, events);
}

int himc_feet_play(performance_feet *feet, performance_drums *drums, const himc_planner *planner,
                   double time, double now, double next, performance_events *events)
{
    int count, missed = 0;
    const himc_tempo_change *tempi = himc_planner_tempi(planner, &count);
    double t = himc_score_seconds(tempi, count, now);
    // after a jump from the beat of this tick on
    double from = fabs(feet->played_to - now) < SAME_COURSE ? feet->played_to : now;
    bool round = next < now; // a loop begins again
    double end = himc_planner_length(planner), to = round ? end : next;
    double begin = himc_planner_loop_begin(planner);
    double turned = himc_score_seconds(tempi, count, end) - himc_score_seconds(tempi, count, begin);
    for (int i = 0; i < feet->count; i++) {
        const foot_stroke *s = &feet->stroke[i];
        bool again = round && s->beat < next && s->beat >= begin;
        if (!again && !(s->beat >= from && s->beat < to))
            continue;
        double at = himc_score_seconds(tempi, count, s->beat) + (again ? turned : 0);
        missed += !launch(feet, s, drums, time, fmax(at - t, 0), events);
    }
    feet->played_to = next;
    return missed;
}

int himc_feet_tell(const performance_feet *feet, const performance_drums *drums,
                   performance_events *events, double t, double *force)
{
    himc_contact_report report;
    double ago;
    int told = 0;
    for (int i = 0; i < drums->count; i++) {
        himc_drum *drum = drums->slot[i].drum;
        for (int kick; (kick = himc_drum_kicked(drum, &report, &ago)); told++) {
            double at = t - ago;
            const foot_stroke *own = &feet->told[kick - 1];
            himc_event event = {.kind = HIMC_EVENT_STRIKE,
                                .strike = {.time = at,
                                           .hand = HIMC_FOOT,
                                           .x = report.x,
                                           .y = report.y,
                                           .velocity = report.velocity,
                                           .force = report.force,
                                           .impulse = report.impulse,
                                           .duration = report.duration,
                                           .planned_time = at,
                                           .planned_x = report.x,
                                           .planned_y = report.y,
                                           .beat = own->beat}};
            *force = fmax(*force, report.force);
            himc_format(event.strike.drum, HIMC_NAME_SIZE, "%s", himc_drum_name(drum));
            himc_format(event.strike.nuance, HIMC_NAME_SIZE, "%s", himc_nuance_name(own->nuance));
            himc_events_add(events, &event);
        }
    }
    return told;
}
