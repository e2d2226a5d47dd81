/// marker_cells.c: three cells, a position or a gap.
#include "capture/marker_cells.h"

#include <math.h>
#include <string.h>

static bool refuse_cell(const marker_row *row, int point, int axis, himc_span cell)
{
    char text[44];
    return himc_error_set(
        row->error,
        "%s:%d: %s %c is \"%s\", expected a number up to 1e8, or an empty cell for a gap",
        row->take->file, row->line, row->take->names[point], "XYZ"[axis],
        himc_span_text(cell, text));
}

static bool is_gap_mark(himc_span cell, double value)
{
    return cell.length == 0 || himc_span_is(cell, "nan") || himc_span_is(cell, "-nan") ||
           value == 9999999;
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
        himc_span cell = rest->at ? himc_span_cell(rest, row->separator) : (himc_span){"", 0};
        bool number = himc_marker_number(cell, row->separator, &v[axis]);
        if (is_gap_mark(cell, v[axis]))
            continue;
        if (!number || !(fabs(v[axis]) <= TAKE_LARGEST))
            return refuse_cell(row, point, axis, cell);
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
