/// evaluate_log.c: the same table of columns writes and reads a row. Numbers are written with nine
/// digits, so reading returns them to 1e-9 of their size.
#define _POSIX_C_SOURCE 200809L
#include "evaluate_log.h"
#include "base/file.h"
#include "control/controller.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct column {
    const char *name;
    size_t at;    ///< in a trial_result
    double scale; ///< the column is the field times this
} column;

#define AT(field) offsetof(trial_result, field)
#define DEGREES (180 / HIMC_PI)

static const column columns[] = {
    {"rms_mm", AT(rms), 1e3},
    {"outside_mm", AT(outside), 1e3},
    {"amplitude_mm", AT(amplitude), 1e3},
    {"elbow_range_ratio", AT(elbow), 1},
    {"shoulder_deg", AT(shoulder_error), DEGREES},
    {"elbow_deg", AT(elbow_error), DEGREES},
    {"wrist_deg", AT(wrist_error), DEGREES},
    {"strokes", AT(strokes), 1},
    {"played", AT(played), 1},
};

#define COLUMNS ((int)(sizeof columns / sizeof *columns))
#define KEY "nuance,controller,law,trial"
#define FIELDS (4 + COLUMNS)
// relative; of one program, on processors whose C library has other last digits of a sine
// (measured: 7e-5 in `himc` with the printed law); as in tests/docs/test_docs.sh
#define SAME 5e-4

static double *field(trial_result *result, size_t at)
{
    return (double *)(void *)((char *)result + at);
}

bool trial_table_make(trial_table *table, int trials, himc_error *error)
{
    size_t count = (size_t)trials * TRIAL_KINDS;
    table->trials = trials;
    table->result = calloc(count, sizeof *table->result);
    table->known = calloc(count, sizeof *table->known);
    return (table->result && table->known) || himc_error_set(error, "out of memory");
}

void trial_table_free(trial_table *table)
{
    free(table->result);
    free(table->known);
}

int trial_index(const trial_table *table, int kind, int number)
{
    return kind * table->trials + number - 1;
}

int trial_number_of(const trial_table *table, int index)
{
    return index % table->trials + 1;
}

trial_kind trial_kind_of(const trial_table *table, int index)
{
    int kind = index / table->trials, control = kind % TRIAL_CONTROLS;
    trial_kind out = {(himc_nuance)(kind / TRIAL_CONTROLS), HIMC_PIPELINE_IK,
                      HIMC_LAW_COMPUTED_TORQUE};
    if (control > 0) {
        out.controller = control <= HIMC_LAW_COUNT ? HIMC_PIPELINE_ID : HIMC_PIPELINE_HIMC;
        out.law = (himc_law)((control - 1) % HIMC_LAW_COUNT);
    }
    return out;
}

/// Mean and standard deviation over the known trials.
typedef struct statistics {
    int count;
    double mean, deviation;
} statistics;

static statistics statistics_of(const trial_table *table, int kind, size_t at)
{
    statistics s = {0};
    double squares = 0;
    for (int number = 1; number <= table->trials; number++) {
        int i = trial_index(table, kind, number);
        if (!table->known[i])
            continue;
        double before = s.mean, value = *field(&table->result[i], at);
        s.mean += (value - before) / ++s.count; // Welford 1962
        squares += (value - before) * (value - s.mean);
    }
    s.deviation = s.count > 1 ? sqrt(squares / (s.count - 1)) : NAN;
    return s;
}

static void print_key(const trial_table *table, int index, FILE *stream)
{
    trial_kind kind = trial_kind_of(table, index);
    fprintf(stream, "%s,%s,%s", himc_nuance_name(kind.nuance),
            trial_controller_name(kind.controller).text, trial_law_name(&kind).text);
}

void trial_table_print(const trial_table *table, FILE *stream)
{
    fputs("nuance,controller,law,trials,rms_mm,rms_sd_mm,amplitude_mm,rms_percent,"
          "elbow_range_ratio\n",
          stream);
    for (int kind = 0; kind < TRIAL_KINDS; kind++) {
        statistics rms = statistics_of(table, kind, AT(rms));
        double amplitude = statistics_of(table, kind, AT(amplitude)).mean;
        if (rms.count == 0)
            continue;
        print_key(table, trial_index(table, kind, 1), stream);
        fprintf(stream, ",%d,%.5f,%.5f,%.3f,%.5f,%.4f\n", rms.count, 1e3 * rms.mean,
                1e3 * rms.deviation, 1e3 * amplitude, 100 * rms.mean / amplitude,
                statistics_of(table, kind, AT(elbow)).mean);
    }
}

static int find_kind(const trial_table *table, char *const key[3])
{
    for (int kind = 0; kind < TRIAL_KINDS; kind++) {
        trial_kind k = trial_kind_of(table, trial_index(table, kind, 1));
        if (!strcmp(key[0], himc_nuance_name(k.nuance)) &&
            !strcmp(key[1], trial_controller_name(k.controller).text) &&
            !strcmp(key[2], trial_law_name(&k).text))
            return kind;
    }
    return -1;
}

// splits a row at its commas; returns the number of fields
static int split(char *row, char *fields[FIELDS])
{
    int count = 0;
    for (char *at = row; at; count++) {
        char *comma = strchr(at, ',');
        if (count < FIELDS)
            fields[count] = at;
        if (comma)
            *comma++ = '\0';
        at = comma;
    }
    return count;
}

static bool read_number(const char *text, double *out)
{
    char *end;
    *out = strtod(text, &end);
    return end != text && !*end && isfinite(*out);
}

