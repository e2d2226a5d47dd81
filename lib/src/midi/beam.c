/// beam.c: the cheapest row of choices for the strokes of a part, by a beam search.
///
/// After each stroke the WIDTH cheapest states are kept, of those with equal keys only the
/// cheapest; on parts of usual length these hold the best way, which is walked back from the
/// cheapest of the last.
#include "midi/part.h"

#include <stdlib.h>
#include <string.h>

#define WIDTH 64 // states kept; chosen

typedef struct way {
    midi_state state;
    int8_t from, choice; // the state before, and what was chosen there
} way;

typedef struct step {
    int8_t from, choice;
} step;

// a hand or a drum is looked for
static bool is_chosen(const midi_stroke *s)
{
    return s->fate == MIDI_PLAYED && !s->foot && !s->in_roll;
}

// among the `count` best so far; returns how many they are then
static int keep(way *best, int count, const way *made)
{
    int worst = 0;
    for (int i = 0; i < count; i++) {
        if (memcmp(best[i].state.key, made->state.key, sizeof made->state.key) == 0) {
            if (made->state.cost < best[i].state.cost)
                best[i] = *made;
            return count;
        }
        worst = best[i].state.cost > best[worst].state.cost ? i : worst;
    }
    if (count < WIDTH) {
        best[count] = *made;
        return count + 1;
    }
    if (made->state.cost < best[worst].state.cost)
        best[worst] = *made;
    return count;
}

bool himc_midi_search(const midi_part *part, const midi_state *first, int choices,
                      midi_choose *choose, int8_t *chosen)
{
    way *now = malloc(WIDTH * sizeof *now), *next = malloc(WIDTH * sizeof *next);
    step *steps = malloc(((size_t)part->count * WIDTH + 1) * sizeof *steps);
    int count = 1, best = 0;
    bool good = now && next && steps;
    if (good)
        now[0].state = *first;
    for (int k = 0; good && k < part->count; k++) {
        if (!is_chosen(&part->stroke[k]))
            continue;
        int kept = 0;
        for (int i = 0; i < count * choices; i++) {
            way made = {now[i / choices].state, (int8_t)(i / choices), (int8_t)(i % choices)};
            if (choose(part, k, made.choice, &made.state))
                kept = keep(next, kept, &made);
        }
        for (int i = 0; i < kept; i++)
            steps[(size_t)k * WIDTH + (size_t)i] = (step){next[i].from, next[i].choice};
        way *other = now;
        now = next;
        next = other;
        count = kept;
    }
    for (int i = 1; good && i < count; i++)
        best = now[i].state.cost < now[best].state.cost ? i : best;
    for (int k = part->count - 1; good && k >= 0; k--) {
        if (!is_chosen(&part->stroke[k]))
            continue;
        step at = steps[(size_t)k * WIDTH + (size_t)best];
        chosen[k] = at.choice;
        best = at.from;
    }
    free(now);
    free(next);
    free(steps);
    return good;
}
