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
/// The order of all sums is fixed: four lanes, each in the order of the oscillators. So one run of
/// n samples and n runs of one sample give the same bits, on any machine. Every 1024 steps the
/// oscillators at the top that have fallen below 1e-15 m/s are set to rest and skipped until the
/// next force: high modes die first, and denormal numbers never arise.
#include "drum/bank.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LANES 4
#define RUN_BLOCK 64 // samples per pass, chosen: all sums of a pass stay in the first-level cache
#define QUIET 1e-15  // (m/s) of p and s; chosen: 300 dB below a stroke
#define FLUSH_INTERVAL 1024 // steps between two searches for quiet oscillators; chosen: 20 ms
#define HIGHEST 0.49        // of the sample rate; chosen: just below half, where aliasing begins
#define ALIGNMENT 64        // (bytes) a cache line

// two oscillators at once; each compiler turns this into one vector instruction with the same
// result
typedef double pair __attribute__((vector_size(2 * sizeof(double)), may_alias));

// a sum in four lanes; total() adds them in a fixed order
typedef struct lanes {
    pair a, b;
} lanes;

// coefficients for steps of one length
typedef struct coefficients {
    double *rotate_c, *rotate_s; // C, S
    double *push_p, *push_s;     // added to p and s by 1 N
} coefficients;

struct himc_bank {
    int capacity; // a multiple of LANES
    int count;    // oscillators that are not silent
    int live;     // of these, the first `live` (a multiple of LANES) are not at rest
    int age;      // steps since the last search for quiet oscillators
    double *memory;
    double *p, *s;               // state
    double *rotate_c, *rotate_s; // coefficients of the present step length
    double *push_p, *push_s;
    coefficients steps[HIMC_STEP_LENGTHS];
    int substeps;                          // of a sample
    double *omega, *decay, *mass, *damped; // w, d, m, w_d
    double *q_per_p;                       // 1/w_d
    lanes sum[HIMC_BANK_READOUTS][RUN_BLOCK];
};

#define ARRAYS (7 + 4 * HIMC_STEP_LENGTHS)

static size_t round_up(size_t n, size_t multiple)
{
    return (n + multiple - 1) / multiple * multiple;
}

// from now on no oscillator counts as being at rest
static void wake(himc_bank *bank)
{
    bank->live = (int)round_up((size_t)bank->count, LANES);
}

himc_bank *himc_bank_new(int capacity, himc_error *error)
{
    capacity = (int)round_up((size_t)capacity, LANES);
    size_t length = (size_t)capacity, bytes = ARRAYS * length * sizeof(double);
    himc_bank *bank = aligned_alloc(ALIGNMENT, round_up(sizeof *bank, ALIGNMENT));
    double *memory = aligned_alloc(ALIGNMENT, round_up(bytes, ALIGNMENT));
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
    coefficients *whole = &bank->steps[HIMC_STEP_SAMPLE];
    coefficients *part = &bank->steps[HIMC_STEP_SUBSTEP];
    double **arrays[ARRAYS] = {&bank->p,         &bank->s,       &bank->omega,   &bank->decay,
                               &bank->mass,      &bank->damped,  &bank->q_per_p, &whole->rotate_c,
                               &whole->rotate_s, &whole->push_p, &whole->push_s, &part->rotate_c,
                               &part->rotate_s,  &part->push_p,  &part->push_s};
    for (int i = 0; i < ARRAYS; i++)
        *arrays[i] = memory + (size_t)i * length;
    bank->substeps = 1;
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
    const coefficients *c = &bank->steps[step];
    bank->rotate_c = c->rotate_c;
    bank->rotate_s = c->rotate_s;
    bank->push_p = c->push_p;
    bank->push_s = c->push_s;
}

// coefficients of one oscillator for steps of length h
static void find_coefficients(const coefficients *of, int i, const himc_oscillator *o,
                              double damped, double h)
{
    double shrink = exp(-o->decay * h), half = sin(0.5 * damped * h);
    double c = shrink * cos(damped * h), s = shrink * sin(damped * h);
    // 1 - a11 = (1 - C) - d S/w_d without the cancellation in 1 - C
    double fall = -expm1(-o->decay * h) + 2 * shrink * half * half - o->decay / damped * s;
    double b1 = fall / (o->mass * o->omega * o->omega), b2 = s / (o->mass * damped);
    of->rotate_c[i] = c;
    of->rotate_s[i] = s;
    of->push_p[i] = damped * b1;
    of->push_s[i] = b2 + o->decay * b1;
}

static void set_oscillator(himc_bank *bank, int i, const himc_oscillator *o, double h)
{
    double damped = sqrt((o->omega - o->decay) * (o->omega + o->decay));
    bank->omega[i] = o->omega;
    bank->decay[i] = o->decay;
    bank->mass[i] = o->mass;
    bank->damped[i] = damped;
    bank->q_per_p[i] = 1 / damped;
    find_coefficients(&bank->steps[HIMC_STEP_SAMPLE], i, o, damped, h);
    if (bank->substeps > 1)
        find_coefficients(&bank->steps[HIMC_STEP_SUBSTEP], i, o, damped, h / bank->substeps);
}

