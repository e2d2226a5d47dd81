/// units.c: the fall of a captured stroke as a polynomial with fixed ends.
///
/// With u the share of the fall's time and h the share of its height,
///     h(u) = A(u) + a B(u) + s C(u) + u^3 (1 - u)^3 (b0 + b1 u + b2 u^2)
/// where A falls from 1 to 0 at rest at both ends, B has the second derivative 1 at u = 0, C the
/// slope -1 at u = 1 (quintics, else zero at both ends up to second derivatives). So for all a, s
/// and b a tip begins at rest with the acceleration a, and lands with the speed s and without
/// acceleration. They are found by least squares from the frames of the fall, without those that
/// the impact has blunted. Another landing speed is another s. A fall that is not monotone is not a
/// unit.
#include "capture/units.h"

#include <stdlib.h>
#include <string.h>

// chosen: a stroke falls for 0.2 to 0.4 s; longer or shorter is another motion (s)
#define LONGEST_FALL 0.5
#define SHORTEST_FALL 0.03
#define LONGEST_RISE 0.5    // chosen: of the way up to the apex (s)
#define LONGEST_REBOUND 0.4 // chosen (s)
#define BLUNT 0.008         // chosen: time before the touch that a capture's filter blunts (s)
#define TOP 0.985           // chosen: share of the height at which the fall begins
#define LEAST_HEIGHT 0.02   // chosen: lower ones are noise or rolls (m)
#define RESTITUTION 0.85    // chosen: rebound speed over landing speed of a mallet on a head
#define RIDGE 1e-9          // chosen: keeps the normal equations regular, far below their entries
#define UNKNOWNS 5          // a, s, b0, b1, b2

// a fall is monotone and between its ends, within this
#define MOST_EXCESS 0.02  // chosen (heights, heights per fall)
#define LEAST_LANDING 0.5 // chosen (heights per fall)
#define MOST_LANDING 4.0

// ranges of the motion around the fall, chosen: those of the built-in strokes and somewhat more
#define LEAST_REBOUND_HEIGHT 0.2 // (heights)
#define MOST_REBOUND_HEIGHT 1.2
#define CLEAR_REBOUND 0.005 // a lower rebound has no duration (m)
#define LEAST_PULL 0.7      // (rebound height / rebound speed)
#define MOST_PULL 2.4
#define USUAL_PULL 2.0
#define LEAST_LIFT 0.15 // (s)
#define MOST_LIFT 0.4
#define RISE_NOISE 1e-4 // (m)
#define MOST_DEPTH 0.25 // (m)

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

// solves the normal equations in place; false if they are singular
static bool solve(double a[UNKNOWNS][UNKNOWNS + 1])
{
    for (int k = 0; k < UNKNOWNS; k++) {
        a[k][k] += RIDGE;
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

static bool is_fall(const himc_unit *unit, double landing)
{
    double fall[3];
    for (int i = 1; i <= 32; i++) {
        himc_unit_at(unit, i / 33.0, landing, fall);
        if (fall[1] > MOST_EXCESS || fall[0] > 1 + MOST_EXCESS || fall[0] < -MOST_EXCESS)
            return false;
    }
    return landing > LEAST_LANDING && landing < MOST_LANDING;
}

// the capture of one hand around one strike
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
    return is_fall(unit, landing);
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
    unit->rebound = fmin(fmax(high / unit->height, LEAST_REBOUND_HEIGHT), MOST_REBOUND_HEIGHT);
    double pull = time * RESTITUTION * unit->speed / high;
    unit->pull = high > CLEAR_REBOUND ? fmin(fmax(pull, LEAST_PULL), MOST_PULL) : USUAL_PULL;
}

static void measure_lift(const cut *c, int top, himc_unit *unit)
{
    int low = top;
    while (low > 0 && low / c->rate > fmax(c->before, top / c->rate - LONGEST_RISE) &&
           height(c, low - 1) <= height(c, low) + RISE_NOISE)
        low--;
    unit->lift = fmin(fmax((top - low) / c->rate, LEAST_LIFT), MOST_LIFT);
    unit->depth = 0;
    for (int i = low; i < c->strike->frame; i++)
        unit->depth =
            fmax(unit->depth, hypot(c->x[i].x - c->strike->x.x, c->x[i].y - c->strike->x.y));
    unit->depth = fmin(unit->depth, MOST_DEPTH);
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

// time of the hand's next (step 1) or last (step -1) touch, infinite without one
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
    if (!strikes) {
        himc_error_set(error, "out of memory");
        return -1;
    }
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
        himc_error_set(error, "%d strokes, expected at least one that is a clear fall from above",
                       found);
        return -1;
    }
    return count;
}
