/// marker_cells.c: three cells, a position or a gap.
#include "capture/marker_cells.h"

#include <math.h>
#include <string.h>

bool himc_marker_row_is_filled(himc_span row, char separator)
{
    bool filled = false;
    while (row.at && !filled)
        filled = himc_span_cell(&row, separator).length > 0;
    return filled;
}

bool himc_marker_number(himc_span cell, char separator, double *value)
{
    char point[40];
    const char *comma = memchr(cell.at, ',', cell.length);
    if (separator == ',' || !comma || cell.length > sizeof point)
        return himc_span_number(cell, value);
    memcpy(point, cell.at, cell.length);
    point[comma - cell.at] = '.';
    return himc_span_number((himc_span){point, cell.length}, value);
}

bool himc_marker_row_point(const marker_row *row, himc_span *rest, int frame, int point)
{
    double v[3] = {0, 0, 0};
    int seen = 0;
    for (int axis = 0; axis < 3; axis++) {
        char text[44];
        himc_span cell = himc_span_cell(rest, row->separator);
        bool number = himc_marker_number(cell, row->separator, &v[axis]);
        if (cell.length == 0 || himc_span_is(cell, "nan") || himc_span_is(cell, "-nan") ||
            v[axis] == 9999999)
            continue;
        if (!number || !(fabs(v[axis]) <= TAKE_LARGEST))
            return himc_error_set(
                row->error,
                "%s:%d: %s %c is \"%s\", expected a number up to 1e8, or an empty cell for a gap",
                row->take->file, row->line, row->take->names[point], "XYZ"[axis],
                himc_span_text(cell, text));
        seen++;
    }
    if (seen != 0 && seen != 3)
        return himc_error_set(row->error,
                              "%s:%d: %s has %d of its 3 coordinates, expected all or none",
                              row->take->file, row->line, row->take->names[point], seen);
    *himc_take_at(row->take, frame, point) =
        seen ? himc_vec3_make(v[0], v[1], v[2]) : himc_vec3_gap();
    return true;
}
