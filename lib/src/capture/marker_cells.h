/// marker_cells.h: the cells of a row of markers in a text table, three for each; private.
#ifndef HIMC_MARKER_CELLS_H
#define HIMC_MARKER_CELLS_H

#include "capture/take.h"
#include "capture/take_text.h"

/// Where a row stands, for error lines, and what it is read into.
typedef struct marker_row {
    himc_take *take;
    int line; ///< in the file, from 1
    char separator;
    himc_error *error;
} marker_row;

/// True if the row has a cell that is not blank.
bool himc_marker_row_is_filled(himc_span row, char separator);

/// Reads a decimal number, with a comma instead of the point if no comma is between cells.
bool himc_marker_number(himc_span cell, char separator, double *value);

/// Takes the three cells of a point off the row: a position, or a gap if all of them are empty,
/// "nan" or 9999999. False with the reason.
bool himc_marker_row_point(const marker_row *row, himc_span *rest, int frame, int point);

#endif
