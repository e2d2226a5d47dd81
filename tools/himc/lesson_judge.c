/// lesson_judge.c: what the matched strokes show, and which of it is worth practising.
///
/// Times are off the player's own beat (lesson_beat.c). For each of time, level and place the
/// strokes of a hand, of a place in beat and bar, of a nuance and of a spot are compared with the
/// others (Welch); the largest difference is named and taken away, then the next, so one fault is
/// named once. Then single strokes are compared with the player's own spread.
#include "lesson_beat.h"

#include "base/format.h"
#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FEWEST 3      // strokes of a group, beside LESSON_FEWEST others; chosen: a phrase's accents
#define CORE 3.5      // standard deviations within which the player's own spread is taken; chosen
#define NEAR_GAP 0.03 // (s) chosen: a strike that close to a gap is blunted
#define ELSEWHERE 0.06  // (m) chosen: three thresholds of places
#define WILD 0.1        // (s), and
#define WILD_SHARE 0.25 // of the interval; chosen: twice the unevenness of a beginner
#define ON_DRUM 0.25    // (m) from its middle; chosen: timpani stand farther apart
#define SINGLE 4.0      // standard deviations of a single stroke; chosen: 1 of 16000 is further off

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

#define FLAT 0.5   // share of a crescendo that must be missing
#define SWELL 3.0  // (dB) of a crescendo or more; chosen
#define WAVERS 0.5 // (dB) of asked strokes that are alike
#define STEP 0.6   // share of a swell in one step: no swell, but another dynamic
#define DRIFT 2.0  // (dB) of loudness, over the whole take; chosen: as a dynamic's half
static const char drift_source[] =
    "chosen: 2 dB over the whole take; no listeners' threshold is published";

enum { HAND, IN_BEAT, NUANCE, SPOT, BEAT_OF_BAR, EACH_SECOND, PLACE_IN_BAR, KINDS };
// of places in a bar there are many, of few strokes each: one would often seem to differ
static const double bound_of[KINDS] = {LESSON_SURE, LESSON_SURE, LESSON_SURE, LESSON_SURE,
                                       SINGLE,      SINGLE,      SINGLE};

static int group_of(const lesson *l, int stroke, int kind)
{
    const lesson_played *p = &l->played[stroke];
    const lesson_asked *a = &l->asked[p->of];
    double quarters = 4 * (a->beat - floor(a->beat));
    if (kind == HAND)
        return (int)p->strike.hand;
    if (kind == IN_BEAT)
        return fabs(quarters - round(quarters)) < 0.02 ? (int)round(quarters) % 4 : 4;
    if (kind == BEAT_OF_BAR)
        return a->metre > 1 ? (int)(a->in_bar + 0.02) : 0;
    if (kind == EACH_SECOND)
        return a->metre % 2 ? 0 : 1 + (int)round(4 * (a->in_bar - 1)) % 8;
    if (kind == PLACE_IN_BAR)
        return a->metre > 1 ? (int)round(4 * a->in_bar) : 0;
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
    else if (kind == BEAT_OF_BAR)
        snprintf(text, size, "the strokes of each bar's beat %d", id);
    else if (kind == EACH_SECOND)
        snprintf(text, size, "the strokes at beats %g, %g ... of the bars", 0.75 + 0.25 * id,
                 2.75 + 0.25 * id);
    else if (kind == PLACE_IN_BAR)
        snprintf(text, size, "the strokes at each bar's beat %g", 0.25 * id);
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
    d.excess = (d.size - bound_of[kind] * d.u) / threshold;
    return d;
}

/// A quantity of the strokes that is judged.
typedef struct quantity {
    const char *kind, *unit, *more, *less, *source;
    int axes;
    double scale, threshold;
} quantity;

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

// asked and played distance of a group's spot from the nearest other spot of its drum (m), NaN
// without one; returns the other's stroke
static const lesson_asked *spots_apart(const lesson *l, const lesson_course *c, const difference *d,
                                       const int *group, double *asked, double *played)
{
    const lesson_asked *a = &l->asked[d->id];
    const lesson_asked *nearest = NULL;
    *asked = *played = NAN;
    for (int k = 0; k < c->n; k++) {
        const lesson_asked *b = &l->asked[l->played[c->stroke[k]].of];
        himc_vec3 x = himc_vec3_sub(a->x, b->x);
        if (group[k] == d->id || strcmp(a->drum, b->drum) != 0 || hypot(x.x, x.y) >= *asked)
            continue;
        nearest = b;
        *asked = hypot(x.x, x.y);
        *played = hypot(x.x + d->effect[0], x.y + d->effect[1]);
    }
    return nearest;
}

