/// modes.c: lists of modes and their shapes: round heads from one table of Bessel functions,
/// rectangles in closed form, and heads known at places.
///
/// Round. J_m(z) and its slope are tabulated for all orders on a grid of step 1/32 in z = j_mn r/a.
/// Sign changes along a row bracket the zeros j_mn; sorted, they are the list. The same table then
/// gives the shapes at any place by cubic Hermite interpolation, with an error of at most
/// step^4/384 max|J^(4)| < 3e-9: fast enough to follow a moving stick. Weyl's law counts the modes
/// below z: z^2/4 - z/2 (pairs twice), so the table ends at 1 + sqrt(1 + 4 count) and a little more
/// (H. Weyl 1911; the second term is the rim's).
///
/// Rectangle A x B: phi = sin(m pi (x/A + 1/2)) sin(n pi (y/B + 1/2)), wavenumber pi hypot(m/A,
/// n/B) (Morse & Ingard 1968, section 5.2). Its transform is a product of two of
///     int_0^1 sin(m pi u) exp(i s (u - 1/2)) du = m pi/(m^2 pi^2 - s^2) {2 cos s/2 | 2 i sin s/2}
/// for m odd | even (up to sign).
///
/// Grid: between places a shape is a plane fitted to the nearest eight by least squares. The
/// weights are infinite at a place and 0 at the ninth, so the surface passes through the places and
/// has no steps as the neighbours change (moving least squares: Lancaster & Salkauskas 1981).
///
/// The default head: a timpano of 26 inches, the commonest one, with Christian et al.'s Mylar
/// (1984) in air, at the tension that sounds D3, the middle of its range. S0 and S1 are what air.h
/// says of a film; the loss by radiation comes on top. Its lugs are uneven enough to beat as
/// recorded heads do: the strongest partials ripple by 1 to 3 dB about a straight decay.
#include "head/modes.h"

#include "head/bessel.h"
#include "head/lugs.h"
#include "head/statistical.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TABLE_STEPS 32       // of the table per unit of z; chosen for the error above
#define TABLE_MARGIN 4       // in z; chosen: more than Weyl's law is off
#define AUTO_OTHERS 200      // modes of a head that is not round, if not given; chosen
#define NEAREST 8            // places of a fit; chosen: a plane has three unknowns
#define REGULAR_PLACE 1e-12  // (per radius^2) keeps a weight finite at a place
#define COLLINEAR 1e-9       // relative; places nearer to one line than this fit no plane
#define SAME_WAVENUMBER 1e-5 // s this near to m pi is moved by twice as much: the limit is smooth
#define RECTANGLE_MARGIN 4   // modes; chosen: with two wavenumbers of the short side, enough

// One entry of the list, shared by the two modes of a pair: z is radius times wavenumber (of a
// round head the zero j_mn), norm the integral of phi^2 per pi a^2.
typedef struct entry {
    int m, n;
    double z, norm;
} entry;

struct himc_modes {
    _Atomic int *users; // of the list, which copies share: all but pairs and mixture
    himc_shape shape;
    int count;       // modes
    int exact;       // of these, in the list of entries; the others are statistical
    int entry_count; // entries they use
    entry *entries;  // sorted by z
    // for round heads only
    int *first;                    // (entry_count) index of the entry's first mode
    int *of;                       // (count) entry of a mode
    int top;                       // largest order in the table
    int columns;                   // its grid points
    double *table;                 // (top + 1, columns, 2) J and J'/TABLE_STEPS
    himc_statistical *statistical; // if any mode is
    double uniformity;             // of the lugs, and `seed`: what `pairs` were made for
    int seed;
    himc_lugs_pair pairs[HIMC_LUGS_ORDERS];
    himc_mixture mixture; // by a kettle
};

