/// outline.c: a rectangle in closed form, and any head known at places.
///
/// Rectangle A x B: phi = sin(m pi (x/A + 1/2)) sin(n pi (y/B + 1/2)), wavenumber pi hypot(m/A,
/// n/B) (Morse & Ingard 1968, section 5.2). Its transform is a product of two of
///     int_0^1 sin(m pi u) exp(i s (u - 1/2)) du = m pi/(m^2 pi^2 - s^2) {2 cos s/2 | 2 i sin s/2}
/// for m odd | even (up to sign).
///
/// Grid: between places a shape is a plane fitted to the nearest eight by least squares, with
/// weights that are infinite at a place and 0 at the ninth, so that it passes through the places
/// and has no steps as the neighbours change (moving least squares: Lancaster & Salkauskas 1981).
#include "drum/outline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEAREST 8

static void sides(const himc_shape *shape, double *a, double *b)
{
    double diagonal = hypot(shape->length, shape->width);
    *a = 2 * shape->length / diagonal;
    *b = 2 * shape->width / diagonal;
}

double himc_outline_area(const himc_shape *shape)
{
    double a, b, sum = 0;
    if (shape->kind == HIMC_RECTANGLE) {
        sides(shape, &a, &b);
        return a * b;
    }
    for (int i = 0; i < shape->grid->places; i++)
        sum += shape->grid->area[i];
    return sum;
}

static int by_frequency(const void *a, const void *b)
{
    const outline_mode *p = a, *q = b;
    return p->z != q->z ? (p->z > q->z) - (p->z < q->z) : p->m - q->m;
}

// Weyl: z^2 area/(4 pi) modes below z, less the rim's; so up to a generous top all are listed
static bool list_rectangle(const himc_shape *shape, int count, outline_mode *modes)
{
    double a, b;
    sides(shape, &a, &b);
    double rim = (a + b) / (2 * HIMC_PI), area = a * b / (4 * HIMC_PI);
    double top = (rim + sqrt(rim * rim + 4 * area * (count + 4))) / (2 * area) + 2 / fmin(a, b) * 4;
    int most = (int)(top * a / HIMC_PI) + 1, found = 0;
    outline_mode *all = malloc(sizeof *all * (size_t)most * (size_t)(top * b / HIMC_PI + 1));
    if (!all)
        return false;
    for (int m = 1; m * HIMC_PI / a <= top; m++)
        for (int n = 1; hypot(m / a, n / b) * HIMC_PI <= top; n++)
            all[found++] =
                (outline_mode){m, n, hypot(m / a, n / b) * HIMC_PI, a * b / (4 * HIMC_PI)};
    qsort(all, (size_t)found, sizeof *all, by_frequency);
    bool enough = found >= count;
    if (enough)
        memcpy(modes, all, sizeof *all * (size_t)count);
    free(all);
    return enough;
}

bool himc_outline_modes(const himc_shape *shape, int count, outline_mode *modes)
{
    if (shape->kind == HIMC_RECTANGLE)
        return list_rectangle(shape, count, modes);
    const himc_grid *g = shape->grid;
    for (int i = 0; i < count; i++)
        modes[i] = (outline_mode){0, i + 1, g->zero[i], g->norm[i]};
    return count <= g->modes;
}

// where a shape is read off a grid
typedef struct blend {
    int count, place[NEAREST];
    double weight[NEAREST];
} blend;

// the nearest places with their squared distances, rising; one more than is used
static void find_nearest(const himc_grid *g, double x, double y, int *place, double *square)
{
    for (int k = 0; k <= NEAREST; k++)
        square[k] = INFINITY;
    for (int i = 0; i < g->all; i++) {
        double dx = g->x[i] - x, dy = g->y[i] - y, d = dx * dx + dy * dy;
        if (!(d < square[NEAREST]))
            continue;
        int k = NEAREST;
        for (; k > 0 && square[k - 1] > d; k--) {
            square[k] = square[k - 1];
            place[k] = place[k - 1];
        }
        square[k] = d;
        place[k] = i;
    }
}

