/// render_tables.h: the tables that `himc render` writes beside the sound: rows of strokes and
/// motion, and the report.
#ifndef RENDER_TABLES_H
#define RENDER_TABLES_H

#include "himc/performance.h"

#include <stdio.h>

void render_stroke_header(FILE *stream);
void render_stroke_row(FILE *stream, const himc_strike *strike);

void render_motion_header(FILE *stream);
/// As himc_performance_on_motion wants it; `stream` is a FILE.
void render_motion_row(void *stream, const himc_motion_row *row);

/// A few lines for a person, then one JSON object in one line.
void render_report(const himc_performance_stats *stats, double seconds, double realtime_factor);

#endif
