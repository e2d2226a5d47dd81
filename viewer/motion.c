/// motion.c: a motion is checked whole before it is served, so that a fault in it is a line in the
/// terminal. The page (motion.js) reads what passes here. The text is neither copied nor changed.
#include "motion.h"
#include "base/file.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)512 << 20) // of a motion; chosen: half an hour
#define NUMBER_SIZE 64                 // of a number with its zero; chosen: twice a double's digits

/// One line after the other.
typedef struct reader {
    const char *at, *text_end; // rest of the text
    const char *line, *end;    // this line, without its end
    long number;               // of the line, from 1
} reader;

static bool next_line(reader *r)
{
    if (r->at == r->text_end)
        return false;
    const char *end = memchr(r->at, '\n', (size_t)(r->text_end - r->at));
    r->line = r->at;
    r->end = end ? end : r->text_end;
    r->at = end ? end + 1 : r->text_end;
    r->end -= r->end > r->line && r->end[-1] == '\r';
    r->number++;
    return true;
}

static const char *cell_end(const reader *r, const char *cell)
{
    const char *comma = memchr(cell, ',', (size_t)(r->end - cell));
    return comma ? comma : r->end;
}

static long count_cells(const reader *r)
{
    long count = 1;
    for (const char *at = r->line; (at = cell_end(r, at)) < r->end; at++)
        count++;
    return count;
}

static bool read_number(const char *cell, const char *end, double *value)
{
    char word[NUMBER_SIZE];
    size_t length = (size_t)(end - cell);
    if (length >= sizeof word)
        return false;
    memcpy(word, cell, length);
    word[length] = 0;
    return himc_text_number(word, value) && isfinite(*value);
}

// a row of that many numbers, the first greater than `time`, which it becomes
static bool check_row(const reader *r, long columns, double *time, const char *name,
                      himc_error *error)
{
    double value, before = *time;
    const char *at = r->line;
    if (count_cells(r) != columns)
        return himc_error_set(error, "%.180s:%ld: %ld numbers, wanted %ld", name, r->number,
                              count_cells(r), columns);
    for (long i = 0; i < columns; i++, at = cell_end(r, at) + 1) {
        const char *end = cell_end(r, at);
        if (!read_number(at, end, &value))
            return himc_error_set(error, "%.180s:%ld: %.*s: not a number", name, r->number,
                                  (int)(end - at < 40 ? end - at : 40), at);
        if (i == 0 && !(value > before))
            return himc_error_set(error, "%.180s:%ld: time %g s, allowed only above %g s", name,
                                  r->number, value, before);
        if (i == 0)
            *time = value;
    }
    return true;
}

bool motion_check(const char *text, size_t size, const char *name, himc_error *error)
{
    static const char first[] = "time_s,";
    reader r = {.at = text, .text_end = text + size};
    double time = -INFINITY;
    long rows = 0;
    if (strlen(text) != size)
        return himc_error_set(error, "%.180s: not a text", name);
    if (!next_line(&r) || strncmp(r.line, first, sizeof first - 1) != 0)
        return himc_error_set(
            error, "%.180s:1: not a motion: its first column must be time_s (himc render --motion)",
            name);
    long columns = count_cells(&r);
    while (next_line(&r))
        if (r.line < r.end) {
            if (!check_row(&r, columns, &time, name, error))
                return false;
            rows++;
        }
    return rows >= 2 || himc_error_set(error, "%.180s: %ld rows, wanted at least 2", name, rows);
}

char *motion_load(const char *path, size_t *size, himc_error *error)
{
    char *text = himc_file_load(path, MOST_BYTES, size, error);
    if (text && motion_check(text, *size, path, error))
        return text;
    free(text);
    return NULL;
}
