/// lesson_match.c: which strike of a take is which stroke of a score.
///
/// Strokes of both hands within 35 ms are one event. Dynamic programming over events: the state
/// (i, j) says that asked event i is played event j; its cost is the least over predecessors of
///
///     ((d - r D) / s)^2, at most LEAP        d, D: intervals since then, played and asked
///     + GAP for each event left out between   s = 30 ms + 0.08 r D
///     + OTHER for each hand that differs
///
/// or, for a phrase left out or played again, JUMP + MORE for each such event, whatever the time.
/// So the offset does not matter, and a wait costs LEAP once. All is done once more with the
/// score's hands exchanged, which costs EXCHANGED. The tempo r begins with each of a
/// grid of values and follows the played intervals along the path. Rolls have no events: their
/// number of strokes is the player's.
#include "lesson.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// costs; chosen by generated takes (tests/cli/lesson_takes.py)
#define TOGETHER 0.035 // (s)
#define LEAP 14.0
#define GAP 6.0
#define JUMP 20.0
#define MORE 1.2
#define EXCHANGED 8.0
#define ROLLED 0.02 // for a played event that a roll may contain
#define OTHER 3.0
#define BACK 4 // steps back: up to BACK - 1 events left out in a row; in a roll ...
#define BACK_ROLL 400
#define FOLLOW 0.15 // share of a new interval in the tempo
#define TEMPI 29    // from half to twice the score's
#define BAND 60     // events beside the diagonal

typedef struct event {
    double time;
    int stroke[HIMC_HANDS]; // index, or -1
    bool after_roll;
} event;

static int add_event(event *e, int count, double time, himc_hand hand, int stroke)
{
    event *last = count ? &e[count - 1] : NULL;
    if (last && time - last->time < TOGETHER && last->stroke[hand] < 0) {
        last->stroke[hand] = stroke;
        return count;
    }
    e[count] = (event){time, {-1, -1}, false};
    e[count].stroke[hand] = stroke;
    return count + 1;
}

typedef struct cell {
    double cost, tempo;
    int i, j;    // predecessor, -1: none
    double jump; // least cost of a jump from here on, and where it begins
    int from_i, from_j;
} cell;

typedef struct table {
    const lesson *l;
    const event *asked, *played;
    int n, m, band;
    bool exchanged; // the player's left is the score's right
    cell *cell;     // (n x (2 band + 1))
} table;

static cell *at(const table *t, int i, int j)
{
    int k = j - (int)((double)i * t->m / t->n) + t->band;
    return j < 0 || j >= t->m || k < 0 || k > 2 * t->band
               ? NULL
               : &t->cell[(size_t)i * (size_t)(2 * t->band + 1) + (size_t)k];
}

// of so many events left out at one end
static double beside(int count)
{
    return fmin(GAP * count, JUMP + MORE * count);
}

static void try_from(const table *t, int i, int j, int from_i, int from_j, double left_out,
                     cell *to)
{
    const cell *from = at(t, from_i, from_j);
    if (!from || from->cost + left_out >= to->cost)
        return;
    double asked = t->asked[i].time - t->asked[from_i].time,
           played = t->played[j].time - t->played[from_j].time, due = from->tempo * asked,
           z = (played - due) / (0.03 + 0.08 * due),
           cost = from->cost + left_out + fmin(z * z, LEAP);
    if (cost >= to->cost)
        return;
    *to = (cell){.cost = cost, .tempo = from->tempo, .i = from_i, .j = from_j};
    if (fabs(played / due - 1) < 0.25)
        to->tempo *= 1 + FOLLOW * (played / due - 1);
}

static int hands_differ(const table *t, const event *a, const event *b)
{
    int n = 0;
    for (int h = 0; h < HIMC_HANDS; h++)
        n += t->l->seen[h] && (a->stroke[t->exchanged ? !h : h] < 0) != (b->stroke[h] < 0);
    return n;
}

// where a jump from (i, j) or before it begins at the least cost
static void keep_jump(const table *t, int i, int j, cell *c)
{
    c->jump = c->cost;
    c->from_i = i, c->from_j = j;
    for (int side = 0; side < 2; side++) {
        const cell *before = at(t, i - side, j - !side);
        if (before && i >= side && before->jump + MORE < c->jump) {
            c->jump = before->jump + MORE;
            c->from_i = before->from_i, c->from_j = before->from_j;
        }
    }
}

static void fill(const table *t, int i, int j, double tempo)
{
    cell *c = at(t, i, j);
    if (!c)
        return;
    *c = (cell){.cost = beside(i) + beside(j), .tempo = tempo, .i = -1, .j = -1};
    bool rolled = false;
    for (int a = i - 1; a >= 0 && a >= i - BACK; a--) {
        rolled |= t->asked[a + 1].after_roll;
        int back = rolled ? BACK_ROLL : BACK;
        for (int b = j - 1; b >= 0 && b >= j - back; b--)
            try_from(t, i, j, a, b, GAP * (i - a - 1) + (rolled ? ROLLED : GAP) * (j - b - 1), c);
    }
    const cell *jump = i > 0 ? at(t, i - 1, j - 1) : NULL;
    if (jump && jump->jump + JUMP < c->cost)
        *c = (cell){.cost = jump->jump + JUMP,
                    .tempo = at(t, jump->from_i, jump->from_j)->tempo,
                    .i = jump->from_i,
                    .j = jump->from_j};
    c->cost += OTHER * hands_differ(t, &t->asked[i], &t->played[j]);
    keep_jump(t, i, j, c);
}

