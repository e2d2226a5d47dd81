/// planner_roll.c: the strokes of rolls.
///
/// A roll has a rate, whatever the tempo, and it ends on its beat. So stroke j of a round is at
///
///     t_j = t_k + (j - k + d_j) s,   s = (t_end - t_k) / n,   n = round(rate (t_end - t_k))
///
/// with k = 0, t_k the roll's first beat and an even n while the tempo does not change; then what
/// follows begins with the right hand again. When it changes in the roll, k is the last stroke that
/// is planned already and n is counted anew, so the rate stays and nothing jumps. A stroke too near
/// to another one of its hand is left out; a roll ends where the next one begins. Invariant: a
/// place (roll, number) means the same stroke as long as the tempo and the score stay.
///
/// The strokes of a player are not quite even. Those of a machine would make a roll up to 10 dB
/// louder where a mode has whole periods between two strokes than where it has half a period more,
/// so its loudness would jump with its length and its dynamic. Therefore
///
///     d_j = w (frac(a j^2 + 1/2) - 1/2),   4 a = sqrt(5) - 1,
///
/// even in -w/2 .. w/2 and 0 on the beat. From j to j + i it changes by 2 a i j + a i^2 (mod 1), so
/// for every i the differences are even too: the strokes add up in energy, in long rolls and short.
#include "plan/planner_roll.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_ROOM 0.08 // to another stroke of the hand (s); chosen: a grace note takes so long
#define LAST_BUZZ 0.85  // the last buzz, of a stroke; chosen: a swinging head delays contacts
// w; chosen: near a period of the lowest drum, a standard deviation of 0.035 intervals, as human.c
#define UNEVENNESS 0.12
#define UNEVEN_TURN 0.30901699437494742 // a
#define MOST_ROLLS 100000               // chosen: no score has as many strokes
#define NO_ROUND INT_MIN                // in which no roll is anchored

/// The strokes of a roll in a round, in time from the round's beginning.
typedef struct roll_grid {
    int first;          ///< number of the stroke ...
    double begin, step; ///< ... at this time, and time from stroke to stroke (s)
    int count;          ///< one more than the last number
} roll_grid;

static double seconds_to(const planner_score *score, double beat)
{
    return himc_score_seconds(score->tempi, score->tempo_count, beat);
}

double himc_planner_roll_end(const planner_score *score, int i)
{
    const planner_roll *r = &score->roll[i];
    double end = r->stroke.beat + r->stroke.length;
    return i + 1 < score->roll_count ? fmin(end, r[1].stroke.beat) : end;
}

static roll_grid grid_of(const planner_score *score, int i, int in_round)
{
    const planner_roll *r = &score->roll[i];
    const planner_anchor *a = &score->anchor;
    double end = seconds_to(score, himc_planner_roll_end(score, i));
    roll_grid g = {.begin = seconds_to(score, r->stroke.beat)};
    bool anchored = a->any && a->roll == i && a->round == in_round;
    if (anchored) {
        g.first = a->number;
        g.begin = a->time;
    }
    double span = end - g.begin, n = r->rate * span;
    if (!(span > 0))
        return (roll_grid){g.first, g.begin, 1, anchored ? g.first + 1 : 0};
    n = fmax(anchored ? round(n) : 2 * round(0.5 * n), 1);
    g.step = span / n;
    g.count = g.first + (int)n;
    return g;
}

static himc_hand hand_of(int number)
{
    return number % 2 ? HIMC_LEFT : HIMC_RIGHT;
}

/// The first number of a hand from that one on.
static int own_number(himc_hand hand, int number)
{
    return hand == HIMC_HAND_ANY || hand_of(number) == hand ? number : number + 1;
}

/// Time of a stroke from the round's beginning (s).
static double time_of(const roll_grid *g, int number)
{
    double turn = UNEVEN_TURN * number * number + 0.5, uneven = turn - floor(turn) - 0.5;
    return g->begin + (number - g->first + UNEVENNESS * uneven) * g->step;
}

static double beat_of(const planner_score *score, int i, const roll_grid *g, int number)
{
    if (number == 0 && g->first == 0)
        return score->roll[i].stroke.beat;
    return himc_score_beat(score->tempi, score->tempo_count, time_of(g, number));
}

