/// lesson_judge.c: what the matched strokes show, and which of it is worth practising.
///
/// Times are off the player's own beat (lesson_beat.c). For each of time, level and place the
/// strokes of a hand, of a place in the beat, of a nuance and of a spot are compared with the
/// others (Welch); the largest difference is named and taken away, then the next, so one fault is
/// named once. Then single strokes are compared with the player's own spread.
#include "lesson_beat.h"

#include "base/format.h"
#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FEWEST 3   // strokes of a group, beside LESSON_FEWEST others; chosen: a phrase's accents
#define SINGLE 4.0 // standard deviations of a single stroke; chosen: 1 of 16000 is further off

// Thresholds of listeners, and where no one has published any, what himc itself counts as right.
static const char level_source[] = "chosen: 1 dB; listeners notice 0.4 dB between noises in the "
                                   "laboratory: Miller 1947";
static const char place_source[] =
    "chosen: 20 mm, within which himc counts a stroke as on its spot; no listeners' threshold is "
    "published";
#define UNEVEN 0.02       // (s), and
#define UNEVEN_SHARE 0.04 // of the interval
static const char even_source[] =
    "chosen: 4 % of the interval, 20 ms or more; trained tappers vary by about 2 %: Repp 2005";
#define UNEVEN_LEVEL 2.0 // (dB)
static const char even_level_source[] =
    "chosen: 2 dB, five times what listeners notice in the laboratory: Miller 1947";

#define LENGTH 0.15 // (s) of a roll
static const char length_source[] =
    "chosen: two of its strokes, 150 ms or more; no listeners' threshold is published";
