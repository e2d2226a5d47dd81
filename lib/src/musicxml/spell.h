/// spell.h: the note values of a bar.
#ifndef HIMC_MUSICXML_SPELL_H
#define HIMC_MUSICXML_SPELL_H

#include <stdbool.h>

#define MUSIC_TICKS 6720 ///< of a quarter note: a multiple of 64, 3, 5 and 7

/// What a voice has from one time to another; together they fill the bar.
typedef struct music_segment {
    long from, to; ///< (ticks)
    int note;      ///< its index; -1: a rest
    bool held;     ///< it is tied where it needs two values; else the second is a rest
} music_segment;

/// A note or a rest of one value.
typedef struct music_piece {
    long from, to;       ///< (ticks)
    int note;            ///< as above
    int type;            ///< 0 whole, 1 half, 2 quarter ..
    bool rough;          ///< no value is so long; this is near
    bool dot;            ///< half as long again
    int actual, normal;  ///< of a tuplet: so many in the time of so many; 0: none
    bool first, last;    ///< of the tuplet
    const char *beam[6]; ///< "begin" and so on, from the first; NULL: none
} music_piece;

/// At most: 8 parts of a quarter note with 7 units each, and what has rough values.
#define MUSIC_PIECES_OF(segments, quarters) (2 * (segments) + 64 * (size_t)(quarters) + 256)

/// The time (ticks) on the grid of notes and tuplets that is meant, if one is near.
long himc_music_snap(long tick);

/// Writes the pieces of the segments (`count`) of a bar; returns how many. `beat`: a quarter note,
/// else three parts, as in 6/8 (ticks). `pieces` has room for MUSIC_PIECES_OF(count, its length).
int himc_music_spell(const music_segment *segments, int count, long beat, music_piece *pieces);

#endif
