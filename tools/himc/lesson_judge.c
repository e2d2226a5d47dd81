/// lesson_judge.c: what the matched strokes show, and which of it is worth practising.
///
/// The beat of the player's own tempo is a robust local line through the strokes' times (LOWESS,
/// Cleveland 1979), begun again after each wait. For each of time, level and place the strokes of
/// a hand, of a place in the beat, of a nuance and of a spot are compared with the others (Welch);
/// the largest difference is named and taken away, then the next, so one fault is named once. Then
/// single strokes are compared with the player's own spread.
///
/// A difference is a fault if it is beyond the threshold with its 99 % bound (single strokes: with
/// 4 standard deviations); `excess` is the difference less that bound, over the threshold.
#include "lesson.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SURE 2.6   // standard uncertainties of a 99 % bound
#define SINGLE 4.0 // standard deviations of a single stroke; chosen: 1 of 16000 is further off
#define WINDOW 16  // chosen: strokes of the local line
#define FEWEST 4   // chosen: strokes of a group
#define PHRASE 3   // chosen: so many missing strokes in a row are a phrase left out

// Thresholds of listeners, and where no one has published any, what himc itself counts as right.
#define JND_TIME 0.006  // (s), and
#define JND_SHARE 0.025 // of the interval
static const char time_source[] =
    "listeners notice 6 ms, or 2.5 % of intervals above 240 ms: Friberg and Sundberg 1995";
#define JND_LEVEL 1.0 // (dB)
static const char level_source[] = "chosen: 1 dB; listeners notice 0.4 dB between noises in the "
                                   "laboratory: Miller 1947";
#define PLACE 0.02 // (m)
static const char place_source[] =
    "chosen: 20 mm, within which himc counts a stroke as on its spot; no listeners' threshold is "
    "published";
#define JND_TEMPO 2.0 // (%)
static const char tempo_source[] =
    "listeners notice a drift of about 2 %, several studies cited by Dahl and Madison 2005";
#define UNEVEN 0.02       // (s), and
#define UNEVEN_SHARE 0.04 // of the interval
static const char even_source[] =
    "chosen: 4 % of the interval, 20 ms or more; trained tappers vary by about 2 %: Repp 2005";
#define UNEVEN_LEVEL 2.0 // (dB)
static const char even_level_source[] =
    "chosen: 2 dB, five times what listeners notice in the laboratory: Miller 1947";
static const char none_source[] =
    "a stroke too few or too many is always heard; no threshold is published";

static double jnd(double interval)
{
    return fmax(JND_TIME, JND_SHARE * interval);
}

/// The matched strokes by asked time.
typedef struct course {
    int n;
    int *stroke, *segment; // of played strokes; waits divide segments
    double *asked, *played, *weight, *value[3], *scratch;
    double interval;   // median asked (s)
    double bend, half; // of a tempo that changes: bend u^2 (s), u from -1 to 1 within half (s)
} course;

static double median(double *x, int n)
{
    qsort(x, (size_t)n, sizeof *x, himc_order_doubles);
    return n ? 0.5 * (x[n / 2] + x[(n - 1) / 2]) : 0;
}

// standard deviation of the middle: 1.4826 times the median of magnitudes
static double spread(const course *c, const double *x)
{
    for (int k = 0; k < c->n; k++)
        c->scratch[k] = fabs(x[k]);
    return 1.4826 * median(c->scratch, c->n);
}

static double bent(const course *c, double asked)
{
    double u = c->bend != 0 ? (asked - c->asked[0]) / c->half - 1 : 0;
    return c->bend * u * u;
}

/// The player's beat at an asked time, by the line through the nearest strokes of the segment.
static double beat_at(const course *c, double asked, int segment)
{
    int low = 0, high = c->n;
    while (c->segment[low] < segment)
        low++;
    while (c->segment[high - 1] > segment)
        high--;
    int most = high - low < WINDOW ? high - low : WINDOW;
    while (high - low > most)
        if (asked - c->asked[low] > c->asked[high - 1] - asked)
            low++;
        else
            high--;
    double h = 1.1 * fmax(fabs(asked - c->asked[low]), fabs(asked - c->asked[high - 1])) + 1e-3;
    double s = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int k = low; k < high; k++) {
        double d = c->asked[k] - asked, t = fabs(d) / h, w = 1 - t * t * t;
        w = w * w * w * c->weight[k] + 1e-9;
        double straight = c->played[k] - bent(c, c->asked[k]);
        s += w, x += w * d, y += w * straight, xx += w * d * d, xy += w * d * straight;
    }
    double det = s * xx - x * x;
    return bent(c, asked) + (det > 1e-9 * s * s ? (xx * y - x * xy) / det : y / s);
}

