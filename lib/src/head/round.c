/// round.c: the round head, whose modes come from one table of Bessel functions.
///
/// J_m(z) and its slope are tabulated for all orders on a grid of step 1/32 in z = j_mn r/a. Sign
/// changes along a row bracket the zeros j_mn; sorted, they are the list. The same table then gives
/// the shapes at any place by cubic Hermite interpolation, with an error of at most step^4/384
/// max|J^(4)| < 3e-9: fast enough to follow a moving stick. Weyl's law counts the modes below z:
/// z^2/4 - z/2 (pairs twice), so the table ends at 1 + sqrt(1 + 4 count) and a little more (H. Weyl
/// 1911; the second term is the rim's).
///
/// Compliance. The mean over disc and disc of Green's function of a disc of radius a, at r0 from
/// its centre (the mean of -ln|x - y| is 1/4 - ln b; the image is harmonic, so its mean is its
/// value at the centre):
///     C(b) = [ln((a^2 - r0^2)/(a b)) + 1/4]/(2 pi T).
/// Without a patch, a sum over modes grows for ever with their number.
#include "head/bessel.h"
#include "head/modes.h"
#include "head/pickup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TABLE_STEPS 32       // of the table per unit of z; chosen for the error above
#define TABLE_MARGIN 4       // in z; chosen: more than Weyl's law is off
#define LARGEST_BESSEL 0.582 // of |J_m| with m > 0

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
        himc_bessel_orders((double)k / TABLE_STEPS, top + 1, j);
        for (int m = 0; m <= top; m++) {
            double *cell = table + 2 * ((size_t)m * (size_t)columns + (size_t)k);
            cell[0] = j[m];
            cell[1] = (m > 0 ? 0.5 * (j[m - 1] - j[m + 1]) : -j[1]) / TABLE_STEPS;
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

// all zeros in the table, unsorted; only counts them when `out` is NULL
static int find_zeros(const himc_modes *modes, himc_mode_entry *out)
{
    int found = 0;
    for (int m = 0; m <= modes->top; m++) {
        const double *j = row(modes, m);
        int n = 0;
        // below z = m there is no zero, and J underflows there
        for (int k = m > 0 ? m * TABLE_STEPS : 1; k + 1 < modes->columns; k++) {
            if ((j[2 * k] > 0) == (j[2 * k + 2] > 0))
                continue;
            n++;
            if (out) {
                double z = himc_bessel_zero_between(m, (double)k / TABLE_STEPS,
                                                    (double)(k + 1) / TABLE_STEPS);
                double next = himc_bessel_j(m + 1, z);
                out[found] = (himc_mode_entry){m, n, z, next * next * (m > 0 ? 0.5 : 1)};
            }
            found++;
        }
    }
    return found;
}

static bool list(himc_modes *modes, bool automatic)
{
    double end = 1 + sqrt(1 + 4.0 * modes->exact) + TABLE_MARGIN;
    if (!tabulate(modes, (int)end, (int)(end * TABLE_STEPS) + 2))
        return false;
    int found = find_zeros(modes, NULL);
    modes->entries = malloc(sizeof *modes->entries * (size_t)found);
    modes->first = malloc(sizeof *modes->first * (size_t)found);
    modes->of = malloc(sizeof *modes->of * (size_t)modes->exact);
    if (!modes->entries || !modes->first || !modes->of)
        return false;
    find_zeros(modes, modes->entries);
    himc_modes_sort(modes->entries, found);
    // the first entries that make so many modes
    int mode = 0, i = 0;
    for (; i < found && mode < modes->exact; i++) {
        modes->first[i] = mode;
        int members = modes->entries[i].m > 0 ? 2 : 1;
        for (int k = 0; k < members && mode < modes->exact; k++)
            modes->of[mode++] = i;
    }
    modes->entry_count = i;
    modes->uneven = himc_uneven_pairs(modes, &modes->uneven_count);
    if (mode < modes->exact || !modes->uneven || !automatic)
        return mode == modes->exact && modes->uneven;
    modes->statistical = malloc(sizeof *modes->statistical);
    if (!modes->statistical)
        return false;
    himc_statistical_list(modes->statistical, HIMC_STATISTICAL_FROM, 0, HIMC_STATISTICAL_MODES);
    modes->count += HIMC_STATISTICAL_MODES;
    return true;
}

// J from value and slope at both ends of a cell of the table
static double hermite(const double *cell, double t)
{
    double u = 1 - t;
    return u * u * ((1 + 2 * t) * cell[0] + t * cell[1]) +
           t * t * ((1 + 2 * u) * cell[2] - u * cell[3]);
}

static void shapes(const himc_modes *modes, double radius, double x, double y, double *out)
{
    double distance = hypot(x, y), r = distance / radius;
    double cosine = distance > 0 ? x / distance : 1, sine = distance > 0 ? y / distance : 0;
    if (!(r < 1)) {
        memset(out, 0, sizeof *out * (size_t)modes->count);
        return;
    }
    // cos and sin of all multiples of the angle, by rotation, then from each order's own axis
    double c[HIMC_LUGS_ORDERS], s[HIMC_LUGS_ORDERS];
    c[0] = 1;
    s[0] = 0;
    for (int m = 0; m < modes->top; m++) {
        c[m + 1] = c[m] * cosine - s[m] * sine;
        s[m + 1] = s[m] * cosine + c[m] * sine;
    }
    for (int m = 1; m <= modes->top && modes->uniformity < 1; m++) {
        const himc_lugs_pair *p = &modes->pairs[m];
        double across = s[m] * p->cosine - c[m] * p->sine;
        c[m] = c[m] * p->cosine + s[m] * p->sine;
        s[m] = across;
    }
    for (int i = 0; i < modes->entry_count; i++) {
        int m = modes->entries[i].m, mode = modes->first[i];
        double z = modes->entries[i].z * r * TABLE_STEPS;
        int k = (int)z;
        double j = hermite(row(modes, m) + 2 * k, z - k);
        out[mode] = j * c[m];
        if (m > 0 && mode + 1 < modes->exact)
            out[mode + 1] = j * s[m];
    }
    if (modes->statistical)
        himc_statistical_shapes(modes->statistical, x / radius, y / radius, out + modes->exact);
}

static double principal(const himc_shape *shape)
{
    (void)shape;
    return HIMC_BESSEL_FIRST;
}

static double film(const himc_shape *shape)
{
    (void)shape;
    return HIMC_PI;
}

static double largest(const himc_mode *mode)
{
    return mode->m < 0 ? HIMC_STATISTICAL_MOST : mode->m > 0 ? LARGEST_BESSEL : 1;
}

// it ends at the rim
static double patch(const himc_head *head, double x, double y, double b)
{
    return fmin(b, head->radius - hypot(x, y));
}

static double compliance(const himc_head *head, double x, double y, double b)
{
    double a = head->radius, distance = hypot(x, y), inside = (a - distance) * (a + distance);
    return (log(inside / (a * b)) + 0.25) / (2 * HIMC_PI * head->tension);
}

const himc_kind himc_kind_round = {.name = "circle",
                                   .air = true,
                                   .usual = HIMC_STATISTICAL_EXACT,
                                   .principal = principal,
                                   .film = film,
                                   .list = list,
                                   .shapes = shapes,
                                   .largest = largest,
                                   .patch = patch,
                                   .compliance = compliance,
                                   .far = himc_pickup_of_round,
                                   .form = himc_pickup_form};
