/// membrane_step.c: one sample of the head: free motion, forces, the film's stretching.
///
/// A head that bows out is longer, so its film pulls harder. With Berger's assumption of a uniform
/// tension (H. M. Berger 1955; Avanzini & Marogna 2010) the tension rises by kappa int |grad w|^2
/// dS, and the energy of stretching is s^2/2 with
///     s = sqrt(kappa/2) sum_i Lam_i q_i^2,   Lam_i = int |grad phi_i|^2 dS,
///     kappa = E h_f/(2 (1 - nu^2) area).
/// Over a sample the film applies the modal forces -s_mean g: g the mean of ds/dq before the sample
/// and after its free motion, s_mean = s + u/2, and s' = s + u with u = g . (q' - q). So the film
/// gains s'^2/2 - s^2/2 = s_mean u, exactly the work done on it: passive for any step, and as the
/// modes answer a force linearly, one division solves it (energy quadratisation: Ducceschi & Bilbao
/// 2019). With forces F of sticks at shapes phi, and P = phi . B g (B the modes' displacements per
/// newton),
///     u = (g . (q_free - q) - gBg s - P F)/(1 + gBg/2)
/// is linear in F, so it only adds to the compliances of the contact (contact.c). P is the film
/// coupling of a strike point, s_mean the film's force.
///
/// When the film could not raise the tension by a millionth, 0.001 cent, even with twice the energy
/// now in the head, it is switched off until the next force: the bank then runs in long passes.
/// This is checked every 64 steps since the film came on, so it does not depend on block sizes. The
/// rest of s is dropped, so energy falls.
#include "drum/membrane_state.h"

#include "drum/membrane_probe.h"

#include <math.h>

#define SLACK 1e-6            // rise per tension; chosen: 0.001 cent
#define SUBSTEP_RATE 192000.0 // (Hz) least rate of substeps; chosen: contact.c

// Young's modulus, Poisson's ratio and density of polyester film (Mylar), typical values; the
// thickness of a head follows from its mass
#define YOUNG 4e9 // (Pa)
#define POISSON 0.38
#define FILM 1390.0 // (kg/m^3)

// finds the point's shapes and the responses to a newton there
static void move_point(himc_membrane *m, strike_point *s, double x, double y)
{
    const core *c = &m->core;
    s->used = true;
    s->x = x;
    s->y = y;
    himc_modes_shapes(c->modes, m->head.radius, x, y, s->shape);
    himc_bank_readout(c->bank, s->shape, NULL, &s->readout);
    for (int k = 0; k < HIMC_STEP_LENGTHS; k++) {
        unit_response *e = &s->response[k];
        himc_bank_set_step(c->bank, (himc_step_length)k);
        e->compliance = himc_bank_response(c->bank, s->shape, &s->readout);
        for (int i = 0; i < m->pickup_count; i++)
            e->sound[i] = himc_bank_sum(c->bank, s->shape, c->pickups[i].response[k]);
        e->watched = himc_bank_sum(c->bank, s->shape, c->watched.response[k]);
    }
    himc_bank_set_step(c->bank, m->step);
}

int himc_membrane_substeps(const himc_membrane *membrane)
{
    return (int)ceil(SUBSTEP_RATE / membrane->rate);
}

void himc_membrane_set_substep(himc_membrane *membrane, int index, int count)
{
    membrane->step = count > 1 ? HIMC_STEP_SUBSTEP : HIMC_STEP_SAMPLE;
    membrane->ends_sample = index == count - 1;
    himc_bank_set_step(membrane->core.bank, membrane->step);
}

strike_point *himc_membrane_strike_point(himc_membrane *membrane, double x, double y)
{
    strike_point *oldest = &membrane->points[0];
    for (int i = 0; i < STRIKE_POINTS; i++) {
        strike_point *s = &membrane->points[i];
        if (s->used && s->x == x && s->y == y) {
            s->age = ++membrane->clock;
            return s;
        }
        if (!s->used || (oldest->used && s->age < oldest->age))
            oldest = s;
    }
    move_point(membrane, oldest, x, y);
    oldest->age = ++membrane->clock;
    return oldest;
}

