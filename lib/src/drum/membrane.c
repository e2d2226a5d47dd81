/// membrane.c: a head in motion is given another model.
///
/// There is one way to another head, size, tuning, outline, sample rate or set of pickups: a model
/// of it is made, and its pointer exchanged between two samples. The state is carried over: modes
/// that both have keep energy and phase, and the energy never grows; a declick keeps the sound
/// continuous. Where no memory may be had, the model is made in the place of the present one, whose
/// bank carries itself over.
#include "drum/membrane_state.h"

#include "head/pickup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ENERGY_ROUNDING 1e-12 // relative; chosen: below it an excess is rounding

himc_membrane *himc_membrane_new_of(himc_model *model, himc_error *error)
{
    himc_membrane *m = model ? calloc(1, sizeof *m) : NULL;
    if (!m) {
        if (model)
            himc_error_set(error, "membrane: no memory");
        himc_model_free(model);
        return NULL;
    }
    m->model = model;
    m->ends_sample = true;
    himc_model_watch(model, 0, 0);
    return m;
}

himc_membrane *himc_membrane_new(const himc_head *head, double rate, himc_error *error)
{
    himc_membrane_config config = {.shape = {.kind = &himc_kind_round},
                                   .head = *head,
                                   .pickups = {himc_pickup_default()},
                                   .pickup_count = 1,
                                   .rate = rate};
    return himc_membrane_new_of(himc_model_new(&config, NULL, error), error);
}

void himc_membrane_free(himc_membrane *membrane)
{
    if (!membrane)
        return;
    himc_model_free(membrane->model);
    free(membrane);
}

// On a slacker head the same energy of bending is a deeper bend, and the energy of stretching goes
// with the fourth power of its depth. So that the total does not exceed `before` (J), every mode's
// displacement is scaled by sqrt(x), x the positive solution of bending x + stretching x^2 = the
// potential energy that remains.
static void keep_energy(himc_membrane *m, double before)
{
    himc_bank *bank = m->model->bank;
    double film = himc_bank_film(bank), bending = 0, stretching = 0.5 * film * film, q, v;
    double excess = himc_membrane_energy(m) - before;
    if (!(excess > ENERGY_ROUNDING * before))
        return;
    for (int i = 0; i < himc_bank_count(bank); i++) {
        const himc_oscillator *o = &m->model->oscillators[i];
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

// a sound's last sample and the coming one, if no new force acts
typedef struct sound_pair {
    double now, next;
} sound_pair;

typedef struct sounds {
    sound_pair of[HIMC_OUTPUTS];
} sounds;

// A pickup of accelerations has a direct part of each force, which cancels most of what the modes
// of a bent head contribute. So the forces of the last sample are counted as if they continued.
static sounds read_sounds(himc_membrane *m)
{
    himc_model *c = m->model;
    sounds all = {0};
    for (int k = 0; k < HIMC_OUTPUTS; k++) {
        if (!himc_membrane_has(m, k))
            continue;
        himc_output *o = &c->outputs[k];
        const declick *d = &m->declicks[k];
        sound_pair *sound = &all.of[k];
        *sound = (sound_pair){himc_bank_read(c->bank, &o->readout) + declick_at(d, d->at - 1),
                              himc_bank_peek(c->bank, &o->readout) + declick_at(d, d->at)};
        himc_bank_step_response(c->bank, &o->readout, c->scratch);
        for (int i = 0; i < himc_bank_padded(c->bank); i++)
            c->scratch[i] = o->response[HIMC_STEP_SAMPLE][i] - c->scratch[i];
        for (int i = 0; i < m->applied_count; i++) {
            const himc_push *p = &m->applied[i];
            strike_point *s = himc_membrane_strike_point(m, p->x, p->y, p->b);
            sound->now += p->force * himc_bank_sum(c->bank, s->shape, c->scratch);
            sound->next += p->force * himc_strike_point_response(m, s, HIMC_STEP_SAMPLE)->sound[k];
        }
    }
    return all;
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
                                   .length = (int)(DECLICK_TIME * m->model->config.rate) + 1};
    }
}

// Adds `times` the static displacement under the pressing forces to all modes. It is taken away
// before a change of the head and put back after it: the bend follows the head, and only what rings
// keeps its energy. A bend of another head would be let go, and heard.
static void bend(himc_membrane *m, double times)
{
    for (int k = 0; k < m->applied_count; k++) {
        const himc_push *p = &m->applied[k];
        const strike_point *s = himc_membrane_strike_point(m, p->x, p->y, p->b);
        for (int i = 0; i < himc_bank_count(m->model->bank); i++) {
            const himc_oscillator *o = &m->model->oscillators[i];
            double q, v, force = times * p->force * s->shape[i];
            himc_bank_state(m->model->bank, i, &q, &v);
            if (force != 0)
                himc_bank_excite(m->model->bank, i, q + force / (o->mass * o->omega * o->omega), v);
        }
    }
    himc_bank_find_film(m->model->bank);
}

