/// membrane_step.c: one sample of the head: free motion, forces, the film's stretching.
///
/// A head that bows out is longer, so its film pulls harder. With Berger's assumption of a uniform
/// tension (H. M. Berger 1955; Avanzini & Marogna 2010) the tension rises by kappa int |grad w|^2
/// dS, and the energy of stretching is s^2/2 with
///     s = sqrt(kappa/2) sum_i Lam_i q_i^2,   Lam_i = int |grad phi_i|^2 dS,
///     kappa = E h_f/(2 (1 - nu^2) area).
/// bank_film.c says how the film and the modes act on each other; contact (contact.c) need not know
/// of it.
///
/// A vibraphone's motor turns discs in the mouths of its tubes, which open and shut twice a turn:
/// its loudness swings, its pitch hardly does (Fletcher & Rossing, ch. 19, remembered). All are
/// on one shaft; open at angle 0, they let pass the amplitude 1 - SHUT sin^2 of what the tubes
/// send. The bars' own sound stays, so high partials do not swing. Discs start open when all is
/// silent, and turned off they go on until they are open: no click. That a bar with a shut tube
/// loses less is left out.
#include "drum/membrane_state.h"

#include <math.h>
#include <string.h>

#define SHUT 0.5 // chosen: 6 dB

// the weights of all modes under a patch of that radius
static const double *weights(himc_membrane *m, double b)
{
    himc_model *c = m->model;
    himc_patch *oldest = &c->patches[0];
    for (int i = 0; i < HIMC_PATCHES; i++) {
        himc_patch *p = &c->patches[i];
        if (p->b == b) {
            p->age = ++m->model->clock;
            return p->weight;
        }
        if (p->b == 0 || (oldest->b > 0 && p->age < oldest->age))
            oldest = p;
    }
    oldest->b = b;
    oldest->age = ++m->model->clock;
    for (int i = 0; i < m->model->modes->count; i++)
        oldest->weight[i] = i > 0 && c->wave[i] == c->wave[i - 1]
                                ? oldest->weight[i - 1]
                                : himc_patch_weight(c->wave[i] * b);
    return oldest->weight;
}

// spreads a force at the point over its patch, and finds what the list's modes do not yield there
static void spread(himc_membrane *m, strike_point *s)
{
    const himc_model *c = m->model;
    const himc_head *head = &c->config.head;
    const himc_kind *kind = c->config.shape.kind;
    double b = kind->patch ? kind->patch(head, s->x, s->y, s->b) : 0;
    s->residual = (himc_residual){0};
    if (!(b > 0))
        return;
    const double *weight = weights(m, b);
    for (int i = 0; i < c->modes->count; i++)
        s->shape[i] *= weight[i];
    if (!kind->compliance)
        return;
    double compliance = kind->compliance(head, s->x, s->y, b);
    double per_mass = 1 / (head->density * HIMC_PI * b * b);
    for (int i = 0; i < himc_bank_count(c->bank); i++) {
        double square = s->shape[i] * s->shape[i];
        compliance -= square * c->per_stiffness[i];
        per_mass -= square * c->per_mass[i];
    }
    s->residual = himc_residual_of(compliance, per_mass);
}

const himc_unit_response *himc_strike_point_response(himc_membrane *m, strike_point *s,
                                                     himc_step_length k)
{
    const himc_model *c = m->model;
    himc_unit_response *e = &s->response[k];
    if (s->responds[k])
        return e;
    s->responds[k] = true;
    himc_bank_set_step(c->bank, k);
    e->compliance = himc_bank_response(c->bank, s->shape, &s->readout);
    for (int i = 0; i < HIMC_OUTPUTS; i++)
        if (himc_membrane_has(m, i))
            e->sound[i] = himc_bank_sum(c->bank, s->shape, c->outputs[i].response[k]);
    for (int i = 0; c->under.shape && i < HIMC_WIRES; i++)
        s->under[k][i] = himc_bank_response(c->bank, c->under.shape + i * himc_bank_padded(c->bank),
                                            &s->readout);
    himc_bank_set_step(c->bank, m->step);
    return e;
}

void himc_membrane_set_substep(himc_membrane *membrane, int index, int count)
{
    membrane->step = count > 1 ? HIMC_STEP_SUBSTEP : HIMC_STEP_SAMPLE;
    membrane->ends_sample = index == count - 1;
    himc_bank_set_step(membrane->model->bank, membrane->step);
}

strike_point *himc_membrane_strike_point(himc_membrane *membrane, double x, double y, double b)
{
    himc_model *c = membrane->model;
    strike_point *oldest = &c->points[0];
    for (int i = 0; i < HIMC_STRIKE_POINTS; i++) {
        strike_point *s = &c->points[i];
        if (s->used && s->x == x && s->y == y && s->b == b) {
            s->age = ++c->clock;
            return s;
        }
        if (!s->used || (oldest->used && s->age < oldest->age))
            oldest = s;
    }
    // most points of a stick on its way feel no force: responses are found when asked for
    oldest->used = true;
    oldest->x = x;
    oldest->y = y;
    oldest->b = b;
    himc_modes_shapes(c->modes, c->config.head.radius, x, y, oldest->shape);
    spread(membrane, oldest);
    himc_modes_mix(c->modes, oldest->shape);
    himc_bank_readout(c->bank, oldest->shape, NULL, NULL, &oldest->readout);
    memset(oldest->responds, 0, sizeof oldest->responds);
    oldest->age = ++c->clock;
    return oldest;
}

