/// planner.c: settings, score and transport: drums, motion units, strokes, tempo map, play and
/// stop.
///
/// Each function here changes the settings or the score (planner_score.c) and then lets the hands
/// be planned again (planner_motion.c); calls go in that direction only. Memory grows here, in
/// setup; the motion only moves within it.
#include "plan/planner_state.h"
#include "base/format.h"
#include "plan/planner_roll.h"
#include "plan/score.h"

#include <stdlib.h>
#include <string.h>

// allowed; chosen: no mallet and no drum is larger
#define MOST_MALLET_RADIUS 0.1 // (m)
#define MOST_HEAD_RADIUS 10.0  // (m)

#define HASTENED 0.3         // a new tempo may take the time of strokes so near (s); chosen
#define PREPARATION_TIME 1.0 // of a late score; chosen (s)
// no variation depends on a neighbour further away: a fifth of it is more than any lateness; chosen
// (s)
#define NEIGHBOUR_TIME 1.0
#define LATENESS_NOTED 0.001 // a smaller delay of the first beat is not worth a note (s)
#define PAST "that beat is past"

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
    if (!himc_check_range("mallet_radius", config->mallet_radius, 0, MOST_MALLET_RADIUS, "m",
                          error))
        return NULL;
    himc_planner *planner = calloc(1, sizeof *planner);
    if (!planner || !himc_planner_score_init(&planner->score)) {
        free(planner);
        himc_error_set(error, "planner: out of memory");
        return NULL;
    }
    planner->config = *config;
    for (int i = 0; i < HIMC_DRUMS; i++)
        planner->drum[i] = (himc_head_frame){.center = {0.75, 0, 0.85}, .radius = 0.2921};
    planner->score.drum = planner->drum;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_hand_place(&planner->hand[hand].plan, 0, config->rest[hand]);
        himc_stream_init(&planner->hand[hand].stream);
        planner->hand[hand].way.touch = -HUGE_VAL;
    }
    himc_planner_changed(planner, -HUGE_VAL);
    return planner;
}

void himc_planner_free(himc_planner *planner)
{
    if (!planner)
        return;
    himc_planner_score_free(&planner->score);
    free(planner);
}

/// Makes the round of the loop at `t` round 0, before its length changes.
static void rebase(himc_planner *planner, double t)
{
    int round = himc_planner_score_rebase(&planner->score, t);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        planner_hand *h = &planner->hand[hand];
        for (int i = 0; i < h->waiting_count; i++)
            h->waiting[i].place.round -= round;
        for (int i = 0; i < h->planned_count; i++)
            h->planned[i].place.round -= round;
    }
}

/// Rolls are about to change at t, with the tempo or what follows them: what of a roll is not
/// planned yet is counted anew.
static void before_change(himc_planner *planner, double t)
{
    if (!planner->score.playing || planner->score.roll_count == 0)
        return;
    himc_planner_cut_both(planner, t);
    // what a hand has planned or has taken over stays
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_hand *h = &planner->hand[hand];
        for (int i = 0; i < h->waiting_count; i++)
            if (h->waiting[i].reassigned)
                t = fmax(t, himc_planner_waiting_time(planner, &h->waiting[i]));
        if (h->planned_count > 0)
            t = fmax(t, h->planned[h->planned_count - 1].written.time);
    }
    himc_planner_score_anchor(&planner->score, t);
}

bool himc_planner_set_drum(himc_planner *planner, int index, const himc_head_frame *place)
{
    if (index < 0 || index >= HIMC_DRUMS || !himc_vec3_finite(place->center) ||
        !isfinite(place->tilt) || !(place->radius > 0 && place->radius < MOST_HEAD_RADIUS))
        return false;
    if (planner->known[index] && himc_head_frame_equal(&planner->drum[index], place))
        return true;
    double t = planner->now + PLANNER_AHEAD;
    before_change(planner, t);
    planner->drum[index] = *place;
    planner->known[index] = true;
    himc_planner_score_keep(&planner->score);
    himc_planner_rest_again(planner);
    himc_planner_replan(planner, t);
    return true;
}

void himc_planner_set_body(himc_planner *planner)
{
    himc_planner_rest_again(planner);
    himc_planner_replan(planner, planner->now + PLANNER_AHEAD);
}

