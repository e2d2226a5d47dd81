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
/// grid of values and follows the played intervals along the path. Rolls have no events, as their
/// number of strokes is the player's: a played event is left out for nearly nothing where its place
/// between the two matched ones is within a roll, also before the first and after the last.
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
#define ENDS 18.0 // in place of JUMP: a take begins late or ends early rather than it leaps
#define EXCHANGED 8.0
#define ROLLED 0.02 // for a played event within a roll
#define OTHER 3.0
#define BACK 4 // steps back: up to BACK - 1 events left out in a row; in a roll ...
#define BACK_ROLL 400
#define SLACK 0.07      // a roll begins earlier, ends later (s) ...
#define SLACK_PART 0.08 // ... and so much of the time from the matched stroke
#define FOLLOW 0.15     // share of a new interval in the tempo
#define TEMPI 29        // from half to twice the score's
#define BAND 60         // events beside the diagonal

typedef struct event {
    double time;
    int stroke[HIMC_HANDS]; // index, or -1
    int rolls;              // that begin before it
} event;

static int add_event(event *e, int count, double time, himc_hand hand, int stroke)
{
    event *last = count ? &e[count - 1] : NULL;
    if (last && time - last->time < TOGETHER && last->stroke[hand] < 0) {
        last->stroke[hand] = stroke;
        return count;
    }
    e[count] = (event){time, {-1, -1}, 0};
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
    return fmin(GAP * count, ENDS + MORE * count);
}

// how many played events from `low` on, before `high`, are earlier than that
static int earlier(const table *t, int low, int high, double time)
{
    int from = low;
    while (low < high) {
        int k = (low + high) / 2;
        if (t->played[k].time < time)
            low = k + 1;
        else
            high = k;
    }
    return low - from;
}

// a stretch between two matched events: asked times become played ones
typedef struct stretch {
    double asked, played, slope; // at its beginning, or where it is open there, at its end
    double end;                  // asked; INFINITY or -INFINITY: one end is open
    int first, last;             // rolls
} stretch;

// of the played events from `low` on, before `high`, those in no roll; `cost` has the rolls'
static int out_of_rolls(const table *t, const stretch *s, int low, int high, double *cost)
{
    int in = 0;
    double done = -INFINITY;
    *cost = 0;
    for (int k = s->first; k < s->last; k++) {
        const lesson_roll *r = &t->l->roll[k];
        double from = r->from - s->asked, to = r->to - s->asked;
        double begins = SLACK + SLACK_PART * fmin(fabs(from), fabs(s->end - r->from)),
               ends = SLACK + SLACK_PART * fmin(fabs(to), fabs(s->end - r->to));
        from = fmax(done, s->played + s->slope * from - begins);
        done = fmax(done, s->played + s->slope * to + ends);
        int here = earlier(t, low, high, done) - earlier(t, low, high, from);
        in += here;
        *cost += here ? ROLLED * here : GAP;
    }
    return high - low - in;
}

// of the events before the first matched ones, or after the last
static double at_an_end(const table *t, int i, int j, double tempo, bool last)
{
    const stretch s = {t->asked[i].time,
                       t->played[j].time,
                       tempo,
                       last ? INFINITY : -INFINITY,
                       last ? t->asked[i].rolls : 0,
                       last ? t->l->rolls : t->asked[i].rolls};
    double rolls;
    int out = last ? out_of_rolls(t, &s, j + 1, t->m, &rolls) : out_of_rolls(t, &s, 0, j, &rolls);
    return beside(last ? t->n - 1 - i : i) + beside(out) + fmin(rolls, JUMP);
}

