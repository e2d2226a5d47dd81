/// strike_heads.c: the planes of the drumheads that a take's sticks fall on.
///
/// A head is a plane, so blows lie on it however soft they are, and turns in the air do not. Speed
/// alone cannot tell them apart: a pianissimo is slower than many a motion in the air. So speed
/// only gives the seeds: the sharp falls above the threshold that divides the logarithms of the
/// speeds best into two classes (Otsu 1979). Of the planes through three seeds the one with the
/// most seeds within their tolerances is taken (RANSAC: Fischler & Bolles 1981; scored as MSAC:
/// Torr & Zisserman 2000). Then any fall near the plane is on it, also the softest, and the plane
/// is fitted again to all of these by weighted least squares. If a good part of the seeds lie
/// elsewhere and agree on another plane, that is another drum. But a plane through which the same
/// hand strikes a lower head is none: there the stick is turned in the air.
///
/// A head gives way, and more to a faster stick, so soft blows end above the plane of loud ones.
/// Where rebounds tell how deep each fall went, sharp falls that lie on the head at rest are on it,
/// and the plane is then that of the head at rest.
///
/// The random numbers begin with the same seed each time, and no loop depends on the data but by
/// the number of falls. The numbers are chosen by 400 synthetic takes
/// (tests/capture/test_take_mixed.c).
#include "capture/strike_heads.h"

#include "base/random.h"
#include "base/order.h"

#include <math.h>
#include <stdlib.h>

#define LEAST_SEEDS 3 // with fewer all sharp falls are seeds; no fewer make another drum
#define OVER 0.05     // (m) a plane in the air is higher than the head by more ...
#define BESIDE 0.1    // (m) ... and the hand's places on both are less far apart; chosen

typedef struct seeds {
    const himc_fall **fall;
    int count;
} seeds;

// the speed at which Otsu's threshold divides the logarithms of all speeds: that with the largest
// variance between both classes
static double dividing_speed(const himc_fall *falls, int count, double *scratch)
{
    double all = 0, low = 0, best = -1, threshold = -INFINITY;
    for (int i = 0; i < count; i++)
        scratch[i] = log(falls[i].speed);
    qsort(scratch, (size_t)count, sizeof *scratch, himc_order_doubles);
    for (int i = 0; i < count; i++)
        all += scratch[i];
    for (int i = 0; i < count - 1; i++) {
        low += scratch[i];
        double below = i + 1, above = count - below;
        double apart = (all - low) / above - low / below, between = below * above * apart * apart;
        if (between > best) {
            best = between;
            threshold = 0.5 * (scratch[i] + scratch[i + 1]);
        }
    }
    return exp(threshold);
}

static void find_seeds(const himc_fall *falls, int count, double threshold, seeds *to)
{
    to->count = 0;
    for (int i = 0; i < count; i++)
        if (falls[i].sharp && falls[i].speed > threshold)
            to->fall[to->count++] = &falls[i];
}

// where a fall ends on that head; at rest, if that is where its plane is
static himc_vec3 end_on(const himc_strike_head *head, const himc_fall *f)
{
    return himc_vec3_make(f->x.x, f->x.y, f->x.z + (head->at_rest ? f->depth : 0));
}

static double off(const himc_strike_head *head, const himc_fall *f)
{
    himc_vec3 x = end_on(head, f);
    return fabs(x.z - himc_strike_head_at(head, x.x, x.y));
}

// the plane through three places; level through the first if they are in line or too steep
static himc_strike_head through(himc_vec3 a, himc_vec3 b, himc_vec3 c)
{
    himc_vec3 n = himc_vec3_cross(himc_vec3_sub(b, a), himc_vec3_sub(c, a));
    himc_strike_head head = {
        .x0 = a.x, .y0 = a.y, .height = a.z, .slope_x = -n.x / n.z, .slope_y = -n.y / n.z};
    if (!(hypot(head.slope_x, head.slope_y) < 0.15)) // a tilted timpano's is 0.1; NaN in line
        head.slope_x = head.slope_y = 0;
    return head;
}

static const himc_fall *any_seed(const seeds *s, uint64_t *random)
{
    return s->fall[himc_random_bits(random) % (uint64_t)s->count];
}

// RANSAC: 300 planes through three seeds, and level ones through one. Their score is that of the
// seeds that are on no head yet; fast ones count more, so that they decide between few
static himc_strike_head best_plane(const seeds *s)
{
    uint64_t random = 1;
    double most = -1;
    himc_strike_head best = {0};
    for (int i = 0; i < 300; i++) {
        himc_vec3 a = any_seed(s, &random)->x, b = any_seed(s, &random)->x,
                  c = any_seed(s, &random)->x;
        himc_strike_head tried = i % 2 ? through(a, b, c) : through(a, a, a);
        double score = 0;
        for (int k = 0; k < s->count; k++) {
            double d = off(&tried, s->fall[k]) / s->fall[k]->within;
            if (s->fall[k]->head < 0 && d < 1)
                score += s->fall[k]->speed * (1 - d * d);
        }
        if (score > most) {
            most = score;
            best = tried;
        }
    }
    return best;
}

static bool lies_on(const himc_strike_head *head, const himc_fall *f)
{
    return off(head, f) < f->within * (f->sharp ? 1 : 0.5);
}

