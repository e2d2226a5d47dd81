/// mixed_takes.h: takes of two sticks that strike a tilted head from pp to ff and turn in the air
/// between, at known times: what a finder of strikes must tell apart; and the score of a finder.
///
/// A blow is a fall of constant acceleration, a contact of 3 to 8 ms on a cubic, and a rise. An air
/// turn falls and rises on a cosine, 20 to 150 mm above the head; an abrupt one is a blow on
/// nothing. What a tracker shows of it is low-pass filtered without phase, sampled and noisy.
#ifndef HIMC_TESTS_MIXED_TAKES_H
#define HIMC_TESTS_MIXED_TAKES_H

#include "take_files.h"

#include "base/random.h"
#include "unity.h"

#include <math.h>

#define MIXED_MOST 1024     // events of a hand
#define MIXED_FINE 4000.0   // least rate of the true motion (Hz)
#define MIXED_CUTOFF 0.35   // of the low-pass filter, as a share of the rate ...
#define MIXED_SHARPEST 500. // ... of captures that are no faster (Hz)

typedef struct mixed_config {
    double rate, noise, seconds; // (Hz), (m), (s)
    double slowest, fastest;     // of blows (m/s)
    double air;                  // share of events in the air
    bool abrupt;                 // as sharp as blows
    double slow_air, fast_air;   // (m/s)
    double low_air, high_air;    // their heights above the head (m)
    double tilt;                 // largest slope of the head
    double lower;                // of a second head under the left hand (m)
    uint64_t seed;
} mixed_config;

typedef struct mixed_event {
    double time, speed; // of the touch, or of the lowest point in the air
    bool blow;
} mixed_event;

typedef struct mixed_hand {
    mixed_event event[MIXED_MOST];
    int count;
} mixed_hand;

typedef struct mixed_truth {
    mixed_hand hand[HIMC_HANDS];
    himc_strike_head head; // under the right hand
} mixed_truth;

// one coordinate's path as it is written, frame by frame of the fine rate
typedef struct mixed_pen {
    double *to;
    int frames, at;
    double rate;
} mixed_pen;

static inline double mixed_uniform(uint64_t *state, double from, double to)
{
    return from + (to - from) * (double)(himc_random_bits(state) >> 11) * 0x1p-53;
}

static inline double mixed_normal(uint64_t *state)
{
    double u = 1 - mixed_uniform(state, 0, 1), turn = mixed_uniform(state, 0, 2 * HIMC_PI);
    return sqrt(-2 * log(u)) * cos(turn);
}

// a cubic from height and speed to height and speed, from the pen's place to time `to`
static inline void mixed_cubic(mixed_pen *pen, double from, double to, const double a[2],
                               const double b[2])
{
    double T = to - from;
    for (; pen->at < pen->frames && pen->at / pen->rate < to; pen->at++) {
        double s = (pen->at / pen->rate - from) / T, r = 1 - s;
        pen->to[pen->at] = r * r * (1 + 2 * s) * a[0] + s * r * r * T * a[1] +
                           s * s * (3 - 2 * s) * b[0] - s * s * r * T * b[1];
    }
}

static inline void mixed_cosine(mixed_pen *pen, double from, double to, double a, double b)
{
    for (; pen->at < pen->frames && pen->at / pen->rate < to; pen->at++) {
        double s = (pen->at / pen->rate - from) / (to - from);
        pen->to[pen->at] = a + (b - a) * (1 - cos(HIMC_PI * s)) / 2;
    }
}

// the time of a way from height a to b, at most at 3 m/s
static inline double mixed_way(uint64_t *state, double a, double b)
{
    return fmax(mixed_uniform(state, 0.15, 0.45), 0.5 * fabs(b - a));
}

// a fall to `low`, a contact or a kink, a rise; *t and *rest are time and height before, and after
static inline void mixed_blow(mixed_pen *pen, uint64_t *state, mixed_event *e, double low,
                              double *t, double *rest)
{
    double v = e->speed, u = v * mixed_uniform(state, 0.15, 0.9);
    double fall = mixed_uniform(state, 0.1, 0.2), rise = mixed_uniform(state, 0.08, 0.2);
    double contact = mixed_uniform(state, 0.003, 0.008);
    double top = low + 0.5 * v * fall, way = mixed_way(state, *rest, top);
    mixed_cubic(pen, *t, *t + way, (double[2]){*rest, 0}, (double[2]){top, 0});
    *t += way;
    mixed_cubic(pen, *t, *t + fall, (double[2]){top, 0}, (double[2]){low, -v});
    *t += fall;
    e->time = *t;
    mixed_cubic(pen, *t, *t + contact, (double[2]){low, -v}, (double[2]){low, u});
    *t += contact;
    *rest = low + 0.5 * u * rise;
    mixed_cubic(pen, *t, *t + rise, (double[2]){low, u}, (double[2]){*rest, 0});
    *t += rise;
}