static void find_beat(course *c)
{
    for (int round = 0; round < 4; round++) {
        for (int k = 0; k < c->n; k++)
            c->value[0][k] = c->played[k] - beat_at(c, c->asked[k], c->segment[k]);
        double six = 4 * spread(c, c->value[0]) + 1e-4;
        for (int k = 0; k < c->n; k++) {
            double r = fmin(1, fabs(c->value[0][k]) / six);
            c->weight[k] = (1 - r * r) * (1 - r * r);
        }
    }
}

/// y = b + a u + c u^2 by least squares, u from -1 to 1 over x; with standard uncertainties, which
/// grow with the correlation of neighbours.
static void fit(const double *x, const double *y, int n, int terms, double p[3], double u[3])
{
    double m[3][6] = {{0}}, v[3] = {0}, ss = 0, lag = 0, before = 0;
    double low = x[0], half = 0.5 * (x[n - 1] - x[0]) + 1e-9;
    for (int k = 0; k < n; k++) {
        double t = (x[k] - low) / half - 1, f[3] = {1, t, t * t};
        for (int i = 0; i < terms; i++) {
            v[i] += f[i] * y[k];
            for (int j = 0; j < terms; j++)
                m[i][j] += f[i] * f[j];
        }
    }
    for (int i = 0; i < terms; i++)
        m[i][3 + i] = 1;
    for (int i = 0; i < terms; i++) {
        double d = m[i][i];
        for (int j = 0; j < 6; j++)
            m[i][j] /= d;
        for (int k = 0; k < terms; k++)
            for (int j = 5; j >= 0 && k != i; j--)
                m[k][j] -= m[k][i] * m[i][j];
    }
    for (int i = 0; i < terms; i++) {
        p[i] = 0;
        for (int j = 0; j < terms; j++)
            p[i] += m[i][3 + j] * v[j];
    }
    for (int k = 0; k < n; k++) {
        double t = (x[k] - low) / half - 1,
               r = y[k] - p[0] - t * (p[1] + (terms > 2 ? t * p[2] : 0));
        ss += r * r, lag += k ? r * before : 0, before = r;
    }
    double rho = ss > 0 ? fmin(0.9, fmax(0, lag / ss)) : 0;
    for (int i = 0; i < terms; i++)
        u[i] = sqrt(ss / (n > terms ? n - terms : 1) * m[i][3 + i] * (1 + rho) / (1 - rho));
}

// a fault, if it is beyond its threshold by more than `bound` u; its text is empty
static lesson_fault *add_fault(lesson *l, const char *kind, double effect, double u, double bound,
                               double threshold)
{
    double excess = (fabs(effect) - bound * u) / threshold;
    if (!(excess >= 1) || l->faults == LESSON_FAULTS)
        return NULL;
    int k = l->faults++;
    for (; k > 0 && l->fault[k - 1].excess < excess; k--)
        l->fault[k] = l->fault[k - 1];
    l->fault[k] = (lesson_fault){
        .effect = effect, .u = u, .threshold = threshold, .excess = excess, .unit = ""};
    snprintf(l->fault[k].kind, sizeof l->fault[k].kind, "%s", kind);
    return &l->fault[k];
}

static void explain(lesson_fault *f, double spread_, const char *unit, const char *source)
{
    f->spread = spread_, f->unit = unit, f->source = source;
}

// played over asked intervals, the middle one; over some strokes, as hands may differ
static double slope_of(const course *c)
{
    int n = 0, lag = c->n < 48 ? 1 + c->n / 12 : 6; // chosen
    for (int k = lag; k < c->n; k++)
        if (c->asked[k] - c->asked[k - lag] > 0.04)
            c->scratch[n++] =
                (c->played[k] - c->played[k - lag]) / (c->asked[k] - c->asked[k - lag]);
    return median(c->scratch, n);
}

// a phrase left out before matched stroke k is named; true if the beat begins again after it
static bool left_out(lesson *l, const course *c, int k, bool jumps)
{
    int first = -1, last = -1, count = 0;
    for (int i = l->played[c->stroke[k - 1]].of + 1; i < l->played[c->stroke[k]].of; i++)
        if (l->seen[l->asked[i].hand] && l->asked[i].by < 0) {
            first = first < 0 ? i : first;
            last = i;
            count++;
        }
    lesson_fault *f = count < PHRASE ? NULL : add_fault(l, "skip", count, 0, 0, 0.01);
    if (!f)
        return false;
    for (int i = first; i <= last; i++)
        l->asked[i].skipped = l->asked[i].by < 0;
    snprintf(f->what, sizeof f->what, "You leave out beats %g to %g: %d strokes",
             l->asked[first].beat, l->asked[last].beat, count);
    snprintf(f->how, sizeof f->how, "%s", jumps ? "played on without them" : "their time passes");
    explain(f, 0, "strokes", none_source);
    f->threshold = 1;
    return jumps;
}

