/// rectangle.c: the rectangular head, in closed form.
///
/// A x B: phi = sin(m pi (x/A + 1/2)) sin(n pi (y/B + 1/2)), wavenumber pi hypot(m/A, n/B) (Morse &
/// Ingard 1968, section 5.2). Its transform is a product of two of
///     int_0^1 sin(m pi u) exp(i s (u - 1/2)) du = m pi/(m^2 pi^2 - s^2) {2 cos s/2 | 2 i sin s/2}
/// for m odd | even (up to sign).
#include "head/modes.h"
#include "head/pickup.h"

#include <math.h>
#include <stdlib.h>

#define SAME_WAVENUMBER 1e-5 // s this near to m pi is moved by twice as much: the limit is smooth
#define RECTANGLE_MARGIN 4   // modes; chosen: with two wavenumbers of the short side, enough

// sides of a rectangle per radius
static void sides(const himc_shape *shape, double *a, double *b)
{
    double diagonal = hypot(shape->length, shape->width);
    *a = 2 * shape->length / diagonal;
    *b = 2 * shape->width / diagonal;
}

// Weyl's law: z^2 area/(4 pi) modes below z, less the rim's. All modes up to a generous top are
// listed.
static bool list(himc_modes *modes, bool automatic)
{
    double a, b;
    (void)automatic;
    sides(&modes->shape, &a, &b);
    double rim = (a + b) / (2 * HIMC_PI), area = a * b / (4 * HIMC_PI);
    double weyl = rim + sqrt(rim * rim + 4 * area * (modes->count + RECTANGLE_MARGIN));
    double top = weyl / (2 * area) + 2 / fmin(a, b) * 4;
    size_t most = (size_t)(top * a / HIMC_PI + 1) * (size_t)(top * b / HIMC_PI + 1);
    int found = 0;
    modes->entries = malloc(sizeof *modes->entries * most);
    if (!modes->entries)
        return false;
    for (int m = 1; m * HIMC_PI / a <= top; m++)
        for (int n = 1; hypot(m / a, n / b) * HIMC_PI <= top; n++)
            modes->entries[found++] =
                (himc_mode_entry){m, n, hypot(m / a, n / b) * HIMC_PI, a * b / (4 * HIMC_PI)};
    himc_modes_sort(modes->entries, found);
    modes->entry_count = modes->count;
    return found >= modes->count;
}

// int_0^1 sin(m pi u) exp(i s (u - 1/2)) du: real for m odd, imaginary for m even
static double side_transform(int m, double s)
{
    double phase = m * HIMC_PI;
    if (fabs(fabs(s) - phase) < SAME_WAVENUMBER)
        s += 2 * SAME_WAVENUMBER;
    double edge = m % 2 ? 2 * cos(0.5 * s) : -2 * sin(0.5 * s);
    return phase / ((phase - s) * (phase + s)) * edge;
}

static void transform(const himc_modes *modes, int index, double kx, double ky, double *even,
                      double *odd)
{
    const himc_mode_entry *e = &modes->entries[index];
    double a, b;
    sides(&modes->shape, &a, &b);
    double product = a * b * side_transform(e->m, kx * a) * side_transform(e->n, ky * b);
    bool m = e->m % 2, n = e->n % 2;
    *even = m && n ? product : !m && !n ? -product : 0;
    *odd = m != n ? product : 0;
}

static void shapes(const himc_modes *modes, double radius, double x, double y, double *out)
{
    double a, b;
    sides(&modes->shape, &a, &b);
    double u = x / radius, v = y / radius;
    bool inside = fabs(u) < 0.5 * a && fabs(v) < 0.5 * b;
    for (int i = 0; i < modes->count; i++) {
        const himc_mode_entry *e = &modes->entries[i];
        out[i] =
            inside ? sin(e->m * HIMC_PI * (u / a + 0.5)) * sin(e->n * HIMC_PI * (v / b + 0.5)) : 0;
    }
}

static bool read(const himc_command *command, himc_shape *shape, himc_error *error)
{
    (void)error;
    shape->length = command->atom[1].number;
    shape->width = command->atom[2].number;
    return true;
}

static void fit(const himc_shape *shape, himc_head *head)
{
    head->radius = 0.5 * hypot(shape->length, shape->width);
}

static void surface(const himc_shape *shape, himc_head_frame *surface)
{
    double a, b;
    sides(shape, &a, &b);
    surface->length = a * surface->radius;
    surface->width = b * surface->radius;
}

static double principal(const himc_shape *shape)
{
    double a, b;
    sides(shape, &a, &b);
    return hypot(1 / a, 1 / b) * HIMC_PI;
}

static double film(const himc_shape *shape)
{
    double a, b;
    sides(shape, &a, &b);
    return a * b;
}

static double largest(const himc_mode *mode)
{
    (void)mode;
    return 1;
}

static double patch(const himc_head *head, double x, double y, double b)
{
    (void)head, (void)x, (void)y;
    return b;
}

const himc_kind himc_kind_rectangle = {.name = "rectangle",
                                       .usual = HIMC_USUAL_MODES,
                                       .read = read,
                                       .fit = fit,
                                       .surface = surface,
                                       .principal = principal,
                                       .film = film,
                                       .list = list,
                                       .shapes = shapes,
                                       .largest = largest,
                                       .patch = patch,
                                       .far = himc_pickup_of_outline,
                                       .transform = transform};
