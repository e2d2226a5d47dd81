/// membrane_step.c: a sample of the head: free, pushed, stretched.
///
/// A head that bows out is longer, so its film pulls harder. With Berger's assumption of a uniform
/// tension (H. M. Berger 1955; Avanzini & Marogna 2010) it rises by kappa int |grad w|^2 dS, and
/// the energy of stretching is s^2/2 with
///     s = sqrt(kappa/2) sum_i Lam_i q_i^2,   Lam_i = int |grad phi_i|^2 dS,
///     kappa = E h_f/(2 (1 - nu^2) area).
/// Over a sample the film holds the modal forces -s_mean g: g the mean of ds/dq before the sample
/// and after its free motion, s_mean = s + u/2, and s' = s + u with u = g . (q' - q). So the film
/// gains s'^2/2 - s^2/2 = s_mean u, just the work done on it: passive for any step, and as the
/// modes answer a force linearly, one division solves it (energy quadratisation: Ducceschi & Bilbao
/// 2019). With sticks of forces F at shapes phi, and P = phi . B g (B what modes yield per newton),
///     u = (g . (q_free - q) - gBg s - P F)/(1 + gBg/2)
/// is linear in F, so it only adds to the compliances of the contact (contact.c).
///
/// When twice the energy could not raise the tension by a millionth, 0.001 cent, the film is left
/// alone until the next force: the bank then runs in long passes. That look comes after every 64
/// samples from when it began, whatever the blocks, and gives up the last of s, so energy falls.
#include "drum/membrane_state.h"

#include <math.h>

#define SLACK 1e-6    // of the tension
#define FINE 192000.0 // (Hz) steps of stiff contacts

// finds the spot's shapes and what a newton there does
static void place_spot(himc_membrane *m, spot *s, double x, double y)
{
    const core *c = &m->core;
    s->used = true;
    s->x = x;
    s->y = y;
    himc_modes_shapes(c->modes, m->head.radius, x, y, s->shape);
    himc_bank_readout(c->bank, s->shape, NULL, &s->tap);
    for (int g = 0; g < HIMC_BANK_SUBSTEPS; g++) {
        effect *e = &s->effect[g];
        himc_bank_set_substep(c->bank, g);
        e->compliance = himc_bank_response(c->bank, s->shape, &s->tap);
        for (int i = 0; i < m->pickup_count; i++)
            e->heard[i] = himc_bank_sum(c->bank, s->shape, c->ears[i].answer[g]);
        e->seen = himc_bank_sum(c->bank, s->shape, c->watch_answer[g]);
    }
    himc_bank_set_substep(c->bank, m->gear);
}

int himc_membrane_parts(const himc_membrane *membrane)
{
    return (int)ceil(FINE / membrane->rate);
}

void himc_membrane_part(himc_membrane *membrane, int index, int parts)
{
    membrane->gear = parts > 1;
    membrane->part_last = index == parts - 1;
    himc_bank_set_substep(membrane->core.bank, membrane->gear);
}

const effect *himc_strike_point_effect(const himc_membrane *membrane, const spot *s)
{
    return &s->effect[membrane->gear];
}

spot *himc_membrane_strike_point(himc_membrane *membrane, double x, double y)
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

double himc_strike_point_displacement(const himc_membrane *membrane, const spot *s)
{
    return himc_bank_displacement(membrane->core.bank, &s->tap);
}

double himc_strike_point_pull(const himc_membrane *membrane, const spot *s)
{
    const core *c = &membrane->core;
    return membrane->tension.on ? himc_bank_response(c->bank, c->pull.shape, &s->tap) : 0;
}

double himc_strike_point_compliance(const himc_membrane *membrane, const spot *a, const spot *b)
{
    return himc_bank_response(membrane->core.bank, b->shape, &a->tap);
}

double himc_membrane_tension(const himc_membrane *membrane, double *half)
{
    *half = membrane->tension.on ? membrane->tension.half : 0;
    return membrane->tension.on ? membrane->tension.base : 0;
}

void himc_strike_point_apply(himc_membrane *membrane, const spot *s, double force)
{
    if (force == 0)
        return;
    himc_bank_push(membrane->core.bank, s->shape, force);
    const effect *e = himc_strike_point_effect(membrane, s);
    for (int i = 0; i < membrane->pickup_count; i++)
        membrane->heard[i] += e->heard[i] * force;
    membrane->seen += e->seen * force;
    if (membrane->pressed_count < SPOTS)
        membrane->pressed[membrane->pressed_count++] = (push){s->x, s->y, force};
    if (membrane->head.glide > 0 && !membrane->tension.on)
        membrane->tension = (tension){.on = true};
}

