/// grid.c: from a head's file, masses and springs, to modes.
///
/// Files. A table is rows of numbers, or a file in the Matrix Market exchange format (Boisvert,
/// Pozo & Remington 1996): a banner, % comments, a line of sizes, then entries: "row column value"
/// of a coordinate file, values column by column of an array; of a symmetric one the lower
/// triangle.
///
/// Modes. K v = w^2 M v, by Eigen (linear.h): Cholesky's M = L L' (which fails if M is not
/// positive), the standard problem of L^-1 K L^-T, its eigenvalues. A membrane's K grows
/// with its tension and its M with its density, so w = z/radius sqrt(T/sigma) with z = radius
/// sqrt(w0^2 sigma0/T0) serves any other tension and density, as a Bessel zero does for a round
/// head (round.c).
#include "head/grid.h"

#include "base/file.h"
#include "base/linear.h"
#include "himc/ranges.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE 1200       // longest file name (characters); chosen: a path fits
#define TEXT (64 << 20) // longest file (bytes); chosen: the largest matrix takes a quarter of it
#define POINTS 4000     // most places, moving or not; chosen: bounds the time to look for them
#define ROWS_AT_ONCE 64 // rows by which memory grows
#define ASYMMETRY 1e-9  // of the largest entry; chosen: rounding of text files
#define NEGATIVE 1e-9   // of the highest eigenvalue; chosen: more than rounding of text files
#define RIGID 1e-11     // of the same; chosen: rounding, below the bending of 800 places

typedef struct matrix {
    int rows, columns;
    double *value; // (rows, columns), owned
} matrix;

// a text in memory, read line by line
typedef struct reader {
    const char *path;
    int line, most;   // rows and columns allowed
    char *text;       // owned
    char *row, *next; // the present line, as a string, and the text after it
    const char *at;   // in the line
    himc_error *error;
} reader;

static bool fault(reader *r, const char *what)
{
    return himc_error_set(r->error, "%s:%d: %s", r->path, r->line, what);
}

static bool open_text(reader *r, const char *path, himc_error *error)
{
    size_t size = 0;
    *r = (reader){.path = path, .error = error, .text = himc_file_load(path, TEXT, &size, error)};
    r->next = r->text;
    if (!r->text || himc_text_check(r->text, size, path, error))
        return r->text;
    free(r->text);
    return false;
}

static bool next_line(reader *r)
{
    if (!*r->next)
        return false;
    r->at = r->row = r->next;
    r->next += strcspn(r->next, "\n");
    if (*r->next)
        *r->next++ = '\0';
    r->line++;
    return true;
}

// the next number of the line; false at its end or before anything else
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

// the next line that is neither empty nor a comment
static bool next_row(reader *r, char comment)
{
    while (next_line(r))
        if (r->row[strspn(r->row, " \t\r")] != '\0' && r->row[0] != comment)
            return true;
    return false;
}

static bool check_size(reader *r, double rows, double columns, himc_error *error)
{
    if (!himc_check_range("rows", rows, 1, r->most, "", error) ||
        !himc_check_range("columns", columns, 1, r->most, "", error))
        return himc_error_prefix(error, "%s:%d", r->path, r->line);
    return true;
}

// room for `rows` rows; new entries are 0
static bool set_size(reader *r, matrix *m, int rows, int columns)
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

static bool read_rows(reader *r, matrix *m, int columns)
{
    double value;
    int rows = 0;
    if (columns == 0) { // as many as the first row has
        while (next_number(r, &value))
            columns++;
        r->at = r->row;
    }
    do {
        if (!check_size(r, rows + 1, columns, r->error) ||
            (rows % ROWS_AT_ONCE == 0 && !set_size(r, m, rows + ROWS_AT_ONCE, columns)))
            return false;
        for (int j = 0; j < columns; j++)
            if (!next_number(r, &m->value[rows * columns + j]))
                return himc_error_set(r->error, "%s:%d: number %d of %d is missing or not a number",
                                      r->path, r->line, j + 1, columns);
        if (r->at[strspn(r->at, " \t\r\n,")] != '\0')
            return himc_error_set(r->error, "%s:%d: more than %d numbers, or text after them",
                                  r->path, r->line, columns);
        rows++;
    } while (next_row(r, '#'));
    m->rows = rows;
    return true;
}