static void tell_spot(lesson_fault *f, const lesson *l, const lesson_course *c, const difference *d,
                      const int *group, const char *who, const char *others)
{
    char place[64];
    double asked = NAN, played = NAN;
    bool whole = d->kind == SPOT; // all that a drum has
    const lesson_asked *one = &l->asked[whole ? d->id : 0], *other = NULL;
    name_place(d, place, sizeof place);
    if (whole)
        other = spots_apart(l, c, d, group, &asked, &played);
    for (int k = 0; k < c->n; k++)
        whole = whole && (group[k] == d->id ||
                          strcmp(one->drum, l->asked[l->played[c->stroke[k]].of].drum) != 0);
    if (d->kind == HAND) // who is right is not known, here and in time
        himc_format(f->what, sizeof f->what,
                    "The hands' places are %.0f mm apart: the left's, seen from the right's, %s",
                    f->effect, place);
    else if (other && asked > 2 * LESSON_PLACE && played < LESSON_PLACE)
        himc_format(f->what, sizeof f->what,
                    "The spots of beat %g and beat %g (%s) are played on one place: %.0f mm apart "
                    "are asked",
                    one->beat, other->beat, other->drum, 1e3 * asked);
    else
        himc_format(f->what, sizeof f->what,
                    "%s land %.0f mm beside their place (%s), measured from %s", who, f->effect,
                    place, others);
    snprintf(f->how, sizeof f->how, "%d strokes against %d%s", d->in, d->out,
             whole ? "; or the drum stands so far from the score's place" : "");
}

static void tell_group(lesson *l, const lesson_course *c, const quantity *q, const int *group,
                       difference d)
{
    char who[80], others[40] = "the others";
    bool place = q->axes > 1, time = q->scale > 1;
    // the softer hand, the earlier one, the left one
    if (d.kind == HAND && (place ? d.id == HIMC_RIGHT : d.effect[0] > 0)) {
        d.id = !d.id;
        for (int axis = 0; axis < q->axes; axis++)
            d.effect[axis] = -d.effect[axis];
    }
    double shown = q->scale * (place ? d.size : d.effect[0]);
    lesson_fault *f = lesson_fault_add(l, q->kind, shown, q->scale * d.u, bound_of[d.kind],
                                       q->scale * q->threshold);
    if (!f)
        return;
    name_group(l, d.kind, d.id, who, sizeof who);
    if (d.kind == HAND)
        snprintf(others, sizeof others, "the %s hand's", himc_hand_name((himc_hand)!d.id));
    who[0] = 'T';
    snprintf(f->how, sizeof f->how, "%d strokes against %d", d.in, d.out);
    lesson_fault_explain(f, q->scale * d.spread, q->unit, q->source);
    if (place)
        tell_spot(f, l, c, &d, group, who, others);
    else if (d.kind == HAND && time)
        snprintf(f->what, sizeof f->what, "The hands are %.1f ms apart: the %s behind the %s",
                 fabs(shown), himc_hand_name((himc_hand)!d.id), himc_hand_name((himc_hand)d.id));
    else if (d.kind == HAND || time)
        snprintf(f->what, sizeof f->what, "%s are %.1f %s %s than %s", who, fabs(shown), q->unit,
                 shown > 0 ? q->more : q->less, others);
    else // they may be as loud as the others where they should be louder
        snprintf(f->what, sizeof f->what, "%s are %.1f dB too %s beside %s", who, fabs(shown),
                 shown > 0 ? "loud" : "soft", others);
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
                for (int i = 0; i < k && first; i++)
                    first = g[i] != g[k];
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
        tell_group(l, c, q, group + best.kind * c->n, best);
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
    double *asked = c->value[2], step = 0;
    for (int k = 0; k < c->n; k++)
        asked[k] = 20 * log10(l->asked[l->played[c->stroke[k]].of].speed);
    for (int way = 1; way >= -1; way -= 2)
        for (int from = 0, k = 1; k <= c->n; k++) {
            int before = k - 2 > from ? k - 2 : from; // a hand with itself
            if (k < c->n && way * (asked[k] - asked[before]) > -WAVERS) {
                step = fmax(step, way * (asked[k] - asked[before]));
                continue;
            }
            double rise = way * (asked[k - 1] - asked[from]);
            if (k - from >= 2 * LESSON_FEWEST && rise > SWELL && step < STEP * rise)
                judge_swell(l, c, from, k - 1, way < 0);
            from = k;
            step = 0;
        }
}

