/// planner_roll.c: the strokes of rolls.
///
/// A roll has a rate, whatever the tempo, and it ends on its beat. So stroke j of a round is at
///
///     t_j = t_k + (j - k + d_j) s,   s = (t_end - t_k) / n,   n = round(rate (t_end - t_k))
///
/// with k = 0 and t_k the roll's first beat while the tempo does not change. When it changes in the
/// roll, k is the last stroke that is planned already and n is counted anew, so the rate stays and
/// nothing jumps. A stroke too near to another one of its hand is left out; a roll ends where the
/// next one begins.
///
/// A roll is joined to what follows it. t_end is x before the first touch after it, which may be a
/// grace note. With k + n even the last stroke is of the second hand, else of the first one. A
/// player ends with the hand that has less to do next, and a little earlier where a hand must go to
/// another drum:
///
///     x = max(0, need_h - (t_h - t_first) - i_h s - s),   i_h = 0 for the last hand, else 1
///
/// over both hands h, t_h the next touch of h and need_h the time that it takes after one of the
/// roll. Where both go to another drum, the hand that the other one has to follow goes first: the
/// last stroke is of the other hand (else i_h = -1). Of both n the one with the smaller x is taken.
/// In a loop what follows may be in the next round; only the length of a round, on which that
/// depends, is found without it (NO_ROUND). Invariant: a place (roll, number) means the same stroke
/// as long as the tempo, the score, the loop and the places of the drums stay.
///
/// The strokes of a player are not quite even. Those of a machine would make a roll up to 10 dB
/// louder where a mode has whole periods between two strokes than where it has half a period more,
/// so its loudness would jump with its length and its dynamic. Therefore
///
///     d_j = w (frac(a j^2 + 1/2) - 1/2),   4 a = sqrt(5) - 1,
///
/// even in -w/2 .. w/2 and 0 on the beat. From j to j + i it changes by 2 a i j + a i^2 (mod 1), so
/// for every i the differences are even too: the strokes add up in energy, in long rolls and short.
#include "base/array.h"
#include "plan/hand.h"
#include "plan/planner_roll.h"
#include "plan/sticking.h"

#include <limits.h>
#include <string.h>

#define LAST_BUZZ 0.85 // the last buzz, of a stroke; chosen: a swinging head delays contacts
// w; chosen: near a period of the lowest drum, a standard deviation of 0.035 intervals, as human.c
#define UNEVENNESS 0.12
#define UNEVEN_TURN 0.30901699437494742 // a
#define MOST_ROLLS 100000               // chosen: no score has as many strokes
#define NO_ROUND INT_MIN                // in which no roll is anchored

// the join to what follows; chosen
#define END_ROUNDING 1e-3  // of a written beat and length, which are floats (beats)
#define JOINED_TIME 1.0    // what comes later after a roll's end does not hurry (s)
#define LEAST_STEP 0.9     // of the mean: interval of a short roll
#define JOIN_GAIN 1e-6     // a roll that would end earlier by less does not (s)
#define GRACE_ROOM 0.1     // before a grace note: it is soft (s)
#define BOUNCED_ROOM 0.07  // after a bounce half an interval later (s)
#define BOTH_HANDS 0.2     // strokes of both hands so near are not for one of them (s)
#define MOST_HELD_BACK 0.5 // of an interval: so much a roll ends earlier for a stroke's strength
#define MOST_JOIN 0.5      // of the roll: where a leap takes more it fails
#define ANCHOR_BEND 0.25   // a changed interval differs by this share at most, for the last hand
#define SHORT_ROLL 8       // with fewer strokes either hand is last, for the rate's sake ...
#define RATE_GAIN 0.02     // ... or first, where the rate is nearer by more than this share
#define JOIN_ROUNDS 3      // of step and x, which depend on each other

