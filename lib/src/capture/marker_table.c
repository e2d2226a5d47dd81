/// marker_table.c: tables of markers as text: Vicon Nexus' ASCII export (.csv), OptiTrack Motive's
/// export (.csv), Qualisys' TSV, Motion Analysis' and OpenSim's TRC, and any CSV with columns
/// NAME_x, NAME_y, NAME_z; TRC is written, too.
///
/// All are a head that says rate, unit and the column where each marker's three cells begin,
/// then rows of numbers. A head is read into a plan; one loop reads the rows of all. Three cells
/// that are empty, "nan" or 9999999 (Motion Analysis' own mark) are a gap; a point with only some
/// of its coordinates is refused, because then columns are shifted.
///
/// Nexus: sections "Devices", "Joints", "Trajectories", ...; of these "Trajectories" is read: the
/// rate, a line of names each above its first column, "Frame,Sub Frame,X,Y,Z,...", a line of
/// units, rows up to an empty one.
///
/// Motive: "Format Version,1.23,Export Frame Rate,120,Length Units,Meters,...", then lines of
/// types (Marker, Rigid Body, Bone, ...), names, identifiers, properties (Position, Rotation), and
/// "Frame,Time (Seconds),X,Y,Z,..."; y up. Positions of all are read, but not the expected ones of
/// a body's markers if the file has the measured ones.
///
/// Qualisys: lines KEY<tab>VALUE, of which FREQUENCY and MARKER_NAMES are needed; mm; then rows,
/// with Frame and Time first if the line before them says so.
///
/// TRC: line 1 names the format; lines 2 and 3 are keys and values (DataRate, NumFrames,
/// NumMarkers, Units); line 4 is "Frame#", "Time" and a marker's name over every third column; line
/// 5 (X1 Y1 Z1 ...) is skipped; y up. Cells are split by tabs, else semicolons, else commas,
/// whichever the row of names has. The header's counts must agree with the rows and names.
///
/// Any: one line of column names: time (s), and three columns for each marker, NAME_x NAME_y
/// NAME_z with the unit at their end: NAME_x_mm, "NAME x [m]", "NAME.X (cm)"; the others are not
/// read. So motion.csv of `himc render` is a take, too. Rows may come at uneven times. Where a
/// semicolon or a tab parts the cells, numbers may have a decimal comma.
#include "base/noise.h"
#include "capture/take.h"
#include "capture/take_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NOT_THERE (-1)
#define ROUNDED 0.3 // of a step: rounded times are off an even rate by less; chosen: .01 s at 60 Hz
#define BRIDGED 0.1 // (s) a longer step is a gap; chosen: a fall takes longer

typedef struct plan {
    himc_take *take;
    himc_text text; // its next line is the first row
    size_t size;    // of the file (bytes)
    char separator;
    double rate;   // (Hz); 0: by the time column
    double *times; // of that column (s), rows; owned
    bool uneven;   // they are not those of an even rate
    int frames;    // of the take, at the rate
    int points;
    int *begin;           // column of each point's x (points), rising; owned
    himc_span *names;     // (points); owned
    int frame, time;      // columns, or NOT_THERE
    bool ends_with_blank; // an empty line ends the rows
    bool strict;          // all rows have whole numbers of frames, and nothing behind the points
    himc_error *error;
} plan;

static bool refuse(const plan *p, const char *what)
{
    return himc_error_set(p->error, "%s:%d: %s", p->take->file, p->text.line, what);
}

static bool refuse_value(const plan *p, const char *what, himc_span value, const char *expected)
{
    char text[44];
    return himc_error_set(p->error, "%s:%d: %s is \"%s\", expected %s", p->take->file, p->text.line,
                          what, himc_span_text(value, text), expected);
}

static int count_filled(himc_span line, char separator)
{
    int count = 0;
    while (line.at)
        count += himc_span_cell(&line, separator).length > 0;
    return count;
}

