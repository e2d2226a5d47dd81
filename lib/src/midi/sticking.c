/// sticking.c: which hand plays which stroke.
///
/// A search over the strokes in time. Its state is the last stroke of each hand; a stroke costs its
/// hand what plan/sticking.h says, a little more the left one, and more the hand that has just
/// struck the same drum: hand by hand, as players do also where one hand had the time. A stroke
/// nearer to its hand's last than the planner can move (hand.c) is not possible; one that is left
/// out costs more than any that is played, and the more the louder it is. The WIDTH best states are
/// kept after each stroke.
#include "midi/part.h"
#include "plan/hand.h"
#include "plan/sticking.h"

#include <math.h>
#include <stdlib.h>

#define WIDTH 64 // states kept; chosen

/// One hand.
typedef struct hand_state {
    double at;   ///< of its last stroke (s); far in the past at first
    double x, y; ///< where it was (m)
} hand_state;

typedef struct state {
    double cost;
    hand_state hand[HIMC_HANDS];
    int32_t last[HIMC_HANDS]; ///< index of its last stroke, -1 at first
    int8_t from;              ///< state of the stroke before
    int8_t choice;            ///< hand of this stroke, or OMIT
} state;

enum { OMIT = HIMC_HANDS };

typedef struct step {
    int8_t from, choice;
} step;

// of a stroke by that hand; infinite if it is not possible
static double stroke_cost(const state *now, const hand_state *to, int hand)
{
    const hand_state *from = &now->hand[hand], *other = &now->hand[1 - hand];
    himc_sticking s = {.gap = to->at - from->at,
                       .way = hypot(to->x - from->x, to->y - from->y),
                       .inwards = hand == HIMC_LEFT ? other->y - to->y : to->y - other->y,
                       .other_gap = to->at - other->at};
    s.same_spot = s.way == 0;
    // on one spot 0.055 s, as the planner refuses 0.04 s; the margin is the planner's (hand.c) for
    // a stroke's swing, and a little more
    if (s.gap < fmax(0.055, 1.45 * himc_move_time(s.way, HIMC_HARDEST_MOVE)))
        return HUGE_VAL;
    return himc_sticking_cost(&s) + (hand == HIMC_LEFT ? 0.02 : 0);
}

// among the `count` best so far; one for each pair of last strokes
static int keep(state *best, int count, const state *made)
{
    int worst = 0;
    for (int i = 0; i < count; i++) {
        if (best[i].last[0] == made->last[0] && best[i].last[1] == made->last[1]) {
            if (made->cost < best[i].cost)
                best[i] = *made;
            return count;
        }
        worst = best[i].cost > best[worst].cost ? i : worst;
    }
    if (count == WIDTH && made->cost >= best[worst].cost)
        return count;
    best[count < WIDTH ? count : worst] = *made;
    return count < WIDTH ? count + 1 : count;
}

// The states after each stroke that is played; returns the best after the last. Both arrays are of
// WIDTH states, `steps` of WIDTH for each stroke.
static int search(const midi_part *part, state *now, state *next, step *steps)
{
    const double omit = 45, omit_loud = 20; // costs of a stroke left out: of any, more of fff
    // at first each hand is before its own side
    int count = 1;
    now[0] = (state){.hand = {{-1e3, 0.5, 0.2}, {-1e3, 0.5, -0.2}}, .last = {-1, -1}};
    for (int k = 0; k < part->count; k++, steps += WIDTH) {
        const midi_stroke *s = &part->stroke[k];
        if (s->fate != MIDI_PLAYED)
            continue;
        const midi_head *head = &part->head[s->head];
        // the normal spot, towards the player from the centre
        hand_state to = {s->note->seconds, head->x - 0.75 * head->radius, head->y};
        int kept = 0;
        for (int i = 0; i < count; i++)
            for (int choice = 0; choice <= OMIT; choice++) {
                state made = now[i];
                made.from = (int8_t)i;
                made.choice = (int8_t)choice;
                made.cost += choice == OMIT ? omit + omit_loud * s->dynamic
                                            : stroke_cost(&now[i], &to, choice);
                if (choice != OMIT) {
                    made.hand[choice] = to;
                    made.last[choice] = k;
                }
                if (isfinite(made.cost))
                    kept = keep(next, kept, &made);
            }
        for (int i = 0; i < kept; i++)
            steps[i] = (step){next[i].from, next[i].choice};
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

bool himc_midi_stick(midi_part *part, himc_error *error)
{
    state *states = malloc(2 * WIDTH * sizeof *states);
    step *steps = malloc(((size_t)part->count * WIDTH + 1) * sizeof *steps);
    bool good = states && steps;
    int at = good ? search(part, states, states + WIDTH, steps) : 0;
    for (int i = part->count - 1; i >= 0 && good; i--) {
        midi_stroke *s = &part->stroke[i];
        if (s->fate != MIDI_PLAYED)
            continue;
        const step *chosen = &steps[(size_t)i * WIDTH + (size_t)at];
        at = chosen->from;
        if (chosen->choice == OMIT)
            s->fate = MIDI_NO_HAND;
        else
            s->hand = (himc_hand)chosen->choice;
    }
    free(states);
    free(steps);
    return good || himc_error_set(error, "out of memory for %d strokes", part->count);
}
