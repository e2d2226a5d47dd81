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
/// After a force, the state makes one step of one sample. Then, as long as none acts, it makes steps
/// of 64 samples, a pass; a readout's samples within it come from the state at its start. With C_n,
/// S_n the coefficients of n samples, the readout rp p + rs s is after n samples
///     y_n = C_n a + S_n b,   a = rp p + rs s,   b = rp s - rs p,
/// taken from a table for n = 1 .. 16, eight samples at once, and from then on
///     y_n = 2 C_8 y_(n-8) - (C_8^2 + S_8^2) y_(n-16).
/// When a force ends the pass early, the state makes the steps of 32, 16, .. samples that lead there.
/// So the steps hang on the forces alone, not on how many samples are asked for at a time, and a
/// readout costs only when it is read.
///
/// The order of all sums is fixed (bank_kernel.h): the same bits on any machine. About every 1024
/// samples the oscillators at the top that have fallen below 1e-15 m/s are set to rest and skipped
/// until the next force: high modes die first, and denormal numbers never arise.
#include "drum/bank.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LANES HIMC_BANK_LANES
#define PASS HIMC_BANK_PASS
#define POWERS 7            // coefficients are kept for 1, 2, 4, .. 64 samples
#define QUIET 1e-15         // (m/s) of p and s; chosen: 300 dB below a stroke
#define FLUSH_INTERVAL 1024 // least samples between two searches for quiet ones; chosen: 20 ms
#define HIGHEST 0.49        // of the sample rate; chosen: just below half, where aliasing begins
#define ALIGNMENT 64        // (bytes) a cache line

// coefficients for a number of samples, or for a substep
typedef struct rotation {
    double *c, *s; // C, S
} rotation;

// effect of a force during one step
typedef struct effect {
    double *p, *s; // added to p and s by 1 N
} effect;

struct himc_bank {
    const himc_bank_kernel *loops;
    int capacity;  // a multiple of LANES
    int count;     // oscillators that are not silent
    int live;      // of these, the first `live` (a multiple of LANES) are not at rest
    int age;       // samples since the last search for quiet oscillators
    uint64_t pass; // number of the present pass
    int at;        // samples that have passed in it
    int length;    // of the present pass; 0 before it begins
    bool forced;   // a force has acted: the next step is a single sample
    double *memory;
    double *p, *s;          // state at the start of the pass
    rotation power[POWERS]; // of 2^k samples
    rotation part;          // of a substep
    effect whole, parted;   // in a sample, in a substep
    rotation present;       // of a step of the present length
    effect push;            // in it
    himc_step_length step;
    int substeps;                          // of a sample
    double *omega, *decay, *mass, *damped; // w, d, m, w_d
    double *q_per_p;                       // 1/w_d
    double *table, *twice, *fall;          // of himc_bank_waves
    double *a, *b;
};

#define ARRAYS (7 + 2 * POWERS + 2 + 4 + 4 + HIMC_BANK_TABLE)

static size_t round_up(size_t n, size_t multiple)
{
    return (n + multiple - 1) / multiple * multiple;
}

// from now on no oscillator counts as being at rest
static void wake(himc_bank *bank)
{
    bank->live = (int)round_up((size_t)bank->count, LANES);
}

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
    double **single[] = {&bank->p,       &bank->s,       &bank->omega,   &bank->decay,
                         &bank->mass,    &bank->damped,  &bank->q_per_p, &bank->twice,
                         &bank->fall,    &bank->a,       &bank->b,       &bank->part.c,
                         &bank->part.s,  &bank->whole.p, &bank->whole.s, &bank->parted.p,
                         &bank->parted.s};
    for (size_t i = 0; i < sizeof single / sizeof *single; i++)
        *single[i] = take(bank, &rest);
    for (int k = 0; k < POWERS; k++)
        bank->power[k] = (rotation){take(bank, &rest), take(bank, &rest)};
    bank->table = rest;
}