// `*index` is -1 of a trial beyond the table
static bool read_row(trial_table *table, char *row, int *index, himc_error *error)
{
    char *fields[FIELDS];
    double number, value;
    int count = split(row, fields), kind = count == FIELDS ? find_kind(table, fields) : -1;
    if (kind < 0)
        return himc_error_set(error, "not a row of trials, expected %s and %d numbers", KEY,
                              COLUMNS);
    if (!read_number(fields[3], &number) || number != floor(number) || number < 1)
        return himc_error_set(error, "trial: %s, expected 1 .. %d", fields[3], TRIALS_MAX);
    *index = number > table->trials ? -1 : trial_index(table, kind, (int)number);
    if (*index < 0)
        return true;
    for (int i = 0; i < COLUMNS; i++) {
        if (!read_number(fields[4 + i], &value))
            return himc_error_set(error, "%s: %s is not a number", columns[i].name, fields[4 + i]);
        *field(&table->result[*index], columns[i].at) = value / columns[i].scale;
    }
    return table->known[*index] = true;
}

// a row with forces is the better sample: `ik` stays the same when a law or the contact changes
static bool keep_sample(evaluate_log *log, const trial_table *table, int line, int index,
                        bool *begun, himc_error *error)
{
    bool forces = trial_kind_of(table, index).controller != HIMC_PIPELINE_IK;
    evaluate_sample row = {line, index, table->result[index]};
    if (!*begun) {
        size_t size = (size_t)(log->samples + 1) * sizeof *log->sample;
        evaluate_sample *grown = realloc(log->sample, size);
        if (!grown)
            return himc_error_set(error, "out of memory");
        log->sample = grown;
        log->sample[log->samples++] = row;
    } else if (forces) {
        log->sample[log->samples - 1] = row;
    }
    return *begun = true;
}

// the header line, without its newline
static void name_columns(char *text, size_t size)
{
    size_t used = (size_t)snprintf(text, size, "%s", KEY);
    for (int i = 0; i < COLUMNS; i++)
        used += (size_t)snprintf(text + used, size - used, ",%s", columns[i].name);
}

// reads all complete rows; `*end` is the end of the last one. A file that is not a log is refused
// and stays unchanged
static bool read_rows(evaluate_log *log, trial_table *table, off_t *end, himc_error *error)
{
    char *row = NULL, header[256];
    size_t room = 0;
    ssize_t length;
    int index = -1;
    bool good = true, begun = false;
    *end = 0;
    name_columns(header, sizeof header);
    for (int line = 1; good && (length = getline(&row, &room, log->stream)) > 0; line++) {
        bool whole = row[length - 1] == '\n';
        if (!whole && (line > 1 || !strncmp(row, header, (size_t)length)))
            break; // an interrupted write: this trial will be repeated
        row[length - whole] = '\0';
        *end += length;
        if (strcmp(row, header) == 0) {
            begun = false; // logs joined by cat have several
            continue;
        }
        good = line > 1 ? read_row(table, row, &index, error)
                        : himc_error_set(error,
                                         "not a log of trials, expected a file that begins with %s",
                                         header);
        good = good && (index < 0 || keep_sample(log, table, line, index, &begun, error));
        if (!good)
            himc_error_prefix(error, "%s:%d", log->path, line);
    }
    free(row);
    return good;
}

bool evaluate_log_check(const evaluate_log *log, int sample, const trial_result *now,
                        himc_error *error)
{
    const evaluate_sample *s = &log->sample[sample];
    trial_result old = s->result, new = *now;
    for (int i = 0; i < COLUMNS; i++) {
        double then = *field(&old, columns[i].at), is = *field(&new, columns[i].at);
        if (!(fabs(then - is) <= SAME * fabs(is)))
            return himc_error_set(error,
                                  "%s:%d: %s: %.9g, expected %.9g: a log of another program, or a "
                                  "row that was changed; expected a new log",
                                  log->path, s->line, columns[i].name, then * columns[i].scale,
                                  is * columns[i].scale);
    }
    return true;
}

static bool begin(evaluate_log *log, himc_error *error)
{
    char header[256];
    name_columns(header, sizeof header);
    fprintf(log->stream, "%s\n", header);
    return fflush(log->stream) == 0 ||
           himc_error_set(error, "%s: cannot be written: %s", log->path, strerror(errno));
}

bool evaluate_log_open(evaluate_log *log, const char *path, trial_table *table, himc_error *error)
{
    off_t end;
    if (!path)
        return true;
    snprintf(log->path, sizeof log->path, "%s", path);
    log->stream = himc_file_write(path, HIMC_FILE_CONTINUE, error);
    if (!log->stream || !read_rows(log, table, &end, error))
        return false;
    if (ftruncate(fileno(log->stream), end) || fseek(log->stream, 0, SEEK_END))
        return himc_error_set(error, "%s: cannot be continued: %s", path, strerror(errno));
    return end > 0 || begin(log, error);
}

bool evaluate_log_add(evaluate_log *log, const trial_table *table, int index, himc_error *error)
{
    trial_result result = table->result[index];
    if (!log->stream)
        return true;
    print_key(table, index, log->stream);
    fprintf(log->stream, ",%d", trial_number_of(table, index));
    for (int i = 0; i < COLUMNS; i++)
        fprintf(log->stream, ",%.9g", *field(&result, columns[i].at) * columns[i].scale);
    fputc('\n', log->stream);
    return fflush(log->stream) == 0 ||
           himc_error_set(error, "%s: cannot be written: %s", log->path, strerror(errno));
}

void evaluate_log_close(evaluate_log *log)
{
    if (log->stream)
        fclose(log->stream);
    log->stream = NULL;
    free(log->sample);
    log->sample = NULL;
    log->samples = 0;
}
