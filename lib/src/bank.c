/// bank.c: the exact step as a rotation.
///
/// With w_d = sqrt(w^2 - d^2), the coordinates p = w_d q and s = q' + d q turn by the angle w_d h
/// and shrink by exp(-d h) in a sample of length h:
///     p' = C p + S s,   s' = C s - S p,   C = exp(-d h) cos w_d h,   S = exp(-d h) sin w_d h.
/// A force f constant over the sample adds b1 f to q and b2 f to q' (zero-order hold), b1 = (1 -
/// a11)/(m w^2) with a11 = C + d S/w_d, and b2 = S/(m w_d); in p, s: w_d b1 f and (b2 + d b1) f.
///
/// The order of all sums is fixed: four lanes, each in the order of the oscillators. So a run of n
/// samples and n runs of one give the same bits, on any machine. Every 1024 samples the oscillators
/// at the top that have fallen below 1e-15 m/s are put to rest and skipped until the next force:
/// high modes die first, and denormal numbers never arise.
#include "himc/bank.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LANES 4
#define CHUNK 64     // samples per pass: both sums of a chunk stay in the first cache
#define QUIET 1e-15  // m/s
#define TENDING 1024 // samples between looks for quiet oscillators

// two oscillators at once, which every machine's compiler makes one instruction of, with the same
// result
typedef double pair __attribute__((vector_size(2 * sizeof(double)), may_alias));

// a sum in four lanes, and its total in a fixed order
typedef struct lanes {
    pair a, b;
} lanes;

struct himc_bank {
    int capacity; // a multiple of LANES
    int count;    // oscillators that swing
    int live;     // of these, the first `live` (a multiple of LANES) are not at rest
    int age;      // samples since the last look for quiet ones
    double *memory;
    double *p, *s;                         // state
    double *turn_c, *turn_s;               // C, S
    double *push_p, *push_s;               // what 1 N adds
    double *omega, *decay, *mass, *damped; // w, d, m, w_d
    double *yield;                         // 1/w_d: q per p
    lanes sum[HIMC_BANK_TAPS][CHUNK];
};

#define ARRAYS 11

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
    double **arrays[ARRAYS] = {&bank->p,      &bank->s,      &bank->turn_c, &bank->turn_s,
                               &bank->push_p, &bank->push_s, &bank->omega,  &bank->decay,
                               &bank->mass,   &bank->damped, &bank->yield};
    for (int i = 0; i < ARRAYS; i++)
        *arrays[i] = memory + (size_t)i * length;
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

// coefficients of one oscillator for samples of length h
static void tune(himc_bank *bank, int i, const himc_oscillator *o, double h)
{
    double damped = sqrt((o->omega - o->decay) * (o->omega + o->decay));
    double shrink = exp(-o->decay * h), half = sin(0.5 * damped * h);
    double c = shrink * cos(damped * h), s = shrink * sin(damped * h);
    // 1 - a11 = (1 - C) - d S/w_d without the cancellation in 1 - C
    double fall = -expm1(-o->decay * h) + 2 * shrink * half * half - o->decay / damped * s;
    double b1 = fall / (o->mass * o->omega * o->omega), b2 = s / (o->mass * damped);
    bank->omega[i] = o->omega;
    bank->decay[i] = o->decay;
    bank->mass[i] = o->mass;
    bank->damped[i] = damped;
    bank->yield[i] = 1 / damped;
    bank->turn_c[i] = c;
    bank->turn_s[i] = s;
    bank->push_p[i] = damped * b1;
    bank->push_s[i] = b2 + o->decay * b1;
}

static void silence(himc_bank *bank, int i)
{
    bank->p[i] = bank->s[i] = bank->turn_c[i] = bank->turn_s[i] = bank->push_p[i] =
        bank->push_s[i] = 0;
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

void himc_bank_tap(const himc_bank *bank, const double *on_q, const double *on_v, himc_tap *tap)
{
    for (int i = 0; i < bank->capacity; i++) {
        double q = on_q && i < bank->count ? on_q[i] / bank->damped[i] : 0;
        double v = on_v && i < bank->count ? on_v[i] : 0;
        tap->p[i] = q - (v != 0 ? v * bank->decay[i] / bank->damped[i] : 0);
        tap->s[i] = v;
    }
}

static double total(const lanes *sum)
{
    return (sum->a[0] + sum->a[1]) + (sum->b[0] + sum->b[1]);
}

double himc_bank_read(const himc_bank *bank, const himc_tap *tap)
{
    const pair *p = (const pair *)bank->p, *s = (const pair *)bank->s;
    const pair *tp = (const pair *)tap->p, *ts = (const pair *)tap->s;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < bank->live / 2; i += 2) {
        sum.a += tp[i] * p[i] + ts[i] * s[i];
        sum.b += tp[i + 1] * p[i + 1] + ts[i + 1] * s[i + 1];
    }
    return total(&sum);
}

