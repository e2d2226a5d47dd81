/// lesson_beat.c: the player's own beat: waits, phrases left out, a tempo that changes.
///
/// The beat is a robust local line through the strokes' times (LOWESS, Cleveland 1979), begun again
/// after each wait.
#include "lesson_beat.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WINDOW 16 // chosen: strokes of the local line
#define STEP 0.6  // chosen: of what a tempo that changes all the time leaves
#define PHRASE 3  // chosen: so many missing strokes in a row are a phrase left out

#define JND_SHARE 0.025 // of the interval
const char lesson_time_source[] =
    "listeners notice 6 ms, or 2.5 % of intervals above 240 ms: Friberg and Sundberg 1995";
const char lesson_none_source[] =
    "a stroke too few or too many is always heard; no threshold is published";
const char lesson_uneven_source[] =
    "chosen: 2 dB, five times what listeners notice in the laboratory: Miller 1947";
#define JND_TEMPO 2.0 // (%)
static const char tempo_source[] =
    "listeners notice a drift of about 2 %, several studies cited by Dahl and Madison 2005";

double lesson_jnd(double interval)
{
    return fmax(LESSON_JND_TIME, JND_SHARE * interval);
}

double lesson_median(double *x, int n)
{
    qsort(x, (size_t)n, sizeof *x, himc_order_doubles);
    return n ? 0.5 * (x[n / 2] + x[(n - 1) / 2]) : 0;
}

double lesson_spread(const lesson_course *c, const double *x)
{
    for (int k = 0; k < c->n; k++)
        c->scratch[k] = fabs(x[k]);
    return 1.4826 * lesson_median(c->scratch, c->n);
}

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

double lesson_below(double sd, double free)
{
    return sd * (1 - pow(1 - 2 / (9 * free) + 2.33 * sqrt(2 / (9 * free)), -1.5));
}

static double bent(const lesson_course *c, double asked)
{
    if (c->bend == 0)
        return 0;
    if (isfinite(c->knee))
        return c->bend * fmax(0, asked - c->knee);
    double u = (asked - c->asked[0]) / c->half - 1;
    return c->bend * u * u;
}

double lesson_beat_at(const lesson_course *c, double asked, int segment)
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

static void find_beat(lesson_course *c)
{
    for (int round = 0; round < 4; round++) {
        for (int k = 0; k < c->n; k++)
            c->value[0][k] = c->played[k] - lesson_beat_at(c, c->asked[k], c->segment[k]);
        double six = 4 * lesson_spread(c, c->value[0]) + 1e-4;
        for (int k = 0; k < c->n; k++) {
            double r = fmin(1, fabs(c->value[0][k]) / six);
            c->weight[k] = (1 - r * r) * (1 - r * r);
        }
    }
}

static double third(double t, double knee)
{
    return isfinite(knee) ? fmax(0, t - knee) : t * t;
}

// lesson_fit, whose third term is max(0, u - knee) unless the knee is NaN; returns the sum of the
// squares that are left
static double fit(const double *x, const double *y, int n, int terms, double knee, double p[3],
                  double u[3])
{
    double m[3][6] = {{0}}, v[3] = {0}, ss = 0, lag = 0, before = 0;
    double low = x[0], half = 0.5 * (x[n - 1] - x[0]) + 1e-9;
    for (int k = 0; k < n; k++) {
        double t = (x[k] - low) / half - 1, f[3] = {1, t, third(t, knee)};
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
               r = y[k] - p[0] - t * p[1] - (terms > 2 ? third(t, knee) * p[2] : 0);
        ss += r * r, lag += k ? r * before : 0, before = r;
    }
    double rho = ss > 0 ? fmin(0.9, fmax(0, lag / ss)) : 0;
    for (int i = 0; i < terms; i++)
        u[i] = sqrt(ss / (n > terms ? n - terms : 1) * m[i][3 + i] * (1 + rho) / (1 - rho));
    return ss;
}

void lesson_fit(const double *x, const double *y, int n, int terms, double p[3], double u[3])
{
    fit(x, y, n, terms, NAN, p, u);
}