// Of amplitudes times frequency and of velocities of a block's modes, those of the even head's
// shapes, or back: the parts are orthogonal in the modes' masses, so this keeps the energy.
static void mix_state(himc_membrane *m, const himc_uneven_block *block, bool back)
{
    const himc_oscillator *o = m->model->oscillators;
    double a[HIMC_UNEVEN_MODES], v[HIMC_UNEVEN_MODES];
    for (int i = 0; i < block->count; i++) {
        himc_bank_state(m->model->bank, block->index[i], &a[i], &v[i]);
        a[i] *= o[block->index[i]].omega;
    }
    for (int i = 0; i < block->count; i++) {
        double sum[2] = {0, 0};
        for (int l = 0; l < block->count; l++) {
            double part =
                back ? block->part[i][l] * o[block->index[l]].mass / o[block->index[i]].mass
                     : block->part[l][i];
            sum[0] += part * a[l];
            sum[1] += part * v[l];
        }
        himc_bank_excite(m->model->bank, block->index[i], sum[0] / o[block->index[i]].omega,
                         sum[1]);
    }
}

// Pairs whose axis was another in `before`, and orders that mixed otherwise, go on in the same
// shape: what vibrated along the old axes is taken apart along the new ones. Orders do not if the
// list of modes is another, not `whole`. Of amplitudes times frequency and of velocities, as here,
// a rotation keeps the energy, since both members have one mass.
static void turn_pairs(himc_membrane *m, const himc_lugs_pair *before,
                       const himc_uneven_block mixed[2], bool whole)
{
    const himc_lugs_pair *after = m->model->modes->pairs;
    if (memcmp(before, after, sizeof *before * HIMC_LUGS_ORDERS) == 0)
        return;
    const himc_modes *modes = m->model->modes;
    for (int parity = 0; parity < 2 && whole; parity++)
        mix_state(m, &mixed[parity], false);
    for (int i = 1; i < himc_bank_count(m->model->bank); i++) {
        himc_mode mode = himc_modes_get(m->model->modes, &m->model->config.head, i);
        if (!mode.sine || before[mode.m].axis == after[mode.m].axis)
            continue;
        const himc_lugs_pair *a = &before[mode.m], *b = &after[mode.m];
        double c = b->cosine * a->cosine + b->sine * a->sine;
        double s = b->sine * a->cosine - b->cosine * a->sine, q[2], v[2];
        double first = m->model->oscillators[i - 1].omega, second = m->model->oscillators[i].omega;
        himc_bank_state(m->model->bank, i - 1, &q[0], &v[0]);
        himc_bank_state(m->model->bank, i, &q[1], &v[1]);
        himc_bank_excite(m->model->bank, i - 1, (c * first * q[0] + s * second * q[1]) / first,
                         c * v[0] + s * v[1]);
        himc_bank_excite(m->model->bank, i, (c * second * q[1] - s * first * q[0]) / second,
                         c * v[1] - s * v[0]);
    }
    for (int parity = 0; parity < 2 && whole; parity++)
        mix_state(m, &modes->block[parity], true);
}

// Gives the membrane the model `made`, whose config this is, or if that is NULL makes that of
// `config` in its place. With a share below 1 its own goes that share of the way to `made`.
static void change(himc_membrane *m, const himc_membrane_config *config, himc_model *made,
                   double share)
{
    himc_model *was = m->model;
    double energy = himc_membrane_energy(m), samples = was->config.rate / config->rate;
    sounds before = read_sounds(m);
    himc_lugs_pair pairs[HIMC_LUGS_ORDERS];
    bool outline = himc_shape_equal(&was->config.shape, &config->shape);
    bool bends = outline && !himc_head_equal(&was->config.head, &config->head);
    memcpy(pairs, was->modes->pairs, sizeof pairs);
    int count = was->modes->count;
    double pull = was->config.head.wires;
    himc_uneven_block mixed[2] = {was->modes->block[0], was->modes->block[1]};
    if (bends)
        bend(m, -1);
    m->revision++;
    if (made) {
        bool lacks = made->config.muted && !was->config.muted;
        made->config.muted = was->config.muted;
        for (int i = 0; i < HIMC_STRIKE_POINTS; i++)
            made->points[i].used = false; // what they know may be of pickups as they were then
        if (lacks)
            himc_model_find_outputs(made, 0, HIMC_EARS);
    }
    if (made && share < 1) {
        himc_model_approach(was, made, share);
        himc_bank_set_step(was->bank, m->step);
    } else if (made) {
        m->model = made;
        himc_bank_set_step(made->bank, m->step);
        if (outline)
            himc_bank_continue(made->bank, was->bank, himc_modes_common(was->modes, made->modes));
        else
            himc_bank_rest(made->bank);
    } else {
        himc_model_make(was, config);
    }
    himc_model_watch(m->model, m->watch_x, m->watch_y);
    if (bends) {
        turn_pairs(m, pairs, mixed, count == m->model->modes->count);
        bend(m, 1);
    }
    keep_energy(m, energy);
    himc_membrane_keep_wires(m, pull);
    for (int i = 0; i < HIMC_OUTPUTS && samples != 1; i++) {
        sound_pair *s = &before.of[i];
        s->next = s->now + (s->next - s->now) * samples;
    }
    declick_from(m, &before, 0, HIMC_OUTPUTS);
}

