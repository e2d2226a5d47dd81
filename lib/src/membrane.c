/// membrane.c: modes, bank, ear and spots put together.
///
/// A force f at (x, y) drives mode i with phi_i(x, y) f; the displacement there is sum phi_i q_i.
/// Both use the same phi, from the same table, so work done on the head is energy in its modes to
/// the last bit but rounding, whatever the table's error. A place is looked up or computed once
/// (spot.h) and kept while it is used.
#include "spot.h"

#include "fade.h"
#include "pickup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PUSHES 8

// what depends on the number of modes and is allocated with it
typedef struct core {
    himc_modes *modes;
    himc_bank *bank;
    himc_oscillator *oscillators;   // (modes)
    double *memory;                 // all arrays below, (padded) each, and the spots'
    double *on_q, *on_v, *on_force; // what the ear hears of each mode
    double *scratch;
    himc_tap ear, watch;
} core;

typedef struct push {
    double x, y, force;
} push;

struct himc_membrane {
    himc_head head;
    himc_pickup pickup;
    double rate;
    core core;
    double watch_x, watch_y;
    spot spots[SPOTS];
    unsigned long clock; // of the spots' use
    push pushes[PUSHES];
    int push_count;
    fade fade;
    double heard, seen; // of the last sample
};

static void core_free(core *c)
{
    himc_modes_free(c->modes);
    himc_bank_free(c->bank);
    free(c->oscillators);
    free(c->memory);
}

// hands out arrays of zeros, aligned as the bank likes them
static double *take(double **memory, int length)
{
    double *array = *memory;
    *memory += length;
    return array;
}

static bool core_new(core *c, spot spots[SPOTS], int count, himc_error *error)
{
    *c = (core){.modes = himc_modes_new(count, error), .bank = himc_bank_new(count, error)};
    c->oscillators = malloc(sizeof *c->oscillators * (size_t)count);
    int padded = c->bank ? himc_bank_padded(c->bank) : 0;
    size_t bytes = sizeof(double) * (size_t)padded * (8 + 3 * SPOTS);
    double *memory = c->memory = aligned_alloc(64, (bytes + 63) / 64 * 64);
    if (!c->modes || !c->bank || !c->oscillators || !memory) {
        core_free(c);
        return himc_error_set(error, "modes: no memory for %d modes", count);
    }
    memset(memory, 0, bytes);
    c->on_q = take(&memory, padded);
    c->on_v = take(&memory, padded);
    c->on_force = take(&memory, padded);
    c->scratch = take(&memory, padded);
    c->ear = (himc_tap){take(&memory, padded), take(&memory, padded)};
    c->watch = (himc_tap){take(&memory, padded), take(&memory, padded)};
    for (int i = 0; i < SPOTS; i++) {
        double *shape = take(&memory, padded), *p = take(&memory, padded),
               *s = take(&memory, padded);
        spots[i] = (spot){.shape = shape, .tap = {p, s}};
    }
    return true;
}

static void find_oscillators(himc_membrane *m)
{
    for (int i = 0; i < m->head.modes; i++) {
        himc_mode mode = himc_modes_get(m->core.modes, &m->head, i);
        m->core.oscillators[i] =
            (himc_oscillator){2 * HIMC_PI * mode.frequency, mode.decay, mode.mass};
    }
}

// sound per newton at a spot: through the state and, for accelerations, directly
static double response(const himc_membrane *m, const double *shape)
{
    double direct = 0;
    for (int i = 0; i < himc_bank_count(m->core.bank); i++)
        direct += m->core.on_force[i] * shape[i];
    return himc_bank_response(m->core.bank, shape, &m->core.ear) + direct;
}

static void aim_watch(himc_membrane *m)
{
    core *c = &m->core;
    himc_modes_shapes(c->modes, m->head.radius, m->watch_x, m->watch_y, c->scratch);
    himc_bank_tap(c->bank, c->scratch, NULL, &c->watch);
    for (int i = 0; i < SPOTS; i++)
        if (m->spots[i].used)
            m->spots[i].seen = himc_bank_response(c->bank, m->spots[i].shape, &c->watch);
}

