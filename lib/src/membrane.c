/// membrane.c: what a membrane is: modes, bank, ears and spots put together, and changed as it
/// sounds.
///
/// A force f at (x, y) drives mode i with phi_i(x, y) f; the displacement there is sum phi_i q_i.
/// Both use the same phi, from the same table, so work done on the head is energy in its modes to
/// the last bit but rounding, whatever the table's error. A place is looked up or computed once
/// (spot.h) and kept while it is used. In air each mode has another frequency, decay and mass and
/// keeps its shape (air.h), so all of this holds there too.
#include "membrane_state.h"

#include "bessel.h"
#include "pickup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Mylar: Young's modulus, Poisson's ratio and density of the film, whose thickness follows from its
// mass
#define YOUNG 4e9    // (Pa)
#define POISSON 0.38 //
#define FILM 1390.0  // (kg/m^3)

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

static himc_tap take_tap(double **memory, int length)
{
    double *p = take(memory, length);
    return (himc_tap){p, take(memory, length)};
}

static bool core_new(core *c, spot spots[SPOTS], const himc_shape *shape, int count,
                     himc_error *error)
{
    *c = (core){.modes = himc_modes_new_of(shape, count, error),
                .bank = himc_bank_new(count, error)};
    c->oscillators = malloc(sizeof *c->oscillators * (size_t)count);
    int padded = c->bank ? himc_bank_padded(c->bank) : 0;
    size_t bytes = sizeof(double) * (size_t)padded * (10 + 3 * (HIMC_PICKUPS + SPOTS));
    double *memory = c->memory = aligned_alloc(64, (bytes + 63) / 64 * 64);
    if (!c->modes || !c->bank || !c->oscillators || !memory) {
        if (c->modes)
            himc_error_set(error, "modes: no memory for %d modes", count);
        core_free(c);
        return false;
    }
    memset(memory, 0, bytes);
    c->on_q = take(&memory, padded);
    c->on_v = take(&memory, padded);
    c->on_force = take(&memory, padded);
    c->scratch = take(&memory, padded);
    c->watch_answer = take(&memory, padded);
    c->stretch = take(&memory, padded);
    c->weight = take(&memory, padded);
    c->pull.shape = take(&memory, padded);
    c->watch = take_tap(&memory, padded);
    for (int i = 0; i < HIMC_PICKUPS; i++)
        c->ears[i] = (ear){take_tap(&memory, padded), take(&memory, padded)};
    for (int i = 0; i < SPOTS; i++)
        spots[i] = (spot){.shape = take(&memory, padded), .tap = take_tap(&memory, padded)};
    return true;
}

static double kettle_of(const himc_head *head)
{
    return head->kettle > 0 ? head->kettle : himc_air_kettle(head->radius);
}

// a mode as it sounds
static himc_mode loaded(const himc_membrane *m, const himc_mode *bare)
{
    return m->head.air ? himc_air_mode(&m->air, &m->head, bare) : *bare;
}

double himc_membrane_film(const himc_membrane *m)
{
    double thickness = m->head.density / FILM;
    double area = himc_modes_area(m->core.modes, m->head.radius);
    return m->head.glide * YOUNG * thickness / (2 * (1 - POISSON * POISSON) * area);
}

// frequencies, decays and masses, and how the film is stretched: Lam_i is a bare mode's stiffness
// per tension
static void find_oscillators(himc_membrane *m)
{
    core *c = &m->core;
    double root = sqrt(2 * himc_membrane_film(m));
    for (int i = 0; i < m->head.modes; i++) {
        himc_mode bare = himc_modes_get(c->modes, &m->head, i);
        c->stretch[i] = root * bare.stiffness / m->head.tension;
        // both of a pair are alike
        if (bare.sine && i > 0) {
            c->oscillators[i] = c->oscillators[i - 1];
            continue;
        }
        himc_mode mode = loaded(m, &bare);
        c->oscillators[i] = (himc_oscillator){2 * HIMC_PI * mode.frequency, mode.decay, mode.mass};
    }
}

static void aim_watch(himc_membrane *m)
{
    core *c = &m->core;
    himc_modes_shapes(c->modes, m->head.radius, m->watch_x, m->watch_y, c->scratch);
    himc_bank_tap(c->bank, c->scratch, NULL, &c->watch);
    himc_bank_answer(c->bank, &c->watch, c->watch_answer);
    for (int i = 0; i < SPOTS; i++)
        if (m->spots[i].used)
            m->spots[i].seen = himc_bank_sum(c->bank, m->spots[i].shape, c->watch_answer);
}