double himc_strike_point_displacement(const himc_membrane *membrane, strike_point *s)
{
    return himc_bank_read(membrane->model->bank, &s->readout);
}

himc_residual himc_strike_point_residual(const strike_point *s)
{
    return s->residual;
}

double himc_strike_point_compliance(himc_membrane *membrane, strike_point *a, strike_point *b)
{
    return a == b ? himc_strike_point_response(membrane, a, membrane->step)->compliance
                  : himc_bank_response(membrane->model->bank, b->shape, &a->readout);
}

static bool has_wires(const himc_membrane *m)
{
    return m->model->under.shape && m->model->config.head.wires > 0;
}

static void read_under(const himc_membrane *m, double *displacement)
{
    himc_bank_read_rows(m->model->bank, m->model->under.shape, displacement);
}

void himc_membrane_begin_wires(himc_membrane *m, double h, double *b)
{
    double under[HIMC_WIRES];
    read_under(m, under);
    himc_wires_begin(&m->wires, under, m->model->config.head.wires, h, b);
}

void himc_membrane_end_wires(himc_membrane *m, double h, const double *b)
{
    himc_under *u = &m->model->under;
    himc_bank_push_rows(m->model->bank, u->shape, m->wires.force);
    for (int k = 0; k < HIMC_OUTPUTS; k++)
        for (int i = 0; i < HIMC_WIRES && himc_membrane_has(m, k); i++)
            m->sound[k] += u->sound[m->step][k][i] * m->wires.force[i];
    himc_wires_end(&m->wires, m->model->config.head.wires, h, u->compliance[m->step], b);
}

void himc_membrane_rattle(himc_membrane *m, double h)
{
    double b[HIMC_WIRES], pull = m->model->config.head.wires;
    if (!m->wires.awake)
        return;
    himc_membrane_begin_wires(m, h, b);
    himc_wires_solve(&m->wires, pull, h, m->model->under.compliance[m->step], b);
    himc_membrane_end_wires(m, h, b);
}

void himc_membrane_keep_wires(himc_membrane *m, double pull_before)
{
    double under[HIMC_WIRES];
    if (!m->wires.awake)
        return;
    if (!has_wires(m) || m->model->config.head.wires != pull_before) {
        m->wires = (himc_wires){.awake = has_wires(m)};
        if (!has_wires(m))
            return;
    }
    read_under(m, under);
    himc_wires_follow(&m->wires, under);
}

void himc_strike_point_apply(himc_membrane *membrane, strike_point *s, double force)
{
    if (force == 0)
        return;
    himc_bank_push(membrane->model->bank, s->shape, force);
    const himc_unit_response *e = himc_strike_point_response(membrane, s, membrane->step);
    for (int i = 0; i < HIMC_OUTPUTS; i++)
        if (himc_membrane_has(membrane, i))
            membrane->sound[i] += e->sound[i] * force;
    if (membrane->applied_count < HIMC_STRIKE_POINTS)
        membrane->applied[membrane->applied_count++] = (himc_push){s->x, s->y, s->b, force};
    if (has_wires(membrane) && !membrane->wires.awake) {
        double under[HIMC_WIRES];
        read_under(membrane, under);
        himc_wires_rest(&membrane->wires, under);
    }
}

static bool swings(const himc_membrane *m)
{
    return m->model->config.head.motor > 0 || m->disc > 0;
}

// Takes from the sound of n steps what the discs keep back. A force in the present step, whose
// sound is added after, is heard as if they were open.
static void swing(himc_membrane *m, int n, const double *tubes, double *const *sound)
{
    const himc_membrane_config *c = &m->model->config;
    m->speed = c->head.motor > 0 ? c->head.motor : m->speed;
    for (int i = 0; i < n; i++) {
        double less = 0.5 * SHUT * (1 - cos(2 * HIMC_PI * m->disc)) * tubes[i];
        for (int k = 0; k < HIMC_OUTPUTS; k++) {
            const himc_pickup *p = &c->pickups[k];
            if (himc_membrane_has(m, k) && sound[k] && p->kind == HIMC_PICKUP_AIR)
                sound[k][i] -= k < HIMC_PICKUPS ? less / p->distance : less;
        }
        m->disc += m->ends_sample ? m->speed / c->rate : 0;
        if (m->disc >= 1)
            m->disc = c->head.motor > 0 ? m->disc - 1 : 0;
    }
}

