/// take_strikes.c: strikes of a stick, found in the trajectory of its tip alone.
///
/// A strike is a peak of upward acceleration that ends a fall. Within 30 ms to either side of a
/// candidate the vertical speed rises by D. A hand that reverses a stick in the air spreads D over
/// that whole time; a drumhead does it within a few milliseconds. So with the largest second
/// difference A (m/s^2) the width D / A is compared: 4 Hz strokes in the air have 55 ms, a blow on
/// a head 8 to 18 ms even in a track that was low-pass filtered (24 ms allowed, and 3 frames where
/// frames are longer than 8 ms).
///
/// The capture's filter blunts the track near the touch, so time and speed come from before it: a
/// parabola by least squares over the last 24 ms (or 4 samples) of undisturbed fall, before the
/// deceleration reaches a tenth of A. A must be larger than noise alone makes it (noise.c); a noisy
/// track is judged by longer differences. In a sharp track (nearly all of D in two frames) the
/// touch is where the parabolas before and after intersect, and the speed is the slope there. In a
/// blunted track the touch is where the parabola before passes the height of the lowest position,
/// and the speed is its slope at the last undisturbed sample.
///
/// In a gap longer than a contact no strike is reported, because the curve that bridges a gap bends
/// arbitrarily.
#include "himc/mocap.h"

#include "base/noise.h"
#include "capture/order.h"
#include "capture/take.h"

#include <stdlib.h>

#define LEAST_SPEED 0.3    // chosen: slower touches are not strokes (m/s)
#define MOST_SINKING 0.3   // chosen: speed of a fall that goes on after it, as a share of its speed
#define REFRACTORY 0.05    // chosen: strikes of one hand are further apart (s)
#define STRIKE_WINDOW 0.03 // chosen: D is taken within this time, longer than any contact (s)
#define STRIKE_WIDTH 0.024 // chosen: most of D / A, between a head's 18 ms and the air's 55 (s)
#define STRIKE_FRAMES 3    // chosen: the same in frames, if these are long
#define FALL_TIME 0.024    // chosen: length of the parabolas, short beside a fall of 0.2 s (s)
#define CONTACT 0.007      // of a felt mallet with the simulated head (s)
#define LONGEST_UNSEEN 0.012   // chosen: longer gaps may hide a strike (s)
#define NOISE_DEVIATIONS 5.0   // chosen: standard deviations of noise that a bend must exceed
#define SHORT_DIFFERENCE 0.006 // chosen: of quiet tracks, about a contact (s) ...
#define LONG_DIFFERENCE 0.012  // ... and at most, of noisy ones (s)
#define QUIET_BEND 100.0       // chosen: noise up to which differences stay short (m/s^2)
#define SHARPEST_WITHIN 0.008  // chosen: time around a candidate for its largest bend (s)
#define LOWEST_WITHIN 0.025    // chosen: time around it for the lowest position (s)
#define FALL_DIFFERENCE 0.004  // chosen: of the bends that end the undisturbed fall (s)
#define DISTURBED 0.1          // chosen: share of the largest bend that ends the undisturbed fall
#define SHARP 0.8              // chosen: share of D that a sharp track has in two frames

