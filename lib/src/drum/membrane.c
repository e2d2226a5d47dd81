/// membrane.c: what a membrane is: modes, bank, ears and spots put together, and changed as it
/// sounds.
///
/// A force f at (x, y) drives mode i with phi_i(x, y) f; the displacement there is sum phi_i q_i.
/// Both use the same phi, from the same table, so work done on the head is energy in its modes to
/// the last bit but rounding, whatever the table's error. A place is looked up or computed once
/// (spot.h) and kept while it is used. In air each mode has another frequency, decay and mass and
/// keeps its shape (air.h), so all of this holds there too.
#include "drum/membrane_state.h"

#include "drum/bessel.h"
#include "drum/pickup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// what every pickup reads now and next
typedef struct hearings {
    sound of[HIMC_PICKUPS];
} hearings;

// what the film's pull drives each mode by, as `direct` hears it
static double film_drive(const himc_membrane *m, const double *direct)
{
    double sum = 0;
    for (int i = 0; i < himc_bank_count(m->core.bank); i++) {
        double q, v;
        himc_bank_state(m->core.bank, i, &q, &v);
        sum -= m->tension.s * m->core.stretch[i] * q * direct[i];
    }
    return sum;
}

// An acceleration is heard of a force directly, and much of that cancels what the bent head's modes
// say; so the forces of the last sample count as if they went on.
static void listen_to_forces(himc_membrane *m, int index, sound *heard)
{
    core *c = &m->core;
    const ear *e = &c->ears[index];
    himc_bank_step_response(c->bank, &e->tap, c->scratch);
    for (int i = 0; i < himc_bank_padded(c->bank); i++)
        c->scratch[i] = e->answer[0][i] - c->scratch[i];
    double film = m->tension.on ? film_drive(m, c->scratch) : 0;
    heard->now += film;
    heard->next += film;
    for (int i = 0; i < m->pressed_count; i++) {
        const push *p = &m->pressed[i];
        const spot *s = himc_membrane_strike_point(m, p->x, p->y);
        heard->now += p->force * himc_bank_sum(c->bank, s->shape, c->scratch);
        heard->next += p->force * s->effect[0].heard[index];
    }
}

static hearings listen(himc_membrane *m)
{
    hearings h = {0};
    for (int i = 0; i < m->pickup_count; i++) {
        const himc_readout *tap = &m->core.ears[i].tap;
        const fade *f = &m->fades[i];
        h.of[i] = (sound){himc_bank_read(m->core.bank, tap) + fade_at(f, f->at - 1),
                          himc_bank_peek(m->core.bank, tap) + fade_at(f, f->at)};
        listen_to_forces(m, i, &h.of[i]);
    }
    return h;
}

// makes the sounds go on from `before`
static void splice(himc_membrane *m, hearings before)
{
    memset(m->fades, 0, sizeof m->fades);
    hearings after = listen(m);
    for (int i = 0; i < m->pickup_count; i++)
        m->fades[i] = fade_between(before.of[i], after.of[i], m->rate);
}

// a head of that outline
static bool check_head(const himc_head *head, himc_outline kind, himc_error *error)
{
    if (!himc_head_check(head, error))
        return false;
    if (head->air && kind != HIMC_CIRCLE)
        return himc_error_set(error, "air: 1, allowed 0 on a head that is not round");
    return !head->air || head->kettle == 0 || himc_air_check(head->kettle, head->radius, error);
}

himc_membrane *himc_membrane_new(const himc_head *head, double rate, himc_error *error)
{
    if (!check_head(head, HIMC_CIRCLE, error) ||
        !himc_check_range("sample rate", rate, 4000, 480000, "Hz", error))
        return NULL;
    himc_membrane *m = calloc(1, sizeof *m);
    if (!m || !himc_core_new(&m->core, m->spots, &(himc_shape){.kind = HIMC_CIRCLE}, head->modes,
                             error)) {
        if (!m)
            himc_error_set(error, "membrane: no memory");
        free(m);
        return NULL;
    }
    m->head = *head;
    m->pickups[0] = himc_pickup_default();
    m->pickup_count = 1;
    m->part_last = true;
    m->rate = rate;
    himc_membrane_retune(m);
    return m;
}

void himc_membrane_free(himc_membrane *membrane)
{
    if (!membrane)
        return;
    himc_core_free(&membrane->core);
    free(membrane);
}

// another number of modes: the common ones go on in new arrays
static bool resize(himc_membrane *m, int count, himc_error *error)
{
    core old = m->core, fresh;
    if (!himc_core_new(&fresh, m->spots, himc_modes_outline(old.modes), count, error))
        return false;
    int common = count < m->head.modes ? count : m->head.modes;
    himc_bank_set(fresh.bank, old.oscillators, common, m->rate);
    for (int i = 0; i < common; i++) {
        double q, v;
        himc_bank_state(old.bank, i, &q, &v);
        himc_bank_excite(fresh.bank, i, q, v);
    }
    m->core = fresh;
    himc_core_free(&old);
    return true;
}