static void put(matrix *m, int i, int j, double value, bool symmetric)
{
    m->value[i * m->columns + j] += value;
    if (symmetric && i != j)
        m->value[j * m->columns + i] += value;
}

static bool read_market(reader *r, matrix *m)
{
    char format[16], field[16], kind[16];
    double rows, columns, entries = 0, row, column, value;
    if (sscanf(r->row, "%%%%MatrixMarket matrix %15s %15s %15s", format, field, kind) != 3)
        return fault(r, "expected %%MatrixMarket matrix coordinate|array real general|symmetric");
    bool coordinate = strcmp(format, "coordinate") == 0, symmetric = strcmp(kind, "symmetric") == 0;
    if ((!coordinate && strcmp(format, "array") != 0) ||
        (strcmp(field, "real") != 0 && strcmp(field, "integer") != 0) ||
        (!symmetric && strcmp(kind, "general") != 0))
        return fault(r, "expected coordinate or array, real or integer, general or symmetric");
    if (!next_row(r, '%') || !next_number(r, &rows) || !next_number(r, &columns) ||
        (coordinate && !next_number(r, &entries)))
        return fault(r, "the matrix's size is missing");
    if (!check_size(r, rows, columns, r->error) || !set_size(r, m, (int)rows, (int)columns))
        return false;
    if (symmetric && rows != columns)
        return fault(r, "symmetric, but not square");
    for (double k = 0; k < entries; k++) {
        if (!next_row(r, '%') || !next_number(r, &row) || !next_number(r, &column) ||
            !next_number(r, &value))
            return fault(r, "an entry is missing or not \"row column value\"");
        if (row < 1 || row > rows || column < 1 || column > columns || row != floor(row) ||
            column != floor(column))
            return fault(r, "row or column outside the matrix");
        put(m, (int)row - 1, (int)column - 1, value, symmetric);
    }
    for (int j = 0; j < m->columns && !coordinate; j++)
        for (int i = symmetric ? j : 0; i < m->rows; i++) {
            if (!next_row(r, '%') || !next_number(r, &value))
                return fault(r, "a value is missing or not a number");
            put(m, i, j, value, symmetric);
        }
    return true;
}

// Reads a table, of at most `most` rows and columns. With `columns` > 0, rows must have so many
// numbers. False with "file:line: ..." if anything in it is wrong.
static bool load_matrix(matrix *out, const char *path, int most, int columns, himc_error *error)
{
    reader r;
    matrix m = {0};
    if (!open_text(&r, path, error))
        return false;
    r.most = most;
    bool good = next_row(&r, '#');
    if (!good)
        himc_error_set(error, "%s: empty", path);
    else if (r.row[0] == '%')
        good = read_market(&r, &m);
    else
        good = read_rows(&r, &m, columns);
    if (good && columns > 0 && m.columns != columns)
        good =
            himc_error_set(error, "%s: rows of %d numbers, expected %d", path, m.columns, columns);
    free(r.text);
    if (!good)
        free(m.value);
    else
        *out = m;
    return good;
}

// the contents of a head's file
typedef struct parts {
    double tension, density;
    matrix places, mass, stiffness;
} parts;

// the file `name` beside the file `path`
static bool beside(const char *path, const char *name, char *out, size_t size, himc_error *error)
{
    const char *slash = name[0] == '/' ? NULL : strrchr(path, '/');
    int folder = slash ? (int)(slash - path) + 1 : 0;
    int length = snprintf(out, size, "%.*s%s", folder, path, name);
    return (length >= 0 && (size_t)length < size) ||
           himc_error_set(error, "a file name of more than %zu characters", size - 1);
}

