/// take_strikes.c: where a stick struck, from its tip's track alone.
///
/// A strike is a spike of upward acceleration that ends a fall. Over 30 ms to either side of a
/// candidate the vertical speed rises by D; a hand that turns a stick in the air spreads D over
/// that whole time, a drumhead gives it within a few milliseconds. So with the largest second
/// difference A (m/s^2) the width D / A is compared: 4 Hz strokes in the air have 55 ms, a blow on
/// a head 8 to 18 ms even in a track that was low-pass filtered (24 ms allowed, and 3 frames where
/// frames are longer than 8 ms).
///
/// The track near the touch is blunted by the capture's filter, so what happens is read from
/// before: a parabola by least squares over the last 6 samples (or 20 ms) of undisturbed fall,
/// those before the deceleration reaches a quarter of A. In a sharp track (nearly all of D within
/// two frames) the touch is where the parabolas from before and after meet; in a blunted one, where
/// the one from before passes the height of the lowest position. The speed is the parabola's slope
/// there, at most one frame beyond the samples it was fitted to.
#include "himc/take.h"

#include <stdlib.h>

#define LEAST_SPEED 0.3 // slower touches are no strokes (m/s)
#define REFRACTORY 0.05 // strikes of one hand are further apart (s)
#define WINDOW 0.03     // (s)

typedef struct track {
    const himc_vec3 *x;
    int frames;
    double rate;
} track;

// a + b u + c u^2, u in frames from `origin`
typedef struct parabola {
    double a, b, c;
    int origin;
} parabola;

static double speed(const track *t, int from, int to)
{
    return (t->x[to].z - t->x[from].z) * t->rate / (to - from);
}

static double bend(const track *t, int i, int h)
{
    double s = t->rate / h;
    return (t->x[i + h].z - 2 * t->x[i].z + t->x[i - h].z) * s * s;
}

static int frames_of(const track *t, double seconds, int least)
{
    int n = (int)lround(seconds * t->rate);
    return n < least ? least : n;
}

// least squares over samples origin, origin + step, ...; n >= 2, at the take's edges whatever there
// is
static parabola fit(const track *t, int origin, int step, int n)
{
    double s[5] = {0, 0, 0, 0, 0}, r[3] = {0, 0, 0};
    for (int k = 0; k < n; k++) {
        double u = step * k, z = t->x[origin + step * k].z - t->x[origin].z;
        for (int j = 0; j < 5; j++)
            s[j] += pow(u, j);
        r[0] += z, r[1] += u * z, r[2] += u * u * z;
    }
    parabola p = {t->x[origin].z, 0, 0, origin};
    double det = s[0] * (s[2] * s[4] - s[3] * s[3]) - s[1] * (s[1] * s[4] - s[2] * s[3]) +
                 s[2] * (s[1] * s[3] - s[2] * s[2]);
    if (n < 3) {
        p.b = n == 2 ? (t->x[origin + step].z - t->x[origin].z) / step : 0;
        return p;
    }
    p.a += (r[0] * (s[2] * s[4] - s[3] * s[3]) + r[1] * (s[2] * s[3] - s[1] * s[4]) +
            r[2] * (s[1] * s[3] - s[2] * s[2])) /
           det;
    p.b = (r[0] * (s[2] * s[3] - s[1] * s[4]) + r[1] * (s[0] * s[4] - s[2] * s[2]) +
           r[2] * (s[1] * s[2] - s[0] * s[3])) /
          det;
    p.c = (r[0] * (s[1] * s[3] - s[2] * s[2]) + r[1] * (s[1] * s[2] - s[0] * s[3]) +
           r[2] * (s[0] * s[2] - s[1] * s[1])) /
          det;
    return p;
}

static double value(const parabola *p, double frame)
{
    double u = frame - p->origin;
    return p->a + u * (p->b + u * p->c);
}

// where p - q passes zero going down, between frames from and to, by bisection; `to` if it does not
static double crossing(const parabola *p, const parabola *q, double from, double to)
{
    if (value(p, to) > value(q, to))
        return to;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (from + to);
        if (value(p, middle) > value(q, middle))
            from = middle;
        else
            to = middle;
    }
    return 0.5 * (from + to);
}

static int lowest(const track *t, int from, int to)
{
    int best = from;
    for (int i = from; i <= to; i++)
        if (t->x[i].z < t->x[best].z)
            best = i;
    return best;
}

// a spike's facts
typedef struct spike {
    int frame;
    double bend, rise; // A, D
} spike;

static bool is_strike(const track *t, int i, int h, spike *s)
{
    int w = frames_of(t, WINDOW, 3);
    int before = i - h - w < 0 ? 0 : i - h - w,
        after = i + h + w >= t->frames ? t->frames - 1 : i + h + w;
    int near = frames_of(t, 0.012, 1);
    // the fastest fall before and the fastest rise after, each over 12 ms so that noise does not
    // count
    double down = 0, up = -INFINITY;
    for (int k = before; k + near <= i; k++)
        down = fmin(down, speed(t, k, k + near));
    for (int k = i; k + near <= after; k++)
        up = fmax(up, speed(t, k, k + near));
    *s = (spike){i, bend(t, i, h), up - down};
    double width = fmax(0.024, 3 / t->rate);
    return down < -LEAST_SPEED && up > 0.3 * down && s->rise < width * s->bend;
}

