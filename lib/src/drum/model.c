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

#include "base/array.h"
#include "head/pickup.h"
#include "system/aligned.h"

#include <math.h>
#include <string.h>

// arrays of a model: its own, of readouts, what rays have in common, those of each output, patch,
// strike point
#define ARRAYS                                                                       \
    (9 + 4 + 3 + HIMC_RAYS + HIMC_PATCHES + HIMC_OUTPUTS * (3 + HIMC_STEP_LENGTHS) + \
     HIMC_STRIKE_POINTS * 3)
_Static_assert(HIMC_BANK_ALIKE == HIMC_RAYS, "the rays are alike");
_Static_assert(HIMC_BANK_ROWS == HIMC_WIRES, "the wires' points are read together");
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

// arrays of a model of that outline
static size_t array_count(const himc_model *c)
{
    return ARRAYS + (himc_shell_takes_wires(c->config.shape.shell) ? HIMC_WIRES : 0);
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
    c->tubes = take_readout(&memory, padded);
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
    c->under.shape = array_count(c) > ARRAYS ? memory : NULL;
}

// the numbers of a model of the same config, without its state
static void copy(himc_model *c, const himc_model *from)
{
    size_t row = sizeof(double) * (size_t)himc_bank_padded(c->bank);
    himc_bank_copy(c->bank, from->bank);
    memcpy(c->memory, from->memory, row * array_count(c));
    memcpy(c->under.compliance, from->under.compliance, sizeof c->under.compliance);
    memcpy(c->under.sound, from->under.sound, sizeof c->under.sound);
    memcpy(c->oscillators, from->oscillators, sizeof *c->oscillators * (size_t)c->modes->count);
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
    himc_model *c = himc_new(sizeof *c, "head", error);
    if (!c)
        return NULL;
    c->config = *config;
    c->modes = like && himc_model_has_room(like, config)
                   ? himc_modes_copy(like->modes, error)
                   : himc_modes_new(&config->shape, config->head.modes, error);
    int count = c->modes ? c->modes->count : 0;
    c->bank = c->modes ? himc_bank_new(count, error) : NULL;
    c->oscillators = malloc(sizeof *c->oscillators * (size_t)count);
    size_t bytes =
        sizeof(double) * (size_t)(c->bank ? himc_bank_padded(c->bank) : 0) * array_count(c);
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

himc_mode himc_model_mode(const himc_model *m, int i)
{
    const himc_oscillator *o = &m->oscillators[i];
    himc_mode mode = himc_modes_get(m->modes, &m->config.head, i);
    mode.frequency = o->omega / (2 * HIMC_PI);
    mode.decay = o->decay;
    mode.mass = o->mass;
    return mode;
}

// mean of numbers of a block's modes by their parts in the energy of the mode in that row
static double mean_of(const himc_uneven_block *block, int row, const double *mass,
                      const double *numbers)
{
    double sum = 0;
    for (int l = 0; l < block->count; l++) {
        double part = block->part[row][l];
        sum += part * part * mass[block->index[l]] * numbers[block->index[l]];
    }
    return sum / mass[block->index[row]];
}

// Makes of the even head's oscillators those of the uneven one: each loses what its parts lose, and
// what it sends in orders that are not its own.
static void mix_orders(himc_model *m)
{
    const himc_head *head = &m->config.head;
    double *stiffness = m->on_q, *mass = m->on_v, *decay = m->on_force, *stretch = m->scratch;
    if (!m->config.shape.kind->air || head->uniformity == 1)
        return;
    int count = m->modes->count, row;
    for (int i = 0; i < count; i++) {
        const himc_oscillator *o = &m->oscillators[i];
        stiffness[i] = o->mass * o->omega * o->omega;
        mass[i] = o->mass;
        decay[i] = o->decay;
        stretch[i] = m->stretch[i];
    }
    himc_uneven_find(m->modes, head->tension, mass, stiffness);
    for (int i = 0; i < count; i++) {
        const himc_uneven_block *block = himc_uneven_of(m->modes, i, &row);
        himc_oscillator *o = &m->oscillators[i];
        if (!block)
            continue;
        o->omega = sqrt(stiffness[i] / mass[i]);
        himc_mode mode = himc_model_mode(m, i);
        o->decay = mean_of(block, row, mass, decay);
        if (head->air)
            o->decay += himc_shared_by_other_orders(head, m->modes, i, &mode);
        o->decay = fmin(o->decay, HIMC_LARGEST_DECAY * o->omega);
        m->stretch[i] = mean_of(block, row, mass, stretch);
    }
    memcpy(m->scratch, m->most, sizeof *m->most * (size_t)count);
    for (int i = 0; i < count; i++) {
        const himc_uneven_block *block = himc_uneven_of(m->modes, i, &row);
        for (int l = 0; block && l < block->count; l++)
            m->most[i] += l == row ? 0 : fabs(block->part[row][l]) * m->scratch[block->index[l]];
    }
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
    for (int i = 0; i < m->modes->count; i++) {
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
    if (kind->sounds)
        kind->sounds(m->modes, &m->config.head, m->oscillators);
    const himc_mixture *mix = &m->modes->mixture;
    for (int n = 0; n < mix->count; n++)
        for (int k = 0; k < mix->count; k++)
            m->most[mix->index[n]] += k == n ? 0 : fabs(mix->part[n][k]);
    mix_orders(m);
}

// the modes that other heads hear, and what the air between takes of their decay
static void find_shared(himc_model *m)
{
    int interval = himc_membrane_interval(m->config.rate);
    bool shares = m->config.shares && m->config.head.air;
    double highest = SHARED_ANGLE * m->config.rate / (2 * HIMC_PI * interval);
    m->shared_count =
        shares ? himc_shared_find(&m->config.head, m->modes, &m->air, highest, m->shared) : 0;
    for (int i = 0; i < m->shared_count; i++) {
        himc_oscillator *o = &m->oscillators[m->shared[i].index];
        o->decay = fmax(o->decay - m->shared[i].decay, 0);
    }
    bool often = shares || m->config.shape.kind->cascade;
    himc_bank_set_pass(m->bank, often ? interval : HIMC_BANK_PASS);
}

int himc_membrane_interval(double rate)
{
    int samples = HIMC_BANK_PASS;
    while (samples > 8 && samples > INTERVAL * rate)
        samples /= 2;
    return samples;
}

// an output of the weights in on_q, on_v, on_force
static void take_weights(himc_model *m, int index)
{
    himc_output *o = &m->outputs[index];
    himc_bank_readout(m->bank, m->on_q, m->on_v,
                      m->config.pickups[index].kind == HIMC_PICKUP_AIR ? m->on_force : NULL,
                      &o->readout);
    // responses to modal forces: through the state and, for accelerations, direct ones
    for (int k = 0; k < HIMC_STEP_LENGTHS; k++) {
        himc_bank_set_step(m->bank, (himc_step_length)k);
        himc_bank_step_response(m->bank, &o->readout, o->response[k]);
        for (int i = 0; i < himc_bank_count(m->bank); i++)
            o->response[k][i] += m->on_force[i];
    }
    himc_bank_set_step(m->bank, HIMC_STEP_SAMPLE);
}

static void find_output(himc_model *m, int index)
{
    const himc_pickup *pickup = &m->config.pickups[index];
    double unit = index < HIMC_PICKUPS ? 1 : pickup->distance; // rays are as loud as at 1 m
    if (pickup->kind == HIMC_PICKUP_POINT) {
        himc_modes_shapes(m->modes, m->config.head.radius, pickup->x, pickup->y, m->scratch);
        himc_modes_mix(m->modes, m->scratch);
    }
    for (int i = 0; i < m->modes->count; i++) {
        himc_mode mode = himc_model_mode(m, i);
        pickup_weights w =
            himc_pickup_weights(pickup, &m->config.head, m->modes, i, &mode, m->scratch[i]);
        m->on_q[i] = unit * w.displacement;
        m->on_v[i] = unit * w.velocity;
        m->on_force[i] = unit * w.force;
        if (index >= HIMC_PICKUPS)
            m->rays.gain[index - HIMC_PICKUPS][i] = unit * w.gain;
    }
    take_weights(m, index);
}

// what all rays have in common
static void find_form(himc_model *m)
{
    if (!m->config.rays || !m->config.shape.kind->form)
        return;
    for (int i = 0; i < m->modes->count; i++) {
        himc_mode mode = himc_model_mode(m, i);
        pickup_weights w = m->config.shape.kind->form(&mode);
        m->on_q[i] = w.displacement;
        m->on_v[i] = w.velocity;
        m->on_force[i] = w.force;
    }
    himc_bank_readout(m->bank, m->on_q, m->on_v, m->on_force, &m->rays.form);
}

static void find_tubes(himc_model *m)
{
    const himc_kind *kind = m->config.shape.kind;
    for (int i = 0; kind->tube && i < m->modes->count; i++) {
        himc_mode mode = himc_model_mode(m, i);
        m->on_v[i] = kind->tube(m->modes, i, &mode);
    }
    if (kind->tube)
        himc_bank_readout(m->bank, NULL, m->on_v, NULL, &m->tubes);
}

// what forces at the wires' points do
static void find_under(himc_model *m)
{
    himc_under *u = &m->under;
    int padded = himc_bank_padded(m->bank);
    for (int k = 0; u->shape && k < HIMC_STEP_LENGTHS; k++) {
        himc_bank_set_step(m->bank, (himc_step_length)k);
        for (int i = 0; i < HIMC_WIRES; i++) {
            const double *shape = u->shape + i * padded;
            himc_bank_readout(m->bank, shape, NULL, NULL, &m->watched);
            for (int j = 0; j <= i; j++)
                u->compliance[k][i][j] = u->compliance[k][j][i] =
                    himc_bank_response(m->bank, u->shape + j * padded, &m->watched);
            for (int o = 0; o < HIMC_OUTPUTS; o++)
                u->sound[k][o][i] = himc_membrane_config_has(&m->config, o)
                                        ? himc_bank_sum(m->bank, shape, m->outputs[o].response[k])
                                        : 0;
        }
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
    if (end > HIMC_PICKUPS)
        find_form(m);
    find_tubes(m);
    find_under(m);
}

void himc_model_watch(himc_model *m, double x, double y)
{
    himc_modes_shapes(m->modes, m->config.head.radius, x, y, m->scratch);
    himc_modes_mix(m->modes, m->scratch);
    himc_bank_readout(m->bank, m->scratch, NULL, NULL, &m->watched);
}

static void set_bank(himc_model *m)
{
    himc_bank_set(m->bank, m->oscillators, m->modes->count, m->config.rate);
    // off while it could not raise the tension by SLACK of it, even with twice the energy
    double stiffness = himc_model_film_stiffness(m), tension = m->config.head.tension;
    himc_bank_set_film(m->bank, stiffness > 0 ? m->stretch : NULL,
                       SLACK * tension * tension / (2 * stiffness));
    const himc_shape *shape = &m->config.shape;
    if (!shape->kind->cascade)
        return;
    himc_cascade cascade = *shape->kind->cascade(shape);
    cascade.rate *= m->config.head.glide;
    himc_bank_set_cascade(m->bank, &cascade);
}

void himc_model_make(himc_model *m, const himc_membrane_config *config)
{
    bool muted = m->config.muted;
    m->config = *config;
    m->config.shape = m->modes->shape; // it has the grid
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
    set_bank(m);
    for (int i = 0; m->under.shape && i < HIMC_WIRES; i++) {
        double *shape = m->under.shape + i * himc_bank_padded(m->bank);
        himc_two_heads_under(m->modes, i, shape);
        himc_modes_mix(m->modes, shape);
    }
    himc_model_find_outputs(m, 0, HIMC_OUTPUTS);
}

static double between(double from, double to, double share)
{
    return from + share * (to - from);
}

// Of an output of a model: the weight on each mode's force and on its velocity, as find_output had
// them; the former into `force` (modes).
static void find_weights(himc_model *m, const himc_output *o, double *force)
{
    himc_bank_set_step(m->bank, HIMC_STEP_SAMPLE);
    himc_bank_step_response(m->bank, &o->readout, force);
    for (int i = 0; i < himc_bank_count(m->bank); i++)
        force[i] = o->response[HIMC_STEP_SAMPLE][i] - force[i];
}

// Of an output in the air, a share of the way to the goal's, into its responses: the pressure per
// acceleration of each mode, in phase with it, and a quarter of a period apart. Unlike the weights
// that follow from them these change slowly with the tension, and sound and force keep together.
static void approach_pressures(himc_model *m, himc_model *goal, int index, double share)
{
    himc_output *o = &m->outputs[index];
    const himc_output *to = &goal->outputs[index];
    find_weights(m, o, m->on_q);
    find_weights(goal, to, m->on_v);
    for (int i = 0; i < himc_bank_count(m->bank); i++) {
        const himc_oscillator *a = &m->oscillators[i], *b = &goal->oscillators[i];
        double even = m->on_q[i] * a->mass, goal_even = m->on_v[i] * b->mass;
        double odd = (o->readout.s[i] + 2 * a->decay * even) / a->omega;
        double goal_odd = (to->readout.s[i] + 2 * b->decay * goal_even) / b->omega;
        o->response[0][i] = between(even, goal_even, share);
        o->response[1][i] = between(odd, goal_odd, share);
    }
}

// the weights that follow from the pressures
static void weigh_pressures(himc_model *m, int index)
{
    const himc_output *o = &m->outputs[index];
    bool air = m->config.pickups[index].kind == HIMC_PICKUP_AIR;
    for (int i = 0; i < himc_bank_count(m->bank); i++) {
        const himc_oscillator *by = &m->oscillators[i];
        double even = o->response[0][i], odd = o->response[1][i];
        m->on_q[i] = air ? -even * by->omega * by->omega : 0;
        m->on_v[i] = air ? by->omega * odd - 2 * by->decay * even : o->readout.s[i];
        m->on_force[i] = air ? even / by->mass : 0;
    }
    take_weights(m, index);
}

_Static_assert(HIMC_STEP_LENGTHS >= 2, "a response for each of two pressures");

void himc_model_approach(himc_model *m, himc_model *goal, double share)
{
    double before = m->config.head.tension;
    for (int k = 0; k < HIMC_OUTPUTS; k++)
        if (himc_membrane_config_has(&m->config, k) && m->config.pickups[k].kind == HIMC_PICKUP_AIR)
            approach_pressures(m, goal, k, share);
    m->config.head.tension *= pow(goal->config.head.tension / before, share);
    for (int i = 0; i < m->modes->count; i++) {
        himc_oscillator *o = &m->oscillators[i];
        const himc_oscillator *to = &goal->oscillators[i];
        o->omega *= pow(to->omega / o->omega, share);
        o->decay = fmin(between(o->decay, to->decay, share), HIMC_LARGEST_DECAY * o->omega);
        o->mass = between(o->mass, to->mass, share);
        m->stretch[i] = between(m->stretch[i], goal->stretch[i], share);
        m->per_stiffness[i] *= before / m->config.head.tension;
        for (int k = 0; k < HIMC_RAYS && m->config.rays; k++)
            m->rays.gain[k][i] = between(m->rays.gain[k][i], goal->rays.gain[k][i], share);
    }
    for (int i = 0; i < m->shared_count; i++) {
        m->shared[i].omega = m->oscillators[m->shared[i].index].omega;
        m->shared[i].mass = m->oscillators[m->shared[i].index].mass;
    }
    set_bank(m);
    for (int i = 0; i < HIMC_STRIKE_POINTS; i++)
        m->points[i].used = false;
    for (int k = 0; k < HIMC_OUTPUTS; k++)
        if (himc_membrane_config_has(&m->config, k))
            weigh_pressures(m, k);
    find_form(m);
    find_tubes(m);
    find_under(m);
}
