/// marks.c: from the dynamic of each note to marks and hairpins that a reader takes in.
///
/// A mark stands where the step changes. Three and more strokes that go one way, each by less than
/// MOST_STEP, are a hairpin with a mark at each end; so is a roll that moves by a step. In a bar
/// where strokes of different dynamics sound at once, or go up and down as accents and ghost notes
/// do, one mark holds, of most of its strokes; the others know how far they are beside it.
#include "musicxml/marks.h"

#include "musicxml/spell.h"

#include <math.h>
#include <stdlib.h>

#define LEAST_STROKES 3
#define MOST_STEP 1.5               // from stroke to stroke; chosen: more is subito
#define MOST_REST (2 * MUSIC_TICKS) // the same
#define MOST_TURNS 2                // of the dynamic in a bar that has marks for each; chosen

/// What begins at one time.
typedef struct group {
    long tick;
    int first, end; ///< items
    double level;   ///< of the roll, else of the loudest, in steps
    bool mixed;     ///< of different steps
    bool roll;
} group;

typedef struct marker {
    music_item *items;
    int count, made;
    music_mark *marks;
} marker;

static int step_of(double dynamic)
{
    return (int)lround(7 * dynamic);
}

// in steps; a reader plays an accent one louder
static double level_of(const music_item *i)
{
    return fmax(7 * i->note->way.dynamic - himc_music_is_louder(&i->note->way), 0);
}

static void add(marker *m, long tick, music_mark_kind kind, int value, bool ends)
{
    m->marks[m->made++] = (music_mark){tick, ends, kind, value, NULL};
}

static group group_at(const marker *m, int first)
{
    group g = {.tick = first < m->count ? m->items[first].begin : 0, .first = first};
    int low = 7;
    for (g.end = first; g.end < m->count && m->items[g.end].begin == g.tick; g.end++) {
        bool roll = m->items[g.end].note->way.length > 0;
        double level = level_of(&m->items[g.end]);
        if (roll || !g.roll)
            g.level = roll ? level : fmax(g.level, level);
        low = lround(level) < low ? (int)lround(level) : low;
        g.roll |= roll;
    }
    g.mixed = lround(g.level) > low;
    return g;
}

// the step of most strokes of a bar with one mark, of equally many the louder; -1: it has several
static int mixed_step(const marker *m, int first, long end)
{
    bool mixed = false;
    int turns = 0, strokes[8] = {0}, most = 0;
    double level = -1, way = 0;
    for (group g = group_at(m, first); g.first < m->count && g.tick < end; g = group_at(m, g.end)) {
        double rise = level < 0 || g.roll ? 0 : g.level - level;
        mixed |= g.mixed;
        turns += rise * way < 0;
        way = rise == 0 ? way : rise;
        level = g.level;
        for (int k = g.first; k < g.end; k++)
            strokes[lround(level_of(&m->items[k]))]++;
    }
    for (int step = 0; step < 8; step++)
        most = strokes[step] >= strokes[most] ? step : most;
    return mixed || turns > MOST_TURNS ? most : -1;
}

// the first item of the last group of a hairpin that begins with `from`; that one's own: none
static int hairpin_end(const marker *m, const group *from)
{
    group last = *from;
    int strokes = 1;
    double way = 0;
    while (!last.roll && last.end < m->count) {
        group next = group_at(m, last.end);
        double rise = next.level - last.level;
        if (next.mixed || rise == 0 || rise * way < 0 || fabs(rise) > MOST_STEP ||
            next.tick - last.tick > MOST_REST)
            break;
        way = rise;
        last = next;
        strokes++;
    }
    bool moves = lround(last.level) != lround(from->level);
    return strokes >= LEAST_STROKES && moves ? last.first : from->first;
}

static void add_roll(marker *m, const music_item *i)
{
    const midi_way *way = &i->note->way;
    int from = step_of(way->dynamic), to = step_of(way->last_dynamic);
    if (way->length <= 0 || from == to)
        return;
    add(m, i->begin, MARK_WEDGE, to > from ? 1 : -1, false);
    add(m, i->end, MARK_STOP, 0, true);
    add(m, i->end, MARK_DYNAMIC, to, true);
}

static int by_tick(const void *a, const void *b)
{
    const music_mark *x = a, *y = b;
    if (x->tick != y->tick)
        return x->tick < y->tick ? -1 : 1;
    if (x->ends != y->ends)
        return y->ends - x->ends;
    return x->kind != y->kind ? (x->kind > y->kind) - (x->kind < y->kind) : (x > y) - (x < y);
}

long himc_music_bar_end(const midi_file *file, const midi_bar **bar, long tick)
{
    while (*bar + 1 < file->bars + file->bar_count && lround((*bar)[1].beat * MUSIC_TICKS) <= tick)
        ++*bar;
    return lround((*bar)[1].beat * MUSIC_TICKS);
}

int himc_music_marks(music_item *items, int count, const midi_file *file, music_mark *marks)
{
    marker m = {.items = items, .count = count, .marks = marks};
    const midi_bar *bar = file->bars;
    int until = -1, mixed = -1; // the first item of a hairpin's last group; of a bar
    long bar_end = 0;
    for (group g = group_at(&m, 0); g.first < count; g = group_at(&m, g.end)) {
        if (g.tick >= bar_end) {
            bar_end = himc_music_bar_end(file, &bar, g.tick);
            mixed = mixed_step(&m, g.first, bar_end);
        }
        bool inside = g.first < until, ends = g.first == until;
        int last = inside || mixed >= 0 ? g.first : hairpin_end(&m, &g);
        if (ends)
            add(&m, g.tick, MARK_STOP, 0, true);
        if (!inside)
            add(&m, g.tick, MARK_DYNAMIC, mixed >= 0 && !g.roll ? mixed : (int)lround(g.level),
                false);
        if (last > g.first) {
            add(&m, g.tick, MARK_WEDGE, group_at(&m, last).level > g.level ? 1 : -1, false);
            until = last;
        }
        for (int k = g.first; k < g.end; k++) {
            bool beside = mixed >= 0 && !g.roll && !inside;
            items[k].beside = beside ? (int)lround(level_of(&items[k])) - mixed : 0;
            m.marks[m.made++] = (music_mark){g.tick, false, MARK_WAY, 0, &items[k].note->way};
            add_roll(&m, &items[k]);
        }
    }
    qsort(marks, (size_t)m.made, sizeof *marks, by_tick);
    return m.made;
}
