/// planner_score.c: beats and seconds.
///
/// Strokes are kept for each hand, sorted by beat, since a hand only ever asks for its next one.
/// While playing, beat b is at the time origin + S(b), S being the sum of 60/bpm over the tempo
/// map. A change of tempo at beat b replaces the map up to b and moves the origin so that b stays
/// where it is. In a loop with rounds from F to L, beat b of round k is at origin +
/// k (S(L) - S(F)) + S(b); the round under way becomes round 0 when tempo or score change.
/// Invariant: S grows strictly, so every time has one beat.
#include "base/array.h"
#include "plan/planner_roll.h"
#include "plan/score.h"

#include <math.h>
#include <string.h>

#define ROUND_ROUNDING 1e-12 // of a time at a round's beginning (rounds)
#define MOST_ROUNDS 1e9      // they fit an int

bool himc_planner_score_init(planner_score *score)
{
    *score = (planner_score){
        .tempi = malloc(sizeof *score->tempi), .tempo_count = 1, .until = -1, .to = HUGE_VAL};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        himc_planner_score_clear(score, (himc_hand)hand);
    if (score->tempi)
        score->tempi[0] = (himc_tempo_change){0, HIMC_TEMPO};
    return score->tempi != NULL;
}

void himc_planner_score_free(planner_score *score)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        free(score->part[hand].list);
    free(score->roll);
    free(score->tempi);
}

static double gap(const planner_score *score, double a, double b)
{
    return fabs(himc_planner_score_seconds(score, b) - himc_planner_score_seconds(score, a));
}

static bool check_count(int count, himc_error *error)
{
    return count < HIMC_SCORE_STROKES ||
           himc_error_set(error, "stroke: one too many, expected %d for a hand",
                          HIMC_SCORE_STROKES);
}

bool himc_planner_score_has_room(const planner_score *score, const himc_stroke *strokes, int count,
                                 himc_error *error)
{
    int all[HIMC_HANDS] = {score->part[HIMC_LEFT].count, score->part[HIMC_RIGHT].count};
    for (int i = 0; i < count; i++)
        if (strokes[i].hand < HIMC_HANDS && strokes[i].ornament < HIMC_ROLL_SINGLE &&
            !check_count(all[strokes[i].hand]++, error))
            return false;
    return true;
}

int himc_planner_score_place(planner_score *score, const himc_stroke *stroke, int drum,
                             himc_error *error)
{
    planner_part *part = &score->part[stroke->hand];
    double least = himc_planner_score_room(score, stroke);
    bool good = true;
    if (drum < 0 || drum >= HIMC_DRUMS)
        good =
            himc_error_set(error, "stroke: drum number %d, expected 0 .. %d", drum, HIMC_DRUMS - 1);
    else if (!check_count(part->count, error))
        good = false;
    else if (least < HIMC_CLOSEST_STROKES - TIME_ROUNDING)
        good = himc_error_set(
            error,
            "stroke: BEAT: %g is %.3g s from another stroke of the %s hand, expected %g s or more",
            stroke->beat, least, himc_hand_name(stroke->hand), HIMC_CLOSEST_STROKES);
    good =
        good && himc_array_grow(&part->list, part->count, &part->room, sizeof *part->list, error);
    return good ? himc_planner_part_place(part, stroke) : -1;
}

void himc_planner_score_insert(planner_score *score, int index, const himc_stroke *stroke, int drum)
{
    planner_part *part = &score->part[stroke->hand];
    planner_stroke *at = part->list + index;
    if (part->count == 0)
        part->listed.round = 0; // its rounds begin with the one under way
    memmove(at + 1, at, (size_t)(part->count - index) * sizeof *at);
    *at = (planner_stroke){*stroke, drum, 0};
    part->count++;
    part->listed.number += index < part->listed.number;
}

int himc_planner_score_common(const planner_part *a, const planner_part *b)
{
    int i = 0;
    while (i < a->count && i < b->count && a->list[i].drum == b->list[i].drum &&
           himc_planner_score_same(&a->list[i].stroke, &b->list[i].stroke))
        i++;
    return i;
}

