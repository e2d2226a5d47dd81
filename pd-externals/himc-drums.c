/* himc-drums.c: the drums of a [himc~]: found by name, taken and released, and advanced together
with the performance by the first of them in a tick of Pd. */
#define _POSIX_C_SOURCE 200809L
#include "himc-tilde.h"
#include "himc/osc.h"

#include <time.h>

static double himc_tilde_seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void himc_tilde_advance(void *player, uint64_t time)
{
    t_himc *x = ((t_player *)player)->p_himc;
    for (uint64_t now; (now = himc_performance_time(x->x_performance)) < time;) {
        uint64_t at = now % FORCE_RING;
        uint64_t n = time - now < FORCE_RING - at ? time - now : FORCE_RING - at;
        double *force[HIMC_HANDS] = {x->x_force[HIMC_LEFT] + at, x->x_force[HIMC_RIGHT] + at};
        double start = x->x_osc ? himc_tilde_seconds() : 0;
        himc_performance_process(x->x_performance, (int)n, force);
        if (x->x_osc)
            himc_osc_publish(x->x_osc, x->x_performance, himc_tilde_seconds() - start);
    }
    x->x_player.p_time = himc_performance_time(x->x_performance);
    bool moved = himc_performance_measure(x->x_performance).hearings != x->x_hearings,
         waited = x->x_waiting;
    x->x_waiting = waited || himc_performance_event(x->x_performance, &x->x_event);
    if (moved || (x->x_waiting && !waited))
        clock_delay(x->x_clock, 0);
}

void himc_tilde_share_room(t_himc *x)
{
    long now = himc_performance_measure(x->x_performance).hearings;
    bool moved = now != x->x_hearings;
    himc_error error;
    x->x_hearings = now;
    for (int i = 0; moved && i < x->x_count; i++) {
        void *player[DRUM_LINK_PLAYERS] = {NULL};
        t_drum_link *link = drum_link_find(x->x_drum[i].d_name, &error);
        if (link)
            link->l_players(link, player);
        for (int k = 0; k < DRUM_LINK_PLAYERS; k++) {
            t_himc *other = player[k] ? ((t_player *)player[k])->p_himc : x;
            if (other == x)
                continue;
            if (!himc_performance_hear_as(other->x_performance, x->x_performance, &error))
                pd_error(other, "himc~: %s", error.text);
            himc_tilde_share_room(other);
        }
    }
}

int himc_tilde_block(void *player)
{
    const t_himc *x = ((t_player *)player)->p_himc;
    int longest = x->x_stream.s_length;
    himc_error none;
    for (int i = 0; i < x->x_count; i++) {
        const t_drum_link *link = drum_link_find(x->x_drum[i].d_name, &none);
        if (link && link->l_block > longest)
            longest = link->l_block;
    }
    return longest;
}

static void himc_tilde_release(t_himc *x, const t_himc_drum *d)
{
    if (d->d_drum && himc_drum_get_driver(d->d_drum).performer == &x->x_player)
        himc_drum_set_driver(d->d_drum, (himc_drum_driver){NULL, NULL});
}

/* Takes `drum` in place of another of its name; a guest takes the room of those who are there. */
static bool himc_tilde_take(t_himc *x, t_himc_drum *d, himc_drum *drum, himc_error *error)
{
    if (!himc_performance_add_drum(x->x_performance, drum, error))
        return false;
    himc_drum_set_driver(drum, (himc_drum_driver){himc_tilde_advance, &x->x_player});
    d->d_drum = drum;
    t_drum_link *link = drum_link_find(d->d_name, error);
    t_player *first = link ? himc_drum_get_driver(link->l_drum).performer : NULL;
    const t_himc *other = first ? first->p_himc : x;
    return other == x || himc_performance_hear_as(x->x_performance, other->x_performance, error);
}

