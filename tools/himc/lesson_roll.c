/// lesson_roll.c: rolls of a score, and runs of equal fast strokes, in the take.
#include "lesson_beat.h"

#include <math.h>

#define LENGTH 0.15 // (s) of a roll
static const char length_source[] =
    "chosen: two of its strokes, 150 ms or more; no listeners' threshold is published";

// a roll that is left out, or that ends well before its end `due` or goes on well after it (s)
static void judge_length(lesson *l, const lesson_roll *r, double due, double last, double interval)
{
    double seconds, decibels, most = fmax(LENGTH, 2 * interval);
    double early = due - last - interval;
    lesson_scatter(l, &seconds, &decibels);
    if (!r->strokes) {
        lesson_fault *f = lesson_fault_add(l, "missing", 1, 0, 0, 0.01);
        if (f) {
            snprintf(f->what, sizeof f->what, "The roll at beat %g is left out", r->beat);
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
    snprintf(f->what, sizeof f->what, "The roll at beat %g is too %s: it ends %.0f ms too %s",
             r->beat, early > 0 ? "short" : "long", fabs(f->effect), early > 0 ? "early" : "late");
    snprintf(f->how, sizeof f->how, "%d strokes", r->strokes);
    lesson_fault_explain(f, 1e3 * seconds, "ms", length_source);
}

/// Evenness of a roll: its strokes about an even course that may quicken; a stroke left out counts.
static void judge_roll(lesson *l, lesson_roll *r, const double *t, const double *level, int n)
{
    double index[512], value[512], p[3], u[3], even[2] = {0}, ss = 0, louder = 0, mean = 0;
    r->strokes = n;
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
    r->u = lesson_below(r->uneven, free) / LESSON_SURE;
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
    snprintf(f->what, sizeof f->what, "The roll at beat %g %s: %s %.1f ms %s", r->beat,
             gallops ? "gallops" : "is uneven",
             gallops ? "every second stroke comes" : "its strokes are", fabs(f->effect),
             !gallops   ? "off an even roll"
             : late > 0 ? "late"
                        : "early");
    snprintf(f->how, sizeof f->how, "%d strokes, %.1f a second", n, r->rate);
    lesson_fault_explain(f, 1e3 * (gallops ? rest : sd), "ms", lesson_time_source);
}

void lesson_find_runs(lesson *l)
{
    for (int from = 0, k = 1; k <= l->asked_count; k++) {
        const lesson_asked *a = l->asked;
        double first = from + 1 < l->asked_count ? a[from + 1].time - a[from].time : 0;
        bool goes_on = k < l->asked_count && first > 0.04 && first < 0.17 &&
                       fabs(a[k].time - a[k - 1].time - first) < 0.1 * first;
        if (goes_on)
            continue;
        if (k - from >= 2 * LESSON_FEWEST && l->rolls < LESSON_ROLLS)
            l->roll[l->rolls++] =
                (lesson_roll){.beat = a[from].beat, .from = a[from].time, .to = a[k - 1].time};
        from = k - from > 1 ? k - 1 : k;
    }
}

// a hand of a roll against the other: not there, or softer
static void judge_sides(lesson *l, const lesson_roll *r, const double *level, const himc_hand *hand,
                        int n)
{
    double mean[HIMC_HANDS] = {0}, ss = 0;
    int count[HIMC_HANDS] = {0};
    for (int k = 0; k < n; k++)
        mean[hand[k]] += (level[k] - mean[hand[k]]) / ++count[hand[k]];
    if (n < 2 * LESSON_FEWEST || !l->seen[0] || !l->seen[1])
        return;
    bool alone = !count[0] || !count[1];
    for (int k = 0; k < n; k++)
        ss += pow(level[k] - mean[hand[k]], 2);
    double spread = sqrt(ss / (n - 2)),
           u = alone ? 0 : spread * sqrt(1.0 / count[0] + 1.0 / count[1]);
    double apart = mean[HIMC_RIGHT] - mean[HIMC_LEFT];
    lesson_fault *f = lesson_fault_add(l, "roll", alone ? 1 : fabs(apart), u, LESSON_SURE,
                                       alone ? 0.01 : LESSON_UNEVEN_LEVEL);
    if (!f)
        return;
    const char *who = himc_hand_name((alone ? count[1] > 0 : apart < 0) ? HIMC_RIGHT : HIMC_LEFT);
    if (alone)
        snprintf(f->what, sizeof f->what, "The roll at beat %g is played by the %s hand alone",
                 r->beat, who);
    else
        snprintf(f->what, sizeof f->what, "The roll at beat %g: the %s hand is %.1f dB softer",
                 r->beat, who, fabs(apart));
    snprintf(f->how, sizeof f->how, "%d strokes", n);
    lesson_fault_explain(f, alone ? 0 : spread, alone ? "roll" : "dB",
                         alone ? "a roll of one stroke each needs both hands"
                               : lesson_uneven_source);
    f->threshold = alone ? 1 : LESSON_UNEVEN_LEVEL;
}

void lesson_judge_rolls(lesson *l, const lesson_course *c)
{
    for (int i = 0; i < l->rolls; i++) {
        lesson_roll *r = &l->roll[i];
        double t[512], level[512], interval[512];
        himc_hand hand[512];
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
            hand[n] = p->strike.hand;
            t[n] = p->strike.time - l->lead[p->strike.hand],
            level[n++] = 20 * log10(p->strike.velocity);
            // what goes on after its time, without a pause, is the same roll
            if (r->written && n > 1 && t[n - 1] > due - 0.12)
                to = fmax(to, t[n - 1] + 1.6 * (t[n - 1] - t[0]) / (n - 1));
        }
        judge_roll(l, r, t, level, n);
        if (r->written)
            judge_sides(l, r, level, hand, n);
        for (k = 1; k < n; k++)
            interval[k - 1] = t[k] - t[k - 1];
        if (r->written)
            judge_length(l, r, due, n ? t[n - 1] : due, lesson_median(interval, n - (n > 0)));
    }
}
