/// spell.c: from times to note values: dots, ties, tuplets and beams, as engravers write them.
///
/// A bar is parts of four quarter notes, two, one, or of three (units of 3/4, eighths of 6/8). Such
/// a part, but for thirds of three, is halved until a part of it is one note, or four units of
/// which its notes have 1 to 4 each (dotted notes and syncopations, Gould 2011), or a tuplet. A
/// beat in which that is not possible keeps its exact times, with rough values. Rests do not cross
/// the middle of a part. Beams join what is in one beat or one tuplet.
#include "musicxml/spell.h"

#include <stdlib.h>
#include <string.h>

#define BEAT ((long)MUSIC_TICKS)
#define SHORTEST (BEAT / 8) // that is halved no more: with its fourth a 128th
#define NEAR (BEAT / 700)   // of the grid; less than a test of equal music allows
#define EIGHTH 3            // the first type with a beam

typedef struct speller {
    const music_segment *segment;
    int segments;
    music_piece *piece;
    int count;
} speller;

long himc_music_snap(long tick)
{
    static const int parts[] = {32, 24, 5, 7};
    for (int i = 0; i < 4; i++) {
        long unit = BEAT / parts[i], near = (tick + unit / 2) / unit * unit;
        if (labs(tick - near) <= NEAR)
            return near;
    }
    return tick;
}

// the first segment that goes on after a time
static const music_segment *segment_at(const speller *p, long tick)
{
    const music_segment *s = p->segment;
    while (s->to <= tick)
        s++;
    return s;
}

// true if all that begins inside a part of the bar does so on multiples of a unit
static bool fits(const speller *p, long begin, long length, long unit)
{
    for (const music_segment *s = segment_at(p, begin); s->to < begin + length; s++)
        if ((s->to - begin) % unit != 0)
            return false;
    return true;
}

static int type_of(long length)
{
    int type = 0;
    while (length < 4 * BEAT >> type)
        type++;
    return type;
}

// the value whose length is nearest, as a ratio
static int near_type(long length)
{
    int type = 2;
    while (type < 7 && 2 * length * length < (4 * BEAT >> type) * (4 * BEAT >> type))
        type++;
    return type;
}

static void put(speller *p, const music_segment *s, music_piece piece)
{
    bool again = piece.from > s->from;
    piece.note = again && !s->held ? -1 : s->note;
    p->piece[p->count++] = piece;
}

// pieces of whole units of that type, of one segment up to a time
static void put_units(speller *p, const music_segment *s, long from, long to, long unit, int type,
                      music_piece like)
{
    while (from < to) {
        long units = (to - from) / unit;
        int up = units >= 4 ? 2 : units >= 2 ? 1 : 0;
        bool dot = up > 0 && units >= 3L << (up - 1);
        like.from = from;
        like.to = from + (dot ? 3L << (up - 1) : 1L << up) * unit;
        like.type = type - up;
        like.dot = dot;
        put(p, s, like);
        from = like.to;
    }
}

// notes of one to four units
static void put_plain(speller *p, long begin, long length)
{
    const long end = begin + length, middle = begin + length / 2, unit = length / 4;
    const int type = type_of(unit);
    const music_piece like = {0};
    long at = begin;
    for (const music_segment *s = segment_at(p, begin); at < end; s++) {
        long to = s->to < end ? s->to : end;
        if (s->note < 0 && at < middle && to > middle && at + length != to) {
            put_units(p, s, at, middle, unit, type, like);
            at = middle;
        }
        put_units(p, s, at, to, unit, type, like);
        at = to;
    }
}

static void put_tuplet(speller *p, long begin, long length, int actual)
{
    const int normal = actual == 3 ? 2 : 4, first = p->count;
    const music_piece like = {.actual = actual, .normal = normal};
    long at = begin;
    for (const music_segment *s = segment_at(p, begin); at < begin + length; s++) {
        long to = s->to < begin + length ? s->to : begin + length;
        put_units(p, s, at, to, length / actual, type_of(length / normal), like);
        at = to;
    }
    p->piece[first].first = p->piece[p->count - 1].last = true;
}

// as it is, with values that are near
static void put_rough(speller *p, long begin, long length, int before)
{
    const music_segment *s = segment_at(p, begin);
    p->count = before;
    for (long at = begin; at < begin + length; s++) {
        long to = s->to < begin + length ? s->to : begin + length;
        put(p, s, (music_piece){.from = at, .to = to, .type = near_type(to - at), .rough = true});
        at = to;
    }
}

