/// bank.c: the exact step as a rotation.
///
/// With w_d = sqrt(w^2 - d^2), the coordinates p = w_d q and s = q' + d q turn by the angle w_d h
/// and shrink by exp(-d h) in a sample of length h:
///     p' = C p + S s,   s' = C s - S p,   C = exp(-d h) cos w_d h,   S = exp(-d h) sin w_d h.
/// A force f constant over the sample adds b1 f to q and b2 f to q' (zero-order hold), b1 = (1 -
/// a11)/(m w^2) with a11 = C + d S/w_d, and b2 = S/(m w_d); in p, s: w_d b1 f and (b2 + d b1) f.
///
/// p and s do not depend on h, so steps of two lengths, a sample and a part of one, follow each
/// other freely: the bank has a set of coefficients, a gear, for each (bank_run.c swings by the
/// present one).
#include "drum/bank_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ARRAYS (7 + 4 * HIMC_BANK_SUBSTEPS)

himc_bank *himc_bank_new(int capacity, himc_error *error)
{
    capacity = (capacity + LANES - 1) / LANES * LANES;
    size_t length = (size_t)capacity, bytes = ARRAYS * length * sizeof(double);
    himc_bank *bank = aligned_alloc(64, (sizeof *bank + 63) / 64 * 64);
    double *memory = aligned_alloc(64, (bytes + 63) / 64 * 64);
    if (!bank || !memory) {
        free(bank);
        free(memory);
        himc_error_set(error, "modes: no memory for %d modes", capacity);
        return NULL;
    }
    memset(bank, 0, sizeof *bank);
    memset(memory, 0, bytes);
    bank->capacity = capacity;
    bank->memory = memory;
    bank_gear *whole = &bank->gears[0], *part = &bank->gears[1];
    double **arrays[ARRAYS] = {&bank->p,       &bank->s,       &bank->omega,   &bank->decay,
                               &bank->mass,    &bank->damped,  &bank->yield,   &whole->turn_c,
                               &whole->turn_s, &whole->push_p, &whole->push_s, &part->turn_c,
                               &part->turn_s,  &part->push_p,  &part->push_s};
    for (int i = 0; i < ARRAYS; i++)
        *arrays[i] = memory + (size_t)i * length;
    bank->parts = 1;
    himc_bank_set_substep(bank, 0);
    return bank;
}

void himc_bank_free(himc_bank *bank)
{
    if (!bank)
        return;
    free(bank->memory);
    free(bank);
}

int himc_bank_padded(const himc_bank *bank)
{
    return bank->capacity;
}

int himc_bank_count(const himc_bank *bank)
{
    return bank->count;
}

void himc_bank_divide(himc_bank *bank, int parts)
{
    bank->parts = parts;
}

void himc_bank_set_substep(himc_bank *bank, int gear)
{
    const bank_gear *g = &bank->gears[gear];
    bank->turn_c = g->turn_c;
    bank->turn_s = g->turn_s;
    bank->push_p = g->push_p;
    bank->push_s = g->push_s;
}

// coefficients of one oscillator for steps of length h
static void cut(const bank_gear *gear, int i, const himc_oscillator *o, double damped, double h)
{
    double shrink = exp(-o->decay * h), half = sin(0.5 * damped * h);
    double c = shrink * cos(damped * h), s = shrink * sin(damped * h);
    // 1 - a11 = (1 - C) - d S/w_d without the cancellation in 1 - C
    double fall = -expm1(-o->decay * h) + 2 * shrink * half * half - o->decay / damped * s;
    double b1 = fall / (o->mass * o->omega * o->omega), b2 = s / (o->mass * damped);
    gear->turn_c[i] = c;
    gear->turn_s[i] = s;
    gear->push_p[i] = damped * b1;
    gear->push_s[i] = b2 + o->decay * b1;
}

static void tune(himc_bank *bank, int i, const himc_oscillator *o, double h)
{
    double damped = sqrt((o->omega - o->decay) * (o->omega + o->decay));
    bank->omega[i] = o->omega;
    bank->decay[i] = o->decay;
    bank->mass[i] = o->mass;
    bank->damped[i] = damped;
    bank->yield[i] = 1 / damped;
    cut(&bank->gears[0], i, o, damped, h);
    if (bank->parts > 1)
        cut(&bank->gears[1], i, o, damped, h / bank->parts);
}

static void silence(himc_bank *bank, int i)
{
    bank->p[i] = bank->s[i] = 0;
    for (int k = 0; k < HIMC_BANK_SUBSTEPS; k++) {
        const bank_gear *g = &bank->gears[k];
        g->turn_c[i] = g->turn_s[i] = g->push_p[i] = g->push_s[i] = 0;
    }
    bank->omega[i] = bank->decay[i] = bank->damped[i] = bank->mass[i] = bank->yield[i] = 0;
}

// q sqrt(K) and v sqrt(m) stay: the same energy, the same phase
static void carry_over(himc_bank *bank, int i, const himc_oscillator *to, double h)
{
    double q, v;
    himc_bank_state(bank, i, &q, &v);
    double mass_ratio = sqrt(bank->mass[i] / to->mass), omega_ratio = bank->omega[i] / to->omega;
    tune(bank, i, to, h);
    if (q != 0 || v != 0)
        himc_bank_excite(bank, i, q * mass_ratio * omega_ratio, v * mass_ratio);
}

void himc_bank_set(himc_bank *bank, const himc_oscillator *oscillators, int count, double rate)
{
    int i = 0;
    for (; i < count && oscillators[i].omega < 2 * HIMC_PI * 0.49 * rate; i++) {
        if (i < bank->count)
            carry_over(bank, i, &oscillators[i], 1 / rate);
        else
            tune(bank, i, &oscillators[i], 1 / rate);
    }
    bank->count = i;
    for (; i < bank->capacity; i++)
        silence(bank, i);
    bank->live = (bank->count + LANES - 1) / LANES * LANES;
}

void himc_bank_readout(const himc_bank *bank, const double *on_q, const double *on_v,
                       himc_readout *tap)
{
    for (int i = 0; i < bank->capacity; i++) {
        double q = on_q && i < bank->count ? on_q[i] / bank->damped[i] : 0;
        double v = on_v && i < bank->count ? on_v[i] : 0;
        tap->p[i] = q - (v != 0 ? v * bank->decay[i] / bank->damped[i] : 0);
        tap->s[i] = v;
    }
}

double himc_bank_energy(const himc_bank *bank)
{
    double sum = 0;
    for (int i = 0; i < bank->count; i++) {
        double q, v;
        himc_bank_state(bank, i, &q, &v);
        double w = bank->omega[i] * q;
        sum += 0.5 * bank->mass[i] * (v * v + w * w);
    }
    return sum;
}

void himc_bank_state(const himc_bank *bank, int index, double *q, double *v)
{
    *q = *v = 0;
    if (index >= bank->count)
        return;
    *q = bank->p[index] / bank->damped[index];
    *v = bank->s[index] - bank->decay[index] * *q;
}

void himc_bank_excite(himc_bank *bank, int index, double q, double v)
{
    if (index >= bank->count)
        return;
    bank->p[index] = bank->damped[index] * q;
    bank->s[index] = v + bank->decay[index] * q;
    bank->live = (bank->count + LANES - 1) / LANES * LANES;
}

void himc_bank_rest(himc_bank *bank)
{
    memset(bank->p, 0, sizeof(double) * (size_t)bank->capacity);
    memset(bank->s, 0, sizeof(double) * (size_t)bank->capacity);
    bank->live = 0;
}
