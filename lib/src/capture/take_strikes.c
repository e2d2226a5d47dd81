/// take_strikes.c: strikes of a stick, found in the trajectory of its tip alone.
///
/// A strike is a peak of upward acceleration that ends a fall. Within 30 ms to either side of the
/// peak the vertical speed rises by D. A hand that reverses a stick in the air spreads D over that
/// whole time; a drumhead does it within a few milliseconds. So with the largest second difference
/// A (m/s^2) the width D / A is compared: 4 Hz strokes in the air have 55 ms, a blow on a head 8 to
/// 18 ms even in a track that was low-pass filtered (26 ms allowed, and 3.2 frames where frames are
/// longer than 8 ms). A must be larger than noise alone makes it (noise.c); a noisy track is judged
/// by longer differences. Hands also turn sticks in the air as sharply as a head does: which of
/// these falls are strikes is decided by where they end (strike_heads.c). Of two within 45 ms the
/// faster is the strike.
///
/// The capture's filter blunts the track near the touch, so time and speed come from before it: a
/// parabola by least squares over the last 24 ms (or 4 samples) of undisturbed fall, before the
/// deceleration reaches a tenth of A. In a sharp track (nearly all of D in two frames) the touch is
/// where the parabolas before and after intersect, and the speed is the slope there. In a blunted
/// or noisy track the touch is where the parabola before passes the height of the lowest position,
/// and the speed is its slope at the last undisturbed sample.
///
/// In a gap longer than a contact no strike is reported, because the curve that bridges a gap bends
/// arbitrarily.
#include "himc/mocap.h"

#include "base/noise.h"
#include "capture/order.h"
#include "capture/strike_heads.h"
#include "capture/take.h"

#include <stdlib.h>

#define LEAST_SPEED 0.25   // chosen: slower touches are not strokes (m/s) ...
#define NOISE_SPEEDS 3.0   // ... nor those within so many deviations of a noisy track's speeds
#define MOST_SINKING 0.3   // chosen: speed of a fall that goes on after it, as a share of its speed
#define REFRACTORY 0.045   // chosen: strikes of one hand are further apart (s)
#define APART 0.025        // chosen: peaks are further apart (s)
#define STRIKE_WINDOW 0.03 // chosen: D is taken within this time, longer than any contact (s) ...
#define SPEED_TIME 0.02    // ... of speeds over this time, to average noise (s)
#define STRIKE_WIDTH 0.026 // chosen: most of D / A, between a head's 18 ms and the air's 55 (s)
#define STRIKE_FRAMES 3.2  // chosen: the same in frames, if these are long
#define BLUNT 1.6          // chosen: a fall on a head may be this much less sharp
#define FALL_TIME 0.024    // chosen: length of the parabolas, short beside a fall of 0.2 s (s)
#define CONTACT 0.007      // of a felt mallet with the simulated head (s)
#define LONGEST_UNSEEN 0.012   // chosen: longer gaps may hide a strike (s)
#define NOISE_DEVIATIONS 3.0   // chosen: standard deviations of noise that a bend must exceed
#define SHORT_DIFFERENCE 0.006 // chosen: of quiet tracks, about a contact (s) ...
#define LONG_DIFFERENCE 0.012  // ... and at most, of noisy ones (s)
#define QUIET_BEND 100.0       // chosen: noise up to which differences stay short (m/s^2)
#define SHARPEST_WITHIN 0.008  // chosen: time around a candidate for its largest bend (s)
#define LOWEST_WITHIN 0.025    // chosen: time around it for the lowest position (s)
#define FALL_DIFFERENCE 0.004  // chosen: of the bends that end the undisturbed fall (s)
#define SLOWER 0.8 // chosen: bounds of the touch's speed, as shares of the fall's over SPEED_TIME,
#define FASTER 1.6 // which noise changes less than the parabola's slope
#define DISTURBED 0.1 // chosen: share of the largest bend that ends the undisturbed fall
#define SHARP 0.8     // chosen: share of D that a sharp track has in two frames
// by which a fall's end may lie off the head: play of felt and marker, noise, blunting by frames,
// and a dent of 12 mm at 8 m/s; chosen by synthetic takes (tests/capture/test_take_mixed.c)
#define PLAY 0.008          // (m)
#define PLAY_DEVIATIONS 3.0 // of noise
#define PLAY_FRAMES 0.35    // of the fall in a frame ...
#define FALL_OF_FRAME 0.02  // ... up to this (m)
#define DENT 0.0015         // for each m/s (m)

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

