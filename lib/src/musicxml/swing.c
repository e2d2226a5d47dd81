/// swing.c: eighths or 16ths of which the first of two is longer.
///
/// As notation programs play it: what begins between two beats comes later, so the first has its
/// share of both. A beat with a tuplet or anything finer is played as it is written. Invariant: the
/// order of a part's notes stays.
#include "musicxml/music.h"

#include <math.h>
#include <stdlib.h>

#define SAME 1e-6    // (beats)
#define MOST_PAIR 64 // notes in two units; chosen: bounds the time

/// What holds at a note.
typedef struct swing {
    double unit, share; ///< (beats); of the first of two
    double bar;         ///< the beat of the bar
} swing;

// from the beginning of its two units (beats)
static double within(const swing *w, double beat)
{
    return fmod(beat - w->bar + SAME, 2 * w->unit) - SAME;
}

static double swung(const swing *w, double beat)
{
    bool off = fabs(within(w, beat) - w->unit) < SAME;
    return off ? beat + (2 * w->share - 1) * w->unit : beat;
}

// true if a part has no tuplet and nothing finer than the unit in the two units around a note
static bool is_plain(const music *m, int note, const swing *w)
{
    double begin = m->notes[note].at.beat - within(w, m->notes[note].at.beat), end = 2 * w->unit;
    int first = note, count = 0;
    while (first > 0 && m->notes[first - 1].at.beat > begin - SAME && count++ < MOST_PAIR)
        first--;
    for (; first < m->note_count && m->notes[first].at.beat < begin + end - SAME; first++) {
        const music_note *n = &m->notes[first];
        double in = n->at.beat - begin;
        if (count++ > 2 * MOST_PAIR)
            return false;
        if (n->at.part == m->notes[note].at.part && in > SAME && fabs(in - w->unit) > SAME)
            return false;
    }
    return true;
}

// where a part's note at a beat has gone, else `otherwise`
static double find(const music *m, const double *to, int part, double beat, double otherwise)
{
    int i = himc_music_first(m, beat);
    for (int n = 0; i < m->note_count && n < MOST_PAIR; i++, n++)
        if (m->notes[i].at.beat > beat + SAME)
            break;
        else if (m->notes[i].at.part == part)
            return to[i];
    return otherwise;
}

static int by_beat(const void *a, const void *b)
{
    const music_place *x = a, *y = b;
    return x->beat != y->beat ? (x->beat > y->beat) - (x->beat < y->beat) : x->order - y->order;
}

// new beats of the notes, and of their ends
static void place(const music *m, const midi_file *file, double *to, double *end)
{
    swing w = {.unit = 0.5, .share = 0.5};
    for (int i = 0, sign = 0, bar = 0; i < m->note_count; i++) {
        double beat = m->notes[i].at.beat;
        for (; sign < m->sign_count && m->signs[sign].at.beat < beat + SAME; sign++)
            if (m->signs[sign].meaning == MUSIC_SWING) {
                double whole = floor(m->signs[sign].value);
                w.unit = whole > 0 ? 0.25 : 0.5;
                w.share = m->signs[sign].value - whole;
            }
        while (bar + 1 < file->bar_count && file->bars[bar + 1].beat < beat + SAME)
            bar++;
        // a bar of less than half its metre is a pickup, which ends on a beat
        const midi_bar *b = &file->bars[bar];
        double length = bar + 1 < file->bar_count ? b[1].beat - b->beat : HUGE_VAL;
        w.bar = length < 2.0 * b->beats / b->unit - SAME ? b[1].beat - ceil(length) : b->beat;
        to[i] = w.share != 0.5 && is_plain(m, i, &w) ? swung(&w, beat) : beat;
        end[i] = swung(&w, beat + m->notes[i].length);
    }
}

bool himc_music_swing(music *m, const midi_file *file, himc_error *error)
{
    bool any = false;
    for (int i = 0; i < m->sign_count; i++)
        any |= m->signs[i].meaning == MUSIC_SWING;
    if (!any || m->note_count == 0)
        return true;
    double *to = malloc(2 * (size_t)m->note_count * sizeof *to), *end = to + m->note_count;
    if (!to)
        return himc_error_set(error, "out of memory for %d notes", m->note_count);
    place(m, file, to, end);
    for (int i = 0; i < m->note_count; i++) {
        const music_note *n = &m->notes[i];
        end[i] = find(m, to, n->at.part, n->at.beat + n->length, end[i]);
    }
    for (int i = 0; i < m->sign_count; i++) {
        music_place *at = &m->signs[i].at;
        at->beat = find(m, to, at->part, at->beat, at->beat);
    }
    for (int i = 0; i < m->note_count; i++) {
        music_note *n = &m->notes[i];
        n->length = n->grace ? 0 : fmax(end[i] - to[i], SAME);
        n->at.beat = to[i];
    }
    free(to);
    qsort(m->signs, (size_t)m->sign_count, sizeof *m->signs, by_beat);
    qsort(m->notes, (size_t)m->note_count, sizeof *m->notes, by_beat);
    return true;
}
