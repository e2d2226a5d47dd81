/// planner.c: what is to be played: drums, strokes, tempo map; and what has to be said about it.
///
/// Strokes are kept for each hand, sorted by beat, since a hand only ever asks for its next one.
/// Memory grows here, in setup; planner_motion.c and planner_transport.c only move within it. Notes
/// are kept in a ring and each kind is given once per play, so that a fast passage does not say the
/// same thing a hundred times.
#include "plan/planner_state.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CLOSEST 0.04 // strokes of one hand (s)
#define MOST_STROKES 200000

himc_planner_config himc_planner_default(void)
{
    return (himc_planner_config){.mallet_radius = 0.02,
                                 .rest = {{0.48, 0.10, 1.0}, {0.48, -0.10, 1.0}}};
}

himc_planner *himc_planner_new(const himc_planner_config *config, himc_error *error)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (!himc_vec3_finite(config->rest[hand])) {
            himc_error_set(error, "rest of the %s hand: not finite",
                           himc_hand_name((himc_hand)hand));
            return NULL;
        }
    if (!himc_check_range("mallet_radius", config->mallet_radius, 0, 0.1, "m", error))
        return NULL;
    himc_planner *planner = calloc(1, sizeof *planner);
    himc_tempo_change *tempi = malloc(sizeof *tempi);
    if (!planner || !tempi) {
        free(planner);
        free(tempi);
        himc_error_set(error, "planner: out of memory");
        return NULL;
    }
    planner->config = *config;
    planner->tempi = tempi;
    planner->tempi[0] = (himc_tempo_change){0, HIMC_TEMPO};
    planner->tempo_count = 1;
    for (int i = 0; i < HIMC_DRUMS; i++)
        planner->place[i] = (himc_head_frame){{0.75, 0, 0.85}, 0, 0.2921};
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_hand_place(&planner->hand[hand].plan, 0, config->rest[hand]);
        planner->hand[hand].stream.time = -HUGE_VAL;
    }
    return planner;
}

void himc_planner_free(himc_planner *planner)
{
    if (!planner)
        return;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        free(planner->hand[hand].list);
    free(planner->tempi);
    free(planner);
}

static bool same_place(const himc_head_frame *a, const himc_head_frame *b)
{
    return a->center.x == b->center.x && a->center.y == b->center.y && a->center.z == b->center.z &&
           a->tilt == b->tilt && a->radius == b->radius;
}

bool himc_planner_set_drum(himc_planner *planner, int index, const himc_head_frame *place)
{
    if (index < 0 || index >= HIMC_DRUMS || !himc_vec3_finite(place->center) ||
        !isfinite(place->tilt) || !(place->radius > 0 && place->radius < 10))
        return false;
    if (same_place(&planner->place[index], place))
        return true;
    planner->place[index] = *place;
    himc_planner_replan(planner, planner->now + PLANNER_AHEAD);
    return true;
}

static double gap(const himc_planner *planner, double a, double b)
{
    return fabs(himc_score_seconds(planner->tempi, planner->tempo_count, b) -
                himc_score_seconds(planner->tempi, planner->tempo_count, a));
}