// the end of a fall: a peak of upward acceleration
typedef struct candidate {
    int frame;
    double bend, down, up; // A, fastest fall before and rise after (m/s)
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

static double bend_or_zero(const track *t, int i, int h)
{
    return i >= h && i + h < t->frames ? fmax(0, bend(t, i, h)) : 0;
}

static double width(const candidate *s)
{
    return (s->down + s->up) / s->bend;
}

static double widest(const track *t)
{
    return fmax(STRIKE_WIDTH, STRIKE_FRAMES / t->rate);
}

// true if no bend by h frames nearby is larger
static bool is_peak(const track *t, int i, int h)
{
    int w = frames_of(t, APART, 1);
    double here = bend(t, i, h);
    for (int k = 1; k <= w; k++)
        if (bend_or_zero(t, i - k, h) >= here || bend_or_zero(t, i + k, h) > here)
            return false;
    return true;
}

// the fastest fall before frame i and the fastest rise after it
static candidate candidate_at(const track *t, int i, int h)
{
    int w = frames_of(t, STRIKE_WINDOW, 3) + h, n = frames_of(t, SPEED_TIME, 1);
    int before = i < w ? 0 : i - w, after = i + w < t->frames ? i + w : t->frames - 1;
    candidate s = {i, bend(t, i, h), -INFINITY, -INFINITY};
    for (int k = before; k + n <= i; k++)
        s.down = fmax(s.down, -speed(t, k, k + n));
    for (int k = i; k + n <= after; k++)
        s.up = fmax(s.up, speed(t, k, k + n));
    return s;
}

static double least_speed(const track *t)
{
    return fmax(LEAST_SPEED, NOISE_SPEEDS * sqrt(2) * t->noise / SPEED_TIME);
}

static bool is_fall(const track *t, const candidate *s, int h)
{
    return s->down > least_speed(t) && s->up > -MOST_SINKING * s->down &&
           width(s) < BLUNT * widest(t) && !in_gap(t, s->frame - h, s->frame + h);
}

// the next end of a fall from frame *from on; false when there are no more
static bool next_fall(const track *t, int *from, candidate *s)
{
    int h = difference(t);
    for (int i = *from < h ? h : *from; i + h < t->frames; i++)
        if (bend(t, i, h) > 0 && is_peak(t, i, h)) {
            *s = candidate_at(t, i, h);
            *from = i + 1;
            if (is_fall(t, s, h))
                return true;
        }
    *from = t->frames;
    return false;
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
    bool quiet = noise_bend(t, 1) < (1 - SHARP) * (s->down + s->up) * t->rate;
    int peak = quiet ? sharpest(t, s->frame, 1) : s->frame, w = frames_of(t, LOWEST_WITHIN, 2),
        n = frames_of(t, FALL_TIME, 4);
    double earlier = bend_or_zero(t, peak - 1, 1), later = bend_or_zero(t, peak + 1, 1);
    bool sharp = quiet && bend_or_zero(t, peak, 1) + fmax(earlier, later) >
                              SHARP * (s->down + s->up) * t->rate;
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
    double down = -(before.b + 2 * before.c * u) * t->rate;
    return (himc_take_strike){.hand = hand,
                              .frame = low,
                              .clear = end,
                              .time = touch / t->rate,
                              .x = place_between(t, touch, height),
                              .velocity = fmin(fmax(down, SLOWER * s->down), FASTER * s->down),
                              .rebound = fmax(up, 0)};
}

// a fall, and the strike that it is if it ends on a head
typedef struct found {
    himc_take_strike *strike;
    himc_fall *fall; // beside strike
    int count;
} found;

// height of the head above the point where fall and rebound intersect: v t down and u (CONTACT - t)
// up again
static double above_intersection(const himc_take_strike *s)
{
    double sum = s->velocity + s->rebound;
    return sum > 0 ? CONTACT * s->velocity * s->rebound / sum : 0;
}

static himc_fall fall_of(const track *t, const candidate *s, const himc_take_strike *end)
{
    double frame = fmin(s->down / t->rate, FALL_OF_FRAME);
    return (himc_fall){.x = end->x,
                       .depth = above_intersection(end),
                       .speed = s->down,
                       .within =
                           PLAY + PLAY_DEVIATIONS * t->noise + PLAY_FRAMES * frame + DENT * s->down,
                       .sharp = width(s) < widest(t) && s->bend > noise_bend(t, difference(t))};
}

static void find_falls(const track *t, himc_hand hand, found *f)
{
    candidate s;
    for (int from = 0; next_fall(t, &from, &s); f->count++) {
        f->strike[f->count] = measure(t, &s, hand);
        f->fall[f->count] = fall_of(t, &s, &f->strike[f->count]);
    }
}

static int most_falls(const track *t)
{
    return t->frames / frames_of(t, APART, 1) + 1;
}

// the falls of both hands, one hand after the other; false without memory
static bool find(const himc_take *take, const himc_take_tip tips[HIMC_HANDS], found *f)
{
    int most = 0;
    track t[HIMC_HANDS];
    for (int hand = 0; hand < HIMC_HANDS; hand++) {
        t[hand] = (track){take, tips[hand].point, tips[hand].x, take->frames, take->rate, 0};
        if (tips[hand].present && !himc_noise(tips[hand].x, take->frames, &t[hand].noise))
            return false;
        most += tips[hand].present ? most_falls(&t[hand]) : 0;
    }
    f->strike = calloc((size_t)most + 1, sizeof *f->strike);
    f->fall = calloc((size_t)most + 1, sizeof *f->fall);
    for (int hand = 0; f->strike && f->fall && hand < HIMC_HANDS; hand++)
        if (tips[hand].present)
            find_falls(&t[hand], (himc_hand)hand, f);
    return f->strike && f->fall;
}

static void leave_out(const himc_fall *f, const himc_strike_head *head, himc_strike_survey *to)
{
    double over = f->x.z - himc_strike_head_at(head, f->x.x, f->x.y);
    to->lowest = to->left_out ? fmin(to->lowest, over) : over;
    to->highest = to->left_out ? fmax(to->highest, over) : over;
    to->fastest = fmax(to->fastest, f->speed);
    to->left_out++;
}

// true if fall k is a strike of the same hand as fall i, and too close in time to be another
static bool is_same(const found *f, int i, int k)
{
    return k >= 0 && k < f->count && f->fall[k].head >= 0 &&
           f->strike[k].hand == f->strike[i].hand &&
           fabs(f->strike[k].time - f->strike[i].time) < REFRACTORY;
}

static void list_left_out(const found *f, const himc_strike_head *heads, himc_strike_survey *to)
{
    for (int i = 0; i < f->count; i++)
        if (f->fall[i].head < 0 && f->fall[i].sharp && !is_same(f, i, i - 1) &&
            !is_same(f, i, i + 1))
            leave_out(&f->fall[i], &heads[0], to);
}

// moves the strikes to the front of the list, without those that follow a faster one closely
static void keep_strikes(found *f, himc_strike_survey *to)
{
    for (int i = 0; i < f->count; i++) {
        himc_take_strike *last = to->count ? &to->strikes[to->count - 1] : NULL, s = f->strike[i];
        s.head = f->fall[i].head;
        if (s.head < 0)
            continue;
        if (!last || last->hand != s.hand || s.time - last->time >= REFRACTORY)
            to->strikes[to->count++] = s;
        else if (s.velocity > last->velocity)
            *last = s;
    }
}

static int by_time(const void *a, const void *b)
{
    double s = ((const himc_take_strike *)a)->time, t = ((const himc_take_strike *)b)->time;
    return (s > t) - (s < t);
}

static double median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, himc_order_doubles);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