// modes from `first` on are new: where something presses they begin bent as they would be by now
static void bend_new(himc_membrane *m, int first)
{
    for (int i = first; i < himc_bank_count(m->core.bank); i++) {
        const himc_oscillator *o = &m->core.oscillators[i];
        double q = 0;
        for (int k = 0; k < m->pressed_count; k++) {
            const push *p = &m->pressed[k];
            q += himc_membrane_strike_point(m, p->x, p->y)->shape[i] * p->force;
        }
        if (q != 0)
            himc_bank_excite(m->core.bank, i, q / (o->mass * o->omega * o->omega), 0);
    }
    if (m->tension.on)
        himc_membrane_find_tension(m);
}

bool himc_membrane_set_head(himc_membrane *membrane, const himc_head *head, himc_error *error)
{
    if (!check_head(head, himc_membrane_shape(membrane)->kind, error))
        return false;
    hearings before = listen(membrane);
    double energy = himc_membrane_energy(membrane);
    int known = membrane->head.modes;
    if (head->modes != known && !resize(membrane, head->modes, error))
        return false;
    membrane->head = *head;
    himc_membrane_retune(membrane);
    bend_new(membrane, known);
    himc_membrane_keep_energy(membrane, energy);
    splice(membrane, before);
    return true;
}

bool himc_membrane_set_shape(himc_membrane *membrane, const himc_shape *shape,
                             const himc_head *head, himc_error *error)
{
    core fresh, old = membrane->core;
    spot spots[SPOTS];
    if (!check_head(head, shape->kind, error) ||
        !himc_core_new(&fresh, spots, shape, head->modes, error))
        return false;
    hearings before = listen(membrane);
    memcpy(membrane->spots, spots, sizeof spots);
    membrane->core = fresh;
    membrane->head = *head;
    membrane->tension = (tension){0};
    himc_membrane_retune(membrane);
    splice(membrane, before);
    himc_core_free(&old);
    return true;
}

const himc_shape *himc_membrane_shape(const himc_membrane *membrane)
{
    return himc_modes_outline(membrane->core.modes);
}

bool himc_membrane_set_pickups(himc_membrane *membrane, const himc_pickup *pickups, int count,
                               himc_error *error)
{
    if (!himc_check_range("pickups", count, 1, HIMC_PICKUPS, "", error))
        return false;
    for (int i = 0; i < count; i++)
        if (!himc_pickup_check(&pickups[i], &membrane->head, error))
            return false;
    hearings before = listen(membrane);
    memcpy(membrane->pickups, pickups, sizeof *pickups * (size_t)count);
    membrane->pickup_count = count;
    for (int i = 0; i < SPOTS; i++)
        membrane->spots[i].used = false;
    for (int i = 0; i < count; i++)
        himc_membrane_aim_ear(membrane, i);
    splice(membrane, before);
    return true;
}

bool himc_membrane_set_pickup(himc_membrane *membrane, const himc_pickup *pickup, himc_error *error)
{
    himc_pickup all[HIMC_PICKUPS];
    memcpy(all, membrane->pickups, sizeof all);
    all[0] = *pickup;
    return himc_membrane_set_pickups(membrane, all, membrane->pickup_count, error);
}

bool himc_membrane_set_rate(himc_membrane *membrane, double rate, himc_error *error)
{
    if (!himc_check_range("sample rate", rate, 4000, 480000, "Hz", error))
        return false;
    hearings before = listen(membrane);
    for (int i = 0; i < HIMC_PICKUPS; i++) {
        sound *s = &before.of[i];
        s->next = s->now + (s->next - s->now) * (membrane->rate / rate);
    }
    membrane->rate = rate;
    himc_membrane_retune(membrane);
    splice(membrane, before);
    return true;
}

static bool same_shape(const himc_shape *a, const himc_shape *b)
{
    return a->kind == b->kind && a->grid == b->grid && a->length * b->width == b->length * a->width;
}

static bool same_head(const himc_head *a, const himc_head *b)
{
    return a->radius == b->radius && a->tension == b->tension && a->density == b->density &&
           a->decay_constant == b->decay_constant && a->decay_square == b->decay_square &&
           a->modes == b->modes && a->air == b->air && a->kettle == b->kettle &&
           a->glide == b->glide && a->damp == b->damp;
}

static bool same_pickup(const himc_pickup *a, const himc_pickup *b)
{
    return a->kind == b->kind && a->x == b->x && a->y == b->y && a->azimuth == b->azimuth &&
           a->elevation == b->elevation && a->distance == b->distance;
}

