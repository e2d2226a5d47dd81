/// bank_run.c: the bank swings, is pushed and read.
///
/// The order of all sums is fixed: four lanes, each in the order of the oscillators. So a run of n
/// samples and n runs of one give the same bits, on any machine. Every 1024 steps the oscillators
/// at the top that have fallen below 1e-15 m/s are put to rest and skipped until the next force:
/// high modes die first, and denormal numbers never arise.
#include "drum/bank_state.h"

#include <math.h>
#include <string.h>

#define QUIET 1e-15  // m/s
#define TENDING 1024 // steps between looks for quiet oscillators

static double total(const lanes *sum)
{
    return (sum->a[0] + sum->a[1]) + (sum->b[0] + sum->b[1]);
}

double himc_bank_read(const himc_bank *bank, const himc_readout *tap)
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

double himc_bank_peek(const himc_bank *bank, const himc_readout *tap)
{
    double sum = 0;
    for (int i = 0; i < bank->count; i++) {
        double p = bank->turn_c[i] * bank->p[i] + bank->turn_s[i] * bank->s[i];
        double s = bank->turn_c[i] * bank->s[i] - bank->turn_s[i] * bank->p[i];
        sum += tap->p[i] * p + tap->s[i] * s;
    }
    return sum;
}

double himc_bank_displacement(const himc_bank *bank, const himc_readout *tap)
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
static void turn(himc_bank *bank, int at, int n, const himc_readout *first,
                 const himc_readout *second, lanes *one, lanes *two, bool last)
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
static void read_lanes(const himc_bank *bank, const himc_readout *tap, lanes *sum)
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
static void turn_once(himc_bank *bank, const himc_readout *const *taps, int count)
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

static void run_chunk(himc_bank *bank, int n, const himc_readout *const *taps, int count,
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

void himc_bank_run(himc_bank *bank, int n, const himc_readout *const *taps, int count,
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

void himc_bank_run_coupled(himc_bank *bank, const double *weight, himc_tension_coupling *pull)
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

double himc_bank_response(const himc_bank *bank, const double *shape, const himc_readout *tap)
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

void himc_bank_step_response(const himc_bank *bank, const himc_readout *tap, double *answer)
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
