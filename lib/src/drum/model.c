/// model.c: a head's model put together from modes, bank and pickups.
///
/// A force f at (x, y) drives mode i with phi_i(x, y) f; the displacement there is sum phi_i q_i.
/// Both use the same phi, from the same table, so work done on the head equals the energy in its
/// modes up to rounding, whatever the table's error. A strike point is computed once and kept while
/// it is used. In air each mode has another frequency, decay and mass but the same shape, or a
/// mixture of shapes (air.h), so all of this holds there too.
///
/// All arrays with an entry for each mode are one block of memory.
#include "drum/model.h"

#include "head/pickup.h"
#include "system/aligned.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// arrays of a model: its own, what rays have in common, those of each output, patch, strike point
#define ARRAYS                                                                       \
    (9 + 2 + 3 + HIMC_RAYS + HIMC_PATCHES + HIMC_OUTPUTS * (3 + HIMC_STEP_LENGTHS) + \
     HIMC_STRIKE_POINTS * 3)
_Static_assert(HIMC_BANK_ALIKE == HIMC_RAYS, "the rays are alike");
#define SLACK 1e-6            // rise per tension; chosen: 0.001 cent
#define SUBSTEP_RATE 192000.0 // (Hz) least rate of substeps; chosen: contact.c
// Exchanges with other heads (air_between.c) take and give velocity at intervals. A mode decays as
// it should whatever its angle w t in one, unless that is near pi, where its velocity would be met
// at the same phase again and again.
#define INTERVAL 0.00075 // (s) chosen: 32 samples of 44.1 and 48 kHz
#define SHARED_ANGLE 2.0 // most of w t of a mode that is shared; chosen: up to 477 Hz

// Young's modulus, Poisson's ratio and density of polyester film (Mylar), typical values; the
// thickness of a head follows from its mass
#define YOUNG 4e9 // (Pa)
#define POISSON 0.38
#define FILM 1390.0 // (kg/m^3)

void himc_model_free(himc_model *model)
{
    if (!model)
        return;
    himc_modes_free(model->modes);
    himc_bank_free(model->bank);
    free(model->oscillators);
    himc_aligned_free(model->memory);
    free(model);
}

// takes the next array from the block; its length keeps the alignment that the bank requires
static double *take(double **memory, int length)
{
    double *array = *memory;
    *memory += length;
    return array;
}

static himc_readout take_readout(double **memory, int length)
{
    double *p = take(memory, length);
    return (himc_readout){.p = p, .s = take(memory, length)};
}

static void share_memory(himc_model *c)
{
    int padded = himc_bank_padded(c->bank);
    double *memory = c->memory;
    double **arrays[] = {&c->on_q, &c->on_v, &c->on_force,      &c->scratch, &c->stretch,
                         &c->wave, &c->most, &c->per_stiffness, &c->per_mass};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        *arrays[i] = take(&memory, padded);
    c->watched = take_readout(&memory, padded);
    for (int i = 0; i < HIMC_OUTPUTS; i++) {
        c->outputs[i].readout = take_readout(&memory, padded);
        c->outputs[i].readout.film = take(&memory, padded);
        for (int k = 0; k < HIMC_STEP_LENGTHS; k++)
            c->outputs[i].response[k] = take(&memory, padded);
    }
    c->rays.form = take_readout(&memory, padded);
    c->rays.form.film = take(&memory, padded);
    for (int i = 0; i < HIMC_RAYS; i++) {
        c->rays.gain[i] = take(&memory, padded);
        c->rays.readout[i] = &c->outputs[HIMC_PICKUPS + i].readout;
        if (c->config.shape.kind->form)
            c->rays.readout[i]->alike = &c->rays;
    }
    for (int i = 0; i < HIMC_PATCHES; i++)
        c->patches[i].weight = take(&memory, padded);
    for (int i = 0; i < HIMC_STRIKE_POINTS; i++)
        c->points[i] = (strike_point){.shape = take(&memory, padded),
                                      .readout = take_readout(&memory, padded)};
}

// the numbers of a model of the same config, without its state
static void copy(himc_model *c, const himc_model *from)
{
    size_t row = sizeof(double) * (size_t)himc_bank_padded(c->bank);
    himc_bank_copy(c->bank, from->bank);
    memcpy(c->memory, from->memory, row * ARRAYS);
    memcpy(c->oscillators, from->oscillators,
           sizeof *c->oscillators * (size_t)himc_modes_count(c->modes));
    memcpy(c->shared, from->shared, sizeof c->shared);
    c->shared_count = from->shared_count;
    c->air = from->air;
    c->config.muted = from->config.muted;
    c->rays.form.direct = from->rays.form.direct;
    for (int i = 0; i < HIMC_OUTPUTS; i++)
        c->outputs[i].readout.direct = from->outputs[i].readout.direct;
}