static void aim_ear(himc_membrane *m, int index)
{
    core *c = &m->core;
    ear *e = &c->ears[index];
    const himc_pickup *pickup = &m->pickups[index];
    himc_modes_shapes(c->modes, m->head.radius, pickup->x, pickup->y, c->scratch);
    for (int i = 0; i < m->head.modes; i++) {
        const himc_oscillator *o = &c->oscillators[i];
        himc_mode mode = himc_modes_get(c->modes, &m->head, i);
        mode.frequency = o->omega / (2 * HIMC_PI);
        mode.decay = o->decay;
        mode.mass = o->mass;
        hearing h = himc_pickup_hears(pickup, &m->head, c->modes, i, &mode, c->scratch[i]);
        c->on_q[i] = h.displacement;
        c->on_v[i] = h.velocity;
        c->on_force[i] = h.force;
    }
    himc_bank_tap(c->bank, c->on_q, c->on_v, &e->tap);
    // through the state and, for accelerations, directly
    himc_bank_answer(c->bank, &e->tap, e->answer);
    for (int i = 0; i < himc_bank_count(c->bank); i++)
        e->answer[i] += c->on_force[i];
    for (int i = 0; i < SPOTS; i++)
        if (m->spots[i].used)
            m->spots[i].heard[index] = himc_bank_sum(c->bank, m->spots[i].shape, e->answer);
}

// the film's energy as the state has it
static void find_tension(himc_membrane *m)
{
    tension *t = &m->tension;
    t->s = 0;
    for (int i = 0; i < m->head.modes; i++) {
        double q, v;
        himc_bank_state(m->core.bank, i, &q, &v);
        t->s += 0.5 * m->core.stretch[i] * q * q;
    }
    t->on = t->s > 0;
}

// after head or rate changed: oscillators, taps; spots are computed again when asked for
static void retune(himc_membrane *m)
{
    core *c = &m->core;
    m->air = himc_air_around(&m->head, kettle_of(&m->head));
    find_oscillators(m);
    himc_bank_set(c->bank, c->oscillators, m->head.modes, m->rate);
    himc_bank_weigh(c->bank, c->stretch, c->weight);
    for (int i = 0; i < SPOTS; i++)
        m->spots[i].used = false;
    for (int i = 0; i < m->pickup_count; i++)
        aim_ear(m, i);
    aim_watch(m);
    if (m->tension.on || m->head.glide > 0)
        find_tension(m);
}

// what every pickup reads now and next
typedef struct hearings {
    sound of[HIMC_PICKUPS];
} hearings;

static hearings listen(const himc_membrane *m)
{
    hearings h = {0};
    for (int i = 0; i < m->pickup_count; i++) {
        const himc_tap *tap = &m->core.ears[i].tap;
        const fade *f = &m->fades[i];
        h.of[i] = (sound){himc_bank_read(m->core.bank, tap) + fade_at(f, f->at - 1),
                          himc_bank_peek(m->core.bank, tap) + fade_at(f, f->at)};
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
    if (!m ||
        !core_new(&m->core, m->spots, &(himc_shape){.kind = HIMC_CIRCLE}, head->modes, error)) {
        if (!m)
            himc_error_set(error, "membrane: no memory");
        free(m);
        return NULL;
    }
    m->head = *head;
    m->pickups[0] = himc_pickup_default();
    m->pickup_count = 1;
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
    if (!core_new(&fresh, m->spots, himc_modes_outline(old.modes), count, error))
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
    if (!check_head(head, himc_membrane_shape(membrane)->kind, error))
        return false;
    hearings before = listen(membrane);
    if (head->modes != membrane->head.modes && !resize(membrane, head->modes, error))
        return false;
    membrane->head = *head;
    retune(membrane);
    splice(membrane, before);
    return true;
}

bool himc_membrane_set_shape(himc_membrane *membrane, const himc_shape *shape,
                             const himc_head *head, himc_error *error)
{
    core fresh, old = membrane->core;
    spot spots[SPOTS];
    if (!check_head(head, shape->kind, error) ||
        !core_new(&fresh, spots, shape, head->modes, error))
        return false;
    hearings before = listen(membrane);
    memcpy(membrane->spots, spots, sizeof spots);
    membrane->core = fresh;
    membrane->head = *head;
    membrane->tension = (tension){0};
    retune(membrane);
    splice(membrane, before);
    core_free(&old);
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
        aim_ear(membrane, i);
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
    retune(membrane);
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
    return loaded(membrane, &bare);
}

double himc_membrane_principal(const himc_membrane *membrane, const himc_head *head)
{
    bool round = himc_membrane_shape(membrane)->kind == HIMC_CIRCLE;
    double zero =
        round ? himc_bessel_zero(1, 1) : himc_modes_get(membrane->core.modes, head, 0).zero;
    double bare = zero / (2 * HIMC_PI * head->radius) * sqrt(head->tension / head->density);
    if (!head->air)
        return bare;
    himc_air air = himc_air_around(head, kettle_of(head));
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
    aim_watch(membrane);
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
    return himc_spot_displacement(membrane, himc_membrane_spot((himc_membrane *)membrane, x, y));
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
    find_tension(membrane);
}

void himc_membrane_rest(himc_membrane *membrane)
{
    hearings before = listen(membrane);
    himc_bank_rest(membrane->core.bank);
    membrane->tension = (tension){0};
    splice(membrane, before);
}