/// The strokes of a roll in a round, in time from the round's beginning.
typedef struct roll_grid {
    himc_hand lead;     ///< hand of its first stroke, number 0
    int first;          ///< number of the stroke ...
    double begin, step; ///< ... at this time, and time from stroke to stroke (s)
    int count;          ///< one more than the last number
} roll_grid;

/// True if the roll is played with the one before it: the hands have a drum, or a bar, each.
static bool is_second(const planner_score *score, int i)
{
    const planner_roll *r = &score->roll[i], *first = r - 1;
    return i > 0 && first->stroke.beat == r->stroke.beat &&
           (first->drum != r->drum || strcmp(first->stroke.part, r->stroke.part) != 0) &&
           first->stroke.length == r->stroke.length &&
           first->stroke.ornament == r->stroke.ornament &&
           (i == 1 || first[-1].stroke.beat < r->stroke.beat);
}

static bool is_pair(const planner_score *score, int i)
{
    return i + 1 < score->roll_count && is_second(score, i + 1);
}

/// The roll after one and its second, or the count of rolls.
static int roll_after(const planner_score *score, int i)
{
    return is_pair(score, i) ? i + 2 : i + 1;
}

double himc_planner_roll_end(const planner_score *score, int i)
{
    const planner_roll *r = &score->roll[i];
    double end = r->stroke.beat + r->stroke.length;
    int after = roll_after(score, i);
    return after < score->roll_count ? fmin(end, score->roll[after].stroke.beat) : end;
}

const planner_roll *himc_planner_roll_cut_by(const planner_score *score, int i)
{
    const planner_roll *r = &score->roll[i];
    double end = r->stroke.beat + r->stroke.length;
    bool cut = !is_second(score, i) && himc_planner_roll_end(score, i) < end - END_ROUNDING;
    return cut ? &score->roll[roll_after(score, i)] : NULL;
}

/// True if another round follows, or comes before.
static bool goes_on(const planner_score *score, int in_round)
{
    return in_round != NO_ROUND && (score->loop || in_round < score->rounds);
}

static bool has_begun(const planner_score *score, int in_round)
{
    return in_round != NO_ROUND && score->past + in_round > 0;
}

/// What a hand has to play after a roll.
typedef struct roll_next {
    double time; ///< of its touch, from the round's beginning (s); infinite: nothing soon
    double leap; ///< time that it needs after a touch of the roll (s)
    double calm; ///< time with which it is as strong as after a pause (intervals); 0: any
    double room; ///< more it does not need (s)
    bool trails; ///< on that way it goes after the other hand
} roll_next;

static himc_vec3 spot_of(const planner_score *score, const himc_stroke *stroke, int drum)
{
    double x, y;
    himc_head_frame_spot(&score->drum[drum], stroke, &x, &y);
    return himc_head_frame_to_world(&score->drum[drum], x, y);
}

/// The roll that a hand plays: of two together that of its side.
static const planner_roll *roll_of(const planner_score *score, int i, himc_hand hand)
{
    const planner_roll *r = &score->roll[i];
    if (!is_pair(score, i) || !score->drum)
        return r;
    bool to_left =
        spot_of(score, &r[1].stroke, r[1].drum).y > spot_of(score, &r->stroke, r->drum).y;
    return (hand == HIMC_LEFT) == to_left ? r + 1 : r;
}

int himc_planner_roll_drum(const planner_score *score, int roll, himc_hand hand)
{
    return roll_of(score, roll, hand)->drum;
}

/// The way from a roll to a stroke on another drum or bar (m).
static himc_vec3 way_to(const planner_score *score, const planner_roll *from,
                        const himc_stroke *stroke, int drum)
{
    if (!score->drum || (drum == from->drum && strcmp(stroke->part, from->stroke.part) == 0))
        return (himc_vec3){0, 0, 0};
    return himc_vec3_sub(spot_of(score, stroke, drum), spot_of(score, &from->stroke, from->drum));
}

