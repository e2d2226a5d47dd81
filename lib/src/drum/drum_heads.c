/// drum_heads.c: the heads of a drum whose pedal and damping are written in a score: each change
/// acts on a copy of the drum's settings, so that the score's commands give the heads they would
/// give by hand.
/// All that differ are computed ahead, and one is exchanged for another when its beat has come
/// (himc_membrane_exchange): the head taken out is kept for its next time. The head at a beat does
/// not depend on the way there, so a loop or `seek` finds it, too. Invariant: the drum's head is
/// that of the last change at or before the last beat asked for.
///
/// A change sets only what its command names. What a person has set on the drum since the heads
/// were made stays (himc_drum_heads_notice): from then on a change acts on the head as it is,
/// and is computed at its beat unless a head made ahead is the same.
///
/// A change may be added to those in use: it is prepared beside them, with all that comes after it,
/// and put in their place between two blocks.
#include "drum/drum_state.h"
#include "base/array.h"

#include "head/two_heads.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// a gliss whose beat is past by more, after `seek`, has arrived; chosen: a stick on the head delays
// it by less
#define GLISS_LATE 0.5 // (beats)
#ifndef MOST_SPARES
#define MOST_SPARES 48 // of a drum, some 2 MB each; chosen: two octaves, sounding and damped
#endif

typedef struct head_change {
    double beat;
    himc_head head;
    himc_command_id id; ///< of the command that made it, whose atoms are all numbers
    int form, count;
    double number[HIMC_COMMAND_ATOMS];
} head_change;

struct himc_drum_heads {
    himc_drum_settings settings; ///< owned; the changes act on them in their order
    himc_head first;             ///< before the first change
    drum_told_head told;         ///< known: of the latest heads only
    bool edited;         ///< the drum was changed by hand: the heads of changes are out of date
    head_change *change; ///< owned, in the order of beats
    int count, room;
    himc_model *spare[MOST_SPARES]; ///< owned
    int spares;
    int now;                 ///< the change whose head the drum has, -1: the first; -2: not known
    int late;                ///< a change that came, at beat `since`, after its beat: ...
    double since;            ///< ... up to an earlier beat it is not made up for; 0: none
    himc_drum_heads *before; ///< owned; in force before `from`
    double from;             ///< (beats)
};

himc_drum_heads *himc_drum_heads_new(const himc_drum_settings *settings, himc_error *error)
{
    himc_drum_heads *heads = himc_new(sizeof *heads, "at", error);
    if (!heads)
        return NULL;
    heads->settings = himc_drum_settings_copy(settings);
    heads->first = heads->told.base = heads->told.known = settings->head.head;
    heads->now = -2;
    return heads;
}

static void keep_command(head_change *change, const himc_command *command)
{
    change->id = command->id;
    change->count = command->count;
    for (int i = 0; i < command->count; i++) {
        bool word = command->atom[i].kind == HIMC_ATOM_SYMBOL; // `wires on|off`, first word on
        assert(!word || command->id == HIMC_COMMAND_WIRES);
        double pull = command->choice[i] == 0 ? HIMC_WIRES_USUAL : 0;
        change->number[i] = word ? pull : command->atom[i].number;
    }
}

static himc_command command_of(const head_change *change)
{
    himc_command command = {.id = change->id, .form = change->form, .count = change->count};
    for (int i = 0; i < change->count; i++)
        command.atom[i] = (himc_atom){HIMC_ATOM_NUMBER, change->number[i], NULL};
    return command;
}

/// Carries out the command of a change on settings, and keeps the head that it leaves.
static bool find_head(himc_drum_settings *settings, head_change *change, himc_error *error)
{
    himc_command command = command_of(change), checked;
    if (!himc_command_check(&checked, HIMC_DRUM, &command, error) ||
        !himc_drum_settings_command(settings, &checked, error))
        return false;
    change->form = checked.form;
    change->head = settings->head.head;
    return true;
}

static bool make_room(himc_drum_heads *heads, int room, himc_error *error)
{
    head_change *bigger = realloc(heads->change, (size_t)room * sizeof *bigger);
    if (!bigger)
        return himc_error_set(error, "at: out of memory for %d changes", room);
    heads->change = bigger;
    heads->room = room;
    return true;
}

bool himc_drum_heads_add(himc_drum_heads *heads, double beat, const himc_command *command,
                         himc_error *error)
{
    head_change change = {.beat = beat};
    keep_command(&change, command);
    if (!find_head(&heads->settings, &change, error))
        return false;
    if (heads->count == heads->room && !make_room(heads, 2 * heads->room + 16, error))
        return false;
    heads->change[heads->count++] = change;
    return true;
}

