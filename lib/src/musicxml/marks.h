/// marks.h: the dynamics and hairpins of a part, as they are printed.
#ifndef HIMC_MUSICXML_MARKS_H
#define HIMC_MUSICXML_MARKS_H

#include "midi/smf.h"

/// A note of a part.
typedef struct music_item {
    const midi_note *note;
    long begin, end; ///< (ticks)
    int voice;
    bool chord; ///< one more note of the one before in its voice
    int beside; ///< of a mixed bar: steps above the mark that holds there
} music_item;

/// Of one time, in this order; of rolls that end before them.
typedef enum music_mark_kind { MARK_STOP, MARK_DYNAMIC, MARK_WAY, MARK_WEDGE } music_mark_kind;

typedef struct music_mark {
    long tick;
    bool ends; ///< it is at the end of what sounded before
    music_mark_kind kind;
    int value;           ///< of a dynamic its step, 0 .. 7; of a hairpin 1 or -1
    const midi_way *way; ///< of MARK_WAY: what words may say
} music_mark;

/// True of an accent that is read a step louder than the mark there.
static inline bool himc_music_is_louder(const midi_way *way)
{
    return way->nuance == HIMC_ACCENT && way->length <= 0;
}

#define MUSIC_MARKS_OF(items) (8 * (items)) ///< at most

/// Writes the marks of a part's items (`count`), which are in the order of time and get what they
/// are `beside` them; returns how many.
int himc_music_marks(music_item *items, int count, const midi_file *file, music_mark *marks);
/// The end of the bar (ticks) that a time is in; `bar`, from the first on, goes on to it.
long himc_music_bar_end(const midi_file *file, const midi_bar **bar, long tick);

#endif