static int first_from(const planner_part *part, double beat)
{
    return himc_planner_part_after(part, beat - BEAT_ROUNDING, true);
}

int himc_planner_score_first_drum(const planner_score *score, himc_hand hand, double beat, int none)
{
    const planner_part *part = &score->part[hand];
    int first = first_from(part, beat), roll = 0;
    while (roll < score->roll_count && himc_planner_roll_end(score, roll) <= beat)
        roll++;
    if (roll < score->roll_count &&
        (first == part->count || score->roll[roll].stroke.beat < part->list[first].stroke.beat))
        return himc_planner_roll_drum(score, roll, hand);
    return first < part->count ? part->list[first].drum : none;
}

void himc_planner_score_exchange(planner_part *a, planner_part *b)
{
    planner_part old = *a;
    for (int i = himc_planner_score_common(a, b) - 1; i >= 0; i--)
        b->list[i].settled = a->list[i].settled;
    a->list = b->list, a->count = b->count, a->room = b->room;
    b->list = old.list, b->count = old.count, b->room = old.room;
}

void himc_planner_score_clear(planner_score *score, himc_hand hand)
{
    planner_part *part = &score->part[hand];
    part->count = 0;
    part->listed = (planner_place){-1, 0, 0};
    part->rolls = (planner_place){0, 0, 0};
    score->roll_count = 0;
    score->anchor.any = false;
}

himc_tempo_change *himc_planner_score_copy_tempi(const himc_tempo_change *tempi, int count,
                                                 himc_error *error)
{
    for (int i = 0; i < count; i++) {
        if (!himc_check_range("tempo", tempi[i].bpm, HIMC_BPM_MIN, HIMC_BPM_MAX, "beats per minute",
                              error))
            return NULL;
        if (!isfinite(tempi[i].beat) || (i > 0 && tempi[i].beat <= tempi[i - 1].beat)) {
            himc_error_set(error, "tempo: BEAT: %g is not after the one before", tempi[i].beat);
            return NULL;
        }
    }
    himc_tempo_change *copy = count > 0 ? malloc((size_t)count * sizeof *copy) : NULL;
    if (!copy) {
        himc_error_set(error, "tempo: %d changes, expected 1 or more", count);
        return NULL;
    }
    memcpy(copy, tempi, (size_t)count * sizeof *copy);
    return copy;
}

void himc_planner_score_take_tempi(planner_score *score, himc_tempo_change *tempi, int count)
{
    free(score->tempi);
    score->tempi = tempi;
    score->tempo_count = count;
}

/// The number of changes up to a beat.
static int changes_to(const planner_score *score, double beat)
{
    int past = 1;
    while (past < score->tempo_count && score->tempi[past].beat <= beat)
        past++;
    return past;
}

double himc_planner_score_bpm(const planner_score *score, double beat)
{
    return score->tempi[changes_to(score, beat) - 1].bpm;
}

bool himc_planner_score_has_tempo(const planner_score *score, double beat, double bpm)
{
    int past = changes_to(score, beat);
    return score->playing && (score->loop || past == 1) && score->tempi[past - 1].bpm == bpm;
}

void himc_planner_score_set_tempo(planner_score *score, double beat, double bpm)
{
    int past = changes_to(score, beat);
    if (score->playing && score->loop) {
        score->tempi[past - 1].bpm = bpm;
        return;
    }
    score->tempo_count -= past - 1;
    memmove(score->tempi + 1, score->tempi + past,
            (size_t)(score->tempo_count - 1) * sizeof *score->tempi);
    score->tempi[0] = (himc_tempo_change){0, bpm};
}

void himc_planner_score_hold(planner_score *score, double t, double beat)
{
    score->origin = t - himc_planner_score_seconds(score, beat);
}