/// The head after a change, -1: the first.
static const himc_head *head_of(const himc_drum_heads *heads, int change)
{
    return change < 0 ? &heads->first : &heads->change[change].head;
}

static bool add_spare(himc_drum_heads *heads, const himc_membrane_config *config, himc_error *error)
{
    himc_model *made = himc_model_new(config, heads->spares ? heads->spare[0] : NULL, error);
    if (made)
        heads->spare[heads->spares++] = made;
    return made;
}

bool himc_drum_heads_prepare(himc_drum_heads *heads, himc_error *error)
{
    himc_membrane_config config = heads->settings.head;
    bool good = true, used[MOST_SPARES] = {false}; // a gliss has started from that one
    for (int i = 0; good && i < heads->count && heads->spares < MOST_SPARES; i++) {
        bool gliss = heads->change[i].id == HIMC_COMMAND_GLISS, known = false;
        for (int k = 0; k < heads->spares; k++) {
            const himc_head *spare = &heads->spare[k]->config.head;
            known = known || (!used[k] && himc_head_equal(spare, head_of(heads, i)));
            used[k] = used[k] || (gliss && himc_head_equal(spare, head_of(heads, i - 1)));
        }
        config.head = *head_of(heads, i);
        good = (known && !gliss) || add_spare(heads, &config, error);
    }
    return good;
}