/// True if a hand on that way would cross the other one.
static bool crosses(himc_hand hand, himc_vec3 way)
{
    return hand == HIMC_LEFT ? way.y < -HIMC_STICKING_CROSS : way.y > HIMC_STICKING_CROSS;
}

/// The time of a leap from a roll (s).
static double leap_time(const planner_roll *from, himc_vec3 way)
{
    double length = himc_vec3_length(way), share = himc_planner_bounce_share(from->stroke.bounces);
    return length > 0 ? himc_hand_leap_time(length) / (1 - share) : 0;
}

/// The first stroke of a list after the roll, maybe of the next round, and its time; NULL if there
/// is none soon.
static const planner_stroke *listed_after(const planner_score *score, int i, int in_round, int hand,
                                          double *time)
{
    double end = himc_planner_roll_end(score, i), turned = 0;
    const planner_part *part = &score->part[hand];
    int at = himc_planner_part_after(part, end - END_ROUNDING, true);
    if (at == part->count && goes_on(score, in_round)) {
        at = himc_planner_loop_first(score, part);
        turned = himc_planner_score_round_length(score);
    }
    const himc_stroke *s = at < part->count ? &part->list[at].stroke : NULL;
    *time = s ? turned + himc_planner_score_seconds(score, s->beat) - s->early : HUGE_VAL;
    return *time <= himc_planner_score_seconds(score, end) + JOINED_TIME ? &part->list[at] : NULL;
}

/// The same as what follows; a hand that would have to cross the other one leaves it to that one,
/// unless that one has a stroke of its own then.
static void listed_next(const planner_score *score, int i, int in_round, roll_next next[HIMC_HANDS])
{
    double time[HIMC_HANDS];
    const planner_stroke *listed[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        listed[hand] = listed_after(score, i, in_round, hand, &time[hand]);
    bool both = fabs(time[HIMC_LEFT] - time[HIMC_RIGHT]) < BOTH_HANDS;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        if (!listed[hand])
            continue;
        himc_hand by = (himc_hand)hand;
        const himc_stroke *s = &listed[hand]->stroke;
        int drum = listed[hand]->drum;
        bool trails = crosses(by, way_to(score, roll_of(score, i, by), s, drum));
        if (trails && !both)
            by = himc_other_hand(by);
        const planner_roll *r = roll_of(score, i, by);
        // a grace note needs so much after a stroke and its bounce; it may end a buzz
        double room = r->stroke.bounces == 1 ? BOUNCED_ROOM + 0.5 / r->rate : GRACE_ROOM;
        if (time[hand] < next[by].time)
            next[by] = (roll_next){time[hand], leap_time(r, way_to(score, r, s, drum)), 2,
                                   s->early > 0 ? room : HUGE_VAL, trails && both};
    }
}

/// How much more than a step there is from the last stroke to what follows at `first` (s).
static double join_of(const roll_next next[HIMC_HANDS], double first, double step, int last)
{
    double extra = 0, calm = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const roll_next *n = &next[hand];
        int steps = hand == last ? 1 : n->trails ? 0 : 2;
        double has = n->time - first + steps * step;
        double wanted = fmin(n->room, n->calm * step);
        if (n->leap > 0)
            extra = fmax(extra, n->leap + UNEVENNESS * step - has);
        calm = fmax(calm, wanted - has);
    }
    extra = fmax(extra, fmin(calm, MOST_HELD_BACK * step));
    return extra < JOIN_GAIN ? 0 : extra; // of rounding
}

/// The nearest count of intervals to `n` with which that hand has the last stroke.
static double count_for(double n, const roll_grid *g, int last)
{
    int odd = (g->first + ((himc_hand)last == g->lead)) % 2;
    return fmax(2 * round(0.5 * (n - odd)) + odd, odd ? 1 : 2);
}