himc_bank *himc_bank_new(int capacity, himc_error *error)
{
    capacity = (int)round_up((size_t)capacity, LANES);
    size_t length = (size_t)capacity, bytes = ARRAYS * length * sizeof(double);
    himc_bank *bank = calloc(1, sizeof *bank);
    double *memory = aligned_alloc(ALIGNMENT, round_up(bytes, ALIGNMENT));
    if (!bank || !memory) {
        free(bank);
        free(memory);
        himc_error_set(error, "modes: no memory for %d modes", capacity);
        return NULL;
    }
    memset(memory, 0, bytes);
    *bank = (himc_bank){.loops = himc_bank_kernel_fastest(),
                        .capacity = capacity,
                        .pass = 1,
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
    free(bank->memory);
    free(bank);
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
    bank->step = step;
    bank->present = step == HIMC_STEP_SUBSTEP ? bank->part : bank->power[0];
    bank->push = step == HIMC_STEP_SUBSTEP ? bank->parted : bank->whole;
}

// begins a new pass at the present state
static void restart(himc_bank *bank)
{
    bank->pass++;
    bank->at = bank->length = 0;
}

static void rotate(himc_bank *bank, const rotation *by)
{
    bank->loops->rotate(bank->p, bank->s, by->c, by->s, bank->live);
}

// brings the state to the present sample, which ends the pass
static void arrive(himc_bank *bank)
{
    for (int k = POWERS - 1; k >= 0; k--)
        if (bank->at >> k & 1)
            rotate(bank, &bank->power[k]);
    restart(bank);
}

// p and s of one oscillator at the present sample: the same numbers as by arrive
static void present_state(const himc_bank *bank, int i, double *p, double *s)
{
    *p = bank->p[i];
    *s = bank->s[i];
    for (int k = POWERS - 1; k >= 0; k--) {
        if (!(bank->at >> k & 1))
            continue;
        double c = bank->power[k].c[i], w = bank->power[k].s[i], before = *p;
        *p = c * before + w * *s;
        *s = c * *s - w * before;
    }
}

// coefficients of one oscillator for a step of length h, and the effect of 1 N during it
static void find_step(const rotation *by, const effect *push, int i, const himc_oscillator *o,
                      double damped, double h)
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
    for (int n = 1; n <= PASS; n = n < 16 ? n + 1 : 2 * n) {
        if (n <= 16) {
            double *t = table + (n > LANES ? 2 * LANES : 0) + (n - 1) % LANES;
            t[0] = c;
            t[LANES] = s;
        }
        for (int k = 1; k < POWERS; k++)
            if (n == 1 << k) {
                bank->power[k].c[i] = c;
                bank->power[k].s[i] = s;
            }
        double next = n < 16 ? c * c1 - s * s1 : c * c - s * s;
        s = n < 16 ? s * c1 + c * s1 : 2 * c * s;
        c = next;
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
    find_step(&bank->power[0], &bank->whole, i, o, damped, h);
    find_powers(bank, i);
    if (bank->substeps > 1)
        find_step(&bank->part, &bank->parted, i, o, damped, h / bank->substeps);
}

// brings oscillator i to rest, for good: it has no coefficients
static void silence(himc_bank *bank, int i)
{
    for (int k = 0; k < ARRAYS - HIMC_BANK_TABLE; k++)
        bank->memory[k * bank->capacity + i] = 0;
    memset(bank->table + (size_t)i * HIMC_BANK_TABLE, 0, sizeof(double) * HIMC_BANK_TABLE);
}

// sets a state that an oscillator of that mass and omega had: q sqrt(K) and v sqrt(m) are kept, so
// that energy and phase are the same
static void inherit(himc_bank *bank, int i, double q, double v, double mass, double omega)
{
    double mass_ratio = sqrt(mass / bank->mass[i]), omega_ratio = omega / bank->omega[i];
    if (q != 0 || v != 0)
        himc_bank_excite(bank, i, q * mass_ratio * omega_ratio, v * mass_ratio);
}

static void carry_over(himc_bank *bank, int i, const himc_oscillator *to, double h)
{
    double q, v, mass = bank->mass[i], omega = bank->omega[i];
    himc_bank_state(bank, i, &q, &v);
    set_oscillator(bank, i, to, h);
    inherit(bank, i, q, v, mass, omega);
}

void himc_bank_continue(himc_bank *bank, const himc_bank *from)
{
    for (int i = 0; i < bank->count && i < from->count; i++) {
        double q, v;
        himc_bank_state(from, i, &q, &v);
        inherit(bank, i, q, v, from->mass[i], from->omega[i]);
    }
}

void himc_bank_set(himc_bank *bank, const himc_oscillator *oscillators, int count, double rate)
{
    int i = 0;
    arrive(bank);
    for (; i < count && oscillators[i].omega < 2 * HIMC_PI * HIGHEST * rate; i++) {
        if (i < bank->count)
            carry_over(bank, i, &oscillators[i], 1 / rate);
        else
            set_oscillator(bank, i, &oscillators[i], 1 / rate);
    }
    bank->count = i;
    for (; i < bank->capacity; i++)
        silence(bank, i);
    wake(bank);
    bank->forced = true;
}

void himc_bank_readout(const himc_bank *bank, const double *on_q, const double *on_v,
                       himc_readout *readout)
{
    for (int i = 0; i < bank->capacity; i++) {
        double q = on_q && i < bank->count ? on_q[i] / bank->damped[i] : 0;
        double v = on_v && i < bank->count ? on_v[i] : 0;
        readout->p[i] = q - (v != 0 ? v * bank->decay[i] / bank->damped[i] : 0);
        readout->s[i] = v;
    }
    readout->pass = 0;
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

void himc_bank_state(const himc_bank *bank, int index, double *q, double *v)
{
    *q = *v = 0;
    if (index >= bank->count)
        return;
    double p, s;
    present_state(bank, index, &p, &s);
    *q = p / bank->damped[index];
    *v = s - bank->decay[index] * *q;
}

void himc_bank_excite(himc_bank *bank, int index, double q, double v)
{
    if (index >= bank->count)
        return;
    arrive(bank);
    bank->p[index] = bank->damped[index] * q;
    bank->s[index] = v + bank->decay[index] * q;
    wake(bank);
    bank->forced = true;
}

void himc_bank_rest(himc_bank *bank)
{
    memset(bank->p, 0, sizeof(double) * (size_t)bank->capacity);
    memset(bank->s, 0, sizeof(double) * (size_t)bank->capacity);
    bank->live = bank->age = 0;
    restart(bank);
}

// fills readout->ahead for the present pass
static void look_ahead(const himc_bank *bank, himc_readout *readout)
{
    himc_bank_waves waves = {bank->a, bank->b, bank->table, bank->twice, bank->fall};
    bank->loops->weigh(bank->a, bank->b, readout->p, readout->s, bank->p, bank->s, bank->live);
    bank->loops->ahead(&waves, bank->live, readout->ahead);
    readout->pass = bank->pass;
}

double himc_bank_read(const himc_bank *bank, himc_readout *readout)
{
    if (bank->at == 0)
        return bank->loops->read(readout->p, readout->s, bank->p, bank->s, bank->live);
    if (readout->pass != bank->pass)
        look_ahead(bank, readout);
    return readout->ahead[bank->at - 1];
}

double himc_bank_peek(const himc_bank *bank, const himc_readout *readout)
{
    double sum = 0;
    for (int i = 0; i < bank->live; i++) {
        double p, s, c = bank->present.c[i], w = bank->present.s[i];
        present_state(bank, i, &p, &s);
        sum += readout->p[i] * (c * p + w * s) + readout->s[i] * (c * s - w * p);
    }
    return sum;
}

// Sets the quiet oscillators at the top to rest, from time to time.
static void flush_quiet(himc_bank *bank)
{
    if (bank->age < FLUSH_INTERVAL)
        return;
    bank->age = 0;
    int live = bank->live;
    while (live > 0 && fabs(bank->p[live - 1]) < QUIET && fabs(bank->s[live - 1]) < QUIET) {
        live--;
        bank->p[live] = bank->s[live] = 0;
    }
    bank->live = (int)round_up((size_t)live, LANES);
}

// a step of its own: a sample after a force, or a substep
static void single_step(himc_bank *bank)
{
    arrive(bank);
    rotate(bank, &bank->present);
    bank->age++;
    bank->forced = false;
}

// samples that the present pass can give, at most n; begins the next one at its end
static int go_on(himc_bank *bank, int n)
{
    if (bank->at == bank->length) {
        arrive(bank);
        flush_quiet(bank);
        bank->length = PASS;
    }
    int left = bank->length - bank->at;
    return n < left ? n : left;
}

// the samples after `at` of the present pass
static void copy_ahead(const himc_bank *bank, himc_readout *readout, int n, double *out)
{
    if (readout->pass != bank->pass)
        look_ahead(bank, readout);
    memcpy(out, readout->ahead + bank->at, sizeof *out * (size_t)n);
}

void himc_bank_run(himc_bank *bank, int n, himc_readout *const *readouts, int count,
                   double *const *out)
{
    for (int done = 0, run; done < n; done += run) {
        bool single = bank->forced || bank->step == HIMC_STEP_SUBSTEP;
        run = single ? 1 : go_on(bank, n - done);
        if (single)
            single_step(bank);
        for (int k = 0; k < count; k++) {
            if (!out[k])
                continue;
            if (bank->live == 0)
                memset(out[k] + done, 0, sizeof **out * (size_t)run);
            else if (single)
                out[k][done] = himc_bank_read(bank, readouts[k]);
            else
                copy_ahead(bank, readouts[k], run, out[k] + done);
        }
        bank->at += single ? 0 : run;
        bank->age += single ? 0 : run;
    }
}

typedef double pair __attribute__((vector_size(2 * sizeof(double)), may_alias));
typedef struct lanes {
    pair a, b;
} lanes;
static double total(const lanes *sum)
{
    return (sum->a[0] + sum->a[1]) + (sum->b[0] + sum->b[1]);
}

void himc_bank_run_coupled(himc_bank *bank, const double *weight, himc_tension_coupling *coupling)
{
    arrive(bank);
    bank->forced = false;
    pair *p = (pair *)bank->p, *s = (pair *)bank->s, *g = (pair *)coupling->shape;
    const pair *c = (const pair *)bank->present.c, *w = (const pair *)bank->present.s;
    const pair *a = (const pair *)weight, *b = (const pair *)bank->q_per_p;
    const pair *push_p = (const pair *)bank->push.p;
    lanes change = {{0}, {0}}, compliance = {{0}, {0}};
    for (int i = 0; i < bank->live / 2; i += 2) {
        pair q0 = p[i], q1 = p[i + 1];
        pair p0 = c[i] * q0 + w[i] * s[i], p1 = c[i + 1] * q1 + w[i + 1] * s[i + 1];
        s[i] = c[i] * s[i] - w[i] * q0;
        s[i + 1] = c[i + 1] * s[i + 1] - w[i + 1] * q1;
        p[i] = p0;
        p[i + 1] = p1;
        pair g0 = g[i] = a[i] * (q0 + p0), g1 = g[i + 1] = a[i + 1] * (q1 + p1);
        change.a += g0 * (p0 - q0) * b[i];
        change.b += g1 * (p1 - q1) * b[i + 1];
        compliance.a += g0 * g0 * b[i] * push_p[i];
        compliance.b += g1 * g1 * b[i + 1] * push_p[i + 1];
    }
    for (int i = bank->live / 2; i < bank->capacity / 2; i++)
        g[i] = (pair){0};
    coupling->change = total(&change);
    coupling->compliance = total(&compliance);
    bank->age++;
    flush_quiet(bank);
}

void himc_bank_coupling_weights(const himc_bank *bank, const double *on_square, double *weight)
{
    for (int i = 0; i < bank->capacity; i++)
        weight[i] = i < bank->count ? 0.5 * on_square[i] * bank->q_per_p[i] : 0;
}

void himc_bank_push(himc_bank *bank, const double *shape, double force)
{
    arrive(bank);
    wake(bank);
    bank->forced = true;
    bank->loops->push(bank->p, bank->s, bank->push.p, bank->push.s, shape, force, bank->live);
}

void himc_bank_step_response(const himc_bank *bank, const himc_readout *readout, double *response)
{
    for (int i = 0; i < bank->capacity; i++)
        response[i] = readout->p[i] * bank->push.p[i] + readout->s[i] * bank->push.s[i];
}

double himc_bank_response(const himc_bank *bank, const double *shape, const himc_readout *readout)
{
    himc_bank_step_response(bank, readout, bank->a);
    return himc_bank_sum(bank, shape, bank->a);
}

double himc_bank_sum(const himc_bank *bank, const double *shape, const double *response)
{
    return bank->loops->dot(shape, response, bank->capacity);
}