double himc_strike_point_displacement(const himc_membrane *membrane, strike_point *s)
{
    return himc_bank_read(membrane->core.bank, &s->readout);
}

double himc_strike_point_film_coupling(const himc_membrane *membrane, const strike_point *s)
{
    const core *c = &membrane->core;
    return membrane->film.on ? himc_bank_response(c->bank, c->coupling.shape, &s->readout) : 0;
}

double himc_strike_point_compliance(const himc_membrane *membrane, const strike_point *a,
                                    const strike_point *b)
{
    return a == b ? a->response[membrane->step].compliance
                  : himc_bank_response(membrane->core.bank, b->shape, &a->readout);
}

double himc_membrane_film_force(const himc_membrane *membrane, double *half)
{
    *half = membrane->film.on ? membrane->film.half : 0;
    return membrane->film.on ? membrane->film.base : 0;
}

void himc_strike_point_apply(himc_membrane *membrane, const strike_point *s, double force)
{
    if (force == 0)
        return;
    himc_bank_push(membrane->core.bank, s->shape, force);
    const unit_response *e = &s->response[membrane->step];
    for (int i = 0; i < membrane->pickup_count; i++)
        membrane->sound[i] += e->sound[i] * force;
    membrane->watched += e->watched * force;
    if (membrane->applied_count < STRIKE_POINTS)
        membrane->applied[membrane->applied_count++] = (push){s->x, s->y, force};
    if (membrane->head.glide > 0 && !membrane->film.on)
        membrane->film = (film){.on = true};
}

double himc_membrane_film_stiffness(const himc_membrane *m)
{
    double thickness = m->head.density / FILM;
    double area = himc_modes_area(m->core.modes, m->head.radius);
    return m->head.glide * YOUNG * thickness / (2 * (1 - POISSON * POISSON) * area);
}

void himc_membrane_find_film(himc_membrane *m)
{
    film *f = &m->film;
    f->s = 0;
    for (int i = 0; i < m->head.modes; i++) {
        double q, v;
        himc_bank_state(m->core.bank, i, &q, &v);
        f->s += 0.5 * m->core.stretch[i] * q * q;
    }
    f->on = f->s > 0;
}

double himc_membrane_rise(const himc_membrane *membrane)
{
    return sqrt(2 * himc_membrane_film_stiffness(membrane)) * membrane->film.s;
}

// runs n steps without the film; adds the declicks to the sound
static void run_free(himc_membrane *m, int n, double *const *sound, double *watched)
{
    core *c = &m->core;
    himc_readout *readouts[HIMC_PICKUPS + 1];
    double *out[HIMC_PICKUPS + 1];
    int count = m->pickup_count;
    for (int k = 0; k < count; k++) {
        readouts[k] = &c->pickups[k].readout;
        out[k] = sound[k];
    }
    readouts[count] = &c->watched.readout;
    out[count] = watched;
    himc_bank_run(c->bank, n, readouts, count + 1, out);
    m->applied_count = 0;
    for (int k = 0; k < count; k++) {
        declick *d = &m->declicks[k];
        for (int i = 0; i < n && m->ends_sample && d->at <= d->length; i++, d->at++)
            if (sound[k])
                sound[k][i] += declick_at(d, d->at);
        m->sound[k] = sound[k] ? sound[k][n - 1] : 0;
    }
    m->watched = watched ? watched[n - 1] : 0;
}

// runs one step of the modes with the film stretched; finds the terms of the film's force
static void run_stretched(himc_membrane *m)
{
    core *c = &m->core;
    film *f = &m->film;
    himc_bank_run_coupled(c->bank, c->weight, &c->coupling);
    m->applied_count = 0;
    double resistance = 1 + 0.5 * c->coupling.compliance;
    f->half = 0.5 / resistance;
    f->base = f->s + f->half * (c->coupling.change - c->coupling.compliance * f->s);
    for (int k = 0; k < m->pickup_count; k++) {
        declick *d = &m->declicks[k];
        m->sound[k] = himc_bank_read(c->bank, &c->pickups[k].readout);
        if (m->ends_sample && d->at <= d->length)
            m->sound[k] += declick_at(d, d->at++);
    }
    m->watched = himc_bank_read(c->bank, &c->watched.readout);
}