// the rows that are not blank
static int count_rows(const plan *p)
{
    himc_span line;
    int rows = 0;
    for (himc_text rest = p->text; himc_text_line(&rest, &line);) {
        bool filled = count_filled(line, p->separator) > 0;
        if (!filled && p->ends_with_blank)
            break;
        rows += filled;
    }
    return rows;
}

// the first of the separators that the line has; else a comma
static char find_separator(himc_span line, const char *separators)
{
    for (; *separators; separators++)
        if (memchr(line.at, *separators, line.length))
            return *separators;
    return ',';
}

// a decimal number, with a comma instead of the point if no comma is between cells
static bool cell_number(himc_span cell, char separator, double *value)
{
    char point[40];
    const char *comma = memchr(cell.at, ',', cell.length);
    if (separator == ',' || !comma || cell.length > sizeof point)
        return himc_span_number(cell, value);
    memcpy(point, cell.at, cell.length);
    point[comma - cell.at] = '.';
    return himc_span_number((himc_span){point, cell.length}, value);
}

static int count_cells(himc_span line, char separator)
{
    int count = 1;
    for (size_t i = 0; i < line.length; i++)
        count += line.at[i] == separator;
    return count;
}

static bool make_room(plan *p, int most)
{
    p->begin = calloc((size_t)most + 1, sizeof *p->begin);
    p->names = calloc((size_t)most + 1, sizeof *p->names);
    return (p->begin && p->names) ||
           himc_error_set(p->error, "%s: no memory for %d names", p->take->file, most);
}

static void add_point(plan *p, himc_span name, int column)
{
    p->names[p->points] = name;
    p->begin[p->points++] = column;
}

static himc_span unquoted(himc_span cell)
{
    bool quoted = cell.length > 1 && cell.at[0] == '"' && cell.at[cell.length - 1] == '"';
    return quoted ? (himc_span){cell.at + 1, cell.length - 2} : cell;
}

// metres per unit; 0 if the word is no unit
static double unit_of(himc_span word)
{
    char text[44];
    return himc_take_unit(himc_span_text(word, text));
}

// sets the unit of the file if one is given; a file has one
static bool set_unit(plan *p, double unit)
{
    if (unit == 0)
        return true;
    if (p->take->file_unit != 0 && p->take->file_unit != unit)
        return refuse(p, "markers in several units, expected one");
    p->take->file_unit = unit;
    return true;
}

// Nexus

static bool read_nexus(plan *p)
{
    himc_span line;
    memcpy(p->take->format, "CSV (Vicon Nexus)", 18);
    bool found = false;
    while (!found && himc_text_line(&p->text, &line))
        found = himc_span_is(himc_span_cell(&line, ','), "trajectories");
    if (!found)
        return himc_error_set(p->error,
                              "%s: no section Trajectories, expected an export with trajectories",
                              p->take->file);
    if (!himc_text_line(&p->text, &line) || !himc_span_number(himc_span_cell(&line, ','), &p->rate))
        return refuse(p, "no rate, expected frames per second (Hz)");
    if (!himc_text_line(&p->text, &line))
        return refuse(p, "no names of markers");
    if (!make_room(p, count_cells(line, ',')))
        return false;
    for (int column = 0; line.at; column++) {
        himc_span name = himc_span_cell(&line, ',');
        if (name.length == 0 || column < 2)
            continue;
        if (p->points > 0 && column < p->begin[p->points - 1] + 3)
            return refuse(p, "two names less than three columns apart");
        add_point(p, name, column);
    }
    if (p->points == 0)
        return refuse(p, "no names of markers, expected one above each first column");
    if (!himc_text_line(&p->text, &line) || !himc_span_is(himc_span_cell(&line, ','), "frame"))
        return refuse(p, "not the line of columns, expected Frame,Sub Frame,X,Y,Z,...");
    if (!himc_text_line(&p->text, &line))
        return refuse(p, "no line of units");
    while (line.at)
        if (!set_unit(p, unit_of(himc_span_cell(&line, ','))))
            return false;
    p->frame = 0;
    p->ends_with_blank = true;
    return true;
}