/// Waits and jumps: an interval that is too long or too short, and all strokes after it with it.
static void find_waits(lesson *l, course *c)
{
    double slope = slope_of(c), *e = c->value[0];
    for (int k = 0; k < c->n; k++)
        e[k] = k ? c->played[k] - c->played[k - 1] - slope * (c->asked[k] - c->asked[k - 1]) : 0;
    double own = fmax(spread(c, e), 0.5 / l->rate);
    int segment = 0;
    for (int k = 0; k < c->n; k++) {
        double before = 0, after = 0;
        c->segment[k] = segment;
        if (k && left_out(l, c, k, fabs(e[k]) > 6 * own + 2 * jnd(c->interval))) {
            c->segment[k] = ++segment;
            continue;
        }
        if (k < 3 || k + 3 > c->n || fabs(e[k]) < 6 * own + 2 * jnd(c->asked[k] - c->asked[k - 1]))
            continue;
        for (int i = 1; i <= 3; i++) {
            before += (c->played[k - i] - c->played[k - 1] -
                       slope * (c->asked[k - i] - c->asked[k - 1])) /
                      3;
            after += (c->played[k + i - 1] - c->played[k - 1] -
                      slope * (c->asked[k + i - 1] - c->asked[k - 1])) /
                     3;
        }
        if (fabs(after - before - e[k]) > 0.35 * fabs(e[k]) || fabs(before) > 0.3 * fabs(e[k]))
            continue;
        c->segment[k] = ++segment;
        const lesson_asked *a = &l->asked[l->played[c->stroke[k]].of];
        lesson_fault *f =
            add_fault(l, "wait", 1e3 * (after - before), 1e3 * own, SURE, 1e3 * jnd(c->interval));
        if (!f)
            continue;
        snprintf(f->what, sizeof f->what,
                 "You %s before beat %g: the stroke and all after it come %.0f ms %s",
                 e[k] > 0 ? "wait" : "hurry", a->beat, fabs(f->effect),
                 e[k] > 0 ? "late" : "early");
        snprintf(f->how, sizeof f->how, "one interval; bound of three spreads");
        explain(f, 1e3 * own, "ms", time_source);
    }
}

/// Mean tempo, the times off a metronome, and rushing or dragging.
static void judge_tempo(lesson *l, course *c)
{
    double p[3], u[3], jump = 0;
    double half = 0.5 * (c->asked[c->n - 1] - c->asked[0]) + 1e-9;
    double *t = c->value[1], slope = slope_of(c);
    for (int k = 0; k < c->n; k++) {
        if (k && c->segment[k] > c->segment[k - 1])
            jump += c->played[k] - c->played[k - 1] - slope * (c->asked[k] - c->asked[k - 1]);
        t[k] = c->played[k] - jump;
    }
    fit(c->asked, t, c->n, 2, p, u);
    l->tempo = (lesson_figure){half / p[1], half / p[1] * u[1] / p[1]};
    for (int k = 0; k < c->n; k++)
        l->played[c->stroke[k]].steady =
            t[k] - p[0] - p[1] * ((c->asked[k] - c->asked[0]) / half - 1);
    if (c->n < 3 * FEWEST)
        return;
    fit(c->asked, t, c->n, 3, p, u);
    double change = 100 * ((p[1] - 2 * p[2]) / (p[1] + 2 * p[2]) - 1), own = 400 * u[2] / p[1];
    if (fabs(p[2]) > SURE * u[2]) { // else the local line follows
        c->bend = p[2];
        c->half = half;
    }
    lesson_fault *f = add_fault(l, "tempo", change, own, SURE, JND_TEMPO);
    if (!f)
        return;
    snprintf(f->what, sizeof f->what,
             "You %s: the tempo %s by %.1f %% from the first stroke to the last",
             change < 0 ? "drag" : "rush", change < 0 ? "falls" : "rises", fabs(change));
    snprintf(f->how, sizeof f->how, "%d strokes, about the score's own tempo", c->n);
    explain(f, own, "%", tempo_source);
}

enum { HAND, IN_BEAT, NUANCE, SPOT, KINDS };

static int group_of(const lesson *l, int stroke, int kind)
{
    const lesson_played *p = &l->played[stroke];
    const lesson_asked *a = &l->asked[p->of];
    double quarters = 4 * (a->beat - floor(a->beat));
    if (kind == HAND)
        return (int)p->strike.hand;
    if (kind == IN_BEAT)
        return fabs(quarters - round(quarters)) < 0.02 ? (int)round(quarters) % 4 : 4;
    for (int k = 0; k < l->asked_count; k++) { // the first stroke that is alike stands for all
        const lesson_asked *b = &l->asked[k];
        bool same = kind == NUANCE ? !strcmp(a->nuance, b->nuance)
                                   : himc_vec3_length(himc_vec3_sub(a->x, b->x)) < 0.04;
        if (same)
            return k;
    }
    return -1;
}