// false if it has no values
static bool spell(speller *p, long begin, long length)
{
    static const int tuplets[] = {3, 5, 6, 7};
    const music_segment *s = segment_at(p, begin);
    if (s->to >= begin + length || fits(p, begin, length, length / 4)) {
        put_plain(p, begin, length);
        return true;
    }
    bool halves = fits(p, begin, length, length / 2);
    for (const music_segment *k = s; k->to < begin + length; k++)
        halves |= k->to == begin + length / 2;
    for (int i = 0; i < 4 && length <= 4 * BEAT; i++)
        if (fits(p, begin, length, length / tuplets[i]) && !(halves && tuplets[i] == 6)) {
            put_tuplet(p, begin, length, tuplets[i]);
            return true;
        }
    if (length <= SHORTEST)
        return false;
    int before = p->count;
    if (spell(p, begin, length / 2) && spell(p, begin + length / 2, length / 2))
        return true;
    if (length == BEAT)
        put_rough(p, begin, length, before);
    return length == BEAT;
}

static void spell_part(speller *p, long begin, long length)
{
    int before = p->count;
    if (!spell(p, begin, length))
        put_rough(p, begin, length, before);
}

// a part of three units, whose length is that of a dotted value
static void spell_three(speller *p, long begin, long length)
{
    const music_segment *s = segment_at(p, begin);
    const long unit = length / 3, end = begin + length;
    if (s->to < end && !fits(p, begin, length, unit)) {
        for (long at = begin; at < end; at += unit)
            spell_part(p, at, unit);
        return;
    }
    for (long at = begin; at < end; s++) {
        long to = s->to < end ? s->to : end;
        bool rest = s->note < 0 && to - at < length;
        while (rest && at + unit < to) { // each beat has its own
            put_units(p, s, at, at + unit, unit, type_of(unit), (music_piece){0});
            at += unit;
        }
        put_units(p, s, at, to, unit, type_of(unit), (music_piece){0});
        at = to;
    }
}

static bool is_beamed(const music_piece *p)
{
    return p->note >= 0 && p->type >= EIGHTH;
}

static void add_beams(music_piece *piece, int count, long beat)
{
    const long begin = piece[0].from;
    for (int i = 0; i < count;) {
        int end = i + 1;
        while (end < count && is_beamed(&piece[i]) && is_beamed(&piece[end]) && !piece[end].first &&
               !piece[end - 1].last &&
               (piece[i].actual > 0 ||
                (piece[end].from - begin) / beat == (piece[i].from - begin) / beat))
            end++;
        for (int k = i; k < end && end - i > 1; k++)
            for (int level = 0; level < piece[k].type - EIGHTH + 1 && level < 6; level++) {
                bool before = k > i && piece[k - 1].type - EIGHTH >= level,
                     after = k + 1 < end && piece[k + 1].type - EIGHTH >= level;
                piece[k].beam[level] = before && after ? "continue"
                                       : after         ? "begin"
                                       : before        ? "end"
                                       : k + 1 < end   ? "forward hook"
                                                       : "backward hook";
            }
        i = end;
    }
}

// the next part of the bar: `three` of one unit, or halves of halves
static long part_at(const speller *p, long at, long end, long beat, bool *three)
{
    long length = 4 * BEAT;
    *three = beat != BEAT && at + beat <= end;
    if (*three) {
        for (length = beat; at + 2 * length <= end && segment_at(p, at)->to >= at + 2 * length;)
            length *= 2;
        return length;
    }
    while (length > end - at && length > SHORTEST)
        length /= 2;
    *three = 2 * (end - at) == 3 * length;
    return *three || length > end - at ? end - at : length;
}

int himc_music_spell(const music_segment *segments, int count, long beat, music_piece *pieces)
{
    speller p = {segments, count, pieces, 0};
    const long end = segments[count - 1].to;
    for (long at = segments[0].from, length; at < end; at += length) {
        bool three;
        length = part_at(&p, at, end, beat, &three);
        if (three)
            spell_three(&p, at, length);
        else if (length < SHORTEST)
            put_rough(&p, at, length, p.count);
        else
            spell_part(&p, at, length);
    }
    add_beams(pieces, p.count, beat);
    return p.count;
}
