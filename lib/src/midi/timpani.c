/// timpani.c: which of four timpani plays a note, and when its pedal moves.
///
/// A search over the notes in time: its state is the pitch of each drum, when it can be retuned,
/// and when the foot is free; a note in tune costs nothing, a change 1 and 0.1 a semitone, a note
/// left out more than any change. Only the WIDTH best states of different pitches are kept after
/// each note; on parts of usual length these hold the best way. A drum is retuned when it rings no
/// more (1 s after its stroke) or a hand has damped it at the end of its note. The first pitch of a
/// drum is free: it is tuned so before the piece. Ranges: of the usual four sizes, widened by what
/// heads bear; costs and times are chosen, no measurement of players was found.
#include "midi/part.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DRUMS 4
#define WIDTH 64
#define LOWEST 36  // C2
#define HIGHEST 59 // B3
#define CHANGE_COST 1.0
#define SEMITONE_COST 0.1
#define DRUM_COST 0.5     // of the first note of a drum: no more drums than the piece needs
#define MIDDLE_COST 0.001 // a semitone from the middle of the range: of equal ways the natural one
#define MOST_OUTSIDE 4    // semitones past its usual range that a drum may be tuned to ...
#define OUTSIDE_COST 0.02 // ... for this on each note: slack or overstretched heads sound poorer
#define OMIT_COST 30.0
#define RING_TIME 1.0      // after a stroke an undamped drum may be retuned (s)
#define DAMP_TIME 0.2      // after the end of its note a damped one may be (s)
#define PEDAL_TIME 0.15    // a change takes this (s) ...
#define SEMITONE_TIME 0.05 // ... and this a semitone ...
#define LONGEST_PEDAL 0.6  // ... and no more
#define MOST_PEDALS 2000   // chosen: an hour of a busy foot, and a score has room for them
#define FOOT_TIME 0.3      // from one pedal to the next (s)
#define DAMPED_SHARE 0.7 // a note that ends before this share of the time to the next is damped ...
#define LEAST_DAMPED 0.3 // ... if the drum then rests so long (s) ...
#define FREE_HAND 0.2    // ... and the hands so (s)

/// From low on the left to high on the right, as in an orchestra; 23 to 32 inches.
static const struct {
    midi_head head;
    int low, high;
} timpano[DRUMS] = {
    {{"low", 32, .251, .843, .85, .406, -1}, 36, 45},
    {{"second", 29, .832, .287, .85, .368, -1}, 41, 50},
    {{"third", 26, .763, -.439, .85, .330, -1}, 45, 54},
    {{"high", 23, .251, -.843, .85, .292, -1}, 50, 59},
};

static int max(int a, int b)
{
    return a > b ? a : b;
}

/// The drums after a note.
typedef struct state {
    double cost;
    int8_t key[DRUMS];    ///< -1: not tuned yet
    double ready[DRUMS];  ///< may be retuned from then on (s)
    double struck[DRUMS]; ///< last (s)
    double foot;          ///< is free from then on (s)
    int32_t from;         ///< the state before, of the note before
    int8_t drum;          ///< of the note, -1: left out
    double pedal;         ///< begins (s); infinite if it does not move
} state;

/// What is remembered of each state to walk back.
typedef struct step {
    int8_t from, drum;
    float pedal; ///< how long before the note it begins (s); 0: it does not move
} step;

static double pedal_time(int semitones)
{
    return fmin(PEDAL_TIME + SEMITONE_TIME * abs(semitones), LONGEST_PEDAL);
}

// the state after the note on that drum; false if the drum cannot play it
static bool play(const state *before, int from, const midi_stroke *s, int drum, state *after)
{
    double at = s->note->seconds;
    int key = before->key[drum], way = abs(s->key - key);
    int outside = max(timpano[drum].low - s->key, s->key - timpano[drum].high);
    if (outside > MOST_OUTSIDE)
        return false;
    *after = *before;
    after->from = from;
    after->drum = (int8_t)drum;
    after->pedal = HUGE_VAL;
    after->cost += MIDDLE_COST * fabs(s->key - 0.5 * (timpano[drum].low + timpano[drum].high)) +
                   OUTSIDE_COST * max(outside, 0);
    after->cost += key < 0 ? DRUM_COST : 0;
    if (key >= 0 && way > 0) {
        after->pedal = fmax(before->ready[drum], before->foot);
        if (after->pedal + pedal_time(way) > at)
            return false;
        after->foot = after->pedal + pedal_time(way) + FOOT_TIME;
        after->cost += CHANGE_COST + SEMITONE_COST * way;
    }
    after->key[drum] = (int8_t)s->key;
    after->struck[drum] = at;
    after->ready[drum] = fmin(at + RING_TIME, s->end + DAMP_TIME);
    return true;
}

// among the `count` best so far; one of each set of pitches
static int keep(state *best, int count, const state *made)
{
    int worst = 0;
    for (int i = 0; i < count; i++) {
        if (memcmp(best[i].key, made->key, sizeof made->key) == 0) {
            if (made->cost < best[i].cost)
                best[i] = *made;
            return count;
        }
        worst = best[i].cost > best[worst].cost ? i : worst;
    }
    if (count < WIDTH) {
        best[count] = *made;
        return count + 1;
    }
    if (made->cost < best[worst].cost)
        best[worst] = *made;
    return count;
}