/// A bounce comes half way to the other hand's stroke; the last buzz ends before what follows.
static double bounce_time(const roll_grid *g, int number, int bounces)
{
    bool last = number + 1 >= g->count;
    double own = time_of(g, number), end = g->begin + (g->count - g->first) * g->step;
    double gap = (last ? end : time_of(g, number + 1)) - own;
    if (bounces != HIMC_BUZZ)
        return 0.5 * gap;
    return last ? LAST_BUZZ * gap : PLANNER_PRESS_OVERLAP * g->step;
}

static himc_stroke stroke_at(const planner_score *score, int i, const roll_grid *g, int number)
{
    const himc_stroke *roll = &score->roll[i].stroke;
    himc_stroke s = *roll;
    double share = g->count > 1 ? (double)number / (g->count - 1) : 0;
    s.hand = hand_of(number);
    s.beat = beat_of(score, i, g, number);
    if (g->first > 0) // numbers are no longer even over the roll
        share = (s.beat - roll->beat) / (beat_of(score, i, g, g->count - 1) - roll->beat);
    s.dynamic = roll->dynamic + fmin(share, 1) * (roll->last_dynamic - roll->dynamic);
    s.bounce_time = bounce_time(g, number, s.bounces);
    return s;
}

static bool is_left_out(const planner_score *score, const himc_stroke *stroke)
{
    return himc_planner_score_room(score, stroke) < LEAST_ROOM;
}

int himc_planner_roll_left_out(const planner_score *score, int i)
{
    roll_grid g = grid_of(score, i, NO_ROUND);
    int out = 0;
    for (int k = 0; k < g.count; k++) {
        himc_stroke s = stroke_at(score, i, &g, k);
        out += is_left_out(score, &s);
    }
    return out;
}

static bool grow(planner_score *score, himc_error *error)
{
    if (score->roll_count == MOST_ROLLS)
        return himc_error_set(error, "roll: one too many, allowed %d", MOST_ROLLS);
    if (score->roll_count < score->roll_room)
        return true;
    int wanted = score->roll_room ? 2 * score->roll_room : 16;
    planner_roll *list = realloc(score->roll, (size_t)wanted * sizeof *list);
    if (!list)
        return himc_error_set(error, "roll: out of memory for %d", wanted);
    score->roll = list;
    score->roll_room = wanted;
    return true;
}

int himc_planner_roll_insert(planner_score *score, const himc_stroke *stroke, int drum, double rate,
                             himc_error *error)
{
    int at = score->roll_count;
    if (!grow(score, error))
        return -1;
    while (at > 0 && score->roll[at - 1].stroke.beat > stroke->beat)
        at--;
    memmove(score->roll + at + 1, score->roll + at,
            (size_t)(score->roll_count - at) * sizeof *score->roll);
    score->roll[at] = (planner_roll){*stroke, drum, rate};
    score->roll_count++;
    score->anchor.roll += score->anchor.roll >= at;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        planner_part *part = &score->part[hand];
        part->rolls.roll += part->rolls.roll >= at && part->rolls.roll < score->roll_count - 1;
        for (int i = 0; i < PLANNER_MARKS; i++)
            part->mark[i].roll += part->mark[i].roll >= at;
    }
    return at;
}

bool himc_planner_roll_equal(const planner_score *a, const planner_score *b)
{
    bool same = a->roll_count == b->roll_count;
    for (int i = 0; i < a->roll_count && same; i++) {
        const himc_stroke *s = &a->roll[i].stroke, *r = &b->roll[i].stroke;
        same = a->roll[i].drum == b->roll[i].drum && a->roll[i].rate == b->roll[i].rate &&
               s->beat == r->beat && s->length == r->length && s->dynamic == r->dynamic &&
               s->last_dynamic == r->last_dynamic && s->nuance == r->nuance &&
               s->ornament == r->ornament && s->spot == r->spot && s->x == r->x && s->y == r->y &&
               strcmp(s->drum, r->drum) == 0;
    }
    return same;
}

bool himc_planner_roll_due(const planner_score *score, himc_hand hand, planner_roll_place *at,
                           planner_due *due)
{
    // in a loop where all are left out there is none
    for (int rounds = 0; rounds < 3; rounds++, at->roll = 0, at->round++) {
        if (!score->loop && at->round > score->rounds)
            return false;
        for (; at->roll < score->roll_count; at->roll++, at->number = 0) {
            roll_grid g = grid_of(score, at->roll, at->round);
            at->number = own_number(hand, at->number);
            for (; at->number < g.count; at->number += 2) {
                due->stroke = stroke_at(score, at->roll, &g, at->number);
                if (is_left_out(score, &due->stroke))
                    continue;
                due->drum = score->roll[at->roll].drum;
                due->roll = at->roll + 1;
                due->index = at->number;
                due->round = at->round;
                return true;
            }
        }
        at->number = 0;
    }
    return false;
}

