/// timpani.c: which of four timpani plays a note, and when its pedal moves.
///
/// A beam search over the notes in time: its state is the pitch of each drum, when it can be
/// retuned, and when the foot is free; a note in tune costs nothing, a change 1 and 0.1 a semitone,
/// a note left out more than any change. A drum is retuned when it rings no more (1 s after its
/// stroke) or a hand has damped it at the end of its note. The first pitch of a drum is free: it is
/// tuned so before the piece. Ranges: of the usual four sizes, widened by what heads bear; costs
/// and times are chosen, no measurement of players was found.
#include "midi/part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DRUMS MIDI_KEYS
#define SAME_TIME 0.01     // (s) as himc_midi_join
#define RING_TIME 1.0      // after a stroke an undamped drum may be retuned (s)
#define OTHER_DRUM 20.0    // cost of a drum that is not the written one; chosen
#define FASTEST_PEDAL 0.05 // (s) chosen
#define MOST_PEDALS 2000   // chosen: an hour of a busy foot, and a score has room for them

/// From low on the left to high on the right, as in an orchestra; 23 to 32 inches.
static const struct {
    midi_head head;
    int low, high;
} timpano[DRUMS] = {
    {{.name = "low", .inches = 32, .x = .251, .y = .843, .z = .85, .radius = .406, .key = -1},
     36,
     45},
    {{.name = "second", .inches = 29, .x = .832, .y = .287, .z = .85, .radius = .368, .key = -1},
     41,
     50},
    {{.name = "third", .inches = 26, .x = .763, .y = -.439, .z = .85, .radius = .330, .key = -1},
     45,
     54},
    {{.name = "high", .inches = 23, .x = .251, .y = -.843, .z = .85, .radius = .292, .key = -1},
     50,
     59},
};

enum { OMIT = DRUMS };

// of a change by so many semitones (s)
static double pedal_time(int semitones)
{
    return fmin(0.15 + 0.05 * abs(semitones), 0.6);
}

// when a drum's pedal can move (s)
static double pedal_free(const midi_state *state, int drum)
{
    return fmax(state->ready[drum], state->foot);
}

// when it begins to, if it takes `time` and is to be there `by` then: at the end of the drum's
// note, or earlier for want of time (s)
static double pedal_begin(const midi_state *state, int drum, double time, double by)
{
    return fmax(pedal_free(state, drum), fmin(state->sounds[drum], by - time));
}

// the pitch of a class (of key `pitch`) nearest to `key` that a drum has; -1: none
static int nearest_pitch(int drum, int key, int pitch)
{
    int best = -1;
    for (int k = timpano[drum].low; k <= timpano[drum].high; k++)
        if (k % 12 == pitch % 12 && (best < 0 || abs(k - key) < abs(best - key)))
            best = k;
    return best;
}

// the drum that an order to tune is for, and its new pitch; -1: none
static int find_ordered(const midi_state *state, const midi_order *o, int *key)
{
    int best = -1, least = 0, from = o->from % 128, named = o->from / 128;
    bool octaves = from >= 24 && o->value >= 24;
    for (int d = 0; d < DRUMS; d++) {
        int now = state->key[d];
        int to = now < 0 ? -1 : octaves ? now + o->value - from : nearest_pitch(d, now, o->value);
        if (to < timpano[d].low - 12 || to > timpano[d].high + 12 ||
            (from != 12 && now % 12 != from % 12))
            continue;
        // rather in the octave, and rather the drum that is written, than the shortest way
        int way = abs(to - now) + (from >= 24 && now != from ? 24 : 0) +
                  (named > 0 && named != d + 1 ? 48 : 0);
        if (best < 0 || way < least) {
            best = d;
            least = way;
            *key = to;
        }
    }
    return best;
}