static bool read_item(parts *p, const char *path, const char *key, const char *value,
                      himc_error *error)
{
    char file[LINE], *end;
    double *number = strcmp(key, "tension") == 0   ? &p->tension
                     : strcmp(key, "density") == 0 ? &p->density
                                                   : NULL;
    matrix *table = strcmp(key, "places") == 0      ? &p->places
                    : strcmp(key, "mass") == 0      ? &p->mass
                    : strcmp(key, "stiffness") == 0 ? &p->stiffness
                                                    : NULL;
    if (number) {
        *number = strtod(value, &end);
        if (*value == '\0' || *end)
            return himc_error_set(error, "%s: %.60s, expected a number", key, value);
        return himc_check_range(key, *number, 1e-3, 1e5, number == &p->tension ? "N/m" : "kg/m2",
                                error);
    }
    if (!table)
        return himc_error_set(
            error, "%.60s: unknown, expected tension density places mass stiffness", key);
    if (table->value)
        return himc_error_set(error, "%s: named twice", key);
    bool places = table == &p->places;
    return beside(path, value, file, sizeof file, error) &&
           load_matrix(table, file, places ? POINTS : HIMC_GRID_PLACES, places ? 2 : 0, error);
}

static bool read_parts(parts *p, reader *r)
{
    char key[64], value[LINE];
    while (next_line(r)) {
        r->row[strcspn(r->row, "#")] = '\0';
        value[0] = '\0';
        if (sscanf(r->row, "%63s %1199s", key, value) >= 1 &&
            !read_item(p, r->path, key, value, r->error))
            return himc_error_prefix(r->error, "%s:%d", r->path, r->line);
    }
    return true;
}

static bool check_matrix(const matrix *a, const char *name, const matrix *places, himc_error *error)
{
    if (!a->value)
        return himc_error_set(error, "%s: missing", name);
    if (a->rows != a->columns)
        return himc_error_set(error, "%s: %d rows of %d numbers, expected a square matrix", name,
                              a->rows, a->columns);
    if (a->rows > places->rows)
        return himc_error_set(error, "%s: %d rows but %d places", name, a->rows, places->rows);
    double most = 0;
    for (int i = 0; i < a->rows * a->columns; i++)
        most = fmax(most, fabs(a->value[i]));
    for (int i = 0; i < a->rows; i++)
        for (int j = 0; j < i; j++) {
            double upper = a->value[j * a->columns + i], lower = a->value[i * a->columns + j];
            if (fabs(upper - lower) > ASYMMETRY * most)
                return himc_error_set(error, "%s: not symmetric: (%d, %d) is %g, (%d, %d) is %g",
                                      name, j + 1, i + 1, upper, i + 1, j + 1, lower);
        }
    return true;
}

static bool check_parts(const parts *p, himc_error *error)
{
    if (p->tension == 0 || p->density == 0)
        return himc_error_set(error, "%s: missing", p->tension == 0 ? "tension" : "density");
    if (!p->places.value)
        return himc_error_set(error, "places: missing");
    if (!check_matrix(&p->mass, "mass", &p->places, error) ||
        !check_matrix(&p->stiffness, "stiffness", &p->places, error))
        return false;
    return p->mass.rows == p->stiffness.rows ||
           himc_error_set(error, "mass: %d rows, stiffness: %d, expected the same", p->mass.rows,
                          p->stiffness.rows);
}

// with a mode for each place that moves
static himc_grid *grid_new(int places, int all, const char *path)
{
    himc_grid *g = calloc(1, sizeof *g);
    if (!g)
        return NULL;
    g->references = 1;
    g->places = g->modes = places;
    g->all = all;
    g->path = malloc(strlen(path) + 1);
    g->x = malloc(sizeof(double) * (size_t)all);
    g->y = malloc(sizeof(double) * (size_t)all);
    g->area = malloc(sizeof(double) * (size_t)places);
    g->zero = malloc(sizeof(double) * (size_t)places);
    g->norm = malloc(sizeof(double) * (size_t)places);
    g->shape = malloc(sizeof(double) * (size_t)places * (size_t)places);
    if (!g->path || !g->x || !g->y || !g->area || !g->zero || !g->norm || !g->shape) {
        himc_grid_release(g);
        return NULL;
    }
    memcpy(g->path, path, strlen(path) + 1);
    return g;
}

