/// units.c: the fall of a captured stroke as a polynomial that knows where it begins and ends.
///
/// With u the share of the fall's time and h the share of its height,
///     h(u) = A(u) + a B(u) + s C(u) + u^3 (1 - u)^3 (b0 + b1 u + b2 u^2)
/// where A falls from 1 to 0 at rest at both ends, B has the second derivative 1 at u = 0, C the
/// slope -1 at u = 1 (quintics, else zero at both ends up to second derivatives). So a tip begins
/// still, with the acceleration a, and lands with the speed s and without acceleration, whatever
/// a, s and b are; they are found by least squares from the frames of the fall, without those
/// that the impact has blunted. Another landing speed is another s. A fall that is not monotone
/// is no unit.
#include "capture/units.h"

#include <stdlib.h>
#include <string.h>

#define LONGEST_FALL 0.5    // (s)
#define SHORTEST_FALL 0.03  // (s)
#define LONGEST_REBOUND 0.4 // (s)
#define BLUNT 0.008         // before the touch, not fitted (s)
#define TOP 0.985           // of the height: the fall begins there
#define LEAST_HEIGHT 0.02   // (m)
#define RESTITUTION 0.85
#define UNKNOWNS 5

typedef struct terms {
    double value[3][1 + UNKNOWNS]; // of A, B, C and the three bends; then derivatives
} terms;

static terms terms_at(double u)
{
    double u2 = u * u, u3 = u2 * u, u4 = u3 * u, u5 = u4 * u, w = 1 - u;
    terms t = {{{1 - 10 * u3 + 15 * u4 - 6 * u5, 0.5 * (u2 - 3 * u3 + 3 * u4 - u5),
                 4 * u3 - 7 * u4 + 3 * u5},
                {-30 * u2 + 60 * u3 - 30 * u4, u - 4.5 * u2 + 6 * u3 - 2.5 * u4,
                 12 * u2 - 28 * u3 + 15 * u4},
                {-60 * u + 180 * u2 - 120 * u3, 1 - 9 * u + 18 * u2 - 10 * u3,
                 24 * u - 84 * u2 + 60 * u3}}};
    // u^n (1 - u)^3 for n = 3, 4, 5
    for (int i = 0; i < 3; i++) {
        double n = 3 + i, p = pow(u, n - 2);
        t.value[0][3 + i] = p * u2 * w * w * w;
        t.value[1][3 + i] = p * u * w * w * (n * w - 3 * u);
        t.value[2][3 + i] = p * w * (n * (n - 1) * w * w - 6 * n * u * w + 6 * u2);
    }
    return t;
}

void himc_unit_at(const himc_unit *unit, double share, double landing, double fall[3])
{
    terms t = terms_at(share);
    for (int d = 0; d < 3; d++) {
        const double *x = t.value[d];
        fall[d] = x[0] + unit->start * x[1] + landing * x[2];
        for (int i = 0; i < 3; i++)
            fall[d] += unit->bend[i] * x[3 + i];
    }
}

// solves the normal equations in place; false if they say too little
static bool solve(double a[UNKNOWNS][UNKNOWNS + 1])
{
    for (int k = 0; k < UNKNOWNS; k++) {
        a[k][k] += 1e-9;
        for (int i = 0; i < UNKNOWNS; i++) {
            double f = i == k ? 0 : a[i][k] / a[k][k];
            for (int j = k; j <= UNKNOWNS; j++)
                a[i][j] -= f * a[k][j];
        }
    }
    for (int k = 0; k < UNKNOWNS; k++)
        if (!isfinite(a[k][UNKNOWNS] /= a[k][k]))
            return false;
    return true;
}

static bool falls(const himc_unit *unit, double landing)
{
    double fall[3];
    for (int i = 1; i <= 32; i++) {
        himc_unit_at(unit, i / 33.0, landing, fall);
        if (fall[1] > 0.02 || fall[0] > 1.02 || fall[0] < -0.02)
            return false;
    }
    return landing > 0.5 && landing < 4;
}

// one hand's capture around one strike
typedef struct cut {
    const himc_vec3 *x;
    int frames;
    double rate;
    const himc_take_strike *strike;
    double before, after; // the touches around it (s)
} cut;

static double height(const cut *c, int frame)
{
    return c->x[frame].z - c->strike->x.z;
}

