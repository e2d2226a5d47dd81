/// modes.c: the list of modes from one table of Bessel functions.
///
/// J_m(z) and its slope are tabulated for all orders on a grid of step 1/32 in z = j_mn r/a. Sign
/// changes along a row bracket the zeros j_mn; sorted, they are the list. Afterwards the same table
/// gives the shapes at any place by cubic Hermite interpolation, whose error is at most step^4/384
/// max|J''''| < 3e-9: cheap enough to follow a moving stick.
///
/// Weyl's law counts the modes below z: z^2/4 - z/2 (pairs twice), so the table ends at 1 + sqrt(1
/// + 4 count) and a little more (H. Weyl 1911; the second term is the rim's).
///
/// The default head: 23 inches of Christian et al.'s Mylar, the ideal membrane of the 2012 paper,
/// and 3700 N/m: a 45 g mallet then meets 65 N at 3.7 m/s and 108 N at 6 m/s, the paper's 62 ..
/// 65 and 106.9 N. With `air 1` the same head is a timpano's, and what the air carries away comes
/// on top of this decay.
#include "drum/modes.h"

#include "drum/bessel.h"
#include "drum/outline.h"

#include <math.h>
#include <stdlib.h>

#define STEPS 32 // of the table per unit of z

// one Bessel zero; a pair of modes shares it
typedef struct zero {
    int m, n;
    double z;
    double norm; // integral of phi^2 / (pi a^2)
} zero;

struct himc_modes {
    himc_shape shape;
    outline_mode *outline; // (count), unless round; then nothing below is used
    int count;             // modes
    int zero_count;        // zeros used by them
    int top;               // largest order used
    int columns;           // grid points
    zero *zeros;           // sorted
    int *first;            // (zero_count) index of the zero's first mode
    int *of;               // (count) zero of a mode
    double *table;         // (top + 1, columns, 2) J and J'/STEPS
};

himc_head himc_head_default(void)
{
    return (himc_head){.radius = 0.2921,
                       .tension = 3700,
                       .density = 0.2653,
                       .decay_constant = 2.2,
                       .decay_square = 3e-7,
                       .modes = 200,
                       .air = false,
                       .glide = 1};
}

bool himc_head_check(const himc_head *head, himc_error *error)
{
    return himc_check_range("radius", head->radius, HIMC_RADIUS_MIN, HIMC_RADIUS_MAX, "m", error) &&
           himc_check_range("tension", head->tension, HIMC_TENSION_MIN, HIMC_TENSION_MAX, "N/m",
                            error) &&
           himc_check_range("density", head->density, 0.001, 10, "kg/m2", error) &&
           himc_check_range("decay S0", head->decay_constant, 0, HIMC_SIGMA0_MAX, "1/s", error) &&
           himc_check_range("decay S1", head->decay_square, 0, HIMC_SIGMA1_MAX, "s", error) &&
           himc_check_range("modes", head->modes, 1, HIMC_MODES_MAX, "", error) &&
           himc_check_range("kettle", head->kettle, 0, 10, "m3", error) &&
           himc_check_range("glide", head->glide, 0, 1, "", error) &&
           himc_check_range("damp", head->damp, 0, 1, "", error);
}

double himc_head_tension_for(const himc_head *head, double frequency)
{
    double speed = 2 * HIMC_PI * frequency * head->radius / himc_bessel_zero(1, 1);
    return head->density * speed * speed;
}

double himc_head_decay(const himc_head *head, double omega, double loading)
{
    double decay = head->decay_constant + head->decay_square * omega * omega;
    return fmin(decay + head->damp * HIMC_DAMP / loading, 0.9 * omega);
}

static int by_frequency(const void *a, const void *b)
{
    double za = ((const zero *)a)->z, zb = ((const zero *)b)->z;
    return (za > zb) - (za < zb);
}