/// The end of a grid that begins so, in its place, with a last stroke of that hand; returns by how
/// much it ends before what follows (s).
static double end_with(roll_grid *g, const roll_next next[HIMC_HANDS], double first, double rate,
                       int last)
{
    double span = first - g->begin, extra = 0, n = count_for(rate * span, g, last);
    for (int i = 0; i < JOIN_ROUNDS; i++) {
        g->step = (span - extra) / n;
        extra = fmin(join_of(next, first, g->step, last), MOST_JOIN * span);
        n = i ? n : count_for(rate * (span - extra), g, last);
    }
    g->step = (span - extra) / n;
    if (g->first > 0 && n > 2 && g->step * rate < 1 - ANCHOR_BEND) { // rather two strokes less
        n -= 2;
        g->step = (span - extra) / n;
    }
    g->count = g->first + (int)n;
    return extra;
}

/// How far the intervals are from those of its rate, as a share of the longer ones.
static double bend_of(const roll_grid *g, double rate)
{
    return fabs(log(g->step * rate));
}

/// How much less time than they want strokes of a list have after the touch of their hand before
/// them (intervals).
static double lack_of(const roll_grid *g, const roll_next next[HIMC_HANDS], double rate, int last)
{
    double lack = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        int number = g->count - (hand == last ? 1 : 2);
        double has = next[hand].time - g->begin - (number - g->first) * g->step;
        lack = fmax(lack, next[hand].calm - has * rate);
    }
    return lack;
}

static double rate_of(const planner_score *score, int i)
{
    const planner_roll *r = &score->roll[i];
    return is_pair(score, i) ? fmax(r->rate, r[1].rate) : r->rate;
}

/// The better of both ends of a grid: with the one or the other hand last.
static roll_grid ended(roll_grid g, const roll_next next[HIMC_HANDS], double first, double rate,
                       double *early)
{
    roll_grid end[HIMC_HANDS] = {g, g};
    double extra[HIMC_HANDS], bent[HIMC_HANDS], lack[HIMC_HANDS];
    for (int last = 0; last < HIMC_HANDS; last++) {
        extra[last] = end_with(&end[last], next, first, rate, (himc_hand)last);
        bent[last] = bend_of(&end[last], rate);
        lack[last] = lack_of(&end[last], next, rate, last);
    }
    double to_left = next[HIMC_LEFT].time, to_right = next[HIMC_RIGHT].time;
    double intervals = rate * (first - g.begin);
    bool nearer = bent[HIMC_RIGHT] < bent[HIMC_LEFT]; // to its rate, if the right hand is last
    bool anchored = g.first > 0;                      // goes on after a change of tempo
    bool too_bent = anchored && fmax(bent[HIMC_LEFT], bent[HIMC_RIGHT]) > ANCHOR_BEND, right;
    if (too_bent && fabs(lack[HIMC_LEFT] - lack[HIMC_RIGHT]) > ANCHOR_BEND)
        right = lack[HIMC_RIGHT] < lack[HIMC_LEFT];
    else if (too_bent || intervals < 1)
        right = nearer;
    else if (!(fabs(extra[HIMC_RIGHT] - extra[HIMC_LEFT]) < JOIN_GAIN))
        right = extra[HIMC_RIGHT] < extra[HIMC_LEFT]; // the earlier
    else if (to_left != to_right && fmin(to_left, to_right) < first + 1 / rate)
        right = to_left < to_right; // the hands take turns with what follows at once
    else
        right = intervals < SHORT_ROLL && nearer;
    *early = extra[right ? HIMC_RIGHT : HIMC_LEFT];
    return end[right ? HIMC_RIGHT : HIMC_LEFT];
}

/// The roll before one, maybe of the round before; -1 if there is none soon before it.
static int joined_before(const planner_score *score, int i, int in_round)
{
    double begin = himc_planner_score_seconds(score, score->roll[i].stroke.beat);
    int before = i - 1;
    if (before < 0 && has_begun(score, in_round)) {
        before = score->roll_count - 1;
        begin += himc_planner_score_round_length(score);
    }
    if (before < 0)
        return -1;
    before -= is_second(score, before);
    double end = himc_planner_score_seconds(score, himc_planner_roll_end(score, before));
    return begin > end + JOINED_TIME ? -1 : before;
}