/* A guest of [membrane~ NAME], which another [himc~] plays. */
static himc_drum *himc_tilde_find_guest(t_himc *x, t_drum_link *link, himc_error *error)
{
    if (link->l_rate == x->x_rate)
        return link->l_guest(link, &x->x_player, error);
    himc_error_set(error, "[membrane~ %s] is played at %g Hz by another [himc~]",
                   himc_drum_name(link->l_drum), link->l_rate);
    return NULL;
}

/* The drum of [membrane~ NAME] at the performance's rate, or NULL and why not. */
static himc_drum *himc_tilde_find(t_himc *x, const char *name, himc_error *error)
{
    t_drum_link *link = drum_link_find(name, error);
    if (!link)
        return NULL;
    void *performer = himc_drum_get_driver(link->l_drum).performer;
    if (performer && performer != &x->x_player)
        return himc_tilde_find_guest(x, link, error);
    if (link->l_rate != x->x_rate && !himc_drum_set_rate(link->l_drum, x->x_rate, error))
        return NULL;
    link->l_rate = x->x_rate;
    return link->l_drum;
}

/* One more drum; NULL if there are too many. */
static t_himc_drum *himc_tilde_append(t_himc *x, const char *name)
{
    if (x->x_count == HIMC_DRUMS)
        return NULL;
    t_himc_drum *d = &x->x_drum[x->x_count++];
    *d = (t_himc_drum){.d_name = gensym(name)->s_name};
    return d;
}

static t_himc_drum *himc_tilde_listed(t_himc *x, const char *name)
{
    for (t_himc_drum *d = x->x_drum; d < x->x_drum + x->x_count; d++)
        if (strcmp(d->d_name, name) == 0)
            return d;
    return NULL;
}

bool himc_tilde_find_drum(void *object, const char *name)
{
    t_himc *x = object;
    himc_error ignored;
    himc_drum *drum = himc_tilde_find(x, name, &ignored);
    t_himc_drum *d = drum ? himc_tilde_listed(x, name) : NULL;
    if (drum && !d)
        d = himc_tilde_append(x, name);
    if (!d || !himc_tilde_take(x, d, drum, &ignored))
        return false;
    d->d_silent = d->d_told = false;
    return true;
}

/* Silent drums that a score or the command `drum` has made: a [membrane~] may come for them. The
one of strokes without a drum's name has a command's name. */
static void himc_tilde_list_made(t_himc *x)
{
    himc_drum *drum;
    for (int i = 0; (drum = himc_performance_drum(x->x_performance, i)); i++) {
        const char *name = himc_drum_name(drum);
        t_himc_drum *d = NULL;
        if (!himc_command_find(HIMC_PERFORMER, name) && !himc_tilde_listed(x, name))
            d = himc_tilde_append(x, name);
        if (d)
            d->d_silent = d->d_told = true; /* by the performance */
    }
}

void himc_tilde_resolve(t_himc *x, bool tell)
{
    himc_tilde_list_made(x);
    for (t_himc_drum *d = x->x_drum; d < x->x_drum + x->x_count; d++) {
        himc_error error = {""};
        himc_drum *drum = himc_tilde_find(x, d->d_name, &error);
        if (drum && drum != d->d_drum) {
            himc_tilde_release(x, d);
            if (himc_tilde_take(x, d, drum, &error))
                d->d_silent = d->d_told = false;
            else
                drum = NULL;
        }
        if (!drum && !d->d_silent) {
            himc_error ignored;
            himc_drum *silent = himc_drum_new(d->d_name, HIMC_INCHES_USUAL, x->x_rate, &ignored);
            himc_tilde_release(x, d);
            d->d_silent = silent && himc_tilde_take(x, d, silent, &ignored);
            himc_drum_release(silent);
        }
        if (!drum && tell && !d->d_told) {
            pd_error(x, "himc~: %s: its strokes are silent", error.text);
            d->d_told = true;
        }
    }
}

void himc_tilde_leave(t_himc *x)
{
    for (int i = 0; i < x->x_count; i++)
        himc_tilde_release(x, x->x_drum + i);
}