static void name_group(const lesson *l, int kind, int id, char *text, size_t size)
{
    static const char *const places[] = {"on the beat", "a quarter after the beat",
                                         "on the half beat", "three quarters after the beat",
                                         "elsewhere in the beat"};
    if (kind == HAND)
        snprintf(text, size, "the %s hand's strokes", himc_hand_name((himc_hand)id));
    else if (kind == IN_BEAT)
        snprintf(text, size, "the strokes %s", places[id]);
    else if (kind == NUANCE)
        snprintf(text, size, "the strokes marked %s", l->asked[id].nuance);
    else
        snprintf(text, size, "the strokes at the spot of beat %g (%s)", l->asked[id].beat,
                 l->asked[id].drum);
}

typedef struct difference {
    double effect[3], size, u, spread, excess;
    int kind, id, in, out;
} difference;

// of a group from the others in `axes` values
static difference compare(const course *c, const int *group, int kind, int id, int axes,
                          double threshold)
{
    difference d = {.kind = kind, .id = id};
    double variance = 0;
    for (int k = 0; k < c->n; k++)
        group[k] == id ? d.in++ : d.out++;
    for (int axis = 0; axis < axes && d.in >= FEWEST && d.out >= FEWEST; axis++) {
        double sum[2] = {0}, ss[2] = {0};
        int n[2] = {d.out, d.in};
        for (int k = 0; k < c->n; k++)
            sum[group[k] == id] += c->value[axis][k];
        for (int k = 0; k < c->n; k++)
            ss[group[k] == id] +=
                pow(c->value[axis][k] - sum[group[k] == id] / n[group[k] == id], 2);
        d.effect[axis] = sum[1] / n[1] - sum[0] / n[0];
        d.size = hypot(d.size, d.effect[axis]);
        // a few strokes may lie close together by chance
        double pooled = (ss[0] + ss[1]) / (c->n - 2);
        for (int side = 0; side < 2; side++)
            variance += fmax(pooled, ss[side] / (n[side] - 1)) / n[side];
        d.spread = hypot(d.spread, sqrt(pooled));
    }
    d.u = sqrt(variance);
    d.excess = (d.size - SURE * d.u) / threshold;
    return d;
}

/// A quantity of the strokes that is judged.
typedef struct quantity {
    const char *kind, *unit, *more, *less, *source;
    int axes;
    double scale, threshold;
} quantity;

void lesson_scatter(const lesson *l, double *seconds, double *decibels)
{
    double n = 0, time = 0, level = 0;
    for (int i = 0; i < l->count; i++)
        if (isfinite(l->played[i].off)) {
            n++;
            time += l->played[i].off * l->played[i].off;
            level += l->played[i].level * l->played[i].level;
        }
    *seconds = n > 0 ? sqrt(time / n) : NAN;
    *decibels = n > 0 ? sqrt(level / n) : NAN;
}

static void tell_group(lesson *l, const quantity *q, difference d)
{
    char who[80], others[40] = "the others";
    if (d.kind == HAND && d.effect[0] > 0 && q->axes == 1) { // the softer hand, the earlier one
        d.id = !d.id;
        d.effect[0] = -d.effect[0];
    }
    double shown = q->scale * (q->axes > 1 ? d.size : d.effect[0]);
    lesson_fault *f = add_fault(l, q->kind, shown, q->scale * d.u, SURE, q->scale * q->threshold);
    if (!f)
        return;
    name_group(l, d.kind, d.id, who, sizeof who);
    if (d.kind == HAND)
        snprintf(others, sizeof others, "the %s hand's", himc_hand_name((himc_hand)!d.id));
    who[0] = 'T';
    if (q->axes > 1)
        snprintf(
            f->what, sizeof f->what,
            "%s land %.0f mm beside their place (%.0f mm %s, %.0f mm to the %s), measured from %s",
            who, shown, 1e3 * fabs(d.effect[0]), d.effect[0] > 0 ? "too far" : "too near",
            1e3 * fabs(d.effect[1]), d.effect[1] > 0 ? "left" : "right", others);
    else if (d.kind == HAND && strcmp(q->kind, "time") == 0) // who is right is not known
        snprintf(f->what, sizeof f->what, "The hands are %.1f ms apart: the %s behind the %s",
                 fabs(shown), himc_hand_name((himc_hand)!d.id), himc_hand_name((himc_hand)d.id));
    else
        snprintf(f->what, sizeof f->what, "%s are %.1f %s %s than %s", who, fabs(shown), q->unit,
                 shown > 0 ? q->more : q->less, others);
    snprintf(f->how, sizeof f->how, "%d strokes against %d", d.in, d.out);
    explain(f, q->scale * d.spread, q->unit, q->source);
}