/// Where a stroke goes in the list: after those of the same beat or earlier.
static int place_of(const planner_hand *h, double beat)
{
    int low = 0, high = h->count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (h->list[middle].stroke.beat <= beat)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool check_stroke(const himc_planner *planner, const himc_stroke *stroke, int drum, int at,
                         himc_error *error)
{
    const planner_hand *h = &planner->hand[stroke->hand];
    if (drum < 0 || drum >= HIMC_DRUMS)
        return himc_error_set(error, "stroke: drum number %d, allowed 0 .. %d", drum,
                              HIMC_DRUMS - 1);
    if (h->count >= MOST_STROKES)
        return himc_error_set(error, "stroke: one too many, allowed %d for a hand", MOST_STROKES);
    double least = HUGE_VAL;
    if (at > 0)
        least = gap(planner, h->list[at - 1].stroke.beat, stroke->beat);
    if (at < h->count)
        least = fmin(least, gap(planner, h->list[at].stroke.beat, stroke->beat));
    if (least < CLOSEST)
        return himc_error_set(
            error,
            "stroke: BEAT: %g is %.3g s from another stroke of the %s hand, allowed %g s or more",
            stroke->beat, least, himc_hand_name(stroke->hand), CLOSEST);
    return true;
}

static bool grow(planner_hand *h, himc_error *error)
{
    if (h->count < h->room)
        return true;
    int wanted = h->room ? 2 * h->room : 256;
    planner_stroke *list = realloc(h->list, (size_t)wanted * sizeof *list);
    if (!list)
        return himc_error_set(error, "stroke: out of memory for %d", wanted);
    h->list = list;
    h->room = wanted;
    return true;
}

/// While playing, a stroke before what is planned already is fitted in, or given up if it is past.
static void fit_in(himc_planner *planner, himc_hand hand, int at)
{
    planner_hand *h = &planner->hand[hand];
    double t = planner->now + PLANNER_AHEAD;
    for (int i = 0; i < h->touches; i++)
        h->touch[i].index += h->touch[i].index >= at;
    if (at < h->next)
        h->next++;
    if (!planner->playing)
        return;
    himc_planner_cut(planner, hand, t);
    double turn = h->round * himc_planner_turn(planner);
    if (at < h->next && himc_planner_time_of(planner, h->list[at].stroke.beat) + turn > h->plan.end)
        h->next = at;
    else if (at < h->next && !planner->loop) {
        planner->given_up++;
        planner->left++;
        himc_planner_say(planner, PLANNER_GIVEN_UP,
                         "stroke at beat %g %s: given up, that beat is past",
                         h->list[at].stroke.beat, himc_hand_name(hand));
    }
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
}

bool himc_planner_add(himc_planner *planner, const himc_stroke *stroke, int drum, himc_error *error)
{
    planner_hand *h = &planner->hand[stroke->hand];
    int at = place_of(h, stroke->beat);
    if (!check_stroke(planner, stroke, drum, at, error) || !grow(h, error))
        return false;
    if (planner->playing)
        himc_planner_rebase(planner, planner->now);
    memmove(h->list + at + 1, h->list + at, (size_t)(h->count - at) * sizeof *h->list);
    h->list[at] = (planner_stroke){*stroke, drum, 0};
    h->count++;
    fit_in(planner, stroke->hand, at);
    return true;
}

bool himc_planner_set_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count,
                            himc_error *error)
{
    for (int i = 0; i < count; i++) {
        if (!himc_check_range("tempo", tempi[i].bpm, HIMC_BPM_MIN, HIMC_BPM_MAX, "beats per minute",
                              error))
            return false;
        if (!isfinite(tempi[i].beat) || (i > 0 && tempi[i].beat <= tempi[i - 1].beat))
            return himc_error_set(error, "tempo: BEAT: %g is not after the one before",
                                  tempi[i].beat);
    }
    himc_tempo_change *copy = count > 0 ? malloc((size_t)count * sizeof *copy) : NULL;
    if (!copy)
        return himc_error_set(error, "tempo: %d changes, allowed 1 or more", count);
    memcpy(copy, tempi, (size_t)count * sizeof *copy);
    double t = planner->now + PLANNER_AHEAD, beat = himc_planner_beat_at(planner, t);
    himc_planner_rebase(planner, t);
    free(planner->tempi);
    planner->tempi = copy;
    planner->tempo_count = count;
    if (planner->playing) {
        planner->origin = t - himc_score_seconds(copy, count, beat);
        himc_planner_replan(planner, t);
    }
    return true;
}

