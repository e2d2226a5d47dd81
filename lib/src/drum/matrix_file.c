/// matrix_file.c: rows of numbers, or the Matrix Market exchange format (Boisvert, Pozo & Remington
/// 1996): a banner, % comments, a line of sizes, then entries: "row column value" of a coordinate
/// file, values column by column of an array; of a symmetric one the lower triangle.
#include "drum/matrix_file.h"

#include "drum/grid.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct reader {
    FILE *file;
    const char *path;
    int line;
    char *text; // of the line, owned
    size_t size;
    const char *at; // in it
    himc_error *error;
} reader;

static bool fault(reader *r, const char *what)
{
    return himc_error_set(r->error, "%s:%d: %s", r->path, r->line, what);
}

// a whole line, however long; false at the file's end
static bool next_line(reader *r)
{
    size_t used = 0;
    for (;;) {
        if (r->size - used < 4096) {
            char *more = realloc(r->text, r->size * 2 + 8192);
            if (!more)
                return false;
            r->text = more;
            r->size = r->size * 2 + 8192;
        }
        if (!fgets(r->text + used, (int)(r->size - used < 1 << 30 ? r->size - used : 1 << 30),
                   r->file))
            break;
        size_t got = strlen(r->text + used);
        used += got;
        if (got == 0) // bytes of nothing are no text
            return false;
        if (used > 0 && r->text[used - 1] == '\n')
            break;
    }
    r->line += used > 0;
    r->at = r->text;
    return used > 0;
}

// the next number of the line; false at its end or at what is no number
static bool next_number(reader *r, double *value)
{
    char *end;
    while (isspace((unsigned char)*r->at) || *r->at == ',')
        r->at++;
    *value = strtod(r->at, &end);
    bool found = end != r->at && isfinite(*value);
    r->at = end;
    return found;
}

static bool at_end(const reader *r)
{
    return r->at[strspn(r->at, " \t\r\n,")] == '\0';
}

// the next line that says something
static bool next_row(reader *r, char comment)
{
    while (next_line(r))
        if (r->text[strspn(r->text, " \t\r\n")] != '\0' && r->text[0] != comment)
            return true;
    return false;
}

static bool check_size(reader *r, double rows, double columns, himc_error *error)
{
    if (!himc_check_range("rows", rows, 1, HIMC_GRID_PLACES, "", error) ||
        !himc_check_range("columns", columns, 1, HIMC_GRID_PLACES, "", error))
        return himc_error_prefix(error, "%s:%d", r->path, r->line);
    return true;
}

static bool allot(reader *r, matrix *m, int rows, int columns)
{
    double *value = realloc(m->value, sizeof *value * (size_t)rows * (size_t)columns);
    if (!value)
        return fault(r, "no memory for so large a matrix");
    memset(value + (size_t)m->rows * (size_t)columns, 0,
           sizeof *value * (size_t)(rows - m->rows) * (size_t)columns);
    m->rows = rows;
    m->columns = columns;
    m->value = value;
    return true;
}

// numbers in the present line
static int count_numbers(reader *r)
{
    double value;
    int count = 0;
    while (next_number(r, &value))
        count++;
    r->at = r->text;
    return count;
}

static bool read_rows(reader *r, matrix *m, int columns)
{
    int rows = 0;
    do {
        if (columns == 0)
            columns = count_numbers(r);
        if (!check_size(r, rows + 1, columns, r->error) ||
            (rows % 64 == 0 && !allot(r, m, rows + 64, columns)))
            return false;
        for (int j = 0; j < columns; j++)
            if (!next_number(r, &m->value[rows * columns + j]))
                return himc_error_set(r->error, "%s:%d: number %d of %d is missing or not one",
                                      r->path, r->line, j + 1, columns);
        if (!at_end(r))
            return himc_error_set(r->error, "%s:%d: more than %d numbers, or something else",
                                  r->path, r->line, columns);
        rows++;
    } while (next_row(r, '#'));
    m->rows = rows;
    return true;
}

static bool put(matrix *m, int i, int j, double value, bool symmetric)
{
    m->value[i * m->columns + j] += value;
    if (symmetric && i != j)
        m->value[j * m->columns + i] += value;
    return true;
}

static bool read_entry(reader *r, matrix *m, bool symmetric)
{
    double i, j, value;
    if (!next_row(r, '%') || !next_number(r, &i) || !next_number(r, &j) || !next_number(r, &value))
        return fault(r, "an entry is missing or not \"row column value\"");
    if (i < 1 || i > m->rows || j < 1 || j > m->columns || i != floor(i) || j != floor(j))
        return fault(r, "row or column outside the matrix");
    return put(m, (int)i - 1, (int)j - 1, value, symmetric);
}

static bool read_array(reader *r, matrix *m, bool symmetric)
{
    double value;
    for (int j = 0; j < m->columns; j++)
        for (int i = symmetric ? j : 0; i < m->rows; i++) {
            if (!next_row(r, '%') || !next_number(r, &value))
                return fault(r, "a value is missing or not a number");
            put(m, i, j, value, symmetric);
        }
    return true;
}

static bool read_market(reader *r, matrix *m)
{
    char format[16], field[16], kind[16];
    double rows, columns, entries = 0;
    if (sscanf(r->text, "%%%%MatrixMarket matrix %15s %15s %15s", format, field, kind) != 3)
        return fault(r, "allowed %%MatrixMarket matrix coordinate|array real general|symmetric");
    bool coordinate = strcmp(format, "coordinate") == 0, symmetric = strcmp(kind, "symmetric") == 0;
    if ((!coordinate && strcmp(format, "array") != 0) ||
        (strcmp(field, "real") != 0 && strcmp(field, "integer") != 0) ||
        (!symmetric && strcmp(kind, "general") != 0))
        return fault(r, "allowed coordinate or array, real or integer, general or symmetric");
    if (!next_row(r, '%') || !next_number(r, &rows) || !next_number(r, &columns) ||
        (coordinate && !next_number(r, &entries)))
        return fault(r, "the matrix's size is missing");
    if (!check_size(r, rows, columns, r->error) || !allot(r, m, (int)rows, (int)columns))
        return false;
    if (symmetric && rows != columns)
        return fault(r, "symmetric, but not square");
    for (double k = 0; k < entries; k++)
        if (!read_entry(r, m, symmetric))
            return false;
    return coordinate || read_array(r, m, symmetric);
}

FILE *himc_open_regular(const char *path, himc_error *error)
{
    struct stat status;
    FILE *file = stat(path, &status) == 0 ? fopen(path, "r") : NULL;
    if (file && S_ISREG(status.st_mode))
        return file;
    himc_error_set(error, "%s: %s", path, file ? "not a file" : strerror(errno));
    if (file)
        fclose(file);
    return NULL;
}

bool himc_matrix_load(matrix *out, const char *path, int columns, himc_error *error)
{
    reader r = {.file = himc_open_regular(path, error), .path = path, .error = error};
    matrix m = {0};
    if (!r.file)
        return false;
    bool good = next_row(&r, '#');
    if (!good)
        himc_error_set(error, "%s: empty", path);
    else if (r.text[0] == '%')
        good = read_market(&r, &m);
    else
        good = read_rows(&r, &m, columns);
    if (good && columns > 0 && m.columns != columns)
        good =
            himc_error_set(error, "%s: rows of %d numbers, allowed %d", path, m.columns, columns);
    fclose(r.file);
    free(r.text);
    if (!good)
        free(m.value);
    else
        *out = m;
    return good;
}