/// Names the largest difference and takes it away, again and again.
static bool judge_groups(lesson *l, course *c, const quantity *q)
{
    int *group = malloc((size_t)(KINDS * c->n) * sizeof *group);
    for (int k = 0; group && k < KINDS * c->n; k++)
        group[k] = group_of(l, c->stroke[k % c->n], k / c->n);
    for (int round = 0; group && round < LESSON_NAMED; round++) {
        difference best = {.excess = 1};
        for (int kind = 0; kind < KINDS; kind++)
            for (int k = 0, *g = group + kind * c->n; k < c->n; k++) {
                bool first = true; // of its group
                for (int i = 0; i < k; i++)
                    first = first && g[i] != g[k];
                difference d = {.excess = 0};
                if (first)
                    d = compare(c, g, kind, g[k], q->axes, q->threshold);
                if (d.in > d.out) // of two groups the smaller differs from the larger
                    d.excess *= 0.999;
                if (d.excess > best.excess * 1.0001)
                    best = d;
            }
        if (!best.in)
            break;
        tell_group(l, q, best);
        if (best.kind == HAND && !strcmp(q->kind, "time"))
            l->lead[best.id] = best.effect[0];
        for (int k = 0; k < c->n; k++)
            for (int axis = 0; axis < q->axes; axis++)
                if (group[best.kind * c->n + k] == best.id)
                    c->value[axis][k] -= best.effect[axis];
    }
    free(group);
    return group != NULL;
}

// a standard deviation less its lower 99 % bound, by the chi-square of Wilson and Hilferty (1931)
static double below(double sd, double free)
{
    return sd * (1 - pow(1 - 2 / (9 * free) + 2.33 * sqrt(2 / (9 * free)), -1.5));
}

/// Unevenness of all strokes, once the differences of groups are taken away.
static void judge_even(lesson *l, course *c, const quantity *q)
{
    bool time = q->scale > 1;
    if (c->n < 2 * FEWEST)
        return;
    for (int k = 0; k < c->n; k++)
        c->value[2][k] = c->value[0][k];
    double middle = median(c->value[2], c->n), sum = 0;
    for (int k = 0; k < c->n; k++)
        c->value[2][k] = fabs(c->value[0][k] - middle);
    qsort(c->value[2], (size_t)c->n, sizeof *c->value[2], himc_order_doubles);
    int used = c->n - 1 - c->n / 16; // the furthest are judged alone
    for (int k = 0; k < used; k++)
        sum += pow(c->value[2][k], 2) / used;
    double camera = time ? 0.5 / l->rate : l->played[0].u_level;
    // the local beat follows the strokes a little
    double sd = q->scale * sqrt(fmax(0, sum - camera * camera) * c->n / (c->n - FEWEST));
    double most = time ? 1e3 * fmax(UNEVEN, UNEVEN_SHARE * c->interval) : UNEVEN_LEVEL;
    lesson_fault *f = add_fault(l, "even", sd, below(sd, c->n - FEWEST) / SURE, SURE, most);
    if (!f)
        return;
    snprintf(f->what, sizeof f->what, "Your strokes are uneven in %s: %.1f %s about your own %s",
             time ? "time" : "loudness", sd, q->unit, time ? "beat" : "mean");
    snprintf(f->how, sizeof f->how, "standard deviation of %d strokes", c->n);
    explain(f, sd, q->unit, time ? even_source : even_level_source);
}

// a displaced stroke is heard against its neighbours; the first and the last have one alone
static void against_neighbours(course *c)
{
    double *x = c->value[0];
    memcpy(c->scratch, x, (size_t)c->n * sizeof *x);
    for (int k = 0; k < c->n; k++)
        x[k] = k && k + 1 < c->n ? x[k] - 0.5 * (c->scratch[k - 1] + c->scratch[k + 1]) : 0;
}