static int advance(const state *now, int count, const midi_stroke *s, state *next)
{
    int kept = 0;
    state made;
    for (int i = 0; i < count; i++) {
        for (int drum = 0; drum < DRUMS; drum++)
            if (play(&now[i], i, s, drum, &made))
                kept = keep(next, kept, &made);
        made = now[i];
        made.cost += OMIT_COST;
        made.from = i;
        made.drum = -1;
        made.pedal = HUGE_VAL;
        kept = keep(next, kept, &made);
    }
    return kept;
}

static void move_by_octaves(midi_part *part)
{
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        while (s->key < LOWEST)
            s->key += 12;
        while (s->key > HIGHEST)
            s->key -= 12;
        part->moved += s->key != s->note->key;
    }
}

// the strokes that are still to be played get their drums; the last state's way is walked back
static void walk_back(midi_part *part, const step *steps, int state_index)
{
    for (int i = part->count - 1; i >= 0; i--) {
        midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED)
            continue;
        const step *at = &steps[(size_t)i * WIDTH + (size_t)state_index];
        state_index = at->from;
        s->head = at->drum;
        if (at->drum < 0)
            s->fate = MIDI_NO_DRUM;
        if (at->pedal > 0)
            part->pedal[part->pedals++] = (midi_pedal){
                .seconds = s->note->seconds - (double)at->pedal, .head = at->drum, .to = s->key};
    }
}

// the pedals in the order of time, with the pitch from which each comes
static void order_pedals(midi_part *part)
{
    for (int i = 0, j = part->pedals - 1; i < j; i++, j--) {
        midi_pedal swapped = part->pedal[i];
        part->pedal[i] = part->pedal[j];
        part->pedal[j] = swapped;
    }
    int key[DRUMS] = {-1, -1, -1, -1}, pedal = 0;
    for (int i = 0; i < part->count; i++) {
        midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED)
            continue;
        if (key[s->head] < 0)
            part->head[s->head].key = s->key;
        else if (key[s->head] != s->key && pedal == MOST_PEDALS) {
            s->fate = MIDI_NO_DRUM;
            continue;
        } else if (key[s->head] != s->key) {
            midi_pedal *p = &part->pedal[pedal++];
            p->from = key[s->head];
            p->length = pedal_time(p->to - p->from);
        }
        key[s->head] = s->key;
    }
    part->pedals = pedal;
}

// a drum is damped where its note ends early, and before its pedal moves while it rings
static void find_damped(midi_part *part)
{
    double next[DRUMS] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL}, moves[DRUMS], any = HUGE_VAL;
    memcpy(moves, next, sizeof moves);
    int pedal = part->pedals;
    for (int i = part->count - 1; i >= 0; i--) {
        midi_stroke *s = &part->stroke[i];
        double at = s->note->seconds, off = s->end;
        if (s->fate != MIDI_PLAYED)
            continue;
        for (; pedal > 0 && part->pedal[pedal - 1].seconds >= at; pedal--)
            moves[part->pedal[pedal - 1].head] = part->pedal[pedal - 1].seconds;
        bool early = off - at < DAMPED_SHARE * (next[s->head] - at);
        bool time = next[s->head] - off > LEAST_DAMPED && any - off > FREE_HAND;
        s->damped = (early && time && isfinite(next[s->head])) || moves[s->head] < at + RING_TIME;
        next[s->head] = any = at;
        moves[s->head] = HUGE_VAL;
    }
}

static void search(midi_part *part, state *now, state *next, step *steps)
{
    int count = 1;
    now[0] = (state){.key = {-1, -1, -1, -1}};
    for (int i = 0; i < part->count; i++) {
        const midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED)
            continue;
        count = advance(now, count, s, next);
        for (int k = 0; k < count; k++)
            steps[(size_t)i * WIDTH + (size_t)k] =
                (step){(int8_t)next[k].from, next[k].drum,
                       isfinite(next[k].pedal) ? (float)(s->note->seconds - next[k].pedal) : 0};
        state *other = now;
        now = next;
        next = other;
    }
    int best = 0;
    for (int k = 1; k < count; k++)
        best = now[k].cost < now[best].cost ? k : best;
    walk_back(part, steps, best);
}

bool himc_midi_tune(midi_part *part, himc_error *error)
{
    state *states = malloc(2 * WIDTH * sizeof *states);
    step *steps = malloc(((size_t)part->count * WIDTH + 1) * sizeof *steps);
    part->pedal = malloc(((size_t)part->count + 1) * sizeof *part->pedal);
    bool good = states && steps && part->pedal;
    for (part->heads = 0; part->heads < DRUMS; part->heads++)
        part->head[part->heads] = timpano[part->heads].head;
    if (good) {
        move_by_octaves(part);
        himc_midi_join(part);
        search(part, states, states + WIDTH, steps);
        order_pedals(part);
        find_damped(part);
    }
    free(states);
    free(steps);
    return good || himc_error_set(error, "out of memory for %d notes", part->count);
}