/// Time from the last stroke of a hand's list before a roll (s).
static double listed_since(const planner_score *score, int i, int in_round, himc_hand hand)
{
    const planner_part *part = &score->part[hand];
    double beat = score->roll[i].stroke.beat, turned = 0;
    int at = himc_planner_part_after(part, beat, true);
    if (at == 0 && has_begun(score, in_round)) {
        at = part->count;
        turned = himc_planner_score_round_length(score);
    }
    return at == 0 ? HUGE_VAL
                   : turned + himc_planner_score_seconds(score, beat) -
                         himc_planner_score_seconds(score, part->list[at - 1].stroke.beat);
}

/// Whether a stroke of a roll at `own` leaves its hand too little time (s) to one of its list, or
/// that one to it: the written one is played.
static bool is_too_near(const planner_score *score, const planner_roll *r, double own,
                        const planner_stroke *listed, double turned)
{
    const himc_stroke *s = &listed->stroke;
    double leap = leap_time(r, way_to(score, r, s, listed->drum));
    double time = turned + himc_planner_score_seconds(score, s->beat) - s->early;
    return fabs(time - own) < fmax(PLANNER_LEAST_ROOM, leap);
}

static bool is_left_out(const planner_score *score, int i, int in_round, const himc_stroke *stroke)
{
    const planner_part *part = &score->part[stroke->hand];
    const planner_roll *r = roll_of(score, i, stroke->hand);
    int after = himc_planner_part_place(part, stroke), count = part->count;
    bool begun = has_begun(score, in_round), more = goes_on(score, in_round);
    double own = himc_planner_score_seconds(score, stroke->beat), turned = 0;
    if (count == 0)
        return false;
    if (begun || more)
        turned = himc_planner_score_round_length(score);
    bool wraps = after == 0, over = after == count; // the one before or after is of another round
    return ((!wraps || begun) &&
            is_too_near(score, r, own, &part->list[(wraps ? count : after) - 1],
                        wraps ? -turned : 0)) ||
           ((!over || more) &&
            is_too_near(score, r, own, &part->list[over ? 0 : after], over ? turned : 0));
}

/// The right hand begins, but not where a roll goes on from there on a drum to the left, nor where
/// only with the other one a short roll comes to the stroke after it at its rate.
static himc_hand usual_lead(const planner_score *score, int i, int in_round)
{
    const planner_roll *r = &score->roll[i];
    int before = joined_before(score, i, in_round);
    if (before >= 0) {
        himc_vec3 way = way_to(score, roll_of(score, before, HIMC_RIGHT), &r->stroke, r->drum);
        return crosses(HIMC_RIGHT, way) ? HIMC_LEFT : HIMC_RIGHT;
    }
    double rate = rate_of(score, i), begin = himc_planner_score_seconds(score, r->stroke.beat),
           first = himc_planner_score_seconds(score, himc_planner_roll_end(score, i)), early,
           other_early;
    if (rate * (first - begin) >= SHORT_ROLL ||
        listed_since(score, i, in_round, HIMC_LEFT) < 2 / rate)
        return HIMC_RIGHT;
    roll_next next[HIMC_HANDS] = {{.time = HUGE_VAL}, {.time = HUGE_VAL}};
    listed_next(score, i, in_round, next);
    first = fmin(first, fmin(next[HIMC_LEFT].time, next[HIMC_RIGHT].time));
    if (!(first > begin))
        return HIMC_RIGHT;
    roll_grid g = ended((roll_grid){.lead = HIMC_RIGHT, .begin = begin}, next, first, rate, &early),
              h = ended((roll_grid){.lead = HIMC_LEFT, .begin = begin}, next, first, rate,
                        &other_early);
    bool better = bend_of(&h, rate) < bend_of(&g, rate) - RATE_GAIN;
    return better && other_early < early + JOIN_GAIN ? HIMC_LEFT : HIMC_RIGHT;
}