// the plane's value at (x, y) as a sum over places: weights w (1 + what centres them)
static void fit_plane(const himc_grid *g, double x, double y, blend *b)
{
    double w = 0, mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
    for (int k = 0; k < b->count; k++) {
        double dx = g->x[b->place[k]] - x, dy = g->y[b->place[k]] - y;
        w += b->weight[k];
        mx += b->weight[k] * dx;
        my += b->weight[k] * dy;
    }
    mx /= w;
    my /= w;
    for (int k = 0; k < b->count; k++) {
        double dx = g->x[b->place[k]] - x - mx, dy = g->y[b->place[k]] - y - my;
        b->weight[k] /= w;
        xx += b->weight[k] * dx * dx;
        xy += b->weight[k] * dx * dy;
        yy += b->weight[k] * dy * dy;
    }
    double det = xx * yy - xy * xy;
    bool flat = !(det > 1e-9 * (xx + yy) * (xx + yy)); // places in a line: their mean
    double ax = flat ? 0 : (-mx * yy + my * xy) / det, ay = flat ? 0 : (-my * xx + mx * xy) / det;
    for (int k = 0; k < b->count; k++) {
        double dx = g->x[b->place[k]] - x - mx, dy = g->y[b->place[k]] - y - my;
        b->weight[k] *= 1 + ax * dx + ay * dy;
    }
}

static blend blend_at(const himc_grid *g, double x, double y)
{
    int place[NEAREST + 1] = {0};
    double square[NEAREST + 1];
    blend b = {0};
    if (!(x * x + y * y < 1))
        return b;
    find_nearest(g, x, y, place, square);
    double reach = sqrt(square[NEAREST]);
    for (int k = 0; k < NEAREST && square[k] < INFINITY; k++) {
        double fall = isfinite(reach) ? 1 - sqrt(square[k]) / reach : 1;
        b.place[b.count] = place[k];
        b.weight[b.count++] = fall * fall / (square[k] + 1e-12);
    }
    fit_plane(g, x, y, &b);
    return b;
}

static double blended(const himc_grid *g, const blend *b, int mode)
{
    const double *shape = g->shape + (size_t)mode * (size_t)g->places;
    double sum = 0;
    for (int k = 0; k < b->count; k++)
        if (b->place[k] < g->places)
            sum += b->weight[k] * shape[b->place[k]];
    return sum;
}

double himc_outline_shape(const himc_shape *shape, const outline_mode *mode, int index, double x,
                          double y)
{
    if (shape->kind == HIMC_GRID) {
        blend b = blend_at(shape->grid, x, y);
        return blended(shape->grid, &b, index);
    }
    double a, b;
    sides(shape, &a, &b);
    if (!(fabs(x) < 0.5 * a && fabs(y) < 0.5 * b))
        return 0;
    return sin(mode->m * HIMC_PI * (x / a + 0.5)) * sin(mode->n * HIMC_PI * (y / b + 0.5));
}

void himc_outline_shapes(const himc_shape *shape, const outline_mode *modes, int count, double x,
                         double y, double *shapes)
{
    if (shape->kind == HIMC_RECTANGLE) {
        for (int i = 0; i < count; i++)
            shapes[i] = himc_outline_shape(shape, &modes[i], i, x, y);
        return;
    }
    blend b = blend_at(shape->grid, x, y);
    for (int i = 0; i < count; i++)
        shapes[i] = blended(shape->grid, &b, i);
}

// int_0^1 sin(m pi u) exp(i s (u - 1/2)) du: real for m odd, imaginary for m even
static double side_beam(int m, double s)
{
    double turn = m * HIMC_PI;
    if (fabs(fabs(s) - turn) < 1e-5)
        s += 2e-5; // the limit is smooth
    double edge = m % 2 ? 2 * cos(0.5 * s) : -2 * sin(0.5 * s);
    return turn / ((turn - s) * (turn + s)) * edge;
}

static void grid_beam(const himc_grid *g, int index, double kx, double ky, double *even,
                      double *odd)
{
    const double *shape = g->shape + (size_t)index * (size_t)g->places;
    *even = *odd = 0;
    for (int i = 0; i < g->places; i++) {
        double phase = kx * g->x[i] + ky * g->y[i], part = g->area[i] * shape[i];
        *even += part * cos(phase);
        *odd += part * sin(phase);
    }
}

void himc_outline_beam(const himc_shape *shape, const outline_mode *mode, int index, double kx,
                       double ky, double *even, double *odd)
{
    double a, b;
    if (shape->kind == HIMC_GRID) {
        grid_beam(shape->grid, index, kx, ky, even, odd);
        return;
    }
    sides(shape, &a, &b);
    double product = a * b * side_beam(mode->m, kx * a) * side_beam(mode->n, ky * b);
    bool m = mode->m % 2, n = mode->n % 2;
    *even = m && n ? product : !m && !n ? -product : 0;
    *odd = m != n ? product : 0;
}

himc_grid *himc_grid_retain(himc_grid *grid)
{
    if (grid)
        grid->references++;
    return grid;
}

void himc_grid_release(himc_grid *grid)
{
    if (!grid || --grid->references > 0)
        return;
    free(grid->x);
    free(grid->y);
    free(grid->area);
    free(grid->zero);
    free(grid->norm);
    free(grid->shape);
    free(grid);
}