// least squares over the falls on head `index`, weighted by their tolerances. A slope is expected
// to be 0 with a deviation of 0.3, so that strikes on one spot say nothing about it
static void fit(himc_strike_head *head, const himc_fall *falls, int count, int index)
{
    struct {
        double w, x, y, z, xx, xy, yy, xz, yz;
    } s = {0};
    himc_vec3 middle = {head->x0, head->y0, head->height};
    for (int i = 0; i < count; i++) {
        if (falls[i].head != index)
            continue;
        double w = 1 / (falls[i].within * falls[i].within);
        himc_vec3 d = himc_vec3_sub(end_on(head, &falls[i]), middle);
        s.w += w;
        s.x += w * d.x, s.y += w * d.y, s.z += w * d.z;
        s.xx += w * d.x * d.x, s.xy += w * d.x * d.y, s.yy += w * d.y * d.y;
        s.xz += w * d.x * d.z, s.yz += w * d.y * d.z;
    }
    if (s.w <= 0)
        return;
    double x = s.x / s.w, y = s.y / s.w, z = s.z / s.w, rest = 1 / (0.3 * 0.3);
    double xx = s.xx - s.x * x + rest, xy = s.xy - s.x * y, yy = s.yy - s.y * y + rest,
           xz = s.xz - s.x * z, yz = s.yz - s.y * z, det = xx * yy - xy * xy;
    head->x0 += x, head->y0 += y, head->height += z;
    head->slope_x = (xz * yy - yz * xy) / det;
    head->slope_y = (yz * xx - xz * xy) / det;
}

// gives the head the free falls near it, and fits it to them, in turn
static void settle(himc_strike_head *head, himc_fall *falls, int count, int index)
{
    for (int round = 0; round < 5; round++) {
        head->strikes = 0;
        for (int i = 0; i < count; i++) {
            himc_fall *f = &falls[i];
            if (f->head < 0 || f->head == index)
                f->head = lies_on(head, f) ? index : -1;
            head->strikes += f->head == index;
        }
        fit(head, falls, count, index);
    }
}

// takes the head at rest as the plane, if softer blows lie on it that end above the plane so far
static void settle_at_rest(himc_strike_head *head, himc_fall *falls, int count, int index)
{
    himc_strike_head rest = *head;
    bool softer = false;
    rest.at_rest = true;
    fit(&rest, falls, count, index);
    for (int i = 0; i < count; i++) {
        const himc_fall *f = &falls[i];
        softer |= f->head < 0 && f->sharp && f->depth > 0 && lies_on(&rest, f);
    }
    if (!softer)
        return;
    *head = rest;
    settle(head, falls, count, index);
}

static int seeds_on(const seeds *s, int head)
{
    int n = 0;
    for (int i = 0; i < s->count; i++)
        n += s->fall[i]->head == head;
    return n;
}

// the higher of two planes, if a hand falls on both at one place; else -1
static int in_the_air(const himc_fall *falls, int count, int a, int b)
{
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        himc_vec3 sum[2] = {{0}};
        double n[2] = {0};
        for (int i = 0; i < count; i++)
            if ((int)falls[i].hand == hand && (falls[i].head == a || falls[i].head == b)) {
                int on = falls[i].head == b;
                sum[on] = himc_vec3_madd(sum[on], 1, falls[i].x);
                n[on]++;
            }
        if (n[0] < 2 || n[1] < 2)
            continue;
        himc_vec3 d =
            himc_vec3_sub(himc_vec3_scale(sum[1], 1 / n[1]), himc_vec3_scale(sum[0], 1 / n[0]));
        if (fabs(d.z) > OVER && hypot(d.x, d.y) < BESIDE)
            return d.z > 0 ? b : a;
    }
    return -1;
}

// its falls are on no head; -1: none
static void give_up(himc_fall *falls, int count, himc_strike_head *heads, int head)
{
    if (head < 0)
        return;
    heads[head].strikes = 0;
    for (int i = 0; i < count; i++)
        falls[i].head = falls[i].head == head ? -1 : falls[i].head;
}

int himc_strike_heads(himc_fall *falls, int count, himc_strike_head heads[HIMC_STRIKE_HEADS])
{
    double *speeds = calloc((size_t)count + 1, sizeof *speeds);
    seeds s = {calloc((size_t)count + 1, sizeof(himc_fall *)), 0};
    bool memory = speeds && s.fall;
    int n = 0;
    for (int i = 0; i < count; i++)
        falls[i].head = -1;
    if (memory)
        find_seeds(falls, count, dividing_speed(falls, count, speeds), &s);
    if (memory && s.count < LEAST_SEEDS)
        find_seeds(falls, count, 0, &s);
    // a good part of the seeds off the heads so far is another drum's if most of them agree on a
    // plane
    for (int rest = seeds_on(&s, -1); n < HIMC_STRIKE_HEADS; n++, rest = seeds_on(&s, -1)) {
        if (rest == 0 || (n > 0 && rest <= 0.2 * s.count))
            break;
        heads[n] = best_plane(&s);
        settle(&heads[n], falls, count, n);
        settle_at_rest(&heads[n], falls, count, n);
        int on = seeds_on(&s, n);
        bool other = n == 0 || (on >= LEAST_SEEDS && on >= 0.6 * rest);
        for (int i = 0; i < count && !other; i++)
            falls[i].head = falls[i].head == n ? -1 : falls[i].head;
        if (!other)
            break;
    }
    for (int k = 1; k < n; k++)
        for (int i = 0; i < k; i++)
            give_up(falls, count, heads, in_the_air(falls, count, i, k));
    // the most struck first
    for (int i = 1; i < n; i++)
        for (int k = i; k > 0 && heads[k].strikes > heads[k - 1].strikes; k--) {
            himc_strike_head head = heads[k];
            heads[k] = heads[k - 1];
            heads[k - 1] = head;
            for (int j = 0; j < count; j++)
                if (falls[j].head == k || falls[j].head == k - 1)
                    falls[j].head = 2 * k - 1 - falls[j].head;
        }
    while (n > 0 && heads[n - 1].strikes == 0)
        n--;
    free(speeds);
    free((void *)(uintptr_t)s.fall);
    return memory ? n : -1;
}