typedef struct track {
    const himc_take *take;
    int point;
    const himc_vec3 *x;
    int frames;
    double rate;
    double noise; // one standard deviation (m)
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

// NOISE_DEVIATIONS standard deviations of bends over h frames by noise alone: for x_h - 2 x_0 +
// x_-h the variance is 6 sigma^2
static double noise_bend(const track *t, int h)
{
    double s = t->rate / h;
    return NOISE_DEVIATIONS * sqrt(6) * t->noise * s * s;
}

// frames of the differences in which strikes are looked for
static int difference(const track *t)
{
    int h = frames_of(t, SHORT_DIFFERENCE, 1), longest = frames_of(t, LONG_DIFFERENCE, 1);
    while (h < longest && noise_bend(t, h) > QUIET_BEND)
        h++;
    return h;
}

// least squares over n samples origin, origin + step, ...; fewer than 3 at the take's edges give a
// line or a constant
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

// a peak of upward acceleration
typedef struct candidate {
    int frame;
    double bend, rise; // A, D
} candidate;

static bool is_unseen(const track *t, int frame)
{
    return frame < 0 || frame >= t->frames ||
           !himc_vec3_finite(*himc_take_at(t->take, frame, t->point));
}

// true if frames from .. to reach into a gap that may hide a strike; at the take's ends any gap may
static bool in_gap(const track *t, int from, int to)
{
    int most = frames_of(t, LONGEST_UNSEEN, 2);
    for (int i = from; i <= to; i++) {
        int begin = i, end = i;
        while (begin >= 0 && is_unseen(t, begin) && i - begin <= most)
            begin--;
        while (end < t->frames && is_unseen(t, end) && end - i <= most)
            end++;
        if (is_unseen(t, i) && (begin < 0 || end == t->frames || end - begin - 1 > most))
            return true;
    }
    return false;
}

static bool is_strike(const track *t, int i, int h, candidate *s)
{
    int w = frames_of(t, STRIKE_WINDOW, 3);
    int before = i - h - w < 0 ? 0 : i - h - w,
        after = i + h + w >= t->frames ? t->frames - 1 : i + h + w;
    int near = frames_of(t, LONG_DIFFERENCE, 1);
    // the fastest fall before and the fastest rise after, each over 12 ms to average noise
    double down = 0, up = -INFINITY;
    for (int k = before; k + near <= i; k++)
        down = fmin(down, speed(t, k, k + near));
    for (int k = i; k + near <= after; k++)
        up = fmax(up, speed(t, k, k + near));
    *s = (candidate){i, bend(t, i, h), up - down};
    double width = fmax(STRIKE_WIDTH, STRIKE_FRAMES / t->rate);
    return down < -LEAST_SPEED && up > MOST_SINKING * down && s->rise < width * s->bend &&
           s->bend > noise_bend(t, h) && !in_gap(t, i - h, i + h);
}

static double bend_or_zero(const track *t, int i, int h)
{
    return i >= h && i + h < t->frames ? fmax(0, bend(t, i, h)) : 0;
}

// the frame of the largest bend by differences of h frames, near `frame`
static int sharpest(const track *t, int frame, int h)
{
    int w = frames_of(t, SHARPEST_WITHIN, 2), best = frame;
    for (int i = frame - w; i <= frame + w; i++)
        if (bend_or_zero(t, i, h) > bend_or_zero(t, best, h))
            best = i;
    return best;
}

// the last frame before a blunt peak in which the fall is still undisturbed
static int clean_end(const track *t, int frame)
{
    int h = frames_of(t, FALL_DIFFERENCE, 1), limit = frame - frames_of(t, STRIKE_WINDOW, 3);
    double largest = bend_or_zero(t, sharpest(t, frame, h), h);
    for (int i = frame - h; i > limit && i >= h; i--)
        if (bend(t, i, h) < DISTURBED * largest && t->x[i + h].z < t->x[i].z)
            return i + h;
    return frame > 0 ? frame - 1 : 0;
}

static himc_vec3 place_between(const track *t, double frame, double height)
{
    int i = (int)frame < t->frames - 1 ? (int)frame : t->frames - 2;
    himc_vec3 x = himc_vec3_madd(t->x[i], frame - i, himc_vec3_sub(t->x[i + 1], t->x[i]));
    x.z = height;
    return x;
}

static himc_take_strike measure(const track *t, const candidate *s, himc_hand hand)
{
    int peak = sharpest(t, s->frame, 1), w = frames_of(t, LOWEST_WITHIN, 2),
        n = frames_of(t, FALL_TIME, 4);
    double earlier = bend_or_zero(t, peak - 1, 1), later = bend_or_zero(t, peak + 1, 1);
    bool sharp = bend_or_zero(t, peak, 1) + fmax(earlier, later) > SHARP * s->rise * t->rate;
    int low = lowest(t, peak < w ? 0 : peak - w, peak + w < t->frames ? peak + w : t->frames - 1);
    // a kink between two frames bends the track in both: the fall ends with the earlier one
    int end = sharp ? peak - (earlier > later) : clean_end(t, peak);
    parabola before = fit(t, end, -1, n < end + 1 ? n : end + 1);
    parabola after = {t->x[low].z, 0, 0, low};
    if (sharp)
        after = fit(t, end + 1, 1, n < t->frames - end - 1 ? n : t->frames - end - 1);
    double touch = crossing(&before, &after, end, sharp ? end + 1 : low + 1);
    double u = sharp ? touch - end : 0;
    double height = sharp ? value(&before, touch) : t->x[low].z;
    double up = sharp ? (after.b + 2 * after.c * (touch - end - 1)) * t->rate : 0;
    return (himc_take_strike){.hand = hand,
                              .frame = low,
                              .time = touch / t->rate,
                              .x = place_between(t, touch, height),
                              .velocity = -(before.b + 2 * before.c * u) * t->rate,
                              .rebound = fmax(up, 0)};
}

// strikes of one hand from frame *from on; false when there are no more
static bool next_strike(const track *t, int *from, himc_hand hand, himc_take_strike *strike)
{
    int h = difference(t), apart = frames_of(t, REFRACTORY, 1);
    candidate best = {-1, 0, 0}, s;
    int i = *from < h ? h : *from;
    for (; i + h < t->frames && (best.frame < 0 || i < best.frame + apart); i++)
        if (bend(t, i, h) > best.bend && is_strike(t, i, h, &s))
            best = s;
    *from = best.frame + apart;
    if (best.frame >= 0)
        *strike = measure(t, &best, hand);
    return best.frame >= 0;
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, himc_order_doubles);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

int himc_take_strikes(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                      himc_take_strike *strikes, int capacity)
{
    himc_take_strike next[HIMC_HANDS];
    track tracks[HIMC_HANDS];
    int from[HIMC_HANDS] = {0, 0}, count = 0;
    bool waits[HIMC_HANDS];
    for (int h = 0; h < HIMC_HANDS; h++) {
        tracks[h] = (track){take, tips[h].point, tips[h].x, take->frames, take->rate, 0};
        if (tips[h].present && !himc_noise(tips[h].x, tracks[h].frames, &tracks[h].noise))
            return -1;
        waits[h] = tips[h].present && next_strike(&tracks[h], &from[h], (himc_hand)h, &next[h]);
    }
    // merges the two sorted lists while they are found
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

himc_take_strike *himc_take_find_strikes(const himc_take *take,
                                         const himc_take_tip tips[HIMC_HANDS], int *count)
{
    himc_take_strike none;
    int all = himc_take_strikes(take, tips, &none, 0);
    himc_take_strike *strikes = all < 0 ? NULL : calloc((size_t)all + 1, sizeof *strikes);
    *count = strikes ? himc_take_strikes(take, tips, strikes, all) : 0;
    if (*count >= 0)
        return strikes;
    *count = 0;
    free(strikes);
    return NULL;
}

// height of the head above the point where fall and rebound intersect: v t down and u (CONTACT - t)
// up again
static double above_intersection(const himc_take_strike *s)
{
    double sum = s->velocity + s->rebound;
    return sum > 0 ? CONTACT * s->velocity * s->rebound / sum : 0;
}

// the median position of one hand's strikes along one axis; false if it has none
static bool hand_median(const himc_take_strike *strikes, int count, int hand, int axis,
                        double *scratch, double *middle)
{
    int n = 0;
    for (int i = 0; i < count; i++)
        if ((int)strikes[i].hand == hand) {
            himc_vec3 x = strikes[i].x;
            scratch[n++] = axis == 0   ? x.x
                           : axis == 1 ? x.y
                                       : x.z + above_intersection(&strikes[i]);
        }
    if (n > 0)
        *middle = median(scratch, n);
    return n > 0;
}

bool himc_take_strike_place(const himc_take_strike *strikes, int count, himc_vec3 *place)
{
    double *scratch = count > 0 ? malloc((size_t)count * sizeof *scratch) : NULL;
    if (!scratch)
        return false;
    double middle[3];
    for (int axis = 0; axis < 3; axis++) {
        double l, r;
        bool left = hand_median(strikes, count, HIMC_LEFT, axis, scratch, &l);
        bool right = hand_median(strikes, count, HIMC_RIGHT, axis, scratch, &r);
        middle[axis] = left && right ? 0.5 * (l + r) : left ? l : r;
    }
    *place = himc_vec3_make(middle[0], middle[1], middle[2]);
    free(scratch);
    return true;
}
