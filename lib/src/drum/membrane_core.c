/// membrane_core.c: a membrane's modes, bank and ears as they follow from its head, rate and
/// pickups.
///
/// The arrays whose length is the number of modes are one block of memory, so that another number
/// is another core, made aside and exchanged. Whatever of head, rate or pickups changes, retuning
/// computes oscillators and taps anew from the same tables; the bank keeps energy and phase.
#include "drum/membrane_state.h"

#include "drum/pickup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Mylar: Young's modulus, Poisson's ratio and density of the film, whose thickness follows from its
// mass
#define YOUNG 4e9    // (Pa)
#define POISSON 0.38 //
#define FILM 1390.0  // (kg/m^3)

void himc_core_free(core *c)
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

static himc_readout take_tap(double **memory, int length)
{
    double *p = take(memory, length);
    return (himc_readout){p, take(memory, length)};
}

bool himc_core_new(core *c, spot spots[SPOTS], const himc_shape *shape, int count,
                   himc_error *error)
{
    *c = (core){.modes = himc_modes_new_of(shape, count, error),
                .bank = himc_bank_new(count, error)};
    c->oscillators = malloc(sizeof *c->oscillators * (size_t)count);
    int padded = c->bank ? himc_bank_padded(c->bank) : 0;
    size_t bytes = sizeof(double) * (size_t)padded * (11 + 4 * HIMC_PICKUPS + 3 * SPOTS);
    double *memory = c->memory = aligned_alloc(64, (bytes + 63) / 64 * 64);
    if (!c->modes || !c->bank || !c->oscillators || !memory) {
        if (c->modes)
            himc_error_set(error, "modes: no memory for %d modes", count);
        himc_core_free(c);
        return false;
    }
    memset(memory, 0, bytes);
    c->on_q = take(&memory, padded);
    c->on_v = take(&memory, padded);
    c->on_force = take(&memory, padded);
    c->scratch = take(&memory, padded);
    for (int g = 0; g < HIMC_BANK_SUBSTEPS; g++)
        c->watch_answer[g] = take(&memory, padded);
    c->stretch = take(&memory, padded);
    c->weight = take(&memory, padded);
    c->pull.shape = take(&memory, padded);
    c->watch = take_tap(&memory, padded);
    for (int i = 0; i < HIMC_PICKUPS; i++) {
        c->ears[i].tap = take_tap(&memory, padded);
        for (int g = 0; g < HIMC_BANK_SUBSTEPS; g++)
            c->ears[i].answer[g] = take(&memory, padded);
    }
    for (int i = 0; i < SPOTS; i++)
        spots[i] = (spot){.shape = take(&memory, padded), .tap = take_tap(&memory, padded)};
    return true;
}

double himc_head_kettle(const himc_head *head)
{
    return head->kettle > 0 ? head->kettle : himc_air_kettle(head->radius);
}

himc_mode himc_membrane_loaded(const himc_membrane *m, const himc_mode *bare)
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
        himc_mode mode = himc_membrane_loaded(m, &bare);
        c->oscillators[i] = (himc_oscillator){2 * HIMC_PI * mode.frequency, mode.decay, mode.mass};
    }
}

void himc_membrane_aim_watch(himc_membrane *m)
{
    core *c = &m->core;
    himc_modes_shapes(c->modes, m->head.radius, m->watch_x, m->watch_y, c->scratch);
    himc_bank_readout(c->bank, c->scratch, NULL, &c->watch);
    for (int g = 0; g < HIMC_BANK_SUBSTEPS; g++) {
        himc_bank_set_substep(c->bank, g);
        himc_bank_step_response(c->bank, &c->watch, c->watch_answer[g]);
        for (int i = 0; i < SPOTS; i++)
            if (m->spots[i].used)
                m->spots[i].effect[g].seen =
                    himc_bank_sum(c->bank, m->spots[i].shape, c->watch_answer[g]);
    }
    himc_bank_set_substep(c->bank, m->gear);
}

void himc_membrane_aim_ear(himc_membrane *m, int index)
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
    himc_bank_readout(c->bank, c->on_q, c->on_v, &e->tap);
    // through the state and, for accelerations, directly
    for (int g = 0; g < HIMC_BANK_SUBSTEPS; g++) {
        himc_bank_set_substep(c->bank, g);
        himc_bank_step_response(c->bank, &e->tap, e->answer[g]);
        for (int i = 0; i < himc_bank_count(c->bank); i++)
            e->answer[g][i] += c->on_force[i];
        for (int i = 0; i < SPOTS; i++)
            if (m->spots[i].used)
                m->spots[i].effect[g].heard[index] =
                    himc_bank_sum(c->bank, m->spots[i].shape, e->answer[g]);
    }
    himc_bank_set_substep(c->bank, m->gear);
}

void himc_membrane_find_tension(himc_membrane *m)
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

void himc_membrane_retune(himc_membrane *m)
{
    core *c = &m->core;
    m->air = himc_air_around(&m->head, himc_head_kettle(&m->head));
    find_oscillators(m);
    himc_bank_divide(c->bank, himc_membrane_parts(m));
    himc_bank_set(c->bank, c->oscillators, m->head.modes, m->rate);
    himc_bank_weigh(c->bank, c->stretch, c->weight);
    for (int i = 0; i < SPOTS; i++)
        m->spots[i].used = false;
    for (int i = 0; i < m->pickup_count; i++)
        himc_membrane_aim_ear(m, i);
    himc_membrane_aim_watch(m);
    if (m->tension.on || m->head.glide > 0)
        himc_membrane_find_tension(m);
}

// On a slacker head the same energy of bending is a deeper bend, and the film's stretching goes
// with its fourth power. What would be more than `before` (J) in all is taken back: every mode is
// bent less, by the root of x, the positive solution of bending x + stretching x^2 = what there is
// to spend.
void himc_membrane_keep_energy(himc_membrane *m, double before)
{
    himc_bank *bank = m->core.bank;
    double bending = 0, stretching = 0.5 * m->tension.s * m->tension.s, q, v;
    double excess = himc_membrane_energy(m) - before;
    if (!(excess > 1e-12 * before))
        return;
    for (int i = 0; i < himc_bank_count(bank); i++) {
        const himc_oscillator *o = &m->core.oscillators[i];
        himc_bank_state(bank, i, &q, &v);
        bending += 0.5 * o->mass * o->omega * o->omega * q * q;
    }
    double spend = fmax(bending + stretching - excess, 0);
    double x = 2 * spend / (bending + sqrt(bending * bending + 4 * stretching * spend));
    for (int i = 0; i < himc_bank_count(bank); i++) {
        himc_bank_state(bank, i, &q, &v);
        himc_bank_excite(bank, i, sqrt(x) * q, v);
    }
    himc_membrane_find_tension(m);
}