/// Loudness that drifts away from the score's dynamics, named and taken away.
static void judge_drift(lesson *l, lesson_course *c)
{
    double p[3], u[3], half = 0.5 * (c->asked[c->n - 1] - c->asked[0]) + 1e-9;
    if (c->n < 3 * LESSON_FEWEST)
        return;
    lesson_fit(c->asked, c->value[0], c->n, 2, p, u);
    lesson_fault *f = lesson_fault_add(l, "level", 2 * p[1], 2 * u[1], LESSON_SURE, DRIFT);
    if (!f)
        return;
    snprintf(
        f->what, sizeof f->what,
        "You get %s, beside the score's dynamics: by %.1f dB from the first stroke to the last",
        p[1] > 0 ? "louder" : "softer", fabs(f->effect));
    snprintf(f->how, sizeof f->how, "%d strokes", c->n);
    lesson_fault_explain(f, u[1] * sqrt(c->n / 3.0), "dB", drift_source);
    for (int k = 0; k < c->n; k++)
        c->value[0][k] -= p[1] * ((c->asked[k] - c->asked[0]) / half - 1);
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
    double most = time ? 1e3 * fmax(UNEVEN, UNEVEN_SHARE * c->interval) : LESSON_UNEVEN_LEVEL;
    lesson_fault *f = lesson_fault_add(
        l, "even", sd, lesson_below(sd, c->n - LESSON_FEWEST) / LESSON_SURE, LESSON_SURE, most);
    if (!f)
        return;
    snprintf(f->what, sizeof f->what, "Your strokes are uneven in %s: %.1f %s about your own %s",
             time ? "time" : "loudness", sd, q->unit, time ? "beat" : "mean");
    snprintf(f->how, sizeof f->how, "standard deviation of %d strokes", c->n);
    lesson_fault_explain(f, sd, q->unit, time ? even_source : lesson_uneven_source);
}

// a displaced stroke is heard against its neighbours, the middle of four; the first and the last
// have fewer
static void against_neighbours(lesson_course *c)
{
    double *x = c->value[0];
    memcpy(c->scratch, x, (size_t)c->n * sizeof *x);
    for (int k = 0; k < c->n; k++) {
        double near[4];
        int n = 0;
        for (int i = k > 2 ? k - 2 : 0; i <= k + 2 && i < c->n; i++)
            if (i != k)
                near[n++] = c->scratch[i];
        bool waits = k && c->segment[k] > c->segment[k - 1]; // which is named
        x[k] = k && k + 1 < c->n && !waits ? c->scratch[k] - lesson_median(near, n) : 0;
    }
}

// standard deviation of what is no single stroke: of the middle, then of all within CORE of it
static double own_spread(const double *size, int n, double own)
{
    for (int round = 0; round < 8; round++) {
        double sum = 0, used = 0;
        for (int k = 0; k < n; k++)
            if (size[k] <= CORE * own)
                sum += size[k] * size[k], used++;
        own = fmax(own, used > 0 ? sqrt(sum / used) : 0);
    }
    return own;
}