// the orders between one stroke that is played and the next; returns how many are before the last
static int share_orders(midi_part *part)
{
    int next = 0;
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED)
            continue;
        s->order = next;
        // a gliss goes on after a stroke on its beat
        for (const midi_order *o = part->file->orders; next < part->file->order_count; next++)
            if (o[next].seconds > s->note->seconds + (o[next].glides ? -1e-6 : 1e-6))
                break;
        s->orders = next - s->order;
    }
    return next;
}

// drums are tuned as the orders up to a stroke say, if there is time until then (s), or as a gliss
// goes on; `record` (or NULL) gets the pedals
static void follow_orders(const midi_part *part, int first, int count, double until,
                          midi_state *state, midi_part *record)
{
    for (int i = first; i < first + count; i++) {
        const midi_order *o = &part->file->orders[i];
        int key = 0;
        if (o->kind != MIDI_TUNING || o->choice > MIDI_TIMPANI)
            continue;
        int drum = find_ordered(state, o, &key);
        if (drum >= 0 && key == state->key[drum])
            continue; // it has that pitch
        double begin = o->seconds, end = begin;
        double time = drum < 0 ? 0 : o->length > 0 ? o->length : pedal_time(key - state->key[drum]);
        // a drum that is named moves while it rings, and as fast as it has to
        if (drum >= 0 && o->from % 128 == 12)
            begin = fmax(begin, pedal_begin(state, drum, time, until));
        else if (drum >= 0 && !o->glides)
            begin = fmax(begin, fmin(state->sounds[drum], until - time));
        if (drum >= 0 && !o->glides && begin + time > until) // the word stands at the note
            begin = fmax(fmin(begin, until - time), pedal_free(state, drum));
        end = begin + time;
        if (o->from % 128 != 12 && !o->glides && begin + FASTEST_PEDAL <= until)
            end = fmin(end, until);
        if (drum < 0 || (end > until && !o->glides)) {
            if (record)
                record->untuned++;
            continue;
        }
        if (record && record->pedals < MOST_PEDALS && key != state->key[drum])
            record->pedal[record->pedals++] =
                (midi_pedal){begin, end - begin, drum, state->key[drum], key, o->glides};
        state->key[drum] = key;
        state->foot = end + 0.3;
        if (o->glides) {
            state->glides = drum;
            state->arrives = end;
        }
    }
}

// a state's key is the pitch of each drum (MIDI keys, -1: not tuned yet), which may be retuned when
// it is `ready`; false if the drum cannot play the note
static bool choose(const midi_part *part, int stroke, int drum, midi_state *state)
{
    const midi_stroke *s = &part->stroke[stroke];
    follow_orders(part, s->order, s->orders, s->note->seconds, state, NULL);
    if (drum == OMIT) {
        state->cost += 30;
        return true;
    }
    int written = s->note->way.drum;
    state->cost += written > 0 && written != drum + 1 ? OTHER_DRUM : 0; // less than to leave it out
    double at = s->note->seconds;
    int key = state->key[drum], way = abs(s->key - key);
    bool arrived = fabs(state->arrives - at) < SAME_TIME && state->key[state->glides] == s->key;
    state->cost += arrived && drum != state->glides ? OTHER_DRUM : 0; // the note that ends a gliss
    int low = timpano[drum].low, high = timpano[drum].high;
    // semitones past the usual range: slack or overstretched heads sound poorer
    int outside = s->key < low ? low - s->key : s->key > high ? s->key - high : 0;
    if (outside > 4 && written != drum + 1)
        return false;
    // of equal ways the natural one: in the middle of the range
    state->cost += 0.001 * fabs(s->key - 0.5 * (low + high)) + 0.02 * outside;
    if (key < 0)
        state->cost += 0.5; // no more drums than the piece needs
    if (key >= 0 && way > 0) {
        double time = pedal_time(way), end = pedal_begin(state, drum, time, at) + time;
        if (end > at && written != drum + 1) // else it glides under the stroke
            return false;
        state->foot = end + 0.3; // s to the next pedal
        state->cost += 1 + 0.1 * way;
    }
    state->key[drum] = s->key;
    state->sounds[drum] = s->end + 0.2; // damped, 0.2 s after its note's end
    state->ready[drum] = fmin(himc_midi_stroke_end(s) + RING_TIME, state->sounds[drum]);
    return true;
}