/// Names a round of the loop, through all starts of the transport; never 0.
static long round_name(const planner_score *score, int round)
{
    return 1 + round + (score->starts & 0xffffL) * 0x100000000L;
}

void himc_planner_score_anchor(planner_score *score, double t)
{
    bool again = himc_planner_roll_anchor(score, t);
    for (int hand = 0; hand < HIMC_HANDS && again; hand++) {
        planner_part *part = &score->part[hand];
        long name = round_name(score, part->rolls.round);
        for (planner_mark *m = part->mark; m < part->mark + PLANNER_MARKS; m++)
            if (m->name == name && m->roll == part->rolls.roll && m->number >= part->rolls.number)
                m->name = 0;
    }
    planner_anchor *a = &score->anchor;
    a->kept = a->time + himc_planner_score_time(score, a->round, 0);
}

void himc_planner_score_keep(planner_score *score)
{
    planner_anchor *a = &score->anchor;
    if (score->playing)
        a->time = a->kept - himc_planner_score_time(score, a->round, 0);
}

void himc_planner_score_start(planner_score *score, double t)
{
    score->playing = true;
    score->over = score->goes_on = score->empties = false;
    score->count = NAN;
    if (score->loop && score->beat >= score->to)
        score->beat = score->from;
    score->starts++;
    score->rounds = score->past = 0;
    himc_planner_score_hold(score, t, score->beat);
    score->anchor.any = false;
    double begin = himc_planner_score_seconds(score, score->beat - BEAT_ROUNDING);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int next = first_from(&score->part[hand], score->beat);
        score->part[hand].listed = (planner_place){-1, next, 0};
        score->part[hand].looked = 0;
        himc_planner_roll_from(score, (himc_hand)hand, 0, begin);
    }
}

void himc_planner_score_stop(planner_score *score, double beat)
{
    score->beat = score->empties ? 0 : beat;
    score->playing = score->over = score->goes_on = score->empties = false;
}

int himc_planner_score_rebase(planner_score *score, double t)
{
    int round = himc_planner_score_round_at(score, t);
    score->starts += round != 0;
    score->past += round;
    score->origin += round * himc_planner_score_round_length(score);
    score->rounds -= round;
    score->anchor.round -= round;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        score->part[hand].listed.round -= round;
        score->part[hand].rolls.round -= round;
    }
    return round;
}

void himc_planner_score_go(planner_score *score, himc_hand hand, planner_place place)
{
    planner_part *part = &score->part[hand];
    *(place.roll < 0 ? &part->listed : &part->rolls) = place;
}

/// The stroke at a place of its list or after it that the loop plays; false if there is none.
static bool find_listed(const planner_score *score, const planner_part *part, int *number,
                        int *round)
{
    int first = himc_planner_loop_first(score, part);
    for (int turn = 0; turn < 2; turn++) {
        if (*round > 0 && *number < first)
            *number = first;
        if (*number < part->count &&
            himc_planner_loop_has(score, *round, part->list[*number].stroke.beat))
            return score->loop || *round <= score->rounds;
        *number = 0;
        ++*round;
    }
    return false;
}

void himc_planner_score_leave_loop(planner_score *score, int last)
{
    planner_due due;
    bool lists[HIMC_HANDS], rolls[HIMC_HANDS]; // in this round
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        planner_part *part = &score->part[hand];
        planner_place *own = &part->listed;
        lists[hand] = find_listed(score, part, &own->number, &own->round) && own->round <= last;
        rolls[hand] = himc_planner_roll_due(score, (himc_hand)hand, &part->rolls, &due) &&
                      part->rolls.round <= last;
    }
    score->loop = false;
    score->rounds = last;
    double end = himc_planner_score_seconds(score, score->to - BEAT_ROUNDING);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        planner_part *part = &score->part[hand];
        if (!lists[hand])
            part->listed =
                (planner_place){-1, himc_planner_part_after(part, score->to, true), last};
        if (!rolls[hand])
            himc_planner_roll_from(score, (himc_hand)hand, last, end);
    }
}

