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

#include "base/noise.h"
#include "capture/take.h"

#include <stdlib.h>

#define REFRACTORY 0.045     // chosen: strikes of one hand are further apart (s)
#define APART 0.025          // chosen: peaks are further apart (s)
#define STRIKE_WINDOW 0.03   // chosen: D is taken within this time, longer than any contact (s) ...
#define SPEED_TIME 0.02      // ... of speeds over this time, to average noise (s)
#define NOISE_DEVIATIONS 3.0 // chosen: standard deviations of noise that count as noise
#define SHARP 0.8            // chosen: share of D that a sharp track has in two frames

typedef struct track {
    const himc_take *take;
    int point;
    const himc_vec3 *x;
    int frames;
    double rate;
    double noise; // one standard deviation (m)
} track;

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

static double height(const himc_parabola *p, double frame)
{
    double u = frame - p->origin;
    return p->a.z + u * (p->b.z + u * p->c.z);
}

// where p - q passes zero going down, between frames from and to, by bisection; `to` if it does not
static double crossing(const himc_parabola *p, const himc_parabola *q, double from, double to)
{
    if (height(p, to) > height(q, to))
        return to;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (from + to);
        if (height(p, middle) > height(q, middle))
            from = middle;
        else
            to = middle;
    }
    return 0.5 * (from + to);
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