/// Those of the chain that hold at a beat.
static himc_drum_heads *heads_at(himc_drum_heads *heads, double beat)
{
    while (heads && heads->before && beat < heads->from)
        heads = heads->before;
    return heads;
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

// the change that the drum is to have at a beat
static int wanted_at(const himc_drum_heads *heads, double beat)
{
    int change = change_at(heads, beat);
    bool late = heads->since > 0 && change == heads->late && beat >= heads->since;
    return late ? heads->now : change;
}

double himc_drum_heads_last(const himc_drum_heads *heads)
{
    double last = -1;
    for (double before = HUGE_VAL; heads && last < 0; before = heads->from, heads = heads->before)
        for (int i = heads->count - 1; i >= 0 && last < 0; i--)
            if (heads->change[i].beat < before)
                last = heads->change[i].beat;
    return last;
}

bool himc_drum_heads_due(const himc_drum_heads *heads, double beat)
{
    bool earlier = heads->before && beat < heads->from;
    return earlier ? heads->now != -2 || himc_drum_heads_due(heads->before, beat)
                   : wanted_at(heads, beat) != heads->now;
}

void himc_drum_heads_notice(himc_drum_heads *heads, const himc_drum *drum)
{
    himc_head now = himc_drum_head_config(drum).head, was = heads->told.known;
    if (himc_head_equal(&was, &now))
        return;
    heads->told.known = now;
    for (; heads; heads = heads->before) {
        himc_head_keep_edits(&heads->first, &was, &now);
        himc_head_keep_edits(&heads->told.base, &was, &now);
        heads->edited = true;
    }
}

void himc_drum_set_heads(himc_drum *drum, const himc_drum_heads *heads)
{
    drum->told = heads ? &heads->told : NULL;
}

/// From the present change on, the drum's head stays but for the changes from here on.
static int first_to_act(const himc_drum_heads *heads, int change)
{
    return heads->now != -2 && change >= heads->now ? heads->now + 1 : 0;
}

double himc_drum_heads_damp(const himc_drum_heads *heads, double beat)
{
    double present = heads->told.known.damp;
    while (heads->before && beat < heads->from)
        heads = heads->before;
    int change = wanted_at(heads, beat), from = first_to_act(heads, change);
    if (!heads->edited)
        return head_of(heads, change)->damp;
    while (change >= from && heads->change[change].id != HIMC_COMMAND_DAMP)
        change--;
    if (change >= from)
        return heads->change[change].number[0];
    return from > 0 || heads->now == -1 ? present : heads->first.damp;
}

bool himc_drum_heads_pedal(const himc_drum_heads *heads, double from, double to)
{
    for (double end = HUGE_VAL; heads; end = heads->from, heads = heads->before)
        for (int i = change_at(heads, from) + 1; i < heads->count; i++) {
            const head_change *c = &heads->change[i];
            if (c->beat > to || c->beat >= end)
                break;
            bool pedal = c->id == HIMC_COMMAND_GLISS || c->id == HIMC_COMMAND_TUNE ||
                         c->id == HIMC_COMMAND_TENSION;
            if (pedal && (!heads->before || c->beat >= heads->from))
                return true;
        }
    return false;
}

/// Carries the command of a change out on a head of the drum, which may refuse it.
static bool redo(const himc_drum *drum, const head_change *change, himc_head *head,
                 himc_error *error)
{
    himc_command command = command_of(change);
    return himc_drum_find_head(&himc_membrane_config_of(drum->membrane)->shape, &drum->set.usual,
                               &command, head, error);
}

/// The head of a drum that was changed by hand, after a change: of the commands that set the same,
/// only the last acts. False with the reason if the drum refuses one, which is left out.
static bool overlay(const himc_drum_heads *heads, const himc_drum *drum, int change,
                    himc_head *head, himc_error *error)
{
    enum { PITCH = 1, DECAY = 2, GLIDE = 4, DAMP = 8, MUFFLE = 16, ALL = 31 };
    int from = first_to_act(heads, change);
    bool onward = from > 0 || heads->now == -1, good = true;
    *head = onward ? himc_drum_head_config(drum).head : heads->first;
    for (int i = change, set = 0; i >= from && set != ALL; i--) {
        himc_command_id id = heads->change[i].id;
        int sets = id == HIMC_COMMAND_DECAY    ? DECAY
                   : id == HIMC_COMMAND_GLIDE  ? GLIDE
                   : id == HIMC_COMMAND_DAMP   ? DAMP
                   : id == HIMC_COMMAND_MUFFLE ? MUFFLE
                                               : PITCH;
        if (!(set & sets))
            good = redo(drum, &heads->change[i], head, error) && good;
        set |= sets;
    }
    return good;
}

/// Gives the drum that head; see himc_drum_take_head for the time.
static bool give(himc_drum_heads *heads, himc_drum *drum, const himc_head *head, double seconds,
                 himc_error *error)
{
    himc_membrane_config config = himc_drum_head_config(drum);
    if (himc_head_equal(&config.head, head) && !(seconds >= 0 && himc_drum_glides(drum)))
        return true;
    config.head = *head;
    himc_model **spare = NULL; // of that config
    for (int i = heads->spares - 1; i >= 0; i--)
        if (himc_membrane_config_equal(&heads->spare[i]->config, &config))
            spare = &heads->spare[i];
    bool good = himc_drum_take_head(drum, &config, seconds, spare, error);
    himc_drum_find_noise(drum, &drum->set.mallet[HIMC_RIGHT]);
    if (spare && !*spare)
        *spare = heads->spare[--heads->spares];
    return good;
}

/// The time of the pedal on its way to a change, as of himc_drum_take_head.
static double pedal_time(const himc_drum_heads *heads, int change, double beat)
{
    int from = first_to_act(heads, change);
    for (int i = change; i >= from; i--) {
        const head_change *c = &heads->change[i];
        if (c->id == HIMC_COMMAND_GLISS)
            return beat - c->beat < GLISS_LATE ? c->number[1] : 0;
        if (c->id == HIMC_COMMAND_TUNE || c->id == HIMC_COMMAND_TENSION)
            return 0;
    }
    return -1;
}

bool himc_drum_heads_turn(himc_drum_heads *heads, himc_drum *drum, double beat, himc_error *error)
{
    himc_drum_heads *latest = heads;
    himc_drum_heads_notice(heads, drum);
    for (; heads->before && beat < heads->from; heads = heads->before)
        heads->now = -2;
    if (heads->before)
        heads->before->now = -2;
    int change = wanted_at(heads, beat);
    if (change == heads->now)
        return true;
    heads->since = 0;
    himc_head head = *head_of(heads, change);
    bool good = !heads->edited || overlay(heads, drum, change, &head, error);
    good = give(heads, drum, &head, pedal_time(heads, change, beat), error) && good;
    heads->now = change;
    latest->told.known = himc_drum_head_config(drum).head;
    return good;
}

bool himc_drum_heads_begin_again(himc_drum_heads *heads, himc_drum *drum, double end,
                                 himc_error *error)
{
    int from = heads->count;
    while (from > 0 && heads->change[from - 1].beat >= end)
        from--;
    if (from == heads->count || heads->before)
        return true;
    himc_drum_heads_notice(heads, drum);
    himc_head head = heads->first;
    bool good = true;
    for (int i = from; i < heads->count; i++)
        good = redo(drum, &heads->change[i], &head, error) && good;
    good = give(heads, drum, &head, 0, error) && good;
    heads->edited = true; // the next changes act on this head
    heads->now = -1;
    heads->since = 0;
    heads->told.known = himc_drum_head_config(drum).head;
    return good;
}

void himc_drum_heads_begin_anew(himc_drum_heads *heads)
{
    heads->now = -2;
}

himc_drum_heads *himc_drum_heads_follow(himc_drum_heads *heads, himc_drum_heads *before,
                                        double from, double now)
{
    heads->before = before;
    heads->from = from;
    if (before)
        heads->told = before->told;
    himc_drum_heads *present = heads_at(before, now);
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
            himc_model_free(heads->spare[--heads->spares]);
        himc_drum_settings_free(&heads->settings);
        free(heads->change);
        free(heads);
        heads = before;
    }
}