/// The stroke of its list `ahead` strokes after the next of a hand.
static bool list_next(const planner_score *score, himc_hand hand, int ahead, planner_due *due)
{
    const planner_part *part = &score->part[hand];
    int number = part->listed.number, round = part->listed.round;
    for (;; number++)
        if (!find_listed(score, part, &number, &round))
            return false;
        else if (ahead-- == 0)
            break;
    *due = (planner_due){.stroke = part->list[number].stroke,
                         .drum = part->list[number].drum,
                         .place = {-1, number, round}};
    due->time = himc_planner_score_touch(score, round, &due->stroke);
    return true;
}

/// The stroke of a roll at `place` or after it.
static bool roll_next(const planner_score *score, himc_hand hand, planner_place *place,
                      planner_due *due)
{
    if (!himc_planner_roll_due(score, hand, place, due))
        return false;
    due->time = himc_planner_score_touch(score, due->place.round, &due->stroke);
    return true;
}

bool himc_planner_score_next(const planner_score *score, himc_hand hand, int ahead,
                             planner_due *due)
{
    planner_place place = score->part[hand].rolls;
    planner_due listed, rolled;
    if (!score->playing || score->empties)
        return false;
    if (score->roll_count == 0)
        return list_next(score, hand, ahead, due);
    bool lists = list_next(score, hand, 0, &listed),
         rolls = roll_next(score, hand, &place, &rolled);
    for (int past = 0, of_list = 0; lists || rolls; past++) {
        bool list = lists && (!rolls || listed.time <= rolled.time);
        *due = list ? listed : rolled;
        if (past == ahead)
            return true;
        if (list) {
            lists = list_next(score, hand, ++of_list, &listed);
        } else {
            place.number += 2;
            rolls = roll_next(score, hand, &place, &rolled);
        }
    }
    return false;
}

void himc_planner_score_settle(planner_score *score, himc_hand hand, const planner_place *place)
{
    planner_part *part = &score->part[hand];
    long name = round_name(score, place->round);
    if (place->roll < 0)
        part->list[place->number].settled = name;
    else
        part->mark[part->marks++ % PLANNER_MARKS] =
            (planner_mark){name, place->roll, place->number};
    part->marks %= PLANNER_MARKS;
}

bool himc_planner_score_is_settled(const planner_score *score, himc_hand hand,
                                   const planner_place *place)
{
    const planner_part *part = &score->part[hand];
    long name = round_name(score, place->round);
    bool settled = place->roll < 0 && part->list[place->number].settled == name;
    for (int i = 0; i < PLANNER_MARKS && place->roll >= 0; i++)
        settled |= part->mark[i].name == name && part->mark[i].roll == place->roll &&
                   part->mark[i].number == place->number;
    return settled;
}

double himc_planner_score_last_beat(const planner_score *score)
{
    return fmax(himc_planner_roll_last_beat(score), score->until);
}

int himc_planner_score_round_at(const planner_score *score, double t)
{
    if (!score->loop && score->rounds <= 0)
        return 0;
    double length = himc_planner_score_round_length(score);
    double begin = score->origin + himc_planner_score_seconds(score, score->from);
    if (!(length > 0) || t < begin)
        return 0;
    double round = fmin(floor((t - begin) / length + ROUND_ROUNDING), MOST_ROUNDS);
    return score->loop ? (int)round : (int)fmin(round, score->rounds);
}

double himc_planner_score_total_beat(const planner_score *score, int round, double beat)
{
    return beat + ((double)score->past + round) * (himc_planner_loop_end(score) - score->from);
}

double himc_planner_score_period(const planner_score *score, double beat)
{
    return gap(score, beat - 1, beat);
}