double himc_bank_peek(const himc_bank *bank, const himc_tap *tap)
{
    double sum = 0;
    for (int i = 0; i < bank->count; i++) {
        double p = bank->turn_c[i] * bank->p[i] + bank->turn_s[i] * bank->s[i];
        double s = bank->turn_c[i] * bank->s[i] - bank->turn_s[i] * bank->p[i];
        sum += tap->p[i] * p + tap->s[i] * s;
    }
    return sum;
}

double himc_bank_displacement(const himc_bank *bank, const himc_tap *tap)
{
    const pair *p = (const pair *)bank->p, *tp = (const pair *)tap->p;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < bank->live / 2; i += 2) {
        sum.a += tp[i] * p[i];
        sum.b += tp[i + 1] * p[i + 1];
    }
    return total(&sum);
}

// rests the quiet ones at the top; only at multiples of TENDING samples, so that block sizes do not
// matter
static void tend(himc_bank *bank)
{
    bank->age = 0;
    int live = bank->live;
    while (live > 0 && fabs(bank->p[live - 1]) < QUIET && fabs(bank->s[live - 1]) < QUIET) {
        live--;
        bank->p[live] = bank->s[live] = 0;
    }
    bank->live = (live + LANES - 1) / LANES * LANES;
}

// Four oscillators through n samples, adding what two taps read. States and coefficients stay in
// registers; where more than two read, the state is written back by the last two alone.
static void turn(himc_bank *bank, int at, int n, const himc_tap *first, const himc_tap *second,
                 lanes *one, lanes *two, bool last)
{
    pair *p = (pair *)(bank->p + at), *s = (pair *)(bank->s + at);
    const pair *c = (const pair *)(bank->turn_c + at), *w = (const pair *)(bank->turn_s + at);
    const pair *tp = (const pair *)(first->p + at), *ts = (const pair *)(first->s + at);
    const pair *uq = (const pair *)(second->p + at), *us = (const pair *)(second->s + at);
    pair c0 = c[0], c1 = c[1], w0 = w[0], w1 = w[1];
    pair tp0 = tp[0], tp1 = tp[1], ts0 = ts[0], ts1 = ts[1];
    pair up0 = uq[0], up1 = uq[1], us0 = us[0], us1 = us[1];
    pair p0 = p[0], p1 = p[1], s0 = s[0], s1 = s[1];
    for (int i = 0; i < n; i++) {
        pair next0 = c0 * p0 + w0 * s0, next1 = c1 * p1 + w1 * s1;
        s0 = c0 * s0 - w0 * p0;
        s1 = c1 * s1 - w1 * p1;
        p0 = next0;
        p1 = next1;
        one[i].a += tp0 * p0 + ts0 * s0;
        one[i].b += tp1 * p1 + ts1 * s1;
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

// what a tap reads now, into `sum`
static void read_lanes(const himc_bank *bank, const himc_tap *tap, lanes *sum)
{
    const pair *p = (const pair *)bank->p, *s = (const pair *)bank->s;
    const pair *tp = (const pair *)tap->p, *ts = (const pair *)tap->s;
    *sum = (lanes){{0}, {0}};
    for (int i = 0; i < bank->live / 2; i += 2) {
        sum->a += tp[i] * p[i] + ts[i] * s[i];
        sum->b += tp[i + 1] * p[i + 1] + ts[i + 1] * s[i + 1];
    }
}

// the same for all oscillators and one sample, where it pays to keep the sums in registers instead
static void turn_once(himc_bank *bank, const himc_tap *const *taps, int count)
{
    pair *p = (pair *)bank->p, *s = (pair *)bank->s;
    const pair *c = (const pair *)bank->turn_c, *w = (const pair *)bank->turn_s;
    const pair *tp = (const pair *)taps[0]->p, *ts = (const pair *)taps[0]->s;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < bank->live / 2; i += 2) {
        pair p0 = c[i] * p[i] + w[i] * s[i], p1 = c[i + 1] * p[i + 1] + w[i + 1] * s[i + 1];
        pair s0 = c[i] * s[i] - w[i] * p[i], s1 = c[i + 1] * s[i + 1] - w[i + 1] * p[i + 1];
        p[i] = p0;
        p[i + 1] = p1;
        s[i] = s0;
        s[i + 1] = s1;
        sum.a += tp[i] * p0 + ts[i] * s0;
        sum.b += tp[i + 1] * p1 + ts[i + 1] * s1;
    }
    bank->sum[0][0] = sum;
    for (int k = 1; k < count; k++)
        read_lanes(bank, taps[k], &bank->sum[k][0]);
}

static void grow_old(himc_bank *bank, int n)
{
    bank->age += n;
    if (bank->age == TENDING)
        tend(bank);
}

static void run_chunk(himc_bank *bank, int n, const himc_tap *const *taps, int count,
                      double *const *read, int done)
{
    if (n == 1) {
        turn_once(bank, taps, count);
    } else {
        memset(bank->sum, 0, sizeof bank->sum[0] * (size_t)(count + count % 2));
        for (int at = 0; at < bank->live; at += LANES)
            for (int k = 0; k < count; k += 2)
                turn(bank, at, n, taps[k], taps[k + 1 < count ? k + 1 : k], bank->sum[k],
                     bank->sum[k + 1], k + 2 >= count);
    }
    for (int k = 0; k < count; k++)
        for (int i = 0; i < n; i++)
            read[k][done + i] = total(&bank->sum[k][i]);
    grow_old(bank, n);
}

void himc_bank_run(himc_bank *bank, int n, const himc_tap *const *taps, int count,
                   double *const *read)
{
    for (int done = 0; done < n;) {
        int chunk = n - done < CHUNK ? n - done : CHUNK;
        if (chunk > TENDING - bank->age)
            chunk = TENDING - bank->age;
        run_chunk(bank, chunk, taps, count, read, done);
        done += chunk;
    }
}

void himc_bank_run_pulled(himc_bank *bank, const double *weight, himc_pull *pull)
{
    pair *p = (pair *)bank->p, *s = (pair *)bank->s, *g = (pair *)pull->shape;
    const pair *c = (const pair *)bank->turn_c, *w = (const pair *)bank->turn_s;
    const pair *a = (const pair *)weight, *b = (const pair *)bank->yield;
    const pair *push_p = (const pair *)bank->push_p;
    lanes climb = {{0}, {0}}, compliance = {{0}, {0}};
    for (int i = 0; i < bank->live / 2; i += 2) {
        pair q0 = p[i], q1 = p[i + 1];
        pair p0 = c[i] * q0 + w[i] * s[i], p1 = c[i + 1] * q1 + w[i + 1] * s[i + 1];
        s[i] = c[i] * s[i] - w[i] * q0;
        s[i + 1] = c[i + 1] * s[i + 1] - w[i + 1] * q1;
        p[i] = p0;
        p[i + 1] = p1;
        pair g0 = g[i] = a[i] * (q0 + p0), g1 = g[i + 1] = a[i + 1] * (q1 + p1);
        climb.a += g0 * (p0 - q0) * b[i];
        climb.b += g1 * (p1 - q1) * b[i + 1];
        compliance.a += g0 * g0 * b[i] * push_p[i];
        compliance.b += g1 * g1 * b[i + 1] * push_p[i + 1];
    }
    for (int i = bank->live / 2; i < bank->capacity / 2; i++)
        g[i] = (pair){0};
    pull->climb = total(&climb);
    pull->compliance = total(&compliance);
    grow_old(bank, 1);
}

void himc_bank_weigh(const himc_bank *bank, const double *on_square, double *weight)
{
    for (int i = 0; i < bank->capacity; i++)
        weight[i] = i < bank->count ? 0.5 * on_square[i] * bank->yield[i] : 0;
}

void himc_bank_push(himc_bank *bank, const double *shape, double force)
{
    pair *p = (pair *)bank->p, *s = (pair *)bank->s;
    const pair *push_p = (const pair *)bank->push_p, *push_s = (const pair *)bank->push_s;
    const pair *a = (const pair *)shape;
    bank->live = (bank->count + LANES - 1) / LANES * LANES;
    for (int i = 0; i < bank->live / 2; i++) {
        pair f = a[i] * force;
        p[i] += push_p[i] * f;
        s[i] += push_s[i] * f;
    }
}

double himc_bank_response(const himc_bank *bank, const double *shape, const himc_tap *tap)
{
    const pair *push_p = (const pair *)bank->push_p, *push_s = (const pair *)bank->push_s;
    const pair *tp = (const pair *)tap->p, *ts = (const pair *)tap->s, *a = (const pair *)shape;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < bank->capacity / 2; i += 2) {
        sum.a += a[i] * (tp[i] * push_p[i] + ts[i] * push_s[i]);
        sum.b += a[i + 1] * (tp[i + 1] * push_p[i + 1] + ts[i + 1] * push_s[i + 1]);
    }
    return total(&sum);
}

void himc_bank_answer(const himc_bank *bank, const himc_tap *tap, double *answer)
{
    for (int i = 0; i < bank->capacity; i++)
        answer[i] = tap->p[i] * bank->push_p[i] + tap->s[i] * bank->push_s[i];
}

double himc_bank_sum(const himc_bank *bank, const double *shape, const double *answer)
{
    const pair *a = (const pair *)shape, *b = (const pair *)answer;
    lanes sum = {{0}, {0}};
    for (int i = 0; i < bank->capacity / 2; i += 2) {
        sum.a += a[i] * b[i];
        sum.b += a[i + 1] * b[i + 1];
    }
    return total(&sum);
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