// the last frame before the spike in which the fall is still undisturbed
static int clean_end(const track *t, int frame, double largest)
{
    int limit = frame - frames_of(t, WINDOW, 3);
    for (int i = frame; i > limit && i >= 2; i--)
        if (bend(t, i - 1, 1) < 0.25 * largest && t->x[i].z < t->x[i - 1].z)
            return i;
    return frame > 0 ? frame - 1 : 0;
}

static double sharpest(const track *t, int frame, int *where)
{
    int w = frames_of(t, 0.008, 2);
    double largest = 0;
    for (int i = frame - w; i <= frame + w; i++)
        if (i >= 1 && i + 1 < t->frames && bend(t, i, 1) > largest) {
            largest = bend(t, i, 1);
            *where = i;
        }
    return largest;
}

static double bend_or_zero(const track *t, int i)
{
    return i >= 1 && i + 1 < t->frames ? fmax(0, bend(t, i, 1)) : 0;
}

static himc_take_strike measure(const track *t, const spike *s, himc_hand hand)
{
    int peak = s->frame, w = frames_of(t, 0.025, 2);
    double largest = sharpest(t, s->frame, &peak);
    int low =
        lowest(t, peak - w < 0 ? 0 : peak - w, peak + w >= t->frames ? t->frames - 1 : peak + w);
    int end = clean_end(t, peak, largest), n = frames_of(t, 0.02, 6);
    parabola before = fit(t, end, -1, n < end + 1 ? n : end + 1);
    double neighbour = fmax(bend_or_zero(t, peak - 1), bend_or_zero(t, peak + 1));
    bool sharp = (largest + neighbour) / t->rate > 0.8 * s->rise;
    parabola level = {t->x[low].z, 0, 0, low}, after = level;
    double latest = peak + w;
    if (sharp) {
        int start =
            end + 1 < peak + 1 ? peak + (bend_or_zero(t, peak + 1) > 0.25 * largest) : end + 1;
        start = start < t->frames ? start : t->frames - 1;
        after = fit(t, start, 1, n < t->frames - start ? n : t->frames - start);
        latest = start;
    }
    double touch = crossing(&before, &after, end, latest);
    double slope_at = fmin(touch, end + 1.0) - before.origin;
    int i = (int)touch < t->frames - 1 ? (int)touch : t->frames - 2;
    himc_vec3 x = himc_vec3_madd(t->x[i], touch - i, himc_vec3_sub(t->x[i + 1], t->x[i]));
    x.z = sharp ? value(&before, touch) : t->x[low].z;
    return (himc_take_strike){hand, low, touch / t->rate, x,
                              -(before.b + 2 * before.c * slope_at) * t->rate};
}

// strikes of one hand from frame *from on; false when there are no more
static bool next_strike(const track *t, int *from, himc_hand hand, himc_take_strike *strike)
{
    int h = frames_of(t, 0.006, 1), apart = frames_of(t, REFRACTORY, 1);
    spike best = {-1, 0, 0}, s;
    int i = *from < h ? h : *from;
    for (; i + h < t->frames && (best.frame < 0 || i < best.frame + apart); i++)
        if (bend(t, i, h) > best.bend && is_strike(t, i, h, &s))
            best = s;
    *from = best.frame + apart;
    if (best.frame >= 0)
        *strike = measure(t, &best, hand);
    return best.frame >= 0;
}

int himc_take_strikes(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                      himc_take_strike *strikes, int capacity)
{
    himc_take_strike next[HIMC_HANDS];
    track tracks[HIMC_HANDS];
    int from[HIMC_HANDS] = {0, 0}, count = 0;
    bool waits[HIMC_HANDS];
    for (int h = 0; h < HIMC_HANDS; h++) {
        tracks[h] = (track){tips[h].x, himc_take_frames(take), himc_take_rate(take)};
        waits[h] = tips[h].present && next_strike(&tracks[h], &from[h], (himc_hand)h, &next[h]);
    }
    // two sorted lists are merged as they are found
    while (waits[HIMC_LEFT] || waits[HIMC_RIGHT]) {
        int h = !waits[HIMC_LEFT] ||
                (waits[HIMC_RIGHT] && next[HIMC_RIGHT].time < next[HIMC_LEFT].time);
        if (count < capacity)
            strikes[count] = next[h];
        count++;
        waits[h] = next_strike(&tracks[h], &from[h], (himc_hand)h, &next[h]);
    }
    return count;
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, compare);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

bool himc_take_strike_place(const himc_take_strike *strikes, int count, himc_vec3 *place)
{
    double *v = count > 0 ? malloc((size_t)count * sizeof *v) : NULL;
    if (!v)
        return false;
    for (int i = 0; i < count; i++)
        v[i] = strikes[i].x.x;
    place->x = median(v, count);
    for (int i = 0; i < count; i++)
        v[i] = strikes[i].x.y;
    place->y = median(v, count);
    for (int i = 0; i < count; i++)
        v[i] = strikes[i].x.z;
    place->z = median(v, count);
    free(v);
    return true;
}