bool himc_planner_check_units(int count, int more, himc_error *error)
{
    return count + more <= HIMC_UNITS ||
           himc_error_set(error, "units: %d more, expected %d in all", more, HIMC_UNITS);
}

int himc_planner_units(const himc_planner *planner)
{
    return planner->unit_count;
}

bool himc_planner_add_units(himc_planner *planner, const himc_unit *units, int count,
                            himc_error *error)
{
    if (!himc_planner_check_units(planner->unit_count, count, error))
        return false;
    memcpy(planner->unit + planner->unit_count, units, (size_t)count * sizeof *units);
    planner->unit_count += count;
    return true;
}

void himc_planner_clear_units(himc_planner *planner)
{
    // planned strokes may still point into the array, which stays where it is
    planner->unit_count = 0;
    himc_planner_replan(planner, planner->now + PLANNER_AHEAD);
}

void himc_planner_set_grip(himc_planner *planner, int grip)
{
    planner->grip = grip;
}

void himc_planner_set_servo(himc_planner *planner, bool servo)
{
    if (planner->servo == servo)
        return;
    planner->servo = servo;
    himc_planner_replan(planner, planner->now + PLANNER_AHEAD);
}

void himc_planner_set_human(himc_planner *planner, himc_human human)
{
    planner->human = human;
    planner->hits = 0;
    himc_planner_replan(planner, planner->now + PLANNER_AHEAD);
}

/// While playing, a stroke before the planned ones is fitted in.
static void fit_in(himc_planner *planner, himc_hand hand, int at, bool first)
{
    planner_score *score = &planner->score;
    planner_hand *h = &planner->hand[hand];
    const planner_place *next = &score->part[hand].listed;
    const planner_stroke *line = &score->part[hand].list[at];
    const himc_stroke *added = &line->stroke;
    double t = planner->now + PLANNER_AHEAD;
    himc_planner_cut(planner, hand, t);
    double time = himc_planner_score_touch(score, next->round, added);
    if (score->loop) {
        // the next one in the first round in which the hand is free by then, if it comes before the
        // present next one; planned strokes of a later round are put back already
        int round = 0;
        while (himc_planner_score_touch(score, round, added) <= h->plan.end)
            round++;
        if (round > 0 && himc_planner_score_touch(score, 0, added) > planner->now)
            himc_planner_tell_next_round(planner, added);
        if (first || round < next->round || (round == next->round && at < next->number))
            himc_planner_score_go(score, hand, (planner_place){-1, at, round});
        else if (round > next->round && at == next->number)
            himc_planner_score_go(score, hand, (planner_place){-1, at + 1, next->round});
        h->added = at + 1;
    } else if (at < next->number && time > h->plan.end) {
        himc_planner_score_go(score, hand, (planner_place){-1, at, next->round});
    } else if (at < next->number) { // its beat is past
        char name[HIMC_PLANNER_NAME];
        timed_stroke past = {.stroke = *added, .place = {-1, 0, -1}};
        himc_planner_tell_miss(planner, &(himc_planner_miss){*added, line->drum, false, time, PAST},
                               himc_planner_name(planner, &past, name));
    }
    himc_planner_extend(planner, hand, t + PLANNER_HORIZON);
    h->added = 0;
}

/// After the end of the score the beats go on: for a stroke or a roll whose beat, or end, is still
/// to come it goes on, too; else a line says what plays it.
static void go_on(himc_planner *planner, const himc_stroke *stroke, double end)
{
    char name[HIMC_PLANNER_NAME];
    planner_score *score = &planner->score;
    timed_stroke late = {.stroke = *stroke, .place = {-1, 0, -1}};
    if (!score->over)
        return;
    rebase(planner, planner->now);
    if (himc_planner_score_time(score, 0, end) - stroke->early > planner->now + PLANNER_AHEAD) {
        score->beat = himc_planner_score_beat_at(score, planner->now);
        himc_planner_score_start(score, planner->now);
        score->goes_on = true;
    } else {
        himc_planner_say(planner, PLANNER_NEXT_PLAY, "%s: " PAST ", the next play has it",
                         himc_planner_name(planner, &late, name));
    }
}

bool himc_planner_goes_on(const himc_planner *planner)
{
    return planner->score.goes_on;
}

bool himc_planner_accepts(himc_planner *planner, const himc_stroke *stroke, int drum,
                          himc_error *error)
{
    return himc_planner_score_place(&planner->score, stroke, drum, error) >= 0;
}