/// The same; but the other one where that one has a stroke too near, so that it begins on its beat.
static himc_hand lead_of(const planner_score *score, int i, int in_round)
{
    himc_stroke first[HIMC_HANDS] = {score->roll[i].stroke, score->roll[i].stroke};
    himc_hand lead = usual_lead(score, i, in_round), other = himc_other_hand(lead);
    first[lead].hand = lead;
    first[other].hand = other;
    return is_left_out(score, i, in_round, &first[lead]) &&
                   !is_left_out(score, i, in_round, &first[other])
               ? other
               : lead;
}

/// The same as listed_next of the next roll.
static void rolled_next(const planner_score *score, int i, int in_round, roll_next next[HIMC_HANDS])
{
    int after = roll_after(score, i);
    double turned = 0;
    if (after >= score->roll_count && goes_on(score, in_round)) {
        after = 0;
        in_round++;
        turned = himc_planner_score_round_length(score);
    }
    if (after >= score->roll_count)
        return;
    double first = turned + himc_planner_score_seconds(score, score->roll[after].stroke.beat),
           latest =
               himc_planner_score_seconds(score, himc_planner_roll_end(score, i)) + JOINED_TIME;
    himc_hand lead = lead_of(score, after, in_round);
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_roll *from = roll_of(score, i, (himc_hand)hand),
                           *to = roll_of(score, after, (himc_hand)hand);
        double time = first + ((himc_hand)hand == lead ? 0 : LEAST_STEP / to->rate);
        if (time <= latest && time < next[hand].time)
            next[hand] = (roll_next){
                .time = time, .leap = leap_time(from, way_to(score, from, &to->stroke, to->drum))};
    }
}

static roll_grid grid_of(const planner_score *score, int i, int in_round)
{
    const planner_anchor *a = &score->anchor;
    double first = himc_planner_score_seconds(score, himc_planner_roll_end(score, i)), early;
    roll_grid g = {.begin = himc_planner_score_seconds(score, score->roll[i].stroke.beat),
                   .step = 1};
    roll_next next[HIMC_HANDS] = {{.time = HUGE_VAL}, {.time = HUGE_VAL}};
    bool anchored = a->any && a->roll == i && a->round == in_round;
    if (is_second(score, i))
        return g;
    if (anchored)
        g = (roll_grid){a->lead, a->number, a->time, 1, a->number + 1};
    else
        g.lead = lead_of(score, i, in_round);
    listed_next(score, i, in_round, next);
    rolled_next(score, i, in_round, next);
    first = fmin(first, fmin(next[HIMC_LEFT].time, next[HIMC_RIGHT].time));
    return first > g.begin ? ended(g, next, first, rate_of(score, i), &early) : g;
}

static himc_hand hand_of(const roll_grid *g, int number)
{
    return number % 2 ? himc_other_hand(g->lead) : g->lead;
}

/// The first number of a hand from that one on.
static int own_number(const roll_grid *g, himc_hand hand, int number)
{
    return hand == HIMC_HAND_ANY || hand_of(g, number) == hand ? number : number + 1;
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
    himc_hand hand = hand_of(g, number);
    const himc_stroke *roll = &roll_of(score, i, hand)->stroke;
    himc_stroke s = *roll;
    double share = g->count > 1 ? (double)number / (g->count - 1) : 0;
    s.hand = hand;
    s.beat = beat_of(score, i, g, number);
    if (g->first > 0) // numbers are no longer even over the roll
        share = (s.beat - roll->beat) / (beat_of(score, i, g, g->count - 1) - roll->beat);
    share = fmin(fmax(share, 0), 1); // an anchored roll may begin late, or have one stroke left
    s.dynamic = roll->dynamic + share * (roll->last_dynamic - roll->dynamic);
    s.bounce_time = bounce_time(g, number, s.bounces);
    return s;
}