static void aim_ear(himc_membrane *m)
{
    core *c = &m->core;
    himc_modes_shapes(c->modes, m->head.radius, m->pickup.x, m->pickup.y, c->scratch);
    for (int i = 0; i < m->head.modes; i++) {
        himc_mode mode = himc_modes_get(c->modes, &m->head, i);
        hearing h = himc_pickup_hears(&m->pickup, &m->head, &mode, c->scratch[i]);
        c->on_q[i] = h.displacement;
        c->on_v[i] = h.velocity;
        c->on_force[i] = h.force;
    }
    himc_bank_tap(c->bank, c->on_q, c->on_v, &c->ear);
    for (int i = 0; i < SPOTS; i++)
        if (m->spots[i].used)
            m->spots[i].heard = response(m, m->spots[i].shape);
}

// after head or rate changed: oscillators, taps; spots are computed again when asked for
static void retune(himc_membrane *m)
{
    find_oscillators(m);
    himc_bank_set(m->core.bank, m->core.oscillators, m->head.modes, m->rate);
    for (int i = 0; i < SPOTS; i++)
        m->spots[i].used = false;
    aim_ear(m);
    aim_watch(m);
}

static sound listen(const himc_membrane *m)
{
    const core *c = &m->core;
    return (sound){himc_bank_read(c->bank, &c->ear) + fade_at(&m->fade, m->fade.at - 1),
                   himc_bank_peek(c->bank, &c->ear) + fade_at(&m->fade, m->fade.at)};
}

// makes the sound go on from `before`
static void splice(himc_membrane *m, sound before)
{
    m->fade = (fade){0};
    m->fade = fade_between(before, listen(m), m->rate);
}

himc_membrane *himc_membrane_new(const himc_head *head, double rate, himc_error *error)
{
    if (!himc_head_check(head, error) ||
        !himc_check_range("sample rate", rate, 4000, 384000, "Hz", error))
        return NULL;
    himc_membrane *m = calloc(1, sizeof *m);
    if (!m || !core_new(&m->core, m->spots, head->modes, error)) {
        if (!m)
            himc_error_set(error, "membrane: no memory");
        free(m);
        return NULL;
    }
    m->head = *head;
    m->pickup = himc_pickup_default();
    m->rate = rate;
    retune(m);
    return m;
}

void himc_membrane_free(himc_membrane *membrane)
{
    if (!membrane)
        return;
    core_free(&membrane->core);
    free(membrane);
}

// another number of modes: the common ones go on in new arrays
static bool resize(himc_membrane *m, int count, himc_error *error)
{
    core old = m->core, fresh;
    if (!core_new(&fresh, m->spots, count, error))
        return false;
    int common = count < m->head.modes ? count : m->head.modes;
    himc_bank_set(fresh.bank, old.oscillators, common, m->rate);
    for (int i = 0; i < common; i++) {
        double q, v;
        himc_bank_state(old.bank, i, &q, &v);
        himc_bank_excite(fresh.bank, i, q, v);
    }
    m->core = fresh;
    core_free(&old);
    return true;
}

bool himc_membrane_set_head(himc_membrane *membrane, const himc_head *head, himc_error *error)
{
    if (!himc_head_check(head, error))
        return false;
    sound before = listen(membrane);
    if (head->modes != membrane->head.modes && !resize(membrane, head->modes, error))
        return false;
    membrane->head = *head;
    retune(membrane);
    splice(membrane, before);
    return true;
}

bool himc_membrane_set_pickup(himc_membrane *membrane, const himc_pickup *pickup, himc_error *error)
{
    if (!himc_pickup_check(pickup, &membrane->head, error))
        return false;
    sound before = listen(membrane);
    membrane->pickup = *pickup;
    aim_ear(membrane);
    splice(membrane, before);
    return true;
}

bool himc_membrane_set_rate(himc_membrane *membrane, double rate, himc_error *error)
{
    if (!himc_check_range("sample rate", rate, 4000, 384000, "Hz", error))
        return false;
    sound before = listen(membrane);
    before.next = before.now + (before.next - before.now) * (membrane->rate / rate);
    membrane->rate = rate;
    retune(membrane);
    splice(membrane, before);
    return true;
}

const himc_head *himc_membrane_head(const himc_membrane *membrane)
{
    return &membrane->head;
}

const himc_pickup *himc_membrane_pickup(const himc_membrane *membrane)
{
    return &membrane->pickup;
}

double himc_membrane_rate(const himc_membrane *membrane)
{
    return membrane->rate;
}