bool himc_planner_has_room(const himc_planner *planner, const himc_stroke *strokes, int count,
                           himc_error *error)
{
    return himc_planner_score_has_room(&planner->score, strokes, count, error);
}

bool himc_planner_add(himc_planner *planner, const himc_stroke *stroke, int drum, himc_error *error)
{
    planner_score *score = &planner->score;
    int at = himc_planner_score_place(score, stroke, drum, error);
    if (at < 0)
        return false;
    go_on(planner, stroke, stroke->beat);
    bool running = score->playing && !score->empties;
    double t = planner->now + PLANNER_AHEAD;
    if (running) {
        rebase(planner, planner->now);
        before_change(planner, t);
    }
    bool first = score->part[stroke->hand].count == 0;
    himc_planner_score_insert(score, at, stroke, drum);
    planner_hand *h = &planner->hand[stroke->hand];
    for (int i = 0; i < h->planned_count; i++) // later ones move up by one
        h->planned[i].place.number +=
            h->planned[i].place.roll < 0 && h->planned[i].place.number >= at;
    himc_planner_rest_again(planner);
    if (!running)
        return true;
    himc_planner_score_keep(score);
    fit_in(planner, stroke->hand, at, first);
    if (score->roll_count > 0)
        himc_planner_replan(planner, t);
    return true;
}

/// A roll that has lost its beats to another one is named.
static void tell_overlap(himc_planner *planner, const himc_stroke *own, const himc_stroke *other)
{
    const char *on = own->drum[0] ? " on " : "", *other_on = other->drum[0] ? " on " : "";
    if (other->beat > own->beat)
        himc_planner_say(planner, PLANNER_OVERLAP,
                         "roll at beat %g%s%s: ends at beat %g, where another one begins%s%s, not "
                         "at beat %g",
                         own->beat, on, own->drum, other->beat, other_on, other->drum,
                         own->beat + own->length);
    else
        himc_planner_say(planner, PLANNER_OVERLAP,
                         "roll at beat %g%s%s: given up, another one begins there%s%s; expected "
                         "two drums, one kind and one length",
                         own->beat, on, own->drum, other_on, other->drum);
}

int himc_planner_add_roll(himc_planner *planner, const himc_stroke *roll, int drum, double rate,
                          himc_error *error)
{
    planner_score *score = &planner->score;
    char name[HIMC_PLANNER_NAME];
    go_on(planner, roll, roll->beat + roll->length);
    bool running = score->playing && !score->empties;
    if (running)
        rebase(planner, planner->now);
    int at = himc_planner_roll_insert(score, roll, drum, rate, error);
    if (at < 0)
        return -1;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; i < planner->hand[hand].planned_count; i++)
            planner->hand[hand].planned[i].place.roll +=
                planner->hand[hand].planned[i].place.roll >= at;
    for (int i = at > 1 ? at - 2 : 0; i <= at; i++) {
        const planner_roll *by = himc_planner_roll_cut_by(score, i);
        if (by)
            tell_overlap(planner, &score->roll[i].stroke, &by->stroke);
    }
    himc_planner_rest_again(planner);
    double t = planner->now + PLANNER_AHEAD;
    for (int i = 0; i < HIMC_HANDS && running; i++) {
        himc_planner_cut(planner, (himc_hand)i, t);
        double from = planner->hand[i].plan.end;
        int round = himc_planner_score_round_at(score, from);
        himc_planner_roll_from(score, (himc_hand)i, round,
                               from - himc_planner_score_time(score, round, 0));
        himc_planner_extend(planner, (himc_hand)i, t + PLANNER_HORIZON);
    }
    double end = himc_planner_score_time(score, 0, himc_planner_roll_end(score, at));
    if (running && !score->loop && end < t) {
        himc_format(name, sizeof name, "roll at beat %g", roll->beat);
        himc_planner_tell_miss(planner, &(himc_planner_miss){*roll, drum, false, end, PAST}, name);
        return 0; // that line is enough
    }
    return himc_planner_roll_left_out(score, at);
}

/// The tempo has changed at t; that was the beat then.
static void after_tempo(himc_planner *planner, double t, double beat)
{
    planner_score *score = &planner->score;
    if (score->playing || score->over)
        himc_planner_score_hold(score, t, beat);
    if (!score->playing)
        return;
    himc_planner_score_keep(score);
    planner->hastened = t + HASTENED;
    himc_planner_replan(planner, t);
}