// runs n steps without forces, at most a pass if a motor swings; adds the declicks to the sound
static void run_free(himc_membrane *m, int n, double *const *sound, double *watched)
{
    himc_model *c = m->model;
    himc_readout *readouts[HIMC_OUTPUTS + 2];
    double *out[HIMC_OUTPUTS + 2], tubes[HIMC_BANK_PASS];
    int count = 0;
    bool swung = swings(m);
    if (himc_bank_at_rest(c->bank))
        m->disc = 0;
    for (int k = 0; k < HIMC_OUTPUTS; k++)
        if (himc_membrane_has(m, k)) {
            readouts[count] = &c->outputs[k].readout;
            out[count++] = sound[k];
        }
    readouts[count] = &c->watched;
    out[count++] = watched;
    readouts[count] = &c->tubes;
    out[count] = tubes;
    himc_bank_run(c->bank, n, readouts, count + swung, out);
    if (swung)
        swing(m, n, tubes, sound);
    m->applied_count = 0;
    for (int k = 0; k < HIMC_OUTPUTS; k++) {
        if (!himc_membrane_has(m, k))
            continue;
        declick *d = &m->declicks[k];
        for (int i = 0; i < n && m->ends_sample && d->at <= d->length; i++, d->at++)
            if (sound[k])
                sound[k][i] += declick_at(d, d->at);
        m->sound[k] = sound[k] ? sound[k][n - 1] : 0;
    }
}

void himc_membrane_ready(himc_membrane *membrane)
{
    himc_bank_ready(membrane->model->bank);
}

void himc_membrane_free_step(himc_membrane *membrane)
{
    double sound[HIMC_OUTPUTS], *into[HIMC_OUTPUTS];
    for (int k = 0; k < HIMC_OUTPUTS; k++)
        into[k] = himc_membrane_has(membrane, k) ? &sound[k] : NULL;
    run_free(membrane, 1, into, NULL);
    for (int i = 0; i < membrane->push_count; i++) {
        const himc_push *p = &membrane->pushes[i];
        himc_strike_point_apply(membrane, himc_membrane_strike_point(membrane, p->x, p->y, p->b),
                                -p->force);
    }
    if (membrane->ends_sample)
        membrane->push_count = 0;
}

void himc_membrane_run_all(himc_membrane *membrane, int n, double *const *sound, double *watched)
{
    double *rest[HIMC_OUTPUTS];
    int i = 0;
    for (; i < n && (membrane->push_count > 0 || membrane->wires.awake); i++) {
        himc_membrane_free_step(membrane);
        himc_membrane_rattle(membrane, 1 / membrane->model->config.rate);
        for (int k = 0; k < HIMC_OUTPUTS; k++)
            if (himc_membrane_has(membrane, k) && sound[k])
                sound[k][i] = membrane->sound[k];
        if (watched)
            watched[i] = himc_membrane_watched(membrane);
    }
    for (int run; i < n; i += run) {
        run = swings(membrane) && n - i > HIMC_BANK_PASS ? HIMC_BANK_PASS : n - i;
        for (int k = 0; k < HIMC_OUTPUTS; k++)
            rest[k] = himc_membrane_has(membrane, k) && sound[k] ? sound[k] + i : NULL;
        run_free(membrane, run, rest, watched ? watched + i : NULL);
    }
}

void himc_membrane_run(himc_membrane *membrane, int n, double *const *sound, double *watched)
{
    double *rows[HIMC_OUTPUTS] = {NULL};
    for (int k = 0; k < membrane->model->config.pickup_count; k++)
        rows[k] = sound[k];
    himc_membrane_run_all(membrane, n, rows, watched);
}

void himc_membrane_push(himc_membrane *membrane, double x, double y, double force)
{
    if (membrane->push_count < MAX_PUSHES)
        membrane->pushes[membrane->push_count++] = (himc_push){x, y, 0, force};
}

double himc_membrane_sound(const himc_membrane *membrane, int pickup)
{
    return membrane->sound[pickup];
}

double himc_membrane_watched(const himc_membrane *membrane)
{
    // only what is known of the coming samples changes, which nobody can see
    return himc_bank_read(membrane->model->bank, &((himc_membrane *)membrane)->model->watched);
}

double himc_membrane_energy(const himc_membrane *membrane)
{
    double s = himc_bank_film(membrane->model->bank);
    return himc_bank_energy(membrane->model->bank) + 0.5 * s * s +
           himc_wires_energy(&membrane->wires, membrane->model->config.head.wires);
}

himc_bank_bounds himc_membrane_bounds(himc_membrane *membrane)
{
    if (!membrane->model->config.shape.kind->largest)
        return (himc_bank_bounds){INFINITY, INFINITY};
    return himc_bank_bounds_of(membrane->model->bank, membrane->model->most);
}

bool himc_membrane_at_rest(const himc_membrane *membrane)
{
    bool rest = membrane->push_count == 0 && !membrane->wires.awake &&
                himc_bank_at_rest(membrane->model->bank);
    for (int k = 0; k < HIMC_OUTPUTS; k++)
        if (himc_membrane_has(membrane, k))
            rest = rest && membrane->declicks[k].at >= membrane->declicks[k].length;
    return rest;
}