/// Strokes that are far outside the player's own spread.
static void judge_singles(lesson *l, course *c, const quantity *q)
{
    double own = 0, worst = 0, rest = 0, *size = c->value[0];
    int which = -1, count = 0;
    for (int axis = 0; axis < q->axes; axis++) {
        for (int k = 0; k < c->n; k++)
            c->scratch[k] = c->value[axis][k];
        double middle = median(c->scratch, c->n);
        for (int k = 0; k < c->n; k++)
            c->value[axis][k] -= middle;
        own = hypot(own, spread(c, c->value[axis]));
    }
    for (int k = 0; k < c->n; k++) {
        double x = q->axes > 1 ? hypot(size[k], c->value[1][k]) : size[k];
        c->scratch[k] = fabs(x);
        if (fabs(x) > fabs(worst))
            worst = x, which = k;
    }
    qsort(c->scratch, (size_t)c->n, sizeof *c->scratch, himc_order_doubles);
    for (int k = 0; k < c->n - 2; k++) // the two furthest may be faults
        rest += c->scratch[k] * c->scratch[k] / (c->n - 2);
    const lesson_played *p = &l->played[c->stroke[which < 0 ? 0 : which]];
    own = fmax(own, sqrt(rest));
    own = hypot(own, q->axes > 1 ? 0 : q->scale > 1 ? p->u_time : p->u_level);
    for (int k = 0; k < c->n; k++)
        count += c->scratch[k] - SINGLE * own > q->threshold;
    lesson_fault *f = c->n < 2 * FEWEST || which < 0
                          ? NULL
                          : add_fault(l, q->kind, q->scale * worst, q->scale * own, SINGLE,
                                      q->scale * q->threshold);
    if (!f)
        return;
    const lesson_asked *a = &l->asked[l->played[c->stroke[which]].of];
    snprintf(f->what, sizeof f->what, "The %s hand's stroke at beat %g %s %.1f %s %s",
             himc_hand_name(a->hand), a->beat, q->axes > 1 ? "lands" : "is", fabs(f->effect),
             q->unit,
             q->axes > 1 ? "beside its place"
             : worst > 0 ? q->more
                         : q->less);
    snprintf(f->how, sizeof f->how, "a single stroke%s", count > 1 ? "; there are others" : "");
    explain(f, q->scale * own, q->unit, q->source);
}

/// Evenness of a roll: its strokes about an even course that may quicken; a stroke left out counts.
static void judge_roll(lesson *l, lesson_roll *r, const double *t, const double *level, int n)
{
    double index[512], value[512], p[3], u[3], even[2] = {0}, ss = 0, louder = 0, mean = 0;
    r->strokes = n, r->begin = n ? t[0] : NAN;
    if (n < 2 * FEWEST)
        return;
    for (int k = 1; k < n; k++)
        value[k - 1] = t[k] - t[k - 1];
    double middle = median(value, n - 1);
    for (int k = 0; k < n; k++)
        index[k] = k ? index[k - 1] + fmax(1, round((t[k] - t[k - 1]) / middle)) : 0;
    fit(index, t, n, 3, p, u);
    double half = 0.5 * index[n - 1];
    int count[2] = {0};
    for (int k = 0; k < n; k++) {
        double x = index[k] / half - 1;
        value[k] = t[k] - p[0] - x * (p[1] + x * p[2]);
        int odd = (int)index[k] % 2;
        even[odd] += value[k], count[odd]++;
        ss += value[k] * value[k], mean += level[k] / n;
    }
    for (int k = 0; k < n; k++)
        louder += pow(level[k] - mean, 2);
    double frame = 1 / (l->rate * sqrt(12)), free = n - 3, sd = sqrt(ss / free);
    double late = count[0] && count[1] ? even[1] / count[1] - even[0] / count[0] : 0;
    double rest = sqrt(fmax(0, ss - late * late * count[0] * count[1] / n) / (free - 1));
    r->rate = half / p[1];
    r->uneven = sqrt(fmax(0, sd * sd - frame * frame / 4));
    r->u = below(r->uneven, free) / SURE;
    r->gallop = late;
    r->u_gallop = rest * sqrt(1.0 / fmax(1, count[0]) + 1.0 / fmax(1, count[1]));
    r->spread = sqrt(louder / (n - 1));
    bool gallops = fabs(late) - SURE * r->u_gallop > JND_TIME;
    lesson_fault *f =
        gallops ? add_fault(l, "roll", 1e3 * late, 1e3 * r->u_gallop, SURE, 1e3 * JND_TIME)
                : add_fault(l, "roll", 1e3 * r->uneven, 1e3 * r->u, SURE, 1e3 * JND_TIME);
    if (!f)
        return;
    snprintf(f->what, sizeof f->what, "The roll at %.1f s %s: %s %.1f ms %s", t[0],
             gallops ? "gallops" : "is uneven",
             gallops ? "every second stroke comes" : "its strokes are", fabs(f->effect),
             !gallops   ? "off an even roll"
             : late > 0 ? "late"
                        : "early");
    snprintf(f->how, sizeof f->how, "%d strokes, %.1f a second", n, r->rate);
    explain(f, 1e3 * (gallops ? rest : sd), "ms", time_source);
}

