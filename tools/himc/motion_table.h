/// motion_table.h: the rows of motion as a table: CSV, or one NumPy file (.npz). One list of arrays
/// (motion_table.c) makes the CSV's header, the names in the NumPy file, `--columns help` and the
/// table in docs/data.md.
#ifndef MOTION_TABLE_H
#define MOTION_TABLE_H

#include "himc/performance.h"

#include <stdio.h>

/// A table under way. Opaque.
typedef struct motion_table motion_table;

/// Begins a table in `stream` (borrowed) with the groups named in `columns`, "tips,torques", in the
/// order of the list; NULL: the usual ones. `numpy`: an .npz, kept in memory until
/// motion_table_end. NULL with the reason.
motion_table *motion_table_new(FILE *stream, bool numpy, const char *columns, himc_error *error);
/// Adds a row.
void motion_table_row(motion_table *table, const himc_motion_row *row);
/// Writes what waits. False with the reason.
bool motion_table_end(motion_table *table, himc_error *error);
/// NULL is allowed.
void motion_table_free(motion_table *table);

/// True if the name ends as a NumPy file's does.
bool motion_table_is_numpy(const char *path);

/// Prints the groups and what is in them, for a person, or as rows of a Markdown table.
void motion_table_help(FILE *stream, bool markdown);

#endif
