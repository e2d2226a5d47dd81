/// modes.c: the list of modes that a kind of head makes, and the materials of heads.
///
/// The default head: a timpano of 26 inches, the commonest one, with Christian et al.'s Mylar
/// (1984) in air, at the tension that sounds D3, the middle of its range. S0 and S1 are what air.h
/// says of a film; the loss by radiation comes on top. Its lugs are uneven enough to beat as
/// recorded heads do: the strongest partials ripple by 1 to 3 dB about a straight decay.
#include "head/modes.h"

#include "head/bessel.h"
#include "head/idiophone.h"

#include <math.h>
#include <stdlib.h>

himc_head himc_head_default(void)
{
    return (himc_head){.radius = 0.3302,
                       .tension = 3830.3,
                       .density = 0.2653,
                       .decay_constant = 0.3,
                       .decay_square = 5e-8,
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
           himc_check_range("wires", head->wires, 0, HIMC_WIRES_MAX, "m/s2", error) &&
           himc_check_range("uniformity", head->uniformity, 0, 1, "", error) &&
           himc_check_range("uniformity seed", head->uniformity_seed, 0, HIMC_SEED_MAX, "",
                            error) &&
           himc_check_range("damp", head->damp, 0, 1, "", error) &&
           himc_check_range("dampers", head->dampers, 0, 100, "1/s", error) &&
           himc_check_range("motor", head->motor, 0, HIMC_MOTOR_MAX, "Hz", error) &&
           himc_check_range("muffle", head->muffle, 0, 1, "", error);
}

double himc_head_tension_for(const himc_head *head, double frequency)
{
    double speed = 2 * HIMC_PI * frequency * head->radius / HIMC_BESSEL_FIRST;
    return head->density * speed * speed;
}

double himc_head_decay(const himc_head *head, double omega, double loading)
{
    double decay = head->decay_constant + head->decay_square * omega * omega;
    double laid = head->damp * HIMC_DAMP + head->dampers +
                  head->muffle * (HIMC_MUFFLE + HIMC_MUFFLE_HIGH * omega);
    return fmin(decay + laid / loading, HIMC_LARGEST_DECAY * omega);
}

static int by_frequency(const void *a, const void *b)
{
    const himc_mode_entry *p = a, *q = b;
    return p->z != q->z ? (p->z > q->z) - (p->z < q->z) : p->m - q->m;
}

void himc_modes_sort(himc_mode_entry *entries, int count)
{
    qsort(entries, (size_t)count, sizeof *entries, by_frequency);
}

static int most_modes(const himc_shape *shape)
{
    return shape->grid ? shape->grid->modes : shape->body ? shape->body->modes : HIMC_MODES_MAX;
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
        count = shape->kind->usual < most_modes(shape) ? shape->kind->usual : most_modes(shape);
    himc_modes *modes = calloc(1, sizeof *modes);
    if (modes)
        modes->users = malloc(sizeof *modes->users);
    if (modes && modes->users) {
        *modes->users = 1;
        modes->count = modes->exact = count;
        modes->uniformity = 1;
        himc_lugs_split(1, 0, modes->pairs);
        modes->shape = *shape;
        himc_shape_retain(shape);
        if (shape->kind->list(modes, automatic))
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
    himc_shape_retain(&copy->shape);
    return copy;
}

void himc_modes_free(himc_modes *modes)
{
    if (!modes)
        return;
    himc_shape_release(&modes->shape);
    if (!modes->users || --*modes->users == 0) {
        free(modes->entries);
        free(modes->first);
        free(modes->of);
        free(modes->table);
        free(modes->statistical);
        free(modes->uneven);
        himc_modes_free(modes->disc);
        free(modes->source);
        free((void *)modes->users);
    }
    free(modes);
}

int himc_modes_common(const himc_modes *a, const himc_modes *b)
{
    if (a->statistical && b->statistical)
        return a->count;
    return a->exact < b->exact ? a->exact : b->exact;
}

void himc_modes_set_lugs(himc_modes *modes, double uniformity, int seed)
{
    if (modes->uniformity != uniformity || modes->seed != seed) {
        himc_lugs_split(uniformity, seed, modes->pairs);
        himc_lugs_fields(uniformity, seed, modes->field);
    }
    modes->uniformity = uniformity;
    modes->seed = seed;
}

void himc_modes_mix_as(himc_modes *modes, const himc_mixture *mixture)
{
    himc_mixture *own = &modes->mixture;
    if (mixture)
        *own = *mixture;
    own->count = modes->block[0].count = modes->block[1].count = 0;
    for (int i = 0; mixture && i < modes->entry_count && own->count < HIMC_MIXED; i++)
        if (modes->entries[i].m == 0)
            own->index[own->count++] = modes->first[i];
}

// of the numbers at `index` (count) the sums of their parts, rows of `width`
static void mix(int count, const int *index, const double *part, int width, double *numbers)
{
    double bare[HIMC_UNEVEN_MODES];
    for (int n = 0; n < count; n++)
        bare[n] = numbers[index[n]];
    for (int n = 0; n < count; n++, part += width) {
        double sum = 0;
        for (int k = 0; k < count; k++)
            sum += part[k] * bare[k];
        numbers[index[n]] = sum;
    }
}

void himc_modes_mix(const himc_modes *modes, double *numbers)
{
    const himc_mixture *m = &modes->mixture;
    mix(m->count, m->index, m->part[0], HIMC_MIXED, numbers);
    for (const himc_uneven_block *b = modes->block; b < modes->block + 2; b++)
        mix(b->count, b->index, b->part[0], HIMC_UNEVEN_MODES, numbers);
}

himc_mode himc_modes_get(const himc_modes *modes, const himc_head *head, int index)
{
    himc_mode mode = {.m = -1, .n = index - modes->exact + 1};
    if (index >= modes->exact) {
        const himc_statistical_mode *s = &modes->statistical->mode[index - modes->exact];
        mode.zero = s->zero;
        mode.norm = 1 / s->count;
    } else {
        int i = modes->of ? modes->of[index] : index;
        const himc_mode_entry *e = &modes->entries[i];
        mode.m = e->m;
        mode.n = e->n;
        mode.sine = modes->of && index > modes->first[i];
        mode.axis = modes->of ? modes->pairs[e->m].axis : 0;
        mode.zero = e->z;
        mode.norm = e->norm;
    }
    double split = modes->of && mode.m > 0 ? modes->pairs[mode.m].split : 0;
    double omega = mode.zero / head->radius * sqrt(head->tension / head->density);
    omega *= sqrt(mode.sine ? 1 + split : 1 - split);
    mode.frequency = omega / (2 * HIMC_PI);
    mode.decay = himc_head_decay(head, omega, 1);
    if (modes->shape.kind->loss)
        mode.decay = fmin(mode.decay + modes->shape.kind->loss(modes, index, omega),
                          HIMC_LARGEST_DECAY * omega);
    mode.mass = head->density * HIMC_PI * head->radius * head->radius * mode.norm;
    mode.stiffness = mode.mass * omega * omega;
    return mode;
}

void himc_modes_shapes(const himc_modes *modes, double radius, double x, double y, double *shapes)
{
    modes->shape.kind->shapes(modes, radius, x, y, shapes);
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

void himc_shape_retain(const himc_shape *shape)
{
    himc_grid_retain(shape->grid);
    if (shape->body)
        shape->body->references++;
}

void himc_shape_release(const himc_shape *shape)
{
    himc_idiophone *body = shape->body;
    himc_grid_release(shape->grid);
    if (!body || --body->references > 0)
        return;
    free(body->name);
    free(body->part);
    free(body->mode);
    free(body->shape);
    free(body);
}
