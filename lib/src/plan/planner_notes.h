/// planner_notes.h: lines for the user, and counts of strokes that are not played as written.
#ifndef HIMC_PLANNER_NOTES_H
#define HIMC_PLANNER_NOTES_H

#include "plan/planner.h"

#define PLANNER_NOTES 32   ///< kept until they are taken
#define PLANNER_MISSES 256 ///< the same; chosen: more than are given up between two steps

typedef enum planner_kind {
    PLANNER_HURRIED,
    PLANNER_HURRIED_ROLL,
    PLANNER_GIVEN_UP,
    PLANNER_DELAYED,
    PLANNER_CROWDED,
    PLANNER_OUTSIDE,
    PLANNER_DROPPED,
    PLANNER_OTHER_HAND,
    PLANNER_OVERLAP,
    PLANNER_NEXT_ROUND,
    PLANNER_NEXT_PLAY,
    PLANNER_REASSIGNED, ///< from here on all strokes are played
    PLANNER_LATE,
    PLANNER_MEET,
    PLANNER_SOFTER,
    PLANNER_KINDS
} planner_kind;

typedef struct planner_notes {
    himc_planner_note line[PLANNER_NOTES]; ///< a ring
    int first, count, lost;
    bool silent;                            ///< nothing is said or counted
    bool said[PLANNER_KINDS];               ///< since play
    int strokes[PLANNER_KINDS];             ///< counted since play
    int given_up;                           ///< strokes given up since himc_planner_given_up
    himc_planner_miss miss[PLANNER_MISSES]; ///< a ring
    int first_miss, misses;
    double spent;               ///< lines about strokes given up, of those that may be said ...
    double told;                ///< ... as of this time (s)
    int untold;                 ///< strokes given up without a line
    double last_untold;         ///< the last of them (s)
    int hits_lost, hits_late;   ///< hits given up and late since the last line about them ...
    double latest;              ///< ... by so much at most (s) ...
    double first_hit, last_hit; ///< ... the first and the last of them at these times (s)
} planner_notes;

/// Adds a line, unless one of its kind has been added since play. Strokes given up have a line
/// each, as long as they are few; the others are counted in one line.
HIMC_RT void himc_planner_say(himc_planner *planner, planner_kind kind, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Counts a stroke of the score that is not played as written.
HIMC_RT void himc_planner_notes_count(planner_notes *notes, planner_kind kind);

/// At play: counts from 0, and each kind may be said again.
HIMC_RT void himc_planner_notes_begin(planner_notes *notes);

/// Adds a line of the counts, if there is more than one stroke in them.
HIMC_RT void himc_planner_notes_sum_up(planner_notes *notes);

/// Counts a hit at t for which no hand has time until it is so `late` (s); infinite: given up.
HIMC_RT void himc_planner_notes_hit(planner_notes *notes, double t, double late);

/// A stroke is given up: keeps it until it is taken.
HIMC_RT void himc_planner_notes_miss(planner_notes *notes, const himc_planner_miss *miss);

/// The same, counted if it is of the score, and with a line that has its name.
HIMC_RT void himc_planner_tell_miss(himc_planner *planner, const himc_planner_miss *miss,
                                    const char *name);

/// One line of the counts of these hits, and of strokes given up without a line, when there have
/// been no more for a second, or for long enough.
HIMC_RT void himc_planner_notes_tell(planner_notes *notes, double t);

#endif