// runs of equal fast strokes are rolls as well
static void find_runs(lesson *l)
{
    for (int from = 0, k = 1; k <= l->asked_count; k++) {
        const lesson_asked *a = l->asked;
        double first = from + 1 < l->asked_count ? a[from + 1].time - a[from].time : 0;
        bool goes_on = k < l->asked_count && first > 0.04 && first < 0.17 &&
                       fabs(a[k].time - a[k - 1].time - first) < 0.1 * first;
        if (goes_on)
            continue;
        if (k - from >= 2 * FEWEST && l->rolls < LESSON_ROLLS)
            l->roll[l->rolls++] = (lesson_roll){.from = a[from].time, .to = a[k - 1].time};
        from = k - from > 1 ? k - 1 : k;
    }
}

static void judge_rolls(lesson *l, const course *c)
{
    for (int i = 0; i < l->rolls; i++) {
        lesson_roll *r = &l->roll[i];
        double t[512], level[512];
        int n = 0, segment = 0;
        for (int k = 0; k < c->n && c->asked[k] < r->from; k++)
            segment = c->segment[k];
        double from = beat_at(c, r->from, segment) - 0.12, to = beat_at(c, r->to, segment) + 0.12;
        for (int k = 0; k < l->count && n < 512; k++) {
            lesson_played *p = &l->played[k];
            double asked = p->of < 0 ? NAN : l->asked[p->of].time;
            bool in = r->written ? p->of < 0 && p->strike.time >= from && p->strike.time < to
                                 : asked > r->from - 1e-6 && asked < r->to + 1e-6;
            if (!in)
                continue;
            p->roll = i;
            t[n] = p->strike.time - l->lead[p->strike.hand],
            level[n++] = 20 * log10(p->strike.velocity);
        }
        judge_roll(l, r, t, level, n);
    }
}

// strokes without a partner
static void judge_missing(lesson *l)
{
    char beats[2][64] = {"", ""};
    int alone = 0; // missing, but not with a phrase
    for (int k = 0; k < l->asked_count; k++) {
        const lesson_asked *a = &l->asked[k];
        if (a->by >= 0 || !l->seen[a->hand])
            continue;
        l->missing++;
        if (a->skipped)
            continue;
        alone++;
        size_t used = strlen(beats[0]);
        snprintf(beats[0] + used, sizeof beats[0] - used, "%s%s at beat %g", used ? ", " : "",
                 himc_hand_name(a->hand), a->beat);
    }
    for (int k = 0; k < l->count; k++) {
        const lesson_played *p = &l->played[k];
        if (p->of >= 0 || p->roll >= 0)
            continue;
        l->extra++;
        size_t used = strlen(beats[1]);
        snprintf(beats[1] + used, sizeof beats[1] - used, "%s%s at %.2f s", used ? ", " : "",
                 himc_hand_name(p->strike.hand), p->strike.time);
    }
    const int count[] = {alone, l->extra};
    for (int k = 0; k < 2; k++) {
        lesson_fault *f = add_fault(l, k ? "extra" : "missing", count[k], 0, 0, 0.01);
        if (!f)
            continue;
        snprintf(f->what, sizeof f->what, "%d stroke%s %s: %s", count[k], count[k] > 1 ? "s" : "",
                 k ? "too many" : "missing", beats[k]);
        snprintf(f->how, sizeof f->how, "%d strokes asked, %d matched, %d played", l->asked_count,
                 l->matched, l->count);
        explain(f, 0, count[k] > 1 ? "strokes" : "stroke", none_source);
        f->threshold = 1;
    }
}

// strokes of the other hand than the score's
static void judge_hands(lesson *l)
{
    char beats[80] = "";
    int count = 0;
    for (int k = 0; k < l->asked_count; k++) {
        const lesson_asked *a = &l->asked[k];
        if (a->by < 0 || l->played[a->by].strike.hand == a->hand)
            continue;
        size_t used = strlen(beats);
        if (used < sizeof beats - 10)
            snprintf(beats + used, sizeof beats - used, "%s%g", used ? ", " : "", a->beat);
        count++;
    }
    lesson_fault *f = add_fault(l, "hand", count, 0, 0, 0.01);
    if (!f)
        return;
    if (count > 0.9 * l->matched)
        snprintf(f->what, sizeof f->what,
                 "The hands are exchanged: %d of %d strokes are played by the other hand", count,
                 l->matched);
    else
        snprintf(f->what, sizeof f->what, "%d stroke%s played by the other hand: beat %s", count,
                 count > 1 ? "s are" : " is", beats);
    snprintf(f->how, sizeof f->how, "%d strokes matched; or the take names its sticks otherwise",
             l->matched);
    explain(f, 0, count > 1 ? "strokes" : "stroke", "the score names the hand");
    f->threshold = 1;
}

