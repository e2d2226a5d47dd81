/// meeting.c: the discrete-gradient force of a compression, and its implicit equation.
///
/// Over a sample of length h the compression goes from c0 to c0 + r and the force is held at
///     F(r) = max(0, (V(c0 + r) - V(c0)) (1/r + mu/h)),    V(c) = k c^(alpha+1)/(alpha+1),
/// so its elastic part does exactly the work V(c0 + r) - V(c0), and the rest only takes energy (V
/// does not decrease). The bodies answer linearly: r = b - G F(r). V is convex, so F does not
/// decrease with r: the residual r - b + G F(r) of one compression rises with slope >= 1 and has
/// one root, between b - G F(b) and b; Newton steps kept inside that bracket find it. (Discrete
/// gradient: Chatziioannou & van Walstijn 2015; Bilbao, Torin & Chatziioannou 2015.)
///
/// Several compressions on one head: the residual is G times the gradient of the strictly convex
///     Psi(r) = (r - b)' G^-1 (r - b)/2 + sum_i int F_i dr_i,
/// so Newton's direction descends and a line search on Psi's slope makes it converge from anywhere.
#include "drum/contact_pair.h"

#include <math.h>
#include <string.h>

#define STEPS 60

double himc_contact_pair_potential(double k, double alpha, double c)
{
    return c > 0 ? k * pow(c, alpha + 1) / (alpha + 1) : 0;
}

// (V(c0 + r) - V(c0))/r and its derivative
static double gradient(const meeting *m, double r, double *slope)
{
    double c1 = m->c0 + r, mid = m->c0 + 0.5 * r;
    *slope = 0;
    if (c1 <= 0 && m->c0 <= 0)
        return 0;
    // small steps: the difference would cancel; V' at the midpoint and its second derivative are
    // exact to (r/mid)^4
    if (fabs(r) < 1e-3 * mid) {
        double force = m->k * pow(mid, m->alpha), t = r / mid;
        *slope = 0.5 * m->alpha * force / mid;
        return force * (1 + m->alpha * (m->alpha - 1) / 24 * t * t);
    }
    double force1 = c1 > 0 ? m->k * pow(c1, m->alpha) : 0;
    double mean = (force1 * fmax(c1, 0) / (m->alpha + 1) - m->potential0) / r;
    *slope = (force1 - mean) / r;
    return mean;
}

static double force_of(const meeting *m, double r, double h, double *slope)
{
    double change, mean = gradient(m, r, &change), loss = 1 + m->mu * r / h;
    *slope = change * loss + mean * m->mu / h;
    if (mean * loss > 0)
        return mean * loss;
    *slope = 0;
    return 0;
}

static void solve_one(meeting *m, double g, double h)
{
    double slope, high = m->b, low = m->b - g * force_of(m, m->b, h, &slope);
    double r = fmin(fmax(m->b - g * m->guess, low), high);
    for (int i = 0; i < STEPS; i++) {
        m->force = force_of(m, r, h, &slope);
        double residual = r - m->b + g * m->force;
        if (residual > 0)
            high = r;
        else
            low = r;
        double next = r - residual / (1 + g * slope);
        if (!(next >= low && next <= high))
            next = 0.5 * (low + high);
        if (fabs(next - r) <= 4e-16 * (fabs(r) + fabs(m->c0)))
            return;
        r = next;
    }
}

// A x = y by elimination with the largest pivot; A and y are used up
static void eliminate(double (*a)[MEETINGS], double *y, int n)
{
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i][k]) > fabs(a[best][k]))
                best = i;
        for (int j = k; j < n; j++) {
            double t = a[k][j];
            a[k][j] = a[best][j];
            a[best][j] = t;
        }
        double t = y[k];
        y[k] = y[best];
        y[best] = t;
        for (int i = k + 1; i < n; i++) {
            double f = a[i][k] / a[k][k];
            for (int j = k; j < n; j++)
                a[i][j] -= f * a[k][j];
            y[i] -= f * y[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++)
            y[k] -= a[k][j] * y[j];
        y[k] /= a[k][k];
    }
}

