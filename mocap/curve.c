/// curve.c: the share of one joint in a stroke over time; and random numbers.
///
/// A joint goes from 1, its angle at the apex, to 0, its angle at the impact. Falling in time T and
/// arriving with the rate e it moves as 1 - (t/T)^n does, n = e T: the smooth quintic that arrives
/// with the acceleration of that power, -e (n - 1) / T (for n below 3 less of it, none below 2).
/// The rebound is the mirror image. A joint that arrives faster than a fall of power 4.5 begins its
/// fall later: so the distal joints, which are the faster ones, follow the proximal ones, as in
/// every stroke and throw. Around the impact one quintic leads from the arrival to the rebound, in
/// the times `reversal`; it is shifted so that it passes 0 at the impact.
#include "parts.h"

#include "base/quintic.h"
#include "base/random.h"

#include <stdlib.h>

#define STEEPEST 4.5   // chosen: power of the fastest fall
#define LEAST_RATE 0.1 // chosen: of an arrival, so that its time stays finite (1/s)

// a slow drift has frequencies from 0.08 to 0.58 Hz, chosen: slower than strokes (Hz)
#define SLOWEST_SINE 0.08
#define SINE_RANGE 0.5

bool himc_mocap_curve_init(mocap_curve *curve, int room)
{
    curve->count = 0;
    curve->room = room;
    curve->knot = calloc((size_t)room, sizeof *curve->knot);
    return curve->knot != NULL;
}

void himc_mocap_curve_free(mocap_curve *curve)
{
    free(curve->knot);
}

void himc_mocap_curve_add(mocap_curve *curve, mocap_knot knot)
{
    if (curve->count == curve->room)
        return;
    // a lift that would end after the next fall begins delays that fall
    if (curve->count > 0)
        knot.t = fmax(knot.t, curve->knot[curve->count - 1].t);
    curve->knot[curve->count++] = knot;
}

static double interpolate(const mocap_knot *a, const mocap_knot *b, double t)
{
    himc_target from = {{a->x, 0, 0}, {a->v, 0, 0}, {a->a, 0, 0}};
    himc_target to = {{b->x, 0, 0}, {b->v, 0, 0}, {b->a, 0, 0}};
    himc_quintic q = himc_quintic_make(&from, &to, b->t - a->t);
    return himc_quintic_at(&q, t - a->t).x.x;
}

double himc_mocap_curve_at(const mocap_curve *curve, double t)
{
    int lo = 0, hi = curve->count - 1;
    if (t <= curve->knot[0].t)
        return curve->knot[0].x;
    if (t >= curve->knot[hi].t)
        return curve->knot[hi].x;
    while (hi - lo > 1) {
        int middle = (lo + hi) / 2;
        if (curve->knot[middle].t <= t)
            lo = middle;
        else
            hi = middle;
    }
    return interpolate(&curve->knot[lo], &curve->knot[hi], t);
}

double himc_mocap_soften(double rate, double *time)
{
    *time = fmin(*time, STEEPEST / fmax(rate, LEAST_RATE));
    double n = rate * *time, more = fmin(fmax(n - 2, 0), 1);
    return -more * rate * (n - 1) / *time;
}

double himc_mocap_reversal_rate(const mocap_share *s, double t)
{
    double u = fmin(fmax((t + s->reversal[0]) / (s->reversal[0] + s->reversal[1]), 0), 1);
    return -s->arrive + (s->arrive + s->rebound) * u * u * (3 - 2 * u);
}

void himc_mocap_curve_stroke(mocap_curve *curve, const mocap_share *s)
{
    double fall = s->fall - s->reversal[0], lift = s->lift - s->reversal[1];
    double rise = 0.5 * (s->reversal[0] + s->reversal[1]) * (s->rebound - s->arrive);
    mocap_knot in = {-s->reversal[0], 0, -s->arrive, himc_mocap_soften(s->arrive, &fall)};
    mocap_knot out = {s->reversal[1], rise, s->rebound, himc_mocap_soften(s->rebound, &lift)};
    double passed = interpolate(&in, &out, 0);
    in.x -= passed;
    out.x -= passed;
    in.t += s->touch;
    out.t += s->touch;
    himc_mocap_curve_add(curve, (mocap_knot){in.t - fall, 1, 0, 0});
    himc_mocap_curve_add(curve, in);
    himc_mocap_curve_add(curve, out);
    himc_mocap_curve_add(curve, (mocap_knot){out.t + lift, s->top, 0, 0});
}

mocap_random himc_mocap_random(uint64_t seed, const int *which, int count)
{
    mocap_random random = {seed};
    for (int i = 0; i < count; i++)
        random.state = himc_random_bits(&random.state) + (uint64_t)which[i];
    return random;
}

double himc_mocap_uniform(mocap_random *random)
{
    return (double)(himc_random_bits(&random->state) >> 11) * 0x1p-53;
}

double himc_mocap_normal(mocap_random *random)
{
    double sum = 0;
    for (int i = 0; i < 12; i++)
        sum += himc_mocap_uniform(random);
    return fmin(fmax(sum - 6, -2), 2);
}

mocap_wander himc_mocap_wander(mocap_random *random)
{
    mocap_wander w;
    for (int i = 0; i < MOCAP_SINES; i++) {
        w.rate[i] = 2 * HIMC_PI *
                    (SLOWEST_SINE + SINE_RANGE * (i + himc_mocap_uniform(random)) / MOCAP_SINES);
        w.phase[i] = 2 * HIMC_PI * himc_mocap_uniform(random);
    }
    return w;
}

double himc_mocap_wander_at(const mocap_wander *w, double t)
{
    double sum = 0;
    for (int i = 0; i < MOCAP_SINES; i++)
        sum += sin(w->rate[i] * t + w->phase[i]);
    return sum * sqrt(2.0 / MOCAP_SINES);
}
