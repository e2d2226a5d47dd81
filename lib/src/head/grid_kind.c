/// grid_kind.c: a head of any outline, known at places (grid.h).
///
/// Between places a shape is a plane fitted to the nearest eight by least squares. The weights are
/// infinite at a place and 0 at the ninth, so the surface passes through the places and has no
/// steps as the neighbours change (moving least squares: Lancaster & Salkauskas 1981).
#include "head/modes.h"
#include "head/pickup.h"

#include <math.h>
#include <stdlib.h>

#define NEAREST 8           // places of a fit; chosen: a plane has three unknowns
#define REGULAR_PLACE 1e-12 // (per radius^2) keeps a weight finite at a place
#define COLLINEAR 1e-9      // relative; places nearer to one line than this fit no plane

static bool list(himc_modes *modes, bool automatic)
{
    (void)automatic;
    const himc_grid *g = modes->shape.grid;
    modes->entries = malloc(sizeof *modes->entries * (size_t)modes->count);
    for (int i = 0; modes->entries && i < modes->count; i++)
        modes->entries[i] = (himc_mode_entry){0, i + 1, g->zero[i], g->norm[i]};
    modes->entry_count = modes->count;
    return modes->entries;
}

// the places and weights from which a grid's shape is interpolated at one point
typedef struct blend {
    int count, place[NEAREST];
    double weight[NEAREST];
} blend;

// the nearest places with their squared distances, rising; one more than the fit uses
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

// turns weights of the fit into weights of the plane's value at (x, y)
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
    bool flat = !(det > COLLINEAR * (xx + yy) * (xx + yy)); // places in a line: their mean
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
    double farthest = sqrt(square[NEAREST]);
    for (int k = 0; k < NEAREST && square[k] < INFINITY; k++) {
        double fall = isfinite(farthest) ? 1 - sqrt(square[k]) / farthest : 1;
        b.place[b.count] = place[k];
        b.weight[b.count++] = fall * fall / (square[k] + REGULAR_PLACE);
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

static void shapes(const himc_modes *modes, double radius, double x, double y, double *out)
{
    blend b = blend_at(modes->shape.grid, x / radius, y / radius);
    for (int i = 0; i < modes->count; i++)
        out[i] = blended(modes->shape.grid, &b, i);
}

static void transform(const himc_modes *modes, int index, double kx, double ky, double *even,
                      double *odd)
{
    const himc_grid *g = modes->shape.grid;
    const double *shape = g->shape + (size_t)index * (size_t)g->places;
    *even = *odd = 0;
    for (int i = 0; i < g->places; i++) {
        double phase = kx * g->x[i] + ky * g->y[i], part = g->area[i] * shape[i];
        *even += part * cos(phase);
        *odd += part * sin(phase);
    }
}

static void fit(const himc_shape *shape, himc_head *head)
{
    const himc_grid *g = shape->grid;
    head->radius = g->radius;
    head->tension = g->tension;
    head->density = g->density;
    head->modes = head->modes < g->modes ? head->modes : g->modes;
}

static double principal(const himc_shape *shape)
{
    return shape->grid->zero[0];
}

// a free body has none, and nothing that it could be stretched between
static double film(const himc_shape *shape)
{
    double sum = 0;
    for (int i = 0; i < shape->grid->places && !shape->grid->free; i++)
        sum += shape->grid->area[i];
    return sum;
}

const himc_kind himc_kind_grid = {.usual = HIMC_USUAL_MODES,
                                  .fit = fit,
                                  .principal = principal,
                                  .film = film,
                                  .list = list,
                                  .shapes = shapes,
                                  .far = himc_pickup_of_outline,
                                  .transform = transform};