himc_head himc_head_default(void)
{
    return (himc_head){.radius = 0.3302,
                       .tension = 3830.3,
                       .density = 0.2653,
                       .decay_constant = 0.5,
                       .decay_square = 3e-7,
                       .modes = HIMC_MODES_AUTO,
                       .air = true,
                       .glide = 1,
                       .uniformity = 0.2};
}

bool himc_head_check(const himc_head *head, himc_error *error)
{
    return himc_check_range("radius", head->radius, HIMC_RADIUS_MIN, HIMC_RADIUS_MAX, "m", error) &&
           himc_check_range("tension", head->tension, HIMC_TENSION_MIN, HIMC_TENSION_MAX, "N/m",
                            error) &&
           himc_check_range("density", head->density, 0.001, HIMC_DENSITY_MAX, "kg/m2", error) &&
           himc_check_range("decay S0", head->decay_constant, 0, HIMC_SIGMA0_MAX, "1/s", error) &&
           himc_check_range("decay S1", head->decay_square, 0, HIMC_SIGMA1_MAX, "s", error) &&
           (head->modes == HIMC_MODES_AUTO ||
            himc_check_range("modes", head->modes, 1, HIMC_MODES_MAX, "", error)) &&
           himc_check_range("kettle", head->kettle, 0, 10, "m3", error) &&
           himc_check_range("glide", head->glide, 0, 1, "", error) &&
           himc_check_range("uniformity", head->uniformity, 0, 1, "", error) &&
           himc_check_range("uniformity seed", head->uniformity_seed, 0, HIMC_SEED_MAX, "",
                            error) &&
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
    return fmin(decay + head->damp * HIMC_DAMP / loading, HIMC_LARGEST_DECAY * omega);
}

static bool is_round(const himc_modes *modes)
{
    return modes->shape.kind == HIMC_CIRCLE;
}

static int by_frequency(const void *a, const void *b)
{
    const entry *p = a, *q = b;
    return p->z != q->z ? (p->z > q->z) - (p->z < q->z) : p->m - q->m;
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
static int find_zeros(const himc_modes *modes, entry *out)
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
                out[found] = (entry){m, n, z, next * next * (m > 0 ? 0.5 : 1)};
            }
            found++;
        }
    }
    return found;
}

// takes the first entries that make `count` modes; false if there are too few
static bool assign_modes(himc_modes *modes, int found)
{
    int mode = 0, i = 0;
    for (; i < found && mode < modes->exact; i++) {
        modes->first[i] = mode;
        int members = modes->entries[i].m > 0 ? 2 : 1;
        for (int k = 0; k < members && mode < modes->exact; k++)
            modes->of[mode++] = i;
    }
    modes->entry_count = i;
    return mode == modes->exact;
}

static bool list_round(himc_modes *modes)
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
    qsort(modes->entries, (size_t)found, sizeof *modes->entries, by_frequency);
    return assign_modes(modes, found);
}

// sides of a rectangle per radius
static void sides(const himc_shape *shape, double *a, double *b)
{
    double diagonal = hypot(shape->length, shape->width);
    *a = 2 * shape->length / diagonal;
    *b = 2 * shape->width / diagonal;
}

// Weyl's law: z^2 area/(4 pi) modes below z, less the rim's. All modes up to a generous top are
// listed.
static bool list_rectangle(himc_modes *modes)
{
    double a, b;
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
                (entry){m, n, hypot(m / a, n / b) * HIMC_PI, a * b / (4 * HIMC_PI)};
    qsort(modes->entries, (size_t)found, sizeof *modes->entries, by_frequency);
    modes->entry_count = modes->count;
    return found >= modes->count;
}

static bool list_grid(himc_modes *modes)
{
    const himc_grid *g = modes->shape.grid;
    modes->entries = malloc(sizeof *modes->entries * (size_t)modes->count);
    for (int i = 0; modes->entries && i < modes->count; i++)
        modes->entries[i] = (entry){0, i + 1, g->zero[i], g->norm[i]};
    modes->entry_count = modes->count;
    return modes->entries;
}