// the stroke at which a tempo that is even before and after changes, or -1 if one that changes all
// the time fits `t` about as well, whose fit is p
static int find_knee(const lesson_course *c, const double *t, double p[3], double u[3])
{
    int knee = -1, every = 1 + c->n / 64; // chosen: a bar or two of a long piece
    double least = STEP * fit(c->asked, t, c->n, 3, NAN, p, u);
    double half = 0.5 * (c->asked[c->n - 1] - c->asked[0]) + 1e-9;
    for (int k = 3 * LESSON_FEWEST; k < c->n - 3 * LESSON_FEWEST; k += every) {
        double q[3], v[3];
        double ss = fit(c->asked, t, c->n, 3, (c->asked[k] - c->asked[0]) / half - 1, q, v);
        if (ss >= least)
            continue;
        least = ss;
        knee = k;
        memcpy(p, q, sizeof q);
        memcpy(u, v, sizeof v);
    }
    return knee;
}

// played over asked intervals, the middle one; over some strokes, as hands may differ
static double slope_of(const lesson_course *c)
{
    int n = 0, lag = c->n < 48 ? 1 + c->n / 12 : 6; // chosen
    for (int k = lag; k < c->n; k++)
        if (c->asked[k] - c->asked[k - lag] > 0.04)
            c->scratch[n++] =
                (c->played[k] - c->played[k - lag]) / (c->asked[k] - c->asked[k - lag]);
    return lesson_median(c->scratch, n);
}

// A fault without its words, if a phrase is missing between the asked strokes `from` and `to`, or
// NULL; `phrase`: its first and last stroke.
static lesson_fault *find_phrase(lesson *l, int from, int to, int phrase[2])
{
    int count = 0;
    phrase[0] = phrase[1] = -1;
    for (int i = from + 1; i < to; i++)
        if (l->seen[l->asked[i].hand] && l->asked[i].by < 0) {
            phrase[0] = count++ == 0 ? i : phrase[0];
            phrase[1] = i;
        }
    lesson_fault *f = count < PHRASE ? NULL : lesson_fault_add(l, "skip", count, 0, 0, 0.01);
    if (!f)
        return NULL;
    for (int i = phrase[0]; i <= phrase[1]; i++)
        l->asked[i].skipped = l->asked[i].by < 0;
    lesson_fault_explain(f, 0, "strokes", lesson_none_source);
    f->threshold = 1;
    return f;
}

// a phrase left out before matched stroke k is named; true if the beat begins again after it
static bool left_out(lesson *l, const lesson_course *c, int k, bool jumps)
{
    int phrase[2];
    lesson_fault *f =
        find_phrase(l, l->played[c->stroke[k - 1]].of, l->played[c->stroke[k]].of, phrase);
    if (!f)
        return false;
    snprintf(f->what, sizeof f->what, "You leave out beats %g to %g: %.0f strokes",
             l->asked[phrase[0]].beat, l->asked[phrase[1]].beat, f->effect);
    snprintf(f->how, sizeof f->how, "%s", jumps ? "played on without them" : "their time passes");
    return jumps;
}

// a take that begins late or ends early
static void find_ends(lesson *l, const lesson_course *c)
{
    const int ends[] = {l->played[c->stroke[0]].of, l->played[c->stroke[c->n - 1]].of};
    for (int late = 0; late < 2; late++) {
        int phrase[2];
        lesson_fault *f =
            find_phrase(l, late ? ends[1] : -1, late ? l->asked_count : ends[0], phrase);
        if (!f)
            continue;
        snprintf(f->what, sizeof f->what,
                 "The take %s at beat %g: the score's %s %.0f strokes are not in it",
                 late ? "ends" : "begins", l->asked[ends[late]].beat, late ? "last" : "first",
                 f->effect);
        snprintf(f->how, sizeof f->how, "the others are judged");
    }
}

