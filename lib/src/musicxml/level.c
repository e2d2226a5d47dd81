/// level.c: the dynamics of a part in time, from its marks and hairpins.
///
/// A hairpin leads to the mark at its end, an fp or sfz is an f; without one it goes a step, two if
/// it is longer than HAIRPIN. A word (cresc.) leads to the next mark within LONGEST_WORD, else as a
/// hairpin of HAIRPIN; al niente leads to nothing where the notes from there on end. A part that
/// says nothing is mf. Signs hold for all voices and staves, unless two have different dynamics at
/// one time. Invariant: the beats of the points never decrease.
#include "musicxml/music.h"

#include "base/array.h"

#include <math.h>

#define STEP (1.0 / 7)
#define USUAL (4 * STEP)  // mf
#define FORTE (5 * STEP)  // of fp, sfz
#define HAIRPIN 4.0       // (beats)
#define LONGEST_WORD 32.0 // (beats)
#define NIENTE (-7)       // steps
#define REACH 1.0         // a mark so much after a hairpin is its end (beats)
#define LOUD_TIME 0.3     // of fp, before the p (s)
#define SAME 1e-6         // (beats)
#define NEAR 50           // signs of one beat that are compared; chosen: bounds the time

typedef struct line {
    music_level *levels;
    int count, room;
    double now;  ///< dynamic
    double from; ///< beat of the open hairpin; below 0: none
    double way;  ///< its direction, in steps: to nothing -7
    double end;  ///< of a word that no mark ends; else below 0
    double more; ///< beat of the last `più f`
    bool failed;
} line;

static void add(line *l, double beat, double dynamic)
{
    himc_error unused;
    dynamic = fmin(fmax(dynamic, 0), 1);
    if (l->count > 0)
        beat = fmax(beat, l->levels[l->count - 1].beat);
    if (!himc_array_grow(&l->levels, l->count, &l->room, sizeof *l->levels, &unused)) {
        l->failed = true;
        return;
    }
    l->levels[l->count++] = (music_level){beat, dynamic};
    l->now = dynamic;
}

static bool is_of(const music_sign *s, int part, int lane)
{
    int staff = s->lane / 100, voice = s->lane % 100;
    return s->at.part == part && s->meaning <= MUSIC_GROWING &&
           (lane == MUSIC_ALL_LANES || ((!staff || lane < 100 || staff == lane / 100) &&
                                        (!voice || lane % 100 == 0 || voice == lane % 100)));
}

bool himc_music_apart(const music *m, int part, int lane)
{
    for (int i = 1; i < m->sign_count; i++) {
        const music_sign *a = &m->signs[i];
        for (int k = i - 1; k >= 0 && i - k <= NEAR && a->at.beat < m->signs[k].at.beat + SAME;
             k--) {
            const music_sign *b = &m->signs[k];
            if (a->meaning == MUSIC_DYNAMIC && b->meaning == MUSIC_DYNAMIC && b->at.part == part &&
                a->at.part == part && a->value != b->value &&
                is_of(a, part, lane) != is_of(b, part, lane))
                return true;
        }
    }
    return false;
}

static double mark_value(const music_sign *s)
{
    return s->meaning == MUSIC_DYNAMIC ? s->value : s->value >= 2 ? floor(s->value / 2) / 7 : FORTE;
}

// the next mark of the part behind sign `i`, up to `until`, an accent only if there is no other one
// at its beat; -1: none
static int next_mark(const music *m, int part, int lane, int i, double from, double until,
                     music_meaning last)
{
    const int most = i + 2000; // signs; chosen: bounds the time
    int found = -1;
    for (int k = i + 1; k < m->sign_count && k < most && m->signs[k].at.beat <= until + SAME; k++) {
        const music_sign *s = &m->signs[k];
        bool mark =
            s->meaning == MUSIC_DYNAMIC || s->meaning == MUSIC_FORTEPIANO || s->meaning == last;
        if (found >= 0 && s->at.beat > m->signs[found].at.beat + SAME)
            break;
        if (!mark || s->at.beat < from - SAME || !is_of(s, part, lane))
            continue;
        if (s->meaning == MUSIC_DYNAMIC)
            return k;
        found = found < 0 ? k : found;
    }
    return found;
}

static bool is_in(const music_note *n, int part, int lane)
{
    return n->at.part == part && !n->grace && n->length > 0 &&
           (lane == MUSIC_ALL_LANES || n->lane == lane ||
            (lane % 100 == 0 && n->lane / 100 == lane / 100));
}

// where the notes from a beat on, without a rest between them, have come to nothing: the end of a
// roll, else the last stroke
static double find_nothing(const music *m, int part, int lane, double beat)
{
    double end = beat, last = beat;
    int first = himc_music_first(m, beat - LONGEST_WORD);
    for (int i = first; i < m->note_count && m->notes[i].at.beat < beat + LONGEST_WORD; i++) {
        const music_note *n = &m->notes[i];
        double off = n->at.beat + n->length;
        if (!is_in(n, part, lane) || off < beat + SAME)
            continue;
        if (n->at.beat > end + SAME && last > beat)
            break;
        end = fmax(end, off);
        last = fmax(last, n->rolled > 0 ? n->at.beat + n->rolled : n->at.beat);
    }
    return last > beat + SAME ? last : fmax(end, beat + HAIRPIN);
}