himc_mode himc_membrane_mode(const himc_membrane *membrane, int index)
{
    return himc_modes_get(membrane->core.modes, &membrane->head, index);
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
    aim_watch(membrane);
}

void himc_membrane_push(himc_membrane *membrane, double x, double y, double force)
{
    if (membrane->push_count < PUSHES)
        membrane->pushes[membrane->push_count++] = (push){x, y, force};
}

// finds the spot's shapes and what a newton there does
static void place_spot(himc_membrane *m, spot *s, double x, double y)
{
    const core *c = &m->core;
    s->used = true;
    s->x = x;
    s->y = y;
    himc_modes_shapes(c->modes, m->head.radius, x, y, s->shape);
    himc_bank_tap(c->bank, s->shape, NULL, &s->tap);
    s->compliance = himc_bank_response(c->bank, s->shape, &s->tap);
    s->heard = response(m, s->shape);
    s->seen = himc_bank_response(c->bank, s->shape, &c->watch);
}

spot *himc_membrane_spot(himc_membrane *membrane, double x, double y)
{
    spot *oldest = &membrane->spots[0];
    for (int i = 0; i < SPOTS; i++) {
        spot *s = &membrane->spots[i];
        if (s->used && s->x == x && s->y == y) {
            s->age = ++membrane->clock;
            return s;
        }
        if (!s->used || (oldest->used && s->age < oldest->age))
            oldest = s;
    }
    place_spot(membrane, oldest, x, y);
    oldest->age = ++membrane->clock;
    return oldest;
}

double himc_spot_displacement(const himc_membrane *membrane, const spot *s)
{
    return himc_bank_displacement(membrane->core.bank, &s->tap);
}

double himc_spot_compliance(const himc_membrane *membrane, const spot *a, const spot *b)
{
    return himc_bank_response(membrane->core.bank, b->shape, &a->tap);
}

void himc_spot_apply(himc_membrane *membrane, const spot *s, double force)
{
    if (force == 0)
        return;
    himc_bank_push(membrane->core.bank, s->shape, force);
    membrane->heard += s->heard * force;
    membrane->seen += s->seen * force;
}

// n samples of the bank, the fade added
static void advance(himc_membrane *m, int n, double *heard, double *seen)
{
    himc_bank_run(m->core.bank, n, &m->core.ear, &m->core.watch, heard, seen);
    for (int i = 0; i < n && m->fade.at < m->fade.length; i++)
        heard[i] += fade_at(&m->fade, m->fade.at++);
    m->heard = heard[n - 1];
    m->seen = seen[n - 1];
}

void himc_membrane_free_step(himc_membrane *membrane)
{
    double heard, seen;
    advance(membrane, 1, &heard, &seen);
    for (int i = 0; i < membrane->push_count; i++) {
        const push *p = &membrane->pushes[i];
        himc_spot_apply(membrane, himc_membrane_spot(membrane, p->x, p->y), -p->force);
    }
    membrane->push_count = 0;
}

void himc_membrane_run(himc_membrane *membrane, int n, double *heard, double *seen)
{
    if (n > 0 && membrane->push_count > 0) {
        himc_membrane_free_step(membrane);
        *heard++ = membrane->heard;
        *seen++ = membrane->seen;
        n--;
    }
    if (n > 0)
        advance(membrane, n, heard, seen);
}

double himc_membrane_heard(const himc_membrane *membrane)
{
    return membrane->heard;
}

double himc_membrane_seen(const himc_membrane *membrane)
{
    return membrane->seen;
}

double himc_membrane_displacement(const himc_membrane *membrane, double x, double y)
{
    // only the cache of spots changes, which nobody can see
    return himc_spot_displacement(membrane, himc_membrane_spot((himc_membrane *)membrane, x, y));
}

double himc_membrane_energy(const himc_membrane *membrane)
{
    return himc_bank_energy(membrane->core.bank);
}

void himc_membrane_state(const himc_membrane *membrane, int index, double *q, double *v)
{
    himc_bank_state(membrane->core.bank, index, q, v);
}

void himc_membrane_excite(himc_membrane *membrane, int index, double q, double v)
{
    himc_bank_excite(membrane->core.bank, index, q, v);
}

void himc_membrane_rest(himc_membrane *membrane)
{
    sound before = listen(membrane);
    himc_bank_rest(membrane->core.bank);
    splice(membrane, before);
}