static void try_from(const table *t, int i, int j, int from_i, int from_j, cell *to)
{
    const event *a = t->asked, *p = t->played;
    const cell *from = at(t, from_i, from_j);
    double cost = GAP * (i - from_i - 1), rolls = 0;
    bool rolled = a[i].rolls > a[from_i].rolls;
    if (!from || from->cost + cost + (rolled ? 0 : GAP * (j - from_j - 1)) >= to->cost)
        return;
    double asked = a[i].time - a[from_i].time, played = p[j].time - p[from_j].time,
           due = from->tempo * asked, z = (played - due) / (0.03 + 0.08 * due);
    cost += from->cost + fmin(z * z, LEAP);
    if (cost >= to->cost)
        return;
    const stretch s = {a[from_i].time, p[from_j].time,  played / asked,
                       a[i].time,      a[from_i].rolls, a[i].rolls};
    cost += GAP * out_of_rolls(t, &s, from_j + 1, j, &rolls) + rolls;
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
    *c = (cell){.cost = at_an_end(t, i, j, tempo, false), .tempo = tempo, .i = -1, .j = -1};
    for (int a = i - 1; a >= 0 && a >= i - BACK; a--) {
        int back = t->asked[i].rolls > t->asked[a].rolls ? BACK_ROLL : BACK;
        for (int b = j - 1; b >= 0 && b >= j - back; b--)
            try_from(t, i, j, a, b, c);
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

// the last cell of the best path in that tempo, and its cost; it gives up when no path can be
// better than `least`
static double best_path(const table *t, double tempo, double least, int *last_i, int *last_j)
{
    // chosen: the score's tempo is likelier
    double extra = 4 * fabs(log2(tempo)) + (t->exchanged ? EXCHANGED : 0), best = INFINITY;
    double row[BACK] = {0}; // least costs of the last rows, from which all later ones come
    for (int i = 0; i < t->n; i++) {
        int middle = (int)((double)i * t->m / t->n);
        double *here = &row[i % BACK], most = beside(i + 1);
        *here = INFINITY;
        for (int j = middle - t->band; j <= middle + t->band; j++) {
            fill(t, i, j, tempo);
            const cell *c = at(t, i, j);
            if (!c)
                continue;
            double cost = c->cost < best ? c->cost + at_an_end(t, i, j, c->tempo, true) : INFINITY;
            *here = fmin(*here, fmin(c->cost, c->jump + JUMP));
            if (cost < best)
                best = cost, *last_i = i, *last_j = j;
        }
        for (int k = 0; k < BACK; k++)
            most = fmin(most, row[k]);
        if (most >= fmin(best, least - extra))
            break;
    }
    return best + extra;
}

static void join(lesson *l, int asked, int played)
{
    l->asked[asked].by = played;
    l->played[played].of = asked;
    l->matched++;
}

// true if the stroke that closes a roll is missing: what has been taken for it follows the roll's
// strokes as these follow each other, well before its time after the stroke before and between
// that and the next
static bool is_rolled(const table *t, int i, int j, int next_i, int next_j)
{
    const event *a = t->asked, *p = t->played;
    const cell *c = at(t, i, j);
    bool closes = false;
    for (int k = c->i < 0 ? a[i].rolls : a[c->i].rolls; k < a[i].rolls; k++)
        closes |= fabs(t->l->roll[k].to - a[i].time) < SLACK;
    if (!closes || j - c->j < 4)
        return false;
    double interval = 0.5 * (p[j - 1].time - p[j - 3].time), asked = a[i].time - a[c->i].time,
           played = p[j].time - p[c->j].time, early = at(t, c->i, c->j)->tempo * asked - played;
    if (next_i >= 0)
        early =
            fmin(early, (p[next_j].time - p[c->j].time) * asked / (a[next_i].time - a[c->i].time) -
                            played);
    return early > 0.6 * interval && p[j].time - p[j - 1].time < 1.4 * interval;
}

// the path's pairs: hand by hand, then, if an event has one hand, with the other hand
static void join_path(lesson *l, const table *t, int i, int j)
{
    int next_i = -1, next_j = -1;
    while (i >= 0) {
        const event *a = &t->asked[i], *p = &t->played[j];
        const cell *c = at(t, i, j);
        bool rolled = is_rolled(t, i, j, next_i, next_j);
        next_i = i, next_j = j;
        if (rolled) {
            i = c->i, j = c->j;
            continue;
        }
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
    int rolls = 0;
    for (int i = 0; i < l->asked_count; i++)
        if (l->seen[l->asked[i].hand]) {
            t->n = add_event(asked, t->n, l->asked[i].time, l->asked[i].hand, i);
            for (; rolls < l->rolls && l->roll[rolls].from < l->asked[i].time - 0.01;)
                rolls++;
            asked[t->n - 1].rolls = rolls;
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
        if (k == TEMPI && !both)
            k = 2 * TEMPI;
        int away = (k % TEMPI + 1) / 2; // from the score's tempo outwards
        double tried = exp2((k % TEMPI % 2 ? 2.0 : -2.0) * away / (TEMPI - 1));
        bool again = k == 2 * TEMPI;
        t.exchanged = again ? exchanged : k >= TEMPI;
        double cost = best_path(&t, again ? tempo : tried, again ? INFINITY : best, &i, &j);
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
    // chosen: with fewer no figure could be trusted; a part of the score is played as a whole
    return (l->matched >= 3 && 2 * l->matched >= l->due) ||
           (l->matched >= 8 && 10 * l->matched >= 9 * l->count) ||
           himc_error_set(
               error,
               "%s does not match %s: %d of %d strokes found, expected at least 3 and at "
               "least half of them, or nearly all that the take has",
               l->take, l->score, l->matched, l->due);
}