// the median position of one hand's strikes on a head along one axis, for z above their
// intersection; false if it has none
static bool hand_median(const himc_strike_survey *s, int head, int hand, int axis, double *scratch,
                        double *middle)
{
    int n = 0;
    for (int i = 0; i < s->count; i++) {
        const himc_take_strike *strike = &s->strikes[i];
        if ((int)strike->hand == hand && strike->head == head)
            scratch[n++] = axis == 0   ? strike->x.x
                           : axis == 1 ? strike->x.y
                                       : above_intersection(strike);
    }
    if (n > 0)
        *middle = median(scratch, n);
    return n > 0;
}

// the middle of the strikes on a head, on its plane
static himc_vec3 place_on(const himc_strike_survey *s, int head, const himc_strike_head *plane,
                          double *scratch)
{
    double middle[3];
    for (int axis = 0; axis < 3; axis++) {
        double l = 0, r = 0;
        bool left = hand_median(s, head, HIMC_LEFT, axis, scratch, &l);
        bool right = hand_median(s, head, HIMC_RIGHT, axis, scratch, &r);
        middle[axis] = left && right ? 0.5 * (l + r) : l + r;
    }
    double z = himc_strike_head_at(plane, middle[0], middle[1]);
    return himc_vec3_make(middle[0], middle[1], z + (plane->at_rest ? 0 : middle[2]));
}