// the state of the search: forces, their slopes and the residual at r
typedef struct search {
    const meeting *m;
    double (*g)[MEETINGS];
    int n;
    double h;
    double r[MEETINGS], force[MEETINGS], slope[MEETINGS], residual[MEETINGS];
} search;

// true when every residual is rounding
static bool look(search *s)
{
    bool done = true;
    for (int i = 0; i < s->n; i++)
        s->force[i] = force_of(&s->m[i], s->r[i], s->h, &s->slope[i]);
    for (int i = 0; i < s->n; i++) {
        double pushed = 0;
        for (int j = 0; j < s->n; j++)
            pushed += s->g[i][j] * s->force[j];
        s->residual[i] = s->r[i] - s->m[i].b + pushed;
        double size = fabs(s->r[i]) + fabs(s->m[i].b) + fabs(s->m[i].c0) + fabs(pushed);
        done = done && fabs(s->residual[i]) <= 4e-16 * size;
    }
    return done;
}

// Newton's direction from here: (1 + G D) step = -residual
static void direction(const search *s, double *step)
{
    double a[MEETINGS][MEETINGS];
    for (int i = 0; i < s->n; i++) {
        for (int j = 0; j < s->n; j++)
            a[i][j] = (i == j) + s->g[i][j] * s->slope[j];
        step[i] = -s->residual[i];
    }
    eliminate(a, step, s->n);
}

// slope of Psi along `step`, with dual = G^-1 step
static double descent(const search *s, const double *dual)
{
    double sum = 0;
    for (int i = 0; i < s->n; i++)
        sum += dual[i] * s->residual[i];
    return sum;
}

// goes along `step` until Psi's slope has fallen; the whole step nearly always
static bool line(search *s, const double *step)
{
    double a[MEETINGS][MEETINGS], dual[MEETINGS], from[MEETINGS];
    memcpy(a, s->g, sizeof(double) * MEETINGS * (size_t)s->n);
    memcpy(dual, step, sizeof(double) * (size_t)s->n);
    memcpy(from, s->r, sizeof from);
    eliminate(a, dual, s->n);
    double start = fabs(descent(s, dual)), low = 0, high = 1, t = 1;
    for (int i = 0; i < 30; i++) {
        for (int k = 0; k < s->n; k++)
            s->r[k] = from[k] + t * step[k];
        if (look(s))
            return true;
        double now = descent(s, dual);
        if (!(fabs(now) > 0.9 * start))
            return false;
        if (now > 0)
            high = t;
        else
            low = t;
        t = 0.5 * (low + high);
    }
    return false;
}

static void solve_together(meeting *meetings, int n, double (*g)[MEETINGS], double h)
{
    search s = {.m = meetings, .g = g, .n = n, .h = h};
    for (int i = 0; i < n; i++) {
        s.r[i] = meetings[i].b;
        for (int j = 0; j < n; j++)
            s.r[i] -= g[i][j] * meetings[j].guess;
    }
    bool done = look(&s);
    for (int i = 0; i < STEPS && !done; i++) {
        double step[MEETINGS];
        direction(&s, step);
        done = line(&s, step);
    }
    for (int i = 0; i < n; i++)
        meetings[i].force = s.force[i];
}

void himc_contact_pairs_solve(meeting *meetings, int count, double (*g)[MEETINGS], double h)
{
    bool apart = true;
    for (int i = 0; i < count; i++) {
        meeting *m = &meetings[i];
        m->force = 0;
        m->potential0 = himc_contact_pair_potential(m->k, m->alpha, m->c0);
        apart = apart && m->c0 <= 0 && m->c0 + m->b <= 0;
    }
    if (apart)
        return;
    if (count == 1)
        solve_one(meetings, g[0][0], h);
    else
        solve_together(meetings, count, g, h);
    for (int i = 0; i < count; i++)
        if (!isfinite(meetings[i].force))
            meetings[i].force = 0;
}