static void silence(himc_bank *bank, int i)
{
    bank->p[i] = bank->s[i] = 0;
    for (int k = 0; k < HIMC_STEP_LENGTHS; k++) {
        const coefficients *c = &bank->steps[k];
        c->rotate_c[i] = c->rotate_s[i] = c->push_p[i] = c->push_s[i] = 0;
    }
    bank->omega[i] = bank->decay[i] = bank->damped[i] = bank->mass[i] = bank->q_per_p[i] = 0;
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
    wake(bank);
}

void himc_bank_rest(himc_bank *bank)
{
    memset(bank->p, 0, sizeof(double) * (size_t)bank->capacity);
    memset(bank->s, 0, sizeof(double) * (size_t)bank->capacity);
    bank->live = 0;
}

static double total(const lanes *sum)
{
    return (sum->a[0] + sum->a[1]) + (sum->b[0] + sum->b[1]);
}

// the readout of the present state
static lanes read_lanes(const himc_bank *bank, const himc_readout *readout)
{
    const pair *p = (const pair *)bank->p, *s = (const pair *)bank->s;
    const pair *rp = (const pair *)readout->p, *rs = (const pair *)readout->s;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < bank->live / 2; i += 2) {
        sum.a += rp[i] * p[i] + rs[i] * s[i];
        sum.b += rp[i + 1] * p[i + 1] + rs[i + 1] * s[i + 1];
    }
    return sum;
}

double himc_bank_read(const himc_bank *bank, const himc_readout *readout)
{
    lanes sum = read_lanes(bank, readout);
    return total(&sum);
}

// sum of x[i] y[i] over the first `length`
static double dot(const double *x, const double *y, int length)
{
    const pair *a = (const pair *)x, *b = (const pair *)y;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < length / 2; i += 2) {
        sum.a += a[i] * b[i];
        sum.b += a[i + 1] * b[i + 1];
    }
    return total(&sum);
}

double himc_bank_peek(const himc_bank *bank, const himc_readout *readout)
{
    double sum = 0;
    for (int i = 0; i < bank->count; i++) {
        double p = bank->rotate_c[i] * bank->p[i] + bank->rotate_s[i] * bank->s[i];
        double s = bank->rotate_c[i] * bank->s[i] - bank->rotate_s[i] * bank->p[i];
        sum += readout->p[i] * p + readout->s[i] * s;
    }
    return sum;
}

double himc_bank_displacement(const himc_bank *bank, const himc_readout *readout)
{
    return dot(readout->p, bank->p, bank->live);
}

// Sets the quiet oscillators at the top to rest. Called only at multiples of FLUSH_INTERVAL steps,
// so the result does not depend on the sizes of blocks.
static void flush_quiet(himc_bank *bank)
{
    bank->age = 0;
    int live = bank->live;
    while (live > 0 && fabs(bank->p[live - 1]) < QUIET && fabs(bank->s[live - 1]) < QUIET) {
        live--;
        bank->p[live] = bank->s[live] = 0;
    }
    bank->live = (int)round_up((size_t)live, LANES);
}

// Runs four oscillators through n samples and adds their part of two readouts. States and
// coefficients stay in registers; with more than two readouts, only the last call writes the state
// back.
static void rotate_block(himc_bank *bank, int at, int n, const himc_readout *first,
                         const himc_readout *second, lanes *one, lanes *two, bool last)
{
    pair *p = (pair *)(bank->p + at), *s = (pair *)(bank->s + at);
    const pair *c = (const pair *)(bank->rotate_c + at), *w = (const pair *)(bank->rotate_s + at);
    const pair *rp = (const pair *)(first->p + at), *rs = (const pair *)(first->s + at);
    const pair *up = (const pair *)(second->p + at), *us = (const pair *)(second->s + at);
    pair c0 = c[0], c1 = c[1], w0 = w[0], w1 = w[1];
    pair rp0 = rp[0], rp1 = rp[1], rs0 = rs[0], rs1 = rs[1];
    pair up0 = up[0], up1 = up[1], us0 = us[0], us1 = us[1];
    pair p0 = p[0], p1 = p[1], s0 = s[0], s1 = s[1];
    for (int i = 0; i < n; i++) {
        pair next0 = c0 * p0 + w0 * s0, next1 = c1 * p1 + w1 * s1;
        s0 = c0 * s0 - w0 * p0;
        s1 = c1 * s1 - w1 * p1;
        p0 = next0;
        p1 = next1;
        one[i].a += rp0 * p0 + rs0 * s0;
        one[i].b += rp1 * p1 + rs1 * s1;
        two[i].a += up0 * p0 + us0 * s0;
        two[i].b += up1 * p1 + us1 * s1;
    }
    if (!last)
        return;
    p[0] = p0;
    p[1] = p1;
    s[0] = s0;
    s[1] = s1;
}