/// Waits and jumps: an interval that is too long or too short, and all strokes after it with it.
static void find_waits(lesson *l, lesson_course *c)
{
    double slope = slope_of(c), *e = c->value[0];
    for (int k = 0; k < c->n; k++)
        e[k] = k ? c->played[k] - c->played[k - 1] - slope * (c->asked[k] - c->asked[k - 1]) : 0;
    double own = fmax(lesson_spread(c, e), 0.5 / l->rate);
    int segment = 0;
    for (int k = 0; k < c->n; k++) {
        double before = 0, after = 0;
        c->segment[k] = segment;
        if (k && left_out(l, c, k, fabs(e[k]) > 6 * own + 2 * lesson_jnd(c->interval))) {
            c->segment[k] = ++segment;
            continue;
        }
        if (k < 3 || k + 3 > c->n ||
            fabs(e[k]) < 6 * own + 2 * lesson_jnd(c->asked[k] - c->asked[k - 1]))
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
        lesson_fault *f = lesson_fault_add(l, "wait", 1e3 * (after - before), 1e3 * own,
                                           LESSON_SURE, 1e3 * lesson_jnd(c->interval));
        if (!f)
            continue;
        snprintf(f->what, sizeof f->what,
                 "You %s before beat %g: the stroke and all after it come %.0f ms %s",
                 e[k] > 0 ? "wait" : "hurry", a->beat, fabs(f->effect),
                 e[k] > 0 ? "late" : "early");
        snprintf(f->how, sizeof f->how, "one interval; bound of three spreads");
        lesson_fault_explain(f, 1e3 * own, "ms", lesson_time_source);
    }
}

/// Mean tempo, the times off a metronome, and rushing or dragging.
static void judge_tempo(lesson *l, lesson_course *c)
{
    double p[3], u[3], jump = 0;
    double half = 0.5 * (c->asked[c->n - 1] - c->asked[0]) + 1e-9;
    double *t = c->value[1], slope = slope_of(c);
    for (int k = 0; k < c->n; k++) {
        if (k && c->segment[k] > c->segment[k - 1])
            jump += c->played[k] - c->played[k - 1] - slope * (c->asked[k] - c->asked[k - 1]);
        t[k] = c->played[k] - jump;
    }
    lesson_fit(c->asked, t, c->n, 2, p, u);
    l->tempo = (lesson_figure){half / p[1], half / p[1] * u[1] / p[1]};
    for (int k = 0; k < c->n; k++)
        l->played[c->stroke[k]].steady =
            t[k] - p[0] - p[1] * ((c->asked[k] - c->asked[0]) / half - 1);
    if (c->n < 3 * LESSON_FEWEST)
        return;
    int knee = find_knee(c, t, p, u);
    double change = 100 * ((p[1] - 2 * p[2]) / (p[1] + 2 * p[2]) - 1), own = 400 * u[2] / p[1];
    if (knee >= 0) {
        change = 100 * (p[1] / (p[1] + p[2]) - 1);
        own = 100 * u[2] / p[1];
    }
    if (fabs(p[2]) > LESSON_SURE * u[2]) { // else the local line follows
        c->bend = knee < 0 ? p[2] : p[2] / half;
        c->half = half;
        c->knee = knee < 0 ? NAN : c->asked[knee];
    }
    lesson_fault *f = lesson_fault_add(l, "tempo", change, own, LESSON_SURE, JND_TEMPO);
    if (!f)
        return;
    const char *way = change < 0 ? "drag" : "rush", *goes = change < 0 ? "falls" : "rises";
    if (knee < 0)
        snprintf(f->what, sizeof f->what,
                 "You %s: the tempo %s by %.1f %% from the first stroke to the last", way, goes,
                 fabs(change));
    else
        snprintf(f->what, sizeof f->what, "You %s from beat %g on: the tempo %s by %.1f %% there",
                 way, l->asked[l->played[c->stroke[knee]].of].beat, goes, fabs(change));
    snprintf(f->how, sizeof f->how, "%d strokes, about the score's own tempo", c->n);
    lesson_fault_explain(f, own, "%", tempo_source);
}

bool lesson_course_new(lesson *l, lesson_course *c)
{
    size_t n = (size_t)l->asked_count + 1;
    double *x = malloc(7 * n * sizeof *x);
    int *k = malloc(2 * n * sizeof *k);
    *c = (lesson_course){.stroke = k,
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
    c->interval = lesson_median(c->scratch, count);
    find_ends(l, c);
    find_waits(l, c);
    judge_tempo(l, c);
    find_beat(c);
    return true;
}

void lesson_course_free(lesson_course *c)
{
    free(c->asked);
    free(c->stroke);
}