// fills the table column by column: the recurrence gives all orders at once
static bool tabulate(himc_modes *modes, int top, int columns)
{
    double *table = malloc(sizeof *table * 2 * (size_t)(top + 1) * (size_t)columns);
    double *j = malloc(sizeof *j * (size_t)(top + 2));
    if (!table || !j) {
        free(table);
        free(j);
        return false;
    }
    for (int k = 0; k < columns; k++) {
        himc_bessel_orders((double)k / STEPS, top + 1, j);
        for (int m = 0; m <= top; m++) {
            double *entry = table + 2 * ((size_t)m * (size_t)columns + (size_t)k);
            entry[0] = j[m];
            entry[1] = (m > 0 ? 0.5 * (j[m - 1] - j[m + 1]) : -j[1]) / STEPS;
        }
    }
    free(j);
    modes->table = table;
    modes->top = top;
    modes->columns = columns;
    return true;
}

static const double *row(const himc_modes *modes, int m)
{
    return modes->table + 2 * (size_t)m * (size_t)modes->columns;
}

// all zeros the table brackets, unsorted; counts only when `out` is NULL
static int collect(const himc_modes *modes, zero *out)
{
    int found = 0;
    for (int m = 0; m <= modes->top; m++) {
        const double *j = row(modes, m);
        int n = 0;
        // below z = m there is no zero, and J underflows there
        for (int k = m > 0 ? m * STEPS : 1; k + 1 < modes->columns; k++) {
            if ((j[2 * k] > 0) == (j[2 * k + 2] > 0))
                continue;
            n++;
            if (out) {
                double z = himc_bessel_zero_between(m, (double)k / STEPS, (double)(k + 1) / STEPS);
                double next = himc_bessel_j(m + 1, z);
                out[found] = (zero){m, n, z, next * next * (m > 0 ? 0.5 : 1)};
            }
            found++;
        }
    }
    return found;
}

// the first zeros that make `count` modes; false if the table holds too few
static bool enlist(himc_modes *modes, int found)
{
    int mode = 0, i = 0;
    for (; i < found && mode < modes->count; i++) {
        modes->first[i] = mode;
        for (int member = 0; member < (modes->zeros[i].m > 0 ? 2 : 1) && mode < modes->count;
             member++)
            modes->of[mode++] = i;
    }
    modes->zero_count = i;
    return mode == modes->count;
}

static bool build(himc_modes *modes)
{
    double end = 1 + sqrt(1 + 4.0 * modes->count) + 4;
    if (!tabulate(modes, (int)end, (int)(end * STEPS) + 2))
        return false;
    int found = collect(modes, NULL);
    modes->zeros = malloc(sizeof *modes->zeros * (size_t)found);
    modes->first = malloc(sizeof *modes->first * (size_t)found);
    modes->of = malloc(sizeof *modes->of * (size_t)modes->count);
    if (!modes->zeros || !modes->first || !modes->of)
        return false;
    collect(modes, modes->zeros);
    qsort(modes->zeros, (size_t)found, sizeof *modes->zeros, by_frequency);
    return enlist(modes, found);
}

static bool build_outline(himc_modes *modes)
{
    modes->outline = malloc(sizeof *modes->outline * (size_t)modes->count);
    return modes->outline && himc_outline_modes(&modes->shape, modes->count, modes->outline);
}

himc_modes *himc_modes_new(int count, himc_error *error)
{
    return himc_modes_new_of(&(himc_shape){.kind = HIMC_CIRCLE}, count, error);
}

himc_modes *himc_modes_new_of(const himc_shape *shape, int count, himc_error *error)
{
    int most = shape->kind == HIMC_GRID ? shape->grid->modes : HIMC_MODES_MAX;
    if (!himc_check_range("modes", count, 1, most, "", error))
        return NULL;
    himc_modes *modes = calloc(1, sizeof *modes);
    if (modes) {
        modes->count = count;
        modes->shape = *shape;
        himc_grid_retain(shape->grid);
        if (shape->kind == HIMC_CIRCLE ? build(modes) : build_outline(modes))
            return modes;
    }
    himc_modes_free(modes);
    himc_error_set(error, "modes: no memory for %d modes", count);
    return NULL;
}