/// Strokes that are far outside the player's own spread, in one fault.
static void judge_singles(lesson *l, lesson_course *c, const quantity *q)
{
    double own = 0, worst = 0, *size = c->value[0];
    bool place = q->axes > 1;
    int which = -1;
    lesson_list list = {.count = 0};
    for (int axis = 0; axis < q->axes; axis++) {
        for (int k = 0; k < c->n; k++)
            c->scratch[k] = c->value[axis][k];
        double middle = lesson_median(c->scratch, c->n);
        for (int k = 0; k < c->n; k++)
            c->value[axis][k] -= middle;
        own = hypot(own, lesson_spread(c, c->value[axis]));
    }
    for (int k = 0; k < c->n; k++) {
        size[k] = place ? hypot(size[k], c->value[1][k]) : size[k];
        c->scratch[k] = fabs(size[k]);
        if (fabs(size[k]) > fabs(worst))
            worst = size[k], which = k;
    }
    const lesson_played *p = &l->played[c->stroke[which < 0 ? 0 : which]];
    own = hypot(own_spread(c->scratch, c->n, own), place          ? 0
                                                   : q->scale > 1 ? p->u_time
                                                                  : p->u_level);
    lesson_fault *f = c->n < 2 * LESSON_FEWEST || which < 0
                          ? NULL
                          : lesson_fault_add(l, q->kind, q->scale * worst, q->scale * own, SINGLE,
                                             q->scale * q->threshold);
    if (!f)
        return;
    for (int k = 0; k < c->n; k++) {
        lesson_played *of = &l->played[c->stroke[k]];
        if (fabs(size[k]) - SINGLE * own <= q->threshold)
            continue;
        of->named = true;
        lesson_list_add(&list, "beat %g: %.*f %s%s%s", l->asked[of->of].beat, q->scale > 1 ? 0 : 1,
                        q->scale * fabs(size[k]), q->unit, place ? "" : " ",
                        place         ? ""
                        : size[k] > 0 ? q->more
                                      : q->less);
    }
    const lesson_asked *a = &l->asked[p->of];
    if (list.count > 1)
        himc_format(f->what, sizeof f->what, "%d strokes %s: %s", list.count,
                    place ? "land beside their places" : "are far from the others",
                    lesson_list_text(&list));
    else
        snprintf(f->what, sizeof f->what, "The %s hand's stroke at beat %g %s %.1f %s %s",
                 himc_hand_name(a->hand), a->beat, place ? "lands" : "is", fabs(f->effect), q->unit,
                 place       ? "beside its place"
                 : worst > 0 ? q->more
                             : q->less);
    snprintf(f->how, sizeof f->how, list.count > 1 ? "the largest of %d" : "a single stroke",
             list.count);
    lesson_fault_explain(f, q->scale * own, q->unit, q->source);
}

// the strokes of the take on the drum that the score names for them: the middle of their places
static bool drum_middle(const lesson *l, const lesson_course *c, const char *drum, double *scratch,
                        himc_vec3 *middle)
{
    double *axis[] = {&middle->x, &middle->y};
    int n = 0;
    for (int k = 0; k < 2; k++) {
        n = 0;
        for (int i = 0; i < c->n; i++) {
            const lesson_played *p = &l->played[c->stroke[i]];
            if (!strcmp(l->asked[p->of].drum, drum))
                scratch[n++] = k ? p->strike.x.y : p->strike.x.x;
        }
        *axis[k] = lesson_median(scratch, n);
    }
    return n >= LESSON_FEWEST;
}

// of all asked drums the one whose strokes in the take a place belongs to, if it is not `own`
static const char *other_drum(const lesson *l, const lesson_course *c, himc_vec3 x, const char *own)
{
    himc_vec3 middle;
    double here = drum_middle(l, c, own, c->scratch, &middle)
                      ? hypot(x.x - middle.x, x.y - middle.y)
                      : INFINITY,
           least = 0.5 * here; // chosen
    const char *found = NULL;
    for (int k = 0; k < l->asked_count && here > ON_DRUM; k++) {
        const char *drum = l->asked[k].drum;
        if (!strcmp(drum, own) || (k && !strcmp(drum, l->asked[k - 1].drum)) ||
            !drum_middle(l, c, drum, c->scratch, &middle))
            continue;
        if (hypot(x.x - middle.x, x.y - middle.y) < least) {
            least = hypot(x.x - middle.x, x.y - middle.y);
            found = drum;
        }
    }
    return found;
}

/// Strokes on another drum than the score's, named and taken away.
static void judge_drums(lesson *l, lesson_course *c)
{
    lesson_list list = {.count = 0};
    for (int k = 0; k < c->n; k++) {
        lesson_played *p = &l->played[c->stroke[k]];
        const lesson_asked *a = &l->asked[p->of];
        const char *drum =
            hypot(p->aside.x, p->aside.y) > ON_DRUM ? other_drum(l, c, p->strike.x, a->drum) : NULL;
        if (!drum)
            continue;
        p->named = true;
        c->value[0][k] = c->value[1][k] = 0;
        lesson_list_add(&list, "beat %g on %s instead of %s", a->beat, drum, a->drum);
    }
    lesson_fault *f = lesson_fault_add(l, "spot", list.count, 0, 0, 0.01);
    if (!f)
        return;
    himc_format(f->what, sizeof f->what, "%d stroke%s on the wrong drum: %s", list.count,
                list.count > 1 ? "s are" : " is", lesson_list_text(&list));
    snprintf(f->how, sizeof f->how, "where the take has each drum's other strokes");
    lesson_fault_explain(f, 0, list.count > 1 ? "strokes" : "stroke", "the score names the drum");
    f->threshold = 1;
}