// true if frames from .. to reach into a gap that may hide a strike; chosen: one longer than 12 ms,
// and any at the take's ends
static bool in_gap(const track *t, int from, int to)
{
    int most = frames_of(t, 0.012, 2);
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

// the frame of the largest bend by differences of h frames, near `frame`; chosen: within 8 ms
static int sharpest(const track *t, int frame, int h)
{
    int w = frames_of(t, 0.008, 2), best = frame;
    for (int i = frame - w; i <= frame + w; i++)
        if (bend_or_zero(t, i, h) > bend_or_zero(t, best, h))
            best = i;
    return best;
}

static himc_take_strike measure(const track *t, const candidate *s, himc_hand hand)
{
    bool quiet = noise_bend(t, 1) < (1 - SHARP) * (s->down + s->up) * t->rate;
    int peak = quiet ? sharpest(t, s->frame, 1) : s->frame;
    double earlier = bend_or_zero(t, peak - 1, 1), later = bend_or_zero(t, peak + 1, 1);
    bool sharp = quiet && bend_or_zero(t, peak, 1) + fmax(earlier, later) >
                              SHARP * (s->down + s->up) * t->rate;
    int w = frames_of(t, APART, 2), low = peak < w ? 0 : peak - w;
    for (int i = low; i <= peak + w && i < t->frames; i++)
        if (t->x[i].z < t->x[low].z)
            low = i;
    // a kink between two frames bends the track in both: the fall ends with the earlier one
    int end = peak - (earlier > later);
    if (!sharp) {
        // the last frame before a blunt peak in which the fall is still undisturbed: its bends, of
        // 4 ms (chosen), are less than a tenth of the largest
        int h = frames_of(t, 0.004, 1), i = peak - h, least = peak - frames_of(t, STRIKE_WINDOW, 3);
        double largest = bend_or_zero(t, sharpest(t, peak, h), h);
        least = least < h - 1 ? h - 1 : least;
        while (i > least && !(bend(t, i, h) < 0.1 * largest && t->x[i + h].z < t->x[i].z))
            i--;
        end = i > least ? i + h : peak > 0 ? peak - 1 : 0;
    }
    int n = frames_of(t, 0.024, 4); // chosen: short beside a fall of 0.2 s
    int left = t->frames - end - 1;
    himc_parabola before = himc_take_parabola(t->x, end, -1, n < end + 1 ? n : end + 1),
                  after = himc_take_parabola(t->x, sharp ? end + 1 : low, 1,
                                             !sharp     ? 1
                                             : n < left ? n
                                                        : left);
    double touch = crossing(&before, &after, end, sharp ? end + 1 : low + 1);
    double u = sharp ? touch - end : 0;
    double up = sharp ? (after.b.z + 2 * after.c.z * (touch - end - 1)) * t->rate : 0;
    double down = -(before.b.z + 2 * before.c.z * u) * t->rate;
    int i = (int)touch < t->frames - 1 ? (int)touch : t->frames - 2;
    himc_vec3 x = himc_vec3_madd(t->x[i], touch - i, himc_vec3_sub(t->x[i + 1], t->x[i]));
    x.z = sharp ? height(&before, touch) : t->x[low].z;
    // chosen bounds: noise changes the fall's speed over SPEED_TIME less than the parabola's slope
    return (himc_take_strike){.hand = hand,
                              .frame = low,
                              .clear = end,
                              .time = touch / t->rate,
                              .x = x,
                              .velocity = fmin(fmax(down, 0.8 * s->down), 1.6 * s->down),
                              .rebound = fmax(up, 0)};
}

// a fall, and the strike that it is if it ends on a head
typedef struct found {
    himc_take_strike *strike;
    himc_fall *fall; // beside strike
    int count;
} found;

// height of the head above the point where fall and rebound intersect: v t down and u (T - t) up
// again, with the contact T = 7 ms of a felt mallet with the simulated head
static double above_intersection(const himc_take_strike *s)
{
    double sum = s->velocity + s->rebound;
    return sum > 0 ? 0.007 * s->velocity * s->rebound / sum : 0;
}

// adds the falls of a hand; false without memory
static bool find_falls(const himc_take *take, const himc_take_tip *tip, himc_hand hand, found *f)
{
    track made = {take, tip->point, tip->x, take->frames, take->rate, 0}, *t = &made;
    int near = frames_of(t, APART, 1); // peaks are further apart (frames)
    size_t most = (size_t)(f->count + take->frames / near + 2);
    himc_take_strike *strikes = realloc(f->strike, most * sizeof *strikes);
    f->strike = strikes ? strikes : f->strike;
    himc_fall *falls = realloc(f->fall, most * sizeof *falls);
    f->fall = falls ? falls : f->fall;
    if (!strikes || !falls || !himc_noise(tip->x, take->frames, &t->noise))
        return false;
    // chosen: differences of about a contact in quiet tracks, and of up to 12 ms in noisy ones,
    // until noise bends them by less than 100 m/s^2
    int h = frames_of(t, 0.006, 1);
    while (h < frames_of(t, 0.012, 1) && noise_bend(t, h) > 100)
        h++;
    int n = frames_of(t, SPEED_TIME, 1), window = frames_of(t, STRIKE_WINDOW, 3) + h;
    // chosen: slower touches are not strokes, nor those that a noisy track's speeds hide
    double least = fmax(0.25, NOISE_DEVIATIONS * sqrt(2) * t->noise / SPEED_TIME);
    // chosen: most of D / A, between a head's 18 ms and the air's 55; and in frames
    double widest = fmax(0.026, 3.2 / t->rate);
    for (int i = h; i + h < t->frames; i++) {
        // a peak: the track bends upwards, and by no less than nearby
        candidate s = {i, bend(t, i, h), -INFINITY, -INFINITY};
        bool peak = s.bend > 0;
        for (int k = 1; peak && k <= near; k++)
            peak = bend_or_zero(t, i - k, h) < s.bend && bend_or_zero(t, i + k, h) <= s.bend;
        if (!peak)
            continue;
        for (int k = i < window ? 0 : i - window; k + n <= i; k++)
            s.down = fmax(s.down, -speed(t, k, k + n));
        for (int k = i; k + n < t->frames && k + n <= i + window; k++)
            s.up = fmax(s.up, speed(t, k, k + n));
        double width = (s.down + s.up) / s.bend;
        // chosen: a fall may go on at 0.3 of its speed, and be 1.6 times less sharp than a blow
        bool ends = s.down > least && s.up > -0.3 * s.down && width < 1.6 * widest;
        if (!ends || in_gap(t, i - h, i + h))
            continue;
        himc_take_strike strike = measure(t, &s, hand);
        // a fall's end may lie off the head by the play of felt and marker (m), noise, blunting by
        // frames, and a dent of 12 mm at 8 m/s; chosen by synthetic takes
        // (tests/capture/test_take_mixed.c)
        double within = 0.008 + NOISE_DEVIATIONS * t->noise + 0.35 * fmin(s.down / t->rate, 0.02) +
                        0.0015 * s.down;
        f->strike[f->count] = strike;
        f->fall[f->count++] = (himc_fall){.x = strike.x,
                                          .depth = above_intersection(&strike),
                                          .speed = s.down,
                                          .within = within,
                                          .hand = hand,
                                          .sharp = width < widest && s.bend > noise_bend(t, h)};
    }
    return true;
}

// true if fall k is a strike of the same hand as fall i, and too close in time to be another
static bool is_same(const found *f, int i, int k)
{
    return k >= 0 && k < f->count && f->fall[k].head >= 0 &&
           f->strike[k].hand == f->strike[i].hand &&
           fabs(f->strike[k].time - f->strike[i].time) < REFRACTORY;
}

static int by_time(const void *a, const void *b)
{
    double s = ((const himc_take_strike *)a)->time, t = ((const himc_take_strike *)b)->time;
    return (s > t) - (s < t);
}

// the middle of the strikes on a head, on its plane: the mean over the hands of the median of each,
// also of the height above their intersection
static himc_vec3 place_on(const himc_strike_survey *s, int head, const himc_strike_head *plane,
                          double *scratch)
{
    double middle[3];
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        int hands = 0;
        for (int hand = 0; hand < HIMC_HANDS; hand++) {
            int n = 0;
            for (const himc_take_strike *k = s->strikes; k < s->strikes + s->count; k++)
                if ((int)k->hand == hand && k->head == head)
                    scratch[n++] = axis == 0 ? k->x.x : axis == 1 ? k->x.y : above_intersection(k);
            sum += n > 0 ? himc_median(scratch, n) : 0;
            hands += n > 0;
        }
        middle[axis] = hands > 1 ? sum / hands : sum;
    }
    double z = himc_strike_head_at(plane, middle[0], middle[1]);
    return himc_vec3_make(middle[0], middle[1], z + (plane->at_rest ? 0 : middle[2]));
}