static bool new_course(const lesson *l, course *c)
{
    size_t n = (size_t)l->asked_count + 1;
    double *x = malloc(7 * n * sizeof *x);
    int *k = malloc(2 * n * sizeof *k);
    *c = (course){.stroke = k,
                  .segment = k + n,
                  .asked = x,
                  .played = x + n,
                  .weight = x + 2 * n,
                  .value = {x + 3 * n, x + 4 * n, x + 5 * n},
                  .scratch = x + 6 * n};
    if (!x || !k)
        return false;
    for (int i = 0; i < l->asked_count; i++)
        if (l->asked[i].by >= 0) {
            c->stroke[c->n] = l->asked[i].by;
            c->asked[c->n] = l->asked[i].time;
            c->weight[c->n] = 1;
            c->played[c->n++] = l->played[l->asked[i].by].strike.time;
        }
    int count = 0;
    for (int i = 1; i < c->n; i++)
        if (c->asked[i] - c->asked[i - 1] > 0.04)
            c->scratch[count++] = c->asked[i] - c->asked[i - 1];
    c->interval = median(c->scratch, count);
    return true;
}

// places of the strokes about their median, with the take turned by so many right angles; returns
// the sum of their distances from the medians of each hand and of both
static double place(const lesson *l, course *c, int turn)
{
    static const double cosine[] = {1, 0, -1, 0};
    double co = cosine[turn], si = cosine[(turn + 3) % 4], sum = 0;
    for (int k = 0; k < c->n; k++) {
        const lesson_played *p = &l->played[c->stroke[k]];
        himc_vec3 x = p->strike.x, a = l->asked[p->of].x;
        c->value[1][k] = co * x.x - si * x.y - a.x;
        c->value[2][k] = si * x.x + co * x.y - a.y;
    }
    double middle[3][3] = {{0}}; // of the left hand, the right, both
    for (int axis = 1; axis < 3; axis++)
        for (int hand = 0; hand < 3; hand++) {
            int n = 0;
            for (int k = 0; k < c->n; k++)
                if (hand == 2 || (int)l->played[c->stroke[k]].strike.hand == hand)
                    c->scratch[n++] = c->value[axis][k];
            middle[axis][hand] = median(c->scratch, n);
        }
    for (int k = 0; k < c->n; k++) {
        const double *x = middle[1], *y = middle[2];
        int hand = (int)l->played[c->stroke[k]].strike.hand;
        // chosen: a hand's own spots tell the direction better than the other hand does
        sum += 4 * hypot(c->value[1][k] - x[hand], c->value[2][k] - y[hand]);
        sum += hypot(c->value[1][k] -= x[2], c->value[2][k] -= y[2]);
    }
    return sum;
}

// levels about the take's mean; places in the direction that fits best, as tips alone hardly show
// where the player faces
static void measure(lesson *l, course *c)
{
    int turn = 0;
    double least = 0.9 * place(l, c, 0), next = INFINITY; // chosen: its own direction is likelier
    for (int k = 1; k < 4; k++) {
        double sum = place(l, c, k);
        next = fmin(next, fmax(sum, least));
        if (sum < least)
            least = sum, turn = k;
    }
    place(l, c, turn);
    l->turn = 90 * turn;
    l->turn_sure = next > 1.25 * least; // chosen
    for (int k = 0; k < c->n; k++) {
        lesson_played *p = &l->played[c->stroke[k]];
        p->off = c->value[0][k];
        p->aside = himc_vec3_make(c->value[1][k], c->value[2][k], 0);
        p->level = 20 * log10(p->strike.velocity / l->asked[p->of].speed);
        l->level += p->level / c->n;
    }
    for (int k = 0; k < c->n; k++)
        l->played[c->stroke[k]].level -= l->level;
}

bool lesson_judge(lesson *l, himc_error *error)
{
    course c;
    bool good = new_course(l, &c);
    if (good) {
        find_waits(l, &c);
        judge_tempo(l, &c);
        find_beat(&c);
        measure(l, &c);
        find_runs(l);
    }
    const quantity quantities[] = {
        {"time", "ms", "later", "earlier", time_source, 1, 1e3, jnd(c.interval)},
        {"level", "dB", "louder", "softer", level_source, 1, 1, JND_LEVEL},
        {"spot", "mm", "", "", place_source, 2, 1e3, PLACE}};
    for (int q = 0; q < 3 && good; q++) {
        for (int k = 0; k < c.n; k++) {
            const lesson_played *p = &l->played[c.stroke[k]];
            c.value[0][k] = q == 0 ? p->off : q == 1 ? p->level : p->aside.x;
            c.value[1][k] = p->aside.y;
        }
        good = judge_groups(l, &c, &quantities[q]);
        if (good && q < 2)
            judge_even(l, &c, &quantities[q]);
        if (good && q == 0)
            against_neighbours(&c);
        if (good)
            judge_singles(l, &c, &quantities[q]);
    }
    if (good) {
        judge_rolls(l, &c);
        judge_missing(l);
        judge_hands(l);
    }
    free(c.asked);
    free(c.stroke);
    return good || himc_error_set(error, "out of memory");
}
