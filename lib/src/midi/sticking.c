/// sticking.c: which hand plays which stroke.
///
/// A beam search over the strokes in time. Its state is the last stroke of each hand; a stroke
/// costs its hand what plan/sticking.h says, with the time that the planner needs for its way, a
/// little more the left one, and more the hand that has just struck the same drum, or another bar
/// of its instrument: hand by hand, as players do also where one hand had the time. A stroke nearer
/// to its hand's last than the planner can leap (hand.c), or for which the arms would cross over
/// another drum at once, is not possible; one that is left out costs more than any that is played,
/// and the more the louder it is. A roll gives way to what follows it, down to a stroke of each
/// hand. Where a stroke is still left out, all is looked for again, and a short roll may be a
/// single stroke, so that the other hand is free.
#include "base/head_frame.h"
#include "midi/part.h"
#include "plan/hand.h"
#include "plan/sticking.h"

#include <stdlib.h>
#include <string.h>

// Choices behind the two hands: the stroke is left out; or a roll is one stroke, SINGLE + hand.
enum { OMIT = HIMC_HANDS, SINGLE, CHOICES = SINGLE + HIMC_HANDS };

#define NEED 2.0        // of the least time of a leap: what is quicker costs; chosen
#define WRITTEN 0.8     // of the time of a leap: who wrote the hand may know better; chosen
#define AGAIN_TIME 0.09 // the same on one spot (s)
#define AGAIN_BARS 0.5  // cost of the hand that struck the last bar; chosen: a line by turns
#define ACROSS 0.2      // arms cross over another drum if a hand is so far past the other (m) ...
#define OVER 0.1        // on another height it passes (m), ...
#define SMALL 0.25      // ... and over toms, which lie close together (radius, m)
#define ACROSS_COST 20.0
#define ACROSS_TIME 0.3 // ... and meet if that one has struck so shortly before (s)
#define SAME_TIME 1e-7  // (beats)
#define ROLL_STROKE 0.1 // from a roll's last stroke to its end (s)
#define LEAST_ROLL 0.1  // of a roll that gives way to a stroke within it (s), or its half; chosen
#define SHORT_ROLL 0.3  // what lasts longer is never one stroke (s); chosen: above each leap
#define MOST_CUTS 16    // strokes among which the parts of a roll are looked for; chosen
#define CUT_TIME 1e-3   // from one part of a roll to the next (s)
#define ONE_STROKE 24.0 // cost of that; more than a hurry's, and both less than leaving out
#define OTHER_HAND 30.0 // cost of a hand that is not the written one; less than of leaving out

/// A stroke of one hand.
typedef struct place {
    double at;      ///< (s); far in the past at first
    double x, y, z; ///< (m)
} place;

// true if a hand plays a roll, and not one stroke for it
static bool is_rolling(const midi_part *part, const midi_state *state, int hand)
{
    int stroke = state->key[hand];
    return stroke >= 0 && part->stroke[stroke].roll.length > 0 && !state->key[HIMC_HANDS + hand];
}

// of a stroke; -1: at first each hand is before its own side
static place place_of(const midi_part *part, int stroke, int hand, bool rolling)
{
    if (stroke < 0)
        return (place){-1e3, 0.5, hand == HIMC_LEFT ? 0.2 : -0.2, 1};
    const midi_head *head = &part->head[part->stroke[stroke].head];
    const midi_stroke *s = &part->stroke[stroke];
    double at = s->note->seconds;
    if (rolling) // its last stroke, about
        at = fmax(at, himc_midi_stroke_end(s) - ROLL_STROKE);
    const himc_head_frame frame = {
        .center = {head->x, head->y, head->z}, .tilt = head->tilt, .radius = head->radius};
    double x, y;
    himc_head_frame_spot(&frame, &(himc_stroke){.spot = s->spot, .hand = (himc_hand)hand}, &x, &y);
    himc_vec3 spot = himc_head_frame_to_world(&frame, x + s->x, y + s->y);
    return (place){at, spot.x, spot.y, spot.z};
}

