/// order.c: the order in which bars are played: repeats, endings, da capo, dal segno, coda.
///
/// As players read them: a repeat goes back to the last opening one, or to where the last one
/// ended; after a jump repeats are not taken, of endings the last is, and `Fine` and `To Coda`
/// count. Invariant: bars are played at most MOST_PLAYED times altogether, whatever the signs say.
#include "musicxml/music.h"

#include "base/array.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define MOST_PLAYED 60000 // bars; chosen: a day of music
#define SAME 1e-6         // (beats)

// where a place is when each bar with a repeat in it has become two; `to`: the new bar of each
static void split_place(const music *m, const int *to, music_place *at)
{
    const music_bar *bar = &m->bars[at->bar];
    bool later = bar->split > 0 && at->beat > bar->split - SAME;
    at->beat -= later ? bar->split : 0;
    at->bar = to[at->bar] + later;
}

static void split_bar(const music_bar *whole, music_bar *half)
{
    music_bar *a = half, *b = half + 1;
    *a = *b = *whole;
    a->length = whole->split;
    b->length -= whole->split;
    a->backward = whole->split_back;
    a->times = 2;
    a->fine = a->to_coda = a->da_capo = a->dal_segno = false;
    b->forward = whole->split_on;
    b->segno = b->coda = false;
    b->endings = 0;
}

static bool split_bars(music *m, himc_error *error)
{
    int count = 0;
    int *to = malloc(((size_t)m->bar_count + 1) * sizeof *to);
    music_bar *made = malloc((2 * (size_t)m->bar_count + 1) * sizeof *made);
    if (!to || !made) {
        free(to);
        free(made);
        return himc_error_set(error, "out of memory for %d bars", m->bar_count);
    }
    for (int k = 0; k < m->bar_count; k++) {
        music_bar *bar = &m->bars[k];
        to[k] = count;
        if (bar->split >= bar->length - SAME) { // at its end
            bar->backward |= bar->split_back;
            bar->split = 0;
        }
        if (bar->split > 0)
            split_bar(bar, &made[count++]);
        else
            made[count] = *bar;
        count++;
    }
    for (int i = 0; i < m->note_count; i++)
        split_place(m, to, &m->notes[i].at);
    for (int i = 0; i < m->sign_count; i++)
        split_place(m, to, &m->signs[i].at);
    free(to);
    free(m->bars);
    m->bars = made;
    m->bar_count = count;
    m->bar_room = count;
    return true;
}

// words beside a repeat say how often
static void spread_times(music *m)
{
    int said = 0;
    for (int i = 0; i < m->bar_count; i++) {
        music_bar *b = &m->bars[i];
        said = b->said ? b->said : b->forward ? 0 : said;
        if (b->backward && b->times == 2 && said > 2)
            b->times = said;
        said = b->backward ? 0 : said;
    }
}

// an ending lasts from where it begins to where it stops, or for one bar
static void spread_endings(music *m)
{
    for (int i = 0; i < m->bar_count; i++) {
        unsigned mask = m->bars[i].endings & ~1u;
        if (!mask) {
            m->bars[i].endings = 0; // a stop without a beginning
            continue;
        }
        int end = i;
        while (end < m->bar_count && !(m->bars[end].endings & 1) &&
               (end == i || !(m->bars[end].endings & ~1u)))
            end++;
        if (end == m->bar_count || !(m->bars[end].endings & 1) ||
            (end > i && m->bars[end].endings & ~1u))
            end = i;
        for (int k = i; k <= end; k++)
            m->bars[k].endings = mask;
        i = end;
    }
}

// the last time of the endings around a bar
static int last_time(const music *m, int bar)
{
    unsigned all = 0;
    int last = 1;
    for (int i = bar; i >= 0 && m->bars[i].endings; i--)
        all |= m->bars[i].endings;
    for (int i = bar; i < m->bar_count && m->bars[i].endings; i++)
        all |= m->bars[i].endings;
    for (int k = 1; k < 32; k++)
        last = all >> k & 1 ? k : last;
    return last;
}

// The coda is at the last of its signs. If no words say where one leaves for it, one leaves at the
// other signs.
static int find_coda(music *m)
{
    int coda = -1;
    bool said = false;
    for (int i = 0; i < m->bar_count; i++) {
        coda = m->bars[i].coda ? i : coda;
        said |= m->bars[i].to_coda;
    }
    for (int i = 0; i < coda && !said; i++)
        m->bars[i].to_coda = m->bars[i].coda;
    return coda;
}

static int find_bar(const music *m, size_t flag)
{
    for (int i = 0; i < m->bar_count; i++)
        if (*(const bool *)((const char *)&m->bars[i] + flag))
            return i;
    return -1;
}

// long: a state machine
static int play_order(music *m, int *played)
{
    int count = 0, begin = 0, time = 1, segno = find_bar(m, offsetof(music_bar, segno)),
        coda = find_coda(m);
    bool jumped = false;
    for (int i = 0; i < m->bar_count && count < MOST_PLAYED;) {
        const music_bar *b = &m->bars[i];
        if (b->forward && i != begin) {
            begin = i;
            time = 1;
        }
        int last = b->endings ? last_time(m, i) : b->times;
        if (b->endings && !(b->endings >> (jumped ? last : time) & 1)) {
            i++;
            continue;
        }
        played[count++] = i;
        bool ends = b->endings && (i + 1 == m->bar_count || !m->bars[i + 1].endings);
        if (jumped && b->fine)
            break;
        if (jumped && b->to_coda && coda > i) {
            begin = i = coda;
            time = 1;
        } else if (b->backward && !jumped && time < (last > b->times ? last : b->times)) {
            time++;
            i = begin;
        } else if ((b->da_capo || (b->dal_segno && segno >= 0)) && !jumped) {
            jumped = true;
            begin = i = b->da_capo ? 0 : segno;
            time = 1;
        } else {
            if (b->backward || ends) {
                begin = i + 1;
                time = 1;
            }
            i++;
        }
    }
    return count;
}

