/// render_tables.h: the tables that `himc render` writes beside the sound: rows of strokes,
/// and the report. motion_table.h has the motion.
#ifndef RENDER_TABLES_H
#define RENDER_TABLES_H

#include "himc/performance.h"

#include <stdio.h>

/// The rows of the table of strokes, in the order of time.
typedef struct render_strokes {
    himc_strike *row; ///< owned
    int count, room;
    bool full; ///< there was no memory for all of them
} render_strokes;

void render_strokes_add(render_strokes *strokes, const himc_strike *strike);
/// Writes the table, with its head, and frees the rows.
void render_strokes_write(render_strokes *strokes, FILE *stream);

/// A few lines for a person on stderr, then one JSON object in one line in `out`, unless NULL.
void render_report(const himc_performance_stats *stats, double seconds, double realtime_factor,
                   FILE *out);

#endif