void himc_modes_free(himc_modes *modes)
{
    if (!modes)
        return;
    himc_grid_release(modes->shape.grid);
    free(modes->outline);
    free(modes->zeros);
    free(modes->first);
    free(modes->of);
    free(modes->table);
    free(modes);
}

int himc_modes_count(const himc_modes *modes)
{
    return modes->count;
}

const himc_shape *himc_modes_outline(const himc_modes *modes)
{
    return &modes->shape;
}

double himc_modes_area(const himc_modes *modes, double radius)
{
    return radius * radius * (modes->outline ? himc_outline_area(&modes->shape) : HIMC_PI);
}

// what depends on the shape alone
static himc_mode bare_shape(const himc_modes *modes, int index)
{
    if (modes->outline) {
        const outline_mode *o = &modes->outline[index];
        return (himc_mode){.m = o->m, .n = o->n, .zero = o->z, .norm = o->norm};
    }
    const zero *z = &modes->zeros[modes->of[index]];
    bool sine = index > modes->first[modes->of[index]];
    return (himc_mode){.m = z->m, .n = z->n, .sine = sine, .zero = z->z, .norm = z->norm};
}

himc_mode himc_modes_get(const himc_modes *modes, const himc_head *head, int index)
{
    himc_mode mode = bare_shape(modes, index);
    double omega = mode.zero / head->radius * sqrt(head->tension / head->density);
    mode.frequency = omega / (2 * HIMC_PI);
    mode.decay = himc_head_decay(head, omega, 1);
    mode.mass = head->density * HIMC_PI * head->radius * head->radius * mode.norm;
    mode.stiffness = mode.mass * omega * omega;
    return mode;
}

void himc_modes_beam(const himc_modes *modes, double radius, int index, double kx, double ky,
                     double *even, double *odd)
{
    himc_outline_beam(&modes->shape, &modes->outline[index], index, kx * radius, ky * radius, even,
                      odd);
    *even *= radius * radius;
    *odd *= radius * radius;
}

double himc_modes_shape(const himc_modes *modes, double radius, int index, double x, double y)
{
    if (modes->outline)
        return himc_outline_shape(&modes->shape, &modes->outline[index], index, x / radius,
                                  y / radius);
    int i = modes->of[index], m = modes->zeros[i].m;
    double r = hypot(x, y) / radius, angle = m * atan2(y, x);
    if (!(r < 1))
        return 0;
    return himc_bessel_j(m, modes->zeros[i].z * r) *
           (index > modes->first[i] ? sin(angle) : cos(angle));
}

// J from value and slope at both ends of a grid cell
static double hermite(const double *cell, double t)
{
    double u = 1 - t;
    return u * u * ((1 + 2 * t) * cell[0] + t * cell[1]) +
           t * t * ((1 + 2 * u) * cell[2] - u * cell[3]);
}

void himc_modes_shapes(const himc_modes *modes, double radius, double x, double y, double *shapes)
{
    if (modes->outline) {
        himc_outline_shapes(&modes->shape, modes->outline, modes->count, x / radius, y / radius,
                            shapes);
        return;
    }
    double distance = hypot(x, y), r = distance / radius;
    if (!(r < 1)) {
        for (int i = 0; i < modes->count; i++)
            shapes[i] = 0;
        return;
    }
    // cos and sin of all multiples of the angle, by turning
    double turn_c = distance > 0 ? x / distance : 1, turn_s = distance > 0 ? y / distance : 0;
    double c[160], s[160]; // more orders than 4000 modes have (about 125)
    c[0] = 1;
    s[0] = 0;
    for (int m = 0; m < modes->top; m++) {
        c[m + 1] = c[m] * turn_c - s[m] * turn_s;
        s[m + 1] = s[m] * turn_c + c[m] * turn_s;
    }
    for (int i = 0; i < modes->zero_count; i++) {
        int m = modes->zeros[i].m, mode = modes->first[i];
        double z = modes->zeros[i].z * r * STEPS;
        int k = (int)z;
        double j = hermite(row(modes, m) + 2 * k, z - k);
        shapes[mode] = j * c[m];
        if (m > 0 && mode + 1 < modes->count)
            shapes[mode + 1] = j * s[m];
    }
}