/// The first number after a time from the round's beginning.
static int number_after(const roll_grid *g, double t)
{
    double steps = floor((t - g->begin) / g->step);
    int number = (int)fmin(fmax(g->first + steps, 0), g->count);
    while (number < g->count && time_of(g, number) <= t) // at most two
        number++;
    return number;
}

void himc_planner_roll_from(planner_score *score, himc_hand hand, int in_round, double t)
{
    planner_roll_place *at = &score->part[hand].rolls;
    for (int i = 0; i < score->roll_count; i++) {
        roll_grid g = grid_of(score, i, in_round);
        int number = own_number(hand, number_after(&g, t));
        *at = (planner_roll_place){i, number, in_round};
        if (number < g.count)
            return;
    }
    *at = (planner_roll_place){score->roll_count, 0, in_round};
}

void himc_planner_roll_anchor(planner_score *score)
{
    planner_roll_place *left = &score->part[HIMC_LEFT].rolls,
                       *right = &score->part[HIMC_RIGHT].rolls;
    bool ahead =
        left->round != right->round ? left->round > right->round : left->roll > right->roll;
    planner_roll_place at = ahead ? *right : *left;
    if (at.roll >= score->roll_count)
        return;
    roll_grid g = grid_of(score, at.roll, at.round);
    int planned = -1; // the last one
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_roll_place *own = &score->part[hand].rolls;
        bool within = own->roll == at.roll && own->round == at.round;
        int next = own_number((himc_hand)hand, within ? own->number : g.count);
        planned = next - 2 > planned ? next - 2 : planned;
    }
    if (planned < 0)
        return;
    score->anchor = (planner_anchor){.any = true,
                                     .roll = at.roll,
                                     .round = at.round,
                                     .number = planned,
                                     .time = g.begin + (planned - g.first) * g.step};
}

double himc_planner_roll_last_beat(const planner_score *score)
{
    for (int i = score->roll_count - 1; i >= 0; i--) {
        roll_grid g = grid_of(score, i, NO_ROUND);
        if (g.count > 0)
            return beat_of(score, i, &g, g.count - 1);
    }
    return -1;
}

/// The last roll that begins at or before a beat, -1 if there is none.
static int last_begun(const planner_score *score, double beat)
{
    int low = 0, high = score->roll_count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (score->roll[middle].stroke.beat <= beat)
            low = middle + 1;
        else
            high = middle;
    }
    return low - 1;
}

void himc_planner_roll_near(const planner_score *score, himc_hand hand, double beat, double *before,
                            double *after)
{
    int begun = last_begun(score, beat), first = begun > 0 ? begun - 1 : 0;
    *before = -HUGE_VAL, *after = HUGE_VAL;
    for (int i = first; i < score->roll_count && i <= begun + 1; i++) {
        roll_grid g = grid_of(score, i, NO_ROUND);
        int at = number_after(&g, seconds_to(score, beat)), from = at < 4 ? 0 : at - 4;
        for (int k = own_number(hand, from); k < g.count && k < at + 4;
             k += hand == HIMC_HAND_ANY ? 1 : 2) {
            double own = beat_of(score, i, &g, k);
            if (own < beat - BEAT_ROUNDING)
                *before = fmax(*before, own);
            else if (own > beat + BEAT_ROUNDING)
                *after = fmin(*after, own);
        }
    }
}

planner_roll_place himc_planner_roll_walk(const planner_score *score, int in_round, double beat)
{
    planner_roll_place at = {last_begun(score, beat), 0, in_round};
    if (at.roll < 0)
        return at;
    roll_grid g = grid_of(score, at.roll, in_round);
    at.number = number_after(&g, seconds_to(score, beat));
    if (at.number < g.count && beat_of(score, at.roll, &g, at.number) <= beat) // of rounding
        at.number++;
    return at;
}

bool himc_planner_roll_back(const planner_score *score, planner_roll_place *at, double *beat,
                            himc_hand *hand)
{
    for (; at->roll >= 0; at->roll--, at->number = INT_MAX) {
        roll_grid g = grid_of(score, at->roll, at->round);
        if (at->number > g.count)
            at->number = g.count;
        if (at->number == 0)
            continue;
        *beat = beat_of(score, at->roll, &g, at->number - 1);
        *hand = hand_of(at->number - 1);
        return true;
    }
    return false;
}