himc_model *himc_model_new(const himc_membrane_config *config, const himc_model *like,
                           himc_error *error)
{
    if (!himc_membrane_config_check(config, error))
        return NULL;
    himc_model *c = calloc(1, sizeof *c);
    if (!c) {
        himc_error_set(error, "head: out of memory");
        return NULL;
    }
    c->config = *config;
    c->modes = like && himc_model_has_room(like, config)
                   ? himc_modes_copy(like->modes, error)
                   : himc_modes_new(&config->shape, config->head.modes, error);
    int count = c->modes ? himc_modes_count(c->modes) : 0;
    c->bank = c->modes ? himc_bank_new(count, error) : NULL;
    c->oscillators = malloc(sizeof *c->oscillators * (size_t)count);
    size_t bytes = sizeof(double) * (size_t)(c->bank ? himc_bank_padded(c->bank) : 0) * ARRAYS;
    c->memory = himc_aligned_new(bytes);
    if (!c->bank || !c->oscillators || !c->memory) {
        himc_error_set(error, "modes: no memory for %d modes", count);
        himc_model_free(c);
        return NULL;
    }
    memset(c->memory, 0, bytes);
    share_memory(c);
    if (like && himc_membrane_config_equal(config, &like->config))
        copy(c, like);
    else
        himc_model_make(c, config);
    return c;
}

bool himc_model_has_room(const himc_model *model, const himc_membrane_config *config)
{
    return himc_shape_equal(&model->config.shape, &config->shape) &&
           model->config.head.modes == config->head.modes;
}

double himc_model_film_stiffness(const himc_model *m)
{
    const himc_shape *shape = &m->config.shape;
    double thickness = m->config.head.density / FILM, radius = m->config.head.radius;
    double area = radius * radius * shape->kind->film(shape);
    if (!(area > 0))
        return 0;
    return m->config.head.glide * YOUNG * thickness / (2 * (1 - POISSON * POISSON) * area);
}

int himc_membrane_substeps(double rate)
{
    return (int)ceil(SUBSTEP_RATE / rate);
}

// Oscillators of all modes, what strike points need of the bare ones, and a_i = sqrt(2 kappa) Lam_i
// of the film; Lam_i is the stiffness of a mode's film per tension. The members of a pair have one
// load.
static void find_oscillators(himc_model *m)
{
    double root = sqrt(2 * himc_model_film_stiffness(m));
    const himc_kind *kind = m->config.shape.kind;
    himc_air_load load = {0};
    for (int i = 0; i < HIMC_PATCHES; i++)
        m->patches[i].b = 0;
    for (int i = 0; i < himc_modes_count(m->modes); i++) {
        himc_mode mode = himc_modes_get(m->modes, &m->config.head, i);
        m->most[i] = kind->largest ? kind->largest(&mode) : INFINITY;
        m->wave[i] = mode.zero / m->config.head.radius;
        double stretch = root * mode.stiffness / m->config.head.tension;
        m->per_stiffness[i] = 1 / mode.stiffness;
        m->per_mass[i] = 1 / mode.mass;
        if (m->config.head.air && !mode.sine)
            load = himc_air_on(&m->air, mode.m, mode.n, mode.zero);
        m->stretch[i] = m->config.head.air ? stretch * load.stretch : stretch;
        if (m->config.head.air)
            mode = himc_air_loaded(&load, &m->config.head, &mode);
        m->oscillators[i] = (himc_oscillator){2 * HIMC_PI * mode.frequency, mode.decay, mode.mass};
    }
    const himc_mixture *mix = himc_modes_mixture(m->modes);
    for (int n = 0; n < mix->count; n++)
        for (int k = 0; k < mix->count; k++)
            m->most[mix->index[n]] += k == n ? 0 : fabs(mix->part[n][k]);
}

// the modes that other heads hear, and what the air between takes of their decay
static void find_shared(himc_model *m)
{
    int interval = himc_membrane_interval(m->config.rate);
    bool shares = m->config.shares && m->config.head.air;
    double highest = SHARED_ANGLE * m->config.rate / (2 * HIMC_PI * interval);
    m->shared_count =
        shares ? himc_shared_find(&m->config.head, m->modes, &m->air, highest, m->shared) : 0;
    for (int i = 0; i < m->shared_count; i++)
        m->oscillators[m->shared[i].index].decay -= m->shared[i].decay;
    himc_bank_set_pass(m->bank, shares ? interval : HIMC_BANK_PASS);
}

