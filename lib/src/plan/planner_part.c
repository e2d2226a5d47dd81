/// planner_part.c: the list of a hand's strokes, sorted by beat, grace notes before the stroke on
/// their beat.
#include "plan/planner_score.h"

#include <math.h>
#include <string.h>

double himc_planner_score_seconds(const planner_score *score, double beat)
{
    return himc_score_seconds(score->tempi, score->tempo_count, beat);
}

bool himc_planner_score_same(const himc_stroke *a, const himc_stroke *b)
{
    return a->beat == b->beat && a->length == b->length && a->hand == b->hand &&
           a->nuance == b->nuance && a->dynamic == b->dynamic &&
           a->last_dynamic == b->last_dynamic && a->ornament == b->ornament && a->spot == b->spot &&
           a->x == b->x && a->y == b->y && a->early == b->early && a->bounces == b->bounces &&
           a->bounce_time == b->bounce_time && strcmp(a->drum, b->drum) == 0;
}

int himc_planner_part_after(const planner_part *part, double beat, bool from)
{
    int low = 0, high = part->count;
    while (low < high) {
        int middle = (low + high) / 2;
        double at = part->list[middle].stroke.beat;
        if (from ? at < beat : at <= beat)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

int himc_planner_loop_first(const planner_score *score, const planner_part *part)
{
    return himc_planner_part_after(part, score->from, true);
}

bool himc_planner_loop_has(const planner_score *score, int round, double beat)
{
    bool more = score->loop || round < score->rounds; // the last round plays on
    return (round <= 0 || beat >= score->from) && (!more || beat < score->to);
}

int himc_planner_part_place(const planner_part *part, const himc_stroke *stroke)
{
    int at = himc_planner_part_after(part, stroke->beat, false);
    while (at > 0 && part->list[at - 1].stroke.beat == stroke->beat &&
           part->list[at - 1].stroke.early < stroke->early)
        at--;
    return at;
}

/// Time of a stroke from beat 0 (s).
static double seconds_of(const planner_score *score, const himc_stroke *stroke)
{
    return himc_planner_score_seconds(score, stroke->beat) - stroke->early;
}

double himc_planner_score_room(const planner_score *score, const himc_stroke *stroke)
{
    const planner_part *part = &score->part[stroke->hand];
    int at = himc_planner_part_place(part, stroke);
    double least = HUGE_VAL, time = seconds_of(score, stroke);
    if (at > 0)
        least = time - seconds_of(score, &part->list[at - 1].stroke);
    if (at < part->count)
        least = fmin(least, seconds_of(score, &part->list[at].stroke) - time);
    return least;
}