bool himc_planner_set_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count,
                            himc_error *error)
{
    planner_score *score = &planner->score;
    himc_tempo_change *copy = himc_planner_score_copy_tempi(tempi, count, error);
    if (!copy)
        return false;
    double t = planner->now + PLANNER_AHEAD, beat = himc_planner_score_beat_at(score, t);
    rebase(planner, t);
    before_change(planner, t);
    himc_planner_score_take_tempi(score, copy, count);
    after_tempo(planner, t, beat);
    return true;
}

static double total_beat(const planner_score *score, double t)
{
    return himc_planner_score_total_beat(score, himc_planner_score_round_at(score, t),
                                         himc_planner_score_beat_at(score, t));
}

void himc_planner_follow_ramp(himc_planner *planner)
{
    himc_tempo_ramp ramp = planner->ramp;
    int steps = himc_score_ramp_steps(&ramp);
    if (steps == 0)
        return;
    double beat = total_beat(&planner->score, planner->now),
           past = ramp.length * fmax(planner->ramp_steps - 1, 0) / steps;
    if (beat < ramp.beat + past) // after `seek` it goes on from what has been reached
        planner->ramp.beat = ramp.beat = beat - past;
    double done = (beat - ramp.beat) / ramp.length;
    int now = planner->score.playing ? (int)fmin(floor(done * steps), steps) : steps;
    if (now < planner->ramp_steps)
        return;
    double bpm = now < steps ? himc_score_ramp_bpm(&ramp, now) : ramp.to;
    himc_planner_tempo(planner, planner->now, bpm);
    planner->ramp = now < steps ? ramp : (himc_tempo_ramp){.length = 0};
    planner->ramp_steps = now + 1;
}

bool himc_planner_add_tempo(himc_planner *planner, const himc_tempo_ramp *asked, himc_error *error)
{
    const planner_score *score = &planner->score;
    himc_tempo_ramp ramp = *asked;
    int count = score->tempo_count;
    if (ramp.beat < 0 && score->playing && score->loop) {
        ramp.beat = total_beat(score, planner->now);
        planner->ramp = ramp;
        planner->ramp_steps = 0;
        return true;
    }
    himc_tempo_change *all =
        malloc(((size_t)count + (size_t)himc_score_ramp_steps(&ramp) + 1) * sizeof *all);
    if (!all)
        return himc_error_set(error, "tempo: out of memory");
    if (ramp.beat < 0)
        ramp.beat = fmax(himc_planner_beat(planner, planner->now + PLANNER_AHEAD), score->beat);
    memcpy(all, score->tempi, (size_t)count * sizeof *all);
    himc_score_insert_ramp(all, &count, &ramp);
    bool good = himc_planner_set_tempi(planner, all, count, error);
    free(all);
    return good;
}

bool himc_planner_append_tempi(himc_planner *planner, const himc_tempo_change *tempi, int count,
                               double beat, himc_error *error)
{
    if (beat <= 0 || count < 1)
        return himc_planner_set_tempi(planner, tempi, count, error);
    planner_score *score = &planner->score;
    int kept = 1;
    while (kept < score->tempo_count && score->tempi[kept].beat < beat)
        kept++;
    himc_tempo_change *all = malloc((size_t)(kept + count) * sizeof *all);
    if (!all)
        return himc_error_set(error, "tempo: out of memory for %d changes", kept + count);
    memcpy(all, score->tempi, (size_t)kept * sizeof *all);
    for (int i = 0; i < count; i++)
        all[kept + i] = (himc_tempo_change){tempi[i].beat + beat, tempi[i].bpm};
    himc_planner_score_take_tempi(score, all, kept + count);
    return true;
}

/// Time of a stroke of a part that may be of another score (s); infinite past its end.
static double part_time(const planner_score *score, const planner_part *part, int i)
{
    return i < part->count ? himc_planner_score_touch(score, 0, &part->list[i].stroke) : HUGE_VAL;
}

/// The first stroke of a part that another part has at another beat, or not.
static int common_beats(const planner_part *a, const planner_part *b)
{
    int i = himc_planner_score_common(a, b);
    while (i < a->count && i < b->count && a->list[i].stroke.beat == b->list[i].stroke.beat)
        i++;
    return i;
}

