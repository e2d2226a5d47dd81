/// bank_set.c: the memory of a bank, and what its oscillators, readouts and film are.
#include "bank/bank_state.h"

#include <math.h>
#include <string.h>

#define REACH 1.0     // w t up to which the film acts on a mode; chosen: well below pi
#define LOWEST 0.35   // w t of the lowest mode at most, in steps of several samples; chosen
#define ACCURACY 1e-3 // rise of stiffness times the square of that; chosen: 0.1 cent
#define HIGHEST 0.49  // of the sample rate; chosen: just below half, where aliasing begins

#define ARRAYS (7 + 2 * POWERS + 2 + 4 + 2 + 7 + 3 + HIMC_BANK_TABLE)
#define STATE_ARRAYS 2 // of these, the first: p and s

// takes the next array from the block
static double *take(himc_bank *bank, double **free_memory)
{
    double *array = *free_memory;
    *free_memory += bank->capacity;
    return array;
}

static void share_memory(himc_bank *bank)
{
    double *rest = bank->memory;
    bank_film *f = &bank->film;
    double **single[] = {&bank->p,       &bank->s,        &bank->omega,    &bank->decay,
                         &bank->mass,    &bank->damped,   &bank->q_per_p,  &bank->twice,
                         &bank->fall,    &bank->sub.c,    &bank->sub.s,    &bank->whole.p,
                         &bank->whole.s, &bank->parted.p, &bank->parted.s, &f->on_p,
                         &f->per_mass,   &f->damp,        &f->kick,        &f->rate,
                         &f->tight,      &f->slack};
    for (size_t i = 0; i < sizeof single / sizeof *single; i++)
        *single[i] = take(bank, &rest);
    for (int k = 0; k < POWERS; k++)
        bank->power[k] = (bank_rotation){take(bank, &rest), take(bank, &rest)};
    bank->cascade.root = take(bank, &rest);
    bank->cascade.sign = take(bank, &rest);
    take(bank, &rest); // its second half
    bank->table = rest;
}

himc_bank *himc_bank_new(int capacity, himc_error *error)
{
    capacity = bank_round_up(capacity);
    size_t length = (size_t)capacity, bytes = ARRAYS * length * sizeof(double);
    himc_bank *bank = himc_aligned_new(sizeof *bank);
    double *memory = himc_aligned_new(bytes);
    if (!bank || !memory) {
        himc_aligned_free(bank);
        himc_aligned_free(memory);
        himc_error_set(error, "modes: no memory for %d modes", capacity);
        return NULL;
    }
    memset(memory, 0, bytes);
    *bank = (himc_bank){.loops = himc_bank_kernel_fastest(),
                        .capacity = capacity,
                        .pass = 1,
                        .whole_pass = PASS,
                        .memory = memory,
                        .substeps = 1};
    share_memory(bank);
    himc_bank_set_step(bank, HIMC_STEP_SAMPLE);
    return bank;
}

void himc_bank_free(himc_bank *bank)
{
    if (!bank)
        return;
    himc_aligned_free(bank->memory);
    himc_aligned_free(bank);
}

// coefficients of one oscillator for a step of length h, and the effect of 1 N during it
static void find_step(const bank_rotation *by, const bank_effect *push, int i,
                      const himc_oscillator *o, double damped, double h)
{
    double shrink = exp(-o->decay * h), half = sin(0.5 * damped * h);
    double c = shrink * cos(damped * h), s = shrink * sin(damped * h);
    // 1 - a11 = (1 - C) - d S/w_d without the cancellation in 1 - C
    double fall = -expm1(-o->decay * h) + 2 * shrink * half * half - o->decay / damped * s;
    double b1 = fall / (o->mass * o->omega * o->omega), b2 = s / (o->mass * damped);
    by->c[i] = c;
    by->s[i] = s;
    push->p[i] = damped * b1;
    push->s[i] = b2 + o->decay * b1;
}

// C_n, S_n of a pass from those of one sample
static void find_powers(himc_bank *bank, int i)
{
    double c1 = bank->power[0].c[i], s1 = bank->power[0].s[i], c = c1, s = s1;
    double *table = bank->table + (size_t)i * HIMC_BANK_TABLE;
    for (int n = 1; n <= 2 * LANES; n++) {
        double *t = table + n - 1 + (n > LANES ? LANES : 0);
        t[0] = c;
        t[LANES] = s;
        double next = c * c1 - s * s1;
        s = s * c1 + c * s1;
        c = next;
    }
    for (int k = 1; k < POWERS; k++) {
        int n = 1 << k; // up to 16 from the table, then by squaring
        const double *t = table + n - 1 + (n > LANES ? LANES : 0);
        c = n <= 2 * LANES ? t[0] : bank->power[k - 1].c[i];
        s = n <= 2 * LANES ? t[LANES] : bank->power[k - 1].s[i];
        bank->power[k].c[i] = n <= 2 * LANES ? c : c * c - s * s;
        bank->power[k].s[i] = n <= 2 * LANES ? s : 2 * c * s;
    }
    double c8 = bank->power[3].c[i], s8 = bank->power[3].s[i];
    bank->twice[i] = 2 * c8;
    bank->fall[i] = c8 * c8 + s8 * s8;
}

static void set_oscillator(himc_bank *bank, int i, const himc_oscillator *o, double h)
{
    double damped = sqrt((o->omega - o->decay) * (o->omega + o->decay));
    bank->omega[i] = o->omega;
    bank->decay[i] = o->decay;
    bank->mass[i] = o->mass;
    bank->damped[i] = damped;
    bank->q_per_p[i] = 1 / damped;
    bank->film.per_mass[i] = 1 / o->mass;
    bank->film.damp[i] = o->decay / damped;
    bank->film.tight[i] = o->omega / damped;
    bank->film.slack[i] = damped / o->omega;
    find_step(&bank->power[0], &bank->whole, i, o, damped, h);
    find_powers(bank, i);
    if (bank->substeps > 1)
        find_step(&bank->sub, &bank->parted, i, o, damped, h / bank->substeps);
}