static bool fit_fall(const cut *c, int first, himc_unit *unit)
{
    double a[UNKNOWNS][UNKNOWNS + 1] = {{0}}, begin = first / c->rate;
    int count = 0;
    unit->height = height(c, first);
    unit->down = c->strike->time - begin;
    for (int i = first; i / c->rate < c->strike->time - BLUNT; i++, count++) {
        terms t = terms_at((i / c->rate - begin) / unit->down);
        const double *x = t.value[0];
        double missing = height(c, i) / unit->height - x[0];
        for (int r = 0; r < UNKNOWNS; r++) {
            for (int k = 0; k < UNKNOWNS; k++)
                a[r][k] += x[1 + r] * x[1 + k];
            a[r][UNKNOWNS] += x[1 + r] * missing;
        }
    }
    if (count < UNKNOWNS + 1 || !solve(a))
        return false;
    double landing = a[1][UNKNOWNS];
    unit->start = a[0][UNKNOWNS];
    for (int i = 0; i < 3; i++)
        unit->bend[i] = a[2 + i][UNKNOWNS];
    unit->speed = landing * unit->height / unit->down;
    return falls(unit, landing);
}

// the rise after the touch, up to its top or the next fall
static void measure_rebound(const cut *c, himc_unit *unit)
{
    int first = c->strike->frame, top = first;
    for (int i = first;
         i < c->frames && i / c->rate < fmin(c->strike->time + LONGEST_REBOUND, c->after); i++)
        if (height(c, i) > height(c, top))
            top = i;
    double high = height(c, top), time = top / c->rate - c->strike->time;
    unit->rebound = fmin(fmax(high / unit->height, 0.2), 1.2);
    unit->pull = high > 0.005 ? fmin(fmax(time * RESTITUTION * unit->speed / high, 0.7), 2.4) : 2;
}

static void measure_lift(const cut *c, int top, himc_unit *unit)
{
    int low = top;
    while (low > 0 && low / c->rate > fmax(c->before, top / c->rate - 0.5) &&
           height(c, low - 1) <= height(c, low) + 1e-4)
        low--;
    unit->lift = fmin(fmax((top - low) / c->rate, 0.15), 0.4);
    unit->depth = 0;
    for (int i = low; i < c->strike->frame; i++)
        unit->depth =
            fmax(unit->depth, hypot(c->x[i].x - c->strike->x.x, c->x[i].y - c->strike->x.y));
    unit->depth = fmin(unit->depth, 0.25);
}

static bool cut_unit(const cut *c, himc_unit *unit)
{
    int last = (int)floor((c->strike->time - BLUNT) * c->rate), top = last;
    double earliest = fmax(fmax(c->before + SHORTEST_FALL, c->strike->time - LONGEST_FALL), 0);
    for (int i = last; i >= 0 && i / c->rate > earliest; i--)
        if (height(c, i) > height(c, top))
            top = i;
    int begin = top;
    while (begin < last && height(c, begin + 1) > TOP * height(c, top))
        begin++;
    bool clear = height(c, top) > LEAST_HEIGHT && c->strike->time - begin / c->rate > SHORTEST_FALL;
    *unit = (himc_unit){.hand = c->strike->hand, .spot = HIMC_SPOT_XY};
    if (!clear || !fit_fall(c, begin, unit))
        return false;
    measure_rebound(c, unit);
    measure_lift(c, top, unit);
    return true;
}

static double touch_of_hand(const himc_take_strike *strikes, int count, int i, int step)
{
    himc_hand hand = strikes[i].hand;
    for (i += step; i >= 0 && i < count; i += step)
        if (strikes[i].hand == hand)
            return strikes[i].time;
    return step < 0 ? -HUGE_VAL : HUGE_VAL;
}

int himc_units_cut(himc_take *take, const himc_take_options *options, himc_unit *units,
                   int capacity, himc_error *error)
{
    himc_take_tip tips[HIMC_HANDS];
    if (!himc_take_tips(take, options, tips, error))
        return -1;
    int found, count = 0;
    himc_take_strike *strikes = himc_take_find_strikes(take, tips, &found);
    for (int i = 0; i < found; i++) {
        cut c = {.x = tips[strikes[i].hand].x,
                 .frames = himc_take_frames(take),
                 .rate = himc_take_rate(take),
                 .strike = &strikes[i],
                 .before = touch_of_hand(strikes, found, i, -1),
                 .after = touch_of_hand(strikes, found, i, 1)};
        himc_unit unit;
        if (!cut_unit(&c, &unit))
            continue;
        if (count < capacity)
            units[count] = unit;
        count++;
    }
    free(strikes);
    if (count == 0) {
        himc_error_set(error, "%d strokes, none of them one clear fall from above", found);
        return -1;
    }
    return count;
}
