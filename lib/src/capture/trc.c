/// trc.c: TRC, the text table of marker trajectories of Motion Analysis and OpenSim; read and
/// written (in millimetres, y up).
///
/// Line 1 names the format; lines 2 and 3 are keys and values (DataRate, NumFrames, NumMarkers,
/// Units); line 4 is "Frame#", "Time" and a marker's name over every third column; line 5 (X1 Y1 Z1
/// ...) is skipped; then one row per frame. Cells are split by tabs, else semicolons, else
/// commas, whichever the row of names has. An empty cell, "nan" or 9999999 (Motion Analysis's own
/// mark) is a gap; a point with only some of its coordinates is refused, because then columns are
/// shifted. The header's counts must agree with the rows and names of the file.
#include "capture/marker_cells.h"

#include <string.h>

typedef struct trc {
    himc_take *take;
    himc_text text;
    char separator;
    double rate;
    long frames, markers;
    himc_span names; // line 4
    himc_error *error;
} trc;

static bool refuse_line(const trc *r, const char *what)
{
    return himc_error_set(r->error, "%s:%d: %s", r->take->file, r->text.line, what);
}

static char find_separator(himc_span line)
{
    const char *candidates = "\t;,";
    for (; *candidates; candidates++)
        if (memchr(line.at, *candidates, line.length))
            break;
    return *candidates ? *candidates : '\t';
}

// the next cell; with `packed` the next that is not empty
static himc_span next_cell(himc_span *line, char separator, bool packed)
{
    himc_span cell = himc_span_cell(line, separator);
    while (packed && line->at && cell.length == 0)
        cell = himc_span_cell(line, separator);
    return cell;
}

static int count_filled(himc_span line, char separator)
{
    int count = 0;
    while (line.at)
        count += himc_span_cell(&line, separator).length > 0;
    return count;
}

// the value under a key of line 2, in line 3; empty if there is none. Some programs put several
// separators between values: with as many values as keys, empty cells do not count
static himc_span header_value(himc_span keys, himc_span values, char separator, const char *key)
{
    bool packed = count_filled(keys, separator) == count_filled(values, separator);
    while (keys.at && values.at) {
        himc_span name = next_cell(&keys, separator, packed);
        himc_span value = next_cell(&values, separator, packed);
        if (himc_span_is(name, key))
            return value;
    }
    return (himc_span){"", 0};
}

static bool refuse_value(const trc *r, const char *key, himc_span value, const char *expected)
{
    char text[44];
    return himc_error_set(r->error, "%s:%d: %s is \"%s\", expected %s", r->take->file, r->text.line,
                          key, himc_span_text(value, text), expected);
}

static bool read_header(trc *r)
{
    himc_span keys, values;
    if (!himc_text_line(&r->text, &keys) || !himc_text_line(&r->text, &keys) ||
        !himc_text_line(&r->text, &values))
        return refuse_line(r, "the file ends in its header");
    char separator = find_separator(keys);
    himc_span rate = header_value(keys, values, separator, "DataRate");
    himc_span frames = header_value(keys, values, separator, "NumFrames");
    himc_span markers = header_value(keys, values, separator, "NumMarkers");
    himc_span units = header_value(keys, values, separator, "Units");
    if (!himc_marker_number(rate, separator, &r->rate))
        return refuse_value(r, "DataRate", rate, "a number (Hz)");
    if (!himc_span_integer(frames, 1, TAKE_MOST_FRAMES, &r->frames))
        return refuse_value(r, "NumFrames", frames, "1 .. 1000000");
    if (!himc_span_integer(markers, 1, TAKE_MOST_POINTS, &r->markers))
        return refuse_value(r, "NumMarkers", markers, "1 .. 65536");
    char unit[44];
    r->take->file_unit = himc_take_unit(himc_span_text(units, unit));
    if (units.length > 0 && r->take->file_unit == 0)
        return refuse_value(r, "Units", units, "mm, cm, m, in or ft");
    if (!himc_text_line(&r->text, &r->names))
        return refuse_line(r, "the file ends before the markers' names");
    r->separator = find_separator(r->names);
    return true;
}

// the name of marker i is above its first column, 2 + 3 i
static bool read_names(trc *r)
{
    himc_span rest = r->names;
    int given = 0;
    for (long column = 0; rest.at; column++) {
        himc_span cell = himc_span_cell(&rest, r->separator);
        if (cell.length == 0 || column < 2)
            continue;
        char text[44];
        if ((column - 2) % 3 != 0 || (column - 2) / 3 >= r->markers)
            return himc_error_set(
                r->error,
                "%s:4: marker \"%s\" is above column %ld, expected every third column, 3 .. %ld",
                r->take->file, himc_span_text(cell, text), column + 1, 3 * r->markers);
        himc_take_set_name(r->take, (int)((column - 2) / 3), cell.at, cell.length);
        given++;
    }
    if (given == r->markers)
        return true;
    return himc_error_set(r->error, "%s:4: the header says %ld markers, the file names %d",
                          r->take->file, r->markers, given);
}