int himc_planner_roll_left_out(const planner_score *score, int i)
{
    roll_grid g = grid_of(score, i, NO_ROUND);
    int out = 0;
    for (int k = 0; k < g.count; k++) {
        himc_stroke s = stroke_at(score, i, &g, k);
        out += is_left_out(score, i, NO_ROUND, &s);
    }
    return out;
}

int himc_planner_roll_insert(planner_score *score, const himc_stroke *stroke, int drum, double rate,
                             himc_error *error)
{
    int at = score->roll_count;
    if (at == MOST_ROLLS) {
        himc_error_set(error, "roll: one too many, expected %d", MOST_ROLLS);
        return -1;
    }
    if (!himc_array_grow(&score->roll, at, &score->roll_room, sizeof *score->roll, error))
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
    for (int i = 0; i < a->roll_count && same; i++)
        same = a->roll[i].drum == b->roll[i].drum && a->roll[i].rate == b->roll[i].rate &&
               himc_planner_score_same(&a->roll[i].stroke, &b->roll[i].stroke);
    return same;
}

bool himc_planner_roll_due(const planner_score *score, himc_hand hand, planner_place *at,
                           planner_due *due)
{
    // in a loop where all are left out there is none
    for (int rounds = 0; rounds < 3; rounds++, at->roll = 0, at->round++) {
        if (!score->loop && at->round > score->rounds)
            return false;
        for (; at->roll < score->roll_count; at->roll++, at->number = 0) {
            roll_grid g = grid_of(score, at->roll, at->round);
            at->number = own_number(&g, hand, at->number);
            for (; at->number < g.count; at->number += 2) {
                due->stroke = stroke_at(score, at->roll, &g, at->number);
                if (!himc_planner_loop_has(score, at->round, due->stroke.beat) ||
                    is_left_out(score, at->roll, at->round, &due->stroke))
                    continue;
                due->drum = himc_planner_roll_drum(score, at->roll, due->stroke.hand);
                due->place = *at;
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
    planner_place *at = &score->part[hand].rolls;
    for (int i = 0; i < score->roll_count; i++) {
        roll_grid g = grid_of(score, i, in_round);
        int number = own_number(&g, hand, number_after(&g, t));
        *at = (planner_place){i, number, in_round};
        if (number < g.count)
            return;
    }
    *at = (planner_place){score->roll_count, 0, in_round};
}

bool himc_planner_roll_anchor(planner_score *score, double t)
{
    planner_place *left = &score->part[HIMC_LEFT].rolls, *right = &score->part[HIMC_RIGHT].rolls;
    bool ahead =
        left->round != right->round ? left->round > right->round : left->roll > right->roll;
    planner_place at = ahead ? *right : *left;
    if (at.roll >= score->roll_count)
        return false;
    roll_grid g = grid_of(score, at.roll, at.round);
    int planned = -1; // the last one
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_place *own = &score->part[hand].rolls;
        bool within = own->roll == at.roll && own->round == at.round;
        int next = own_number(&g, (himc_hand)hand, within ? own->number : g.count);
        planned = next - 2 > planned ? next - 2 : planned;
    }
    t += TIME_ROUNDING - score->origin;
    t -= at.round ? at.round * himc_planner_score_round_length(score) : 0;
    bool early = planned >= g.first && time_of(&g, planned) > t;
    if (early) {
        planned = number_after(&g, t) - 1;
        if (g.first > 0 && planned < g.first)
            planned = g.first;
        for (int hand = 0; hand < HIMC_HANDS; hand++) { // those after it are to be played again
            at.number = own_number(&g, (himc_hand)hand, planned + 1);
            if (at.number < g.count)
                score->part[hand].rolls = at;
        }
    }
    if (planned < 0)
        return early;
    score->anchor = (planner_anchor){.any = true,
                                     .lead = g.lead,
                                     .roll = at.roll,
                                     .round = at.round,
                                     .number = planned,
                                     .time = g.begin + (planned - g.first) * g.step};
    return early;
}

double himc_planner_roll_last_beat(const planner_score *score)
{
    double beat = -1;
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        const planner_part *part = &score->part[hand];
        if (part->count > 0)
            beat = fmax(beat, part->list[part->count - 1].stroke.beat);
    }
    for (int i = score->roll_count - 1; i >= 0; i--) {
        roll_grid g = grid_of(score, i, NO_ROUND);
        if (g.count > 0)
            return fmax(beat, beat_of(score, i, &g, g.count - 1));
    }
    return beat;
}

double himc_planner_score_length(const planner_score *score)
{
    return fmax(floor(himc_planner_roll_last_beat(score)) + 1, ceil(score->until));
}

double himc_planner_loop_end(const planner_score *score)
{
    return isfinite(score->to) ? score->to : himc_planner_score_length(score);
}

double himc_planner_score_round_length(const planner_score *score)
{
    return himc_planner_score_seconds(score, himc_planner_loop_end(score)) -
           himc_planner_score_seconds(score, score->from);
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

double himc_planner_roll_since(const planner_score *score, double beat)
{
    double before, after;
    int begun = last_begun(score, beat - BEAT_ROUNDING);
    himc_planner_roll_near(score, HIMC_HAND_ANY, NO_ROUND, beat, &before, &after);
    bool over = begun >= 0 && himc_planner_roll_end(score, begun) <= beat + END_ROUNDING;
    return over ? fmin(before, score->roll[begun].stroke.beat) : before;
}

bool himc_planner_roll_same_places(const planner_score *a, const planner_score *b)
{
    bool same = a->roll_count == b->roll_count;
    for (int i = 0; i < a->roll_count && same; i++) {
        roll_grid g = grid_of(a, i, NO_ROUND), h = grid_of(b, i, NO_ROUND);
        same = g.count == h.count && g.begin == h.begin && g.step == h.step;
    }
    return same;
}

void himc_planner_roll_near(const planner_score *score, himc_hand hand, int in_round, double beat,
                            double *before, double *after)
{
    int begun = last_begun(score, beat), first = begun > 1 ? begun - 2 : 0;
    *before = -HUGE_VAL, *after = HUGE_VAL;
    for (int i = first; i < score->roll_count && i <= begun + 1; i++) {
        roll_grid g = grid_of(score, i, in_round);
        int at = number_after(&g, himc_planner_score_seconds(score, beat)),
            from = at < 4 ? 0 : at - 4;
        for (int k = own_number(&g, hand, from); k < g.count && k < at + 4;
             k += hand == HIMC_HAND_ANY ? 1 : 2) {
            double own = beat_of(score, i, &g, k);
            if (own < beat - BEAT_ROUNDING)
                *before = fmax(*before, own);
            else if (own > beat + BEAT_ROUNDING)
                *after = fmin(*after, own);
        }
    }
}

planner_place himc_planner_roll_walk(const planner_score *score, int in_round, double beat)
{
    planner_place at = {last_begun(score, beat), 0, in_round};
    if (at.roll < 0)
        return at;
    at.roll -= is_second(score, at.roll);
    roll_grid g = grid_of(score, at.roll, in_round);
    at.number = number_after(&g, himc_planner_score_seconds(score, beat));
    if (at.number < g.count && beat_of(score, at.roll, &g, at.number) <= beat) // of rounding
        at.number++;
    return at;
}

bool himc_planner_roll_back(const planner_score *score, planner_place *at, double *beat,
                            himc_hand *hand)
{
    for (; at->roll >= 0; at->roll--, at->number = INT_MAX) {
        roll_grid g = grid_of(score, at->roll, at->round);
        if (at->number > g.count)
            at->number = g.count;
        if (at->number == 0)
            continue;
        *beat = beat_of(score, at->roll, &g, at->number - 1);
        *hand = hand_of(&g, at->number - 1);
        return true;
    }
    return false;
}