static bool list_modes(himc_modes *modes)
{
    switch (modes->shape.kind) {
    case HIMC_CIRCLE: return list_round(modes);
    case HIMC_RECTANGLE: return list_rectangle(modes);
    case HIMC_GRID: return list_grid(modes);
    }
    return false;
}

static int exact_of_auto(const himc_shape *shape, int most)
{
    return shape->kind == HIMC_CIRCLE ? HIMC_STATISTICAL_EXACT
                                      : (most < AUTO_OTHERS ? most : AUTO_OTHERS);
}

static bool list_statistical(himc_modes *modes)
{
    modes->statistical = malloc(sizeof *modes->statistical);
    if (!modes->statistical)
        return false;
    himc_statistical_list(modes->statistical);
    modes->count += HIMC_STATISTICAL_MODES;
    return true;
}

static int most_modes(const himc_shape *shape)
{
    return shape->kind == HIMC_GRID ? shape->grid->modes : HIMC_MODES_MAX;
}

bool himc_modes_check(const himc_shape *shape, int count, himc_error *error)
{
    return count == HIMC_MODES_AUTO ||
           himc_check_range("modes", count, 1, most_modes(shape), "", error);
}

himc_modes *himc_modes_new(const himc_shape *shape, int count, himc_error *error)
{
    bool automatic = count == HIMC_MODES_AUTO;
    if (!himc_modes_check(shape, count, error))
        return NULL;
    if (automatic)
        count = exact_of_auto(shape, most_modes(shape));
    himc_modes *modes = calloc(1, sizeof *modes);
    if (modes)
        modes->users = malloc(sizeof *modes->users);
    if (modes && modes->users) {
        *modes->users = 1;
        modes->count = modes->exact = count;
        modes->uniformity = 1;
        himc_lugs_split(1, 0, modes->pairs);
        modes->shape = *shape;
        himc_grid_retain(shape->grid);
        if (list_modes(modes) && (!automatic || !is_round(modes) || list_statistical(modes)))
            return modes;
    }
    himc_modes_free(modes);
    himc_error_set(error, "modes: no memory for %d modes", count);
    return NULL;
}

himc_modes *himc_modes_copy(const himc_modes *modes, himc_error *error)
{
    himc_modes *copy = malloc(sizeof *copy);
    if (!copy) {
        himc_error_set(error, "modes: no memory for %d modes", modes->count);
        return NULL;
    }
    *copy = *modes;
    ++*copy->users;
    himc_grid_retain(copy->shape.grid);
    return copy;
}

void himc_modes_free(himc_modes *modes)
{
    if (!modes)
        return;
    himc_grid_release(modes->shape.grid);
    if (!modes->users || --*modes->users == 0) {
        free(modes->entries);
        free(modes->first);
        free(modes->of);
        free(modes->table);
        free(modes->statistical);
        free((void *)modes->users);
    }
    free(modes);
}

double himc_shape_principal(const himc_shape *shape)
{
    double a, b;
    if (shape->kind == HIMC_GRID)
        return shape->grid->zero[0];
    if (shape->kind == HIMC_CIRCLE)
        return himc_bessel_zero(1, 1);
    sides(shape, &a, &b);
    return hypot(1 / a, 1 / b) * HIMC_PI;
}

int himc_modes_count(const himc_modes *modes)
{
    return modes->count;
}

int himc_modes_common(const himc_modes *a, const himc_modes *b)
{
    if (a->statistical && b->statistical)
        return a->count;
    return a->exact < b->exact ? a->exact : b->exact;
}

const himc_shape *himc_modes_shape(const himc_modes *modes)
{
    return &modes->shape;
}

void himc_modes_set_lugs(himc_modes *modes, double uniformity, int seed)
{
    if (modes->uniformity != uniformity || modes->seed != seed)
        himc_lugs_split(uniformity, seed, modes->pairs);
    modes->uniformity = uniformity;
    modes->seed = seed;
}