/// True if a hand's plan so far is the same with the strokes of `other`.
static bool may_exchange(himc_planner *planner, himc_hand hand, const planner_score *other)
{
    const planner_score *score = &planner->score;
    const planner_part *part = &score->part[hand], *fresh = &other->part[hand];
    // one that has struck nothing waits over its first drum
    if (planner->begun && !planner->hand[hand].struck &&
        himc_planner_score_first_drum(score, hand, score->beat, -1) !=
            himc_planner_score_first_drum(other, hand, score->beat, -1))
        return false;
    if (!score->playing)
        return true;
    int index, next = part->listed.number, same = himc_planner_score_common(part, fresh);
    double to = himc_planner_looked_to(planner, hand, &index),
           time = fmin(part_time(score, part, same), part_time(score, fresh, same));
    bool ends = same == part->count || same == fresh->count, open = same >= part->looked;
    if (time == HUGE_VAL) // they are the same
        return true;
    open = open && same == next && !ends && part->list[same].settled == 0 &&
           part->list[same].drum == fresh->list[same].drum &&
           himc_planner_may_be_next(planner, &part->list[same].stroke, &fresh->list[same].stroke,
                                    part->list[same].drum);
    // a hand that has nothing more to play goes home
    if (!open && same < index && (time < to || (ends && same <= next) || same < part->looked))
        return false;
    // variation depends on the time to the neighbours in both hands: to the last ones looked at
    same = common_beats(part, fresh);
    time = fmin(part_time(score, part, same), part_time(score, fresh, same));
    for (int i = 0; i < HIMC_HANDS && planner->human.amount > 0; i++) {
        to = himc_planner_looked_to(planner, (himc_hand)i, &index);
        if (time < fmin(part_time(score, &score->part[i], index), to) + NEIGHBOUR_TIME)
            return false;
    }
    return true;
}

double himc_planner_rests_to(himc_planner *planner, himc_hand hand)
{
    const planner_score *score = &planner->score;
    const planner_part *part = &score->part[hand];
    int index, next = part->listed.number;
    double to = himc_planner_looked_to(planner, hand, &index);
    if (!score->playing) // before the beginning on none, after the end on all
        return score->starts > 0 ? HUGE_VAL : 0;
    if (next >= part->looked && next < part->count) {
        himc_stroke softest = part->list[next].stroke;
        softest.dynamic = 0;
        if (himc_planner_may_be_next(planner, &part->list[next].stroke, &softest,
                                     part->list[next].drum))
            index = next;
    }
    return fmin(to, part_time(score, part, index)) - score->origin;
}

bool himc_planner_exchange(himc_planner *planner, himc_planner *other)
{
    planner_score *score = &planner->score, *fresh = &other->score;
    bool over = score->starts > 0 && !score->playing;
    if (over || score->loop || score->past > 0 || fresh->playing ||
        !himc_planner_roll_equal(score, fresh) || score->tempo_count != fresh->tempo_count)
        return false;
    for (int i = 0; i < score->tempo_count; i++)
        if (score->tempi[i].beat != fresh->tempi[i].beat ||
            score->tempi[i].bpm != fresh->tempi[i].bpm)
            return false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (!may_exchange(planner, (himc_hand)hand, fresh))
            return false;
    planner_score with_fresh = *score; // at the drums' places
    memcpy(with_fresh.part, fresh->part, sizeof fresh->part);
    if (!himc_planner_roll_same_places(score, &with_fresh))
        return false;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        himc_planner_score_exchange(&score->part[hand], &fresh->part[hand]);
    himc_planner_rest_again(planner);
    return true;
}

void himc_planner_clear(himc_planner *planner)
{
    planner_score *score = &planner->score;
    double t = planner->now + PLANNER_AHEAD;
    bool turns = score->playing && score->loop;
    double beat = turns ? himc_planner_score_beat_at(score, t) : 0;
    himc_planner_stop(planner, t);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_planner_cut(planner, (himc_hand)hand, t);
        himc_planner_score_clear(&planner->score, (himc_hand)hand);
        planner_hand *h = &planner->hand[hand];
        h->struck = false;
        h->waiting_count = 0;
        for (int i = 0; i < h->planned_count; i++) // they are no longer in the score
            h->planned[i].place.roll = h->planned[i].place.number = -1;
        himc_planner_extend(planner, (himc_hand)hand, t + PLANNER_HORIZON);
    }
    score->beat = 0;
    himc_planner_last_until(planner, -1);
    planner->hits = 0;
    himc_planner_notes_begin(&planner->notes);
    if (!turns)
        return;
    himc_planner_score_start(score, t);
    himc_planner_score_hold(score, t, beat);
    score->empties = true; // it plays on without strokes
}

