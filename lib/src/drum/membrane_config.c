/// membrane_config.c: configs of heads compared, checked and changed.
#include "drum/membrane_config.h"

#include "base/argument.h"
#include "head/air.h"

#include <math.h>
#include <string.h>

// relative; so a point moved to the rim is not outside it in single precision, in which a command
// can say it
#define RIM_ROUNDING 1.2e-7
#define BISECTIONS 60 // halvings of ln T: exact to the last bit of a double

bool himc_shape_equal(const himc_shape *a, const himc_shape *b)
{
    return a->kind == b->kind && a->grid == b->grid && a->body == b->body && a->shell == b->shell &&
           a->length * b->width == b->length * a->width;
}

// all fields of a head
#define FIELDS(OF)                                                                               \
    OF(radius), OF(tension), OF(density), OF(decay_constant), OF(decay_square), OF(modes),       \
        OF(air), OF(kettle), OF(glide), OF(damp), OF(dampers), OF(motor), OF(muffle), OF(wires), \
        OF(uniformity), OF(uniformity_seed)

bool himc_head_equal(const himc_head *a, const himc_head *b)
{
#define SAME(field) (equal = equal && a->field == b->field)
    bool equal = true;
    FIELDS(SAME);
    return equal;
}

void himc_head_keep_edits(himc_head *head, const himc_head *was, const himc_head *now)
{
#define KEEP(field) (head->field = now->field != was->field ? now->field : head->field)
    FIELDS(KEEP);
}

static bool same_pickups(const himc_pickup *a, const himc_pickup *b, int count)
{
    bool same = true;
    for (int i = 0; i < count; i++)
        same = same && a[i].kind == b[i].kind && a[i].x == b[i].x && a[i].y == b[i].y &&
               a[i].azimuth == b[i].azimuth && a[i].elevation == b[i].elevation &&
               a[i].distance == b[i].distance;
    return same;
}

bool himc_membrane_config_alike(const himc_membrane_config *a, const himc_membrane_config *b)
{
    return a->pickup_count == b->pickup_count && himc_head_equal(&a->head, &b->head) &&
           himc_shape_equal(&a->shape, &b->shape) &&
           same_pickups(a->pickups, b->pickups, a->pickup_count);
}

bool himc_membrane_config_equal(const himc_membrane_config *a, const himc_membrane_config *b)
{
    const himc_pickup *rays = a->pickups + HIMC_PICKUPS;
    return a->rate == b->rate && a->shares == b->shares && a->rays == b->rays &&
           himc_membrane_config_alike(a, b) &&
           (!a->rays || same_pickups(rays, b->pickups + HIMC_PICKUPS, HIMC_RAYS));
}

bool himc_membrane_config_check(const himc_membrane_config *config, himc_error *error)
{
    const himc_head *head = &config->head;
    if (!himc_head_check(head, error) ||
        !himc_check_range("sample rate", config->rate, 4000, 480000, "Hz", error))
        return false;
    if (head->air && !config->shape.kind->air)
        return himc_error_set(error, "air: 1, expected 0 on a head that is not round");
    return (!head->air || head->kettle == 0 || himc_air_check(head->kettle, head->radius, error)) &&
           himc_modes_check(&config->shape, head->modes, error);
}

bool himc_membrane_config_set_rays(himc_membrane_config *config, const himc_pickup *rays)
{
    himc_pickup *own = config->pickups + HIMC_PICKUPS;
    if (config->rays == (rays != NULL) && (!rays || same_pickups(own, rays, HIMC_RAYS)))
        return false;
    config->rays = rays != NULL;
    if (rays)
        memcpy(own, rays, sizeof *rays * HIMC_RAYS);
    return true;
}

void himc_membrane_config_keep_pickups(himc_membrane_config *config)
{
    for (int i = 0; i < config->pickup_count; i++) {
        himc_pickup *p = &config->pickups[i];
        double r = hypot(p->x, p->y), radius = config->head.radius;
        if (p->kind != HIMC_PICKUP_POINT || r <= radius)
            continue;
        p->x = himc_argument_single((1 - RIM_ROUNDING) * radius / r * p->x);
        p->y = himc_argument_single((1 - RIM_ROUNDING) * radius / r * p->y);
    }
}

double himc_head_principal(const himc_head *head, const himc_shape *shape)
{
    double zero = shape->kind->principal(shape);
    if (shape->kind->pitch)
        return shape->kind->pitch(shape, head);
    double bare = zero / (2 * HIMC_PI * head->radius) * sqrt(head->tension / head->density);
    if (!head->air)
        return bare;
    himc_air air = himc_air_over(head);
    return bare * himc_air_on(&air, 1, 1, zero).frequency;
}

double himc_head_tension(const himc_head *head, const himc_shape *shape, double frequency)
{
    himc_head trial = *head;
    double low = log(HIMC_TENSION_MIN), high = log(HIMC_TENSION_MAX);
    for (int i = 0; i < BISECTIONS; i++) {
        trial.tension = exp(0.5 * (low + high));
        if (himc_head_principal(&trial, shape) < frequency)
            low = log(trial.tension);
        else
            high = log(trial.tension);
    }
    return trial.tension;
}

himc_air himc_air_over(const himc_head *head)
{
    return himc_air_around(head, head->kettle > 0 ? head->kettle : himc_air_kettle(head->radius));
}
