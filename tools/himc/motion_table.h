/// motion_table.h: the rows of motion as a table: CSV, OpenSim's storage file, C3D or NumPy file.
/// One list of arrays (motion_table.c) makes the header, the names in the NumPy file, `--columns
/// help` and the table in docs/data.md.
#ifndef MOTION_TABLE_H
#define MOTION_TABLE_H

#include "himc/performance.h"

#include <stdio.h>

/// A table under way. Opaque.
typedef struct motion_table motion_table;

typedef enum motion_table_format {
    MOTION_TABLE_CSV,
    MOTION_TABLE_STORAGE, ///< OpenSim's .sto and .mot
    MOTION_TABLE_C3D,     ///< .c3d
    MOTION_TABLE_NUMPY    ///< .npz
} motion_table_format;

/// Begins a table in `stream` (borrowed) with the groups named in `columns`, "tips,torques", in the
/// order of the list; NULL: the usual ones. All but a CSV is kept in memory until motion_table_end.
/// NULL with the reason.
motion_table *motion_table_new(FILE *stream, motion_table_format format, const char *columns,
                               himc_error *error);
/// Adds a row.
void motion_table_row(motion_table *table, const himc_motion_row *row);
/// Writes what waits. False with the reason.
bool motion_table_end(motion_table *table, himc_error *error);
/// NULL is allowed.
void motion_table_free(motion_table *table);

/// The format that a file's name asks for by its ending; a CSV if by none.
motion_table_format motion_table_format_of(const char *path);

/// Prints the groups and what is in them, for a person, or as rows of a Markdown table.
void motion_table_help(FILE *stream, bool markdown);

#endif
