/// performance_feet.c: a foot plays with a beater on a pedal: a mallet that is launched onto the
/// head (drum_strike.c), as fast as a hand's, on its sample. The leg's own motion is not simulated.
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

static bool launch(const foot_stroke *s, performance_drums *drums, double delay, himc_error *error)
{
    himc_drum *drum = drums->slot[s->drum].drum;
    return himc_drum_kick(drum, (int)lround(delay * himc_drum_rate(drum)), s->x, s->y, s->velocity,
                          1 + (int)s->nuance, error);
}

bool himc_feet_hit(const himc_stroke *stroke, performance_drums *drums, int drum, double delay,
                   himc_error *error)
{
    foot_stroke own = read_stroke(stroke, drum, himc_drums_frame(drums, drum));
    return launch(&own, drums, delay, error);
}

void himc_feet_play(performance_feet *feet, performance_drums *drums, const himc_planner *planner,
                    double now, double next, performance_events *events)
{
    int count;
    const himc_tempo_change *tempi = himc_planner_tempi(planner, &count);
    double t = himc_score_seconds(tempi, count, now);
    // after a jump from the beat of this tick on
    double from = fabs(feet->played_to - now) < SAME_COURSE ? feet->played_to : now;
    bool round = next < now; // a loop ends on a whole beat, and begins again at 0
    double end = floor(now) + 1, to = round ? end : next;
    double t_end = himc_score_seconds(tempi, count, end);
    for (int i = 0; i < feet->count; i++) {
        const foot_stroke *s = &feet->stroke[i];
        bool again = round && s->beat < next;
        himc_error error;
        if (!again && !(s->beat >= from && s->beat < to))
            continue;
        double at = himc_score_seconds(tempi, count, s->beat) + (again ? t_end : 0);
        if (!launch(s, drums, fmax(at - t, 0), &error))
            himc_events_note(events, "foot at beat %g: %s", s->beat, error.text);
    }
    feet->played_to = next;
}

int himc_feet_tell(const performance_drums *drums, performance_events *events, double t)
{
    himc_contact_report report;
    double ago;
    int told = 0;
    for (int i = 0; i < drums->count; i++) {
        himc_drum *drum = drums->slot[i].drum;
        for (int kick; (kick = himc_drum_kicked(drum, &report, &ago)); told++) {
            double at = t - ago;
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
                                           .beat = NAN}};
            himc_format(event.strike.drum, HIMC_NAME_SIZE, "%s", himc_drum_name(drum));
            himc_format(event.strike.nuance, HIMC_NAME_SIZE, "%s",
                        himc_nuance_name((himc_nuance)(kick - 1)));
            himc_events_add(events, &event);
        }
    }
    return told;
}