const himc_lugs_pair *himc_modes_pairs(const himc_modes *modes)
{
    return modes->pairs;
}

void himc_modes_mix_as(himc_modes *modes, const himc_mixture *mixture)
{
    himc_mixture *own = &modes->mixture;
    if (mixture)
        *own = *mixture;
    own->count = 0;
    for (int i = 0; mixture && i < modes->entry_count && own->count < HIMC_MIXED; i++)
        if (modes->entries[i].m == 0)
            own->index[own->count++] = modes->first[i];
}

const himc_mixture *himc_modes_mixture(const himc_modes *modes)
{
    return &modes->mixture;
}

void himc_modes_mix(const himc_modes *modes, double *numbers)
{
    const himc_mixture *mix = &modes->mixture;
    double bare[HIMC_MIXED];
    for (int n = 0; n < mix->count; n++)
        bare[n] = numbers[mix->index[n]];
    for (int n = 0; n < mix->count; n++) {
        double sum = 0;
        for (int k = 0; k < mix->count; k++)
            sum += mix->part[n][k] * bare[k];
        numbers[mix->index[n]] = sum;
    }
}

// area of a head that is not round, per radius^2
static double area_of(const himc_shape *shape)
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

double himc_modes_area(const himc_modes *modes, double radius)
{
    return radius * radius * (is_round(modes) ? HIMC_PI : area_of(&modes->shape));
}

// the fields of a mode that depend on the shape alone
static himc_mode bare_shape(const himc_modes *modes, int index)
{
    if (index >= modes->exact) {
        const himc_statistical_mode *s = &modes->statistical->mode[index - modes->exact];
        return (himc_mode){
            .m = -1, .n = index - modes->exact + 1, .zero = s->zero, .norm = 1 / s->count};
    }
    int i = is_round(modes) ? modes->of[index] : index;
    const entry *e = &modes->entries[i];
    bool sine = is_round(modes) && index > modes->first[i];
    double axis = is_round(modes) ? modes->pairs[e->m].axis : 0;
    return (himc_mode){
        .m = e->m, .n = e->n, .sine = sine, .axis = axis, .zero = e->z, .norm = e->norm};
}

himc_mode himc_modes_get(const himc_modes *modes, const himc_head *head, int index)
{
    himc_mode mode = bare_shape(modes, index);
    double split = is_round(modes) && mode.m > 0 ? modes->pairs[mode.m].split : 0;
    double omega = mode.zero / head->radius * sqrt(head->tension / head->density);
    omega *= sqrt(mode.sine ? 1 + split : 1 - split);
    mode.frequency = omega / (2 * HIMC_PI);
    mode.decay = himc_head_decay(head, omega, 1);
    mode.mass = head->density * HIMC_PI * head->radius * head->radius * mode.norm;
    mode.stiffness = mode.mass * omega * omega;
    return mode;
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

static double at_rectangle(const himc_shape *shape, const entry *e, double x, double y)
{
    double a, b;
    sides(shape, &a, &b);
    if (!(fabs(x) < 0.5 * a && fabs(y) < 0.5 * b))
        return 0;
    return sin(e->m * HIMC_PI * (x / a + 0.5)) * sin(e->n * HIMC_PI * (y / b + 0.5));
}

static double at_statistical(const himc_modes *modes, int index, double x, double y)
{
    double shapes[HIMC_STATISTICAL_MODES];
    if (!(hypot(x, y) < 1))
        return 0;
    himc_statistical_shapes(modes->statistical, x, y, shapes);
    return shapes[index - modes->exact];
}

static double at_circle(const himc_modes *modes, double radius, int index, double x, double y)
{
    int i = modes->of[index], m = modes->entries[i].m;
    double r = hypot(x, y) / radius, angle = m * (atan2(y, x) - modes->pairs[m].axis);
    if (!(r < 1))
        return 0;
    return himc_bessel_j(m, modes->entries[i].z * r) *
           (index > modes->first[i] ? sin(angle) : cos(angle));
}

double himc_modes_shape_at(const himc_modes *modes, double radius, int index, double x, double y)
{
    if (index >= modes->exact)
        return at_statistical(modes, index, x / radius, y / radius);
    if (is_round(modes))
        return at_circle(modes, radius, index, x, y);
    if (modes->shape.kind == HIMC_RECTANGLE)
        return at_rectangle(&modes->shape, &modes->entries[index], x / radius, y / radius);
    blend b = blend_at(modes->shape.grid, x / radius, y / radius);
    return blended(modes->shape.grid, &b, index);
}

// J from value and slope at both ends of a cell of the table
static double hermite(const double *cell, double t)
{
    double u = 1 - t;
    return u * u * ((1 + 2 * t) * cell[0] + t * cell[1]) +
           t * t * ((1 + 2 * u) * cell[2] - u * cell[3]);
}

// all shapes at radius r < 1 in the direction (cosine, sine)
static void shapes_of_circle(const himc_modes *modes, double r, double cosine, double sine,
                             double *shapes)
{
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
        shapes[mode] = j * c[m];
        if (m > 0 && mode + 1 < modes->exact)
            shapes[mode + 1] = j * s[m];
    }
}