static bool read_rows(trc *r)
{
    himc_take *take = r->take;
    himc_span row;
    double first = NAN, last = NAN;
    for (int frame = 0; frame < take->frames && himc_text_line(&r->text, &row);) {
        if (!himc_marker_row_is_filled(row, r->separator))
            continue;
        himc_span number = himc_span_cell(&row, r->separator);
        himc_span time = himc_span_cell(&row, r->separator);
        long label;
        if (!himc_span_integer(number, -2000000000, 2000000000, &label))
            return refuse_value(r, "Frame#", number, "a whole number");
        if (frame == 0)
            take->first_frame = (int)label;
        if (!himc_marker_number(time, r->separator, frame ? &last : &first))
            *(frame ? &last : &first) = NAN;
        marker_row cells = {take, r->text.line, r->separator, r->error};
        for (int point = 0; point < take->points; point++)
            if (!himc_marker_row_point(&cells, &row, frame, point))
                return false;
        while (row.at) {
            himc_span cell = himc_span_cell(&row, r->separator);
            if (cell.length > 0)
                return refuse_value(r, "the cell after the last marker", cell, "an empty cell");
        }
        frame++;
    }
    // the Time column is not used; a note says if it disagrees by more than its rounding
    double step = (last - first) / (take->frames - 1), said = 1 / r->rate;
    if (take->frames > 1 && isfinite(step) && fabs(step - said) > 0.01 * said)
        himc_take_note(take,
                       "rate: the Time column steps by %.6g s, DataRate means %.6g s and is used",
                       step, said);
    return true;
}

bool himc_trc_read(himc_take *take, const void *bytes, size_t size, himc_error *error)
{
    trc r = {.take = take, .text = himc_text_open(bytes, size), .error = error};
    memcpy(take->format, "TRC", 4);
    take->format_up = himc_vec3_make(0, 1, 0);
    himc_span line;
    if (!read_header(&r))
        return false;
    if (!himc_text_line(&r.text, &line))
        return refuse_line(&r, "the file ends before its first row");
    int rows = 0;
    for (himc_text rest = r.text; himc_text_line(&rest, &line);)
        rows += himc_marker_row_is_filled(line, r.separator);
    if (rows != r.frames)
        return himc_error_set(error, "%s: the header says %ld frames, the file has %d rows",
                              take->file, r.frames, rows);
    // rows may be shorter than their points, but a file has at least a byte for each point
    if (size / (size_t)r.markers < (size_t)rows)
        return himc_error_set(error, "%s:3: NumMarkers is %ld, more than the rows have cells for",
                              take->file, r.markers);
    return himc_take_allocate(take, r.rate, rows, (int)r.markers, false, error) && read_names(&r) &&
           read_rows(&r);
}

bool himc_trc_write(FILE *file, const himc_take *take, himc_error *error)
{
    (void)error;
    fprintf(file, "PathFileType\t4\t(X/Y/Z)\t%s\n", take->file);
    fputs("DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\t"
          "OrigNumFrames\n",
          file);
    himc_text_put_number(file, take->rate, 6);
    fputc('\t', file);
    himc_text_put_number(file, take->rate, 6);
    fprintf(file, "\t%d\t%d\tmm\t", take->frames, take->points);
    himc_text_put_number(file, take->rate, 6);
    fprintf(file, "\t1\t%d\nFrame#\tTime", take->frames);
    for (int i = 0; i < take->points; i++)
        fprintf(file, "\t%s\t\t", take->names[i]);
    fputs("\n\t", file);
    for (int i = 1; i <= take->points; i++)
        fprintf(file, "\tX%d\tY%d\tZ%d", i, i, i);
    fputc('\n', file);
    for (int frame = 0; frame < take->frames; frame++) {
        fprintf(file, "%d\t", frame + 1);
        himc_text_put_number(file, frame / take->rate, 6);
        for (int i = 0; i < take->points; i++) {
            himc_vec3 x = himc_take_y_up(*himc_take_at(take, frame, i));
            if (himc_vec3_finite(x))
                himc_text_put_vec3(file, himc_vec3_scale(x, 1000), 4, '\t');
            else
                fputs("\t\t\t", file);
        }
        fputc('\n', file);
    }
    return true;
}