// places from the centre of the smallest box around them, per radius
static void set_places(himc_grid *g, const matrix *places)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int i = 0; i < 2 * g->all; i++) {
        low[i % 2] = fmin(low[i % 2], places->value[i]);
        high[i % 2] = fmax(high[i % 2], places->value[i]);
    }
    for (int i = 0; i < g->all; i++) {
        g->x[i] = places->value[2 * i] - 0.5 * (low[0] + high[0]);
        g->y[i] = places->value[2 * i + 1] - 0.5 * (low[1] + high[1]);
        g->radius = fmax(g->radius, hypot(g->x[i], g->y[i]));
    }
    for (int i = 0; i < g->all; i++) {
        g->x[i] /= g->radius;
        g->y[i] /= g->radius;
    }
}

// Takes the modes that bend; the eigenvalues are in `zero`, rising. In the first ones a free body
// moves without bending: their eigenvalues are 0 but for rounding.
static bool take_modes(himc_grid *g, himc_error *error)
{
    double highest = g->zero[g->modes - 1];
    int rigid = 0;
    if (g->zero[0] < -NEGATIVE * fabs(highest))
        return himc_error_set(error,
                              "stiffness: negative: its lowest eigenvalue is %g 1/s2, its highest "
                              "%g, expected from 0",
                              g->zero[0], highest);
    while (rigid < g->modes && !(g->zero[rigid] > RIGID * highest))
        rigid++;
    if (rigid == g->modes)
        return himc_error_set(error, "stiffness: 0, expected one that resists bending");
    g->free = rigid > 0;
    g->modes -= rigid;
    memmove(g->zero, g->zero + rigid, sizeof *g->zero * (size_t)g->modes);
    memmove(g->shape, g->shape + (size_t)rigid * (size_t)g->places,
            sizeof *g->shape * (size_t)g->modes * (size_t)g->places);
    double area = HIMC_PI * g->radius * g->radius;
    for (int k = 0; k < g->modes; k++) {
        // the shape as it was found, v' M v = 1, to a largest value of 1
        double *v = g->shape + (size_t)k * (size_t)g->places, most = 0;
        for (int i = 0; i < g->places; i++)
            most = fabs(v[i]) > fabs(most) ? v[i] : most;
        for (int i = 0; i < g->places; i++)
            v[i] /= most;
        g->norm[k] = 1 / (most * most * g->density * area);
        g->zero[k] = g->radius * sqrt(g->zero[k] * g->density / g->tension);
    }
    return true;
}

static bool solve(himc_grid *g, parts *p, himc_error *error)
{
    int n = g->places;
    for (int i = 0; i < n; i++) {
        g->area[i] = 0;
        for (int j = 0; j < n; j++)
            g->area[i] += p->mass.value[i * n + j] / (g->density * g->radius * g->radius);
    }
    switch (himc_linear_vibrations(n, p->stiffness.value, p->mass.value, g->zero, g->shape)) {
    case HIMC_LINEAR_SOLVED: return take_modes(g, error);
    case HIMC_LINEAR_NO_MEMORY: return himc_error_set(error, "no memory for %d places", n);
    case HIMC_LINEAR_NOT_DEFINITE:
        return himc_error_set(error, "mass: not positive definite, expected one that gives every "
                                     "motion kinetic energy");
    default: return himc_error_set(error, "no modes found");
    }
}

static himc_grid *make(parts *p, const char *path, himc_error *error)
{
    if (!check_parts(p, error))
        return NULL;
    int n = p->mass.rows;
    himc_grid *g = grid_new(n, p->places.rows, path);
    if (!g) {
        himc_error_set(error, "no memory for %d places", n);
        return NULL;
    }
    g->tension = p->tension;
    g->density = p->density;
    set_places(g, &p->places);
    if (himc_check_range("radius of all places", g->radius, HIMC_RADIUS_MIN, HIMC_RADIUS_MAX, "m",
                         error) &&
        solve(g, p, error))
        return g;
    himc_grid_release(g);
    return NULL;
}

himc_grid *himc_grid_load(const char *path, himc_error *error)
{
    parts p = {0};
    reader r;
    himc_grid *grid = NULL;
    if (!open_text(&r, path, error))
        return NULL;
    if (read_parts(&p, &r)) {
        grid = make(&p, path, error);
        if (!grid)
            himc_error_prefix(error, "%s", path);
    }
    free(r.text);
    free(p.places.value);
    free(p.mass.value);
    free(p.stiffness.value);
    return grid;
}