// n samples of the bank, the fades added
static void advance(himc_membrane *m, int n, double *const *heard, double *seen)
{
    const core *c = &m->core;
    const himc_readout *taps[HIMC_PICKUPS + 1];
    double *read[HIMC_PICKUPS + 1];
    int count = m->pickup_count;
    for (int k = 0; k < count; k++) {
        taps[k] = &c->ears[k].tap;
        read[k] = heard[k];
    }
    taps[count] = &c->watch;
    read[count] = seen;
    himc_bank_run(c->bank, n, taps, count + 1, read);
    m->pressed_count = 0;
    for (int k = 0; k < count; k++) {
        fade *f = &m->fades[k];
        for (int i = 0; i < n && m->part_last && f->at < f->length; i++)
            heard[k][i] += fade_at(f, f->at++);
        m->heard[k] = heard[k][n - 1];
    }
    m->seen = seen[n - 1];
}

// a stretched film's sample: the modes free, and what the film meets in it
static void advance_stretched(himc_membrane *m)
{
    core *c = &m->core;
    tension *t = &m->tension;
    himc_bank_run_coupled(c->bank, c->weight, &c->pull);
    m->pressed_count = 0;
    double yielding = 1 + 0.5 * c->pull.compliance;
    t->half = 0.5 / yielding;
    t->base = t->s + t->half * (c->pull.climb - c->pull.compliance * t->s);
    for (int k = 0; k < m->pickup_count; k++) {
        fade *f = &m->fades[k];
        m->heard[k] = himc_bank_read(c->bank, &c->ears[k].tap);
        if (m->part_last && f->at < f->length)
            m->heard[k] += fade_at(f, f->at++);
    }
    m->seen = himc_bank_displacement(c->bank, &c->watch);
}

// the highest the film's pull could become, per the head's tension
static double stretched(const himc_membrane *m)
{
    double kappa = himc_membrane_film(m);
    return 2 * kappa * himc_bank_energy(m->core.bank) / (m->head.tension * m->head.tension);
}

double himc_membrane_rise(const himc_membrane *membrane)
{
    return sqrt(2 * himc_membrane_film(membrane)) * membrane->tension.s;
}

void himc_membrane_settle(himc_membrane *membrane, double taken)
{
    core *c = &membrane->core;
    tension *t = &membrane->tension;
    if (!t->on || !isfinite(taken))
        return;
    double mean = t->base - t->half * taken;
    himc_bank_push(c->bank, c->pull.shape, -mean);
    for (int k = 0; k < membrane->pickup_count; k++)
        membrane->heard[k] -=
            mean * himc_bank_sum(c->bank, c->pull.shape, c->ears[k].answer[membrane->gear]);
    membrane->seen -= mean * himc_bank_sum(c->bank, c->pull.shape, c->watch_answer[membrane->gear]);
    t->s += 2 * (mean - t->s);
    if (++t->glance % GLANCE == 0 && stretched(membrane) < SLACK)
        *t = (tension){.on = false};
}

double himc_membrane_free_step(himc_membrane *membrane)
{
    double heard[HIMC_PICKUPS], *into[HIMC_PICKUPS], seen, taken = 0;
    for (int k = 0; k < HIMC_PICKUPS; k++)
        into[k] = &heard[k];
    bool stretching = membrane->tension.on;
    if (stretching)
        advance_stretched(membrane);
    else
        advance(membrane, 1, into, &seen);
    for (int i = 0; i < membrane->push_count; i++) {
        const push *p = &membrane->pushes[i];
        spot *s = himc_membrane_strike_point(membrane, p->x, p->y);
        taken += stretching ? himc_strike_point_pull(membrane, s) * p->force : 0;
        himc_strike_point_apply(membrane, s, -p->force);
    }
    if (membrane->part_last)
        membrane->push_count = 0;
    return taken;
}

// one sample without contact
static void step(himc_membrane *m)
{
    himc_membrane_settle(m, himc_membrane_free_step(m));
}

void himc_membrane_run_all(himc_membrane *membrane, int n, double *const *heard, double *seen)
{
    double *rest[HIMC_PICKUPS];
    int i = 0;
    for (; i < n && (membrane->tension.on || membrane->push_count > 0); i++) {
        step(membrane);
        for (int k = 0; k < membrane->pickup_count; k++)
            heard[k][i] = membrane->heard[k];
        seen[i] = membrane->seen;
    }
    for (int k = 0; k < membrane->pickup_count; k++)
        rest[k] = heard[k] + i;
    if (i < n)
        advance(membrane, n - i, rest, seen + i);
}

void himc_membrane_run(himc_membrane *membrane, int n, double *heard, double *seen)
{
    double unheard[HIMC_PICKUPS][GLANCE], *into[HIMC_PICKUPS];
    for (int done = 0, m; done < n; done += m) {
        m = membrane->pickup_count == 1 || n - done < GLANCE ? n - done : GLANCE;
        for (int k = 0; k < HIMC_PICKUPS; k++)
            into[k] = k == 0 ? heard + done : unheard[k];
        himc_membrane_run_all(membrane, m, into, seen + done);
    }
}