// sets a state that an oscillator of that mass and omega had: q sqrt(K) and v sqrt(m) are kept, so
// that energy and phase are the same
static void inherit(himc_bank *bank, int i, double q, double v, double mass, double omega)
{
    if (q == 0 && v == 0)
        return;
    double mass_ratio = sqrt(mass / bank->mass[i]), omega_ratio = omega / bank->omega[i];
    himc_bank_excite(bank, i, q * mass_ratio * omega_ratio, v * mass_ratio);
}

// Becomes the other but for the contents of its memory, the first `arrays` of which are copied.
// Readouts of its own that were computed ahead no longer hold.
static void become(himc_bank *bank, const himc_bank *from, int arrays)
{
    himc_bank own = *bank;
    *bank = *from;
    bank->memory = own.memory;
    bank->pass = own.pass + 1;
    bank->part = own.part + 1;
    bank->bounds_left = 0;
    share_memory(bank);
    himc_bank_set_step(bank, from->kind);
    memcpy(bank->memory, from->memory, sizeof(double) * (size_t)(arrays * bank->capacity));
}

void himc_bank_continue(himc_bank *bank, himc_bank *from, int count)
{
    size_t bytes = sizeof(double) * (size_t)bank->capacity;
    if (bank->count == from->count && bank->capacity == from->capacity && bank->h == from->h &&
        memcmp(bank->omega, from->omega, bytes) == 0 &&
        memcmp(bank->decay, from->decay, bytes) == 0 &&
        memcmp(bank->mass, from->mass, bytes) == 0 &&
        memcmp(bank->film.on_p, from->film.on_p, bytes) == 0 &&
        bank->cascade.set.rate == from->cascade.set.rate) {
        become(bank, from, STATE_ARRAYS); // in the middle of its pass, to the last bit
        return;
    }
    himc_bank_settle(from);
    himc_bank_rest(bank); // what it has done before is over
    bank->film.power = from->film.power;
    for (int i = 0; i < count && i < bank->count && i < from->count; i++) {
        double q, v;
        himc_bank_state(from, i, &q, &v);
        inherit(bank, i, q, v, from->mass[i], from->omega[i]);
    }
    bank->age = from->age;
    bank->cascade.since = from->cascade.since;
    bank->cascade.turn = from->cascade.turn;
    himc_bank_find_film(bank);
}

void himc_bank_set(himc_bank *bank, const himc_oscillator *oscillators, int count, double rate)
{
    int i = 0;
    himc_bank_settle(bank);
    bank->h = 1 / rate;
    for (; i < count && oscillators[i].omega < 2 * HIMC_PI * HIGHEST * rate; i++) {
        double q, v, mass = bank->mass[i], omega = bank->omega[i];
        himc_bank_state(bank, i, &q, &v);
        set_oscillator(bank, i, &oscillators[i], 1 / rate);
        inherit(bank, i, q, v, mass, omega);
    }
    bank->count = i;
    // the others are at rest, for good: they have no coefficients
    size_t rest = sizeof(double) * (size_t)(bank->capacity - i);
    for (int k = 0; k < ARRAYS - HIMC_BANK_TABLE; k++)
        memset(bank->memory + k * bank->capacity + i, 0, rest);
    memset(bank->table + (size_t)i * HIMC_BANK_TABLE, 0, rest * HIMC_BANK_TABLE);
    himc_bank_wake(bank);
    bank->forced = true;
}

void himc_bank_copy(himc_bank *bank, const himc_bank *from)
{
    become(bank, from, ARRAYS);
    himc_bank_rest(bank);
}

void himc_bank_readout(const himc_bank *bank, const double *on_q, const double *on_v,
                       const double *on_force, himc_readout *readout)
{
    readout->direct = on_force != NULL;
    readout->pass = readout->read_pass = 0;
    for (int i = 0; i < bank->capacity; i++) {
        double q = on_q && i < bank->count ? on_q[i] / bank->damped[i] : 0;
        double v = on_v && i < bank->count ? on_v[i] : 0;
        readout->p[i] = q - (v != 0 ? v * bank->decay[i] / bank->damped[i] : 0);
        readout->s[i] = v;
        if (readout->film)
            readout->film[i] =
                bank->film.on_p[i] * (on_force ? on_force[i] : v * bank->film.per_mass[i]);
    }
}

void himc_bank_set_film(himc_bank *bank, const double *on_square, double least)
{
    bank_film *f = &bank->film;
    himc_bank_settle(bank);
    f->set = on_square != NULL;
    f->least = least;
    f->due = 0;
    memset(f->reach, 0, sizeof f->reach);
    double rise = 0; // the largest of a mode's stiffness per s
    for (int i = 0; i < bank->count; i++) {
        double a = on_square ? on_square[i] : 0, omega = bank->omega[i];
        f->on_p[i] = a * bank->q_per_p[i];
        f->rate[i] = 0.5 * a * f->per_mass[i] / omega;
        rise = fmax(rise, a * f->per_mass[i] / (omega * omega));
        for (int k = 0; k < LEVELS; k++)
            if (omega * bank_steps[k] * bank->h < REACH)
                f->reach[k] = bank_round_up(i + 1);
    }
    for (int k = 0; k < LEVELS; k++) {
        double angle = bank->omega[0] * bank_steps[k] * bank->h; // of the lowest mode
        f->most[k] = rise > 0 && angle < LOWEST ? ACCURACY / (rise * angle * angle) : 0;
    }
    himc_bank_find_film(bank);
}
