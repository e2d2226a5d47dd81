/// membrane.c: a drumhead put together from modes, bank and pickups, and changed while it sounds.
///
/// A force f at (x, y) drives mode i with phi_i(x, y) f; the displacement there is sum phi_i q_i.
/// Both use the same phi, from the same table, so work done on the head equals the energy in its
/// modes up to rounding, whatever the table's error. A strike point is computed once and kept while
/// it is used. In air each mode has another frequency, decay and mass but the same shape, or a
/// mixture of shapes (air.h), so all of this holds there too.
///
/// All arrays with an entry for each mode are one block of memory, the core. Another number of
/// modes is another core, made beside the old one and exchanged. A whole membrane may also be made
/// aside, by another thread, and exchanged (himc_membrane_exchange). After any change of head, rate
/// or pickups, oscillators and readouts are computed anew from the same tables; the bank keeps the
/// modes' energy and phase, and a declick keeps the sound continuous.
#include "base/argument.h"
#include "drum/membrane_form.h"
#include "drum/membrane_state.h"

#include "drum/membrane_probe.h"
#include "head/pickup.h"
#include "head/statistical.h"
#include "system/aligned.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// arrays of a core: its own, what rays have in common, those of each output, patch, strike point
#define ARRAYS \
    (9 + 2 + 3 + HIMC_RAYS + PATCHES + HIMC_OUTPUTS * (3 + HIMC_STEP_LENGTHS) + STRIKE_POINTS * 3)
_Static_assert(HIMC_BANK_ALIKE == HIMC_RAYS, "the rays are alike");
#define ENERGY_ROUNDING 1e-12 // relative; chosen: below it an excess is rounding
// relative; so a point moved to the rim is not outside it in single precision, in which a command
// can say it
#define RIM_ROUNDING 1.2e-7
#define SLACK 1e-6 // rise per tension; chosen: 0.001 cent
// Exchanges with other heads (air_between.c) take and give velocity at intervals. A mode decays as
// it should whatever its angle w t in one, unless that is near pi, where its velocity would be met
// at the same phase again and again.
#define INTERVAL 0.00075     // (s) chosen: 32 samples of 44.1 and 48 kHz
#define LARGEST_BESSEL 0.582 // of |J_m| with m > 0
#define SHARED_ANGLE 2.0     // most of w t of a mode that is shared; chosen: up to 477 Hz