int himc_membrane_interval(double rate)
{
    int samples = HIMC_BANK_PASS;
    while (samples > 8 && samples > INTERVAL * rate)
        samples /= 2;
    return samples;
}

// as its oscillator has it
static himc_mode sounding_mode(const himc_model *m, int i)
{
    const himc_oscillator *o = &m->oscillators[i];
    himc_mode mode = himc_modes_get(m->modes, &m->config.head, i);
    mode.frequency = o->omega / (2 * HIMC_PI);
    mode.decay = o->decay;
    mode.mass = o->mass;
    return mode;
}

static void find_output(himc_model *m, int index)
{
    const himc_pickup *pickup = &m->config.pickups[index];
    double unit = index < HIMC_PICKUPS ? 1 : pickup->distance; // rays are as loud as at 1 m
    if (pickup->kind == HIMC_PICKUP_POINT) {
        himc_modes_shapes(m->modes, m->config.head.radius, pickup->x, pickup->y, m->scratch);
        himc_modes_mix(m->modes, m->scratch);
    }
    for (int i = 0; i < himc_modes_count(m->modes); i++) {
        himc_mode mode = sounding_mode(m, i);
        pickup_weights w =
            himc_pickup_weights(pickup, &m->config.head, m->modes, i, &mode, m->scratch[i]);
        m->on_q[i] = unit * w.displacement;
        m->on_v[i] = unit * w.velocity;
        m->on_force[i] = unit * w.force;
        if (index >= HIMC_PICKUPS)
            m->rays.gain[index - HIMC_PICKUPS][i] = unit * w.gain;
    }
    himc_output *o = &m->outputs[index];
    himc_bank_readout(m->bank, m->on_q, m->on_v,
                      pickup->kind == HIMC_PICKUP_AIR ? m->on_force : NULL, &o->readout);
    // responses to modal forces: through the state and, for accelerations, direct ones
    for (int k = 0; k < HIMC_STEP_LENGTHS; k++) {
        himc_bank_set_step(m->bank, (himc_step_length)k);
        himc_bank_step_response(m->bank, &o->readout, o->response[k]);
        for (int i = 0; i < himc_bank_count(m->bank); i++)
            o->response[k][i] += m->on_force[i];
    }
    himc_bank_set_step(m->bank, HIMC_STEP_SAMPLE);
}

void himc_model_find_outputs(himc_model *m, int first, int end)
{
    for (int i = 0; i < HIMC_STRIKE_POINTS; i++)
        m->points[i].used = false;
    for (int i = first; i < end; i++)
        if (himc_membrane_config_has(&m->config, i))
            find_output(m, i);
    if (end <= HIMC_PICKUPS || !m->config.rays || !m->config.shape.kind->form)
        return;
    for (int i = 0; i < himc_modes_count(m->modes); i++) { // what all rays have in common
        himc_mode mode = sounding_mode(m, i);
        pickup_weights w = m->config.shape.kind->form(&mode);
        m->on_q[i] = w.displacement;
        m->on_v[i] = w.velocity;
        m->on_force[i] = w.force;
    }
    himc_bank_readout(m->bank, m->on_q, m->on_v, m->on_force, &m->rays.form);
}

void himc_model_watch(himc_model *m, double x, double y)
{
    himc_modes_shapes(m->modes, m->config.head.radius, x, y, m->scratch);
    himc_modes_mix(m->modes, m->scratch);
    himc_bank_readout(m->bank, m->scratch, NULL, NULL, &m->watched);
}

void himc_model_make(himc_model *m, const himc_membrane_config *config)
{
    bool muted = m->config.muted;
    m->config = *config;
    m->config.shape = *himc_modes_shape(m->modes); // it has the grid
    m->config.muted = muted;
    himc_membrane_config_keep_pickups(&m->config);
    const himc_head *head = &m->config.head;
    himc_modes_set_lugs(m->modes, head->uniformity, head->uniformity_seed);
    m->air = himc_air_over(head);
    himc_mixture mixture = himc_air_mixture(&m->air);
    himc_modes_mix_as(m->modes, head->air ? &mixture : NULL);
    find_oscillators(m);
    find_shared(m);
    himc_bank_set_substeps(m->bank, himc_membrane_substeps(m->config.rate));
    himc_bank_set(m->bank, m->oscillators, himc_modes_count(m->modes), m->config.rate);
    // off while it could not raise the tension by SLACK of it, even with twice the energy
    double stiffness = himc_model_film_stiffness(m);
    himc_bank_set_film(m->bank, stiffness > 0 ? m->stretch : NULL,
                       SLACK * head->tension * head->tension / (2 * stiffness));
    himc_model_find_outputs(m, 0, HIMC_OUTPUTS);
}