// a drum is damped where its note ends early, and before its pedal moves while it rings
static void find_damped(midi_part *part)
{
    double next[DRUMS] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL}, moves[DRUMS];
    double now = HUGE_VAL, any = HUGE_VAL; // this stroke's time, and that of the next after it
    bool heard[DRUMS] = {false};           // a gliss
    memcpy(moves, next, sizeof moves);
    int pedal = part->pedals;
    for (int i = part->count - 1; i >= 0; i--) {
        midi_stroke *s = &part->stroke[i];
        double at = s->note->seconds, off = s->end;
        if (s->fate != MIDI_PLAYED)
            continue;
        if (at < now - SAME_TIME) {
            any = now;
            now = at;
        }
        for (; pedal > 0 && part->pedal[pedal - 1].seconds >= at; pedal--)
            if (part->pedal[pedal - 1].heard)
                heard[part->pedal[pedal - 1].head] = true;
            else
                moves[part->pedal[pedal - 1].head] = part->pedal[pedal - 1].seconds;
        bool early = off - at < 0.7 * (next[s->head] - at);
        bool time = next[s->head] - off > 0.3 && any - off > 0.2; // drum and hands rest so long (s)
        s->damped = (early && time && !heard[s->head] && isfinite(next[s->head])) ||
                    moves[s->head] < himc_midi_stroke_end(s) + RING_TIME;
        if (s->note->way.ring != 0)
            s->damped = s->note->way.ring < 0;
        next[s->head] = at;
        moves[s->head] = HUGE_VAL;
        heard[s->head] = false;
    }
}

bool himc_midi_tune(midi_part *part, himc_error *error)
{
    const int lowest = timpano[0].low, highest = timpano[DRUMS - 1].high; // C2, B3
    midi_state now = {.key = {-1, -1, -1, -1}};
    int8_t *drum = malloc((size_t)part->count + 1);
    part->pedal = malloc(MOST_PEDALS * sizeof *part->pedal);
    for (part->heads = 0; part->heads < DRUMS; part->heads++)
        part->head[part->heads] = timpano[part->heads].head;
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        while (s->key < lowest)
            s->key += 12;
        while (s->key > highest)
            s->key -= 12;
        part->moved += s->key != s->note->key;
    }
    himc_midi_join(part);
    const int done = share_orders(part);
    bool good = drum && part->pedal && himc_midi_search(part, &now, DRUMS + 1, choose, drum);
    for (int i = 0; good && i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED)
            continue;
        midi_state before = now;
        follow_orders(part, s->order, s->orders, s->note->seconds, &now, part);
        int from = drum[i] == OMIT ? -1 : now.key[drum[i]];
        bool pedal = from >= 0 && from != s->key;
        if (drum[i] == OMIT || (pedal && part->pedals == MOST_PEDALS)) {
            s->fate = MIDI_NO_DRUM;
            continue;
        }
        s->head = drum[i];
        if (from < 0)
            part->head[s->head].key = s->key;
        if (pedal) {
            double time = pedal_time(s->key - from);
            double begin = pedal_begin(&now, s->head, time, s->note->seconds);
            float early = (float)(s->note->seconds - begin);
            if ((double)early < time - 1e-4) // beyond rounding
                time = early = (float)FASTEST_PEDAL;
            part->pedal[part->pedals++] =
                (midi_pedal){s->note->seconds - (double)early, time, s->head, from, s->key, false};
        }
        now = before; // choose follows the orders again
        choose(part, i, s->head, &now);
    }
    if (good)
        follow_orders(part, done, part->file->order_count - done, INFINITY, &now, part);
    if (good)
        find_damped(part);
    free(drum);
    return good || himc_error_set(error, "out of memory for %d notes", part->count);
}