// of two rolls together each hand plays one; the first has both until the second comes
static bool is_second(const midi_part *part, const midi_state *state, int stroke)
{
    int first = state->key[HIMC_LEFT];
    if (first != state->key[HIMC_RIGHT] || !is_rolling(part, state, HIMC_LEFT))
        return false;
    const midi_stroke *a = &part->stroke[first], *b = &part->stroke[stroke];
    return fabs(a->roll.length - b->roll.length) < SAME_TIME &&
           fabs(a->note->beat - b->note->beat) < SAME_TIME &&
           (a->head != b->head || strcmp(a->part, b->part) != 0);
}

// when a roll began, which may be cut where its dynamic bends (s)
static double roll_begin(const midi_part *part, int roll)
{
    const midi_stroke *s = &part->stroke[roll];
    double begin = s->note->seconds;
    for (int i = roll - 1; i >= 0 && i > roll - MOST_CUTS; i--) {
        const midi_stroke *before = &part->stroke[i];
        if (before->roll.length > 0 && before->head == s->head &&
            fabs(himc_midi_stroke_end(before) - begin) < CUT_TIME)
            begin = before->note->seconds;
    }
    return begin;
}

// When a hand may leave a roll for a stroke at time `at` (s): for one at its end or later from the
// roll's beginning on, since a stroke of each hand is enough; for one within it later.
static double leaves_roll(const midi_part *part, int roll, double at)
{
    double begin = roll_begin(part, roll), end = himc_midi_stroke_end(&part->stroke[roll]);
    return at > end - CUT_TIME ? begin : begin + fmin(0.5 * (end - begin), LEAST_ROLL);
}

// a short roll of a note that has no other parts
static bool can_be_single(const midi_part *part, int stroke)
{
    const midi_stroke *s = &part->stroke[stroke], *next = s + 1, *end = part->stroke + part->count;
    bool whole = s->note->way.length > 0 && !s->note->way.extra &&
                 s->roll.end - s->note->seconds < SHORT_ROLL;
    for (; whole && next < end && next->note->seconds < s->roll.end + CUT_TIME; next++)
        whole = !(next->note->way.extra && next->roll.length > 0 && next->head == s->head);
    return whole;
}