// a change that is added while others are in use

struct himc_head_insertion {
    himc_drum *drum;              ///< borrowed
    himc_drum_heads *to;          ///< not touched by `prepare`; NULL: the drum has no changes yet
    himc_drum_heads *made;        ///< owned; changes of `to` with the new one, and the heads ...
    himc_head known[MOST_SPARES]; ///< ... that are not yet made
    int known_count;
    int at;    ///< the new one's index
    bool anew; ///< the drum was changed by hand: all heads are made again
};

himc_head_insertion *himc_head_insertion_new(himc_drum_heads *heads, himc_drum *drum, double beat,
                                             const himc_command *command, himc_error *error)
{
    himc_drum_heads *to = heads_at(heads, beat);
    int old = to ? to->count : 0;
    himc_drum_settings settings = himc_drum_settings_of(drum);
    himc_drum_heads *made = himc_drum_heads_new(&settings, error);
    himc_head_insertion *j = made ? calloc(1, sizeof *j) : NULL;
    himc_drum_settings_free(&settings);
    if (!j || !make_room(made, old + 1, error)) {
        himc_drum_heads_free(made);
        free(j);
        return NULL;
    }
    *j = (himc_head_insertion){.drum = drum, .to = to, .made = made, .anew = to && to->edited};
    while (j->at < old && to->change[j->at].beat <= beat)
        j->at++;
    for (int i = 0; i < old; i++)
        made->change[i + (i >= j->at)] = to->change[i];
    made->change[j->at] = (head_change){.beat = beat};
    made->count = old + 1;
    keep_command(&made->change[j->at], command);
    for (int i = 0; to && i < to->spares; i++) {
        himc_membrane_config config = made->settings.head;
        config.head = to->spare[i]->config.head;
        if (himc_membrane_config_equal(&to->spare[i]->config, &config))
            j->known[j->known_count++] = config.head;
    }
    if (to)
        made->first = to->first;
    return j;
}

bool himc_head_insertion_prepare(himc_head_insertion *j, himc_error *error)
{
    himc_drum_heads *made = j->made;
    int from = j->anew ? 0 : j->at;
    himc_drum_settings after = himc_drum_settings_copy(&made->settings);
    bool good = true;
    after.head.head = *head_of(made, from - 1);
    for (int i = from; i < made->count && good; i++) {
        good = find_head(&after, &made->change[i], error);
        bool room = j->known_count + made->spares < MOST_SPARES;
        const himc_head *head = &after.head.head;
        bool known = himc_head_equal(head, &made->settings.head.head);
        for (int k = 0; k < j->known_count; k++)
            known = known || himc_head_equal(head, &j->known[k]);
        for (int k = 0; k < made->spares; k++)
            known = known || himc_head_equal(head, &made->spare[k]->config.head);
        bool gliss = made->change[i].id == HIMC_COMMAND_GLISS;
        if (good && room && (gliss || !known))
            good = add_spare(made, &after.head, error);
    }
    himc_drum_settings_free(&after);
    return good;
}

/// True if the changes are still those that it was prepared for.
static bool still_fits(const himc_head_insertion *j, const himc_drum_heads *to)
{
    const himc_drum_heads *made = j->made;
    if (!to)
        return !j->to && himc_drum_has_head(j->drum, &made->settings);
    bool fits =
        to == j->to && to->count == made->count - 1 && himc_head_equal(&to->first, &made->first);
    for (int i = 0; fits && i < to->count; i++) {
        const head_change *was = &made->change[i + (i >= j->at)];
        fits = was->beat == to->change[i].beat && was->id == to->change[i].id &&
               memcmp(was->number, to->change[i].number, sizeof was->number) == 0;
    }
    return fits;
}

bool himc_head_insertion_install(himc_head_insertion *j, himc_drum_heads **heads, double now)
{
    himc_drum_heads *made = j->made, *to = heads_at(*heads, made->change[j->at].beat);
    if (!still_fits(j, to))
        return false;
    if (!to) {
        to = *heads = made;
        to->now = -1;
        himc_drum_set_heads(j->drum, to);
        j->made = NULL;
    } else {
        head_change *old = to->change;
        to->change = made->change;
        to->count = to->room = made->count;
        made->change = old;
        while (made->spares > 0 && to->spares < MOST_SPARES)
            to->spare[to->spares++] = made->spare[--made->spares];
        to->now += to->now >= j->at;
        to->late += to->late >= j->at;
    }
    if (now > to->change[j->at].beat && change_at(to, now) == j->at) {
        to->late = j->at;
        to->since = now;
    }
    return true;
}

void himc_head_insertion_free(himc_head_insertion *j)
{
    if (j)
        himc_drum_heads_free(j->made);
    free(j);
}