himc_model *himc_membrane_exchange(himc_membrane *m, himc_model *made)
{
    himc_model *was = m->model;
    change(m, &made->config, made, 1);
    return was;
}

void himc_membrane_approach(himc_membrane *m, himc_model *goal, double share)
{
    change(m, &goal->config, goal, share);
}

bool himc_membrane_become(himc_membrane *m, const himc_membrane_config *config, himc_error *error)
{
    if (!himc_membrane_config_check(config, error))
        return false;
    if (himc_model_has_room(m->model, config)) {
        change(m, config, NULL, 1);
        return true;
    }
    himc_model *made = himc_model_new(config, NULL, error);
    if (made)
        himc_model_free(himc_membrane_exchange(m, made));
    return made;
}

bool himc_membrane_set_rate(himc_membrane *membrane, double rate, himc_error *error)
{
    himc_membrane_config config = membrane->model->config;
    config.rate = rate;
    return himc_membrane_become(membrane, &config, error);
}

// outputs from `first` to `end` become those of a config that differs in nothing else
static void change_outputs(himc_membrane *m, const himc_membrane_config *config, int first, int end)
{
    sounds before = read_sounds(m);
    m->model->config = *config;
    himc_model_find_outputs(m->model, first, end);
    declick_from(m, &before, first, end);
}

bool himc_membrane_set_pickups(himc_membrane *membrane, const himc_pickup *pickups, int count,
                               himc_error *error)
{
    himc_membrane_config config = membrane->model->config;
    if (!himc_check_range("pickups", count, 1, HIMC_PICKUPS, "", error))
        return false;
    for (int i = 0; i < count; i++)
        if (!himc_pickup_check(&pickups[i], &config.head, error))
            return false;
    memcpy(config.pickups, pickups, sizeof *pickups * (size_t)count);
    config.pickup_count = count;
    change_outputs(membrane, &config, 0, HIMC_PICKUPS);
    return true;
}

void himc_membrane_set_rays(himc_membrane *membrane, const himc_pickup *rays)
{
    himc_membrane_config config = membrane->model->config;
    if (himc_membrane_config_set_rays(&config, rays))
        change_outputs(membrane, &config, HIMC_PICKUPS, HIMC_OUTPUTS);
}

void himc_membrane_share(himc_membrane *m, bool shares)
{
    himc_membrane_config config = m->model->config;
    config.shares = shares;
    if (m->model->config.shares != shares)
        change(m, &config, NULL, 1);
}

void himc_membrane_mute_pickups(himc_membrane *membrane, bool mute)
{
    if (membrane->model->config.muted == mute)
        return;
    membrane->model->config.muted = mute;
    memset(membrane->declicks, 0, sizeof *membrane->declicks * HIMC_EARS);
    memset(membrane->sound, 0, sizeof *membrane->sound * HIMC_EARS);
    if (!mute)
        himc_model_find_outputs(membrane->model, 0, HIMC_EARS);
}

void himc_membrane_watch(himc_membrane *membrane, double x, double y)
{
    if (x == membrane->watch_x && y == membrane->watch_y)
        return;
    membrane->watch_x = x;
    membrane->watch_y = y;
    himc_model_watch(membrane->model, x, y);
}

void himc_membrane_rest(himc_membrane *membrane)
{
    sounds before = read_sounds(membrane);
    himc_bank_rest(membrane->model->bank);
    membrane->wires = (himc_wires){.awake = false};
    declick_from(membrane, &before, 0, HIMC_OUTPUTS);
}