void himc_planner_last_until(himc_planner *planner, double beat)
{
    planner_score *score = &planner->score;
    if (score->until == beat)
        return;
    double t = planner->now + PLANNER_AHEAD;
    if (score->playing)
        rebase(planner, planner->now);
    if (score->loop)
        before_change(planner, t);
    score->until = beat;
    if (!score->playing || !score->loop)
        return;
    himc_planner_score_keep(score);
    himc_planner_replan(planner, t);
}

double himc_planner_last_beat(const himc_planner *planner)
{
    return himc_planner_roll_last_beat(&planner->score);
}

double himc_planner_until(const himc_planner *planner)
{
    return planner->score.until;
}

/// Begins at score->beat; the hands have been cut. If the music was `running`, listeners miss the
/// time that the first stroke needs.
static void start(himc_planner *planner, double t, bool running)
{
    planner_score *score = &planner->score;
    himc_planner_score_start(score, t);
    double late = himc_planner_lateness(planner);
    score->origin += late;
    if (running && late > LATENESS_NOTED)
        himc_planner_say(planner, PLANNER_LATE,
                         "beat %g is %.2g s late: the first stroke must be prepared", score->beat,
                         late);
    himc_planner_replan(planner, t);
}

void himc_planner_play(himc_planner *planner, double t)
{
    planner_score *score = &planner->score;
    bool plays = score->playing && !score->empties && !score->goes_on;
    if (!isfinite(t) || (plays && t < himc_planner_end(planner)))
        return;
    if (score->playing || score->beat > himc_planner_score_last_beat(score))
        score->beat = 0;
    himc_planner_notes_begin(&planner->notes);
    himc_planner_cut_both(planner, t);
    start(planner, t, false);
}

void himc_planner_stop(himc_planner *planner, double t)
{
    planner_score *score = &planner->score;
    if (!isfinite(t))
        return;
    score->over = false;
    if (!score->playing)
        return;
    himc_planner_score_stop(score, himc_planner_beat(planner, t));
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        planner->hand[hand].waiting_count = 0;
    himc_planner_cut_both(planner, t);
    // the cut has put planned hits back
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        planner->hand[hand].waiting_count = 0;
    himc_planner_replan(planner, t);
}

void himc_planner_seek(himc_planner *planner, double t, double beat)
{
    if (!isfinite(t) || !isfinite(beat))
        return;
    planner->score.beat = fmax(beat, 0);
    planner->score.over = false;
    himc_planner_rest_again(planner);
    if (!planner->score.playing)
        return;
    himc_planner_cut_both(planner, t);
    start(planner, t, true);
}

void himc_planner_loop_beats(himc_planner *planner, double t, double from, double to)
{
    planner_score *score = &planner->score;
    if (!isfinite(t))
        return;
    rebase(planner, t);
    himc_planner_cut_both(planner, t);
    before_change(planner, t);
    bool past = score->playing && himc_planner_score_beat_at(score, t) >= to;
    score->from = from;
    score->to = to;
    score->loop = true;
    score->over = false;
    score->rounds = 0;
    himc_planner_score_keep(score);
    if (past)
        himc_planner_seek(planner, t, from);
    else
        himc_planner_replan(planner, t);
}

void himc_planner_loop(himc_planner *planner, double t, bool on)
{
    planner_score *score = &planner->score;
    if (on && isfinite(score->to))
        himc_planner_loop_beats(planner, t, 0, HUGE_VAL);
    if (!isfinite(t) || score->loop == on)
        return;
    himc_planner_cut_both(planner, t);
    before_change(planner, t); // the last roll goes on to another stroke
    int rounds = on || !score->playing ? 0 : himc_planner_score_round_at(score, t);
    // a stroke of the next round that can no longer be taken back brings that round with it
    for (int hand = 0; hand < HIMC_HANDS && !on; hand++)
        for (int i = 0; i < planner->hand[hand].planned_count; i++)
            if (planner->hand[hand].planned[i].place.round > rounds)
                rounds = planner->hand[hand].planned[i].place.round;
    if (!on && isfinite(score->to))
        himc_planner_score_leave_loop(score, rounds);
    score->over = score->over && !on;
    score->rounds = rounds;
    score->loop = on;
    himc_planner_score_keep(score);
    himc_planner_replan(planner, t);
}