bool himc_membrane_alike(const himc_membrane *a, const himc_membrane *b)
{
    bool alike = a->pickup_count == b->pickup_count && same_head(&a->head, &b->head) &&
                 same_shape(himc_membrane_shape(a), himc_membrane_shape(b));
    for (int i = 0; alike && i < a->pickup_count; i++)
        alike = same_pickup(&a->pickups[i], &b->pickups[i]);
    return alike;
}

bool himc_membrane_follow(himc_membrane *membrane, const himc_membrane *other, himc_error *error)
{
    const himc_shape *shape = himc_membrane_shape(other);
    bool good = same_shape(himc_membrane_shape(membrane), shape)
                    ? himc_membrane_set_head(membrane, &other->head, error)
                    : himc_membrane_set_shape(membrane, shape, &other->head, error);
    return good && himc_membrane_set_pickups(membrane, other->pickups, other->pickup_count, error);
}

const himc_head *himc_membrane_head(const himc_membrane *membrane)
{
    return &membrane->head;
}

const himc_pickup *himc_membrane_pickup(const himc_membrane *membrane)
{
    return &membrane->pickups[0];
}

const himc_pickup *himc_membrane_pickups(const himc_membrane *membrane, int *count)
{
    *count = membrane->pickup_count;
    return membrane->pickups;
}

double himc_membrane_rate(const himc_membrane *membrane)
{
    return membrane->rate;
}

himc_mode himc_membrane_mode(const himc_membrane *membrane, int index)
{
    himc_mode bare = himc_modes_get(membrane->core.modes, &membrane->head, index);
    return himc_membrane_loaded(membrane, &bare);
}

double himc_membrane_principal(const himc_membrane *membrane, const himc_head *head)
{
    bool round = himc_membrane_shape(membrane)->kind == HIMC_CIRCLE;
    double zero =
        round ? himc_bessel_zero(1, 1) : himc_modes_get(membrane->core.modes, head, 0).zero;
    double bare = zero / (2 * HIMC_PI * head->radius) * sqrt(head->tension / head->density);
    if (!head->air)
        return bare;
    himc_air air = himc_air_around(head, himc_head_kettle(head));
    return bare * himc_air_on(&air, 1, 1, zero).frequency;
}

double himc_membrane_tension_for(const himc_membrane *membrane, const himc_head *head,
                                 double frequency)
{
    himc_head trial = *head;
    double low = log(HIMC_TENSION_MIN), high = log(HIMC_TENSION_MAX);
    for (int i = 0; i < 60; i++) {
        trial.tension = exp(0.5 * (low + high));
        if (himc_membrane_principal(membrane, &trial) < frequency)
            low = log(trial.tension);
        else
            high = log(trial.tension);
    }
    return trial.tension;
}

int himc_membrane_audible(const himc_membrane *membrane)
{
    return himc_bank_count(membrane->core.bank);
}

void himc_membrane_watch(himc_membrane *membrane, double x, double y)
{
    if (x == membrane->watch_x && y == membrane->watch_y)
        return;
    membrane->watch_x = x;
    membrane->watch_y = y;
    himc_membrane_aim_watch(membrane);
}

void himc_membrane_push(himc_membrane *membrane, double x, double y, double force)
{
    if (membrane->push_count < PUSHES)
        membrane->pushes[membrane->push_count++] = (push){x, y, force};
}

double himc_membrane_heard(const himc_membrane *membrane)
{
    return membrane->heard[0];
}

double himc_membrane_heard_by(const himc_membrane *membrane, int pickup)
{
    return membrane->heard[pickup];
}

double himc_membrane_seen(const himc_membrane *membrane)
{
    return membrane->seen;
}

double himc_membrane_displacement(const himc_membrane *membrane, double x, double y)
{
    // only the cache of spots changes, which nobody can see
    return himc_strike_point_displacement(
        membrane, himc_membrane_strike_point((himc_membrane *)membrane, x, y));
}

double himc_membrane_energy(const himc_membrane *membrane)
{
    double s = membrane->tension.s;
    return himc_bank_energy(membrane->core.bank) + 0.5 * s * s;
}

void himc_membrane_state(const himc_membrane *membrane, int index, double *q, double *v)
{
    himc_bank_state(membrane->core.bank, index, q, v);
}

void himc_membrane_excite(himc_membrane *membrane, int index, double q, double v)
{
    himc_bank_excite(membrane->core.bank, index, q, v);
    himc_membrane_find_tension(membrane);
}

void himc_membrane_rest(himc_membrane *membrane)
{
    hearings before = listen(membrane);
    himc_bank_rest(membrane->core.bank);
    membrane->tension = (tension){0};
    splice(membrane, before);
}