// Motive

static bool read_motive(plan *p)
{
    himc_span line, types = {"", 0}, names = {"", 0}, properties = {"", 0};
    double capture = 0;
    bool is_head = true, measured = false;
    memcpy(p->take->format, "CSV (OptiTrack Motive)", 23);
    p->take->format_up = himc_vec3_make(0, 1, 0);
    himc_text_line(&p->text, &line); // there: it names the format
    while (line.at) {
        himc_span key = himc_span_cell(&line, ','), rest = line;
        himc_span value = himc_span_cell(&rest, ',');
        if (himc_span_is(key, "export frame rate") && !himc_span_number(value, &p->rate))
            return refuse(p, "Export Frame Rate is no number (Hz)");
        if (himc_span_is(key, "capture frame rate") && !himc_span_number(value, &capture))
            return refuse(p, "Capture Frame Rate is no number (Hz)");
        if (himc_span_is(key, "length units"))
            p->take->file_unit = unit_of(value);
    }
    p->rate = p->rate > 0 ? p->rate : capture;
    for (int row = 0; is_head && himc_text_filled_line(&p->text, &line); row++) {
        himc_span rest = line;
        is_head = !himc_span_is(himc_span_cell(&rest, ','), "frame");
        types = row == 0 ? line : types;
        names = row == 1 ? line : names;
        properties = is_head ? line : properties;
    }
    if (is_head)
        return refuse(p,
                      "no line Frame,Time (Seconds),X,Y,Z,..., expected an export with a header");
    p->frame = 0;
    p->time = p->rate > 0 ? NOT_THERE : 1;
    for (himc_span rest = types; rest.at && !measured;)
        measured = himc_span_is(himc_span_cell(&rest, ','), "marker");
    if (!make_room(p, count_cells(line, ',')))
        return false;
    for (int column = 0, next = 0; line.at; column++) { // next: axis that goes on with the point
        himc_span type = himc_span_cell(&types, ','), name = himc_span_cell(&names, ',');
        himc_span property = himc_span_cell(&properties, ','), axis = himc_span_cell(&line, ',');
        bool expected =
            himc_span_is(type, "rigid body marker") || himc_span_is(type, "bone marker");
        bool here = himc_span_is(property, "position") && !(measured && expected) &&
                    axis.length == 1 && (axis.at[0] | 32) == 'x' + next;
        if (here && next == 2)
            add_point(p, unquoted(name), column - 2);
        next = here ? (next + 1) % 3 : 0;
    }
    return p->points > 0 || refuse(p, "no columns Position, expected an export with markers, rigid "
                                      "bodies or bones");
}

// Qualisys

// columns of the points, behind Frame and Time if the table begins with them
static void qualisys_columns(plan *p, himc_span line)
{
    int column = 0;
    if (himc_span_is(himc_span_cell(&line, '\t'), "frame")) {
        p->frame = column++;
        if (himc_span_is(himc_span_cell(&line, '\t'), "time"))
            p->time = column++;
    }
    for (int i = 0; i < p->points; i++)
        p->begin[i] = column + 3 * i;
}

static bool read_qualisys(plan *p)
{
    himc_span line;
    double unused;
    memcpy(p->take->format, "TSV (Qualisys)", 15);
    p->take->file_unit = 0.001;
    for (himc_text before = p->text; himc_text_line(&p->text, &line); before = p->text) {
        himc_span rest = line, key = himc_span_cell(&rest, '\t');
        if (himc_span_is(key, "frequency")) {
            if (!himc_span_number(himc_span_cell(&rest, '\t'), &p->rate))
                return refuse(p, "FREQUENCY is no number (Hz)");
        } else if (himc_span_is(key, "marker_names") && p->points == 0) {
            if (!make_room(p, count_cells(rest, '\t')))
                return false;
            while (rest.at) {
                himc_span name = himc_span_cell(&rest, '\t');
                if (name.length > 0)
                    add_point(p, name, 0);
            }
            if (p->points == 0)
                return refuse(p, "MARKER_NAMES has none");
            qualisys_columns(p, (himc_span){"", 0});
        } else if (himc_span_is(key, "frame")) {
            qualisys_columns(p, line);
            return p->points > 0 || refuse(p, "no MARKER_NAMES before the rows");
        } else if (himc_span_number(key, &unused)) {
            p->text = before;
            return p->points > 0 || refuse(p, "no MARKER_NAMES before the rows");
        }
    }
    return refuse(p, "no rows, expected a TSV with MARKER_NAMES, then numbers");
}