void himc_planner_tempo(himc_planner *planner, double t, double bpm)
{
    planner_score *score = &planner->score;
    if (!isfinite(t) || !(bpm >= HIMC_BPM_MIN && bpm <= HIMC_BPM_MAX))
        return;
    double beat = himc_planner_score_beat_at(score, t);
    planner->ramp.length = 0;
    if (himc_planner_score_has_tempo(score, beat, bpm))
        return;
    rebase(planner, t);
    before_change(planner, t);
    himc_planner_score_set_tempo(score, score->playing ? beat : score->beat, bpm);
    after_tempo(planner, t, beat);
}

double himc_planner_length(const himc_planner *planner)
{
    return himc_planner_loop_end(&planner->score);
}

double himc_planner_loop_begin(const himc_planner *planner)
{
    return planner->score.from;
}

double himc_planner_next_start(const himc_planner *planner, double t)
{
    const planner_score *score = &planner->score;
    double last = himc_planner_roll_last_beat(score), length = himc_planner_score_length(score);
    if (last >= 0 &&
        himc_planner_score_seconds(score, length) - himc_planner_score_seconds(score, last) <
            HIMC_CLOSEST_STROKES)
        length++;
    return score->playing && !score->empties
               ? fmax(length, ceil(himc_planner_score_beat_at(score, t + PREPARATION_TIME)))
               : length;
}

double himc_planner_beat(const himc_planner *planner, double t)
{
    const planner_score *score = &planner->score;
    if (!score->playing && !score->over)
        return -1;
    double beat = himc_planner_score_beat_at(score, t);
    return himc_planner_score_round_at(score, t) == 0 ? fmax(beat, score->beat) : beat;
}

double himc_planner_bpm(const himc_planner *planner, double t)
{
    return himc_planner_score_bpm(&planner->score, fmax(himc_planner_beat(planner, t), 0));
}

long himc_planner_round(const himc_planner *planner, double t)
{
    return (long)planner->score.past + himc_planner_score_round_at(&planner->score, t);
}

bool himc_planner_is_preparing(const himc_planner *planner, double t)
{
    const planner_score *score = &planner->score;
    return score->playing && !score->empties && score->past == 0 &&
           himc_planner_score_round_at(score, t) == 0 &&
           himc_planner_score_beat_at(score, t) < score->beat - BEAT_ROUNDING;
}

double himc_planner_count(const himc_planner *planner, double t)
{
    const planner_score *score = &planner->score;
    bool counts = himc_planner_is_preparing(planner, t) && isfinite(score->count);
    return counts ? himc_score_beat(score->tempi, score->tempo_count, t - score->count) : -1;
}

double himc_planner_end(const himc_planner *planner)
{
    const planner_score *score = &planner->score;
    double last = himc_planner_score_last_beat(score);
    if (!score->playing || (score->loop && (last >= 0 || score->empties)))
        return HUGE_VAL;
    double end = -HUGE_VAL; // of the last contact or bounce that waits or is planned
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_hand *h = &planner->hand[hand];
        for (int i = 0; i < h->waiting_count; i++)
            end = fmax(end, himc_goal_end(&h->waiting[i].goal));
        if (h->planned_count > 0)
            end = fmax(end, himc_goal_end(&h->planned[h->planned_count - 1].goal));
    }
    if (last >= 0)
        end = fmax(end, himc_planner_score_time(score, score->rounds, last) + HIMC_CONTACT_TIME);
    return fmax(score->origin, end);
}

void himc_planner_finish(himc_planner *planner)
{
    planner_score *score = &planner->score;
    if (score->playing) {
        himc_planner_score_stop(score, 0);
        score->over = true;
    }
    himc_planner_notes_sum_up(&planner->notes);
}

const himc_tempo_change *himc_planner_tempi(const himc_planner *planner, int *count)
{
    *count = planner->score.tempo_count;
    return planner->score.tempi;
}

bool himc_planner_loops_beats(const himc_planner *planner)
{
    return planner->score.loop && isfinite(planner->score.to);
}

bool himc_planner_is_looped(const himc_planner *planner)
{
    return planner->score.loop;
}
