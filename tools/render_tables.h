/// render_tables.h: the tables that `himc render` writes beside the sound: rows of strokes,
/// and the report. motion_table.h has the motion.
#ifndef RENDER_TABLES_H
#define RENDER_TABLES_H

#include "himc/performance.h"

#include <stdio.h>

void render_stroke_header(FILE *stream);
void render_stroke_row(FILE *stream, const himc_strike *strike);

/// A few lines for a person on stderr, then one JSON object in one line in `out`, unless NULL.
void render_report(const himc_performance_stats *stats, double seconds, double realtime_factor,
                   FILE *out);

#endif
