/// drum_heads.c: the heads of a drum whose pedal and damping are written in a score.
///
/// Each change acts on a copy of the drum, so that the score's commands give the heads they would
/// give by hand. All that differ are computed ahead, and one is exchanged for another when its beat
/// has come (himc_membrane_exchange): the head taken out is kept for its next time. The head at a beat
/// does not depend on the way there, so a loop or `seek` finds it, too. Invariant: the drum's head
/// is that of the last change at or before the last beat asked for.
#include "drum/drum_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_SPARES 48 // of a drum, under 1 MB each; chosen: two octaves, sounding and damped

typedef struct head_change {
    double beat;
    himc_head head;
} head_change;

struct himc_drum_heads {
    himc_drum *copy;     ///< owned; the commands act on it
    himc_head first;     ///< before the first change
    himc_drum_form form; ///< owned
    head_change *change; ///< owned, in the order of beats
    int count, room;
    himc_membrane *spare[MOST_SPARES]; ///< owned
    int spares;
    int now;                 ///< the change whose head the drum has, -1: the first; -2: not known
    himc_drum_heads *before; ///< owned; in force before `from`
    double from;             ///< (beats)
};

himc_drum_heads *himc_drum_heads_new(const himc_drum_form *form, himc_error *error)
{
    himc_drum_heads *heads = calloc(1, sizeof *heads);
    if (heads)
        heads->copy = himc_drum_new_of(form, error);
    else
        himc_error_set(error, "at: out of memory");
    if (!heads || !heads->copy) {
        free(heads);
        return NULL;
    }
    heads->form = himc_drum_form_of(heads->copy);
    heads->first = *himc_membrane_head(heads->copy->membrane);
    heads->now = -2;
    return heads;
}

bool himc_drum_heads_add(himc_drum_heads *heads, double beat, const himc_command *command,
                         himc_error *error)
{
    if (!himc_drum_command(heads->copy, command, error))
        return false;
    if (heads->count == heads->room) {
        int room = heads->room ? 2 * heads->room : 16;
        head_change *bigger = realloc(heads->change, (size_t)room * sizeof *bigger);
        if (!bigger)
            return himc_error_set(error, "at: out of memory for %d changes", room);
        heads->change = bigger;
        heads->room = room;
    }
    heads->change[heads->count++] = (head_change){beat, *himc_membrane_head(heads->copy->membrane)};
    return true;
}

/// The head after a change, -1: the first.
static const himc_head *head_of(const himc_drum_heads *heads, int change)
{
    return change < 0 ? &heads->first : &heads->change[change].head;
}

static himc_membrane *find_spare(himc_drum_heads *heads, const himc_membrane_form *form)
{
    for (int i = 0; i < heads->spares; i++)
        if (himc_membrane_has_form(heads->spare[i], form))
            return heads->spare[i];
    return NULL;
}

bool himc_drum_heads_prepare(himc_drum_heads *heads, himc_error *error)
{
    himc_membrane_form form = heads->form.head;
    for (int i = 0; i < heads->count && heads->spares < MOST_SPARES; i++) {
        form.head = *head_of(heads, i);
        if (find_spare(heads, &form))
            continue;
        himc_membrane *made = himc_membrane_new_of(&form, error);
        if (!made)
            return false;
        heads->spare[heads->spares++] = made;
    }
    return true;
}

// the last change at or before a beat; usually the present one or its neighbour
static int change_at(const himc_drum_heads *heads, double beat)
{
    int i = heads->now < -1 ? -1 : heads->now;
    while (i >= 0 && heads->change[i].beat > beat)
        i--;
    while (i + 1 < heads->count && heads->change[i + 1].beat <= beat)
        i++;
    return i;
}

bool himc_drum_heads_due(const himc_drum_heads *heads, double beat)
{
    bool earlier = heads->before && beat < heads->from;
    return earlier ? heads->now != -2 || himc_drum_heads_due(heads->before, beat)
                   : change_at(heads, beat) != heads->now;
}

void himc_drum_heads_turn(himc_drum_heads *heads, himc_drum *drum, double beat)
{
    for (; heads->before && beat < heads->from; heads = heads->before)
        heads->now = -2;
    if (heads->before)
        heads->before->now = -2;
    int change = change_at(heads, beat);
    if (change == heads->now)
        return;
    himc_membrane *membrane = drum->membrane;
    himc_membrane_form form = himc_membrane_form_of(membrane);
    form.head = *head_of(heads, change);
    heads->now = change;
    himc_membrane *spare = find_spare(heads, &form);
    if (spare && !himc_membrane_has_form(membrane, &form))
        himc_membrane_exchange(membrane, spare);
    else if (!spare)
        himc_membrane_set_head(membrane, &form.head, NULL);
    himc_membrane_form_free(&form);
}

himc_drum_heads *himc_drum_heads_follow(himc_drum_heads *heads, himc_drum_heads *before,
                                        double from, double now)
{
    heads->before = before;
    heads->from = from;
    himc_drum_heads *present = before;
    while (present && present->before && now < present->from)
        present = present->before;
    himc_drum_heads *over = present ? present->before : NULL;
    if (present)
        present->before = NULL;
    return over;
}

void himc_drum_heads_free(himc_drum_heads *heads)
{
    while (heads) {
        himc_drum_heads *before = heads->before;
        while (heads->spares > 0)
            himc_membrane_free(heads->spare[--heads->spares]);
        himc_drum_form_free(&heads->form);
        himc_drum_release(heads->copy);
        free(heads->change);
        free(heads);
        heads = before;
    }
}