// events begin with their place

static int by_bar(const void *a, const void *b)
{
    const music_place *x = a, *y = b;
    return x->bar != y->bar ? x->bar - y->bar : x->order - y->order;
}

static int by_beat(const void *a, const void *b)
{
    const music_place *x = a, *y = b;
    return x->beat != y->beat ? (x->beat > y->beat) - (x->beat < y->beat) : x->order - y->order;
}

/// The bars as they are played.
typedef struct order {
    int *played;   ///< bars (count)
    double *begin; ///< their beats (count)
    int *first;    ///< scratch: the first event of each bar (bars + 1)
    int count, bars;
} order;

// `*events` of `size` bytes become those that are played, in the order of beats
static bool unfold(const order *o, void *events, int *count, size_t size, himc_error *error)
{
    char **list = events;
    memset(o->first, 0, ((size_t)o->bars + 1) * sizeof *o->first);
    if (*count > 0)
        qsort(*list, (size_t)*count, size, by_bar);
    for (int i = 0; i < *count; i++)
        o->first[((music_place *)(void *)(*list + (size_t)i * size))->bar + 1]++;
    for (int i = 0; i < o->bars; i++)
        o->first[i + 1] += o->first[i];
    size_t all = 0, made_count = 0;
    for (int k = 0; k < o->count; k++)
        all += (size_t)(o->first[o->played[k] + 1] - o->first[o->played[k]]);
    if (all > MUSIC_MADE_MAX)
        return himc_error_set(error, "%zu notes or signs with repeats, expected up to %d", all,
                              MUSIC_MADE_MAX);
    char *made = malloc((all + 1) * size);
    if (!made)
        return himc_error_set(error, "out of memory for %zu notes", all);
    for (int k = 0; k < o->count; k++)
        for (int i = o->first[o->played[k]]; i < o->first[o->played[k] + 1]; i++) {
            music_place *at = (music_place *)(void *)(made + made_count * size);
            memcpy(at, *list + (size_t)i * size, size);
            at->beat += o->begin[k];
            at->order = (int)made_count++;
        }
    if (all > 0)
        qsort(made, all, size, by_beat);
    free(*list);
    *list = made;
    *count = (int)all;
    return true;
}

static bool place_bars(const music *m, order *o, midi_file *file)
{
    file->bars = calloc((size_t)o->count + 1, sizeof *file->bars);
    double beat = 0;
    for (int k = 0; file->bars && k < o->count; k++) {
        const music_bar *b = &m->bars[o->played[k]];
        midi_bar *bar = &file->bars[file->bar_count++];
        memcpy(bar->number, b->number, sizeof bar->number);
        bar->beats = b->beats;
        bar->unit = b->unit;
        bar->beat = o->begin[k] = beat;
        beat += b->length;
    }
    return file->bars != NULL;
}

// where a jump leads back, the tempo returns that was there
static bool add_returns(music *m, const order *o, himc_error *error)
{
    for (int k = 1; k < o->count; k++)
        o->first[o->played[k]] = -1;
    for (int k = 0; k < o->count; k++) {
        int bar = o->played[k], first = k > 0 ? o->first[bar] : -1;
        if (first < 0)
            o->first[bar] = k;
        if (first < 0 || bar == o->played[k - 1] + 1)
            continue;
        if (!himc_array_grow(&m->signs, m->sign_count, &m->sign_room, sizeof *m->signs, error))
            return false;
        m->signs[m->sign_count++] = (music_sign){.at = {o->begin[k], bar, 0, -1},
                                                 .meaning = MUSIC_TEMPO_AGAIN,
                                                 .value = o->begin[first]};
    }
    if (m->sign_count > 0)
        qsort(m->signs, (size_t)m->sign_count, sizeof *m->signs, by_beat);
    return true;
}

bool himc_music_order(music *m, midi_file *file, himc_error *error)
{
    if (!split_bars(m, error))
        return false;
    order o = {.bars = m->bar_count};
    o.played = malloc(MOST_PLAYED * sizeof *o.played);
    o.begin = malloc(MOST_PLAYED * sizeof *o.begin);
    o.first = malloc(((size_t)m->bar_count + 1) * sizeof *o.first);
    bool good = o.played && o.begin && o.first;
    if (good) {
        spread_times(m);
        spread_endings(m);
        o.count = play_order(m, o.played);
        good = place_bars(m, &o, file);
    }
    if (!good)
        himc_error_set(error, "out of memory for %d bars", m->bar_count);
    good = good && unfold(&o, &m->notes, &m->note_count, sizeof *m->notes, error) &&
           unfold(&o, &m->signs, &m->sign_count, sizeof *m->signs, error);
    if (good) {
        m->sign_room = m->sign_count + 1; // as unfolded
        good = add_returns(m, &o, error);
    }
    free(o.played);
    free(o.begin);
    free(o.first);
    return good;
}

int himc_music_first(const music *m, double beat)
{
    int low = 0, high = m->note_count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (m->notes[middle].at.beat < beat - 1e-6)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}