// Runs all oscillators through one sample: here it is faster to keep the sum in registers.
static void rotate_sample(himc_bank *bank, const himc_readout *const *readouts, int count)
{
    pair *p = (pair *)bank->p, *s = (pair *)bank->s;
    const pair *c = (const pair *)bank->rotate_c, *w = (const pair *)bank->rotate_s;
    const pair *rp = (const pair *)readouts[0]->p, *rs = (const pair *)readouts[0]->s;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < bank->live / 2; i += 2) {
        pair p0 = c[i] * p[i] + w[i] * s[i], p1 = c[i + 1] * p[i + 1] + w[i + 1] * s[i + 1];
        pair s0 = c[i] * s[i] - w[i] * p[i], s1 = c[i + 1] * s[i + 1] - w[i + 1] * p[i + 1];
        p[i] = p0;
        p[i + 1] = p1;
        s[i] = s0;
        s[i + 1] = s1;
        sum.a += rp[i] * p0 + rs[i] * s0;
        sum.b += rp[i + 1] * p1 + rs[i + 1] * s1;
    }
    bank->sum[0][0] = sum;
    for (int k = 1; k < count; k++)
        bank->sum[k][0] = read_lanes(bank, readouts[k]);
}

static void count_steps(himc_bank *bank, int n)
{
    bank->age += n;
    if (bank->age == FLUSH_INTERVAL)
        flush_quiet(bank);
}

static void run_block(himc_bank *bank, int n, const himc_readout *const *readouts, int count,
                      double *const *out, int done)
{
    if (n == 1) {
        rotate_sample(bank, readouts, count);
    } else {
        memset(bank->sum, 0, sizeof bank->sum[0] * (size_t)(count + count % 2));
        for (int at = 0; at < bank->live; at += LANES)
            for (int k = 0; k < count; k += 2)
                rotate_block(bank, at, n, readouts[k], readouts[k + 1 < count ? k + 1 : k],
                             bank->sum[k], bank->sum[k + 1], k + 2 >= count);
    }
    for (int k = 0; k < count; k++)
        for (int i = 0; i < n; i++)
            out[k][done + i] = total(&bank->sum[k][i]);
    count_steps(bank, n);
}

void himc_bank_run(himc_bank *bank, int n, const himc_readout *const *readouts, int count,
                   double *const *out)
{
    for (int done = 0; done < n;) {
        int block = n - done < RUN_BLOCK ? n - done : RUN_BLOCK;
        if (block > FLUSH_INTERVAL - bank->age)
            block = FLUSH_INTERVAL - bank->age;
        run_block(bank, block, readouts, count, out, done);
        done += block;
    }
}

void himc_bank_run_coupled(himc_bank *bank, const double *weight, himc_tension_coupling *coupling)
{
    pair *p = (pair *)bank->p, *s = (pair *)bank->s, *g = (pair *)coupling->shape;
    const pair *c = (const pair *)bank->rotate_c, *w = (const pair *)bank->rotate_s;
    const pair *a = (const pair *)weight, *b = (const pair *)bank->q_per_p;
    const pair *push_p = (const pair *)bank->push_p;
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
    count_steps(bank, 1);
}

void himc_bank_coupling_weights(const himc_bank *bank, const double *on_square, double *weight)
{
    for (int i = 0; i < bank->capacity; i++)
        weight[i] = i < bank->count ? 0.5 * on_square[i] * bank->q_per_p[i] : 0;
}

void himc_bank_push(himc_bank *bank, const double *shape, double force)
{
    pair *p = (pair *)bank->p, *s = (pair *)bank->s;
    const pair *push_p = (const pair *)bank->push_p, *push_s = (const pair *)bank->push_s;
    const pair *a = (const pair *)shape;
    wake(bank);
    for (int i = 0; i < bank->live / 2; i++) {
        pair f = a[i] * force;
        p[i] += push_p[i] * f;
        s[i] += push_s[i] * f;
    }
}

double himc_bank_response(const himc_bank *bank, const double *shape, const himc_readout *readout)
{
    const pair *push_p = (const pair *)bank->push_p, *push_s = (const pair *)bank->push_s;
    const pair *rp = (const pair *)readout->p, *rs = (const pair *)readout->s,
               *a = (const pair *)shape;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < bank->capacity / 2; i += 2) {
        sum.a += a[i] * (rp[i] * push_p[i] + rs[i] * push_s[i]);
        sum.b += a[i + 1] * (rp[i + 1] * push_p[i + 1] + rs[i + 1] * push_s[i + 1]);
    }
    return total(&sum);
}

void himc_bank_step_response(const himc_bank *bank, const himc_readout *readout, double *response)
{
    for (int i = 0; i < bank->capacity; i++)
        response[i] = readout->p[i] * bank->push_p[i] + readout->s[i] * bank->push_s[i];
}

double himc_bank_sum(const himc_bank *bank, const double *shape, const double *response)
{
    return dot(shape, response, bank->capacity);
}