bool himc_take_strikes(const himc_take *take, const himc_take_tip tips[HIMC_HANDS],
                       himc_strike_survey *survey)
{
    found f = {malloc(sizeof *f.strike), NULL, 0}; // not NULL without falls
    himc_strike_head heads[HIMC_STRIKE_HEADS];
    *survey = (himc_strike_survey){.heads = -1};
    bool all = f.strike != NULL;
    for (int hand = 0; hand < HIMC_HANDS; hand++)
        if (all && tips[hand].present)
            all = find_falls(take, &tips[hand], (himc_hand)hand, &f);
    double *scratch = all ? malloc(((size_t)f.count + 1) * sizeof *scratch) : NULL;
    survey->strikes = f.strike;
    if (scratch)
        survey->heads = himc_strike_heads(f.fall, f.count, heads);
    for (int i = 0; i < f.count && survey->heads > 0; i++) {
        const himc_fall *fall = &f.fall[i];
        if (fall->head >= 0 || !fall->sharp || is_same(&f, i, i - 1) || is_same(&f, i, i + 1))
            continue;
        double over = fall->x.z - himc_strike_head_at(&heads[0], fall->x.x, fall->x.y);
        survey->lowest = survey->left_out ? fmin(survey->lowest, over) : over;
        survey->highest = survey->left_out ? fmax(survey->highest, over) : over;
        survey->fastest = fmax(survey->fastest, fall->speed);
        survey->left_out++;
    }
    // moves the strikes to the front of the list, without those that follow a faster one closely
    for (int i = 0; i < f.count && survey->heads > 0; i++) {
        himc_take_strike *last = survey->count ? &f.strike[survey->count - 1] : NULL;
        himc_take_strike s = f.strike[i];
        s.head = f.fall[i].head;
        if (s.head < 0)
            continue;
        if (!last || last->hand != s.hand || s.time - last->time >= REFRACTORY)
            f.strike[survey->count++] = s;
        else if (s.velocity > last->velocity)
            *last = s;
    }
    if (survey->count > 0)
        qsort(f.strike, (size_t)survey->count, sizeof *f.strike, by_time);
    for (int i = 0; i < survey->heads; i++)
        survey->head[i] = place_on(survey, i, &heads[i], scratch);
    free(scratch);
    free(f.fall);
    if (survey->heads >= 0)
        return true;
    free(f.strike);
    *survey = (himc_strike_survey){.strikes = NULL};
    return false;
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