// strikes, heads and the place of the drum from the falls; false without memory
static bool judge(found *f, himc_strike_survey *to)
{
    himc_strike_head heads[HIMC_STRIKE_HEADS];
    double *scratch = malloc(((size_t)f->count + 1) * sizeof *scratch);
    to->heads = scratch ? himc_strike_heads(f->fall, f->count, heads) : -1;
    if (to->heads > 0) {
        list_left_out(f, heads, to);
        keep_strikes(f, to);
    }
    qsort(to->strikes, (size_t)to->count, sizeof *to->strikes, by_time);
    for (int i = 0; i < to->heads; i++)
        to->head[i] = place_on(to, i, &heads[i], scratch);
    free(scratch);
    return to->heads >= 0;
}

bool himc_take_strikes(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                       himc_strike_survey *survey)
{
    found f = {NULL, NULL, 0};
    *survey = (himc_strike_survey){.strikes = NULL};
    bool found_all = find(take, tips, &f);
    survey->strikes = f.strike;
    found_all = found_all && judge(&f, survey);
    free(f.fall);
    if (!found_all) {
        free(f.strike);
        *survey = (himc_strike_survey){.strikes = NULL};
    }
    return found_all;
}

double himc_take_fastest_fall(const himc_take *take, const himc_take_tip *tip,
                              const himc_take_strike *strike)
{
    double fastest = 0;
    int from = strike->frame - (int)(STRIKE_WINDOW * take->rate);
    for (int i = from < 1 ? 1 : from; i <= strike->frame; i++)
        fastest = fmax(fastest, (tip->x[i - 1].z - tip->x[i].z) * take->rate);
    return fastest;
}

himc_take_strike *himc_take_find_strikes(const himc_take *take,
                                         const himc_take_tip tips[HIMC_HANDS], int *count)
{
    himc_strike_survey survey;
    himc_take_strikes(take, tips, &survey);
    *count = survey.count;
    return survey.strikes;
}