bool himc_planner_add_units(himc_planner *planner, const himc_unit *units, int count,
                            himc_error *error)
{
    if (planner->unit_count + count > HIMC_UNITS)
        return himc_error_set(error, "units: %d more, allowed %d in all", count, HIMC_UNITS);
    memcpy(planner->unit + planner->unit_count, units, (size_t)count * sizeof *units);
    planner->unit_count += count;
    return true;
}

void himc_planner_clear_units(himc_planner *planner)
{
    // what is planned may still look at the array, which stays where it is
    planner->unit_count = 0;
    himc_planner_replan(planner, planner->now + PLANNER_AHEAD);
}

void himc_planner_set_grip(himc_planner *planner, int grip)
{
    planner->grip = grip;
}

bool himc_planner_append_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count,
                               double beat, himc_error *error)
{
    int kept = 1;
    while (kept < planner->tempo_count && planner->tempi[kept].beat < beat)
        kept++;
    if (beat <= 0 || count < 1)
        return himc_planner_set_tempi(planner, tempi, count, error);
    himc_tempo_change *all = malloc((size_t)(kept + count) * sizeof *all);
    if (!all)
        return himc_error_set(error, "tempo: out of memory for %d changes", kept + count);
    memcpy(all, planner->tempi, (size_t)kept * sizeof *all);
    for (int i = 0; i < count; i++)
        all[kept + i] = (himc_tempo_change){tempi[i].beat + beat, tempi[i].bpm};
    free(planner->tempi);
    planner->tempi = all;
    planner->tempo_count = kept + count;
    return true;
}

void himc_planner_clear(himc_planner *planner)
{
    double t = planner->now + PLANNER_AHEAD;
    himc_planner_stop(planner, t);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        planner_hand *h = &planner->hand[hand];
        himc_planner_cut(planner, (himc_hand)hand, t);
        h->count = h->next = h->round = h->hits = 0;
        for (int i = 0; i < h->touches; i++)
            h->touch[i].index = -1;
        himc_planner_extend(planner, (himc_hand)hand, t + PLANNER_HORIZON);
    }
    planner->beat = 0;
    himc_planner_forget_said(planner);
}

void himc_planner_forget_said(himc_planner *planner)
{
    memset(planner->said, 0, sizeof planner->said);
    planner->smaller = planner->lent = planner->left = 0;
}

static void put_note(himc_planner *planner, const char *format, va_list args)
{
    if (planner->note_count == PLANNER_NOTES) {
        himc_planner_note *last =
            &planner->note[(planner->note_first + PLANNER_NOTES - 1) % PLANNER_NOTES];
        snprintf(last->text, sizeof last->text, "%d more notes were lost",
                 ++planner->note_lost + 1);
        return;
    }
    int at = (planner->note_first + planner->note_count++) % PLANNER_NOTES;
    vsnprintf(planner->note[at].text, sizeof planner->note[at].text, format, args);
}

void himc_planner_say(himc_planner *planner, planner_kind kind, const char *format, ...)
{
    if (planner->said[kind]++ > 0)
        return;
    va_list args;
    va_start(args, format);
    put_note(planner, format, args);
    va_end(args);
}

int himc_planner_given_up(himc_planner *planner)
{
    int count = planner->given_up;
    planner->given_up = 0;
    return count;
}

static void note(himc_planner *planner, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void note(himc_planner *planner, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    put_note(planner, format, args);
    va_end(args);
}

void himc_planner_sum_up(himc_planner *planner)
{
    if (planner->smaller + planner->lent + planner->left > 1)
        note(planner, "in all %d strokes smaller, %d by the other hand, %d given up",
             planner->smaller, planner->lent, planner->left);
}

bool himc_planner_note_next(himc_planner *planner, himc_planner_note *note)
{
    if (planner->note_count == 0)
        return false;
    *note = planner->note[planner->note_first];
    planner->note_first = (planner->note_first + 1) % PLANNER_NOTES;
    if (--planner->note_count == 0)
        planner->note_lost = 0;
    return true;
}
