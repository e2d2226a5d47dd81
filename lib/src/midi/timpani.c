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
#define WIDTH 64         // states kept; chosen
#define RING_TIME 1.0    // after a stroke an undamped drum may be retuned (s)
#define MOST_PEDALS 2000 // chosen: an hour of a busy foot, and a score has room for them

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

/// The drums after a note.
typedef struct state {
    double cost;
    int8_t key[DRUMS];   ///< -1: not tuned yet
    double ready[DRUMS]; ///< may be retuned from then on (s)
    double foot;         ///< is free from then on (s)
    int32_t from;        ///< the state before, of the note before
    int8_t drum;         ///< of the note, -1: left out
    double pedal;        ///< begins (s); infinite if it does not move
} state;

/// What is remembered of each state to walk back.
typedef struct step {
    int8_t from, drum;
    float pedal; ///< how long before the note it begins (s); 0: it does not move
} step;

// of a change by so many semitones (s)
static double pedal_time(int semitones)
{
    return fmin(0.15 + 0.05 * abs(semitones), 0.6);
}

// the state after the note on that drum; false if the drum cannot play it
static bool play(const state *before, int from, const midi_stroke *s, int drum, state *after)
{
    double at = s->note->seconds;
    int key = before->key[drum], way = abs(s->key - key);
    int low = timpano[drum].low, high = timpano[drum].high;
    // semitones past the usual range: slack or overstretched heads sound poorer
    int outside = s->key < low ? low - s->key : s->key > high ? s->key - high : 0;
    if (outside > 4)
        return false;
    *after = *before;
    after->from = from;
    after->drum = (int8_t)drum;
    after->pedal = HUGE_VAL;
    // of equal ways the natural one: in the middle of the range
    after->cost += 0.001 * fabs(s->key - 0.5 * (low + high)) + 0.02 * outside;
    if (key < 0)
        after->cost += 0.5; // no more drums than the piece needs
    if (key >= 0 && way > 0) {
        after->pedal = fmax(before->ready[drum], before->foot);
        if (after->pedal + pedal_time(way) > at)
            return false;
        after->foot = after->pedal + pedal_time(way) + 0.3; // s to the next pedal
        after->cost += 1 + 0.1 * way;
    }
    after->key[drum] = (int8_t)s->key;
    after->ready[drum] = fmin(at + RING_TIME, s->end + 0.2); // damped, 0.2 s after its note's end
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

// The states after each note that is played; returns the best after the last. Both arrays are of
// WIDTH states, `steps` of WIDTH for each note.
static int search(const midi_part *part, state *now, state *next, step *steps)
{
    int count = 1;
    now[0] = (state){.key = {-1, -1, -1, -1}};
    for (int k = 0; k < part->count; k++, steps += WIDTH) {
        const midi_stroke *s = &part->stroke[k];
        if (s->fate != MIDI_PLAYED)
            continue;
        int kept = 0;
        for (int i = 0; i < count; i++) {
            state made;
            for (int drum = 0; drum < DRUMS; drum++)
                if (play(&now[i], i, s, drum, &made))
                    kept = keep(next, kept, &made);
            made = now[i];
            made.cost += 30; // the note is left out
            made.from = i;
            made.drum = -1;
            made.pedal = HUGE_VAL;
            kept = keep(next, kept, &made);
        }
        for (int i = 0; i < kept; i++)
            steps[i] =
                (step){(int8_t)next[i].from, next[i].drum,
                       isfinite(next[i].pedal) ? (float)(s->note->seconds - next[i].pedal) : 0};
        state *other = now;
        now = next;
        next = other;
        count = kept;
    }
    int best = 0;
    for (int i = 1; i < count; i++)
        best = now[i].cost < now[best].cost ? i : best;
    return best;
}

// The strokes that are still to be played get their drums, and the part its pedals, in the order of
// time, with the pitch from which each comes; the way of the last state is walked back.
static void assign(midi_part *part, const step *steps, int state_index)
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
        bool early = off - at < 0.7 * (next[s->head] - at);
        bool time = next[s->head] - off > 0.3 && any - off > 0.2; // drum and hands rest so long (s)
        s->damped = (early && time && isfinite(next[s->head])) || moves[s->head] < at + RING_TIME;
        next[s->head] = any = at;
        moves[s->head] = HUGE_VAL;
    }
}

bool himc_midi_tune(midi_part *part, himc_error *error)
{
    const int lowest = timpano[0].low, highest = timpano[DRUMS - 1].high; // C2, B3
    state *states = malloc(2 * WIDTH * sizeof *states);
    step *steps = malloc(((size_t)part->count * WIDTH + 1) * sizeof *steps);
    part->pedal = malloc(((size_t)part->count + 1) * sizeof *part->pedal);
    bool good = states && steps && part->pedal;
    for (part->heads = 0; part->heads < DRUMS; part->heads++)
        part->head[part->heads] = timpano[part->heads].head;
    for (int i = 0; i < part->count && good; i++) {
        midi_stroke *s = &part->stroke[i];
        while (s->key < lowest)
            s->key += 12;
        while (s->key > highest)
            s->key -= 12;
        part->moved += s->key != s->note->key;
    }
    if (good) {
        himc_midi_join(part);
        assign(part, steps, search(part, states, states + WIDTH, steps));
        find_damped(part);
    }
    free(states);
    free(steps);
    return good || himc_error_set(error, "out of memory for %d notes", part->count);
}