// where the p of an fp begins: with the next stroke, or within a roll
static double soft_from(const music *m, int part, int lane, double beat, double until)
{
    int i = himc_music_first(m, beat + 2 * SAME);
    while (i < m->note_count && m->notes[i].at.beat < until && !is_in(&m->notes[i], part, lane))
        i++;
    return i < m->note_count ? fmin(m->notes[i].at.beat, until) : until;
}

static void close_hairpin(line *l, const music *m, int part, int lane, int i, double beat)
{
    double steps = beat - l->from > HAIRPIN ? 2 * STEP : STEP, to = l->now + l->way * steps;
    int mark = next_mark(m, part, lane, i, beat, beat + REACH, MUSIC_ATTACK);
    if (mark >= 0 && l->way > NIENTE && (mark_value(&m->signs[mark]) - l->now) * l->way > 0)
        to = mark_value(&m->signs[mark]);
    add(l, beat, to);
    l->from = -1;
}

static void open_hairpin(line *l, double beat, double way)
{
    add(l, beat, l->now);
    l->from = beat;
    l->way = way;
    l->end = -1;
}

// of a word that has just begun to act
static void find_end(line *l, const music *m, int part, int lane, int i)
{
    double beat = m->signs[i].at.beat;
    int mark = next_mark(m, part, lane, i, beat, beat + LONGEST_WORD, MUSIC_FORTEPIANO);
    const music_sign *s = mark < 0 ? NULL : &m->signs[mark];
    double nothing = l->way <= NIENTE ? find_nothing(m, part, lane, beat) : beat + HAIRPIN;
    l->end = !s                                         ? nothing
             : (mark_value(s) - l->now) * l->way > 0    ? -1 // it leads there
             : l->way <= NIENTE && nothing < s->at.beat ? nothing
                                                        : s->at.beat;
}

static void take_sign(line *l, const music *m, int part, int lane, int i, double second)
{
    const music_sign *s = &m->signs[i];
    double beat = s->at.beat;
    if (l->from >= 0 && l->end >= 0 && beat >= l->end - SAME)
        close_hairpin(l, m, part, lane, i - 1, l->end);
    bool open = l->from >= 0, begins = open && beat < l->from + SAME;
    if (s->meaning == MUSIC_DYNAMIC || s->meaning == MUSIC_FORTEPIANO) {
        bool leads = (mark_value(s) - l->now) * l->way > 0;
        if (open && !begins && !leads) // subito
            close_hairpin(l, m, part, lane, i, beat);
        else if (!open || begins)
            add(l, beat, l->now);
        if (s->meaning == MUSIC_FORTEPIANO) {
            add(l, beat, mark_value(s));
            beat = soft_from(m, part, lane, beat, beat + LOUD_TIME * second);
        }
        add(l, beat, fmod(s->value, 2));
        l->from = begins ? l->from : -1;
    } else if (s->meaning == MUSIC_LOUDER && beat > l->more + SAME) { // not of each staff
        if (open && !begins)
            close_hairpin(l, m, part, lane, i, beat);
        add(l, beat, l->now);
        add(l, beat, l->now + s->value * STEP);
        l->more = beat;
    } else if (s->meaning == MUSIC_WEDGE) {
        if (open && !begins)
            close_hairpin(l, m, part, lane, i, beat);
        if (s->value != 0)
            open_hairpin(l, beat, s->value);
    } else if (s->meaning == MUSIC_GROWING && !open) {
        open_hairpin(l, beat, s->value);
        find_end(l, m, part, lane, i);
    } else if (s->meaning == MUSIC_GROWING && s->value * l->way > 0) {
        l->way = s->value; // dim. al niente
        find_end(l, m, part, lane, i);
    }
}

music_level *himc_music_levels(const music *m, int part, int lane, double second, int *count)
{
    line l = {.now = USUAL, .from = -1, .end = -1, .more = -1};
    add(&l, 0, USUAL);
    for (int i = 0; i < m->sign_count; i++)
        if (is_of(&m->signs[i], part, lane))
            take_sign(&l, m, part, lane, i, second);
    if (l.from >= 0)
        close_hairpin(&l, m, part, lane, m->sign_count, l.end >= 0 ? l.end : l.from + HAIRPIN);
    if (l.failed) {
        free(l.levels);
        return NULL;
    }
    *count = l.count;
    return l.levels;
}

double himc_music_level(const music_level *levels, int count, double beat)
{
    int low = 0, high = count; // the last point at or before the beat
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (levels[middle].beat <= beat + SAME)
            low = middle;
        else
            high = middle;
    }
    if (low + 1 == count || levels[low + 1].beat <= levels[low].beat)
        return levels[low].dynamic;
    double share = (beat - levels[low].beat) / (levels[low + 1].beat - levels[low].beat);
    share = fmin(fmax(share, 0), 1);
    return levels[low].dynamic + share * (levels[low + 1].dynamic - levels[low].dynamic);
}