static inline void mixed_turn(mixed_pen *pen, uint64_t *state, mixed_event *e, double low,
                              double *t, double *rest)
{
    double fall = mixed_uniform(state, 0.08, 0.2), top = low + e->speed * fall * 2 / HIMC_PI;
    double way = mixed_way(state, *rest, top);
    mixed_cubic(pen, *t, *t + way, (double[2]){*rest, 0}, (double[2]){top, 0});
    *t += way;
    mixed_cosine(pen, *t, *t + fall, top, low);
    e->time = *t += fall;
    mixed_cosine(pen, *t, *t + fall, low, top);
    *t += fall;
    *rest = top;
}

// the heights above the head of a hand, and its events
static inline void mixed_heights(const mixed_config *c, uint64_t *state, mixed_pen *pen,
                                 mixed_hand *hand)
{
    double t = 0, rest = 0.2;
    for (hand->count = 0; t < c->seconds - 1.5 && hand->count < MIXED_MOST; hand->count++) {
        mixed_event *e = &hand->event[hand->count];
        double kind = mixed_uniform(state, 0, 1), share = mixed_uniform(state, 0, 1);
        *e = (mixed_event){.blow = kind >= c->air};
        e->speed = e->blow ? c->slowest * pow(c->fastest / c->slowest, share)
                           : c->slow_air + share * (c->fast_air - c->slow_air);
        double low = e->blow ? 0 : mixed_uniform(state, c->low_air, c->high_air);
        if (e->blow || c->abrupt)
            mixed_blow(pen, state, e, low, &t, &rest);
        else
            mixed_turn(pen, state, e, low, &t, &rest);
    }
    for (; pen->at < pen->frames; pen->at++)
        pen->to[pen->at] = rest;
}

// places on the head near `middle`, another for each event
static inline void mixed_places(uint64_t *state, mixed_pen *pen, const mixed_hand *hand,
                                double middle)
{
    double from = 0, a = middle;
    for (int i = 0; i < hand->count; i++) {
        double b = middle + fmin(fmax(mixed_normal(state) * 0.025, -0.08), 0.08);
        mixed_cubic(pen, from, hand->event[i].time, (double[2]){a, 0}, (double[2]){b, 0});
        from = hand->event[i].time, a = b;
    }
    for (; pen->at < pen->frames; pen->at++)
        pen->to[pen->at] = a;
}

// a Butterworth filter of second order, one way
static inline void mixed_filter(double *x, int from, int to, double cutoff)
{
    double k = tan(HIMC_PI * cutoff), n = 1 / (1 + sqrt(2) * k + k * k), step = from < to ? 1 : -1;
    double b = k * k * n, a1 = 2 * (k * k - 1) * n, a2 = (1 - sqrt(2) * k + k * k) * n;
    double x1 = x[from], x2 = x1, y1 = x1, y2 = x1;
    for (int i = from; i != to; i += (int)step) {
        double y = b * (x[i] + 2 * x1 + x2) - a1 * y1 - a2 * y2;
        x2 = x1, x1 = x[i], y2 = y1, y1 = y;
        x[i] = y;
    }
}

static inline void mixed_smooth(const mixed_config *c, double *x, int frames, double rate)
{
    if (c->rate > MIXED_SHARPEST)
        return;
    mixed_filter(x, 0, frames, MIXED_CUTOFF * c->rate / rate);
    mixed_filter(x, frames - 1, -1, MIXED_CUTOFF * c->rate / rate);
}

