/// bank.c: each oscillator's exact step is a rotation.
///
/// With w_d = sqrt(w^2 - d^2), the coordinates p = w_d q and s = q' + d q rotate by the angle w_d h
/// and shrink by exp(-d h) in a step of length h:
///     p' = C p + S s,   s' = C s - S p,   C = exp(-d h) cos w_d h,   S = exp(-d h) sin w_d h.
/// A force f constant over the step adds b1 f to q and b2 f to q' (zero-order hold), b1 = (1 -
/// a11)/(m w^2) with a11 = C + d S/w_d, and b2 = S/(m w_d); in p, s: w_d b1 f and (b2 + d b1) f.
///
/// p and s do not depend on h, so steps of two lengths, a sample and a substep, may follow each
/// other in any order: the bank keeps a set of coefficients for each length.
///
/// After a force, the state makes one step of one sample. Then, as long as none acts, it makes
/// steps of 64 samples, a pass; the samples within it are read from the state at its start
/// (bank_read.c). When a force ends the pass early, the state makes the steps of 32, 16, .. samples
/// that lead there. So the steps hang on the forces alone, not on how many samples are asked for at
/// a time. The film (bank_film.c) acts between steps.
///
/// The order of all sums is fixed (bank_kernel.h): the same bits on any machine. About every 1024
/// samples the oscillators at the top that have fallen below 1e-8 m/s are set to rest and skipped
/// until the next force: high modes die first, and denormal numbers never arise. That takes energy,
/// and of a sound at most 1e-8 m/s times the sum of its weights: 200 modes of one stroke, which
/// began with 1 m/s, lack 160 dB of its peak.
#include "bank/bank_state.h"

#include <math.h>
#include <string.h>

#define QUIET 1e-8         // (m/s) of p and s; chosen: 160 dB below a stroke
#define TIDY_INTERVAL 1024 // least samples between two searches for quiet ones; chosen: 20 ms
#define BOUNDS_TIME 256    // samples between two searches for the bounds; chosen: they cost nothing
#define FILM_SWING 2.0     // growth of a swing by what the film gives back; chosen

// a step of its own: a sample after a force, or a substep
static void single_step(himc_bank *bank)
{
    double samples = bank->kind == HIMC_STEP_SUBSTEP ? 1.0 / bank->substeps : 1;
    bank_arrive(bank);
    if (bank->film.level > 0)
        himc_bank_exchange(bank, 0);
    bank->film.level = 0;
    himc_bank_exchange(bank, samples / 2);
    bank->loops->rotate(bank->p, bank->s, bank->present.c, bank->present.s, bank->live);
    bank->film.lead -= samples;
    bank->cascade.since += samples;
    bank->age++;
    bank->forced = false;
    bank->bounds_left = 0;
}

void himc_bank_ready(himc_bank *bank)
{
    if (bank->at < bank->length)
        return;
    if (himc_bank_cascade_due(bank))
        himc_bank_scatter(bank);
    if (bank->forced || bank->kind == HIMC_STEP_SUBSTEP)
        return;
    bank_arrive(bank);
    himc_bank_turn(bank);
}

// from time to time sets the quiet oscillators at the top to rest
static void begin_pass(himc_bank *bank)
{
    bank_film *f = &bank->film;
    bool tidies = bank->age >= TIDY_INTERVAL && !bank->cascade.acts;
    if (tidies) {
        int live = bank->live;
        while (live > 0 && fabs(bank->p[live - 1]) < QUIET && fabs(bank->s[live - 1]) < QUIET) {
            live--;
            bank->p[live] = bank->s[live] = 0;
        }
        bank->live = bank_round_up(live);
        bank->age = 0;
    }
    if (f->on && (tidies || f->moved))
        himc_bank_anchor(bank);
    bank->length = bank->whole_pass;
    bank->step = f->on && bank_steps[f->level] < bank->length ? bank_steps[f->level] : bank->length;
    bank->low = f->on ? bank_coupled(bank) : 0;
}

// samples that the present step can give, at most n; begins the next one at its end
static int go_on(himc_bank *bank, int n)
{
    if (bank->at == bank->length) {
        himc_bank_ready(bank);
        begin_pass(bank);
    } else if (bank->step_at == bank->step) {
        bank_rotate(bank, 0, bank->low, bank->step);
        bank->film.lead -= bank->step;
        bank->step_at = 0;
    }
    if (bank->step_at == 0) {
        bank->part++;
        himc_bank_exchange(bank, 0.5 * bank->step);
    }
    int left = bank->step - bank->step_at;
    return n < left ? n : left;
}

void himc_bank_run(himc_bank *bank, int n, himc_readout *const *readouts, int count,
                   double *const *out)
{
    for (int done = 0, run; done < n; done += run) {
        bool single = bank->forced || bank->kind == HIMC_STEP_SUBSTEP;
        run = single ? 1 : go_on(bank, n - done);
        if (single) {
            himc_bank_ready(bank);
            single_step(bank);
        }
        for (int k = 0; k < count; k++) {
            if (!out[k])
                continue;
            if (bank->live == 0)
                memset(out[k] + done, 0, sizeof **out * (size_t)run);
            else if (single)
                out[k][done] = himc_bank_read_single(bank, readouts[k]);
            else
                himc_bank_read_ahead(bank, readouts[k], run, out[k] + done);
        }
        bank->at += single ? 0 : run;
        bank->cascade.since += single ? 0 : run;
        bank->step_at += single ? 0 : run;
        bank->age += single ? 0 : run;
        bank->bounds_left -= run;
    }
}