// strokes too few or too many
static void tell_count(lesson *l, const char *kind, const char *what, lesson_list *list)
{
    lesson_fault *f = lesson_fault_add(l, kind, list->count, 0, 0, 0.01);
    if (!f)
        return;
    himc_format(f->what, sizeof f->what, "%d stroke%s %s: %s", list->count,
                list->count > 1 ? "s" : "", what, lesson_list_text(list));
    snprintf(f->how, sizeof f->how, "%d strokes asked, %d matched, %d played", l->asked_count,
             l->matched, l->count);
    lesson_fault_explain(f, 0, list->count > 1 ? "strokes" : "stroke", lesson_none_source);
    f->threshold = 1;
}

// true if the take does not show the stick where the stroke is due
static bool in_gap(const lesson *l, const lesson_course *c, const lesson_asked *a)
{
    int k = 0;
    while (k + 1 < c->n && c->asked[k + 1] <= a->time)
        k++;
    double due = lesson_beat_at(c, a->time, c->segment[k]);
    for (const lesson_gap *g = l->gap; g < l->gap + l->gaps; g++)
        if (g->hand == a->hand && due > g->from - NEAR_GAP && due < g->to + NEAR_GAP)
            return true;
    return false;
}

// strokes without a partner
static void judge_missing(lesson *l, const lesson_course *c)
{
    lesson_list missing = {.count = 0}, extra = {.count = 0};
    for (int k = 0; k < l->asked_count; k++) {
        lesson_asked *a = &l->asked[k];
        if (a->by >= 0 || !l->seen[a->hand])
            continue;
        a->unseen = !a->skipped && in_gap(l, c, a);
        l->unseen += a->unseen;
        l->missing += !a->unseen;
        if (!a->skipped && !a->unseen)
            lesson_list_add(&missing, "%s at beat %g", himc_hand_name(a->hand), a->beat);
    }
    double beat = NAN; // of the last matched stroke
    for (int k = 0; k < l->count; k++) {
        const lesson_played *p = &l->played[k];
        if (p->of >= 0)
            beat = l->asked[p->of].beat;
        if (p->of >= 0 || p->roll >= 0)
            continue;
        l->extra++;
        if (isfinite(beat))
            lesson_list_add(&extra, "%s after beat %g (%.2f s)", himc_hand_name(p->strike.hand),
                            beat, p->strike.time);
        else
            lesson_list_add(&extra, "%s at %.2f s", himc_hand_name(p->strike.hand), p->strike.time);
    }
    tell_count(l, "missing", "missing", &missing);
    tell_count(l, "extra", "too many", &extra);
}

// strokes of the other hand than the score's
static void judge_hands(lesson *l)
{
    lesson_list beats = {.count = 0};
    for (int k = 0; k < l->asked_count; k++) {
        const lesson_asked *a = &l->asked[k];
        if (a->by >= 0 && l->played[a->by].strike.hand != a->hand)
            lesson_list_add(&beats, "%g", a->beat);
    }
    lesson_fault *f = lesson_fault_add(l, "hand", beats.count, 0, 0, 0.01);
    if (!f)
        return;
    if (beats.count > 0.9 * l->matched)
        snprintf(f->what, sizeof f->what,
                 "The hands are exchanged: %d of %d strokes are played by the other hand",
                 beats.count, l->matched);
    else
        himc_format(f->what, sizeof f->what, "%d stroke%s played by the other hand: beat %s",
                    beats.count, beats.count > 1 ? "s are" : " is", lesson_list_text(&beats));
    snprintf(f->how, sizeof f->how, "%d strokes matched; or the take names its sticks otherwise",
             l->matched);
    lesson_fault_explain(f, 0, beats.count > 1 ? "strokes" : "stroke", "the score names the hand");
    f->threshold = 1;
}

// of the strokes on a drum (NULL: on all), by a hand (HIMC_HANDS: both), the middle of their places
static void middle_of(const lesson *l, lesson_course *c, const char *drum, int hand,
                      double middle[2])
{
    for (int axis = 0; axis < 2; axis++) {
        int n = 0;
        for (int k = 0; k < c->n; k++) {
            const lesson_played *p = &l->played[c->stroke[k]];
            if ((hand == HIMC_HANDS || (int)p->strike.hand == hand) &&
                (!drum || !strcmp(l->asked[p->of].drum, drum)))
                c->scratch[n++] = c->value[1 + axis][k];
        }
        middle[axis] = lesson_median(c->scratch, n);
    }
}

