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

#define SHORTEST_FALL 0.03 // chosen: a shorter one is another motion (s)
#define BLUNT 0.008        // chosen: time before the touch that a capture's filter blunts (s)
#define UNKNOWNS 5         // a, s, b0, b1, b2

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
    if (count < UNKNOWNS + 1)
        return false;
    for (int k = 0; k < UNKNOWNS; k++) {
        a[k][k] += 1e-9; // chosen: keeps the equations regular, far below their entries
        for (int i = 0; i < UNKNOWNS; i++) {
            double f = i == k ? 0 : a[i][k] / a[k][k];
            for (int j = k; j <= UNKNOWNS; j++)
                a[i][j] -= f * a[k][j];
        }
    }
    for (int k = 0; k < UNKNOWNS; k++)
        if (!isfinite(a[k][UNKNOWNS] /= a[k][k]))
            return false;
    double landing = a[1][UNKNOWNS];
    unit->start = a[0][UNKNOWNS];
    for (int i = 0; i < 3; i++)
        unit->bend[i] = a[2 + i][UNKNOWNS];
    unit->speed = landing * unit->height / unit->down;
    // monotone and between its ends, within `excess` (heights, heights per fall; chosen)
    const double excess = 0.02;
    for (int i = 1; i <= 32; i++) {
        double fall[3];
        himc_unit_at(unit, i / 33.0, landing, fall);
        if (fall[1] > excess || fall[0] > 1 + excess || fall[0] < -excess)
            return false;
    }
    return landing > 0.5 && landing < 4; // heights per fall, chosen
}

// false if the stroke is no clear fall. The ranges of the motion around it are those of the
// built-in strokes and somewhat more, chosen
static bool cut_unit(const cut *c, himc_unit *unit)
{
    double touch = c->strike->time;
    int last = (int)floor((touch - BLUNT) * c->rate), top = last;
    // chosen: a stroke falls for 0.2 to 0.4 s, and begins where its height is 1.5 % less
    double earliest = fmax(fmax(c->before + SHORTEST_FALL, touch - 0.5), 0);
    for (int i = last; i >= 0 && i / c->rate > earliest; i--)
        if (height(c, i) > height(c, top))
            top = i;
    int begin = top;
    while (begin < last && height(c, begin + 1) > 0.985 * height(c, top))
        begin++;
    *unit = (himc_unit){.hand = c->strike->hand, .spot = HIMC_SPOT_XY};
    // chosen: lower ones than 2 cm are noise or rolls
    bool clear = height(c, top) > 0.02 && touch - begin / c->rate > SHORTEST_FALL;
    if (!clear || !fit_fall(c, begin, unit))
        return false;
    // the rise after the touch, up to its top or the next fall; below 5 mm it has no duration
    int first = c->strike->frame, high = first;
    for (int i = first; i < c->frames && i / c->rate < fmin(touch + 0.4, c->after); i++)
        if (height(c, i) > height(c, high))
            high = i;
    double rise = height(c, high);
    unit->rebound = fmin(fmax(rise / unit->height, 0.2), 1.2);
    unit->pull = 2;
    if (rise > 0.005) // 0.85, chosen: rebound speed over landing speed of a mallet on a head
        unit->pull = fmin(fmax((high / c->rate - touch) * 0.85 * unit->speed / rise, 0.7), 2.4);
    // the rise before the apex, but for noise
    int low = top;
    while (low > 0 && low / c->rate > fmax(c->before, top / c->rate - 0.5) &&
           height(c, low - 1) <= height(c, low) + 1e-4)
        low--;
    unit->lift = fmin(fmax((top - low) / c->rate, 0.15), 0.4);
    for (int i = low; i < c->strike->frame; i++)
        unit->depth =
            fmax(unit->depth, hypot(c->x[i].x - c->strike->x.x, c->x[i].y - c->strike->x.y));
    unit->depth = fmin(unit->depth, 0.25);
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