// the highest rise of tension that the energy in the head could give, per tension
static double largest_rise(const himc_membrane *m)
{
    double kappa = himc_membrane_film_stiffness(m);
    return 2 * kappa * himc_bank_energy(m->core.bank) / (m->head.tension * m->head.tension);
}

void himc_membrane_end_step(himc_membrane *membrane, double coupled)
{
    core *c = &membrane->core;
    film *f = &membrane->film;
    if (!f->on || !isfinite(coupled))
        return;
    double mean = f->base - f->half * coupled;
    himc_bank_push(c->bank, c->coupling.shape, -mean);
    for (int k = 0; k < membrane->pickup_count; k++)
        membrane->sound[k] -= mean * himc_bank_sum(c->bank, c->coupling.shape,
                                                   c->pickups[k].response[membrane->step]);
    membrane->watched -=
        mean * himc_bank_sum(c->bank, c->coupling.shape, c->watched.response[membrane->step]);
    f->s += 2 * (mean - f->s);
    if (++f->age % FILM_CHECK_INTERVAL == 0 && largest_rise(membrane) < SLACK)
        *f = (film){.on = false};
}

double himc_membrane_free_step(himc_membrane *membrane)
{
    double sound[HIMC_PICKUPS], *into[HIMC_PICKUPS], watched, coupled = 0;
    for (int k = 0; k < HIMC_PICKUPS; k++)
        into[k] = &sound[k];
    bool stretching = membrane->film.on;
    if (stretching)
        run_stretched(membrane);
    else
        run_free(membrane, 1, into, &watched);
    for (int i = 0; i < membrane->push_count; i++) {
        const push *p = &membrane->pushes[i];
        strike_point *s = himc_membrane_strike_point(membrane, p->x, p->y);
        coupled += stretching ? himc_strike_point_film_coupling(membrane, s) * p->force : 0;
        himc_strike_point_apply(membrane, s, -p->force);
    }
    if (membrane->ends_sample)
        membrane->push_count = 0;
    return coupled;
}

void himc_membrane_run(himc_membrane *membrane, int n, double *const *sound, double *watched)
{
    double *rest[HIMC_PICKUPS];
    int i = 0;
    for (; i < n && (membrane->film.on || membrane->push_count > 0); i++) {
        himc_membrane_end_step(membrane, himc_membrane_free_step(membrane));
        for (int k = 0; k < membrane->pickup_count; k++)
            if (sound[k])
                sound[k][i] = membrane->sound[k];
        if (watched)
            watched[i] = membrane->watched;
    }
    for (int k = 0; k < membrane->pickup_count; k++)
        rest[k] = sound[k] ? sound[k] + i : NULL;
    if (i < n)
        run_free(membrane, n - i, rest, watched ? watched + i : NULL);
}

void himc_membrane_push(himc_membrane *membrane, double x, double y, double force)
{
    if (membrane->push_count < MAX_PUSHES)
        membrane->pushes[membrane->push_count++] = (push){x, y, force};
}

double himc_membrane_sound(const himc_membrane *membrane, int pickup)
{
    return membrane->sound[pickup];
}

double himc_membrane_watched(const himc_membrane *membrane)
{
    return membrane->watched;
}

double himc_membrane_displacement(const himc_membrane *membrane, double x, double y)
{
    // only the cache of points changes, which nobody can see
    return himc_strike_point_displacement(
        membrane, himc_membrane_strike_point((himc_membrane *)membrane, x, y));
}

double himc_membrane_energy(const himc_membrane *membrane)
{
    double s = membrane->film.s;
    return himc_bank_energy(membrane->core.bank) + 0.5 * s * s;
}