// places of the strokes about their median, if the drums are apart of each drum's, with the take
// turned by so many right angles; returns the sum of their distances from the medians of each hand
// and of both
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
    for (int first = 0; first < c->n; first++) { // of each drum, or of all
        const char *drum = l->apart ? l->asked[l->played[c->stroke[first]].of].drum : NULL;
        double middle[HIMC_HANDS + 1][2];
        bool done = !drum && first > 0;
        for (int k = 0; drum && k < first && !done; k++)
            done = !strcmp(l->asked[l->played[c->stroke[k]].of].drum, drum);
        for (int hand = 0; hand <= HIMC_HANDS && !done; hand++)
            middle_of(l, c, drum, hand, middle[hand]);
        for (int k = first; k < c->n && !done; k++) {
            const lesson_played *p = &l->played[c->stroke[k]];
            const double *own = middle[p->strike.hand], *both = middle[HIMC_HANDS];
            if (drum && strcmp(l->asked[p->of].drum, drum) != 0)
                continue;
            // chosen: a hand's own spots tell the direction better than the other hand does
            sum += 4 * hypot(c->value[1][k] - own[0], c->value[2][k] - own[1]);
            sum += hypot(c->value[1][k] -= both[0], c->value[2][k] -= both[1]);
        }
    }
    return sum;
}

// the direction in which the places fit best, as tips alone hardly show where the player faces
static void find_turn(lesson *l, lesson_course *c)
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
}

// true if a drum's strokes are together so far from their place that it will stand elsewhere
static bool stand_otherwise(const lesson *l, lesson_course *c)
{
    for (int k = 0; k < c->n; k++) {
        double middle[2];
        int count = 0;
        const char *drum = l->asked[l->played[c->stroke[k]].of].drum;
        for (int i = 0; i < c->n; i++)
            count += !strcmp(l->asked[l->played[c->stroke[i]].of].drum, drum);
        if (count < LESSON_FEWEST ||
            (k && !strcmp(l->asked[l->played[c->stroke[k - 1]].of].drum, drum)))
            continue;
        middle_of(l, c, drum, HIMC_HANDS, middle);
        if (hypot(middle[0], middle[1]) > ELSEWHERE)
            return true;
    }
    return false;
}

// levels about the take's mean, and places
static void measure(lesson *l, lesson_course *c)
{
    find_turn(l, c);
    l->apart = stand_otherwise(l, c);
    if (l->apart)
        find_turn(l, c);
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

// false for strokes that are hardly those of the score: too many, or on no steady beat
static bool fits(const lesson *l, const lesson_course *c, double wild, himc_error *error)
{
    bool whole = 10 * l->matched >= 9 * l->due && fabs(log2(l->tempo.mean)) < 0.5;
    if (l->extra > l->matched && !whole)
        return himc_error_set(error,
                              "%s does not match %s: %d of %d strokes of the take found in the "
                              "score, expected at least half of them",
                              l->take, l->score, l->matched, l->matched + l->extra);
    return wild < fmax(WILD, WILD_SHARE * c->interval) ||
           himc_error_set(error,
                          "%s does not match %s: its strokes are %.0f ms off any steady beat, "
                          "expected less than %.0f",
                          l->take, l->score, 1e3 * wild,
                          1e3 * fmax(WILD, WILD_SHARE * c->interval));
}

bool lesson_judge(lesson *l, himc_error *error)
{
    lesson_course c;
    bool good = lesson_course_new(l, &c);
    double wild = 0;
    if (good) {
        wild = lesson_spread(&c, c.value[0]);
        measure(l, &c);
        lesson_find_runs(l);
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
        if (q == 1) {
            judge_swells(l, &c);
            judge_drift(l, &c);
        }
        if (q == 2)
            judge_drums(l, &c);
        good = judge_groups(l, &c, &quantities[q]);
        if (good && q < 2)
            judge_even(l, &c, &quantities[q]);
        if (good && q == 0)
            against_neighbours(&c);
        if (good)
            judge_singles(l, &c, &quantities[q]);
    }
    if (good) {
        lesson_judge_rolls(l, &c);
        judge_missing(l, &c);
        judge_hands(l);
    }
    good = good ? fits(l, &c, wild, error) : himc_error_set(error, "out of memory");
    lesson_course_free(&c);
    return good;
}