static void shapes_of_grid(const himc_modes *modes, double x, double y, double *shapes)
{
    blend b = blend_at(modes->shape.grid, x, y);
    for (int i = 0; i < modes->count; i++)
        shapes[i] = blended(modes->shape.grid, &b, i);
}

void himc_modes_shapes(const himc_modes *modes, double radius, double x, double y, double *shapes)
{
    double distance = hypot(x, y), r = distance / radius;
    if (modes->shape.kind == HIMC_GRID)
        shapes_of_grid(modes, x / radius, y / radius, shapes);
    else if (modes->shape.kind == HIMC_RECTANGLE)
        for (int i = 0; i < modes->count; i++)
            shapes[i] = at_rectangle(&modes->shape, &modes->entries[i], x / radius, y / radius);
    else if (!(r < 1))
        memset(shapes, 0, sizeof *shapes * (size_t)modes->count);
    else
        shapes_of_circle(modes, r, distance > 0 ? x / distance : 1, distance > 0 ? y / distance : 0,
                         shapes);
    if (modes->statistical && r < 1)
        himc_statistical_shapes(modes->statistical, x / radius, y / radius, shapes + modes->exact);
}

double himc_modes_pressure(const himc_modes *modes, int index, double across, double azimuth)
{
    return himc_statistical_pressure(modes->statistical, index - modes->exact, across, azimuth);
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

static void grid_transform(const himc_grid *g, int index, double kx, double ky, double *even,
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

static void rectangle_transform(const himc_shape *shape, const entry *e, double kx, double ky,
                                double *even, double *odd)
{
    double a, b;
    sides(shape, &a, &b);
    double product = a * b * side_transform(e->m, kx * a) * side_transform(e->n, ky * b);
    bool m = e->m % 2, n = e->n % 2;
    *even = m && n ? product : !m && !n ? -product : 0;
    *odd = m != n ? product : 0;
}

void himc_modes_transform(const himc_modes *modes, double radius, int index, double kx, double ky,
                          double *even, double *odd)
{
    const himc_shape *shape = &modes->shape;
    if (shape->kind == HIMC_GRID)
        grid_transform(shape->grid, index, kx * radius, ky * radius, even, odd);
    else
        rectangle_transform(shape, &modes->entries[index], kx * radius, ky * radius, even, odd);
    *even *= radius * radius;
    *odd *= radius * radius;
}

// here and not in grid.c, so that a membrane needs no Eigen
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
    free(grid->path);
    free(grid->x);
    free(grid->y);
    free(grid->area);
    free(grid->zero);
    free(grid->norm);
    free(grid->shape);
    free(grid);
}