// TRC

// the next cell; with `packed` the next that is not empty
static himc_span next_cell(himc_span *line, char separator, bool packed)
{
    himc_span cell = himc_span_cell(line, separator);
    while (packed && line->at && cell.length == 0)
        cell = himc_span_cell(line, separator);
    return cell;
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

// the name of marker i is above its first column, 2 + 3 i
static bool trc_names(plan *p, himc_span line, long markers)
{
    if (!make_room(p, (int)markers))
        return false;
    for (long column = 0; line.at; column++) {
        himc_span cell = himc_span_cell(&line, p->separator);
        if (cell.length == 0 || column < 2)
            continue;
        char text[44];
        if ((column - 2) % 3 != 0 || (column - 2) / 3 >= markers)
            return himc_error_set(
                p->error,
                "%s:4: marker \"%s\" is above column %ld, expected every third column, 3 .. %ld",
                p->take->file, himc_span_text(cell, text), column + 1, 3 * markers);
        add_point(p, cell, (int)column);
    }
    return p->points == markers ||
           himc_error_set(p->error, "%s:4: the header says %ld markers, the file names %d",
                          p->take->file, markers, p->points);
}

static bool read_trc(plan *p)
{
    himc_span keys, values, names;
    long frames, markers;
    memcpy(p->take->format, "TRC", 4);
    p->take->format_up = himc_vec3_make(0, 1, 0);
    if (!himc_text_line(&p->text, &keys) || !himc_text_line(&p->text, &keys) ||
        !himc_text_line(&p->text, &values))
        return refuse(p, "the file ends in its header");
    char separator = find_separator(keys, "\t;,");
    himc_span rate = header_value(keys, values, separator, "DataRate");
    himc_span said_frames = header_value(keys, values, separator, "NumFrames");
    himc_span said_markers = header_value(keys, values, separator, "NumMarkers");
    himc_span unit = header_value(keys, values, separator, "Units");
    if (!cell_number(rate, separator, &p->rate))
        return refuse_value(p, "DataRate", rate, "a number (Hz)");
    if (!himc_span_integer(said_frames, 1, TAKE_MOST_FRAMES, &frames))
        return refuse_value(p, "NumFrames", said_frames, "1 .. 1000000");
    if (!himc_span_integer(said_markers, 1, TAKE_MOST_POINTS, &markers))
        return refuse_value(p, "NumMarkers", said_markers, "1 .. 65536");
    p->take->file_unit = unit_of(unit);
    if (unit.length > 0 && p->take->file_unit == 0)
        return refuse_value(p, "Units", unit, "mm, cm, m, in or ft");
    if (!himc_text_line(&p->text, &names))
        return refuse(p, "the file ends before the markers' names");
    if (!himc_text_line(&p->text, &keys))
        return refuse(p, "the file ends before its first row");
    p->separator = find_separator(names, "\t;,");
    p->frame = 0;
    p->time = 1;
    p->strict = true;
    int rows = count_rows(p);
    if (rows != frames)
        return himc_error_set(p->error, "%s: the header says %ld frames, the file has %d rows",
                              p->take->file, frames, rows);
    // rows may be shorter than their points, but a file has at least a byte for each point
    if (p->size / (size_t)markers < (size_t)rows)
        return himc_error_set(p->error,
                              "%s:3: NumMarkers is %ld, more than the rows have cells for",
                              p->take->file, markers);
    return trc_names(p, names, markers);
}

// any CSV

// takes the last word off: blanks, brackets, points and underscores are between words
static himc_span last_word(himc_span *rest)
{
    static const char *const between = " _.:()[]{}\"'";
    size_t end = rest->length, begin;
    while (end > 0 && strchr(between, rest->at[end - 1]))
        end--;
    for (begin = end; begin > 0 && !strchr(between, rest->at[begin - 1]);)
        begin--;
    himc_span word = {rest->at + begin, end - begin};
    rest->length = begin;
    while (rest->length > 0 && strchr(between, rest->at[rest->length - 1]))
        rest->length--;
    return word;
}

static bool read_any(plan *p)
{
    himc_span line, last = {"", 0};
    memcpy(p->take->format, "CSV", 4);
    if (!himc_text_filled_line(&p->text, &line))
        return refuse(p, "the file has no line");
    p->separator = find_separator(line, ";\t");
    if (!make_room(p, count_cells(line, p->separator)))
        return false;
    for (int column = 0, next = 0; line.at; column++) {
        himc_span cell = unquoted(himc_span_cell(&line, p->separator)), name = cell;
        bool seconds = himc_span_is(last_word(&name), "s");
        if (p->time == NOT_THERE && himc_span_is(seconds ? name : cell, "time"))
            p->time = column;
        // a coordinate is "NAME_x_mm": its name, axis and unit, if one is said
        himc_span word = last_word(&cell);
        double unit = unit_of(word);
        if (unit != 0)
            word = last_word(&cell);
        int axis = word.length == 1 && cell.length > 0 ? (word.at[0] | 32) - 'x' : NOT_THERE;
        bool goes_on = next > 0 && axis == next && cell.length == last.length &&
                       memcmp(cell.at, last.at, cell.length) == 0;
        if (axis != 0 && !goes_on) {
            next = 0;
            continue;
        }
        next = (axis + 1) % 3;
        last = cell;
        if (!set_unit(p, unit))
            return false;
        if (axis == 2)
            add_point(p, cell, column - 2);
    }
    if (p->points == 0)
        return refuse(p,
                      "no markers, expected columns time,NAME_x_m,NAME_y_m,NAME_z_m,... (or _mm, "
                      "_cm); Vicon Nexus' or Motive's export; Qualisys' .tsv");
    return p->time != NOT_THERE || refuse(p, "no column time (s)");
}

// rows

static bool read_number(const plan *p, himc_span cell, const char *column, double *value)
{
    return (cell_number(cell, p->separator, value) && fabs(*value) <= TAKE_LARGEST) ||
           refuse_value(p, column, cell, "a number");
}

// `time` becomes NaN in a strict table if it is no number: it has a rate
static bool read_row(const plan *p, himc_span line, int frame, double *time)
{
    double v[3];
    long label;
    int point = 0, seen = 0, column = 0;
    for (; point < p->points || column <= p->time || (p->strict && line.at); column++) {
        himc_span cell = himc_span_cell(&line, p->separator);
        int axis = point < p->points ? column - p->begin[point] : NOT_THERE;
        if (axis >= 0) {
            const char *name = p->take->names[point];
            bool number = cell_number(cell, p->separator, &v[axis]);
            bool gap = cell.length == 0 || himc_span_is(cell, "nan") ||
                       himc_span_is(cell, "-nan") || (number && v[axis] == 9999999);
            if (!gap && !(number && fabs(v[axis]) <= TAKE_LARGEST)) {
                char what[TAKE_NAME + 2];
                snprintf(what, sizeof what, "%s %c", name, "XYZ"[axis]);
                return refuse_value(p, what, cell,
                                    "a number up to 1e8, or an empty cell for a gap");
            }
            seen += !gap;
            if (axis == 2 && seen % 3 != 0)
                return himc_error_set(p->error,
                                      "%s:%d: %s has %d of its 3 coordinates, expected all or none",
                                      p->take->file, p->text.line, name, seen);
            if (axis == 2) {
                *himc_take_at(p->take, frame, point++) =
                    seen ? himc_vec3_make(v[0], v[1], v[2]) : himc_vec3_gap();
                seen = 0;
            }
        } else if (column == p->frame && (frame == 0 || p->strict)) {
            if (!himc_span_integer(cell, -2000000000, 2000000000, &label))
                return refuse_value(p, "Frame#", cell, "a whole number");
            p->take->first_frame = frame == 0 ? (int)label : p->take->first_frame;
        } else if (column == p->time && p->strict) {
            *time = cell_number(cell, p->separator, time) ? *time : NAN;
        } else if (column == p->time) {
            if (!read_number(p, cell, "the time", time))
                return false;
        } else if (p->strict && point == p->points && cell.length > 0) {
            return refuse_value(p, "the cell after the last marker", cell, "an empty cell");
        }
    }
    return true;
}

// the times of a table that has only a time column
static bool read_times(plan *p, int rows)
{
    himc_span line;
    plan look = *p;
    p->times = malloc((size_t)rows * sizeof *p->times);
    if (!p->times)
        return himc_error_set(p->error, "%s: no memory for %d rows", p->take->file, rows);
    for (int row = 0; row < rows && himc_text_line(&look.text, &line);) {
        himc_span cell = {"", 0};
        if (count_filled(line, p->separator) == 0)
            continue;
        for (int column = 0; column <= p->time; column++)
            cell = himc_span_cell(&line, p->separator);
        if (!read_number(&look, cell, "the time", &p->times[row++]))
            return false;
    }
    return rows > 1 || refuse(p, "one row: no rate");
}

// The rate, and the number of frames. Rows that are off an even rate by more than rounding are
// uneven: make_even moves them to times a median step apart.
static bool find_rate(plan *p, int rows)
{
    const double *t = p->times;
    double mean = (t[rows - 1] - t[0]) / (rows - 1), off = 0, least = mean, most = mean;
    double *step = malloc((size_t)rows * sizeof *step);
    for (int k = 1; step && k < rows; k++) {
        step[k - 1] = t[k] - t[k - 1];
        least = fmin(least, step[k - 1]), most = fmax(most, step[k - 1]);
        off = fmax(off, fabs(t[k] - t[0] - k * mean));
    }
    double usual = step ? himc_median(step, rows - 1) : NAN;
    free(step);
    if (!isfinite(usual))
        return himc_error_set(p->error, "%s: no memory for %d rows", p->take->file, rows);
    p->rate = 1 / mean;
    p->uneven = least > 0 && off > fmax(0.001, ROUNDED * mean);
    if (least <= 0 && mean > 0)
        himc_take_note(p->take,
                       "rate: the times do not rise with each row; the rows are read as even, "
                       "%.6g s apart",
                       mean);
    if (!p->uneven)
        return true;
    double frames = (t[rows - 1] - t[0]) / usual + 1.5;
    if (frames > (double)p->size / p->points)
        return himc_error_set(p->error,
                              "%s: rows are up to %.6g s apart, %.6g s usually, expected even ones",
                              p->take->file, most, usual);
    p->rate = 1 / usual;
    p->frames = (int)frames;
    if (most > 3 * usual)
        himc_take_note(p->take,
                       "rate: rows are up to %.4g s apart, %.4g s usually; they are read at even "
                       "times, on straight lines between two, and as gaps beyond %g s",
                       most, usual, BRIDGED);
    return true;
}

// the rows at even times: on straight lines between two
static bool make_even(plan *p, int rows)
{
    himc_take *take = p->take;
    size_t points = (size_t)take->points;
    himc_vec3 *even = malloc((size_t)p->frames * points * sizeof *even);
    if (!even)
        return himc_error_set(p->error, "%s: no memory for %d frames", take->file, p->frames);
    for (int frame = 0, row = 0; frame < p->frames; frame++) {
        double time = p->times[0] + frame / p->rate;
        while (row + 2 < rows && p->times[row + 1] <= time)
            row++;
        double apart = p->times[row + 1] - p->times[row],
               part = fmin((time - p->times[row]) / apart, 1);
        bool first = part<1e-6, second = part> 1 - 1e-6; // a row itself
        for (int i = 0; i < take->points; i++) {
            himc_vec3 a = *himc_take_at(take, row, i), b = *himc_take_at(take, row + 1, i);
            himc_vec3 between =
                apart > BRIDGED ? himc_vec3_gap() : himc_vec3_madd(a, part, himc_vec3_sub(b, a));
            even[(size_t)frame * points + (size_t)i] = first ? a : second ? b : between;
        }
    }
    free(take->x);
    take->x = even;
    take->frames = p->frames;
    return true;
}

static bool read_table(plan *p)
{
    himc_span line;
    int rows = count_rows(p);
    if (rows == 0)
        return refuse(p, "no rows");
    p->frames = rows;
    if (p->rate == 0 && !p->strict && !(read_times(p, rows) && find_rate(p, rows)))
        return false;
    if (p->size / (size_t)p->points < (size_t)rows)
        return refuse(p, "more markers than the rows have cells for");
    int most = p->frames > rows ? p->frames : rows;
    if (!himc_take_allocate(p->take, p->rate, most, p->points, false, p->error))
        return false;
    p->take->frames = rows;
    for (int i = 0; i < p->points; i++)
        himc_take_set_name(p->take, i, p->names[i].at, p->names[i].length);
    double first = NAN, last = NAN;
    for (int frame = 0; frame < rows && himc_text_line(&p->text, &line);) {
        if (count_filled(line, p->separator) == 0)
            continue;
        if (!read_row(p, line, frame, &last))
            return false;
        first = frame++ == 0 ? last : first;
    }
    // the time column beside a rate is not used; a note says if it disagrees by more than its
    // rounding
    double step = (last - first) / (rows - 1), said = 1 / p->rate;
    if (p->strict && rows > 1 && isfinite(step) && fabs(step - said) > 0.01 * said)
        himc_take_note(p->take,
                       "rate: the Time column steps by %.6g s, DataRate means %.6g s and is used",
                       step, said);
    return !p->uneven || make_even(p, rows);
}

static bool read_as(himc_take *take, const void *bytes, size_t size, char separator,
                    bool (*head)(plan *), himc_error *error)
{
    plan p = {.take = take,
              .text = himc_text_open(bytes, size),
              .size = size,
              .separator = separator,
              .frame = NOT_THERE,
              .time = NOT_THERE,
              .error = error};
    take->format_up = himc_vec3_make(0, 0, 1);
    bool good = head(&p) && read_table(&p);
    free(p.times);
    free(p.begin);
    free(p.names);
    return good;
}

bool himc_csv_read(himc_take *take, const void *bytes, size_t size, himc_error *error)
{
    static const char *const sections[] = {"trajectories",  "devices",  "joints",
                                           "model outputs", "segments", "events"};
    himc_text text = himc_text_open(bytes, size);
    himc_span line = {"", 0};
    himc_text_line(&text, &line);
    himc_span cell = himc_span_cell(&line, ',');
    bool (*head)(plan *) = himc_span_is(cell, "format version") ? read_motive : read_any;
    for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++)
        if (himc_span_is(cell, sections[i]))
            head = read_nexus;
    return read_as(take, bytes, size, ',', head, error);
}

bool himc_tsv_read(himc_take *take, const void *bytes, size_t size, himc_error *error)
{
    himc_text text = himc_text_open(bytes, size);
    himc_span line = {"", 0};
    himc_text_line(&text, &line);
    bool qualisys = line.length > 6 && himc_span_is((himc_span){line.at, 6}, "NO_OF_");
    return read_as(take, bytes, size, '\t', qualisys ? read_qualisys : read_any, error);
}

bool himc_trc_read(himc_take *take, const void *bytes, size_t size, himc_error *error)
{
    return read_as(take, bytes, size, '\t', read_trc, error);
}

// in millimetres, y up
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