#define FLAT 0.5   // share of a crescendo that must be missing
#define SWELL 3.0  // (dB) of a crescendo or more; chosen
#define WAVERS 0.5 // (dB) of asked strokes that are alike

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
static difference compare(const lesson_course *c, const int *group, int kind, int id, int axes,
                          double threshold)
{
    difference d = {.kind = kind, .id = id};
    double variance = 0;
    for (int k = 0; k < c->n; k++)
        group[k] == id ? d.in++ : d.out++;
    for (int axis = 0; axis < axes && d.in >= FEWEST && d.out >= LESSON_FEWEST; axis++) {
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
    d.excess = (d.size - LESSON_SURE * d.u) / threshold;
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

// "30 mm too far, 12 mm to the left", without what is none
static void name_place(const difference *d, char *text, size_t size)
{
    static const char *const ways[][2] = {{"too near", "too far"}, {"to the right", "to the left"}};
    double away[] = {fabs(1e3 * d->effect[0]), fabs(1e3 * d->effect[1])};
    *text = 0;
    for (int axis = 0; axis < 2; axis++)
        if (away[axis] >= 0.5)
            himc_format(text + strlen(text), size - strlen(text), "%s%.0f mm %s", *text ? ", " : "",
                        away[axis], ways[axis][d->effect[axis] > 0]);
}

static void tell_group(lesson *l, const quantity *q, difference d)
{
    char who[80], others[40] = "the others", place[64];
    // the softer hand, the earlier one, the left one
    if (d.kind == HAND && (q->axes == 1 ? d.effect[0] > 0 : d.id == HIMC_RIGHT)) {
        d.id = !d.id;
        for (int axis = 0; axis < q->axes; axis++)
            d.effect[axis] = -d.effect[axis];
    }
    name_place(&d, place, sizeof place);
    double shown = q->scale * (q->axes > 1 ? d.size : d.effect[0]);
    lesson_fault *f =
        lesson_fault_add(l, q->kind, shown, q->scale * d.u, LESSON_SURE, q->scale * q->threshold);
    if (!f)
        return;
    name_group(l, d.kind, d.id, who, sizeof who);
    if (d.kind == HAND)
        snprintf(others, sizeof others, "the %s hand's", himc_hand_name((himc_hand)!d.id));
    who[0] = 'T';
    if (q->axes > 1 && d.kind == HAND) // who is right is not known, here and in time
        himc_format(f->what, sizeof f->what,
                    "The hands' places are %.0f mm apart: the left's, seen from the right's, %s",
                    shown, place);
    else if (q->axes > 1)
        himc_format(f->what, sizeof f->what,
                    "%s land %.0f mm beside their place (%s), measured from %s", who, shown, place,
                    others);
    else if (d.kind == HAND && strcmp(q->kind, "time") == 0)
        snprintf(f->what, sizeof f->what, "The hands are %.1f ms apart: the %s behind the %s",
                 fabs(shown), himc_hand_name((himc_hand)!d.id), himc_hand_name((himc_hand)d.id));
    else
        snprintf(f->what, sizeof f->what, "%s are %.1f %s %s than %s", who, fabs(shown), q->unit,
                 shown > 0 ? q->more : q->less, others);
    snprintf(f->how, sizeof f->how, "%d strokes against %d", d.in, d.out);
    lesson_fault_explain(f, q->scale * d.spread, q->unit, q->source);
}

/// Names the largest difference and takes it away, again and again.
static bool judge_groups(lesson *l, lesson_course *c, const quantity *q)
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

// the slope of the level over the asked one within a swell, named and taken away if it is flat
static void judge_swell(lesson *l, lesson_course *c, int from, int to, bool falls)
{
    double *level = c->value[0], *asked = c->value[2];
    double rise = asked[to] - asked[from], x = 0, xx = 0, y = 0, xy = 0, rest = 0;
    int n = to - from + 1;
    for (int k = from; k <= to; k++)
        x += asked[k] / n, y += level[k] / n;
    for (int k = from; k <= to; k++)
        xx += pow(asked[k] - x, 2), xy += (asked[k] - x) * (level[k] - y);
    double slope = xy / xx;
    for (int k = from; k <= to; k++)
        rest += pow(level[k] - y - slope * (asked[k] - x), 2);
    lesson_fault *f = slope > -FLAT ? NULL
                                    : lesson_fault_add(l, "level", slope * fabs(rise),
                                                       fabs(rise) * sqrt(rest / (n - 2) / xx),
                                                       LESSON_SURE, LESSON_JND_LEVEL);
    if (!f)
        return;
    snprintf(f->what, sizeof f->what, "%s %s from beat %g to %g: of %.1f dB you play %.1f dB",
             slope < -0.75 ? "Flat: no" : "Too little", falls ? "diminuendo" : "crescendo",
             l->asked[l->played[c->stroke[from]].of].beat,
             l->asked[l->played[c->stroke[to]].of].beat, rise, (1 + slope) * rise);
    snprintf(f->how, sizeof f->how, "slope of %d strokes over the asked level", n);
    lesson_fault_explain(f, sqrt(rest / (n - 2)), "dB", level_source);
    for (int k = from; k <= to; k++)
        level[k] -= slope * (asked[k] - x);
}

/// Crescendi and diminuendi of the score: runs in which the asked level goes one way.
static void judge_swells(lesson *l, lesson_course *c)
{
    double *asked = c->value[2];
    for (int k = 0; k < c->n; k++)
        asked[k] = 20 * log10(l->asked[l->played[c->stroke[k]].of].speed);
    for (int way = 1; way >= -1; way -= 2)
        for (int from = 0, k = 1; k <= c->n; k++) {
            int before = k - 2 > from ? k - 2 : from; // a hand with itself
            if (k < c->n && way * (asked[k] - asked[before]) > -WAVERS)
                continue;
            if (k - from >= 2 * LESSON_FEWEST && way * (asked[k - 1] - asked[from]) > SWELL)
                judge_swell(l, c, from, k - 1, way < 0);
            from = k;
        }
}

/// Unevenness of all strokes, once the differences of groups are taken away.
static void judge_even(lesson *l, lesson_course *c, const quantity *q)
{
    bool time = q->scale > 1;
    if (c->n < 2 * LESSON_FEWEST)
        return;
    for (int k = 0; k < c->n; k++)
        c->value[2][k] = c->value[0][k];
    double middle = lesson_median(c->value[2], c->n), sum = 0;
    for (int k = 0; k < c->n; k++)
        c->value[2][k] = fabs(c->value[0][k] - middle);
    qsort(c->value[2], (size_t)c->n, sizeof *c->value[2], himc_order_doubles);
    int used = c->n - 1 - c->n / 16;
    for (int k = 0; k < used; k++)
        sum += pow(c->value[2][k], 2);
    // of the furthest those that are no part of the others' spread are judged alone
    for (; used < c->n && c->value[2][used] < SINGLE * sqrt(sum / used); used++)
        sum += pow(c->value[2][used], 2);
    sum /= used;
    double camera = time ? 0.5 / l->rate : l->played[0].u_level;
    // the local beat follows the strokes a little
    double sd = q->scale * sqrt(fmax(0, sum - camera * camera) * c->n / (c->n - LESSON_FEWEST));
    double most = time ? 1e3 * fmax(UNEVEN, UNEVEN_SHARE * c->interval) : UNEVEN_LEVEL;
    lesson_fault *f = lesson_fault_add(l, "even", sd, below(sd, c->n - LESSON_FEWEST) / LESSON_SURE,
                                       LESSON_SURE, most);
    if (!f)
        return;
    snprintf(f->what, sizeof f->what, "Your strokes are uneven in %s: %.1f %s about your own %s",
             time ? "time" : "loudness", sd, q->unit, time ? "beat" : "mean");
    snprintf(f->how, sizeof f->how, "standard deviation of %d strokes", c->n);
    lesson_fault_explain(f, sd, q->unit, time ? even_source : even_level_source);
}

// a displaced stroke is heard against its neighbours; the first and the last have one alone
static void against_neighbours(lesson_course *c)
{
    double *x = c->value[0];
    memcpy(c->scratch, x, (size_t)c->n * sizeof *x);
    for (int k = 0; k < c->n; k++)
        x[k] = k && k + 1 < c->n ? x[k] - 0.5 * (c->scratch[k - 1] + c->scratch[k + 1]) : 0;
}

/// Strokes that are far outside the player's own spread.
static void judge_singles(lesson *l, lesson_course *c, const quantity *q)
{
    double own = 0, worst = 0, rest = 0, *size = c->value[0];
    int which = -1, count = 0;
    for (int axis = 0; axis < q->axes; axis++) {
        for (int k = 0; k < c->n; k++)
            c->scratch[k] = c->value[axis][k];
        double middle = lesson_median(c->scratch, c->n);
        for (int k = 0; k < c->n; k++)
            c->value[axis][k] -= middle;
        own = hypot(own, lesson_spread(c, c->value[axis]));
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
    lesson_fault *f = c->n < 2 * LESSON_FEWEST || which < 0
                          ? NULL
                          : lesson_fault_add(l, q->kind, q->scale * worst, q->scale * own, SINGLE,
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
    lesson_fault_explain(f, q->scale * own, q->unit, q->source);
}

// a roll that is left out, or that ends well before its end `due` or goes on well after it (s)
static void judge_length(lesson *l, const lesson_roll *r, double due, double last, double interval)
{
    double seconds, decibels, most = fmax(LENGTH, 2 * interval);
    double early = due - last - interval;
    lesson_scatter(l, &seconds, &decibels);
    if (!r->strokes) {
        lesson_fault *f = lesson_fault_add(l, "missing", 1, 0, 0, 0.01);
        if (f) {
            snprintf(f->what, sizeof f->what, "The roll until %.1f s is left out", due);
            snprintf(f->how, sizeof f->how, "no stroke in its time");
            lesson_fault_explain(f, 0, "roll", lesson_none_source);
            f->threshold = 1;
        }
        return;
    }
    lesson_fault *f =
        lesson_fault_add(l, "roll", 1e3 * early, 1e3 * seconds, LESSON_SURE, 1e3 * most);
    if (!f)
        return;
    snprintf(f->what, sizeof f->what, "The roll at %.1f s is too %s: it ends %.0f ms too %s",
             r->begin, early > 0 ? "short" : "long", fabs(f->effect), early > 0 ? "early" : "late");
    snprintf(f->how, sizeof f->how, "%d strokes", r->strokes);
    lesson_fault_explain(f, 1e3 * seconds, "ms", length_source);
}

/// Evenness of a roll: its strokes about an even course that may quicken; a stroke left out counts.
static void judge_roll(lesson *l, lesson_roll *r, const double *t, const double *level, int n)
{
    double index[512], value[512], p[3], u[3], even[2] = {0}, ss = 0, louder = 0, mean = 0;
    r->strokes = n, r->begin = n ? t[0] : NAN;
    if (n < 2 * LESSON_FEWEST)
        return;
    for (int k = 1; k < n; k++)
        value[k - 1] = t[k] - t[k - 1];
    double middle = lesson_median(value, n - 1);
    if (!(middle > 0)) // both hands at once: no roll's strokes
        return;
    for (int k = 0; k < n; k++)
        index[k] = k ? index[k - 1] + fmax(1, round((t[k] - t[k - 1]) / middle)) : 0;
    lesson_fit(index, t, n, 3, p, u);
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
    r->u = below(r->uneven, free) / LESSON_SURE;
    r->gallop = late;
    r->u_gallop = rest * sqrt(1.0 / fmax(1, count[0]) + 1.0 / fmax(1, count[1]));
    r->spread = sqrt(louder / (n - 1));
    bool gallops = fabs(late) - LESSON_SURE * r->u_gallop > LESSON_JND_TIME;
    lesson_fault *f = gallops ? lesson_fault_add(l, "roll", 1e3 * late, 1e3 * r->u_gallop,
                                                 LESSON_SURE, 1e3 * LESSON_JND_TIME)
                              : lesson_fault_add(l, "roll", 1e3 * r->uneven, 1e3 * r->u,
                                                 LESSON_SURE, 1e3 * LESSON_JND_TIME);
    if (!f)
        return;
    snprintf(f->what, sizeof f->what, "The roll at %.1f s %s: %s %.1f ms %s", t[0],
             gallops ? "gallops" : "is uneven",
             gallops ? "every second stroke comes" : "its strokes are", fabs(f->effect),
             !gallops   ? "off an even roll"
             : late > 0 ? "late"
                        : "early");
    snprintf(f->how, sizeof f->how, "%d strokes, %.1f a second", n, r->rate);
    lesson_fault_explain(f, 1e3 * (gallops ? rest : sd), "ms", lesson_time_source);
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
        if (k - from >= 2 * LESSON_FEWEST && l->rolls < LESSON_ROLLS)
            l->roll[l->rolls++] = (lesson_roll){.from = a[from].time, .to = a[k - 1].time};
        from = k - from > 1 ? k - 1 : k;
    }
}

static void judge_rolls(lesson *l, const lesson_course *c)
{
    for (int i = 0; i < l->rolls; i++) {
        lesson_roll *r = &l->roll[i];
        double t[512], level[512], interval[512];
        int n = 0, k = 0;
        while (k + 1 < c->n && c->asked[k + 1] < r->from)
            k++;
        int before = c->segment[k];
        while (k + 1 < c->n && c->asked[k] < r->to - 0.01)
            k++;
        double from = lesson_beat_at(c, r->from, before) - 0.12,
               due = lesson_beat_at(c, r->to, c->segment[k]), to = due + 0.12;
        for (k = 0; k < l->count && n < 512; k++) {
            lesson_played *p = &l->played[k];
            double asked = p->of < 0 ? NAN : l->asked[p->of].time;
            bool in = r->written ? p->of < 0 && p->strike.time >= from && p->strike.time < to
                                 : asked > r->from - 1e-6 && asked < r->to + 1e-6;
            if (!in)
                continue;
            p->roll = i;
            t[n] = p->strike.time - l->lead[p->strike.hand],
            level[n++] = 20 * log10(p->strike.velocity);
            // what goes on after its time, without a pause, is the same roll
            if (r->written && n > 1 && t[n - 1] > due - 0.12)
                to = fmax(to, t[n - 1] + 1.6 * (t[n - 1] - t[0]) / (n - 1));
        }
        judge_roll(l, r, t, level, n);
        for (k = 1; k < n; k++)
            interval[k - 1] = t[k] - t[k - 1];
        if (r->written)
            judge_length(l, r, due, n ? t[n - 1] : due, lesson_median(interval, n - (n > 0)));
    }
}

#define LISTED 64 // characters of strokes that are listed, in whole entries of 32 at most
#define ENTRY 32

// strokes without a partner
static void judge_missing(lesson *l)
{
    char beats[2][LISTED + 2 * ENTRY] = {"", ""};
    int alone = 0, listed[2] = {0}; // missing, but not with a phrase
    for (int k = 0; k < l->asked_count; k++) {
        const lesson_asked *a = &l->asked[k];
        if (a->by >= 0 || !l->seen[a->hand])
            continue;
        l->missing++;
        if (a->skipped)
            continue;
        alone++;
        size_t used = strlen(beats[0]);
        if (used < LISTED && ++listed[0])
            snprintf(beats[0] + used, ENTRY, "%s%s at beat %g", used ? ", " : "",
                     himc_hand_name(a->hand), a->beat);
    }
    for (int k = 0; k < l->count; k++) {
        const lesson_played *p = &l->played[k];
        if (p->of >= 0 || p->roll >= 0)
            continue;
        l->extra++;
        size_t used = strlen(beats[1]);
        if (used < LISTED && ++listed[1])
            snprintf(beats[1] + used, ENTRY, "%s%s at %.2f s", used ? ", " : "",
                     himc_hand_name(p->strike.hand), p->strike.time);
    }
    const int count[] = {alone, l->extra};
    for (int k = 0; k < 2; k++)
        if (count[k] > listed[k])
            snprintf(beats[k] + strlen(beats[k]), ENTRY, " and %d more", count[k] - listed[k]);
    for (int k = 0; k < 2; k++) {
        lesson_fault *f = lesson_fault_add(l, k ? "extra" : "missing", count[k], 0, 0, 0.01);
        if (!f)
            continue;
        himc_format(f->what, sizeof f->what, "%d stroke%s %s: %s", count[k],
                    count[k] > 1 ? "s" : "", k ? "too many" : "missing", beats[k]);
        snprintf(f->how, sizeof f->how, "%d strokes asked, %d matched, %d played", l->asked_count,
                 l->matched, l->count);
        lesson_fault_explain(f, 0, count[k] > 1 ? "strokes" : "stroke", lesson_none_source);
        f->threshold = 1;
    }
}

// strokes of the other hand than the score's
static void judge_hands(lesson *l)
{
    char beats[80] = "";
    int count = 0, listed = 0;
    for (int k = 0; k < l->asked_count; k++) {
        const lesson_asked *a = &l->asked[k];
        if (a->by < 0 || l->played[a->by].strike.hand == a->hand)
            continue;
        size_t used = strlen(beats);
        if (used < sizeof beats - 30 && ++listed)
            snprintf(beats + used, sizeof beats - used, "%s%g", used ? ", " : "", a->beat);
        count++;
    }
    if (count > listed)
        himc_format(beats + strlen(beats), 20, " and %d more", count - listed);
    lesson_fault *f = lesson_fault_add(l, "hand", count, 0, 0, 0.01);
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
    lesson_fault_explain(f, 0, count > 1 ? "strokes" : "stroke", "the score names the hand");
    f->threshold = 1;
}

// places of the strokes about their median, with the take turned by so many right angles; returns
// the sum of their distances from the medians of each hand and of both
static double place(const lesson *l, lesson_course *c, int turn)
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
            middle[axis][hand] = lesson_median(c->scratch, n);
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
static void measure(lesson *l, lesson_course *c)
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
    lesson_course c;
    bool good = lesson_course_new(l, &c);
    if (good) {
        measure(l, &c);
        find_runs(l);
    }
    l->jnd = lesson_jnd(c.interval);
    const quantity quantities[] = {
        {"time", "ms", "later", "earlier", lesson_time_source, 1, 1e3, l->jnd},
        {"level", "dB", "louder", "softer", level_source, 1, 1, LESSON_JND_LEVEL},
        {"spot", "mm", "", "", place_source, 2, 1e3, LESSON_PLACE}};
    for (int q = 0; q < 3 && good; q++) {
        for (int k = 0; k < c.n; k++) {
            const lesson_played *p = &l->played[c.stroke[k]];
            c.value[0][k] = q == 0 ? p->off : q == 1 ? p->level : p->aside.x;
            c.value[1][k] = p->aside.y;
        }
        if (q == 1)
            judge_swells(l, &c);
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
    lesson_course_free(&c);
    return good || himc_error_set(error, "out of memory");
}