// the last cell of the best path in that tempo, and its cost
static double best_path(const table *t, double tempo, int *last_i, int *last_j)
{
    double best = INFINITY;
    for (int i = 0; i < t->n; i++) {
        int middle = (int)((double)i * t->m / t->n);
        for (int j = middle - t->band; j <= middle + t->band; j++) {
            fill(t, i, j, tempo);
            const cell *c = at(t, i, j);
            double cost = c ? c->cost + beside(t->n - 1 - i) + beside(t->m - 1 - j) : INFINITY;
            if (cost < best)
                best = cost, *last_i = i, *last_j = j;
        }
    }
    // chosen: the score's tempo is likelier
    return best + 4 * fabs(log2(tempo)) + (t->exchanged ? EXCHANGED : 0);
}

static void join(lesson *l, int asked, int played)
{
    l->asked[asked].by = played;
    l->played[played].of = asked;
    l->matched++;
}

// the path's pairs: hand by hand, then, if an event has one hand, with the other hand
static void join_path(lesson *l, const table *t, int i, int j)
{
    while (i >= 0) {
        const event *a = &t->asked[i], *p = &t->played[j];
        const cell *c = at(t, i, j);
        bool both = a->stroke[0] >= 0 && a->stroke[1] >= 0;
        for (int h = 0; h < HIMC_HANDS; h++) {
            int own = t->exchanged && !both ? !h : h; // a chord has no exchanged hands
            if (a->stroke[h] >= 0 && p->stroke[own] >= 0)
                join(l, a->stroke[h], p->stroke[own]);
            else if (a->stroke[h] >= 0 && !both && l->seen[h])
                join(l, a->stroke[h], p->stroke[!own]);
        }
        i = c->i, j = c->j;
    }
}

// a chord whose hands fell apart: an asked stroke without a played one, whose event has one
static void join_chords(lesson *l)
{
    for (int i = 0; i < l->asked_count; i++) {
        const lesson_asked *a = &l->asked[i];
        int other = -1, near = -1;
        for (int k = i ? i - 1 : 0; k <= i + 1 && k < l->asked_count; k++)
            if (k != i && fabs(l->asked[k].time - a->time) < TOGETHER && l->asked[k].by >= 0)
                other = l->asked[k].by;
        for (int k = 0; a->by < 0 && other >= 0 && k < l->count; k++) {
            const lesson_played *p = &l->played[k];
            double away = fabs(p->strike.time - l->played[other].strike.time);
            if (p->of < 0 && p->roll < 0 && p->strike.hand == a->hand && away < 0.15)
                near = k; // chosen: less than any stroke of a hand to the next
        }
        if (near >= 0)
            join(l, i, near);
    }
}

static bool make_table(lesson *l, table *t, event *asked, event *played)
{
    for (int i = 0; i < l->asked_count; i++)
        if (l->seen[l->asked[i].hand]) {
            t->n = add_event(asked, t->n, l->asked[i].time, l->asked[i].hand, i);
            for (int k = 0; k < l->rolls && t->n > 1; k++)
                asked[t->n - 1].after_roll |=
                    l->roll[k].from > asked[t->n - 2].time && l->roll[k].from < l->asked[i].time;
        }
    for (int k = 0; k < l->count; k++)
        t->m = add_event(played, t->m, l->played[k].strike.time, l->played[k].strike.hand, k);
    t->band = BAND + abs(t->n - t->m);
    t->cell = malloc(((size_t)t->n + 1) * (size_t)(2 * t->band + 1) * sizeof *t->cell);
    return t->cell;
}

bool lesson_match(lesson *l, himc_error *error)
{
    event *asked = malloc(((size_t)l->asked_count + 1) * sizeof *asked),
          *played = malloc(((size_t)l->count + 1) * sizeof *played);
    table t = {.l = l, .asked = asked, .played = played};
    bool good = asked && played && make_table(l, &t, asked, played);
    double best = INFINITY, tempo = 1;
    int i = -1, j = -1;
    bool exchanged = false, both = l->seen[0] && l->seen[1];
    for (int k = 0; good && t.n > 0 && k <= 2 * TEMPI; k++) { // the last: the best once more
        if (k % TEMPI == 0 && k / TEMPI == 1 && !both)
            k = 2 * TEMPI;
        t.exchanged = k < 2 * TEMPI ? k >= TEMPI : exchanged;
        double tried = k < 2 * TEMPI ? exp2(2.0 * (k % TEMPI) / (TEMPI - 1) - 1) : tempo,
               cost = best_path(&t, tried, &i, &j);
        if (cost < best)
            best = cost, tempo = tried, exchanged = t.exchanged;
    }
    if (good)
        join_path(l, &t, i, j);
    free(asked);
    free(played);
    free(t.cell);
    if (!good)
        return himc_error_set(error, "out of memory");
    join_chords(l);
    for (int k = 0; k < l->asked_count; k++)
        l->due += l->seen[l->asked[k].hand];
    // chosen: with fewer no figure could be trusted
    return (l->matched >= 3 && 2 * l->matched >= l->due) ||
           himc_error_set(error,
                          "%s does not match %s: %d of %d strokes found, expected 3 and half",
                          l->take, l->score, l->matched, l->due);
}