// the state's keys are the index of each hand's last stroke, and 1 if that is a roll's single one
static bool choose(const midi_part *part, int stroke, int choice, midi_state *state)
{
    const double omit = 45, omit_loud = 20; // costs of a stroke left out: of any, more of fff
    if (choice == OMIT) {
        state->cost += omit + omit_loud * part->stroke[stroke].dynamic;
        return true;
    }
    bool single = choice >= SINGLE;
    if (single && !can_be_single(part, stroke))
        return false;
    int hand = choice % SINGLE;
    bool rolling = is_rolling(part, state, hand);
    place to = place_of(part, stroke, hand, false),
          from = place_of(part, state->key[hand], hand, rolling),
          other = place_of(part, state->key[1 - hand], 1 - hand, is_rolling(part, state, 1 - hand));
    if (!single && is_second(part, state, stroke)) {
        state->key[hand] = stroke;
        return (hand == HIMC_LEFT) == (to.y > from.y);
    }
    himc_sticking s = {.gap = to.at - from.at,
                       .waits = true, // its way is counted here
                       .way = hypot(to.x - from.x, to.y - from.y),
                       .inwards = hand == HIMC_LEFT ? other.y - to.y : to.y - other.y,
                       .other_gap = to.at - other.at};
    s.same_spot = s.way == 0;
    double leap = himc_hand_leap_time(s.way), need = s.same_spot ? AGAIN_TIME : NEED * leap;
    // a roll is left earlier for what follows: its strokes too near to that are left out
    const midi_stroke *before = state->key[hand] < 0 ? NULL : &part->stroke[state->key[hand]];
    if (rolling)
        s.gap = fmax(s.gap, fmin(to.at - leaves_roll(part, state->key[hand], to.at),
                                 s.same_spot ? AGAIN_TIME : leap));
    // on one spot 0.055 s, as the planner refuses 0.04 s
    int written = part->stroke[stroke].note->way.hand;
    if (s.gap < (s.same_spot ? 0.055 : written == 1 + hand ? WRITTEN * leap : leap))
        return false;
    bool across = s.inwards > ACROSS && fabs(to.z - other.z) < OVER &&
                  part->head[part->stroke[stroke].head].radius > SMALL && written != 1 + hand;
    if (across && s.other_gap < ACROSS_TIME)
        return false;
    state->cost += himc_sticking_cost(&s) + (hand == HIMC_LEFT ? 0.02 : 0) +
                   40 * fmax(0, need - s.gap) / need + pow(0.3 * need / s.gap, 2) +
                   (across ? ACROSS_COST : 0);
    bool bars = before && before->part[0] && before->head == part->stroke[stroke].head;
    if (bars && s.way > 0 && s.gap < s.other_gap && s.gap < HIMC_STICKING_ANEW)
        state->cost += AGAIN_BARS;
    state->cost += (written > 0 && written != 1 + hand ? OTHER_HAND : 0) + ONE_STROKE * single;
    state->key[hand] = stroke;
    state->key[HIMC_HANDS + hand] = single;
    if (part->stroke[stroke].roll.length > 0 && !single) {
        state->key[1 - hand] = stroke;
        state->key[HIMC_HANDS + 1 - hand] = false;
    }
    return true;
}

static bool has_hand(const midi_stroke *s)
{
    return s->fate == MIDI_PLAYED && s->choice != MIDI_DRUMS && !s->foot && !s->in_roll;
}

// of a chord of three and more pitches, of one dynamic, two hands play the outer ones
static void leave_inner(midi_part *part)
{
    for (int first = 0, next; first < part->count; first = next) {
        const midi_stroke *s = &part->stroke[first];
        int low = 1000, high = 0;
        double dynamic = -1;
        bool alike = true;
        for (next = first;
             next < part->count && fabs(part->stroke[next].note->beat - s->note->beat) < SAME_TIME;
             next++) {
            const midi_stroke *n = &part->stroke[next];
            if (!has_hand(n))
                continue;
            low = n->key < low ? n->key : low;
            high = n->key > high ? n->key : high;
            dynamic = dynamic < 0 ? n->dynamic : dynamic;
            alike &= fabs(n->dynamic - dynamic) < 0.01;
        }
        for (int i = first; i < next && alike; i++) {
            midi_stroke *n = &part->stroke[i];
            if (has_hand(n) && n->key != low && n->key != high)
                n->fate = MIDI_NO_HAND;
        }
    }
}

bool himc_midi_stick(midi_part *part, himc_error *error)
{
    const midi_state first = {.key = {-1, -1}};
    leave_inner(part);
    int8_t *hand = calloc((size_t)part->count + 1, 1);
    bool good = hand && himc_midi_search(part, &first, OMIT + 1, choose, hand);
    if (good && memchr(hand, OMIT, (size_t)part->count)) // rather one stroke than a note lost
        good = himc_midi_search(part, &first, CHOICES, choose, hand);
    for (int i = 0; good && i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        if (s->foot)
            s->hand = HIMC_FOOT;
        if (s->fate != MIDI_PLAYED || s->foot || s->in_roll)
            continue;
        if (hand[i] == OMIT)
            s->fate = MIDI_NO_HAND;
        else
            s->hand = (himc_hand)(hand[i] % SINGLE);
        if (hand[i] >= SINGLE)
            s->roll = (midi_roll){0};
    }
    free(hand);
    return good || himc_error_set(error, "out of memory for %d strokes", part->count);
}