// what a hand's tip does, on the fine clock
static inline void mixed_motion(const mixed_config *c, uint64_t *state, int hand, double fine,
                                int frames, double *x[3], mixed_truth *truth)
{
    mixed_hand *to = &truth->hand[hand];
    bool left = hand == HIMC_LEFT;
    mixed_heights(c, state, &(mixed_pen){x[2], frames, 0, fine}, to);
    mixed_places(state, &(mixed_pen){x[0], frames, 0, fine}, to, 0.5);
    mixed_places(state, &(mixed_pen){x[1], frames, 0, fine}, to, left ? 0.1 : -0.1);
    for (int i = 0; i < frames; i++)
        x[2][i] += himc_strike_head_at(&truth->head, x[0][i], x[1][i]) - (left ? c->lower : 0);
    for (int k = 0; k < 3; k++)
        mixed_smooth(c, x[k], frames, fine);
}

/// The take, to be freed, and what its hands did.
static inline himc_take *mixed_take(const mixed_config *c, mixed_truth *truth)
{
    uint64_t state = c->seed;
    int finer = (int)ceil(MIXED_FINE / c->rate), frames = (int)(c->seconds * c->rate);
    int phase = (int)mixed_uniform(&state, 0, finer);
    himc_take *take = calloc(1, sizeof *take);
    himc_error error;
    double fine = c->rate * finer, slope = mixed_uniform(&state, 0, c->tilt),
           way = mixed_uniform(&state, 0, 2 * HIMC_PI);
    truth->head = (himc_strike_head){.x0 = 0.5,
                                     .height = mixed_uniform(&state, 0.5, 1.2),
                                     .slope_x = slope * cos(way),
                                     .slope_y = slope * sin(way)};
    double *x[3], *all = calloc(3 * (size_t)(frames * finer), sizeof *all);
    TEST_ASSERT_TRUE(all && take && himc_take_allocate(take, c->rate, frames, 2, false, &error));
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        for (int k = 0; k < 3; k++)
            x[k] = all + (size_t)k * (size_t)(frames * finer);
        mixed_motion(c, &state, hand, fine, frames * finer, x, truth);
        himc_take_set_name(take, hand, hand == HIMC_LEFT ? "LTIP" : "RTIP", 4);
        for (int f = 0; f < frames; f++)
            for (int k = 0; k < 3; k++)
                (&himc_take_at(take, f, hand)->x)[k] =
                    x[k][f * finer + phase] + c->noise * mixed_normal(&state);
        for (int i = 0; i < truth->hand[hand].count; i++)
            truth->hand[hand].event[i].time -= phase / fine;
    }
    free(all);
    return take;
}

/// Hits and misses of a finder.
typedef struct mixed_score {
    int found, invented, missed;
    int soft, soft_found; // blows slower than a tenth of the fastest, and those found
    double square;        // sum over the found of squared relative errors of speed
} mixed_score;

// the strike not used yet that is nearest to a time, -1 if none is within `within`
static inline int mixed_nearest(const himc_strike_survey *s, const bool *used, int hand,
                                double time, double within)
{
    int best = -1;
    for (int i = 0; i < s->count; i++) {
        double away = fabs(s->strikes[i].time - time);
        if ((int)s->strikes[i].hand == hand && !used[i] && away <= within) {
            best = i;
            within = away;
        }
    }
    return best;
}

/// Adds the strikes found in a take to the score: one to one within 20 ms and a frame.
static inline void mixed_compare(const mixed_config *c, const mixed_truth *truth,
                                 const himc_strike_survey *s, mixed_score *score)
{
    bool *used = calloc((size_t)s->count + 1, sizeof *used);
    int found = 0;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        for (int i = 0; i < truth->hand[hand].count; i++) {
            const mixed_event *e = &truth->hand[hand].event[i];
            int k = mixed_nearest(s, used, hand, e->time, 0.02 + 1 / c->rate);
            if (!e->blow)
                continue;
            bool soft = e->speed < 0.1 * c->fastest;
            score->missed += k < 0;
            found += k >= 0;
            score->soft += soft;
            score->soft_found += soft && k >= 0;
            used[k < 0 ? s->count : k] = true;
            double off = k < 0 ? 0 : s->strikes[k].velocity / e->speed - 1;
            score->square += off * off;
        }
    score->found += found;
    score->invented += s->count - found;
    free(used);
}

static inline double mixed_precision(const mixed_score *s)
{
    return s->found / fmax(s->found + s->invented, 1);
}

static inline double mixed_speed_error(const mixed_score *s)
{
    return sqrt(s->square / fmax(s->found, 1));
}

static inline double mixed_recall(const mixed_score *s)
{
    return s->found / fmax(s->found + s->missed, 1);
}

#endif