double himc_planner_score_gap(const planner_score *score, himc_hand hand, int round, double beat)
{
    const planner_part *part = &score->part[hand];
    double least = HUGE_VAL, before, after;
    if (part->count > 0) {
        int last = himc_planner_part_after(part, beat, true) - 1,
            next = himc_planner_part_after(part, beat, false);
        double length = himc_planner_loop_end(score);
        least = last >= 0 ? gap(score, part->list[last].stroke.beat, beat)
                          : gap(score, part->list[part->count - 1].stroke.beat, length) +
                                gap(score, score->from, beat);
        least = fmin(least, next < part->count
                                ? gap(score, beat, part->list[next].stroke.beat)
                                : gap(score, beat, length) +
                                      gap(score, score->from, part->list[0].stroke.beat));
    }
    himc_planner_roll_near(score, hand, round, beat, &before, &after);
    if (before >= 0)
        least = fmin(least, gap(score, before, beat));
    return isfinite(after) ? fmin(least, gap(score, beat, after)) : least;
}

double himc_planner_score_since(const planner_score *score, double beat)
{
    double since = HUGE_VAL, rolled = himc_planner_roll_since(score, beat);
    if (rolled >= 0)
        since = gap(score, rolled, beat);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_part *part = &score->part[hand];
        int before = himc_planner_part_after(part, beat, true) - 1;
        if (before >= 0)
            since = fmin(since, gap(score, part->list[before].stroke.beat, beat));
    }
    return since;
}

planner_walk himc_planner_score_walk(const planner_score *score, int round, double beat)
{
    planner_walk walk = {.round = round, .before = himc_planner_score_total_beat(score, round, 0)};
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        walk.at[hand] = himc_planner_part_after(&score->part[hand], beat, false);
    walk.rolls = himc_planner_roll_walk(score, round, beat);
    return walk;
}

/// The beat of the next stroke of a walk, -1 if none is left in its round.
static double beat_back(const planner_score *score, planner_walk *walk)
{
    double beat = -1, rolled;
    himc_hand unused;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (walk->at[hand] > 0)
            beat = fmax(beat, score->part[hand].list[walk->at[hand] - 1].stroke.beat);
    if (himc_planner_roll_back(score, &walk->rolls, &rolled, &unused))
        beat = fmax(beat, rolled);
    return beat;
}

bool himc_planner_score_back(const planner_score *score, planner_walk *walk, planner_onset *onset)
{
    double beat = beat_back(score, walk), rolled;
    himc_hand rolls;
    if (beat < 0 && walk->round > -score->past) {
        walk->before = himc_planner_score_total_beat(score, --walk->round, 0);
        for (int hand = 0; hand < HIMC_HANDS; hand++)
            walk->at[hand] =
                himc_planner_part_after(&score->part[hand], himc_planner_loop_end(score), true);
        walk->rolls = himc_planner_roll_walk(score, walk->round, himc_planner_loop_end(score));
        beat = beat_back(score, walk);
    }
    if (beat < 0)
        return false;
    onset->beat = beat + walk->before;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_stroke *list = score->part[hand].list;
        int at = walk->at[hand];
        onset->strikes[hand] = at > 0 && list[at - 1].stroke.beat == beat;
        walk->at[hand] -= onset->strikes[hand];
    }
    if (himc_planner_roll_back(score, &walk->rolls, &rolled, &rolls) && rolled == beat) {
        onset->strikes[rolls] = true;
        walk->rolls.number--;
    }
    return true;
}

double himc_planner_score_time(const planner_score *score, int round, double beat)
{
    double begun = round == 0 ? 0 : round * himc_planner_score_round_length(score);
    return begun + (score->origin + himc_planner_score_seconds(score, beat));
}

double himc_planner_score_touch(const planner_score *score, int round, const himc_stroke *stroke)
{
    return himc_planner_score_time(score, round, stroke->beat) - stroke->early;
}

double himc_planner_score_beat_at(const planner_score *score, double t)
{
    int round = himc_planner_score_round_at(score, t);
    double begun = round == 0 ? 0 : round * himc_planner_score_round_length(score);
    return himc_score_beat(score->tempi, score->tempo_count, t - (score->origin + begun));
}