static void core_free(core *c)
{
    himc_modes_free(c->modes);
    himc_bank_free(c->bank);
    free(c->oscillators);
    himc_aligned_free(c->memory);
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

static output take_output(double **memory, int length)
{
    output o = {.readout = take_readout(memory, length)};
    o.readout.film = take(memory, length);
    for (int k = 0; k < HIMC_STEP_LENGTHS; k++)
        o.response[k] = take(memory, length);
    return o;
}

// Modes, bank and arrays for `modes` (as a head's) of that outline, and the arrays of strike
// points. False, and nothing kept, without memory.
static bool core_new(core *c, strike_point points[STRIKE_POINTS], const himc_shape *shape,
                     int modes, himc_error *error)
{
    *c = (core){.modes = himc_modes_new(shape, modes, error)};
    if (!c->modes)
        return false;
    int count = himc_modes_count(c->modes);
    c->bank = himc_bank_new(count, error);
    c->oscillators = malloc(sizeof *c->oscillators * (size_t)count);
    int padded = c->bank ? himc_bank_padded(c->bank) : 0;
    size_t bytes = sizeof(double) * (size_t)padded * ARRAYS;
    double *memory = c->memory = himc_aligned_new(bytes);
    if (!c->bank || !c->oscillators || !memory) {
        himc_error_set(error, "modes: no memory for %d modes", count);
        core_free(c);
        return false;
    }
    memset(memory, 0, bytes);
    double **arrays[] = {&c->on_q, &c->on_v, &c->on_force,      &c->scratch, &c->stretch,
                         &c->wave, &c->most, &c->per_stiffness, &c->per_mass};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        *arrays[i] = take(&memory, padded);
    c->watched = take_readout(&memory, padded);
    for (int i = 0; i < HIMC_OUTPUTS; i++)
        c->outputs[i] = take_output(&memory, padded);
    c->rays.form = take_readout(&memory, padded);
    c->rays.form.film = take(&memory, padded);
    for (int i = 0; i < HIMC_RAYS; i++)
        c->rays.gain[i] = take(&memory, padded);
    for (int i = 0; i < PATCHES; i++)
        c->patches[i].weight = take(&memory, padded);
    for (int i = 0; i < STRIKE_POINTS; i++)
        points[i] = (strike_point){.shape = take(&memory, padded),
                                   .readout = take_readout(&memory, padded)};
    return true;
}

// Oscillators of all modes, what strike points need of the bare ones, and a_i = sqrt(2 kappa) Lam_i
// of the film; Lam_i is the stiffness of a mode's film per tension. The members of a pair have one
// load.
static void find_oscillators(himc_membrane *m)
{
    core *c = &m->core;
    double root = sqrt(2 * himc_membrane_film_stiffness(m));
    himc_outline kind = himc_membrane_shape(m)->kind;
    himc_air_load load = {0};
    for (int i = 0; i < PATCHES; i++)
        c->patches[i].b = 0;
    for (int i = 0; i < himc_membrane_modes(m); i++) {
        himc_mode mode = himc_modes_get(c->modes, &m->head, i);
        c->most[i] = mode.m < 0 ? HIMC_STATISTICAL_MOST : 1;
        if (kind == HIMC_CIRCLE && mode.m > 0)
            c->most[i] = LARGEST_BESSEL;
        c->wave[i] = kind != HIMC_GRID ? mode.zero / m->head.radius : 0;
        double stretch = root * mode.stiffness / m->head.tension;
        c->per_stiffness[i] = 1 / mode.stiffness;
        c->per_mass[i] = 1 / mode.mass;
        if (m->head.air && !mode.sine)
            load = himc_air_on(&m->air, mode.m, mode.n, mode.zero);
        c->stretch[i] = m->head.air ? stretch * load.stretch : stretch;
        if (m->head.air)
            mode = himc_air_loaded(&load, &m->head, &mode);
        c->oscillators[i] = (himc_oscillator){2 * HIMC_PI * mode.frequency, mode.decay, mode.mass};
    }
    const himc_mixture *mix = himc_modes_mixture(c->modes);
    for (int n = 0; n < mix->count; n++)
        for (int k = 0; k < mix->count; k++)
            c->most[mix->index[n]] += k == n ? 0 : fabs(mix->part[n][k]);
}

// the modes that other heads hear, and what the air between takes of their decay
static void find_shared(himc_membrane *m)
{
    int interval = himc_membrane_interval(m->rate);
    bool shares = m->shares && m->head.air;
    double highest = SHARED_ANGLE * m->rate / (2 * HIMC_PI * interval);
    m->revision++;
    m->shared_count =
        shares ? himc_shared_find(&m->head, m->core.modes, &m->air, highest, m->shared) : 0;
    for (int i = 0; i < m->shared_count; i++)
        m->core.oscillators[m->shared[i].index].decay -= m->shared[i].decay;
    himc_bank_set_pass(m->core.bank, shares ? interval : HIMC_BANK_PASS);
}

int himc_membrane_interval(double rate)
{
    int samples = HIMC_BANK_PASS;
    while (samples > 8 && samples > INTERVAL * rate)
        samples /= 2;
    return samples;
}

// responses of an output to modal forces: through the state and, for accelerations, direct ones
static void find_responses(himc_membrane *m, output *o, const double *direct)
{
    himc_bank *bank = m->core.bank;
    for (int k = 0; k < HIMC_STEP_LENGTHS; k++) {
        himc_bank_set_step(bank, (himc_step_length)k);
        himc_bank_step_response(bank, &o->readout, o->response[k]);
        for (int i = 0; direct && i < himc_bank_count(bank); i++)
            o->response[k][i] += direct[i];
    }
    himc_bank_set_step(bank, m->step);
}

// after the watched point has moved, or the modes have changed
static void find_watched(himc_membrane *m)
{
    core *c = &m->core;
    himc_modes_shapes(c->modes, m->head.radius, m->watch_x, m->watch_y, c->scratch);
    himc_modes_mix(c->modes, c->scratch);
    himc_bank_readout(c->bank, c->scratch, NULL, NULL, &c->watched);
}

// as its oscillator has it
static himc_mode sounding_mode(const himc_membrane *m, int i)
{
    const himc_oscillator *o = &m->core.oscillators[i];
    himc_mode mode = himc_modes_get(m->core.modes, &m->head, i);
    mode.frequency = o->omega / (2 * HIMC_PI);
    mode.decay = o->decay;
    mode.mass = o->mass;
    return mode;
}

static void find_output(himc_membrane *m, int index)
{
    core *c = &m->core;
    const himc_pickup *pickup = &m->pickups[index];
    double unit = index < HIMC_PICKUPS ? 1 : pickup->distance; // rays are as loud as at 1 m
    if (pickup->kind == HIMC_PICKUP_POINT) {
        himc_modes_shapes(c->modes, m->head.radius, pickup->x, pickup->y, c->scratch);
        himc_modes_mix(c->modes, c->scratch);
    }
    for (int i = 0; i < himc_membrane_modes(m); i++) {
        himc_mode mode = sounding_mode(m, i);
        pickup_weights w = himc_pickup_weights(pickup, &m->head, c->modes, i, &mode, c->scratch[i]);
        c->on_q[i] = unit * w.displacement;
        c->on_v[i] = unit * w.velocity;
        c->on_force[i] = unit * w.force;
        if (index >= HIMC_PICKUPS)
            c->rays.gain[index - HIMC_PICKUPS][i] = unit * w.gain;
    }
    himc_bank_readout(c->bank, c->on_q, c->on_v,
                      pickup->kind == HIMC_PICKUP_AIR ? c->on_force : NULL,
                      &c->outputs[index].readout);
    find_responses(m, &c->outputs[index], c->on_force);
}

// what all rays of a round head have in common
static void find_form(himc_membrane *m)
{
    core *c = &m->core;
    for (int i = 0; i < himc_membrane_modes(m); i++) {
        himc_mode mode = sounding_mode(m, i);
        pickup_weights w = himc_pickup_form(&mode);
        c->on_q[i] = w.displacement;
        c->on_v[i] = w.velocity;
        c->on_force[i] = w.force;
    }
    himc_bank_readout(c->bank, c->on_q, c->on_v, c->on_force, &c->rays.form);
}

// outputs from `first` to `end`, but muted pickups; strike points hold responses to them and are
// computed again when asked for
static void find_outputs(himc_membrane *m, int first, int end)
{
    for (int i = 0; i < STRIKE_POINTS; i++)
        m->points[i].used = false;
    for (int i = first; i < end; i++)
        if (himc_membrane_wants(m, i))
            find_output(m, i);
    if (first < HIMC_PICKUPS)
        m->core.stale = m->muted;
    if (end > HIMC_PICKUPS && himc_membrane_rays(m))
        find_form(m);
}

// The film is off while it could not raise the tension by SLACK of it, 0.001 cent, even with twice
// the energy in the head.
static void set_film(himc_membrane *m)
{
    double tension = m->head.tension, stiffness = himc_membrane_film_stiffness(m);
    if (stiffness > 0)
        himc_bank_set_film(m->core.bank, m->core.stretch,
                           SLACK * tension * tension / (2 * stiffness));
    else
        himc_bank_set_film(m->core.bank, NULL, 0);
}

// points of pickups that a smaller head no longer has move to its rim
static void keep_pickups_on_head(himc_membrane *m)
{
    for (int i = 0; i < m->pickup_count; i++) {
        himc_pickup *p = &m->pickups[i];
        double r = hypot(p->x, p->y);
        if (p->kind != HIMC_PICKUP_POINT || r <= m->head.radius)
            continue;
        p->x = himc_argument_single((1 - RIM_ROUNDING) * m->head.radius / r * p->x);
        p->y = himc_argument_single((1 - RIM_ROUNDING) * m->head.radius / r * p->y);
    }
}

// after head, rate or core have changed
static void retune(himc_membrane *m)
{
    core *c = &m->core;
    keep_pickups_on_head(m);
    himc_modes_set_lugs(c->modes, m->head.uniformity, m->head.uniformity_seed);
    m->air = himc_membrane_air(&m->head);
    himc_mixture mixture = himc_air_mixture(&m->air);
    himc_modes_mix_as(c->modes, m->head.air ? &mixture : NULL);
    find_oscillators(m);
    find_shared(m);
    himc_bank_set_substeps(c->bank, himc_membrane_substeps(m));
    himc_bank_set(c->bank, c->oscillators, himc_membrane_modes(m), m->rate);
    set_film(m);
    find_outputs(m, 0, HIMC_OUTPUTS);
    find_watched(m);
}

// On a slacker head the same energy of bending is a deeper bend, and the energy of stretching goes
// with the fourth power of its depth. So that the total does not exceed `before` (J), every mode's
// displacement is scaled by sqrt(x), x the positive solution of bending x + stretching x^2 = the
// potential energy that remains.
static void keep_energy(himc_membrane *m, double before)
{
    himc_bank *bank = m->core.bank;
    double film = himc_bank_film(bank), bending = 0, stretching = 0.5 * film * film, q, v;
    double excess = himc_membrane_energy(m) - before;
    if (!(excess > ENERGY_ROUNDING * before))
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
    himc_bank_find_film(bank);
}

// As it rings, with no more energy. After a hard blow the film stretches step by step; retune lets
// it stretch at once, which would bring energy that nobody has paid.
static void retune_ringing(himc_membrane *m)
{
    double energy = himc_membrane_energy(m);
    retune(m);
    keep_energy(m, energy);
}

// a sound's last sample and the coming one, if no new force acts
typedef struct sound_pair {
    double now, next;
} sound_pair;

typedef struct sounds {
    sound_pair of[HIMC_OUTPUTS];
} sounds;

// A pickup of accelerations has a direct part of each force, which cancels most of what the modes
// of a bent head contribute. So the forces of the last sample are counted as if they continued.
static void add_forces(himc_membrane *m, int index, sound_pair *sound)
{
    core *c = &m->core;
    const output *o = &c->outputs[index];
    himc_bank_step_response(c->bank, &o->readout, c->scratch);
    for (int i = 0; i < himc_bank_padded(c->bank); i++)
        c->scratch[i] = o->response[HIMC_STEP_SAMPLE][i] - c->scratch[i];
    for (int i = 0; i < m->applied_count; i++) {
        const push *p = &m->applied[i];
        strike_point *s = himc_membrane_strike_point(m, p->x, p->y, p->b);
        sound->now += p->force * himc_bank_sum(c->bank, s->shape, c->scratch);
        sound->next += p->force * himc_strike_point_response(m, s, HIMC_STEP_SAMPLE)->sound[index];
    }
}

static sounds read_sounds(himc_membrane *m)
{
    sounds s = {0};
    for (int i = 0; i < HIMC_OUTPUTS; i++) {
        if (!himc_membrane_wants(m, i))
            continue;
        himc_readout *readout = &m->core.outputs[i].readout;
        const declick *d = &m->declicks[i];
        s.of[i] = (sound_pair){himc_bank_read(m->core.bank, readout) + declick_at(d, d->at - 1),
                               himc_bank_peek(m->core.bank, readout) + declick_at(d, d->at)};
        add_forces(m, i, &s.of[i]);
    }
    return s;
}

// continues the sounds of the outputs from `first` to `end` by declicks, from `before`
static void declick_from(himc_membrane *m, const sounds *before, int first, int end)
{
    memset(m->declicks + first, 0, sizeof *m->declicks * (size_t)(end - first));
    sounds after = read_sounds(m);
    for (int i = first; i < end; i++) {
        const sound_pair *a = &after.of[i], *b = &before->of[i];
        double step = b->next - a->next;
        m->declicks[i] = (declick){.step = step,
                                   .slope = step - (b->now - a->now),
                                   .length = (int)(DECLICK_TIME * m->rate) + 1};
    }
}

// checks a head of that outline
static bool check_head(const himc_head *head, himc_outline kind, himc_error *error)
{
    if (!himc_head_check(head, error))
        return false;
    if (head->air && kind != HIMC_CIRCLE)
        return himc_error_set(error, "air: 1, expected 0 on a head that is not round");
    return !head->air || head->kettle == 0 || himc_air_check(head->kettle, head->radius, error);
}

himc_membrane *himc_membrane_new_of(const himc_membrane_form *form, himc_error *error)
{
    if (!check_head(&form->head, form->shape.kind, error) ||
        !himc_check_range("sample rate", form->rate, 4000, 480000, "Hz", error))
        return NULL;
    himc_membrane *m = calloc(1, sizeof *m);
    if (!m || !core_new(&m->core, m->points, &form->shape, form->head.modes, error)) {
        if (!m)
            himc_error_set(error, "membrane: no memory");
        free(m);
        return NULL;
    }
    m->head = form->head;
    memcpy(m->pickups, form->pickups, sizeof m->pickups);
    m->pickup_count = form->pickup_count;
    m->rays = form->rays;
    m->shares = form->shares;
    m->ends_sample = true;
    m->rate = form->rate;
    m->watch_x = form->watch_x;
    m->watch_y = form->watch_y;
    retune(m);
    return m;
}

himc_membrane *himc_membrane_new(const himc_head *head, double rate, himc_error *error)
{
    return himc_membrane_new_of(&(himc_membrane_form){.shape = {.kind = HIMC_CIRCLE},
                                                      .head = *head,
                                                      .pickups = {himc_pickup_default()},
                                                      .pickup_count = 1,
                                                      .rate = rate},
                                error);
}

void himc_membrane_free(himc_membrane *membrane)
{
    if (!membrane)
        return;
    core_free(&membrane->core);
    free(membrane);
}

// Adds `times` the static displacement under the pressing forces to all modes. It is taken away
// before a change of the head and put back after it: the bend follows the head, and only what rings
// keeps its energy. A bend of another head would be let go, and heard.
static void bend(himc_membrane *m, double times)
{
    for (int k = 0; k < m->applied_count; k++) {
        const push *p = &m->applied[k];
        const strike_point *s = himc_membrane_strike_point(m, p->x, p->y, p->b);
        for (int i = 0; i < himc_bank_count(m->core.bank); i++) {
            const himc_oscillator *o = &m->core.oscillators[i];
            double q, v, force = times * p->force * s->shape[i];
            himc_bank_state(m->core.bank, i, &q, &v);
            if (force != 0)
                himc_bank_excite(m->core.bank, i, q + force / (o->mass * o->omega * o->omega), v);
        }
    }
    himc_bank_find_film(m->core.bank);
}

// other modes; those that remain keep their state, without the bend of pressing forces
static bool resize(himc_membrane *m, int modes, himc_error *error)
{
    core old = m->core, fresh;
    strike_point points[STRIKE_POINTS];
    if (!core_new(&fresh, points, himc_modes_shape(old.modes), modes, error))
        return false;
    bend(m, -1);
    int common = himc_modes_common(old.modes, fresh.modes);
    himc_bank_set(fresh.bank, old.oscillators, common, m->rate);
    himc_bank_continue(fresh.bank, old.bank, common);
    memcpy(m->points, points, sizeof points);
    m->core = fresh;
    core_free(&old);
    return true;
}

// Pairs whose axis was another in `before` go on in the same shape: what vibrated along the old
// axes is taken apart along the new ones. Of amplitudes times frequency and of velocities, as here,
// a rotation keeps the energy, since both members have one mass.
static void turn_pairs(himc_membrane *m, const himc_lugs_pair *before)
{
    const himc_lugs_pair *after = himc_modes_pairs(m->core.modes);
    if (memcmp(before, after, sizeof *before * HIMC_LUGS_ORDERS) == 0)
        return;
    for (int i = 1; i < himc_bank_count(m->core.bank); i++) {
        himc_mode mode = himc_modes_get(m->core.modes, &m->head, i);
        if (!mode.sine || before[mode.m].axis == after[mode.m].axis)
            continue;
        const himc_lugs_pair *a = &before[mode.m], *b = &after[mode.m];
        double c = b->cosine * a->cosine + b->sine * a->sine;
        double s = b->sine * a->cosine - b->cosine * a->sine, q[2], v[2];
        double first = m->core.oscillators[i - 1].omega, second = m->core.oscillators[i].omega;
        himc_bank_state(m->core.bank, i - 1, &q[0], &v[0]);
        himc_bank_state(m->core.bank, i, &q[1], &v[1]);
        himc_bank_excite(m->core.bank, i - 1, (c * first * q[0] + s * second * q[1]) / first,
                         c * v[0] + s * v[1]);
        himc_bank_excite(m->core.bank, i, (c * second * q[1] - s * first * q[0]) / second,
                         c * v[1] - s * v[0]);
    }
}

bool himc_membrane_set_head(himc_membrane *membrane, const himc_head *head, himc_error *error)
{
    if (!check_head(head, himc_membrane_shape(membrane)->kind, error))
        return false;
    sounds before = read_sounds(membrane);
    double energy = himc_membrane_energy(membrane);
    himc_lugs_pair pairs[HIMC_LUGS_ORDERS];
    memcpy(pairs, himc_modes_pairs(membrane->core.modes), sizeof pairs);
    if (head->modes == membrane->head.modes)
        bend(membrane, -1);
    else if (!resize(membrane, head->modes, error))
        return false;
    membrane->head = *head;
    retune(membrane);
    turn_pairs(membrane, pairs);
    bend(membrane, 1);
    keep_energy(membrane, energy);
    declick_from(membrane, &before, 0, HIMC_OUTPUTS);
    return true;
}

bool himc_membrane_set_shape(himc_membrane *membrane, const himc_shape *shape,
                             const himc_head *head, himc_error *error)
{
    core fresh, old = membrane->core;
    strike_point points[STRIKE_POINTS];
    if (!check_head(head, shape->kind, error) ||
        !core_new(&fresh, points, shape, head->modes, error))
        return false;
    sounds before = read_sounds(membrane);
    memcpy(membrane->points, points, sizeof points);
    membrane->core = fresh;
    membrane->head = *head;
    retune(membrane);
    declick_from(membrane, &before, 0, HIMC_OUTPUTS);
    core_free(&old);
    return true;
}

bool himc_membrane_set_pickups(himc_membrane *membrane, const himc_pickup *pickups, int count,
                               himc_error *error)
{
    if (!himc_check_range("pickups", count, 1, HIMC_PICKUPS, "", error))
        return false;
    for (int i = 0; i < count; i++)
        if (!himc_pickup_check(&pickups[i], &membrane->head, error))
            return false;
    sounds before = read_sounds(membrane);
    memcpy(membrane->pickups, pickups, sizeof *pickups * (size_t)count);
    membrane->pickup_count = count;
    find_outputs(membrane, 0, HIMC_PICKUPS);
    declick_from(membrane, &before, 0, HIMC_PICKUPS);
    return true;
}

static bool same_pickup(const himc_pickup *a, const himc_pickup *b)
{
    return a->kind == b->kind && a->x == b->x && a->y == b->y && a->azimuth == b->azimuth &&
           a->elevation == b->elevation && a->distance == b->distance;
}

static bool same_rays(const himc_pickup *a, const himc_pickup *b)
{
    bool same = (a == NULL) == (b == NULL);
    for (int i = 0; same && a && i < HIMC_RAYS; i++)
        same = same_pickup(&a[i], &b[i]);
    return same;
}

void himc_membrane_set_rays(himc_membrane *membrane, const himc_pickup *rays)
{
    if (same_rays(himc_membrane_rays(membrane), rays))
        return;
    sounds before = read_sounds(membrane);
    membrane->rays = rays != NULL;
    if (rays)
        memcpy(membrane->pickups + HIMC_PICKUPS, rays, sizeof *rays * HIMC_RAYS);
    find_outputs(membrane, HIMC_PICKUPS, HIMC_OUTPUTS);
    declick_from(membrane, &before, HIMC_PICKUPS, HIMC_OUTPUTS);
}

const himc_pickup *himc_membrane_rays(const himc_membrane *membrane)
{
    return membrane->rays ? membrane->pickups + HIMC_PICKUPS : NULL;
}

void himc_membrane_share(himc_membrane *m, bool shares)
{
    if (m->shares == shares)
        return;
    sounds before = read_sounds(m);
    m->shares = shares;
    retune_ringing(m);
    declick_from(m, &before, 0, HIMC_OUTPUTS);
}

bool himc_membrane_shares(const himc_membrane *membrane)
{
    return membrane->shares;
}

const himc_shared_mode *himc_membrane_shared(const himc_membrane *membrane, int *count)
{
    *count = membrane->shared_count;
    return membrane->shared;
}

unsigned himc_membrane_revision(const himc_membrane *membrane)
{
    return membrane->revision;
}

void himc_membrane_kick(himc_membrane *membrane, int index, double change)
{
    himc_bank_kick(membrane->core.bank, index, change);
}

void himc_membrane_mute_pickups(himc_membrane *membrane, bool mute)
{
    bool returns = membrane->muted && !mute;
    membrane->muted = mute;
    if (returns)
        find_outputs(membrane, 0, HIMC_PICKUPS);
}

bool himc_membrane_set_rate(himc_membrane *membrane, double rate, himc_error *error)
{
    if (!himc_check_range("sample rate", rate, 4000, 480000, "Hz", error))
        return false;
    sounds before = read_sounds(membrane);
    for (int i = 0; i < HIMC_OUTPUTS; i++) {
        sound_pair *s = &before.of[i];
        s->next = s->now + (s->next - s->now) * (membrane->rate / rate);
    }
    membrane->rate = rate;
    retune_ringing(membrane);
    declick_from(membrane, &before, 0, HIMC_OUTPUTS);
    return true;
}

static bool same_shape(const himc_shape *a, const himc_shape *b)
{
    return a->kind == b->kind && a->grid == b->grid && a->length * b->width == b->length * a->width;
}

bool himc_head_equal(const himc_head *a, const himc_head *b)
{
    return a->radius == b->radius && a->tension == b->tension && a->density == b->density &&
           a->decay_constant == b->decay_constant && a->decay_square == b->decay_square &&
           a->modes == b->modes && a->air == b->air && a->kettle == b->kettle &&
           a->glide == b->glide && a->damp == b->damp && a->uniformity == b->uniformity &&
           a->uniformity_seed == b->uniformity_seed;
}

himc_membrane_form himc_membrane_form_of(const himc_membrane *m)
{
    himc_membrane_form form = {.shape = *himc_membrane_shape(m),
                               .head = m->head,
                               .pickup_count = m->pickup_count,
                               .rays = m->rays,
                               .shares = m->shares,
                               .rate = m->rate,
                               .watch_x = m->watch_x,
                               .watch_y = m->watch_y};
    memcpy(form.pickups, m->pickups, sizeof form.pickups);
    if (form.shape.grid)
        himc_grid_retain(form.shape.grid);
    return form;
}

void himc_membrane_form_free(himc_membrane_form *form)
{
    himc_grid_release(form->shape.grid);
    form->shape.grid = NULL;
}

// the outline, head, pickups and rays of `m` are those
static bool is_alike(const himc_membrane *m, const himc_shape *shape, const himc_head *head,
                     const himc_pickup *pickups, int count, bool rays)
{
    bool alike = m->pickup_count == count && himc_head_equal(&m->head, head) &&
                 same_shape(himc_membrane_shape(m), shape) &&
                 same_rays(himc_membrane_rays(m), rays ? pickups + HIMC_PICKUPS : NULL);
    for (int i = 0; alike && i < count; i++)
        alike = same_pickup(&m->pickups[i], &pickups[i]);
    return alike;
}

bool himc_membrane_has_form(const himc_membrane *m, const himc_membrane_form *form)
{
    return m->rate == form->rate && m->shares == form->shares &&
           is_alike(m, &form->shape, &form->head, form->pickups, form->pickup_count, form->rays);
}

bool himc_membrane_alike(const himc_membrane *a, const himc_membrane *b)
{
    return is_alike(a, himc_membrane_shape(b), &b->head, b->pickups, b->pickup_count, b->rays);
}

bool himc_membrane_follow(himc_membrane *membrane, const himc_membrane *other, himc_error *error)
{
    const himc_shape *shape = himc_membrane_shape(other);
    bool good = same_shape(himc_membrane_shape(membrane), shape)
                    ? himc_membrane_set_head(membrane, &other->head, error)
                    : himc_membrane_set_shape(membrane, shape, &other->head, error);
    if (good && !same_rays(himc_membrane_rays(membrane), himc_membrane_rays(other)))
        himc_membrane_set_rays(membrane, himc_membrane_rays(other));
    return good && himc_membrane_set_pickups(membrane, other->pickups, other->pickup_count, error);
}

// gives `m` the form of another membrane, with its core and its strike points
static void take_form(himc_membrane *m, const himc_membrane *from)
{
    m->core = from->core;
    memcpy(m->points, from->points, sizeof m->points);
    m->head = from->head;
    m->air = from->air;
    memcpy(m->pickups, from->pickups, sizeof m->pickups);
    m->pickup_count = from->pickup_count;
    m->rays = from->rays;
    m->shares = from->shares;
    memcpy(m->shared, from->shared, sizeof m->shared);
    m->shared_count = from->shared_count;
}

void himc_membrane_exchange(himc_membrane *m, himc_membrane *made)
{
    sounds before = read_sounds(m);
    double energy = himc_membrane_energy(m);
    bool outline = same_shape(himc_membrane_shape(m), himc_membrane_shape(made));
    bool bends = outline && !himc_head_equal(&m->head, &made->head);
    if (bends)
        bend(m, -1);
    himc_membrane was = *m;
    take_form(m, made);
    take_form(made, &was);
    m->revision++;
    himc_bank_set_step(m->core.bank, m->step);
    for (int i = 0; i < STRIKE_POINTS; i++)
        m->points[i].used = false; // what they know may be of pickups as they were then
    if (m->core.stale && !m->muted)
        find_outputs(m, 0, HIMC_PICKUPS);
    if (m->watch_x != made->watch_x || m->watch_y != made->watch_y)
        find_watched(m);
    made->watch_x = m->watch_x;
    made->watch_y = m->watch_y;
    if (outline)
        himc_bank_continue(m->core.bank, was.core.bank,
                           himc_modes_common(was.core.modes, m->core.modes));
    else
        himc_bank_rest(m->core.bank);
    if (bends) {
        turn_pairs(m, himc_modes_pairs(was.core.modes));
        bend(m, 1);
        keep_energy(m, energy);
    }
    declick_from(m, &before, 0, HIMC_OUTPUTS);
}

void himc_membrane_watch(himc_membrane *membrane, double x, double y)
{
    if (x == membrane->watch_x && y == membrane->watch_y)
        return;
    membrane->watch_x = x;
    membrane->watch_y = y;
    find_watched(membrane);
}

void himc_membrane_excite(himc_membrane *membrane, int index, double q, double v)
{
    himc_bank_excite(membrane->core.bank, index, q, v);
    himc_bank_find_film(membrane->core.bank);
}

void himc_membrane_rest(himc_membrane *membrane)
{
    sounds before = read_sounds(membrane);
    himc_bank_rest(membrane->core.bank);
    declick_from(membrane, &before, 0, HIMC_OUTPUTS);
}