// for how long the bank has been at rest, some of it not run, makes no difference
static void begin_anew(himc_bank *bank)
{
    if (bank->live > 0)
        return;
    bank->age = bank->bounds_left = 0;
    bank->cascade.since = bank->cascade.turn = 0;
    bank->cascade.acts = false;
}

void himc_bank_push(himc_bank *bank, const double *shape, double force)
{
    bank_arrive(bank);
    begin_anew(bank);
    bank->live = bank_round_up(bank->count);
    bank->age = 0;
    bank->forced = true;
    if (!bank->film.on)
        himc_bank_slacken(bank);
    bank->film.on = bank->film.moved = bank->film.set;
    bank->loops->push(bank->p, bank->s, bank->push.p, bank->push.s, shape, force, bank->live);
}

// an oscillator moves
static void stir(himc_bank *bank, int index)
{
    begin_anew(bank);
    if (index >= bank->live)
        bank->live = bank_round_up(index + 1);
}

void himc_bank_kick(himc_bank *bank, int index, double change)
{
    if (index >= bank->count)
        return;
    bank_arrive(bank);
    bank->s[index] += change;
    bank->bounds.swing += HIMC_BANK_MOST * fabs(change) * bank->q_per_p[index];
    bank->bounds.speed += HIMC_BANK_MOST * fabs(change);
    stir(bank, index);
}

void himc_bank_slow(himc_bank *bank, double part)
{
    bank_arrive(bank);
    for (int i = 0; i < bank->live; i++)
        bank->s[i] *= 1 - part;
}

void himc_bank_excite(himc_bank *bank, int index, double q, double v)
{
    if (index >= bank->count)
        return;
    himc_bank_settle(bank);
    bank->p[index] = bank->damped[index] * q;
    bank->s[index] = v + bank->decay[index] * q;
    if (bank->p[index] == 0 && bank->s[index] == 0)
        himc_bank_wake(bank);
    else
        stir(bank, index);
    bank->forced = true;
}

void himc_bank_wake(himc_bank *bank)
{
    int live = bank->count;
    while (live > 0 && bank->p[live - 1] == 0 && bank->s[live - 1] == 0)
        live--;
    bank->live = bank_round_up(live);
}

void himc_bank_rest(himc_bank *bank)
{
    memset(bank->p, 0, sizeof(double) * (size_t)bank->capacity);
    memset(bank->s, 0, sizeof(double) * (size_t)bank->capacity);
    bank->live = bank->age = 0;
    himc_bank_settle(bank);
    himc_bank_slacken(bank);
    bank->forced = true;
}

void himc_bank_state(const himc_bank *bank, int index, double *q, double *v)
{
    *q = *v = 0;
    if (index >= bank->count)
        return;
    double p, s;
    bank_present(bank, index, &p, &s);
    *q = p / bank->damped[index];
    *v = s - bank->decay[index] * *q;
}

double himc_bank_energy(const himc_bank *bank)
{
    double sum = 0;
    for (int i = 0; i < bank->live && i < bank->count; i++) {
        double q, v;
        himc_bank_state(bank, i, &q, &v);
        double w = bank->omega[i] * q;
        sum += 0.5 * bank->mass[i] * (v * v + w * w);
    }
    return sum;
}

himc_bank_bounds himc_bank_bounds_of(himc_bank *bank, const double *most)
{
    himc_bank_bounds *b = &bank->bounds;
    if (bank->forced || bank->bounds_left <= 0) {
        *b = (himc_bank_bounds){0};
        for (int i = 0; i < bank->live; i++) {
            double size = most[i] * sqrt(bank->p[i] * bank->p[i] + bank->s[i] * bank->s[i]);
            b->swing += bank->q_per_p[i] * size;
            b->speed += (1 + bank->film.damp[i]) * size; // q' = s - d q
        }
        bank->bounds_left = BOUNDS_TIME;
    }
    double film = bank->film.on ? FILM_SWING : 1;
    return (himc_bank_bounds){film * b->swing, film * b->speed};
}

bool himc_bank_at_rest(const himc_bank *bank)
{
    return bank->live == 0;
}

void himc_bank_use(himc_bank *bank, const himc_bank_kernel *kernel)
{
    bank->loops = kernel;
}

int himc_bank_padded(const himc_bank *bank)
{
    return bank->capacity;
}

int himc_bank_count(const himc_bank *bank)
{
    return bank->count;
}

void himc_bank_set_substeps(himc_bank *bank, int count)
{
    bank->substeps = count;
}

void himc_bank_set_step(himc_bank *bank, himc_step_length step)
{
    bank->kind = step;
    bank->present = step == HIMC_STEP_SUBSTEP ? bank->sub : bank->power[0];
    bank->push = step == HIMC_STEP_SUBSTEP ? bank->parted : bank->whole;
}

void himc_bank_set_pass(himc_bank *bank, int samples)
{
    bank->whole_pass = samples;
}
